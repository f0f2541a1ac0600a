/* Hair that moves on the GPU. */
enum { VERTEX = 20, BEFORE = 8, MOST_POINTS = 20000, GUIDES = 4, GUIDE_POINTS = 6 };

static struct Staging {
    VkBuffer buffers[3]; /* two to copy from, and the library's source */
    VkDeviceMemory memories[3];
    float *words[2];
    VkDeviceSize size;
} staging;

static void make_staging(void) {
    staging.size = BEFORE + (VkDeviceSize)MOST_POINTS * VERTEX;
    for (int at = 0; at < 3; at++) {
        VkBufferCreateInfo info = { .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO };
        info.size = staging.size;
        info.usage = at < 2 ? VK_BUFFER_USAGE_TRANSFER_SRC_BIT : VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
        VK(vkCreateBuffer(the_device, &info, NULL, &staging.buffers[at]));
        VkMemoryRequirements needs;
        vkGetBufferMemoryRequirements(the_device, staging.buffers[at], &needs);
        staging.memories[at] = allocate(needs, at < 2 ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        VK(vkBindBufferMemory(the_device, staging.buffers[at], staging.memories[at], 0));
        if (at < 2) {
            void *bytes;
            VK(vkMapMemory(the_device, staging.memories[at], 0, VK_WHOLE_SIZE, 0, &bytes));
            staging.words[at] = bytes;
        }
    }
    points_buffer = staging.buffers[2];
}

static void free_staging(void) {
    points_buffer = VK_NULL_HANDLE;
    for (int at = 0; at < 3; at++) {
        vkDestroyBuffer(the_device, staging.buffers[at], NULL);
        vkFreeMemory(the_device, staging.memories[at], NULL);
    }
}

/* Sends positions to the buffer, from one staging buffer or the other, without a wait or a semaphore. */
static PelageVulkanPoints send_points(const float *positions, int count, int which) {
    PelageVulkanPoints points = PELAGE_VULKAN_POINTS_INIT;
    points.buffer = staging.buffers[2];
    points.size = staging.size;
    points.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    points.offset = BEFORE;
    points.stride = VERTEX;
    for (int at = 0; at < count; at++) {
        for (int axis = 0; axis < 3; axis++) {
            float value = positions[3 * at + axis];
            staging.words[which][BEFORE / 4 + at * (VERTEX / 4) + axis] = value;
            points.low[axis] = at == 0 || (double)value < points.low[axis] ? (double)value : points.low[axis];
            points.high[axis] = at == 0 || (double)value > points.high[axis] ? (double)value : points.high[axis];
        }
    }
    VkCommandBuffer commands = begin();
    VkBufferCopy copy = { 0, 0, staging.size };
    vkCmdCopyBuffer(commands, staging.buffers[which], staging.buffers[2], 1, &copy);
    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 0);
    return points;
}

/* Guides at the corners of a square, or moved aside. */
static void place_guides(float *positions, float aside) {
    for (int at = 0; at < GUIDES * GUIDE_POINTS; at++) {
        int guide = at / GUIDE_POINTS, point = at % GUIDE_POINTS;
        float along = (float)point / (float)(GUIDE_POINTS - 1);
        positions[3 * at] = 0.2f * (float)(guide % 2) - 0.1f + aside * along * along;
        positions[3 * at + 1] = 0.1f - 0.25f * along;
        positions[3 * at + 2] = 0.2f * (float)(guide / 2) - 0.1f + 0.03f * along * (float)guide;
    }
}

static PelageHair make_guided(PelageContext context, int on_mesh) {
    float positions[GUIDES * GUIDE_POINTS * 3];
    const uint32_t counts[GUIDES] = { GUIDE_POINTS, GUIDE_POINTS, GUIDE_POINTS, GUIDE_POINTS };
    static const uint32_t TRIANGLES[6] = { 0, 1, 2, 1, 3, 2 };
    place_guides(positions, 0.0f);
    PelageStrands guides = PELAGE_STRANDS_INIT;
    guides.curve = PELAGE_CURVE_CATMULL_ROM;
    guides.positions = positions;
    guides.point_count = GUIDES * GUIDE_POINTS;
    guides.counts = counts;
    guides.strand_count = GUIDES;
    guides.root_radius = 0.001f;
    guides.tip_radius = 0.0005f;
    PelageHair hair = { 0 };
    if (on_mesh) {
        PelageInterpolationSettings settings = PELAGE_INTERPOLATION_SETTINGS_INIT;
        settings.triangles = TRIANGLES;
        settings.triangle_count = 2;
        settings.density = 10000.0f;
        OK(pelage_hair_create_guided_on_mesh(context, &guides, &settings, &hair));
    } else {
        PelageClumpSettings settings = PELAGE_CLUMP_SETTINGS_INIT;
        settings.followers = 100;
        settings.root_radius = 0.04f;
        OK(pelage_hair_create_guided_clumps(context, &guides, &settings, &hair));
    }
    return hair;
}

