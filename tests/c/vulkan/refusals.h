/* What is wrong is refused with a sentence. */
/* A copy of the submission of one view, with one thing changed. */
#define WITH(status, words, change)                                          \
    do {                                                                     \
        struct Texture colour = good_colour, depth = good_depth;             \
        PelageVulkanSemaphore wait = PELAGE_VULKAN_SEMAPHORE_INIT;           \
        PelageVulkanView view = view_of(&scene, &colour, &depth, 0);         \
        PelageVulkanSubmit submission = PELAGE_VULKAN_SUBMIT_INIT;           \
        wait.semaphore = semaphore;                                          \
        submission.views = &view;                                            \
        submission.view_count = 1;                                           \
        submission.waits = &wait;                                            \
        change;                                                              \
        unsigned submits = watch.submits;                                    \
        REFUSED(status, words, pelage_vulkan_render(context, &submission));  \
        TRUE(watch.submits == submits);                                      \
    } while (0)

#define WITH_DEVICE(status, words, change)                                        \
    do {                                                                          \
        PelageVulkanDevice device = host.device;                                  \
        PelageVulkanInstance instance = host.instance;                            \
        PelageContext made = { 77 };                                              \
        device.instance = &instance;                                              \
        change;                                                                   \
        REFUSED(status, words, pelage_vulkan_context_create(&device, &made));     \
        TRUE(made.id == 77);                                                      \
    } while (0)

