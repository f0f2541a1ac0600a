/*
 * A context with a device of its own, under a driver that fails when it is told to, by tests/c/vulkan_shim.c. The argument is
 * what to do:
 *
 *     lost        the device is lost in a call of each kind
 *     memory      memory fails where that is harmless, and where it is not
 *     updates     hair that moves without being drawn takes no memory
 */
#define _POSIX_C_SOURCE 200112L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelage.h"

#define DEVICE_LOST "-4"
#define OUT_OF_DEVICE_MEMORY "-2"

enum { SIDE = 16 };

static int failures = 0;

static void expect(int line, const char *what, PelageResult wanted, PelageResult result) {
    if (result != wanted) {
        printf("line %d: %s: %u: %s\n", line, what, (unsigned)result, result ? pelage_last_error() : "no error");
        failures++;
    }
}

#define OK(call) expect(__LINE__, #call, PELAGE_OK, (call))
#define FAILS(status, call) expect(__LINE__, #call, (status), (call))

/* All that a context has, in a struct that points to itself. */
struct Scene {
    PelageContext context;
    PelageHair hair;
    PelageTarget target;
    PelageLight light;
    PelageView view;
    PelageFrame frame;
};

static float pixels[SIDE * SIDE * 4];

static void make_scene(struct Scene *scene, uint64_t strands) {
    const double eye[3] = { 0.6, 0.15, -0.75 }, middle[3] = { 0.0, -0.06, 0.0 }, up[3] = { 0.0, 1.0, 0.0 };
    PelageContextDescriptor device = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    device.force_software = 1;
    OK(pelage_context_create(&device, &scene->context));
    OK(pelage_hair_create_builtin(scene->context, PELAGE_BUILTIN_STRAIGHT, strands, &scene->hair));
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    image.width = image.height = SIDE;
    OK(pelage_target_create(scene->context, &image, &scene->target));
    const PelageLight light = PELAGE_LIGHT_INIT;
    const PelageView view = PELAGE_VIEW_INIT;
    const PelageFrame frame = PELAGE_FRAME_INIT;
    scene->light = light;
    scene->view = view;
    scene->frame = frame;
    OK(pelage_view_perspective(eye, middle, up, 0.5, 1.0, 0.1, 10.0, &scene->view));
    scene->frame.hairs = &scene->hair;
    scene->frame.lights = &scene->light;
    scene->frame.hair_count = scene->frame.light_count = 1;
    scene->frame.view = &scene->view;
}

static PelageResult draw(const struct Scene *scene) {
    return pelage_render(scene->context, &scene->frame, scene->target, PELAGE_RENDER_CLEAR);
}

/* Whatever is asked of a dead context is refused, and what is on it can be destroyed. */
static void bury(const struct Scene *scene) {
    PelageStatistics statistics = PELAGE_STATISTICS_INIT;
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    PelageHair hair;
    PelageTarget target;
    PelageReadback readback;
    float positions[3] = { 0.0f, 0.0f, 0.0f };
    image.width = image.height = SIDE;
    FAILS(PELAGE_DEVICE_LOST, draw(scene));
    FAILS(PELAGE_DEVICE_LOST, pelage_render_timed(scene->context, &scene->frame, scene->target, PELAGE_RENDER_CLEAR));
    FAILS(PELAGE_DEVICE_LOST, pelage_statistics(scene->context, &statistics));
    FAILS(PELAGE_DEVICE_LOST, pelage_hair_create_builtin(scene->context, PELAGE_BUILTIN_WAVY, 10, &hair));
    FAILS(PELAGE_DEVICE_LOST, pelage_hair_update_points(scene->hair, positions, 1));
    FAILS(PELAGE_DEVICE_LOST, pelage_target_create(scene->context, &image, &target));
    FAILS(PELAGE_DEVICE_LOST, pelage_target_write_colour(scene->target, pixels, sizeof pixels));
    FAILS(PELAGE_DEVICE_LOST, pelage_target_read_colour(scene->target, pixels, sizeof pixels));
    FAILS(PELAGE_DEVICE_LOST, pelage_readback_begin_colour(scene->target, &readback));
    FAILS(PELAGE_DEVICE_LOST, pelage_wait(scene->context));
    OK(pelage_hair_set_opacity(scene->hair, 0.5f));
    OK(pelage_hair_destroy(scene->hair));
    OK(pelage_target_destroy(scene->target));
    OK(pelage_context_destroy(scene->context));
}

