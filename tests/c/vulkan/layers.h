/* Layers and mip levels of the host's images, and images and buffers that change hands between families of queues. */

enum { EYES = 2, IMAGES = 5 };

/* Colour, depth, nearest depth, coverage and ids of one eye. */
struct Eye {
    struct Scene scene;
    struct Texture images[IMAGES];
};

static const VkFormat EYE_FORMATS[IMAGES] = {
    VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_D32_SFLOAT, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32_UINT,
};
static uint8_t eyes_alone[EYES][IMAGES][MOST_BYTES];

static size_t eye_bytes(int which) {
    return (size_t)(SIDE * SIDE) * (which == 0 ? 16 : which == IMAGES - 1 ? 8 : 4);
}

/* A depth that hides a part of the hair, other for each eye. */
static void fill_depth(struct Texture *depth, int eye) {
    VkCommandBuffer commands = begin();
    const VkClearDepthStencilValue value = { eye ? 0.908f : 0.905f, 0 };
    const VkImageSubresourceRange range = { VK_IMAGE_ASPECT_DEPTH_BIT, depth->image.mip_level, 1, depth->image.layer, 1 };
    move(commands, depth, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdClearDepthStencilImage(commands, depth->image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &value, 1, &range);
    move(commands, depth, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, depth->image.layout_in);
    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);
}

static void make_eyes(struct Eye *eyes, PelageContext context) {
    for (int eye = 0; eye < EYES; eye++) {
        make_scene(&eyes[eye].scene, context, 600, 0);
        const double from[3] = { 0.6 + 0.08 * eye, 0.15, -0.75 }, middle[3] = { 0.0, -0.06, 0.0 }, up[3] = { 0.0, 1.0, 0.0 };
        OK(pelage_view_perspective(from, middle, up, 0.5, 1.0, 0.1, 10.0, &eyes[eye].scene.view));
    }
}

static PelageVulkanView view_of_eye(const struct Eye *eye) {
    PelageVulkanView view = view_of(&eye->scene, &eye->images[0], &eye->images[1], PELAGE_RENDER_CLEAR | PELAGE_RENDER_WRITE_DEPTH);
    view.nearest_depth = &eye->images[2].image;
    view.coverage = &eye->images[3].image;
    view.ids = &eye->images[4].image;
    return view;
}

/* Draws both eyes in one submission; how many bytes differ from the pictures kept, or from then on are kept. */
static int draw_eyes(PelageContext context, const struct Eye *eyes, int keep) {
    PelageVulkanView views[EYES] = { PELAGE_VULKAN_VIEW_INIT, PELAGE_VULKAN_VIEW_INIT };
    for (int eye = 0; eye < EYES; eye++) {
        struct Texture depth = eyes[eye].images[1];
        fill_depth(&depth, eye);
        views[eye] = view_of_eye(&eyes[eye]);
    }
    OK(render(context, views, EYES));
    int differ = 0;
    for (int eye = 0; eye < EYES; eye++) {
        for (int which = 0; which < IMAGES; which++) {
            struct Texture image = eyes[eye].images[which];
            read_back(&image, image.image.layout_out, image.aspect, VK_NULL_HANDLE);
            uint8_t *kept = eyes_alone[eye][which];
            if (keep) {
                memcpy(kept, host.bytes, eye_bytes(which));
            }
            for (size_t at = 0; at < eye_bytes(which); at++) {
                differ += kept[at] != ((const uint8_t *)host.bytes)[at];
            }
        }
    }
    return differ;
}

