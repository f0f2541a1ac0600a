/* The host: its device, images, buffers and scenes. */
static struct Host {
    PelageVulkanInstance instance;
    PelageVulkanDevice device;
    PelageVulkanRequirements requirements;
    VkPhysicalDevice physical;
    VkQueue queue;
    VkCommandPool pool;
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *bytes;
} host;

static uint32_t memory_type(uint32_t bits, VkMemoryPropertyFlags flags) {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(host.physical, &memory);
    uint32_t at = 0;
    while (!(bits >> at & 1) || (memory.memoryTypes[at].propertyFlags & flags) != flags) {
        at++;
    }
    return at;
}

static VkDeviceMemory allocate(VkMemoryRequirements needs, VkMemoryPropertyFlags flags) {
    VkMemoryAllocateInfo info = { .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO };
    info.allocationSize = needs.size;
    info.memoryTypeIndex = memory_type(needs.memoryTypeBits, flags);
    VkDeviceMemory memory;
    VK(vkAllocateMemory(the_device, &info, NULL, &memory));
    return memory;
}

static void open_host(void) {
    VkApplicationInfo application = { .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO };
    application.apiVersion = VK_API_VERSION_1_3;
    VkInstanceCreateInfo instance = { .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO };
    instance.pApplicationInfo = &application;
    PelageVulkanInstance mine = PELAGE_VULKAN_INSTANCE_INIT;
    VK(vkCreateInstance(&instance, NULL, &mine.instance));
    mine.api_version = VK_API_VERSION_1_3;
    mine.get_instance_proc_addr = get_instance;
    host.instance = mine;
    uint32_t count = 1;
    vkEnumeratePhysicalDevices(mine.instance, &count, &host.physical);

    /* The first run of each kind asks by structs of its own, the second by those of a whole version. */
    static VkPhysicalDeviceVulkan13Features of_1_3 = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES };
    static VkPhysicalDeviceFeatures2 features = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &of_1_3 };
    of_1_3.dynamicRendering = VK_TRUE;
    const PelageVulkanRequirements empty = PELAGE_VULKAN_REQUIREMENTS_INIT;
    host.requirements = empty;
    host.requirements.features = &features;
    OK(pelage_vulkan_requirements(&host.instance, host.physical, &host.requirements));
    TRUE(host.requirements.features == &features && of_1_3.dynamicRendering);
    TRUE(features.features.robustBufferAccess && features.features.fragmentStoresAndAtomics);

    const float priorities[2] = { 1.0f, 1.0f };
    VkDeviceQueueCreateInfo queue = { .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO };
    queue.queueCount = 1;
    queue.pQueuePriorities = priorities;
    VkDeviceCreateInfo device = { .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO };
    device.pNext = host.requirements.features;
    device.queueCreateInfoCount = 1;
    device.pQueueCreateInfos = &queue;
    device.enabledExtensionCount = host.requirements.device_extension_count;
    device.ppEnabledExtensionNames = host.requirements.device_extensions;
    VK(vkCreateDevice(host.physical, &device, NULL, &the_device));
    vkGetDeviceQueue(the_device, 0, 0, &host.queue);
    VkCommandPoolCreateInfo pool = { .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO };
    pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    VK(vkCreateCommandPool(the_device, &pool, NULL, &host.pool));

    VkBufferCreateInfo room = { .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO };
    room.size = MOST_BYTES;
    room.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    VK(vkCreateBuffer(the_device, &room, NULL, &host.buffer));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(the_device, host.buffer, &needs);
    host.memory = allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    VK(vkBindBufferMemory(the_device, host.buffer, host.memory, 0));
    VK(vkMapMemory(the_device, host.memory, 0, VK_WHOLE_SIZE, 0, &host.bytes));

    const PelageVulkanDevice none = PELAGE_VULKAN_DEVICE_INIT;
    host.device = none;
    host.device.instance = &host.instance;
    host.device.physical_device = host.physical;
    host.device.device = the_device;
    host.device.extensions = host.requirements.device_extensions;
    host.device.extension_count = host.requirements.device_extension_count;
    host.device.lock = lock;
    host.device.unlock = unlock;
    host.device.lock_user = &watch;
}

