// pelage.hpp: ownership and errors, with exceptions and without. The last line says how many things were wrong.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <type_traits>

#include "pelage.hpp"

static int failures = 0;

static void expect(bool holds, const char *what) {
    if (!holds) {
        std::printf("wrong: %s (%s)\n", what, pelage_last_error());
        failures++;
    }
}

template <class T> constexpr bool moved_not_copied =
    std::is_nothrow_move_constructible_v<T> && std::is_nothrow_move_assignable_v<T> &&
    !std::is_copy_constructible_v<T> && !std::is_copy_assignable_v<T>;
static_assert(moved_not_copied<pelage::Context>, "contexts");
static_assert(moved_not_copied<pelage::Hair>, "hairs");
static_assert(moved_not_copied<pelage::Target>, "targets");
static_assert(moved_not_copied<pelage::Readback>, "readbacks");

// The value of a call that must work, in both ways.
#if PELAGE_HPP_EXCEPTIONS
template <class T> static T value(T outcome) { return outcome; }
template <class Call> static void fails(Call &&call, PelageResult code, const char *words) {
    try {
        call();
        expect(false, "a call that must fail");
    } catch (const pelage::Error &error) {
        expect(error.code() == code && std::strstr(error.what(), words), words);
    }
}
static void done() {}
#define DONE(call) (call, done())
#else
template <class T> static T value(pelage::Outcome<T> outcome) {
    expect(bool(outcome), "a call that must work");
    return std::move(*outcome);
}
template <class Call> static void fails(Call &&call, PelageResult code, const char *words) {
    const auto outcome = call();
    expect(!outcome && outcome.code() == code && outcome.sentence().find(words) != std::string::npos, words);
}
#define DONE(call) expect(bool(call), #call)
#endif

static bool alive(PelageHair hair) {
    PelageHairInfo info = PELAGE_HAIR_INFO_INIT;
    return pelage_hair_info(hair, &info) == PELAGE_OK;
}

// What a view from `distance` along z shows of a hair.
struct Shown {
    std::vector<float> nearest_depth, coverage, motion;
    std::vector<uint32_t> ids;
    std::size_t count = 0;       // pixels with hair
    float fastest = 0.0f;        // the largest motion to the right
    uint32_t instances = 0;      // the highest number of a copy, and one
};

constexpr uint32_t SIDE = 32;

static Shown show(const pelage::Context &context, const pelage::Hair &hair, double distance) {
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    image.width = image.height = SIDE;
    image.outputs = PELAGE_OUTPUT_NEAREST_DEPTH | PELAGE_OUTPUT_COVERAGE | PELAGE_OUTPUT_MOTION | PELAGE_OUTPUT_IDS;
    auto target = value(context.target(image));
    const double eye[] = {0.0, 0.0, distance}, middle[] = {0.0, 0.0, 0.0}, up[] = {0.0, 1.0, 0.0};
    const PelageView view = value(pelage::perspective(eye, middle, up, 0.8, 1.0, 0.1, 10.0));
    const PelageHair drawn = hair.get();
    PelageFrame frame = PELAGE_FRAME_INIT;
    frame.hairs = &drawn;
    frame.hair_count = 1;
    frame.view = &view;
    DONE(context.render(frame, target));
    Shown shown;
    shown.nearest_depth = value(target.read_nearest_depth());
    shown.coverage = value(target.read_coverage());
    shown.motion = value(target.read_motion());
    shown.ids = value(target.read_ids());
    expect(shown.coverage.size() == SIDE * SIDE && shown.ids.size() == 2 * SIDE * SIDE, "outputs' sizes");
    for (std::size_t at = 0; at < SIDE * SIDE; at++) {
        const bool hit = shown.ids[2 * at + 1] != PELAGE_NO_STRAND;
        expect(hit == (shown.nearest_depth[at] < 1.0f) && (hit || shown.coverage[at] == 0.0f), "outputs that agree");
        if (hit) {
            shown.count++;
            shown.fastest = std::max(shown.fastest, shown.motion[2 * at]);
            shown.instances = std::max(shown.instances, (shown.ids[2 * at] >> 16) + 1);
        }
    }
    return shown;
}

