/* Pictures on the host's device are those of the library's own. */
static float expected[SIDE * SIDE * 4], expected_depths[SIDE * SIDE];

/* The same scene on the host's device and on the library's own. */
static void compare(void) {
    PelageContextDescriptor descriptor = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    descriptor.force_software = 1;
    PelageContext own = { 0 }, context = open_context();
    OK(pelage_context_create(&descriptor, &own));
    const float slanted[8] = { 0.0f, 0.87f, 0.875f, 0.88f, 0.89f, 0.9f, 0.91f, 1.0f };
    for (int way = 0; way < 4; way++) {
        int reverse_z = way & 1, wide = way >> 1;
        float depths[8];
        for (int at = 0; at < 8; at++) {
            depths[at] = reverse_z ? 1.0f - slanted[at] : slanted[at];
        }
        struct Scene ours, theirs;
        make_scene(&ours, own, 1500, reverse_z);
        make_scene(&theirs, context, 1500, reverse_z);
        uint32_t flags = PELAGE_RENDER_WRITE_DEPTH | PELAGE_RENDER_RECEIVE_SHADOW;
        render_offscreen(own, &ours, wide ? PELAGE_FORMAT_RGBA32F : PELAGE_FORMAT_RGBA16F, depths, flags, expected, expected_depths);

        struct Texture colour = make_texture(wide ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R16G16B16A16_SFLOAT, SIDE, SIDE);
        struct Texture depth = make_texture(VK_FORMAT_D32_SFLOAT, SIDE, SIDE);
        VkCommandBuffer commands = begin();
        draw_scene(commands, &colour, &depth, depths);
        submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 0);
        PelageVulkanView view = view_of(&theirs, &colour, &depth, flags);
        OK(render(context, &view, 1));
        float furthest = 0.0f;
        int hair = 0;
        read_back(&colour, colour.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
        for (int at = 0; at < SIDE * SIDE * 4; at++) {
            float value = wide ? ((const float *)host.bytes)[at] : half(((const uint16_t *)host.bytes)[at]);
            furthest = fmaxf(furthest, fabsf(value - expected[at]));
            hair += at % 4 == 0 && fabsf(value - COLUMN[0] * (float)(at / 4 % SIDE / 8 % 2)) > 0.05f;
        }
        read_back(&depth, depth.image.layout_out, VK_IMAGE_ASPECT_DEPTH_BIT, VK_NULL_HANDLE);
        float furthest_depth = 0.0f;
        for (int at = 0; at < SIDE * SIDE; at++) {
            furthest_depth = fmaxf(furthest_depth, fabsf(((const float *)host.bytes)[at] - expected_depths[at]));
        }
        printf("%s%s: differs by %g, depth by %g, %d pixels of hair\n", wide ? "rgba32f" : "rgba16f", reverse_z ? ", reversed" : "",
               (double)furthest, (double)furthest_depth, hair);
        TRUE(furthest <= 1e-4f && furthest_depth <= 1e-4f && hair > 200);
        OK(pelage_hair_destroy(ours.hair));
        OK(pelage_hair_destroy(theirs.hair));
        OK(pelage_wait(context));
        destroy_texture(&colour);
        destroy_texture(&depth);
    }
    PelageStatistics statistics = PELAGE_STATISTICS_INIT;
    OK(pelage_statistics(context, &statistics));
    TRUE(statistics.fragments_stored > 0 && statistics.bytes_total > 0);
    OK(pelage_context_destroy(own));
    OK(pelage_context_destroy(context));
}

/* Fills an image with one value, and brings it into the layout that the library is told of. */
static void fill_image(struct Texture *texture, const VkClearColorValue *value) {
    VkCommandBuffer commands = begin();
    VkImageSubresourceRange range = { VK_IMAGE_ASPECT_COLOR_BIT, texture->image.mip_level, 1, texture->image.layer, 1 };
    move(commands, texture, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdClearColorImage(commands, texture->image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, value, 1, &range);
    move(commands, texture, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, texture->image.layout_in);
    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);
}