static void close_host(void) {
    vkDestroyBuffer(the_device, host.buffer, NULL);
    vkFreeMemory(the_device, host.memory, NULL);
    vkDestroyCommandPool(the_device, host.pool, NULL);
    vkDestroyDevice(the_device, NULL);
    vkDestroyInstance(host.instance.instance, NULL);
    TRUE(watch.objects_taken == 0 && watch.unlocked_uses == 0 && watch.locks == watch.unlocks);
}

static PelageContext open_context(void) {
    PelageContext context = { 0 };
    OK(pelage_vulkan_context_create(&host.device, &context));
    return context;
}

struct Texture {
    PelageVulkanImage image;
    VkDeviceMemory memory;
    VkImageView view;
    VkImageAspectFlags aspect;
};

static int has_stencil(VkFormat format) {
    return format == VK_FORMAT_D24_UNORM_S8_UINT || format == VK_FORMAT_D32_SFLOAT_S8_UINT;
}

static int is_depth(VkFormat format) {
    return (format >= VK_FORMAT_D16_UNORM && format <= VK_FORMAT_D32_SFLOAT) || has_stencil(format);
}

/* An image of several layers and mip levels in the layout of an attachment; the first of each is meant, and seen by the view. */
static struct Texture make_array(VkFormat format, uint32_t width, uint32_t height, uint32_t layers, uint32_t levels) {
    struct Texture texture = { PELAGE_VULKAN_IMAGE_INIT, VK_NULL_HANDLE, VK_NULL_HANDLE, VK_IMAGE_ASPECT_COLOR_BIT };
    VkImageCreateInfo image = { .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO };
    image.imageType = VK_IMAGE_TYPE_2D;
    image.format = format;
    image.extent.width = width;
    image.extent.height = height;
    image.extent.depth = 1;
    image.mipLevels = texture.image.mip_levels = levels;
    image.arrayLayers = texture.image.array_layers = layers;
    image.samples = VK_SAMPLE_COUNT_1_BIT;
    image.usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT
        | (is_depth(format) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
    texture.image.format = format;
    texture.image.width = width;
    texture.image.height = height;
    texture.image.usage = image.usage;
    texture.image.layout_in = texture.image.layout_out =
        is_depth(format) ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    if (is_depth(format)) {
        texture.aspect = VK_IMAGE_ASPECT_DEPTH_BIT | (has_stencil(format) ? VK_IMAGE_ASPECT_STENCIL_BIT : 0);
    }
    VK(vkCreateImage(the_device, &image, NULL, &texture.image.image));
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(the_device, texture.image.image, &needs);
    texture.memory = allocate(needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    VK(vkBindImageMemory(the_device, texture.image.image, texture.memory, 0));
    VkImageViewCreateInfo view = { .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO };
    view.image = texture.image.image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange.aspectMask = texture.aspect;
    view.subresourceRange.levelCount = view.subresourceRange.layerCount = 1;
    VK(vkCreateImageView(the_device, &view, NULL, &texture.view));
    return texture;
}

/* An image of which the library uses the first of two layers. */
static struct Texture make_texture(VkFormat format, uint32_t width, uint32_t height) {
    return make_array(format, width, height, 2, 1);
}

static void destroy_texture(struct Texture *texture) {
    vkDestroyImageView(the_device, texture->view, NULL);
    vkDestroyImage(the_device, texture->image.image, NULL);
    vkFreeMemory(the_device, texture->memory, NULL);
}

static VkCommandBuffer begin(void) {
    VkCommandBufferAllocateInfo info = { VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, NULL, host.pool, VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1 };
    VkCommandBuffer commands;
    VK(vkAllocateCommandBuffers(the_device, &info, &commands));
    VkCommandBufferBeginInfo once = { VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, NULL, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT, NULL };
    VK(vkBeginCommandBuffer(commands, &once));
    return commands;
}

/* Submits, with the lock that the library takes too; waits if asked to. */
static void submit(VkCommandBuffer commands, VkSemaphore wait, VkSemaphore signal, int idle) {
    VK(vkEndCommandBuffer(commands));
    const VkPipelineStageFlags stages = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    VkSubmitInfo info = { .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO };
    info.waitSemaphoreCount = wait ? 1 : 0;
    info.pWaitSemaphores = &wait;
    info.pWaitDstStageMask = &stages;
    info.commandBufferCount = 1;
    info.pCommandBuffers = &commands;
    info.signalSemaphoreCount = signal ? 1 : 0;
    info.pSignalSemaphores = &signal;
    pthread_mutex_lock(&watch.mutex);
    VK(vkQueueSubmit(host.queue, 1, &info, VK_NULL_HANDLE));
    if (idle) {
        VK(vkQueueWaitIdle(host.queue));
        vkFreeCommandBuffers(the_device, host.pool, 1, &commands);
    }
    pthread_mutex_unlock(&watch.mutex);
}

static void move(VkCommandBuffer commands, const struct Texture *texture, VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier barrier = { .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER };
    barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = texture->image.image;
    barrier.subresourceRange.aspectMask = texture->aspect;
    barrier.subresourceRange.levelCount = barrier.subresourceRange.layerCount = 1;
    barrier.subresourceRange.baseMipLevel = texture->image.mip_level;
    barrier.subresourceRange.baseArrayLayer = texture->image.layer;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

/* The opaque scene: in columns of eight pixels, `depths` of them, its colour that of the column. */
static const float COLUMN[3] = { 0.25f, 0.5f, 0.0625f };

static void draw_scene(VkCommandBuffer commands, struct Texture *colour, struct Texture *depth, const float *depths) {
    move(commands, colour, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    move(commands, depth, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
    VkRenderingAttachmentInfo attachments[2] = { { .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO } };
    attachments[0].loadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    attachments[0].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachments[1] = attachments[0];
    attachments[0].imageView = colour->view;
    attachments[0].imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    attachments[1].imageView = depth->view;
    attachments[1].imageLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    VkRenderingInfo rendering = { .sType = VK_STRUCTURE_TYPE_RENDERING_INFO };
    rendering.renderArea.extent.width = colour->image.width;
    rendering.renderArea.extent.height = colour->image.height;
    rendering.layerCount = rendering.colorAttachmentCount = 1;
    rendering.pColorAttachments = &attachments[0];
    rendering.pDepthAttachment = &attachments[1];
    vkCmdBeginRendering(commands, &rendering);
    for (uint32_t column = 0; column < colour->image.width / 8; column++) {
        VkClearAttachment clear[2] = { { .aspectMask = VK_IMAGE_ASPECT_COLOR_BIT }, { .aspectMask = VK_IMAGE_ASPECT_DEPTH_BIT } };
        for (int channel = 0; channel < 3; channel++) {
            clear[0].clearValue.color.float32[channel] = COLUMN[channel] * (float)(column % 2);
        }
        clear[0].clearValue.color.float32[3] = 1.0f;
        clear[1].clearValue.depthStencil.depth = depths[column];
        VkClearRect rect = { { { (int32_t)(8 * column), 0 }, { 8, colour->image.height } }, 0, 1 };
        vkCmdClearAttachments(commands, 2, clear, 1, &rect);
    }
    vkCmdEndRendering(commands);
}

/* Copies an image, or the first pixels of a larger one, which is left as it is, to `host.bytes`. */
static void read_back(struct Texture *texture, VkImageLayout layout, VkImageAspectFlags aspect, VkSemaphore wait) {
    VkCommandBuffer commands = begin();
    move(commands, texture, layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    VkBufferImageCopy copy = { 0 };
    copy.imageSubresource.aspectMask = aspect;
    copy.imageSubresource.layerCount = 1;
    copy.imageSubresource.mipLevel = texture->image.mip_level;
    copy.imageSubresource.baseArrayLayer = texture->image.layer;
    copy.imageExtent.width = texture->image.width >> texture->image.mip_level;
    copy.imageExtent.height = texture->image.height >> texture->image.mip_level;
    copy.imageExtent.width = copy.imageExtent.width < SIDE ? copy.imageExtent.width : SIDE;
    copy.imageExtent.height = copy.imageExtent.height < SIDE ? copy.imageExtent.height : SIDE;
    copy.imageExtent.depth = 1;
    vkCmdCopyImageToBuffer(commands, texture->image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, host.buffer, 1, &copy);
    move(commands, texture, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, layout);
    submit(commands, wait, VK_NULL_HANDLE, 1);
}

struct Scene {
    PelageHair hair;
    PelageLight light;
    PelageView view;
    PelageFrame frame;
};

/* A small head of hair, in a struct that points to itself. */
static void make_scene(struct Scene *scene, PelageContext context, uint64_t strands, int reverse_z) {
    const double eye[3] = { 0.6, 0.15, -0.75 }, middle[3] = { 0.0, -0.06, 0.0 }, up[3] = { 0.0, 1.0, 0.0 };
    const PelageLight light = PELAGE_LIGHT_INIT;
    const PelageView view = PELAGE_VIEW_INIT;
    const PelageFrame frame = PELAGE_FRAME_INIT;
    scene->light = light;
    scene->view = view;
    scene->frame = frame;
    OK(pelage_hair_create_builtin(context, PELAGE_BUILTIN_WAVY, strands, &scene->hair));
    OK(pelage_view_perspective(eye, middle, up, 0.5, 1.0, 0.1, 10.0, &scene->view));
    if (reverse_z) { /* depth becomes 1 - depth */
        scene->view.flags = PELAGE_VIEW_REVERSE_Z;
        for (int column = 0; column < 4; column++) {
            double *clip = scene->view.clip_from_view + 4 * column;
            clip[2] = clip[3] - clip[2];
        }
    }
    scene->light.direction[0] = -0.9;
    scene->light.power[0] = scene->light.power[1] = scene->light.power[2] = 2.0f;
    scene->frame.hairs = &scene->hair;
    scene->frame.lights = &scene->light;
    scene->frame.hair_count = scene->frame.light_count = 1;
    scene->frame.view = &scene->view;
    scene->frame.ambient[0] = scene->frame.ambient[1] = scene->frame.ambient[2] = 0.05f;
}

static PelageVulkanView view_of(const struct Scene *scene, const struct Texture *colour, const struct Texture *depth, uint32_t flags) {
    PelageVulkanView view = PELAGE_VULKAN_VIEW_INIT;
    view.frame = &scene->frame;
    view.colour = &colour->image;
    view.depth = depth ? &depth->image : NULL;
    view.flags = flags;
    return view;
}

static PelageResult render(PelageContext context, const PelageVulkanView *views, uint32_t count) {
    PelageVulkanSubmit submission = PELAGE_VULKAN_SUBMIT_INIT;
    submission.views = views;
    submission.view_count = count;
    return pelage_vulkan_render(context, &submission);
}

static float half(uint16_t bits) {
    int exponent = bits >> 10 & 31;
    float value = exponent ? ldexpf((float)((bits & 1023) | 1024), exponent - 25) : ldexpf((float)(bits & 1023), -24);
    return bits & 0x8000 ? -value : value;
}

static float encoded(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1.0f / 2.4f) - 0.055f;
}

/* The library's own picture of a scene over that of `draw_scene`, and its depth. */
static void render_offscreen(PelageContext context, const struct Scene *scene, uint32_t format, const float *depths,
                             uint32_t flags, float *pixels, float *pixel_depths) {
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    PelageTarget target;
    image.width = image.height = SIDE;
    image.format = format;
    image.with_depth = depths != NULL;
    OK(pelage_target_create(context, &image, &target));
    for (int at = 0; at < SIDE * SIDE && depths; at++) {
        int column = at % SIDE / 8;
        for (int channel = 0; channel < 4; channel++) {
            pixels[4 * at + channel] = channel == 3 ? 1.0f : COLUMN[channel] * (float)(column % 2);
        }
        pixel_depths[at] = depths[column];
    }
    if (depths) {
        OK(pelage_target_write_colour(target, pixels, SIDE * SIDE * 16));
        OK(pelage_target_write_depth(target, pixel_depths, SIDE * SIDE * 4));
    }
    OK(pelage_render(context, &scene->frame, target, flags));
    OK(pelage_target_read_colour(target, pixels, SIDE * SIDE * 16));
    if (depths) {
        OK(pelage_target_read_depth(target, pixel_depths, SIDE * SIDE * 4));
    }
    OK(pelage_target_destroy(target));
}
