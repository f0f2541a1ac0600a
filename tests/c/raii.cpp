// pelage.hpp: ownership and errors, with exceptions and without. The last line says how many things were wrong.

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

    // Errors.
    fails([&] { return context.builtin(99, 5); }, PELAGE_INVALID_VALUE, "99");
    fails([&] { return target.write_depth({0.5f}); }, PELAGE_INVALID_VALUE, "4 bytes");
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