static void refusals(void) {
    enum { WRONG = PELAGE_INVALID_VALUE, CANNOT = PELAGE_UNSUPPORTED };
    PelageContext context = open_context(), own = { 0 };
    PelageContextDescriptor descriptor = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    descriptor.force_software = 1;
    OK(pelage_context_create(&descriptor, &own));
    struct Scene scene, foreign;
    make_scene(&scene, context, 50, 0);
    make_scene(&foreign, own, 50, 0);
    struct Texture good_colour = make_texture(VK_FORMAT_R16G16B16A16_SFLOAT, SIDE, SIDE), good_depth = make_texture(VK_FORMAT_D32_SFLOAT, SIDE, SIDE);
    struct Texture good_output = make_texture(VK_FORMAT_R32_SFLOAT, SIDE, SIDE);
    const uint32_t part[4] = { 8, 8, 16, 16 };
    VkSemaphoreCreateInfo info = { .sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO };
    VkSemaphore semaphore;
    VK(vkCreateSemaphore(the_device, &info, NULL, &semaphore));

    WITH(WRONG, "colour: the image is NULL", colour.image.image = VK_NULL_HANDLE);
    WITH(WRONG, "depth: the image is NULL", depth.image.image = VK_NULL_HANDLE);
    WITH(WRONG, "colour: format D32_SFLOAT", colour.image.format = VK_FORMAT_D32_SFLOAT);
    WITH(WRONG, "colour: format R8G8B8A8_UINT", colour.image.format = VK_FORMAT_R8G8B8A8_UINT);
    WITH(WRONG, "colour: format 12345678", colour.image.format = 12345678);
    WITH(WRONG, "depth: format R32_SFLOAT", depth.image.format = VK_FORMAT_R32_SFLOAT);
    WITH(CANNOT, "depth: the image has 4 samples a pixel", depth.image.samples = 4);
    WITH(CANNOT, "colour: the image has 8 samples a pixel", colour.image.samples = 8);
    WITH(CANNOT, "colour: the image has 0 samples a pixel", colour.image.samples = 0);
    WITH(WRONG, "colour: an image of 0", colour.image.width = 0);
    WITH(WRONG, "1000000", colour.image.width = depth.image.width = 1000000);
    WITH(WRONG, "colour 64", depth.image.width = 32);
    WITH(WRONG, "lacks VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT", colour.image.usage = VK_IMAGE_USAGE_SAMPLED_BIT);
    WITH(WRONG, "lacks VK_IMAGE_USAGE_SAMPLED_BIT", depth.image.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
    WITH(WRONG, "depth lacks the usage", depth.image.usage = VK_IMAGE_USAGE_SAMPLED_BIT; view.flags = PELAGE_RENDER_WRITE_DEPTH);
    WITH(WRONG, "colour: layout_in is VK_IMAGE_LAYOUT_UNDEFINED", colour.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED);
    WITH(WRONG, "depth: layout_in is VK_IMAGE_LAYOUT_UNDEFINED", depth.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED);
    WITH(WRONG, "colour: layout_out is VK_IMAGE_LAYOUT_UNDEFINED", colour.image.layout_out = VK_IMAGE_LAYOUT_UNDEFINED);
    WITH(WRONG, "depth: layout_in 9999", depth.image.layout_in = 9999);
    WITH(WRONG, "depth is the same image as colour, and the same layer", depth.image.image = colour.image.image);
    WITH(WRONG, "colour: layer 2 of an image of 2", colour.image.layer = 2);
    WITH(WRONG, "depth: layer 4294967295 of an image of 2", depth.image.layer = 0xffffffffu);
    WITH(WRONG, "colour: mip level 1 of an image of 1", colour.image.mip_level = 1);
    WITH(WRONG, "colour: an image of 0 layers", colour.image.array_layers = 0);
    WITH(WRONG, "colour: an image of 2 layers and 0 mip levels", colour.image.mip_levels = 0);
    WITH(WRONG, "from 1 to 7 levels", depth.image.mip_levels = 8);
    WITH(WRONG, "colour: an image of 100000 layers", colour.image.array_layers = 100000);
    WITH(WRONG, "colour 32", colour.image.mip_levels = 2; colour.image.mip_level = 1);
    WITH(WRONG, "colour: owner_before 5 is not below 1", colour.image.owner_before = 5);
    WITH(WRONG, "depth: owner_after 1 is not below 1", depth.image.owner_after = 1);
    WITH(WRONG, "owner_after is VK_QUEUE_FAMILY_FOREIGN_EXT", colour.image.owner_after = VK_QUEUE_FAMILY_FOREIGN_EXT);
    WITH(WRONG, "in which no image can change hands", colour.image.owner_before = VK_QUEUE_FAMILY_EXTERNAL; view.flags = PELAGE_RENDER_CLEAR;
         colour.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED);
    WITH(WRONG, "coverage: format D32_SFLOAT", view.coverage = &depth.image);
    WITH(WRONG, "ids: format R16G16B16A16_SFLOAT", view.ids = &colour.image);
    WITH(WRONG, "motion: the image is NULL", colour.image.format = VK_FORMAT_R16G16_SFLOAT; colour.image.image = VK_NULL_HANDLE;
         view.colour = &good_colour.image; view.motion = &colour.image);
    WITH(WRONG, "nearest_depth is the same image as colour", colour.image.format = VK_FORMAT_R32_SFLOAT; view.colour = &good_colour.image;
         view.nearest_depth = &colour.image);
    WITH(WRONG, "coverage: layout_in is VK_IMAGE_LAYOUT_UNDEFINED", depth.image = good_output.image; view.depth = NULL;
         view.coverage = &depth.image; depth.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED; memcpy(scene.view.rectangle, part, sizeof part));
    memset(scene.view.rectangle, 0, sizeof part);
    WITH(WRONG, "the target's coverage is 32", depth.image = good_output.image; view.depth = NULL; view.coverage = &depth.image;
         depth.image.width = 32);
    WITH(WRONG, "coverage: the image's usage lacks VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT", depth.image = good_output.image; view.depth = NULL;
         view.coverage = &depth.image; depth.image.usage = VK_IMAGE_USAGE_SAMPLED_BIT);
    WITH(WRONG, "struct_size 3", colour.image.struct_size = 3);
    WITH(WRONG, "colour is NULL", view.colour = NULL);
    WITH(WRONG, "frame is NULL", view.frame = NULL);
    WITH(WRONG, "flags 0x80", view.flags = 0x80);
    WITH(WRONG, "need a depth", view.depth = NULL; view.flags = PELAGE_RENDER_WRITE_DEPTH);
    WITH(WRONG, "views is NULL", submission.views = NULL);
    WITH(WRONG, "9 views", submission.view_count = 9);
    WITH(WRONG, "waits[0]: the semaphore is NULL", wait.semaphore = VK_NULL_HANDLE; submission.wait_count = 1);
    WITH(WRONG, "waits[0]: kind 7", wait.kind = 7; submission.wait_count = 1);
    WITH(WRONG, "waits[0]: value 4 for a binary", wait.value = 4; submission.wait_count = 1);
    WITH(WRONG, "signals is NULL", submission.signal_count = 1);
    WITH(WRONG, "65 waits", submission.wait_count = 65);
    WITH(PELAGE_INVALID_HANDLE, "belongs to another context", view.frame = &foreign.frame);

    /* What is wrong with a later view undoes those before it, and no frame's place is lost by it. */
    for (int number = 0; number < 40; number++) {
        struct Texture colour = good_colour;
        colour.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
        PelageFrame dark = scene.frame;
        dark.ambient[0] = -1.0f;
        PelageVulkanView views[2] = { view_of(&scene, &colour, NULL, PELAGE_RENDER_CLEAR), PELAGE_VULKAN_VIEW_INIT };
        views[1] = views[0];
        views[1].frame = &dark;
        REFUSED(WRONG, "views[1]: ambient (-1,", render(context, views, 2));
        if (number % 10 == 9) {
            OK(render(context, views, 1));
        }
    }
    OK(pelage_wait(context));

    /* Each kind of context has its own way of drawing. */
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    PelageTarget target = { 77 };
    image.width = image.height = 8;
    REFUSED(CANNOT, "draws into the host's images", pelage_target_create(context, &image, &target));
    OK(pelage_target_create(own, &image, &target));
    REFUSED(CANNOT, "draws into the host's images", pelage_render(context, &scene.frame, target, 0));
    PelageVulkanSubmit nothing = PELAGE_VULKAN_SUBMIT_INIT;
    REFUSED(CANNOT, "has a device of its own", pelage_vulkan_render(own, &nothing));
    REFUSED(WRONG, "submit is NULL", pelage_vulkan_render(context, NULL));
    OK(pelage_vulkan_render(context, &nothing));
    PelageContext no_context = { 0 };
    REFUSED(PELAGE_INVALID_HANDLE, "NULL", pelage_vulkan_render(no_context, &nothing));

    WITH_DEVICE(WRONG, "device is NULL", device.device = NULL);
    WITH_DEVICE(WRONG, "physical_device is NULL", device.physical_device = NULL);
    WITH_DEVICE(WRONG, "physical_device is not one of the instance's", device.physical_device = (VkPhysicalDevice)(void *)&instance);
    WITH_DEVICE(WRONG, "instance is NULL", instance.instance = NULL);
    WITH_DEVICE(WRONG, "instance is NULL", device.instance = NULL);
    WITH_DEVICE(WRONG, "get_instance_proc_addr is NULL", instance.get_instance_proc_addr = NULL);
    WITH_DEVICE(CANNOT, "the instance has Vulkan 1.1; 1.3 is needed", instance.api_version = VK_API_VERSION_1_1);
    WITH_DEVICE(WRONG, "queue_family 99", device.queue_family = 99);
    WITH_DEVICE(WRONG, "queue_index 99", device.queue_index = 99);
    WITH_DEVICE(WRONG, "lock and unlock", device.unlock = NULL);
    WITH_DEVICE(WRONG, "extensions is", device.extensions = NULL; device.extension_count = 1);
    if (host.device.extension_count > 0) {
        WITH_DEVICE(WRONG, "the device's extensions lack VK_", device.extension_count = 0);
    }
    PelageVulkanRequirements requirements = PELAGE_VULKAN_REQUIREMENTS_INIT;
    VkPhysicalDeviceVulkan13Features not_the_head = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES };
    requirements.features = (void *)&not_the_head;
    REFUSED(WRONG, "not to a VkPhysicalDeviceFeatures2", pelage_vulkan_requirements(&host.instance, host.physical, &requirements));
    REFUSED(WRONG, "requirements is NULL", pelage_vulkan_requirements(&host.instance, host.physical, NULL));

    OK(pelage_context_destroy(context));
    OK(pelage_context_destroy(own));
    vkDestroySemaphore(the_device, semaphore, NULL);
    destroy_texture(&good_output);
    destroy_texture(&good_colour);
    destroy_texture(&good_depth);
}

