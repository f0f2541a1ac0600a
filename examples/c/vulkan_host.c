/*
 * A host with its own Vulkan 1.3: a depth pre-pass of its own, hair by pelage, another pass of its own, all on one queue,
 * several frames in flight, in step by one timeline semaphore. Writes the last frame as a PNG picture.
 *
 *     cc examples/c/vulkan_host.c -Iinclude -Ltarget/release -lpelage -lvulkan -lm -o vulkan_host
 *     ./vulkan_host [picture.png [strands]]
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PELAGE_VULKAN
#include "pelage.h"
#include "vulkan_host_spirv.h"

enum { WIDTH = 480, HEIGHT = 640, FRAMES = 3, SPHERE_VERTICES = 64 * 32 * 6 };

static const VkFormat COLOUR = VK_FORMAT_R16G16B16A16_SFLOAT, DEPTH = VK_FORMAT_D32_SFLOAT;

static void check(PelageResult result, const char *what) {
    if (result != PELAGE_OK) {
        fprintf(stderr, "%s: %s\n", what, pelage_last_error());
        exit(1);
    }
}

static void check_vk(VkResult result, const char *what) {
    if (result != VK_SUCCESS) {
        fprintf(stderr, "%s: VkResult %d\n", what, (int)result);
        exit(1);
    }
}

/* All that the host owns. */
struct Host {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    uint32_t family;
    VkQueue queue;
    VkCommandPool pool;
    VkPipelineLayout layout;
    VkPipeline pipeline;
    VkSemaphore timeline;
};

struct Picture {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
};

/* ---- The device, made with what pelage requires ---- */

static uint32_t find_family(VkPhysicalDevice physical, VkQueueFlags flags) {
    VkQueueFamilyProperties families[16];
    uint32_t count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    for (uint32_t at = 0; at < count; at++) {
        if ((families[at].queueFlags & flags) == flags) {
            return at;
        }
    }
    return UINT32_MAX;
}

static PelageContext make_device(struct Host *host) {
    VkApplicationInfo application = { VK_STRUCTURE_TYPE_APPLICATION_INFO, NULL, "vulkan_host", 1, NULL, 0, VK_API_VERSION_1_3 };
    VkInstanceCreateInfo instance = { VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, NULL, 0, &application, 0, NULL, 0, NULL };
    check_vk(vkCreateInstance(&instance, NULL, &host->instance), "vkCreateInstance");

    PelageVulkanInstance mine = PELAGE_VULKAN_INSTANCE_INIT;
    mine.api_version = VK_API_VERSION_1_3;
    mine.instance = host->instance;
    mine.get_instance_proc_addr = vkGetInstanceProcAddr;

    /* The host's own features; pelage adds its own, and says what devices do not suit it. */
    VkPhysicalDevice devices[16];
    uint32_t count = 16;
    if (vkEnumeratePhysicalDevices(host->instance, &count, devices) < 0 || count == 0) {
        fprintf(stderr, "no Vulkan device\n");
        exit(1);
    }
    VkPhysicalDeviceVulkan13Features of_1_3 = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES };
    of_1_3.dynamicRendering = VK_TRUE;
    of_1_3.synchronization2 = VK_TRUE;
    VkPhysicalDeviceFeatures2 features = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2 };
    features.pNext = &of_1_3;
    PelageVulkanRequirements requirements = PELAGE_VULKAN_REQUIREMENTS_INIT;
    requirements.features = &features;
    for (uint32_t at = 0; at < count && !host->physical; at++) {
        if (pelage_vulkan_requirements(&mine, devices[at], &requirements) == PELAGE_OK) {
            host->physical = devices[at];
        } else {
            fprintf(stderr, "device %u does not do: %s\n", (unsigned)at, pelage_last_error());
        }
    }
    if (!host->physical) {
        exit(1);
    }
    host->family = find_family(host->physical, requirements.queue_flags);

    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue = { VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, NULL, 0, host->family, 1, &priority };
    VkDeviceCreateInfo device = { .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO };
    device.pNext = requirements.features;
    device.queueCreateInfoCount = 1;
    device.pQueueCreateInfos = &queue;
    device.enabledExtensionCount = requirements.device_extension_count;
    device.ppEnabledExtensionNames = requirements.device_extensions;
    check_vk(vkCreateDevice(host->physical, &device, NULL, &host->device), "vkCreateDevice");
    vkGetDeviceQueue(host->device, host->family, 0, &host->queue);

    PelageVulkanDevice ours = PELAGE_VULKAN_DEVICE_INIT;
    ours.instance = &mine;
    ours.physical_device = host->physical;
    ours.device = host->device;
    ours.queue_family = host->family;
    ours.extensions = requirements.device_extensions;
    ours.extension_count = requirements.device_extension_count;
    /* One thread, so no lock around the queue. */
    PelageContext context;
    check(pelage_vulkan_context_create(&ours, &context), "context");
    return context;
}