/* What an output's image holds at a pixel, as numbers, and by how much its format may round. */
static void decode_output(VkFormat format, const uint8_t *bytes, int at, double out[2], double *rounding) {
    uint32_t words[2];
    uint16_t halves[2];
    float floats[2];
    *rounding = 0.0;
    out[1] = 0.0;
    switch (format) {
    case VK_FORMAT_R32_SFLOAT:
        memcpy(floats, bytes + 4 * at, 4);
        out[0] = (double)floats[0];
        break;
    case VK_FORMAT_R32G32_SFLOAT:
        memcpy(floats, bytes + 8 * at, 8);
        out[0] = (double)floats[0];
        out[1] = (double)floats[1];
        break;
    case VK_FORMAT_R16_SFLOAT:
        memcpy(halves, bytes + 2 * at, 2);
        out[0] = (double)half(halves[0]);
        *rounding = 1.0 / 1024.0;
        break;
    case VK_FORMAT_R16G16_SFLOAT:
        memcpy(halves, bytes + 4 * at, 4);
        out[0] = (double)half(halves[0]);
        out[1] = (double)half(halves[1]);
        *rounding = 1.0 / 128.0; /* motion of up to sixteen pixels */
        break;
    case VK_FORMAT_R8_UNORM:
        out[0] = (double)bytes[at] / 255.0;
        *rounding = 0.51 / 255.0;
        break;
    default:
        memcpy(words, bytes + 8 * at, 8);
        out[0] = (double)words[0];
        out[1] = (double)words[1];
    }
}

enum { OUTPUTS = 4 };
static uint8_t own_outputs[OUTPUTS][SIDE * SIDE * 8];

