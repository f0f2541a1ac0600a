/*
 * Makes and destroys everything, wrongly and rightly, so that a checker (valgrind, a sanitizer) finds what leaks.
 * Also: the log callback, which may call the library, and what only a process of its own can show.
 *
 * Arguments: rounds (2), and a second one for the validation layer (which itself leaks).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelage.h"

static int failures = 0;

#define EXPECT(wanted, call)                                                                             \
    do {                                                                                                 \
        PelageResult result_ = (call);                                                                   \
        if (result_ != (wanted)) {                                                                       \
            printf("line %d: %s gave %u: %s\n", __LINE__, #call, (unsigned)result_, pelage_last_error()); \
            failures++;                                                                                  \
        }                                                                                                \
    } while (0)

#define EXPECT_TRUE(condition)                                \
    do {                                                      \
        if (!(condition)) {                                   \
            printf("line %d: not %s\n", __LINE__, #condition); \
            failures++;                                       \
        }                                                     \
    } while (0)

enum { SIDE = 48 };

struct Log {
    PelageContext context;
    unsigned messages;
    unsigned merged;
    PelageResult set_within;
};

/* Calls the library from within: the last error, the context that has just logged, and the one call that is refused. */
static void on_log(uint32_t level, const char *message, void *user) {
    struct Log *log = user;
    PelageStatistics statistics = PELAGE_STATISTICS_INIT;
    log->messages++;
    log->merged += level == PELAGE_LOG_WARN && strstr(message, "merged") != NULL;
    EXPECT_TRUE(pelage_last_error() != NULL);
    EXPECT(PELAGE_OK, pelage_statistics(log->context, &statistics));
    log->set_within = pelage_set_log_callback(PELAGE_LOG_OFF, NULL, NULL);
}

/* Nothing here may be a fault of the library. */
static void on_error(uint32_t level, const char *message, void *user) {
    (void)user;
    printf("log, level %u: %s\n", (unsigned)level, message);
    failures++;
}

static PelageView view_of_z(void) {
    const double eye[3] = { 0, 0, 3 }, target[3] = { 0, 0, 0 }, up[3] = { 0, 1, 0 };
    PelageView view = PELAGE_VIEW_INIT;
    EXPECT(PELAGE_OK, pelage_view_perspective(eye, target, up, 0.9, 1.0, 0.1, 10.0, &view));
    return view;
}

static PelageHair strands_in(PelageContext context) {
    static const float positions[] = { -1, -1, 0, 0, 0.2f, 0, 1, 1, 0, 1, -1, 0.1f, -1, 1, 0.1f };
    static const uint32_t counts[] = { 3, 2 };
    PelageStrands strands = PELAGE_STRANDS_INIT;
    PelageStatistics before = PELAGE_STATISTICS_INIT, after = PELAGE_STATISTICS_INIT;
    uint64_t bytes = 0;
    PelageHair hair = { 0 };
    strands.positions = positions;
    strands.point_count = 5;
    strands.counts = counts;
    strands.strand_count = 2;
    strands.root_radius = strands.tip_radius = 0.1f;
    EXPECT(PELAGE_OK, pelage_hair_memory_estimate(context, &strands, &bytes));
    EXPECT(PELAGE_OK, pelage_statistics(context, &before));
    EXPECT(PELAGE_OK, pelage_hair_create_from_strands(context, &strands, &hair));
    EXPECT(PELAGE_OK, pelage_statistics(context, &after));
    EXPECT_TRUE(after.bytes_total - before.bytes_total == bytes);
    return hair;
}

/* One of everything, rendered, read both ways. */
static void use(PelageContext context, int destroy_each) {
    PelageHair hair = strands_in(context);
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    PelageTarget target;
    PelageReadback readback;
    PelageView view = view_of_z();
    PelageLight light = PELAGE_LIGHT_INIT;
    PelageFrame frame = PELAGE_FRAME_INIT;
    float *pixels = malloc(sizeof(float) * 4 * SIDE * SIDE), *again = malloc(sizeof(float) * 4 * SIDE * SIDE);
    uint32_t arrived = 0;

    image.width = image.height = SIDE;
    image.with_depth = 1;
    EXPECT(PELAGE_OK, pelage_target_create(context, &image, &target));
    frame.hairs = &hair;
    frame.hair_count = 1;
    frame.lights = &light;
    frame.light_count = 1;
    frame.view = &view;
    for (int at = 0; at < SIDE * SIDE; at++) {
        again[at] = 1.0f;
    }
    EXPECT(PELAGE_OK, pelage_target_write_depth(target, again, sizeof(float) * SIDE * SIDE));
    EXPECT(PELAGE_OK, pelage_render(context, &frame, target, PELAGE_RENDER_CLEAR | PELAGE_RENDER_WRITE_DEPTH));
    EXPECT(PELAGE_OK, pelage_render_timed(context, &frame, target, PELAGE_RENDER_RECEIVE_SHADOW));
    EXPECT(PELAGE_OK, pelage_readback_begin_colour(target, &readback));
    while (!arrived) {
        EXPECT(PELAGE_OK, pelage_readback_poll(readback, &arrived));
    }
    EXPECT(PELAGE_OK, pelage_readback_copy(readback, pixels, sizeof(float) * 4 * SIDE * SIDE));
    EXPECT(PELAGE_OK, pelage_target_read_colour(target, again, sizeof(float) * 4 * SIDE * SIDE));
    EXPECT_TRUE(memcmp(pixels, again, sizeof(float) * 4 * SIDE * SIDE) == 0);
    EXPECT_TRUE(pixels[4 * (SIDE * SIDE / 2 + SIDE / 2) + 3] > 0.5f);
    if (destroy_each) {
        EXPECT(PELAGE_OK, pelage_readback_destroy(readback));
        EXPECT(PELAGE_OK, pelage_target_destroy(target));
        EXPECT(PELAGE_OK, pelage_hair_destroy(hair));
        EXPECT(PELAGE_INVALID_HANDLE, pelage_hair_destroy(hair));
        EXPECT(PELAGE_INVALID_HANDLE, pelage_target_destroy(target));
        EXPECT(PELAGE_INVALID_HANDLE, pelage_readback_destroy(readback));
        EXPECT(PELAGE_INVALID_HANDLE, pelage_render(context, &frame, target, 0));
    }
    free(pixels);
    free(again);
}