// Points, guides, transforms and copies, seen in the outputs.
static void outputs_of_what_moves(const pelage::Context &context) {
    const float positions[] = {-0.5f, -0.5f, 0.0f, -0.5f, 0.5f, 0.0f};
    const uint32_t counts[] = {2};
    PelageStrands strands = PELAGE_STRANDS_INIT;
    strands.positions = positions;
    strands.point_count = 2;
    strands.counts = counts;
    strands.strand_count = 1;
    strands.root_radius = strands.tip_radius = 0.05f;
    auto hair = value(context.strands(strands));
    const Shown still = show(context, hair, 3.0);
    expect(still.count > 10 && still.fastest == 0.0f && still.instances == 1, "hair at rest");

    // 0.25 to the right, at a distance of 3 with half a height of tan 0.4.
    const float pixels = 0.25f / (3.0f * 0.4228f) * SIDE / 2.0f;
    auto points = value(hair.points());
    expect(points == std::vector<float>(positions, positions + 6), "a hair's points");
    points[0] += 0.25f;
    points[3] += 0.25f;
    DONE(hair.update_points(points));
    expect(std::abs(show(context, hair, 3.0).fastest - pixels) < 0.05f, "points that moved");
    DONE(hair.rest());
    expect(show(context, hair, 3.0).fastest == 0.0f, "points at rest");

    pelage::Matrix there = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, before = there;
    before[12] = -0.25;
    DONE(hair.set_previous_transform(before.data()));
    expect(std::abs(show(context, hair, 3.0).fastest - pixels) < 0.05f, "a transform that changed");
    DONE(hair.set_previous_transform(nullptr));
    pelage::Matrix aside = there;
    aside[12] = 0.5;
    DONE(hair.set_instances({{there, there}, {aside, there}}));
    const Shown copies = show(context, hair, 3.0);
    expect(copies.instances == 2 && copies.count > 3 * still.count / 2, "two copies");
    expect(std::abs(copies.fastest - 2.0f * pixels) < 0.1f, "a copy that moved");
    DONE(hair.set_instances({}));
    expect(show(context, hair, 3.0).instances == 1, "no copies");

    // Guides.
    PelageClumpSettings clumps = PELAGE_CLUMP_SETTINGS_INIT;
    clumps.followers = 20;
    clumps.root_radius = 0.1f;
    auto guided = value(context.guided_clumps(strands, clumps));
    expect(show(context, guided, 3.0).fastest == 0.0f, "guided hair at rest");
    DONE(guided.update_guides(points));
    expect(std::abs(show(context, guided, 3.0).fastest - pixels) < 0.2f, "guides that moved");
    fails([&] { return hair.update_guides(points); }, PELAGE_INVALID_VALUE, "no guides");
    fails([&] { return hair.update_points(PelageVulkanPoints(PELAGE_VULKAN_POINTS_INIT)); }, PELAGE_UNSUPPORTED, "own");
}

int main() {
    PelageContextDescriptor device = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    device.force_software = 1;
    auto context = value(pelage::Context::offscreen(device));
    expect(bool(context) && value(context.adapter()).software == 1, "a software context");

    // A hair lives as long as its object, and moves with it.
    PelageHair raw{0};
    {
        auto hair = value(context.builtin(PELAGE_BUILTIN_STRAIGHT, 50));
        raw = hair.get();
        pelage::Hair other = std::move(hair);
        expect(!hair && other.get().id == raw.id && alive(raw), "a moved hair");
        expect(value(other.info()).strand_count == 50, "a hair's strands");
        auto second = value(context.builtin(PELAGE_BUILTIN_STRAIGHT, 20));
        const PelageHair replaced = second.get();
        second = std::move(other);
        expect(!alive(replaced) && alive(raw), "an assigned hair destroys the one before");
        pelage::Hair &same = second;
        second = std::move(same);
        expect(alive(raw), "a hair assigned to itself stays");
    }
    expect(!alive(raw), "a hair destroyed with its object");
    {
        auto kept = value(context.builtin(PELAGE_BUILTIN_STRAIGHT, 50));
        raw = kept.release();
    }
    expect(alive(raw), "a released hair");
    pelage_hair_destroy(raw);

    // Pictures there and back.
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    image.width = 8;
    image.height = 4;
    image.format = PELAGE_FORMAT_RGBA32F;
    image.with_depth = 1;
    auto target = value(context.target(image));
    std::vector<float> colours(8 * 4 * 4), depths(8 * 4);
    for (std::size_t at = 0; at < colours.size(); at++) {
        colours[at] = 0.25f * static_cast<float>(at);
        depths[at / 4] = static_cast<float>(at) / 128.0f;
    }
    DONE(target.write_colour(colours));
    DONE(target.write_depth(depths));
    expect(value(target.read_colour()) == colours, "a target's colour");
    expect(value(target.read_depth()) == depths, "a target's depth");
    auto readback = value(target.begin_read_colour());
    DONE(context.wait());
    expect(value(readback.arrived()), "a readback arrives");
    std::vector<float> copied(colours.size());
    DONE(readback.copy(copied.data(), copied.size()));
    expect(copied == colours, "a readback's colour");

    outputs_of_what_moves(context);

    // Errors.
    fails([&] { return context.builtin(99, 5); }, PELAGE_INVALID_VALUE, "99");
    fails([&] { return target.write_depth({0.5f}); }, PELAGE_INVALID_VALUE, "4 bytes");
    fails([&] { return target.read_motion(); }, PELAGE_INVALID_VALUE, "motion");
    fails([&] { return context.window_info(); }, PELAGE_UNSUPPORTED, "no window");
    fails([&] { return pelage::check(pelage_wait(PelageContext{0})); }, PELAGE_INVALID_HANDLE, "NULL");
    const double here[] = {0, 0, 0};
    fails([&] { return pelage::perspective(here, here, here, 1, 1, 1, 2); }, PELAGE_INVALID_VALUE, "make no view");

    // What outlives its context does nothing.
    auto late = value(context.builtin(PELAGE_BUILTIN_STRAIGHT, 50));
    context.reset();
    expect(!context, "a context that was reset");
    late.reset();
    std::printf("%d failures\n", failures);
    return failures != 0;
}
