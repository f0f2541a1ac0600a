/* Frames in flight, locks, losses, and contexts that come and go. */
/* Eight frames are handed over without a wait, as if the GPU never ended one; the ninth waits, and all are drawn. */
static void backlog(void) {
    PelageContext context = open_context();
    struct Scene scene;
    make_scene(&scene, context, 60, 0);
    struct Texture colour = make_texture(VK_FORMAT_R16G16B16A16_SFLOAT, SIDE, SIDE);
    colour.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
    PelageVulkanView view = view_of(&scene, &colour, NULL, PELAGE_RENDER_CLEAR);
    OK(render(context, &view, 1));
    OK(pelage_wait(context));
    watch.waits = 0;
    slow = 1;
    for (int number = 0; number < 8; number++) {
        OK(render(context, &view, 1));
    }
    TRUE(watch.waits == 0);
    OK(render(context, &view, 1));
    TRUE(watch.waits == 1 && !slow);
    for (int number = 0; number < 20; number++) {
        OK(render(context, &view, 1));
    }
    OK(pelage_wait(context));
    OK(pelage_context_destroy(context));
    destroy_texture(&colour);
}

/* What may be left of a context that has drawn, and is gone. */
enum { MOST_KEPT_KIB = 1024 };

struct Rounds {
    int count;
    uint32_t largest; /* the side of the last image; 0 for no frame at all */
};

/* One context and all that is on it, time and again. */
static void *live_and_die(void *user) {
    const struct Rounds *rounds = user;
    for (int round = 0; round < rounds->count; round++) {
        PelageContext context = open_context();
        struct Scene scene;
        make_scene(&scene, context, 60, 0);
        for (uint32_t side = 16; side <= rounds->largest; side *= 2) {
            struct Texture colour = make_texture(VK_FORMAT_R16G16B16A16_SFLOAT, side, side), depth = make_texture(VK_FORMAT_D32_SFLOAT, side, side);
            colour.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
            PelageTransparency transparency = PELAGE_TRANSPARENCY_INIT;
            transparency.technique = side == 32 ? PELAGE_TRANSPARENCY_OPAQUE : PELAGE_TRANSPARENCY_A_BUFFER;
            scene.frame.transparency = &transparency;
            PelageVulkanView view = view_of(&scene, &colour, NULL, PELAGE_RENDER_CLEAR);
            OK(render(context, &view, 1));
            OK(pelage_wait(context));
            destroy_texture(&colour);
            destroy_texture(&depth);
        }
        PelageStatistics statistics = PELAGE_STATISTICS_INIT;
        OK(pelage_statistics(context, &statistics));
        TRUE(rounds->largest == 0 || statistics.bytes_total > 2 * 1024 * MOST_KEPT_KIB);
        OK(pelage_context_destroy(context));
    }
    return NULL;
}

static void on_two_threads(int count, uint32_t largest) {
    pthread_t threads[2];
    struct Rounds rounds = { count, largest };
    for (int at = 0; at < 2; at++) {
        pthread_create(&threads[at], NULL, live_and_die, &rounds);
    }
    pthread_join(threads[0], NULL);
    pthread_join(threads[1], NULL);
}

static void locks(void) {
    on_two_threads(2, SIDE);
    printf("%u submits and %u waits, %u without the lock; %u locks, %u unlocks\n", watch.submits, watch.idles, watch.unlocked_uses, watch.locks, watch.unlocks);
    TRUE(watch.submits >= 12 && watch.idles == 4 && watch.unlocked_uses == 0);
    TRUE(watch.locks == watch.unlocks && watch.locks >= 16);
    TRUE(watch.objects_taken == 0);
}

