/*
 * Renders a built-in hairstyle into a PPM picture, by pelage.h and the C library alone.
 *
 *     cc examples/c/offscreen.c -Iinclude -Ltarget/release -lpelage -lm -o offscreen
 *     ./offscreen [picture.ppm [strands]]
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "pelage.h"

enum { WIDTH = 480, HEIGHT = 640 };

/* Every call says whether it worked; the library has the sentence. */
static void check(PelageResult result, const char *what) {
    if (result != PELAGE_OK) {
        fprintf(stderr, "%s: %s\n", what, pelage_last_error());
        exit(1);
    }
}

static void print_message(uint32_t level, const char *message, void *user) {
    fprintf((FILE *)user, "pelage (level %u): %s\n", (unsigned)level, message);
}

/* A linear value as a byte of the sRGB curve. */
static int srgb(float value) {
    double v = value < 0.0f ? 0.0 : value > 1.0f ? 1.0 : (double)value;
    v = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
    return (int)(255.0 * v + 0.5);
}

/* Premultiplied hair over a grey wall. */
static void write_ppm(const char *path, const float *pixels) {
    FILE *file = fopen(path, "wb");
    if (!file) {
        perror(path);
        exit(1);
    }
    fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    for (size_t at = 0; at < (size_t)WIDTH * HEIGHT; at++) {
        const float *pixel = pixels + 4 * at;
        for (int channel = 0; channel < 3; channel++) {
            fputc(srgb(pixel[channel] + (1.0f - pixel[3]) * 0.18f), file);
        }
    }
    fclose(file);
}

int main(int argc, char **argv) {
    const char *path = argc > 1 ? argv[1] : "offscreen.ppm";
    uint64_t strands = argc > 2 ? strtoull(argv[2], NULL, 10) : PELAGE_BUILTIN_STRAND_COUNT;
    check(pelage_set_log_callback(PELAGE_LOG_WARN, print_message, stderr), "log");

    PelageContext context;
    PelageContextDescriptor device = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    check(pelage_context_create(&device, &context), "context");
    PelageAdapter adapter = PELAGE_ADAPTER_INIT;
    check(pelage_context_adapter(context, &adapter), "adapter");
    printf("pelage %s on %s, %s\n", pelage_version(), adapter.name, adapter.driver);

    PelageHair hair;
    check(pelage_hair_create_builtin(context, PELAGE_BUILTIN_WAVY, strands, &hair), "hair");

    PelageTarget target;
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    image.width = WIDTH;
    image.height = HEIGHT;
    check(pelage_target_create(context, &image, &target), "target");

    /* The head's origin lies between the ears; it looks along +z, in metres. */
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
    check(pelage_render(context, &frame, target, PELAGE_RENDER_CLEAR), "render");

    const size_t size = (size_t)WIDTH * HEIGHT * 4 * sizeof(float);
    float *pixels = malloc(size);
    check(pelage_target_read_colour(target, pixels, size), "read");
    write_ppm(path, pixels);
    free(pixels);

    PelageStatistics statistics = PELAGE_STATISTICS_INIT;
    check(pelage_statistics(context, &statistics), "statistics");
    printf("%llu strands, %llu segments, %llu fragments of which %llu stored and %llu merged, %.1f MB on the GPU\n",
           (unsigned long long)statistics.strands, (unsigned long long)statistics.segments,
           (unsigned long long)statistics.fragments_produced, (unsigned long long)statistics.fragments_stored,
           (unsigned long long)statistics.fragments_merged, (double)statistics.bytes_total / 1e6);

    check(pelage_context_destroy(context), "destroy"); /* and with it the hair and the target */
    printf("wrote %s\n", path);
    return 0;
}
