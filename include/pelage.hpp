/*
 * pelage for C++17: contexts, hairs, targets and readbacks as classes that are moved and not copied, and that destroy what
 * they hold. It is nothing but pelage.h: every class gives its C handle by get(), so that all functions of that header can be
 * called beside it, with pelage::check() around them.
 *
 * ERRORS     A call that fails throws pelage::Error, whose what() is the library's sentence. Where exceptions are off
 *            (-fno-exceptions), or PELAGE_HPP_NO_EXCEPTIONS is defined, calls return a pelage::Outcome instead, which is
 *            false after a failure and holds code and sentence; otherwise * and -> give its value.
 * LIFETIME   A context takes all that was made on it along. Hairs, targets and readbacks that are destroyed after it do
 *            nothing.
 * THREADS    As in pelage.h: any call from any thread. An object is moved or destroyed by one thread at a time.
 */
#ifndef PELAGE_HPP
#define PELAGE_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "pelage.h"

#if (defined(__cpp_exceptions) || defined(_CPPUNWIND)) && !defined(PELAGE_HPP_NO_EXCEPTIONS)
#define PELAGE_HPP_EXCEPTIONS 1
#include <stdexcept>
#else
#define PELAGE_HPP_EXCEPTIONS 0
#include <optional>
#endif

namespace pelage {

#if PELAGE_HPP_EXCEPTIONS

/* A call that failed. */
class Error : public std::runtime_error {
public:
    Error(PelageResult code, const char *sentence) : std::runtime_error(sentence), code_(code) {}

    /* PELAGE_INVALID_VALUE and the like. */
    PelageResult code() const noexcept { return code_; }

private:
    PelageResult code_;
};

/* What a call returns: its value. */
template <class T> using Outcome = T;

#else

/* Why a call failed. */
struct Failure {
    PelageResult code;
    std::string sentence;
};

/* What a call returns: its value, or why it has none. */
template <class T> class [[nodiscard]] Outcome {
public:
    Outcome(T value) : value_(std::move(value)) {}
    Outcome(Failure failure) : failure_(std::move(failure)) {}

    explicit operator bool() const noexcept { return value_.has_value(); }
    T &operator*() noexcept { return *value_; }
    T *operator->() noexcept { return &*value_; }
    PelageResult code() const noexcept { return failure_.code; }
    const std::string &sentence() const noexcept { return failure_.sentence; }

private:
    std::optional<T> value_;
    Failure failure_{PELAGE_OK, {}};
};

template <> class [[nodiscard]] Outcome<void> {
public:
    Outcome() = default;
    Outcome(Failure failure) : failure_(std::move(failure)) {}

    explicit operator bool() const noexcept { return failure_.code == PELAGE_OK; }
    PelageResult code() const noexcept { return failure_.code; }
    const std::string &sentence() const noexcept { return failure_.sentence; }

private:
    Failure failure_{PELAGE_OK, {}};
};

#endif

namespace detail {

template <class T> Outcome<T> failed(PelageResult code) {
#if PELAGE_HPP_EXCEPTIONS
    throw Error(code, pelage_last_error());
#else
    return Failure{code, pelage_last_error()};
#endif
}

/* What `make` makes, after a call that worked. */
template <class Make> auto outcome(PelageResult code, Make &&make) -> Outcome<decltype(make())> {
    if (code != PELAGE_OK) {
        return failed<decltype(make())>(code);
    }
    return make();
}

/* A handle that is destroyed once. */
template <class Handle, PelageResult (*destroy)(Handle)> class Owned {
public:
    Owned() noexcept = default;
    explicit Owned(Handle handle) noexcept : handle_(handle) {}
    Owned(Owned &&other) noexcept : handle_(other.release()) {}
    Owned &operator=(Owned &&other) noexcept {
        if (this != &other) {
            reset();
            handle_ = other.release();
        }
        return *this;
    }
    Owned(const Owned &) = delete;
    Owned &operator=(const Owned &) = delete;
    ~Owned() { reset(); }

    /* The C handle, which stays this object's; all zero if there is none. */
    Handle get() const noexcept { return handle_; }
    /* The C handle, which is the caller's from now on. */
    Handle release() noexcept { return std::exchange(handle_, Handle{0}); }
    /* Destroys what is held. */
    void reset() noexcept {
        if (handle_.id != 0) {
            destroy(release());
        }
    }
    explicit operator bool() const noexcept { return handle_.id != 0; }

private:
    Handle handle_{0};
};

} // namespace detail

/* Checks what a function of pelage.h has returned. */
inline Outcome<void> check(PelageResult code) {
    if (code != PELAGE_OK) {
        return detail::failed<void>(code);
    }
    return Outcome<void>();
}

/* An image on its way back from the GPU. */
class Readback : public detail::Owned<PelageReadback, pelage_readback_destroy> {
public:
    using Owned::Owned;