/* Compares the host's picture of a view with that of the library's own device, motion among it. */
static void compare_moving(const char *name, PelageContext own, const struct Scene *ours, PelageContext context, const struct Scene *theirs) {
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    PelageTarget target;
    image.width = image.height = SIDE;
    image.format = PELAGE_FORMAT_RGBA32F;
    image.outputs = PELAGE_OUTPUT_MOTION;
    OK(pelage_target_create(own, &image, &target));
    OK(pelage_render(own, &ours->frame, target, PELAGE_RENDER_CLEAR));
    OK(pelage_target_read_colour(target, expected, sizeof expected));
    OK(pelage_target_read_output(target, PELAGE_OUTPUT_MOTION, own_outputs[2], SIDE * SIDE * 8));
    OK(pelage_target_destroy(target));
    struct Texture colour = make_texture(VK_FORMAT_R32G32B32A32_SFLOAT, SIDE, SIDE), motion = make_texture(VK_FORMAT_R32G32_SFLOAT, SIDE, SIDE);
    colour.image.layout_in = motion.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
    PelageVulkanView view = view_of(theirs, &colour, NULL, PELAGE_RENDER_CLEAR);
    view.motion = &motion.image;
    OK(render(context, &view, 1));
    read_back(&colour, colour.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
    float furthest = 0.0f, fastest = 0.0f;
    int hair = 0, others = 0;
    for (int at = 0; at < SIDE * SIDE * 4; at++) {
        furthest = fmaxf(furthest, fabsf(((const float *)host.bytes)[at] - expected[at]));
        hair += at % 4 == 3 && expected[at] > 0.1f;
    }
    read_back(&motion, motion.image.layout_out, VK_IMAGE_ASPECT_COLOR_BIT, VK_NULL_HANDLE);
    for (int at = 0; at < SIDE * SIDE * 2; at++) {
        float mine;
        memcpy(&mine, own_outputs[2] + 4 * at, 4);
        others += fabsf(((const float *)host.bytes)[at] - mine) > 1e-2f;
        fastest = fmaxf(fastest, fabsf(mine));
    }
    printf("%s: differs by %g, %d motions, %d pixels of hair, up to %g px of motion\n", name, (double)furthest, others, hair, (double)fastest);
    /* Where two fibres are equally near either may tell its motion. */
    TRUE(furthest <= 1e-3f && others <= 8 && hair > 200 && fastest > 0.5f);
    destroy_texture(&colour);
    destroy_texture(&motion);
}

static void moving(void) {
    static float positions[2][MOST_POINTS * 3];
    PelageContextDescriptor descriptor = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    descriptor.force_software = 1;
    PelageContext own = { 0 }, context = open_context();
    OK(pelage_context_create(&descriptor, &own));
    make_staging();
    struct Scene ours, theirs;
    make_scene(&ours, own, 400, 0);
    make_scene(&theirs, context, 400, 0);
    PelageShadow none = PELAGE_SHADOW_INIT;
    none.technique = PELAGE_SHADOW_NONE;
    ours.light.shadow = theirs.light.shadow = &none;

    /* The strands' own points, twice in a row, each time with the buffer filled anew right before. */
    PelageHairInfo info = PELAGE_HAIR_INFO_INIT;
    OK(pelage_hair_info(theirs.hair, &info));
    int count = (int)info.point_count;
    TRUE(count > 1000 && count <= MOST_POINTS);
    for (int step = 0; step < 2; step++) {
        OK(pelage_hair_points(theirs.hair, positions[step], info.point_count * 12));
        for (int at = 0; at < count; at++) {
            positions[step][3 * at] += (0.2f * (float)step - 0.1f) * positions[step][3 * at + 1];
        }
        PelageVulkanPoints points = send_points(positions[step], count, step);
        OK(pelage_vulkan_update_points(theirs.hair, &points));
        REFUSED(PELAGE_CONFLICT, "still waiting for pelage_vulkan_render", pelage_hair_update_points(theirs.hair, positions[step], info.point_count));
        OK(pelage_hair_update_points(ours.hair, positions[step], info.point_count));
        compare_moving("points", own, &ours, context, &theirs);
    }
    /* A submission of no views takes an update too; the CPU's comes after it. */
    PelageVulkanPoints points = send_points(positions[0], count, 0);
    OK(pelage_vulkan_update_points(theirs.hair, &points));
    OK(render(context, NULL, 0));
    OK(pelage_hair_update_points(theirs.hair, positions[1], info.point_count));
    OK(pelage_hair_update_points(ours.hair, positions[0], info.point_count));
    OK(pelage_hair_update_points(ours.hair, positions[1], info.point_count));
    compare_moving("points of the CPU after them", own, &ours, context, &theirs);

    /* A buffer that comes from another family, and goes back to it. */
    other_family = VK_QUEUE_FAMILY_EXTERNAL;
    points = send_points(positions[0], count, 0);
    OK(pelage_wait(context));
    VkCommandBuffer commands = begin();
    VkBufferMemoryBarrier away = { .sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER, .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT };
    away.srcQueueFamilyIndex = 0;
    away.dstQueueFamilyIndex = other_family;
    away.buffer = points.buffer;
    away.size = VK_WHOLE_SIZE;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 1, &away, 0, NULL);
    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);
    points.owner_before = points.owner_after = other_family;
    watch.acquired = watch.released = watch.misplaced = 0;
    OK(pelage_vulkan_update_points(theirs.hair, &points));
    OK(pelage_hair_update_points(ours.hair, positions[0], info.point_count));
    compare_moving("points of another family", own, &ours, context, &theirs);
    TRUE(watch.acquired == 1 && watch.released == 1 && watch.misplaced == 0);
    commands = begin();
    away.srcQueueFamilyIndex = other_family;
    away.dstQueueFamilyIndex = 0;
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 1, &away, 0, NULL);
    submit(commands, VK_NULL_HANDLE, VK_NULL_HANDLE, 1);

    /* Updates without a submission: so many of a hair, and the others are none of its business. */
    enum { MOST_WAITING = 16 };
    points.owner_before = points.owner_after = PELAGE_VULKAN_QUEUE_FAMILY_IGNORED;
    struct Scene others;
    make_scene(&others, context, 100, 0);
    PelageHairInfo few = PELAGE_HAIR_INFO_INIT;
    OK(pelage_hair_info(others.hair, &few));
    OK(pelage_hair_points(others.hair, positions[1], few.point_count * 12));
    for (int round = 0; round < 2; round++) {
        for (int number = 0; number < MOST_WAITING; number++) {
            OK(pelage_vulkan_update_points(theirs.hair, &points));
            OK(pelage_hair_update_points(others.hair, positions[1], few.point_count));
        }
        REFUSED(PELAGE_CONFLICT, "16 updates of the hair wait", pelage_vulkan_update_points(theirs.hair, &points));
        REFUSED(PELAGE_CONFLICT, "16 updates of the hair wait", pelage_hair_update_points(others.hair, positions[1], few.point_count));
        OK(render(context, NULL, 0));
    }
    OK(pelage_hair_destroy(others.hair));

    /* Guides, from a buffer and from the CPU. */
    PelageHair plain[2] = { ours.hair, theirs.hair };
    for (int on_mesh = 0; on_mesh < 2; on_mesh++) {
        OK(pelage_wait(context));
        ours.hair = make_guided(own, on_mesh);
        theirs.hair = make_guided(context, on_mesh);
        for (int step = 0; step < 3; step++) {
            place_guides(positions[step % 2], 0.05f - 0.07f * (float)step);
            if (step == 2) {
                OK(pelage_hair_update_guides(theirs.hair, positions[0], GUIDES * GUIDE_POINTS));
            } else {
                points = send_points(positions[step], GUIDES * GUIDE_POINTS, step);
                OK(pelage_vulkan_update_guides(theirs.hair, &points));
            }
            OK(pelage_hair_update_guides(ours.hair, positions[step % 2], GUIDES * GUIDE_POINTS));
            compare_moving(on_mesh ? "guides on a mesh" : "guides of clumps", own, &ours, context, &theirs);
        }
        /* What fails leaves the update for the next submission. */
        OK(pelage_wait(context));
        place_guides(positions[0], 0.08f);
        points = send_points(positions[0], GUIDES * GUIDE_POINTS, 0);
        OK(pelage_vulkan_update_guides(theirs.hair, &points));
        PelageVulkanView broken = PELAGE_VULKAN_VIEW_INIT;
        REFUSED(PELAGE_INVALID_VALUE, "frame is NULL", render(context, &broken, 1));
        OK(pelage_hair_update_guides(ours.hair, positions[0], GUIDES * GUIDE_POINTS));
        compare_moving("after a refusal", own, &ours, context, &theirs);
        /* A destroyed hair's update is harmless. */
        OK(pelage_vulkan_update_guides(theirs.hair, &points));
        OK(pelage_hair_destroy(theirs.hair));
        OK(render(context, NULL, 0));
    }

    /* Rubbish is drawn without harm. */
    theirs.hair = plain[1];
    for (int at = 0; at < count * 3; at++) {
        positions[0][at] = at % 3 ? (float)NAN : (float)INFINITY;
    }
    OK(pelage_wait(context));
    points = send_points(positions[0], count, 0);
    points.low[0] = points.low[1] = points.low[2] = -1.0;
    points.high[0] = points.high[1] = points.high[2] = 1.0;
    OK(pelage_vulkan_update_points(theirs.hair, &points));
    struct Texture colour = make_texture(VK_FORMAT_R16G16B16A16_SFLOAT, SIDE, SIDE);
    colour.image.layout_in = VK_IMAGE_LAYOUT_UNDEFINED;
    PelageVulkanView view = view_of(&theirs, &colour, NULL, PELAGE_RENDER_CLEAR);
    OK(render(context, &view, 1));
    OK(pelage_wait(context));

    /* What is wrong is named, and nothing is done. */