#define SHORT(words, change)                                                                                   \
    do {                                                                                                       \
        memset(&fake, 0, sizeof fake);                                                                         \
        change;                                                                                                \
        PelageVulkanRequirements requirements = PELAGE_VULKAN_REQUIREMENTS_INIT;                               \
        VkPhysicalDeviceFeatures2 features = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2 };        \
        requirements.features = &features;                                                                     \
        REFUSED(PELAGE_UNSUPPORTED, words, pelage_vulkan_requirements(&host.instance, host.physical, &requirements)); \
        TRUE(!features.pNext && !features.features.robustBufferAccess);                                        \
        PelageContext made;                                                                                    \
        REFUSED(PELAGE_UNSUPPORTED, words, pelage_vulkan_context_create(&host.device, &made));                 \
    } while (0)

static void short_devices(void) {
    SHORT("the device has Vulkan 1.2; 1.3 is needed", fake.api_version = VK_API_VERSION_1_2);
    SHORT("queue family 0 offers no graphics", fake.no_graphics = 1);
    SHORT("no queue family that offers both graphics and compute", fake.no_compute = 1);
    SHORT("the device allows 3 bind groups; pelage needs 4", fake.sets = 3);
    SHORT("the device allows 9 storage buffers a stage; pelage needs 10", fake.storage_buffers = 9);
    SHORT("the device allows 128 invocations a workgroup; pelage needs 256", fake.invocations = 128);
    SHORT("lacks the feature fragmentStoresAndAtomics", fake.no_stores = 1);
    SHORT("lacks the feature timelineSemaphore", fake.no_timeline = 1);
    memset(&fake, 0, sizeof fake);
    PelageVulkanRequirements requirements = PELAGE_VULKAN_REQUIREMENTS_INIT;
    OK(pelage_vulkan_requirements(&host.instance, host.physical, &requirements));
    TRUE(requirements.features != NULL && requirements.queue_flags == (VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT));
}