    Outcome<bool> arrived() const {
        uint32_t value = 0;
        PelageResult code = pelage_readback_poll(get(), &value);
        return detail::outcome(code, [&] { return value != 0; });
    }
    /* Waits for the image: as many floats as there is room for, which must be as many as it has. */
    Outcome<void> copy(float *values, std::size_t count) const {
        return check(pelage_readback_copy(get(), values, count * sizeof(float)));
    }
};

/* An image to draw into. */
class Target : public detail::Owned<PelageTarget, pelage_target_destroy> {
public:
    Target() noexcept = default;
    Target(PelageTarget handle, uint32_t width, uint32_t height) noexcept
        : Owned(handle), width_(width), height_(height) {}

    uint32_t width() const noexcept { return width_; }
    uint32_t height() const noexcept { return height_; }

    /* Four floats a pixel, row 0 at the top. */
    Outcome<void> write_colour(const std::vector<float> &pixels) const {
        return check(pelage_target_write_colour(get(), pixels.data(), pixels.size() * sizeof(float)));
    }
    /* One float a pixel. */
    Outcome<void> write_depth(const std::vector<float> &depths) const {
        return check(pelage_target_write_depth(get(), depths.data(), depths.size() * sizeof(float)));
    }
    Outcome<std::vector<float>> read_colour() const {
        std::vector<float> pixels(pixel_count() * 4);
        PelageResult code = pelage_target_read_colour(get(), pixels.data(), pixels.size() * sizeof(float));
        return detail::outcome(code, [&] { return std::move(pixels); });
    }
    Outcome<std::vector<float>> read_depth() const {
        std::vector<float> depths(pixel_count());
        PelageResult code = pelage_target_read_depth(get(), depths.data(), depths.size() * sizeof(float));
        return detail::outcome(code, [&] { return std::move(depths); });
    }
    /* What the target was made with beside the colour, by PelageTargetDescriptor::outputs: clip depth of the nearest fibre, one
     * float a pixel; */
    Outcome<std::vector<float>> read_nearest_depth() const { return output<float>(PELAGE_OUTPUT_NEAREST_DEPTH, 1); }
    /* the part of a pixel that hair covers, one float; */
    Outcome<std::vector<float>> read_coverage() const { return output<float>(PELAGE_OUTPUT_COVERAGE, 1); }
    /* motion on the screen in pixels, two floats; */
    Outcome<std::vector<float>> read_motion() const { return output<float>(PELAGE_OUTPUT_MOTION, 2); }
    /* hair with instance, and strand, two integers: PELAGE_NO_STRAND where there is none. */
    Outcome<std::vector<uint32_t>> read_ids() const { return output<uint32_t>(PELAGE_OUTPUT_IDS, 2); }
    Outcome<Readback> begin_read_colour() const { return begin(pelage_readback_begin_colour); }
    Outcome<Readback> begin_read_depth() const { return begin(pelage_readback_begin_depth); }

private:
    std::size_t pixel_count() const noexcept { return static_cast<std::size_t>(width_) * height_; }
    template <class T> Outcome<std::vector<T>> output(uint32_t which, std::size_t each) const {
        std::vector<T> values(pixel_count() * each);
        PelageResult code = pelage_target_read_output(get(), which, values.data(), values.size() * sizeof(T));
        return detail::outcome(code, [&] { return std::move(values); });
    }
    Outcome<Readback> begin(PelageResult (*call)(PelageTarget, PelageReadback *)) const {
        PelageReadback readback{0};
        PelageResult code = call(get(), &readback);
        return detail::outcome(code, [&] { return Readback(readback); });
    }

    uint32_t width_ = 0;
    uint32_t height_ = 0;
};

/* Sixteen numbers, column-major. */
using Matrix = std::array<double, 16>;
static_assert(sizeof(Matrix) == 16 * sizeof(double), "a row of matrices is a row of numbers");

/* A copy of a hair: where it is, and where it was in the frame before. */
struct Instance {
    Matrix object_from_instance;
    Matrix previous_object_from_instance;
};

/* A groom on the GPU. */
class Hair : public detail::Owned<PelageHair, pelage_hair_destroy> {
public:
    using Owned::Owned;