/* Outputs beside the colour, of a hair that has moved, into the whole images and into a part of them. */
static void outputs(void) {
    static const VkFormat FORMATS[3][OUTPUTS] = {
        { VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32_UINT },
        { VK_FORMAT_R32_SFLOAT, VK_FORMAT_R16_SFLOAT, VK_FORMAT_R16G16_SFLOAT, VK_FORMAT_R32G32_UINT },
        { VK_FORMAT_R32_SFLOAT, VK_FORMAT_R8_UNORM, VK_FORMAT_UNDEFINED, VK_FORMAT_UNDEFINED },
    };
    static const VkImageLayout LAYOUTS[3] = { VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL };
    static const VkFormat OWN[OUTPUTS] = { VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32_UINT };
    static const uint32_t PART[4] = { 9, 5, 40, 48 };
    const double before[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.02, 0.01, 0, 1 };
    PelageContextDescriptor descriptor = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    descriptor.force_software = 1;
    PelageContext own = { 0 }, context = open_context();
    OK(pelage_context_create(&descriptor, &own));
    struct Scene ours, theirs;
    make_scene(&ours, own, 800, 0);
    make_scene(&theirs, context, 800, 0);
    OK(pelage_hair_set_previous_transform(ours.hair, before));
    OK(pelage_hair_set_previous_transform(theirs.hair, before));
    for (int way = 0; way < 3; way++) {
        if (way > 0) {
            memcpy(ours.view.rectangle, PART, sizeof PART);
            memcpy(theirs.view.rectangle, PART, sizeof PART);
        }
        PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
        PelageTarget target;
        image.width = image.height = SIDE;
        image.format = PELAGE_FORMAT_RGBA32F;
        image.outputs = PELAGE_OUTPUT_NEAREST_DEPTH | PELAGE_OUTPUT_COVERAGE | PELAGE_OUTPUT_MOTION | PELAGE_OUTPUT_IDS;
        OK(pelage_target_create(own, &image, &target));
        OK(pelage_render(own, &ours.frame, target, PELAGE_RENDER_CLEAR));
        OK(pelage_target_read_colour(target, expected, sizeof expected));
        for (int which = 0; which < OUTPUTS; which++) {
            OK(pelage_target_read_output(target, 1u << which, own_outputs[which], SIDE * SIDE * (which < 2 ? 4 : 8)));
        }
        OK(pelage_target_destroy(target));

        struct Texture colour = make_texture(VK_FORMAT_R32G32B32A32_SFLOAT, SIDE, SIDE), images[OUTPUTS];
        colour.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
        PelageVulkanView view = view_of(&theirs, &colour, NULL, PELAGE_RENDER_CLEAR);
        const PelageVulkanImage **fields[OUTPUTS] = { &view.nearest_depth, &view.coverage, &view.motion, &view.ids };
        for (int which = 0; which < OUTPUTS; which++) {
            if (!FORMATS[way][which]) {
                continue;
            }
            images[which] = make_texture(FORMATS[way][which], SIDE, SIDE);
            images[which].image.layout_in = LAYOUTS[way];
            images[which].image.layout_out = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
            VkClearColorValue value = { .float32 = { 0.75f, 0.75f, 0.75f, 0.75f } };
            if (which == 3) {
                value.uint32[0] = value.uint32[1] = 42;
            }
            if (LAYOUTS[way]) {
                fill_image(&images[which], &value);
            }
            *fields[which] = &images[which].image;
        }
        OK(render(context, &view, 1));
        int hair = 0, wrong = 0, moved = 0, kept = 0;
        read_back(&colour, colour.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
        for (int at = 0; at < SIDE * SIDE * 4; at++) {
            wrong += fabsf(((const float *)host.bytes)[at] - expected[at]) > 1e-4f;
        }
        for (int which = 0; which < OUTPUTS; which++) {
            if (!FORMATS[way][which]) {
                continue;
            }
            read_back(&images[which], images[which].image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
            for (int at = 0; at < SIDE * SIDE; at++) {
                uint32_t x = (uint32_t)(at % SIDE), y = (uint32_t)(at / SIDE);
                int inside = way == 0 || (x - PART[0] < PART[2] && y - PART[1] < PART[3]);
                double is[2], shall[2], rounding, none;
                decode_output(FORMATS[way][which], host.bytes, at, is, &rounding);
                decode_output(OWN[which], own_outputs[which], at, shall, &none);
                if (!inside) {
                    wrong += fabs(is[0] - (which == 3 ? 42.0 : 0.75)) > rounding;
                    kept++;
                    continue;
                }
                wrong += fabs(is[0] - shall[0]) > rounding + (which == 3 ? 0.0 : 1e-4) || fabs(is[1] - shall[1]) > rounding + (which == 3 ? 0.0 : 1e-4);
                hair += which == 1 && is[0] > 0.1;
                moved += which == 2 && fabs(is[0]) > 1.0;
            }
        }
        printf("outputs %d: %d values are wrong, %d pixels of hair, %d moved, %d kept\n", way, wrong, hair, moved, kept);
        TRUE(wrong == 0 && hair > 200 && (moved > 200 || way == 2) && (kept > 1000 || way == 0));
        OK(pelage_wait(context));
        destroy_texture(&colour);
        for (int which = 0; which < OUTPUTS; which++) {
            if (FORMATS[way][which]) {
                destroy_texture(&images[which]);
            }
        }
    }
    OK(pelage_context_destroy(own));
    OK(pelage_context_destroy(context));
}

/* A format's pixel, and how far rounding may take it. */
static void decode(VkFormat format, const uint8_t *at, float pixel[3], float *absolute, float *relative) {
    uint32_t word;
    memcpy(&word, at, 4);
    int bgra = format == VK_FORMAT_B8G8R8A8_UNORM || format == VK_FORMAT_B8G8R8A8_SRGB;
    *absolute = 0.51f / 255.0f;
    *relative = 0.0f;
    for (int channel = 0; channel < 3; channel++) {
        pixel[channel] = (float)at[bgra ? 2 - channel : channel] / 255.0f;
        if (format == VK_FORMAT_A2B10G10R10_UNORM_PACK32) {
            pixel[channel] = (float)(word >> 10 * channel & 1023) / 1023.0f;
            *absolute = 0.51f / 1023.0f;
        } else if (format == VK_FORMAT_B10G11R11_UFLOAT_PACK32) {
            /* As half floats without their sign and lowest bits; drivers may cut off instead of rounding. */
            pixel[channel] = half((uint16_t)(channel < 2 ? (word >> 11 * channel & 2047) << 4 : (word >> 22) << 5));
            *absolute = 1e-4f;
            *relative = 1.0f / 32.0f;
        } else if (format == VK_FORMAT_R16G16B16A16_SFLOAT) {
            uint16_t bits;
            memcpy(&bits, at + 2 * channel, 2);
            pixel[channel] = half(bits);
            *absolute = 1e-4f;
            *relative = 1e-3f;
        } else if (format == VK_FORMAT_R32G32B32A32_SFLOAT) {
            memcpy(&pixel[channel], at + 4 * channel, 4);
            *absolute = *relative = 1e-3f;
        }
    }
}

/* Every format, with layouts of many kinds and binary semaphores. */
static void formats(void) {
    static const VkFormat COLOURS[] = {
        VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_B10G11R11_UFLOAT_PACK32,
        VK_FORMAT_A2B10G10R10_UNORM_PACK32, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB,
        VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_B8G8R8A8_SRGB,
    };
    static const VkFormat DEPTHS[] = {
        VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM, VK_FORMAT_X8_D24_UNORM_PACK32, VK_FORMAT_D24_UNORM_S8_UINT, VK_FORMAT_D32_SFLOAT_S8_UINT,
    };
    static const VkImageLayout COLOUR_LAYOUTS[] = {
        VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL,
        VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL,
    };
    static const VkImageLayout DEPTH_LAYOUTS[] = {
        VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL,
        VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL,
    };
    /* The same in every format of depth. */
    const float depths[8] = { 0, 1, 1, 0, 1, 1, 1, 1 };
    PelageContextDescriptor descriptor = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    descriptor.force_software = 1;
    PelageContext own = { 0 }, context = open_context();
    OK(pelage_context_create(&descriptor, &own));
    struct Scene ours, theirs;
    make_scene(&ours, own, 400, 0);
    make_scene(&theirs, context, 400, 0);
    const uint32_t flags = PELAGE_RENDER_WRITE_DEPTH;
    render_offscreen(own, &ours, PELAGE_FORMAT_RGBA32F, depths, flags, expected, expected_depths);
    VkSemaphoreCreateInfo semaphore = { .sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO };
    VkSemaphore before, after;
    VK(vkCreateSemaphore(the_device, &semaphore, NULL, &before));
    VK(vkCreateSemaphore(the_device, &semaphore, NULL, &after));
    for (int number = 0; number < 8; number++) {
        VkFormat depth_format = DEPTHS[number % 5];
        VkFormatProperties can;
        vkGetPhysicalDeviceFormatProperties(host.physical, depth_format, &can);
        const VkFormatFeatureFlags needed = VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT;
        if ((can.optimalTilingFeatures & needed) != needed) {
            printf("no depth format %d\n", (int)depth_format);
            depth_format = VK_FORMAT_D32_SFLOAT;
        }
        struct Texture colour = make_texture(COLOURS[number], SIDE, SIDE), depth = make_texture(depth_format, SIDE, SIDE);
        colour.image.layout_in = COLOUR_LAYOUTS[number];
        colour.image.layout_out = COLOUR_LAYOUTS[(number + 3) % 8];
        depth.image.layout_in = DEPTH_LAYOUTS[number];
        depth.image.layout_out = DEPTH_LAYOUTS[(number + 5) % 8];
        VkCommandBuffer commands = begin();
        draw_scene(commands, &colour, &depth, depths);
        move(commands, &colour, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, colour.image.layout_in);
        move(commands, &depth, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, depth.image.layout_in);
        submit(commands, VK_NULL_HANDLE, before, 0);
        PelageVulkanView view = view_of(&theirs, &colour, &depth, flags);
        PelageVulkanSemaphore semaphores[2] = { PELAGE_VULKAN_SEMAPHORE_INIT, PELAGE_VULKAN_SEMAPHORE_INIT };
        semaphores[0].semaphore = before;
        semaphores[1].semaphore = after;
        PelageVulkanSubmit submission = PELAGE_VULKAN_SUBMIT_INIT;
        submission.views = &view;
        submission.waits = &semaphores[0];
        submission.signals = &semaphores[1];
        submission.view_count = submission.wait_count = submission.signal_count = 1;
        OK(pelage_vulkan_render(context, &submission));
        read_back(&colour, colour.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, after);
        read_back(&depth, depth.image.layout_out, VK_IMAGE_ASPECT_DEPTH_BIT, VK_NULL_HANDLE);
        read_back(&colour, colour.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
        int texel = number == 0 ? 8 : number == 1 ? 16 : 4, wrong = 0;
        int srgb = COLOURS[number] == VK_FORMAT_R8G8B8A8_SRGB || COLOURS[number] == VK_FORMAT_B8G8R8A8_SRGB;
        for (int at = 0; at < SIDE * SIDE; at++) {
            float pixel[3], absolute, relative;
            decode(COLOURS[number], (const uint8_t *)host.bytes + texel * at, pixel, &absolute, &relative);
            for (int channel = 0; channel < 3; channel++) {
                /* Blending over what has been rounded before rounds twice. */
                float value = expected[4 * at + channel];
                value = number < 3 ? value : fminf(value, 1.0f);
                value = srgb ? encoded(value) : value;
                wrong += fabsf(pixel[channel] - value) > 2.0f * absolute + relative * value + 1e-3f;
            }
        }
        printf("colour format %d over depth format %d: %d values are wrong\n", (int)COLOURS[number], (int)depth_format, wrong);
        TRUE(wrong == 0);
        OK(pelage_wait(context));
        destroy_texture(&colour);
        destroy_texture(&depth);
    }

    /* Several views at once are those of one at a time, whether into images of their own or one after another into one. */
    struct Texture left = make_texture(VK_FORMAT_R32G32B32A32_SFLOAT, SIDE, SIDE), right = left, depth = make_texture(VK_FORMAT_D32_SFLOAT, SIDE, SIDE);
    right = make_texture(VK_FORMAT_R32G32B32A32_SFLOAT, SIDE, SIDE);
    left.image.layout_in = right.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
    PelageVulkanView views[3] = { view_of(&theirs, &left, NULL, PELAGE_RENDER_CLEAR), view_of(&theirs, &right, NULL, PELAGE_RENDER_CLEAR), PELAGE_VULKAN_VIEW_INIT };
    views[2] = views[0];
    OK(render(context, views, 3));
    render_offscreen(own, &ours, PELAGE_FORMAT_RGBA32F, NULL, PELAGE_RENDER_CLEAR, expected, NULL);
    for (int eye = 0; eye < 2; eye++) {
        read_back(eye ? &right : &left, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
        float furthest = 0.0f;
        for (int at = 0; at < SIDE * SIDE * 4; at++) {
            furthest = fmaxf(furthest, fabsf(((const float *)host.bytes)[at] - expected[at]));
        }
        printf("view %d differs by %g\n", eye, (double)furthest);
        TRUE(furthest <= 1e-4f);
    }

    OK(pelage_wait(context));
    destroy_texture(&left);
    destroy_texture(&right);
    destroy_texture(&depth);
    vkDestroySemaphore(the_device, before, NULL);
    vkDestroySemaphore(the_device, after, NULL);
    OK(pelage_context_destroy(own));
    OK(pelage_context_destroy(context));
}