static void misuse(PelageContext context) {
    const float nan_position[3] = { NAN, 0, 0 };
    const uint32_t one = 1;
    PelageStrands strands = PELAGE_STRANDS_INIT;
    PelageFile file = PELAGE_FILE_INIT;
    PelageHair hair = { 77 }, null = { 0 };
    uint64_t bytes = 7;
    for (uint32_t at = 0; at < 100; at++) {
        strands.positions = nan_position;
        strands.point_count = strands.strand_count = 1;
        strands.counts = &one;
        EXPECT(PELAGE_INVALID_VALUE, pelage_hair_create_from_strands(context, &strands, &hair));
        EXPECT(PELAGE_INVALID_VALUE, pelage_hair_memory_estimate(context, &strands, &bytes));
        strands.point_count = UINT64_MAX / 2;
        EXPECT(PELAGE_INVALID_VALUE, pelage_hair_create_from_strands(context, &strands, &hair));
        file.bytes = "HAIRHAIRHAIR";
        file.size = at % 13;
        EXPECT(PELAGE_INVALID_FILE, pelage_hair_create_from_file(context, &file, &hair));
        EXPECT(PELAGE_INVALID_HANDLE, pelage_hair_set_opacity(null, 1.0f));
        EXPECT_TRUE(hair.id == 77 && bytes == 7);
        EXPECT_TRUE(strlen(pelage_last_error()) > 0);
    }
}

/* A fragment pool for one fragment: what is merged is said in the log. */
static void listen(PelageContext context) {
    struct Log log = { context, 0, 0, PELAGE_OK };
    PelageHair hair = strands_in(context);
    PelageDbkBuffer small = PELAGE_DBK_BUFFER_INIT;
    PelageTransparency transparency = PELAGE_TRANSPARENCY_INIT;
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    PelageTarget target;
    PelageView view = view_of_z();
    PelageFrame frame = PELAGE_FRAME_INIT;
    PelageStatistics statistics = PELAGE_STATISTICS_INIT;
    PelageMemoryEstimate estimate = PELAGE_MEMORY_ESTIMATE_INIT;
    unsigned before;

    small.pool_bytes = 16;
    transparency.dbk_buffer = &small;
    image.width = image.height = SIDE;
    frame.hairs = &hair;
    frame.hair_count = 1;
    frame.view = &view;
    frame.transparency = &transparency;
    EXPECT(PELAGE_INVALID_VALUE, pelage_set_log_callback(6, on_log, &log));
    EXPECT(PELAGE_OK, pelage_set_log_callback(PELAGE_LOG_WARN, on_log, &log));
    EXPECT(PELAGE_OK, pelage_target_create(context, &image, &target));
    EXPECT(PELAGE_OK, pelage_frame_memory_estimate(context, &frame, &image, PELAGE_RENDER_CLEAR, &estimate));
    EXPECT(PELAGE_OK, pelage_render(context, &frame, target, PELAGE_RENDER_CLEAR));
    EXPECT(PELAGE_OK, pelage_wait(context));
    EXPECT(PELAGE_OK, pelage_statistics(context, &statistics));
    EXPECT_TRUE(statistics.bytes_total == estimate.bytes_total);
    EXPECT_TRUE(statistics.fragments_merged > 0);
    EXPECT_TRUE(log.merged > 0);
    EXPECT_TRUE(log.set_within == PELAGE_INVALID_VALUE);
    EXPECT(PELAGE_OK, pelage_set_log_callback(PELAGE_LOG_ERROR, on_error, NULL));
    before = log.messages;
    EXPECT(PELAGE_OK, pelage_render(context, &frame, target, PELAGE_RENDER_CLEAR));
    EXPECT(PELAGE_OK, pelage_wait(context));
    EXPECT(PELAGE_OK, pelage_statistics(context, &statistics));
    EXPECT_TRUE(log.messages == before);
}

int main(int argc, char **argv) {
    int rounds = argc > 1 ? atoi(argv[1]) : 2;
    EXPECT_TRUE(pelage_abi_version() == PELAGE_ABI_VERSION);
    for (int round = 0; round < rounds; round++) {
        PelageContextDescriptor descriptor = PELAGE_CONTEXT_DESCRIPTOR_INIT;
        PelageContext context;
        descriptor.force_software = 1;
        descriptor.validation = argc > 2;
        EXPECT(PELAGE_OK, pelage_set_log_callback(PELAGE_LOG_ERROR, on_error, NULL));
        EXPECT(PELAGE_OK, pelage_context_create(&descriptor, &context));
        misuse(context);
        use(context, 1);
        use(context, 0);
        listen(context);
        EXPECT(PELAGE_OK, pelage_context_destroy(context));
        EXPECT(PELAGE_INVALID_HANDLE, pelage_context_destroy(context));
        EXPECT(PELAGE_INVALID_HANDLE, pelage_wait(context));
    }
    EXPECT(PELAGE_OK, pelage_set_log_callback(PELAGE_LOG_OFF, NULL, NULL));
    printf("%d failures\n", failures);
    return failures != 0;
}