static void lost(void) {
    struct Texture colour = make_texture(VK_FORMAT_R16G16B16A16_SFLOAT, SIDE, SIDE);
    colour.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
    static const struct { VkResult result; PelageResult status; } ways[] = {
        { VK_ERROR_DEVICE_LOST, PELAGE_DEVICE_LOST }, { VK_ERROR_OUT_OF_DEVICE_MEMORY, PELAGE_OUT_OF_MEMORY },
    };
    for (int way = 0; way < 2; way++) {
        PelageContext context = open_context();
        struct Scene scene;
        make_scene(&scene, context, 60, 0);
        PelageVulkanView view = view_of(&scene, &colour, NULL, PELAGE_RENDER_CLEAR);
        OK(render(context, &view, 1));
        OK(pelage_wait(context)); /* a real loss leaves nothing running either */
        fail_submit = ways[way].result;
        REFUSED(ways[way].status, "", render(context, &view, 1));
        /* After a loss every wait tells of it. */
        fail_submit = ways[way].status == PELAGE_DEVICE_LOST ? ways[way].result : VK_SUCCESS;
        printf("%s\n", pelage_last_error());
        /* The context is dead, whatever is asked of it. */
        PelageStatistics statistics = PELAGE_STATISTICS_INIT;
        PelageHair hair;
        REFUSED(PELAGE_DEVICE_LOST, "lost", render(context, &view, 1));
        REFUSED(PELAGE_DEVICE_LOST, "lost", pelage_statistics(context, &statistics));
        REFUSED(PELAGE_DEVICE_LOST, "lost", pelage_hair_create_builtin(context, PELAGE_BUILTIN_WAVY, 10, &hair));
        REFUSED(PELAGE_DEVICE_LOST, "lost", pelage_wait(context));
        OK(pelage_hair_destroy(scene.hair));
        OK(pelage_context_destroy(context));
        fail_submit = VK_SUCCESS;
        VK(vkDeviceWaitIdle(the_device));
    }

    /* Memory that fails in the right place leaves the context alive. */
    PelageContext context = open_context();
    struct Scene scene;
    make_scene(&scene, context, 60, 0);
    PelageVulkanView view = view_of(&scene, &colour, NULL, PELAGE_RENDER_CLEAR);
    OK(render(context, &view, 1));
    PelageHair large = { 0 };
    fail_allocate = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    REFUSED(PELAGE_OUT_OF_MEMORY, "", pelage_hair_create_builtin(context, PELAGE_BUILTIN_WAVY, 100000, &large));
    printf("%s\n", pelage_last_error());
    fail_allocate = VK_SUCCESS;
    OK(render(context, &view, 1));
    OK(pelage_context_set_byte_budget(context, 1000));
    REFUSED(PELAGE_OUT_OF_MEMORY, "budget", pelage_hair_create_builtin(context, PELAGE_BUILTIN_WAVY, 1000, &large));
    OK(pelage_wait(context));
    OK(pelage_context_destroy(context));
    destroy_texture(&colour);
}

static long resident_kib(void) {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    long pages = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &pages, &resident) != 2) {
        exit(1);
    }
    fclose(file);
    return resident * 4;
}

/* How many KiB the process grows by with each of `count` contexts on each of two threads. */
static long growth(int count, uint32_t largest) {
    on_two_threads(count / 2, largest); /* fills the driver's own caches */
    long before = resident_kib();
    on_two_threads(count, largest);
    long after = resident_kib();
    printf("%d contexts on two threads, images up to %u: from %ld to %ld KiB\n", 2 * count, (unsigned)largest, before, after);
    return (after - before) / (2 * count);
}

static void stress(int rounds) {
    /* Without frames, there is nothing but what the library makes: next to nothing is left of each context. 0 to 15 KiB were
       measured; the ring of counters alone of a context that were kept has 128. */
    long bare = growth(rounds / 4, 0);
    /* lavapipe 22 keeps some 290 KiB of the pipelines of a context that is gone, on any device, and now and then 30 MB
       for itself; lavapipe 25 nothing. A context that were kept would be several times the bound. */
    long drawn = growth(rounds / 6, SIDE);
    TRUE(rounds < 100 || (bare < 64 && drawn < MOST_KEPT_KIB));
    TRUE(watch.unlocked_uses == 0);
}

/* A copy of what another copy writes, without a barrier between them. */
static void hazard(void) {
    struct Texture colour = make_texture(VK_FORMAT_R16G16B16A16_SFLOAT, SIDE, SIDE);
    VkCommandBuffer commands = begin();
    move(commands, &colour, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL);
    VkClearColorValue black = { { 0 } };
    VkImageSubresourceRange range = { VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1 };
    vkCmdClearColorImage(commands, colour.image.image, VK_IMAGE_LAYOUT_GENERAL, &black, 1, &range);
    VkBufferImageCopy copy = { 0 };
    copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    copy.imageSubresource.layerCount = 1;
    copy.imageExtent.width = copy.imageExtent.height = SIDE;
    copy.imageExtent.depth = 1;
    vkCmdCopyImageToBuffer(commands, colour.image.image, VK_IMAGE_LAYOUT_GENERAL, host.buffer, 1, &copy);
    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);
    destroy_texture(&colour);
}