/* ---- The host's images, pipeline and passes ---- */

static uint32_t memory_type(const struct Host *host, uint32_t bits, VkMemoryPropertyFlags flags) {
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(host->physical, &memory);
    for (uint32_t at = 0; at < memory.memoryTypeCount; at++) {
        if ((bits >> at & 1) && (memory.memoryTypes[at].propertyFlags & flags) == flags) {
            return at;
        }
    }
    fprintf(stderr, "no memory of the kind\n");
    exit(1);
}

static VkDeviceMemory allocate(const struct Host *host, VkMemoryRequirements needs, VkMemoryPropertyFlags flags) {
    VkMemoryAllocateInfo info = { VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, NULL, needs.size, 0 };
    info.memoryTypeIndex = memory_type(host, needs.memoryTypeBits, flags);
    VkDeviceMemory memory;
    check_vk(vkAllocateMemory(host->device, &info, NULL, &memory), "vkAllocateMemory");
    return memory;
}

static struct Picture make_picture(const struct Host *host, VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect) {
    struct Picture picture;
    VkImageCreateInfo image = { .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO };
    image.imageType = VK_IMAGE_TYPE_2D;
    image.format = format;
    image.extent.width = WIDTH;
    image.extent.height = HEIGHT;
    image.extent.depth = image.mipLevels = image.arrayLayers = 1;
    image.samples = VK_SAMPLE_COUNT_1_BIT;
    image.usage = usage;
    check_vk(vkCreateImage(host->device, &image, NULL, &picture.image), "vkCreateImage");
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(host->device, picture.image, &needs);
    picture.memory = allocate(host, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    check_vk(vkBindImageMemory(host->device, picture.image, picture.memory, 0), "vkBindImageMemory");
    VkImageViewCreateInfo view = { .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO };
    view.image = picture.image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange.aspectMask = aspect;
    view.subresourceRange.levelCount = view.subresourceRange.layerCount = 1;
    check_vk(vkCreateImageView(host->device, &view, NULL, &picture.view), "vkCreateImageView");
    return picture;
}

static void make_pipeline(struct Host *host) {
    VkPushConstantRange constants = { VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, 24 * sizeof(float) };
    VkPipelineLayoutCreateInfo layout = { VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, NULL, 0, 0, NULL, 1, &constants };
    check_vk(vkCreatePipelineLayout(host->device, &layout, NULL, &host->layout), "vkCreatePipelineLayout");
    VkShaderModuleCreateInfo code = { VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, NULL, 0, sizeof VULKAN_HOST_SPIRV, VULKAN_HOST_SPIRV };
    VkShaderModule module;
    check_vk(vkCreateShaderModule(host->device, &code, NULL, &module), "vkCreateShaderModule");
    VkPipelineShaderStageCreateInfo stages[2] = { { .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO } };
    stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
    stages[0].module = module;
    stages[0].pName = "sphere";
    stages[1] = stages[0];
    stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
    stages[1].pName = "shade";
    VkPipelineVertexInputStateCreateInfo no_vertices = { .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO };
    VkPipelineInputAssemblyStateCreateInfo assembly = { .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO };
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    /* Clip space has y upwards, as pelage's: a viewport of negative height. */
    VkViewport viewport = { 0, HEIGHT, WIDTH, -(float)HEIGHT, 0, 1 };
    VkRect2D scissor = { { 0, 0 }, { WIDTH, HEIGHT } };
    VkPipelineViewportStateCreateInfo view = { VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, NULL, 0, 1, &viewport, 1, &scissor };
    VkPipelineRasterizationStateCreateInfo raster = { .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO };
    raster.lineWidth = 1.0f;
    VkPipelineMultisampleStateCreateInfo samples = { .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO };
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    VkPipelineDepthStencilStateCreateInfo depth = { .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO };
    depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = VK_COMPARE_OP_LESS;
    VkPipelineColorBlendAttachmentState written = { 0 };
    written.colorWriteMask = 15;
    VkPipelineColorBlendStateCreateInfo blend = { .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO };
    blend.attachmentCount = 1;
    blend.pAttachments = &written;
    VkPipelineRenderingCreateInfo formats = { .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO };
    formats.colorAttachmentCount = 1;
    formats.pColorAttachmentFormats = &COLOUR;
    formats.depthAttachmentFormat = DEPTH;
    VkGraphicsPipelineCreateInfo pipeline = { .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO };
    pipeline.pNext = &formats;
    pipeline.stageCount = 2;
    pipeline.pStages = stages;
    pipeline.pVertexInputState = &no_vertices;
    pipeline.pInputAssemblyState = &assembly;
    pipeline.pViewportState = &view;
    pipeline.pRasterizationState = &raster;
    pipeline.pMultisampleState = &samples;
    pipeline.pDepthStencilState = &depth;
    pipeline.pColorBlendState = &blend;
    pipeline.layout = host->layout;
    check_vk(vkCreateGraphicsPipelines(host->device, VK_NULL_HANDLE, 1, &pipeline, NULL, &host->pipeline), "vkCreateGraphicsPipelines");
    vkDestroyShaderModule(host->device, module, NULL);
}

/* A barrier around an image; what comes before it and after it is all. */
static void barrier(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to) {
    VkImageMemoryBarrier2 move = { .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2 };
    move.srcStageMask = move.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    move.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    move.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    move.oldLayout = from;
    move.newLayout = to;
    move.srcQueueFamilyIndex = move.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    move.image = image;
    move.subresourceRange.aspectMask = aspect;
    move.subresourceRange.levelCount = move.subresourceRange.layerCount = 1;
    VkDependencyInfo dependency = { .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO };
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &move;
    vkCmdPipelineBarrier2(commands, &dependency);
}

static VkCommandBuffer begin(const struct Host *host) {
    VkCommandBufferAllocateInfo info = { VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, NULL, host->pool, VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1 };
    VkCommandBuffer commands;
    check_vk(vkAllocateCommandBuffers(host->device, &info, &commands), "vkAllocateCommandBuffers");
    VkCommandBufferBeginInfo once = { VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, NULL, VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT, NULL };
    check_vk(vkBeginCommandBuffer(commands, &once), "vkBeginCommandBuffer");
    return commands;
}

/* A pass of the host's: one sphere, over a grey background or over what is there. `object` as in vulkan_host.wgsl. */
static void draw_sphere(const struct Host *host, VkCommandBuffer commands, const struct Picture *colour,
                        const struct Picture *depth, int clear, const float object[24]) {
    VkRenderingAttachmentInfo attachments[2] = { { .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO } };
    attachments[0].loadOp = clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
    attachments[0].storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    attachments[1] = attachments[0];
    attachments[0].imageView = colour->view;
    attachments[0].imageLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    for (int channel = 0; channel < 4; channel++) {
        attachments[0].clearValue.color.float32[channel] = channel < 3 ? 0.18f : 1.0f;
    }
    attachments[1].imageView = depth->view;
    attachments[1].imageLayout = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
    attachments[1].clearValue.depthStencil.depth = 1.0f;
    VkRenderingInfo rendering = { .sType = VK_STRUCTURE_TYPE_RENDERING_INFO };
    rendering.renderArea.extent.width = WIDTH;
    rendering.renderArea.extent.height = HEIGHT;
    rendering.layerCount = rendering.colorAttachmentCount = 1;
    rendering.pColorAttachments = &attachments[0];
    rendering.pDepthAttachment = &attachments[1];
    vkCmdBeginRendering(commands, &rendering);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, host->pipeline);
    vkCmdPushConstants(commands, host->layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0, 24 * sizeof(float), object);
    vkCmdDraw(commands, SPHERE_VERTICES, 1, 0, 0);
    vkCmdEndRendering(commands);
}

