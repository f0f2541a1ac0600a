/* The hair's colour over the image just read back, and how much of it is covered. */
static double light_of_hair(int *covered) {
    const float *pixels = (const float *)host.bytes;
    double sum = 0.0;
    *covered = 0;
    for (int at = 0; at < SIDE * SIDE; at++) {
        sum += (double)pixels[4 * at];
        *covered += pixels[4 * at + 3] > 0.5f;
    }
    return sum;
}

/* The hair's shadow on a wall as an image, and the host's own shadow map over the hair. */
static void shadows(void) {
    PelageContext context = open_context();
    struct Scene scene;
    make_scene(&scene, context, 800, 0);
    scene.frame.ambient[0] = scene.frame.ambient[1] = scene.frame.ambient[2] = 0.0f;
    struct Texture colour = make_texture(VK_FORMAT_R32G32B32A32_SFLOAT, SIDE, SIDE), depth = make_texture(VK_FORMAT_D32_SFLOAT, SIDE, SIDE);
    struct Texture image = make_texture(VK_FORMAT_R32_SFLOAT, SIDE, SIDE);
    float depths[SIDE / 8];
    for (int column = 0; column < SIDE / 8; column++) {
        depths[column] = 0.9f; /* amid the hair */
    }
    VkCommandBuffer commands = begin();
    draw_scene(commands, &colour, &depth, depths);
    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);

    PelageVulkanView view = view_of(&scene, &colour, &depth, PELAGE_RENDER_SHADOWS_ONLY);
    PelageVulkanShadowImage wanted = PELAGE_VULKAN_SHADOW_IMAGE_INIT;
    wanted.image = &image.image;
    image.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
    image.image.layout_out = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    view.shadow_images = &wanted;
    view.shadow_image_count = 1;
    OK(render(context, &view, 1));
    read_back(&image, image.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
    int dark = 0, wrong = 0;
    for (int at = 0; at < SIDE * SIDE; at++) {
        float value = ((const float *)host.bytes)[at];
        wrong += !(value >= 0.0f && value <= 1.0f);
        dark += value < 0.5f;
    }
    read_back(&colour, colour.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
    for (int at = 0; at < SIDE * SIDE; at++) {
        wrong += ((const float *)host.bytes)[4 * at] != COLUMN[0] * (float)(at % SIDE / 8 % 2);
    }
    printf("shadow image: %d values are wrong, %d pixels in shadow\n", wrong, dark);
    TRUE(wrong == 0 && dark > 50 && dark < SIDE * SIDE - 50);

    /* A map of which all lies before the hair, and one of which all lies behind it. */
    PelageVulkanOccluder occluder = PELAGE_VULKAN_OCCLUDER_INIT;
    double light[3];
    int covered[3];
    occluder.clip_from_world[10] = 0.5;
    occluder.clip_from_world[14] = 0.5;
    occluder.depth = &depth.image;
    for (int way = 0; way < 3; way++) {
        for (int column = 0; column < SIDE / 8; column++) {
            depths[column] = way == 1 ? 0.0f : 1.0f;
        }
        commands = begin();
        draw_scene(commands, &colour, &depth, depths);
        submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);
        view = view_of(&scene, &colour, NULL, PELAGE_RENDER_CLEAR);
        view.occluders = &occluder;
        view.occluder_count = way == 0 ? 0 : 1;
        OK(render(context, &view, 1));
        read_back(&colour, colour.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
        light[way] = light_of_hair(&covered[way]);
    }
    printf("occluder: light %g without, %g hidden, %g lit\n", light[0], light[1], light[2]);
    TRUE(light[0] > 10.0 && light[1] == 0.0 && light[2] == light[0]);
    TRUE(covered[0] > 200 && covered[1] == covered[0]);

    occluder.light = 1;
    REFUSED(PELAGE_INVALID_VALUE, "occluder 0: light 1 of a frame of 1 lights", render(context, &view, 1));
    occluder.light = 0;
    occluder.depth = NULL;
    REFUSED(PELAGE_INVALID_VALUE, "views[0]: occluders[0]: depth is NULL", render(context, &view, 1));
    occluder.depth = &image.image;
    REFUSED(PELAGE_INVALID_VALUE, "occluder: format R32_SFLOAT", render(context, &view, 1));
    OK(pelage_wait(context));
    destroy_texture(&colour);
    destroy_texture(&depth);
    destroy_texture(&image);
    OK(pelage_context_destroy(context));
}