    Outcome<PelageHairInfo> info() const {
        PelageHairInfo value = PELAGE_HAIR_INFO_INIT;
        PelageResult code = pelage_hair_info(get(), &value);
        return detail::outcome(code, [&] { return value; });
    }
    /* Three floats a point, as the CPU gave them last. */
    Outcome<std::vector<float>> points() const {
        PelageHairInfo has = PELAGE_HAIR_INFO_INIT;
        PelageResult code = pelage_hair_info(get(), &has);
        std::vector<float> positions(code == PELAGE_OK ? static_cast<std::size_t>(has.point_count) * 3 : 0);
        if (code == PELAGE_OK) {
            code = pelage_hair_points(get(), positions.data(), positions.size() * sizeof(float));
        }
        return detail::outcome(code, [&] { return std::move(positions); });
    }
    /* Three floats a point. */
    Outcome<void> update_points(const std::vector<float> &positions) const {
        return check(pelage_hair_update_points(get(), positions.data(), positions.size() / 3));
    }
    /* Three floats a point of the guides, of a hair that remembers them. */
    Outcome<void> update_guides(const std::vector<float> &positions) const {
        return check(pelage_hair_update_guides(get(), positions.data(), positions.size() / 3));
    }
    /* From a buffer of the host's, on its Vulkan device. */
    Outcome<void> update_points(const PelageVulkanPoints &points) const {
        return check(pelage_vulkan_update_points(get(), &points));
    }
    Outcome<void> update_guides(const PelageVulkanPoints &points) const {
        return check(pelage_vulkan_update_guides(get(), &points));
    }
    /* The points have not moved since the frame before. */
    Outcome<void> rest() const { return check(pelage_hair_rest(get())); }
    /* Sixteen doubles, column-major. */
    Outcome<void> set_transform(const double *world_from_object) const {
        return check(pelage_hair_set_transform(get(), world_from_object));
    }
    /* Where the hair was in the frame before; NULL for where it is. */
    Outcome<void> set_previous_transform(const double *world_from_object) const {
        return check(pelage_hair_set_previous_transform(get(), world_from_object));
    }
    /* Copies of the hair; none: the hair itself, once. */
    Outcome<void> set_instances(const std::vector<Instance> &instances) const {
        std::vector<Matrix> now, before;
        for (const Instance &instance : instances) {
            now.push_back(instance.object_from_instance);
            before.push_back(instance.previous_object_from_instance);
        }
        return check(pelage_hair_set_instances(get(), now.empty() ? nullptr : now[0].data(),
                                               before.empty() ? nullptr : before[0].data(),
                                               static_cast<uint32_t>(instances.size())));
    }
    Outcome<void> set_opacity(float opacity) const { return check(pelage_hair_set_opacity(get(), opacity)); }
    Outcome<void> set_shading(const PelageShading &shading) const {
        return check(pelage_hair_set_shading(get(), &shading));
    }
    Outcome<void> set_shadow(const PelageShadow &shadow) const { return check(pelage_hair_set_shadow(get(), &shadow)); }
    Outcome<void> set_transparency(const PelageTransparency &transparency) const {
        return check(pelage_hair_set_transparency(get(), &transparency));
    }
};

/* A device with everything made on it. */
class Context : public detail::Owned<PelageContext, pelage_context_destroy> {
public:
    using Owned::Owned;

    /* On a device of the library's own. */
    static Outcome<Context> offscreen() { return offscreen(PELAGE_CONTEXT_DESCRIPTOR_INIT); }
    static Outcome<Context> offscreen(const PelageContextDescriptor &descriptor) {
        return make(pelage_context_create, descriptor);
    }
    /* On a device of the library's own that can show targets in the host's window. */
    static Outcome<Context> window(const PelageWindow &window) { return make(pelage_window_context_create, window); }
    /* On the host's Vulkan device. */
    static Outcome<Context> vulkan(const PelageVulkanDevice &device) {
        return make(pelage_vulkan_context_create, device);
    }

    Outcome<PelageAdapter> adapter() const {
        PelageAdapter value = PELAGE_ADAPTER_INIT;
        PelageResult code = pelage_context_adapter(get(), &value);
        return detail::outcome(code, [&] { return value; });
    }
    Outcome<PelageStatistics> statistics() const {
        PelageStatistics value = PELAGE_STATISTICS_INIT;
        PelageResult code = pelage_statistics(get(), &value);
        return detail::outcome(code, [&] { return value; });
    }
    /* 0 lifts the limit. */
    Outcome<void> set_byte_budget(uint64_t bytes) const {
        return check(pelage_context_set_byte_budget(get(), bytes));
    }
    /* False is for measurements of frames with everything new. */
    Outcome<void> set_shadow_reuse(bool reuse) const {
        return check(pelage_context_set_shadow_reuse(get(), reuse ? 1 : 0));
    }
    Outcome<void> wait() const { return check(pelage_wait(get())); }