/* Submits the host's commands: they wait for one value of the timeline and signal the next. */
static void submit(const struct Host *host, VkCommandBuffer commands, uint64_t wait, uint64_t signal) {
    check_vk(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    VkSemaphoreSubmitInfo before = { .sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO };
    before.semaphore = host->timeline;
    before.value = wait;
    before.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    VkSemaphoreSubmitInfo after = before;
    after.value = signal;
    VkCommandBufferSubmitInfo buffer = { .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO };
    buffer.commandBuffer = commands;
    VkSubmitInfo2 info = { .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2 };
    info.waitSemaphoreInfoCount = info.commandBufferInfoCount = info.signalSemaphoreInfoCount = 1;
    info.pWaitSemaphoreInfos = &before;
    info.pCommandBufferInfos = &buffer;
    info.pSignalSemaphoreInfos = &after;
    check_vk(vkQueueSubmit2(host->queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
}

/* ---- Hair, between the host's passes ---- */

static void draw_hair(const struct Host *host, PelageContext context, const PelageFrame *frame, VkImage colour,
                      VkImage depth, uint64_t wait, uint64_t signal) {
    PelageVulkanImage images[2] = { PELAGE_VULKAN_IMAGE_INIT, PELAGE_VULKAN_IMAGE_INIT };
    for (int at = 0; at < 2; at++) {
        images[at].image = at ? depth : colour;
        images[at].format = at ? DEPTH : COLOUR;
        images[at].width = WIDTH;
        images[at].height = HEIGHT;
        /* It finds the images as the host's pass has left them, and leaves them as the next pass wants them. */
        images[at].layout_in = images[at].layout_out =
            at ? VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    }
    images[0].usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    images[1].usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    PelageVulkanView view = PELAGE_VULKAN_VIEW_INIT;
    view.frame = frame;
    view.colour = &images[0];
    view.depth = &images[1];
    view.flags = PELAGE_RENDER_WRITE_DEPTH | PELAGE_RENDER_RECEIVE_SHADOW;
    PelageVulkanSemaphore semaphores[2] = { PELAGE_VULKAN_SEMAPHORE_INIT, PELAGE_VULKAN_SEMAPHORE_INIT };
    for (int at = 0; at < 2; at++) {
        semaphores[at].kind = PELAGE_VULKAN_SEMAPHORE_TIMELINE;
        semaphores[at].semaphore = host->timeline;
        semaphores[at].value = at ? signal : wait;
    }
    PelageVulkanSubmit submission = PELAGE_VULKAN_SUBMIT_INIT;
    submission.views = &view;
    submission.waits = &semaphores[0];
    submission.signals = &semaphores[1];
    submission.view_count = submission.wait_count = submission.signal_count = 1;
    check(pelage_vulkan_render(context, &submission), "render");
}

/* ---- The picture ---- */

static float half(uint16_t bits) {
    int exponent = bits >> 10 & 31;
    float value = exponent ? ldexpf((float)((bits & 1023) | 1024), exponent - 25) : ldexpf((float)(bits & 1023), -24);
    return bits & 0x8000 ? -value : value;
}

static uint8_t srgb(float value) {
    double v = value < 0.0f ? 0.0 : value > 1.0f ? 1.0 : (double)value;
    v = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
    return (uint8_t)(255.0 * v + 0.5);
}

static void put32(uint8_t *out, uint32_t value) {
    for (int at = 0; at < 4; at++) {
        out[at] = (uint8_t)(value >> (24 - 8 * at));
    }
}

/* A chunk of a PNG file: `data` has room for its length and type before it and for its checksum after it. */
static void write_chunk(FILE *file, uint8_t *data, uint32_t size, const char *type) {
    uint32_t crc = 0xffffffffu;
    put32(data - 8, size);
    memcpy(data - 4, type, 4);
    for (uint8_t *at = data - 4; at < data + size; at++) {
        crc ^= *at;
        for (int bit = 0; bit < 8; bit++) {
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
        }
    }
    put32(data + size, ~crc);
    fwrite(data - 8, 1, size + 12, file);
}

/* Without compression: each row is one stored block of deflate. */
static void write_png(const char *path, const uint16_t *pixels) {
    enum { ROW = 1 + 3 * WIDTH, BLOCK = 5 + ROW, SIZE = 2 + HEIGHT * BLOCK + 4 };
    FILE *file = fopen(path, "wb");
    uint8_t *bytes = malloc(8 + SIZE + 4);
    if (!file || !bytes) {
        perror(path);
        exit(1);
    }
    fwrite("\x89PNG\r\n\x1a\n", 1, 8, file);
    uint8_t head[8 + 13 + 4] = { 0 };
    put32(head + 8, WIDTH);
    put32(head + 12, HEIGHT);
    head[16] = 8; /* bits a channel */
    head[17] = 2; /* RGB */
    write_chunk(file, head + 8, 13, "IHDR");
    uint8_t *out = bytes + 8;
    uint32_t a = 1, b = 0; /* Adler-32 */
    *out++ = 0x78;
    *out++ = 0x01;
    for (int y = 0; y < HEIGHT; y++) {
        *out++ = y == HEIGHT - 1;
        *out++ = ROW & 255;
        *out++ = ROW >> 8;
        *out++ = ~ROW & 255;
        *out++ = ~ROW >> 8 & 255;
        uint8_t *row = out;
        *out++ = 0; /* no filter */
        for (int x = 0; x < WIDTH; x++, pixels += 4) {
            for (int channel = 0; channel < 3; channel++) {
                *out++ = srgb(half(pixels[channel]));
            }
        }
        for (; row < out; row++) {
            a = (a + *row) % 65521;
            b = (b + a) % 65521;
        }
    }
    put32(out, b << 16 | a);
    write_chunk(file, bytes + 8, SIZE, "IDAT");
    write_chunk(file, head + 8, 0, "IEND");
    free(bytes);
    fclose(file);
}

int main(int argc, char **argv) {
    const char *path = argc > 1 ? argv[1] : "vulkan_host.png";
    uint64_t strands = argc > 2 ? strtoull(argv[2], NULL, 10) : PELAGE_BUILTIN_STRAND_COUNT;

    struct Host host = { 0 };
    PelageContext context = make_device(&host);
    PelageAdapter adapter = PELAGE_ADAPTER_INIT;
    check(pelage_context_adapter(context, &adapter), "adapter");
    printf("pelage %s on %s, %s\n", pelage_version(), adapter.name, adapter.driver);
    make_pipeline(&host);
    VkCommandPoolCreateInfo pool = { VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, NULL, VK_COMMAND_POOL_CREATE_TRANSIENT_BIT, host.family };
    check_vk(vkCreateCommandPool(host.device, &pool, NULL, &host.pool), "vkCreateCommandPool");
    VkSemaphoreTypeCreateInfo kind = { VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO, NULL, VK_SEMAPHORE_TYPE_TIMELINE, 0 };
    VkSemaphoreCreateInfo semaphore = { VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &kind, 0 };
    check_vk(vkCreateSemaphore(host.device, &semaphore, NULL, &host.timeline), "vkCreateSemaphore");
    struct Picture colour = make_picture(&host, COLOUR, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_ASPECT_COLOR_BIT);
    struct Picture depth = make_picture(&host, DEPTH, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);

    VkBufferCreateInfo room = { .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO };
    room.size = (VkDeviceSize)WIDTH * HEIGHT * 8;
    room.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    VkBuffer buffer;
    check_vk(vkCreateBuffer(host.device, &room, NULL, &buffer), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(host.device, buffer, &needs);
    VkDeviceMemory memory = allocate(&host, needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check_vk(vkBindBufferMemory(host.device, buffer, memory, 0), "vkBindBufferMemory");

    /* The hair, and a frame of it. */
    PelageHair hair;
    check(pelage_hair_create_builtin(context, PELAGE_BUILTIN_WAVY, strands, &hair), "hair");
    const double eye[3] = { 0.6, 0.15, -0.75 }, middle[3] = { 0.0, -0.06, 0.0 }, up[3] = { 0.0, 1.0, 0.0 };
    PelageView view = PELAGE_VIEW_INIT;
    check(pelage_view_perspective(eye, middle, up, 0.5, (double)WIDTH / HEIGHT, 0.1, 10.0, &view), "view");
    PelageLight sun = PELAGE_LIGHT_INIT;
    sun.direction[0] = -0.9;
    sun.direction[1] = -0.8;
    sun.direction[2] = 0.2;
    sun.power[0] = sun.power[1] = sun.power[2] = 3.0f;
    PelageFrame frame = PELAGE_FRAME_INIT;
    frame.hairs = &hair;
    frame.hair_count = 1;
    frame.lights = &sun;
    frame.light_count = 1;
    frame.ambient[0] = frame.ambient[1] = frame.ambient[2] = 0.05f;
    frame.view = &view;

    /* The host's objects, seen by the same view: a head, and a ball that stands half in the hair. */
    float head[24] = { 0 }, ball[24];
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 4; row++) {
            double sum = 0.0;
            for (int at = 0; at < 4; at++) {
                sum += view.clip_from_view[4 * at + row] * view.view_from_world[4 * column + at];
            }
            head[4 * column + row] = (float)sum;
        }
    }
    memcpy(ball, head, sizeof ball);
    const float head_sphere[7] = { 0.0f, 0.02f, 0.0f, 0.085f, 0.6f, 0.4f, 0.3f };
    const float ball_sphere[7] = { 0.03f, -0.07f, -0.08f, 0.05f, 0.1f, 0.25f, 0.6f };
    memcpy(head + 16, head_sphere, sizeof head_sphere);
    memcpy(ball + 16, ball_sphere, sizeof ball_sphere);

    /* Frames follow one another without the CPU waiting for any: three values of the timeline each. */
    for (uint64_t number = 0; number < FRAMES; number++) {
        uint64_t value = 3 * number;
        VkCommandBuffer before = begin(&host);
        barrier(before, colour.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        barrier(before, depth.image, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL);
        draw_sphere(&host, before, &colour, &depth, 1, head);
        submit(&host, before, value, value + 1);

        draw_hair(&host, context, &frame, colour.image, depth.image, value + 1, value + 2);

        VkCommandBuffer after = begin(&host);
        draw_sphere(&host, after, &colour, &depth, 0, ball);
        barrier(after, colour.image, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
        VkBufferImageCopy copy = { 0 };
        copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
        copy.imageSubresource.layerCount = 1;
        copy.imageExtent.width = WIDTH;
        copy.imageExtent.height = HEIGHT;
        copy.imageExtent.depth = 1;
        vkCmdCopyImageToBuffer(after, colour.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, buffer, 1, &copy);
        submit(&host, after, value + 2, value + 3);
    }
    const uint64_t last = 3 * FRAMES;
    VkSemaphoreWaitInfo done = { VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO, NULL, 0, 1, &host.timeline, &last };
    check_vk(vkWaitSemaphores(host.device, &done, UINT64_MAX), "vkWaitSemaphores");

    void *pixels;
    check_vk(vkMapMemory(host.device, memory, 0, VK_WHOLE_SIZE, 0, &pixels), "vkMapMemory");
    write_png(path, pixels);
    PelageStatistics statistics = PELAGE_STATISTICS_INIT;
    check(pelage_statistics(context, &statistics), "statistics");
    printf("%llu strands, %llu fragments, %.1f MB on the GPU\n", (unsigned long long)statistics.strands,
           (unsigned long long)statistics.fragments_produced, (double)statistics.bytes_total / 1e6);

    /* The context goes before the device, and takes nothing of the host's with it. */
    check(pelage_context_destroy(context), "destroy");
    vkDestroyBuffer(host.device, buffer, NULL);
    vkFreeMemory(host.device, memory, NULL);
    struct Picture pictures[2] = { colour, depth };
    for (int at = 0; at < 2; at++) {
        vkDestroyImageView(host.device, pictures[at].view, NULL);
        vkDestroyImage(host.device, pictures[at].image, NULL);
        vkFreeMemory(host.device, pictures[at].memory, NULL);
    }
    vkDestroySemaphore(host.device, host.timeline, NULL);
    vkDestroyCommandPool(host.device, host.pool, NULL);
    vkDestroyPipeline(host.device, host.pipeline, NULL);
    vkDestroyPipelineLayout(host.device, host.layout, NULL);
    vkDestroyDevice(host.device, NULL);
    vkDestroyInstance(host.instance, NULL);
    printf("wrote %s\n", path);
    return 0;
}