/* Two layers of each image, at a mip level of their own, as both eyes of one submission. */
static void layers(void) {
    PelageContext context = open_context();
    struct Eye eyes[EYES];
    make_eyes(eyes, context);
    for (int eye = 0; eye < EYES; eye++) {
        for (int which = 0; which < IMAGES; which++) {
            eyes[eye].images[which] = make_texture(EYE_FORMATS[which], SIDE, SIDE);
            eyes[eye].images[which].image.layout_in = which == 1 ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED;
        }
    }
    draw_eyes(context, eyes, 1);
    int hair = 0, apart = memcmp(eyes_alone[0][0], eyes_alone[1][0], eye_bytes(0)) != 0;
    for (int at = 0; at < SIDE * SIDE; at++) {
        float covered[EYES];
        memcpy(&covered[0], &eyes_alone[0][3][4 * at], 4);
        memcpy(&covered[1], &eyes_alone[1][3][4 * at], 4);
        hair += covered[0] > 0.1f && covered[1] > 0.1f;
    }
    for (int eye = 0; eye < EYES; eye++) {
        for (int which = 0; which < IMAGES; which++) {
            destroy_texture(&eyes[eye].images[which]);
        }
    }

    /* Colour and depth at mip level 1; nearest depth and coverage are layers of one image. */
    struct Texture colour = make_array(EYE_FORMATS[0], 2 * SIDE, 2 * SIDE, 3, 2), depth = make_array(EYE_FORMATS[1], 2 * SIDE + 1, 2 * SIDE + 1, 2, 3);
    struct Texture scalars = make_array(EYE_FORMATS[2], SIDE, SIDE, 4, 1), ids = make_array(EYE_FORMATS[4], 4 * SIDE, 4 * SIDE, 2, 4);
    for (int eye = 0; eye < EYES; eye++) {
        struct Texture *images = eyes[eye].images;
        images[0] = colour;
        images[0].image.layer = eye ? 2 : 0;
        images[1] = depth;
        images[1].image.layer = eye ? 0 : 1;
        images[2] = images[3] = scalars;
        images[2].image.layer = eye ? 2 : 0;
        images[3].image.layer = eye ? 3 : 1;
        images[4] = ids;
        images[4].image.layer = (uint32_t)eye;
        images[0].image.mip_level = images[1].image.mip_level = 1;
        images[4].image.mip_level = 2;
        for (int which = 0; which < IMAGES; which++) {
            images[which].image.layout_in = which == 1 ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED;
        }
    }
    /* All other parts of the colour are the host's own, in a layout of its own. */
    const VkClearColorValue own = { { 0.75f, 0.75f, 0.75f, 0.75f } };
    colour.image.layout_in = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    for (uint32_t part = 0; part < 6; part++) {
        colour.image.layer = part / 2;
        colour.image.mip_level = part % 2;
        if (part % 2 == 0 || part / 2 == 1) {
            fill_image(&colour, &own);
        }
    }
    int differ = draw_eyes(context, eyes, 0), touched = 0;
    for (uint32_t part = 0; part < 6; part++) {
        colour.image.layer = part / 2;
        colour.image.mip_level = part % 2;
        if (part % 2 == 0 || part / 2 == 1) {
            read_back(&colour, colour.image.layout_in, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
            for (int at = 0; at < SIDE * SIDE * 4; at++) {
                touched += ((const float *)host.bytes)[at] != 0.75f;
            }
        }
    }
    printf("layers: %d bytes differ, %d of other parts, %d pixels of hair\n", differ, touched, hair);
    TRUE(differ == 0 && touched == 0 && hair > 200 && apart);

    OK(pelage_wait(context));
    OK(pelage_context_destroy(context));
    destroy_texture(&colour);
    destroy_texture(&depth);
    destroy_texture(&scalars);
    destroy_texture(&ids);
}

/* The host's half of a transfer: away from its queue's family, or back. */
static void give(VkCommandBuffer commands, const struct Texture *texture, VkImageLayout layout, int back) {
    VkImageMemoryBarrier barrier = { .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER };
    barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    barrier.oldLayout = barrier.newLayout = layout;
    barrier.srcQueueFamilyIndex = back ? other_family : 0;
    barrier.dstQueueFamilyIndex = back ? 0 : other_family;
    if (fake.second_family) {
        barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    }
    barrier.image = texture->image.image;
    barrier.subresourceRange.aspectMask = texture->aspect;
    barrier.subresourceRange.levelCount = barrier.subresourceRange.layerCount = 1;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
}

/* Images that come from another family and go back to it: outside of this Vulkan, and one that the driver does not have, of
   which it is not told. */
static void owners(void) {
    static const VkFormat FORMATS[3] = { VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_D32_SFLOAT, VK_FORMAT_R32_SFLOAT };
    for (int second = 0; second < 2; second++) {
        fake.second_family = second;
        other_family = second ? 1 : VK_QUEUE_FAMILY_EXTERNAL;
        PelageContext context = open_context();
        struct Scene scene;
        make_scene(&scene, context, 600, 0);
        static uint8_t alone[3][MOST_BYTES];
        int differ = 0;
        for (int way = 0; way < 3; way++) { /* nothing changes hands; all; as if it did, with the family that it has */
            struct Texture images[3];
            for (int which = 0; which < 3; which++) {
                struct Texture *image = &images[which];
                *image = make_texture(FORMATS[which], SIDE, SIDE);
                image->image.layout_in = which == 1 ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_GENERAL;
                image->image.layout_out = which == 1 ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
                const VkClearColorValue grey = { { 0.25f, 0.25f, 0.25f, 1.0f } };
                if (which == 1) {
                    fill_depth(image, 0);
                } else {
                    fill_image(image, &grey);
                }
                if (way == 1) {
                    VkCommandBuffer commands = begin();
                    give(commands, image, (VkImageLayout)image->image.layout_in, 0);
                    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);
                    image->image.owner_before = image->image.owner_after = other_family;
                } else if (way == 2) {
                    image->image.owner_before = image->image.owner_after = 0;
                }
            }
            watch.acquired = watch.released = watch.misplaced = 0;
            PelageVulkanView view = view_of(&scene, &images[0], &images[1], PELAGE_RENDER_WRITE_DEPTH);
            view.coverage = &images[2].image;
            OK(render(context, &view, 1));
            printf("%u acquired, %u released\n", watch.acquired, watch.released);
            TRUE(watch.acquired == (way == 1 ? 3 : 0) && watch.released == watch.acquired && watch.misplaced == 0);
            for (int which = 0; which < 3; which++) {
                struct Texture *image = &images[which];
                if (way == 1) {
                    VkCommandBuffer commands = begin();
                    give(commands, image, (VkImageLayout)image->image.layout_out, 1);
                    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);
                }
                read_back(image, image->image.layout_out, image->aspect, VK_NULL_HANDLE);
                size_t bytes = (size_t)(SIDE * SIDE) * (which == 0 ? 8 : 4);
                if (way == 0) {
                    memcpy(alone[which], host.bytes, bytes);
                }
                differ += memcmp(alone[which], host.bytes, bytes) != 0;
                destroy_texture(image);
            }
        }
        TRUE(differ == 0);
        OK(pelage_context_destroy(context));
    }
    memset(&fake, 0, sizeof fake);
}