    Outcome<Hair> builtin(uint32_t groom, uint64_t strand_count = PELAGE_BUILTIN_STRAND_COUNT) const {
        return hair([&](PelageHair *made) { return pelage_hair_create_builtin(get(), groom, strand_count, made); });
    }
    Outcome<Hair> strands(const PelageStrands &given) const {
        return hair([&](PelageHair *made) { return pelage_hair_create_from_strands(get(), &given, made); });
    }
    Outcome<Hair> file(const PelageFile &given) const {
        return hair([&](PelageHair *made) { return pelage_hair_create_from_file(get(), &given, made); });
    }
    Outcome<Hair> interpolated(const PelageStrands &guides, const PelageInterpolationSettings &settings) const {
        return hair([&](PelageHair *made) {
            return pelage_hair_create_interpolated_on_mesh(get(), &guides, &settings, made);
        });
    }
    Outcome<Hair> clumps(const PelageStrands &guides, const PelageClumpSettings &settings) const {
        return hair([&](PelageHair *made) {
            return pelage_hair_create_interpolated_clumps(get(), &guides, &settings, made);
        });
    }

    /* As the two above, of hair that remembers its guides for Hair::update_guides. */
    Outcome<Hair> guided(const PelageStrands &guides, const PelageInterpolationSettings &settings) const {
        return hair([&](PelageHair *made) {
            return pelage_hair_create_guided_on_mesh(get(), &guides, &settings, made);
        });
    }
    Outcome<Hair> guided_clumps(const PelageStrands &guides, const PelageClumpSettings &settings) const {
        return hair([&](PelageHair *made) {
            return pelage_hair_create_guided_clumps(get(), &guides, &settings, made);
        });
    }

    Outcome<Target> target(const PelageTargetDescriptor &descriptor) const {
        PelageTarget made{0};
        PelageResult code = pelage_target_create(get(), &descriptor, &made);
        return detail::outcome(code, [&] { return Target(made, descriptor.width, descriptor.height); });
    }

    Outcome<void> render(const PelageFrame &frame, const Target &target, uint32_t flags = PELAGE_RENDER_CLEAR) const {
        return check(pelage_render(get(), &frame, target.get(), flags));
    }
    Outcome<void> render_timed(const PelageFrame &frame, const Target &target,
                               uint32_t flags = PELAGE_RENDER_CLEAR) const {
        return check(pelage_render_timed(get(), &frame, target.get(), flags));
    }
    /* Of a context on the host's Vulkan device. */
    Outcome<void> submit(const PelageVulkanSubmit &submit) const {
        return check(pelage_vulkan_render(get(), &submit));
    }

    /* Of a context with a window. */
    Outcome<PelageWindowInfo> window_info() const {
        PelageWindowInfo value = PELAGE_WINDOW_INFO_INIT;
        PelageResult code = pelage_window_info(get(), &value);
        return detail::outcome(code, [&] { return value; });
    }
    Outcome<void> resize(uint32_t width, uint32_t height) const {
        return check(pelage_window_resize(get(), width, height));
    }
    Outcome<void> set_present_mode(uint32_t mode) const { return check(pelage_window_set_present_mode(get(), mode)); }
    /* PELAGE_PRESENTED, or why the frame was skipped; `clear` is three floats, or NULL for black. */
    Outcome<uint32_t> present(const Target &target, const float *clear = nullptr) const {
        uint32_t value = 0;
        PelageResult code = pelage_window_present(get(), target.get(), clear, &value);
        return detail::outcome(code, [&] { return value; });
    }

private:
    template <class Descriptor>
    static Outcome<Context> make(PelageResult (*call)(const Descriptor *, PelageContext *),
                                 const Descriptor &descriptor) {
        PelageContext made{0};
        PelageResult code = call(&descriptor, &made);
        return detail::outcome(code, [&] { return Context(made); });
    }
    template <class Call> static Outcome<Hair> hair(Call &&call) {
        PelageHair made{0};
        PelageResult code = call(&made);
        return detail::outcome(code, [&] { return Hair(made); });
    }
};

/* A view from `eye` towards `target`, three doubles each; see pelage_view_perspective. */
inline Outcome<PelageView> perspective(const double *eye, const double *target, const double *up, double vertical_fov,
                                       double aspect, double near_plane, double far_plane) {
    PelageView value = PELAGE_VIEW_INIT;
    PelageResult code =
        pelage_view_perspective(eye, target, up, vertical_fov, aspect, near_plane, far_plane, &value);
    return detail::outcome(code, [&] { return value; });
}

} // namespace pelage

#endif /* PELAGE_HPP */