#define WRONG_POINTS(status, words, change)                                            \
    do {                                                                               \
        PelageVulkanPoints wrong = points;                                             \
        PelageHair hair = theirs.hair;                                                 \
        change;                                                                        \
        REFUSED(status, words, pelage_vulkan_update_points(hair, &wrong));             \
    } while (0)
    WRONG_POINTS(PELAGE_INVALID_VALUE, "the buffer is NULL", wrong.buffer = VK_NULL_HANDLE);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "lacks VK_BUFFER_USAGE_STORAGE_BUFFER_BIT", wrong.usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "size 0", wrong.size = 0);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "size 3", wrong.size = 3);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "the buffer has 1000", wrong.size = 1003);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "offset 6", wrong.offset = 6);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "stride 8", wrong.stride = 8);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "make no box", wrong.low[1] = 2.0);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "make no box", wrong.high[2] = (double)NAN);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "struct_size 7", wrong.struct_size = 7);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "the buffer: owner_before 3 is not below 1", wrong.owner_before = 3);
    WRONG_POINTS(PELAGE_INVALID_VALUE, "the buffer: owner_after 1 is not below 1", wrong.owner_after = 1);
    WRONG_POINTS(PELAGE_UNSUPPORTED, "a device of its own", hair = plain[0]);
    WRONG_POINTS(PELAGE_INVALID_HANDLE, "NULL", hair.id = 0);
    REFUSED(PELAGE_INVALID_VALUE, "points is NULL", pelage_vulkan_update_points(theirs.hair, NULL));
    REFUSED(PELAGE_INVALID_VALUE, "the hair has no guides", pelage_vulkan_update_guides(theirs.hair, &points));
    REFUSED(PELAGE_INVALID_VALUE, "the hair has no guides", pelage_hair_update_guides(theirs.hair, positions[1], 3));
    REFUSED(PELAGE_INVALID_VALUE, "24 points", pelage_hair_update_guides(ours.hair, positions[1], 3));
    REFUSED(PELAGE_INVALID_VALUE, "positions is NULL", pelage_hair_update_guides(ours.hair, NULL, 24));

    /* A context may end with an update that no submission has taken. */
    OK(pelage_vulkan_update_points(theirs.hair, &points));
    OK(pelage_context_destroy(context));
    OK(pelage_context_destroy(own));
    TRUE(watch.objects_taken == 0);
    destroy_texture(&colour);
    free_staging();
}