static void lost(void) {
    for (int way = 0; way < 4; way++) {
        struct Scene scene;
        PelageReadback readback = { 0 };
        PelageHairInfo info = PELAGE_HAIR_INFO_INIT;
        make_scene(&scene, 50);
        OK(draw(&scene));
        OK(pelage_target_read_colour(scene.target, pixels, sizeof pixels));
        OK(pelage_hair_info(scene.hair, &info));
        float *positions = malloc(info.point_count * 12);
        OK(pelage_hair_points(scene.hair, positions, info.point_count * 12));
        setenv("SHIM_SUBMIT", DEVICE_LOST, 1);
        switch (way) {
        case 0:
            FAILS(PELAGE_DEVICE_LOST, draw(&scene));
            break;
        case 1:
            FAILS(PELAGE_DEVICE_LOST, pelage_target_read_colour(scene.target, pixels, sizeof pixels));
            break;
        case 2:
            FAILS(PELAGE_DEVICE_LOST, pelage_hair_update_points(scene.hair, positions, info.point_count));
            break;
        default:
            FAILS(PELAGE_DEVICE_LOST, pelage_readback_begin_colour(scene.target, &readback));
        }
        printf("%s\n", pelage_last_error());
        bury(&scene);
        free(positions);
        unsetenv("SHIM_SUBMIT");
    }
    /* Another context on the same driver is none of theirs. */
    struct Scene scene;
    make_scene(&scene, 50);
    OK(draw(&scene));
    OK(pelage_context_destroy(scene.context));
}

static void memory(void) {
    struct Scene scene;
    make_scene(&scene, 50);
    OK(draw(&scene));
    /* A hair that finds no room is not made, and all the rest is as it was. */
    PelageHair large = { 0 };
    setenv("SHIM_ALLOCATE", OUT_OF_DEVICE_MEMORY, 1);
    FAILS(PELAGE_OUT_OF_MEMORY, pelage_hair_create_builtin(scene.context, PELAGE_BUILTIN_WAVY, 100000, &large));
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    PelageTarget target;
    image.width = image.height = 8192;
    FAILS(PELAGE_OUT_OF_MEMORY, pelage_target_create(scene.context, &image, &target));
    unsetenv("SHIM_ALLOCATE");
    OK(draw(&scene));
    OK(pelage_target_read_colour(scene.target, pixels, sizeof pixels));
    OK(pelage_wait(scene.context));
    /* A submission that finds none ends the device. */
    setenv("SHIM_SUBMIT", OUT_OF_DEVICE_MEMORY, 1);
    FAILS(PELAGE_OUT_OF_MEMORY, draw(&scene));
    bury(&scene);
    unsetenv("SHIM_SUBMIT");
}

static long resident_kib(void) {
    long pages = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &pages, &resident) != 2) {
        exit(1);
    }
    fclose(file);
    return resident * 4;
}

static void updates(void) {
    enum { UPDATES = 100 };
    struct Scene scene;
    make_scene(&scene, 3000);
    OK(draw(&scene));
    PelageHairInfo info = PELAGE_HAIR_INFO_INIT;
    OK(pelage_hair_info(scene.hair, &info));
    float *positions = malloc(info.point_count * 12);
    OK(pelage_hair_points(scene.hair, positions, info.point_count * 12));
    /* Each uploads 16 bytes a point. */
    long each = (long)(info.point_count * 16 / 1024), before = 0;
    for (int number = 0; number < UPDATES + 20; number++) {
        if (number == 20) {
            OK(pelage_wait(scene.context));
            before = resident_kib();
        }
        OK(pelage_hair_update_points(scene.hair, positions, info.point_count));
    }
    OK(pelage_wait(scene.context));
    long grown = resident_kib() - before;
    printf("%d updates of %ld KiB: %ld KiB more\n", UPDATES, each, grown);
    if (grown > UPDATES * each / 4) {
        printf("they are kept\n");
        failures++;
    }
    free(positions);
    OK(pelage_context_destroy(scene.context));
}

int main(int argc, char **argv) {
    const char *what = argc > 1 ? argv[1] : "";
    if (strcmp(what, "lost") == 0) {
        lost();
    } else if (strcmp(what, "memory") == 0) {
        memory();
    } else if (strcmp(what, "updates") == 0) {
        updates();
    } else {
        failures++;
    }
    printf("%d failures\n", failures);
    return failures != 0;
}
