/*
 * pelage: hair and fur, rendered inside other people's programs. Generated from src/capi; do not edit.
 *
 * RESULTS    Every call returns a PelageResult: PELAGE_OK, or what went wrong. After an error nothing has changed (what a
 *            result would have been written to is as it was), and pelage_last_error() is one sentence that names the
 *            value at fault. Nothing that is given here crashes the host, but for pointers to memory that is not there.
 * HANDLES    PelageContext, PelageHair, PelageTarget and PelageReadback are ids that are never used again. A handle that
 *            is NULL (all zero), stale, of another kind or of another context is PELAGE_INVALID_HANDLE.
 * STRUCTS    Each begins with its struct_size; begin with its PELAGE_..._INIT, then set what differs:
 *                PelageFrame frame = PELAGE_FRAME_INIT;
 *            That holds for structs that a call fills, too. Fields are only ever appended within an ABI version, and
 *            programs that were built against an older header keep working.
 * POINTERS   Read or written during the call only, and not NULL unless their description allows it.
 * THREADS    Every function may be called from any thread. Calls on one context, and on what was made on it, wait for
 *            each other; contexts run beside each other.
 * UNITS      Lengths in the host's units, angles in radians, colours linear RGB, matrices column-major, right-handed
 *            world, clip depth 0 to 1, images row 0 at the top, alpha premultiplied.
 */


#ifndef PELAGE_H
#define PELAGE_H

#include <stddef.h>
#include <stdint.h>
/*
 * Vulkan's handles. With PELAGE_VULKAN defined they are those of <vulkan/vulkan.h>; without it this header needs nothing of
 * Vulkan's, and they are what they are in memory: pointers, and 64-bit numbers for images, buffers and semaphores. Either way a
 * program is the same to the library.
 */
#ifdef PELAGE_VULKAN
#include <vulkan/vulkan.h>
typedef VkInstance PelageVkInstance;
typedef VkPhysicalDevice PelageVkPhysicalDevice;
typedef VkDevice PelageVkDevice;
typedef VkImage PelageVkImage;
typedef VkBuffer PelageVkBuffer;
typedef VkSemaphore PelageVkSemaphore;
typedef VkPhysicalDeviceFeatures2 PelageVkFeatures;
typedef PFN_vkGetInstanceProcAddr PelageVkGetInstanceProcAddr;
#else
#if defined(_WIN32)
#define PELAGE_VKAPI __stdcall
#else
#define PELAGE_VKAPI
#endif
typedef void *PelageVkInstance;
typedef void *PelageVkPhysicalDevice;
typedef void *PelageVkDevice;
typedef uint64_t PelageVkImage;
typedef uint64_t PelageVkBuffer;
typedef uint64_t PelageVkSemaphore;
typedef void PelageVkFeatures;
typedef void (PELAGE_VKAPI *PelageVkFunction)(void);
typedef PelageVkFunction (PELAGE_VKAPI *PelageVkGetInstanceProcAddr)(void *instance, const char *name);
#endif


// Major version of the header's library.
#define PELAGE_VERSION_MAJOR 0

// Minor version of the header's library.
#define PELAGE_VERSION_MINOR 1

// Patch version of the header's library.
#define PELAGE_VERSION_PATCH 0

// Version of the ABI. Programs built against it run with every library of the same number, which is that of the
// library's file name too: `libpelage.so.0`.
#define PELAGE_ABI_VERSION 0

// Done.
#define PELAGE_OK 0

// A value is out of range, not finite, NULL where it must not be, or does not fit the others.
#define PELAGE_INVALID_VALUE 1

// Bytes of a file do not follow their format.
#define PELAGE_INVALID_FILE 2

// A handle is NULL, was destroyed, or belongs to something else.
#define PELAGE_INVALID_HANDLE 3

// Hairs of one frame wish for different techniques and the frame names none.
#define PELAGE_CONFLICT 4

// The adapter, the driver or a target cannot do what was asked.
#define PELAGE_UNSUPPORTED 5

// No memory was left, on the GPU or within the byte budget.
#define PELAGE_OUT_OF_MEMORY 6

// The device is lost. The context is dead; destroy it.
#define PELAGE_DEVICE_LOST 7

// A fault of the library itself.
#define PELAGE_INTERNAL 8

// A fault of the library itself, caught while it unwound. The context of the call is dead; destroy it.
#define PELAGE_PANIC 9

// No messages.
#define PELAGE_LOG_OFF 0

// Faults of the library.
#define PELAGE_LOG_ERROR 1

// What a host should know: a fragment pool that was too small.
#define PELAGE_LOG_WARN 2

// Steps of the device's setup.
#define PELAGE_LOG_INFO 3

// For the library's developers.
#define PELAGE_LOG_DEBUG 4

// For the library's developers, very much of it.
#define PELAGE_LOG_TRACE 5

// Bytes of a name in `PelageAdapter`, its NUL included.
#define PELAGE_NAME_SIZE 256

// The library chooses.
#define PELAGE_RASTER_AUTO 0

// Camera-facing triangle strips.
#define PELAGE_RASTER_RIBBONS 1

// A compute pass that walks the pixels of each segment.
#define PELAGE_RASTER_WALK 2

// Kajiya and Kay 1989.
#define PELAGE_SHADING_KAJIYA_KAY 0

// Scheuermann 2004: Kajiya-Kay with two highlights.
#define PELAGE_SHADING_SCHEUERMANN 1

// Marschner et al. 2003.
#define PELAGE_SHADING_MARSCHNER 2

// Sadeghi et al. 2010.
#define PELAGE_SHADING_SADEGHI 3

// Chiang et al. 2016, d'Eon et al. 2011.
#define PELAGE_SHADING_CHIANG 4

// At strand points, once a view; a fragment's colour is interpolated along its segment.
#define PELAGE_SHADING_RATE_POINT 0

// At each fragment that the transparency technique keeps, at its own position. Refused with weighted blended, depth peeling,
// random subsets, sorted blending, the single-pass k-buffer, moments, and the k+-buffer with `PELAGE_REST_MERGED`, which need
// colours before they know what they keep.
#define PELAGE_SHADING_RATE_FRAGMENT 1

// Of the exact exit angle.
#define PELAGE_ROOTS_EXACT 0

// Of its fit by a cubic polynomial.
#define PELAGE_ROOTS_CUBIC 1

// 16-bit floats.
#define PELAGE_PRECISION_F16 0

// 32-bit floats.
#define PELAGE_PRECISION_F32 1

// Black hair.
#define PELAGE_HAIR_COLOUR_BLACK 0

// Brown hair.
#define PELAGE_HAIR_COLOUR_BROWN 1

// Blond hair.
#define PELAGE_HAIR_COLOUR_BLOND 2

// Red hair.
#define PELAGE_HAIR_COLOUR_RED 3

// Grey hair.
#define PELAGE_HAIR_COLOUR_GREY 4

// White hair.
#define PELAGE_HAIR_COLOUR_WHITE 5

// Dyed hair, blue.
#define PELAGE_HAIR_COLOUR_DYED 6

// Every light reaches every fibre.
#define PELAGE_SHADOW_NONE 0

// Yuksel and Keyser 2008.
#define PELAGE_SHADOW_DEEP_OPACITY_MAP 1

// Nearest depths with percentage-closer filtering.
#define PELAGE_SHADOW_SHADOW_MAP 2

// Nearest depths, and a guess of the fibres behind them.
#define PELAGE_SHADOW_APPROXIMATED_DEEP_SHADOW_MAP 3

// Kim and Neumann 2001.
#define PELAGE_SHADOW_OPACITY_SHADOW_MAPS 4

// Peters and Klein 2015, Münstermann et al. 2018.
#define PELAGE_SHADOW_MOMENT_OPACITY_MAP 5

// Yu et al. 2012.
#define PELAGE_SHADOW_K_BUFFER_VOLUME 6

// A fibre takes as much of the light as its opacity says.
#define PELAGE_ATTENUATION_OPACITY 0

// A fibre takes what its surface reflects and its inside absorbs.
#define PELAGE_ATTENUATION_FRESNEL 1

// The nearest fragment's colour at the pixel's whole opacity.
#define PELAGE_TRANSPARENCY_OPAQUE 0

// Every fragment stored, sorted and composited.
#define PELAGE_TRANSPARENCY_A_BUFFER 1

// As the A-buffer, but that nothing is stored behind the depth from which on it changes a pixel by less than a tolerance.
#define PELAGE_TRANSPARENCY_DBK_BUFFER 10

// McGuire and Bavoil 2013: the mean of all fragments weighed by depth, at their exact opacity.
#define PELAGE_TRANSPARENCY_WEIGHTED_BLENDED 4

// Everitt 2001: the nearest fragments found one after the other, the rest merged.
#define PELAGE_TRANSPARENCY_DEPTH_PEELING 5

// Hunz 2016: the nearest fragment of each of some random subsets of the strands.
#define PELAGE_TRANSPARENCY_RANDOM_SUBSETS 3

// Kim 2003: segments sorted into bins of depth, and blended in that order.
#define PELAGE_TRANSPARENCY_SORTED_BLENDING 2

// Every fragment stored, the K nearest of each pixel sorted and composited (Yu et al. 2012).
#define PELAGE_TRANSPARENCY_K_BUFFER 6

// The K nearest fragments of each pixel stored and composited (Vasilakis and Fudos 2014, Hunz 2016).
#define PELAGE_TRANSPARENCY_K_PLUS_BUFFER 7

// Fragments linked in order as they come, unless K nearer ones are there (Yu et al. 2012).
#define PELAGE_TRANSPARENCY_K_BUFFER_SINGLE_PASS 8

// Colours weighted by a transmittance that moments of optical depth give (Muenstermann et al. 2018, Sharpe 2018).
#define PELAGE_TRANSPARENCY_MOMENT 9

// Fragments counted first, then stored side by side.
#define PELAGE_STORAGE_COUNTED 0

// Per-pixel linked lists.
#define PELAGE_STORAGE_LISTS 1

// Cut-offs are looked for where that saves time, or where `pool_bytes` or the device do not hold all fragments.
#define PELAGE_CULLING_AUTO 0

// They are looked for in every frame: the fewest fragments are stored.
#define PELAGE_CULLING_ALWAYS 1

// Every fragment weighs the same.
#define PELAGE_WEIGHT_UNIFORM 0

// Opacity times the third power of the distance from the hair's far end.
#define PELAGE_WEIGHT_CUBIC 1

// exp(-falloff d), d from 0 at the hair's near end to 1 at its far one.
#define PELAGE_WEIGHT_EXPONENTIAL 2

// Farthest segments first, each over what is there.
#define PELAGE_BLEND_ORDER_BACK_TO_FRONT 0

// Nearest segments first, each under what is there.
#define PELAGE_BLEND_ORDER_FRONT_TO_BACK 1

// What lies behind the K nearest is one layer of exact opacity, in the mean of its own colours.
#define PELAGE_REST_MERGED 0

// It is one layer of exact opacity, in the mean colour of the K.
#define PELAGE_REST_ALPHA 1

// It is left out, as published.
#define PELAGE_REST_DROPPED 2

// 64-bit atomics where the device was opened with them, else 32-bit ones.
#define PELAGE_ATOMICS_AUTO 0

// 64-bit atomics, in one pass; on a device without them rendering fails with PELAGE_UNSUPPORTED.
#define PELAGE_ATOMICS_64 1

// 32-bit atomics, in two passes.
#define PELAGE_ATOMICS_32 2

// One way through a pixel's list selects all K (Yu et al. 2012).
#define PELAGE_SELECTION_REGISTERS 0

// It selects eight.
#define PELAGE_SELECTION_ROUNDS 1

// It selects one: a selection sort (Yang et al. 2010), for comparison.
#define PELAGE_SELECTION_SORT 2

// Straight segments between the points.
#define PELAGE_CURVE_POLYLINE 0

// A uniform Catmull-Rom spline through every point.
#define PELAGE_CURVE_CATMULL_ROM 1

// The most points of all strands together.
#define PELAGE_MAX_POINTS (1 << 28)

// Long and straight, parted.
#define PELAGE_BUILTIN_STRAIGHT 0

// Long, with waves that each wisp shares.
#define PELAGE_BUILTIN_WAVY 1

// Shoulder-length helical locks.
#define PELAGE_BUILTIN_CURLY 2

// The number of strands that the built-in grooms are made for.
#define PELAGE_BUILTIN_STRAND_COUNT 50000

// Four 16-bit floats a pixel.
#define PELAGE_FORMAT_RGBA16F 0

// Four 32-bit floats a pixel; needs a device that can blend them.
#define PELAGE_FORMAT_RGBA32F 1

// The nearest fibre's clip depth: one float a pixel; the far plane's where there is none.
#define PELAGE_OUTPUT_NEAREST_DEPTH 1

// The part of the pixel that hair covers, 0 to 1: one float a pixel.
#define PELAGE_OUTPUT_COVERAGE 2

// How far the nearest fibre has moved on the screen since the frame before, in pixels, +x right, +y down, jitter left out:
// two floats a pixel, 0 where there is none.
#define PELAGE_OUTPUT_MOTION 4

// The nearest fibre's hair, as its place in the frame, in the lower 16 bits with its instance in the upper 16; and its strand:
// two 32-bit integers a pixel, both `PELAGE_NO_STRAND` where there is none.
#define PELAGE_OUTPUT_IDS 8

// What both integers of `PELAGE_OUTPUT_IDS` hold where there is no hair.
#define PELAGE_NO_STRAND 4294967295

// Clip depth 1 is near and 0 far.
#define PELAGE_VIEW_REVERSE_Z 1

// Clip space's y points down the image, as Vulkan's own convention has it, not up.
#define PELAGE_VIEW_FLIP_Y 2

// The previous matrices and jitter are given, for motion vectors; without it the camera stood still.
#define PELAGE_VIEW_PREVIOUS 4

// A light so far away that its rays are parallel.
#define PELAGE_LIGHT_DIRECTIONAL 0

// A light at a point that shines in all directions.
#define PELAGE_LIGHT_POINT 1

// A light at a point that shines into a cone.
#define PELAGE_LIGHT_SPOT 2

// The most lights of a frame.
#define PELAGE_MAX_LIGHTS 16

// Clear the colour to transparent black first. Without it, hair is blended over what the colour holds.
#define PELAGE_RENDER_CLEAR 1

// Write the nearest hair's depth into the target's depth.
#define PELAGE_RENDER_WRITE_DEPTH 2

// Darken the opaque scene of the target by the hair's shadow.
#define PELAGE_RENDER_RECEIVE_SHADOW 4

// Of `pelage_vulkan_render`: write a view's shadow images alone. No hair is drawn, and its colour and outputs stay.
#define PELAGE_RENDER_SHADOWS_ONLY 8

// Bytes of a label, its NUL included.
#define PELAGE_LABEL_SIZE 96

// `VK_QUEUE_FAMILY_IGNORED`: nothing changes hands.
#define PELAGE_VULKAN_QUEUE_FAMILY_IGNORED 4294967295

// The most extensions that are required of a device.
#define PELAGE_VULKAN_MAX_EXTENSIONS 8

// Words in which appended structs of features live.
#define PELAGE_VULKAN_FEATURE_STORAGE 128

// The most shadow maps of the host's in one view.
#define PELAGE_MAX_OCCLUDERS 8

// A binary semaphore.
#define PELAGE_VULKAN_SEMAPHORE_BINARY 0

// A timeline semaphore.
#define PELAGE_VULKAN_SEMAPHORE_TIMELINE 1

// The most views of one submission.
#define PELAGE_VULKAN_MAX_VIEWS 8

// The most semaphores to wait on, and the most to signal.
#define PELAGE_VULKAN_MAX_SEMAPHORES 64

// `display` is a `Display *`, `window` a `Window`.
#define PELAGE_WINDOW_XLIB 1

// `display` is an `xcb_connection_t *`, `window` an `xcb_window_t`.
#define PELAGE_WINDOW_XCB 2

// `display` is a `struct wl_display *`, `window` a `struct wl_surface *`.
#define PELAGE_WINDOW_WAYLAND 3

// `display` is the `HINSTANCE` that the window was made with, `window` an `HWND`.
#define PELAGE_WINDOW_WIN32 4

// `display` is NULL, `window` an `NSView *`. Needs a Vulkan driver, such as MoltenVK.
#define PELAGE_WINDOW_APPKIT 5

// Each frame in its turn, at the screen's rate. Every window has it.
#define PELAGE_PRESENT_FIFO 0

// The newest frame at the screen's next refresh; older ones are dropped.
#define PELAGE_PRESENT_MAILBOX 1

// At once, even while the screen is being refreshed.
#define PELAGE_PRESENT_IMMEDIATE 2

// The first of the following that the window has.
#define PELAGE_SURFACE_AUTO 0

// 8 bits a channel of the sRGB curve, which the GPU applies.
#define PELAGE_SURFACE_SRGB8 1

// The same 8 bits in a format that does not know of the curve: the library applies it.
#define PELAGE_SURFACE_UNORM8 2

// 10 bits a channel of the sRGB curve, which the library applies.
#define PELAGE_SURFACE_UNORM10 3

// 16-bit floats, linear, beyond 1 too: extended linear sRGB, which the screen makes the best of.
#define PELAGE_SURFACE_FLOAT16 4

// The frame is on its way to the screen.
#define PELAGE_PRESENTED 0

// Skipped: the window has no pixels, as one that is minimised.
#define PELAGE_SKIPPED_MINIMISED 1

// Skipped: nothing of the window can be seen.
#define PELAGE_SKIPPED_OCCLUDED 2

// Skipped: the screen had no room for another frame within a second.
#define PELAGE_SKIPPED_TIMEOUT 3

// Skipped: the window kept changing while its surface was made anew.
#define PELAGE_SKIPPED_CHANGING 4

// What a call returns: `PELAGE_OK`, or what went wrong. After an error nothing has changed, and `pelage_last_error`
// says in one sentence what was wrong with which value.
typedef uint32_t PelageResult;

// Receives one message, UTF-8, valid for the length of the call; `user` is what was given with the callback.
//
// Called on any thread: mostly at the end of the `pelage_...` call that caused the message, when the library holds no lock,
// so that it may call any function of the library but `pelage_set_log_callback`. What the library logs meanwhile on the
// same thread is dropped. It must return: no exception, no longjmp.
typedef void (*PelageLogCallback)(uint32_t level, const char *message, void *user);

// How a context is made.
typedef struct PelageContextDescriptor {
    // `sizeof(PelageContextDescriptor)`.
    uint32_t struct_size;
    // 1: take a software driver even where a GPU is present. 0 takes one only where there is nothing else.
    uint32_t force_software;
    // 1: load Vulkan's validation layer where it is installed; it writes what it finds to the standard output.
    uint32_t validation;
    // 0.
    uint32_t reserved;
    // Bytes of GPU memory that the context may take beside its targets; 0 for no limit.
    uint64_t byte_budget;
} PelageContextDescriptor;

// A device with everything made on it. All zero: no context.
typedef struct PelageContext {
    // Opaque; 0 is NULL.
    uint64_t id;
} PelageContext;

// What a context runs on.
typedef struct PelageAdapter {
    // `sizeof(PelageAdapter)`.
    uint32_t struct_size;
    // 1 for a software driver.
    uint32_t software;
    // The device's name, UTF-8, ended by a NUL, cut off where it is too long.
    char name[PELAGE_NAME_SIZE];
    // The driver's name and version, likewise.
    char driver[PELAGE_NAME_SIZE];
} PelageAdapter;

// Strands as arrays, which are copied. Lengths are in the host's units, in the groom's own space.
//
// A strand has at least one point, its root first; one of a single point is kept and draws nothing. There may be no
// strands at all.
typedef struct PelageStrands {
    // `sizeof(PelageStrands)`.
    uint32_t struct_size;
    // `PELAGE_CURVE_...`: how the points make a curve.
    uint32_t curve;
    // Three floats a point, strand after strand; finite.
    const float *positions;
    // The number of points, at most `PELAGE_MAX_POINTS`.
    uint64_t point_count;
    // Points of each strand, at least 1; they sum to `point_count`.
    const uint32_t *counts;
    // The number of strands.
    uint64_t strand_count;
    // One radius a point, finite and at least 0; NULL: from `root_radius` to `tip_radius`.
    const float *radii;
    // Three floats a strand, linear RGB factors, finite and at least 0; NULL: white.
    const float *colours;
    // One coordinate a point, from 0 at the root to 1 at the tip, not falling along a strand; NULL: by arc length.
    const float *coordinates;
    // Radius at the root, at least 0; read where `radii` is NULL.
    float root_radius;
    // Radius at the tip, at least 0; read where `radii` is NULL. Runs linearly in the coordinate.
    float tip_radius;
} PelageStrands;

// A groom on the GPU, with how it is to be drawn. All zero: no hair.
typedef struct PelageHair {
    // Opaque; 0 is NULL.
    uint64_t id;
} PelageHair;

// How the triangles between guides are filled.
typedef struct PelageInterpolationSettings {
    // `sizeof(PelageInterpolationSettings)`.
    uint32_t struct_size;
    // Another seed, another groom of the same kind.
    uint32_t seed;
    // Three guide numbers a triangle: the mesh whose vertices are the guides' roots.
    const uint32_t *triangles;
    // The number of triangles.
    uint64_t triangle_count;
    // Strands per unit of area, in host units; at least 0. A scalp has 200 to 300 a square centimetre.
    float density;
    // How closely tips gather at the nearest guide: 0 spreads them over the triangle, 1 puts them on the guide.
    float clump;
    // The fraction of the strands that leave their clump, 0 to 1.
    float stray_fraction;
    // How far a stray's tip is displaced at most, as a fraction of the strand's length; at least 0.
    float stray_strength;
} PelageInterpolationSettings;

// How each guide is surrounded by followers.
typedef struct PelageClumpSettings {
    // `sizeof(PelageClumpSettings)`.
    uint32_t struct_size;
    // Another seed, another groom of the same kind.
    uint32_t seed;
    // Strands that are added to each guide.
    uint32_t followers;
    // Radius of the disc in which the followers' roots lie, in host units; at least 0.
    float root_radius;
    // The disc's radius at the tip over that at the root; at least 0.
    float tip_factor;
    // The fraction of the strands that leave their clump, 0 to 1.
    float stray_fraction;
    // How far a stray's tip is displaced at most, as a fraction of the strand's length; at least 0.
    float stray_strength;
    // 0.
    uint32_t reserved;
} PelageClumpSettings;

// A hair file in memory: Cem Yuksel's `.hair`, or AMD TressFX's `.tfx` of versions 3 and 4.
typedef struct PelageFile {
    // `sizeof(PelageFile)`.
    uint32_t struct_size;
    // `PELAGE_CURVE_...`: how the file's points make a curve; the formats do not say.
    uint32_t curve;
    // The file's bytes. Read during the call only.
    const void *bytes;
    // The number of bytes.
    uint64_t size;
    // Radius at the root, in the file's units, in place of the file's own radii; 0, with `tip_radius`: the file's, or
    // where it has none (TressFX) what fits the groom's size.
    float root_radius;
    // Radius at the tip, likewise.
    float tip_radius;
} PelageFile;

// What a hair is made of.
typedef struct PelageHairInfo {
    // `sizeof(PelageHairInfo)`.
    uint32_t struct_size;
    // `PELAGE_CURVE_...`.
    uint32_t curve;
    // The number of strands.
    uint64_t strand_count;
    // The number of points, of all strands together.
    uint64_t point_count;
    // The lowest corner of the box around all points, in the groom's own space; zero where there are none.
    float low[3];
    // The highest corner.
    float high[3];
} PelageHairInfo;

// Kajiya and Kay's diffuse and specular lobes.
typedef struct PelageKajiyaKay {
    // `sizeof(PelageKajiyaKay)`.
    uint32_t struct_size;
    // Diffuse coefficient, linear RGB, at least 0; multiplies each strand's own colour. About 1/pi for a light fibre.
    float diffuse[3];
    // Specular coefficient, linear RGB, at least 0.
    float specular[3];
    // The specular lobe's exponent, from 1 to 100000.
    float exponent;
} PelageKajiyaKay;

// One highlight of Scheuermann's model.
typedef struct PelageHighlight {
    // Coefficient, linear RGB, from 0 to 1e6.
    float colour[3];
    // Exponent, from 1 to 100000.
    float exponent;
    // The tangent is turned by atan(shift) towards the eye, from -10 to 10. Positive moves the highlight to the root.
    float shift;
} PelageHighlight;

// Scheuermann 2004: Kajiya-Kay with two highlights.
typedef struct PelageScheuermann {
    // `sizeof(PelageScheuermann)`.
    uint32_t struct_size;
    // Diffuse coefficient, linear RGB, from 0 to 1e6; multiplies each strand's own colour.
    float diffuse[3];
    // The first highlight, of the light's colour.
    struct PelageHighlight primary;
    // The second; multiplies each strand's own colour.
    struct PelageHighlight secondary;
} PelageScheuermann;

// Marschner et al. 2003.
typedef struct PelageMarschner {
    // `sizeof(PelageMarschner)`.
    uint32_t struct_size;
    // Index of refraction, from 1.01 to 3.
    float eta;
    // Absorption per fibre radius, linear RGB, from 0 to 1e6.
    float sigma_a[3];
    // Shifts of R, TT and TRT in terms of half the sum of both inclinations, radians, -pi/2 to pi/2; negative is towards
    // the root.
    float alpha[3];
    // Widths of R, TT and TRT in the same terms, radians, from 1e-5 to 10.
    float beta[3];
    // One axis of the section over the other, from 0.75 to 1.33.
    float eccentricity;
    // `PELAGE_ROOTS_...`.
    uint32_t roots;
    // 0: the caustic stays; 1: it is taken out, and glints are put in its place.
    uint32_t remove_caustic;
    // Azimuthal width of the glints, radians, from 1e-5 to 10.
    float caustic_width;
    // Scale of the glints, from 0 to 100; 0.5 keeps the energy.
    float caustic_scale;
    // Range of the index above 2 in which the glints fade, from 1e-5 to 10.
    float caustic_fade;
    // Limit of the caustic's width across the fibre, from 0 to 1.
    float caustic_limit;
    // What a crossing transmits further at the tip, linear RGB, from 0 to 1.
    float tip_colour[3];
    // Rows and columns of the tables, from 32 to 512; 0: no tables.
    uint32_t table_size;
    // `PELAGE_PRECISION_...`.
    uint32_t table_precision;
    // 0: single scattering; 1: with dual scattering.
    uint32_t dual_scattering;
    // Density of hair before the shaded fibre, from 0 to 1.
    float forward_density;
    // Density of hair around it, from 0 to 1.
    float backward_density;
    // Each strand's roughness lies between 1 - this and 1 + this times the model's, from 0 to 0.9.
    float roughness_strand;
    // The tip's roughness over the root's, from 0.1 to 10.
    float roughness_tip;
    // Radiance by which no fibre may change where the TT lobe is left out, from 0, never, to 1e6.
    float lobe_tolerance;
    // How much its fibres lie in other directions, from 0, combed hair, to 1.
    float disorder;
} PelageMarschner;

// One lobe of Sadeghi's model.
typedef struct PelageLobe {
    // Linear RGB, from 0 to 1e6.
    float colour[3];
    // From 0 to 1e6.
    float intensity;
    // Shift in terms of half the sum of both inclinations, radians, -pi/2 to pi/2; negative is towards the root.
    float shift;
    // Width in the same terms, radians, from 1e-5 to 10.
    float width;
} PelageLobe;

// Sadeghi et al. 2010.
typedef struct PelageSadeghi {
    // `sizeof(PelageSadeghi)`.
    uint32_t struct_size;
    // Primary highlight.
    struct PelageLobe r;
    // Forward lobe.
    struct PelageLobe tt;
    // Secondary highlight, with the glints.
    struct PelageLobe trt;
    // Azimuthal width of the forward lobe, radians, from 1e-5 to 10.
    float tt_azimuthal_width;
    // Intensity of the glints relative to the secondary highlight, from 0 to 1e6.
    float glint_intensity;
    // Azimuthal width of the glints, radians, from 1e-5 to 10.
    float glint_width;
    // Range of half the angle between a strand's two glints, radians, from 0 to pi.
    float glint_angle[2];
    // 1: divided by the part of the light that is scattered where that is above 1; 0: as published.
    uint32_t normalised;
    // What a crossing transmits further at the tip, linear RGB, from 0 to 1.
    float tip_colour[3];
    // 0: single scattering; 1: with dual scattering.
    uint32_t dual_scattering;
    // Density of hair before the shaded fibre, from 0 to 1.
    float forward_density;
    // Density of hair around it, from 0 to 1.
    float backward_density;
    // Each strand's roughness lies between 1 - this and 1 + this times the model's, from 0 to 0.9.
    float roughness_strand;
    // The tip's roughness over the root's, from 0.1 to 10.
    float roughness_tip;
    // Radiance by which no fibre may change where the TT lobe is left out, from 0, never, to 1e6.
    float lobe_tolerance;
    // How much its fibres lie in other directions, from 0, combed hair, to 1.
    float disorder;
} PelageSadeghi;

// Chiang et al. 2016, d'Eon et al. 2011.
typedef struct PelageChiang {
    // `sizeof(PelageChiang)`.
    uint32_t struct_size;
    // Longitudinal roughness, from 0.001 to 1.
    float beta_m;
    // Azimuthal roughness, from 0.001 to 1.
    float beta_n;
    // Tilt of the cuticle's scales, radians, -pi/2 to pi/2; positive moves the first highlight towards the root.
    float alpha;
    // Index of refraction, from 1.01 to 3.
    float eta;
    // Absorption per fibre radius, linear RGB, from 0 to 1e6. See `pelage_sigma_a_from_melanin`.
    float sigma_a[3];
    // What a crossing transmits further at the tip, linear RGB, from 0 to 1.
    float tip_colour[3];
    // Intervals of the integral across the fibre where there are no tables, from 8 to 256.
    uint32_t intervals;
    // Rows and columns of the tables, from 32 to 512; 0: no tables.
    uint32_t table_size;
    // `PELAGE_PRECISION_...`.
    uint32_t table_precision;
    // 0: single scattering; 1: with dual scattering.
    uint32_t dual_scattering;
    // Density of hair before the shaded fibre, from 0 to 1.
    float forward_density;
    // Density of hair around it, from 0 to 1.
    float backward_density;
    // Each strand's roughness lies between 1 - this and 1 + this times the model's, from 0 to 0.9.
    float roughness_strand;
    // The tip's roughness over the root's, from 0.1 to 10.
    float roughness_tip;
    // Radiance by which no fibre may change where the TT lobe is left out, from 0, never, to 1e6.
    float lobe_tolerance;
    // 1: fibres wider than a pixel are shaded by where the pixel lies across them, at `PELAGE_SHADING_RATE_FRAGMENT`; 0: all by
    // the mean over their width.
    uint32_t near_field;
    // How much its fibres lie in other directions, from 0, combed hair, to 1.
    float disorder;
} PelageChiang;

// A shading model with its parameters.
typedef struct PelageShading {
    // `sizeof(PelageShading)`.
    uint32_t struct_size;
    // `PELAGE_SHADING_...`.
    uint32_t model;
    // For `PELAGE_SHADING_KAJIYA_KAY`; NULL: as `PELAGE_KAJIYA_KAY_INIT`.
    const struct PelageKajiyaKay *kajiya_kay;
    // For `PELAGE_SHADING_SCHEUERMANN`; NULL: as `PELAGE_SCHEUERMANN_INIT`.
    const struct PelageScheuermann *scheuermann;
    // For `PELAGE_SHADING_MARSCHNER`; NULL: as `PELAGE_MARSCHNER_INIT`.
    const struct PelageMarschner *marschner;
    // For `PELAGE_SHADING_SADEGHI`; NULL: as `PELAGE_SADEGHI_INIT`.
    const struct PelageSadeghi *sadeghi;
    // For `PELAGE_SHADING_CHIANG`; NULL: as `PELAGE_CHIANG_INIT`.
    const struct PelageChiang *chiang;
    // `PELAGE_SHADING_RATE_...`; the same for all hairs of a frame.
    uint32_t rate;
    // 0.
    uint32_t reserved;
} PelageShading;

// Settings of the deep opacity map.
typedef struct PelageDeepOpacityMap {
    // `sizeof(PelageDeepOpacityMap)`.
    uint32_t struct_size;
    // Texels a side, from 16 to 8192.
    uint32_t resolution;
    // Layers, from 1 to 64.
    uint32_t layers;
    // Width of the filter in texels: 1, 3 or 5.
    uint32_t pcf;
    // Depth behind the front at which the last layer ends, as a part of the hair's extent along the light, above 0 and
    // up to 1. What lies deeper counts in the last layer.
    float depth;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
    // The part of each channel that a crossed fibre passes on, from 0 to below 1: all hair's alike.
    float transmitted[3];
} PelageDeepOpacityMap;

// Settings of the shadow map.
typedef struct PelageShadowMap {
    // `sizeof(PelageShadowMap)`.
    uint32_t struct_size;
    // Texels a side, from 16 to 8192.
    uint32_t resolution;
    // Width of the filter in texels: 1, 3 or 5.
    uint32_t pcf;
    // The part of the light that a shadow takes, from 0 to 1.
    float strength;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageShadowMap;

// Settings of the approximated deep shadow map.
typedef struct PelageApproximatedDeepShadowMap {
    // `sizeof(PelageApproximatedDeepShadowMap)`.
    uint32_t struct_size;
    // Texels a side, from 16 to 8192.
    uint32_t resolution;
    // Width of the filter in texels: 1, 3 or 5.
    uint32_t pcf;
    // Opacity of each fibre that is guessed to lie in the way, above 0 and up to 1. 0: the fibres' own.
    float opacity;
    // Mean distance between fibres along a ray, in host units. 0: such that mean transmittance is that of fibres spread
    // evenly in the volume that they fill.
    float spacing;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageApproximatedDeepShadowMap;

// Settings of opacity shadow maps.
typedef struct PelageOpacityShadowMaps {
    // `sizeof(PelageOpacityShadowMaps)`.
    uint32_t struct_size;
    // Texels a side, from 16 to 8192.
    uint32_t resolution;
    // Planes, from 1 to 256.
    uint32_t layers;
    // How much farther apart the planes lie with depth, from 0, evenly, to 1, as the square of their number.
    float unevenness;
    // Width of the filter in texels: 1, 3 or 5.
    uint32_t pcf;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageOpacityShadowMaps;

// Settings of the moment opacity map.
typedef struct PelageMomentOpacityMap {
    // `sizeof(PelageMomentOpacityMap)`.
    uint32_t struct_size;
    // Texels a side, from 16 to 8192.
    uint32_t resolution;
    // Moments beside the sum, 4 or 6.
    uint32_t moments;
    // Width of the filter in texels: 1, 3 or 5.
    uint32_t pcf;
    // The part of each channel that a crossed fibre passes on, from 0 to below 1: all hair's alike.
    float transmitted[3];
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageMomentOpacityMap;

// Settings of the k-buffer volumetric shadow.
typedef struct PelageKBufferVolume {
    // `sizeof(PelageKBufferVolume)`.
    uint32_t struct_size;
    // Texels a side, from 16 to 8192.
    uint32_t resolution;
    // Events a texel, from 1 to 64.
    uint32_t k;
    // Width of the filter in texels: 1, 3 or 5.
    uint32_t pcf;
    // 1: what lies behind the K-th event counts, spread evenly to the farthest one. 0: it does not.
    uint32_t tail;
    // `PELAGE_ATTENUATION_...`: what a fibre takes of the light.
    uint32_t attenuation;
    // Of `PELAGE_ATTENUATION_FRESNEL`: the index of refraction, from 1.01 to 3.
    float eta;
    // Of `PELAGE_ATTENUATION_FRESNEL`: absorption per fibre radius, from 0.
    float sigma_a[3];
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageKBufferVolume;

// A shadow technique with its settings.
typedef struct PelageShadow {
    // `sizeof(PelageShadow)`.
    uint32_t struct_size;
    // `PELAGE_SHADOW_...`.
    uint32_t technique;
    // For `PELAGE_SHADOW_DEEP_OPACITY_MAP`; NULL: as `PELAGE_DEEP_OPACITY_MAP_INIT`.
    const struct PelageDeepOpacityMap *deep_opacity_map;
    // For `PELAGE_SHADOW_SHADOW_MAP`; NULL: as `PELAGE_SHADOW_MAP_INIT`.
    const struct PelageShadowMap *shadow_map;
    // For `PELAGE_SHADOW_APPROXIMATED_DEEP_SHADOW_MAP`; NULL: as `PELAGE_APPROXIMATED_DEEP_SHADOW_MAP_INIT`.
    const struct PelageApproximatedDeepShadowMap *approximated_deep_shadow_map;
    // For `PELAGE_SHADOW_OPACITY_SHADOW_MAPS`; NULL: as `PELAGE_OPACITY_SHADOW_MAPS_INIT`.
    const struct PelageOpacityShadowMaps *opacity_shadow_maps;
    // For `PELAGE_SHADOW_MOMENT_OPACITY_MAP`; NULL: as `PELAGE_MOMENT_OPACITY_MAP_INIT`.
    const struct PelageMomentOpacityMap *moment_opacity_map;
    // For `PELAGE_SHADOW_K_BUFFER_VOLUME`; NULL: as `PELAGE_K_BUFFER_VOLUME_INIT`.
    const struct PelageKBufferVolume *k_buffer_volume;
} PelageShadow;

// Settings of the opaque technique.
typedef struct PelageOpaque {
    // `sizeof(PelageOpaque)`.
    uint32_t struct_size;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageOpaque;

// Settings of the A-buffer.
typedef struct PelageABuffer {
    // `sizeof(PelageABuffer)`.
    uint32_t struct_size;
    // `PELAGE_STORAGE_...`.
    uint32_t storage;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
    // 0.
    uint32_t reserved;
    // Bytes of the fragment pool, at least 12; 0: the library estimates, and grows it within the byte budget.
    uint64_t pool_bytes;
} PelageABuffer;

// Settings of the DBK-buffer.
typedef struct PelageDbkBuffer {
    // `sizeof(PelageDbkBuffer)`.
    uint32_t struct_size;
    // How much of a pixel's alpha, and of its culled hair's radiance, may be left out: from 1e-6 to 0.5.
    float epsilon;
    // Above 0: what lies farther than this behind the nearest fragment, in host units along the ray, is drawn as one opaque
    // layer, and `epsilon` is not asked. 0: `epsilon` decides.
    float depth_shift;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
    // Bytes of the fragment pool, at least 12; 0: the library estimates, and grows it within the byte budget.
    uint64_t pool_bytes;
    // `PELAGE_CULLING_...`; by a depth shift cut-offs are always looked for.
    uint32_t culling;
    // 0.
    uint32_t reserved;
} PelageDbkBuffer;

// Settings of weighted blended transparency. 28 bytes a pixel.
typedef struct PelageWeightedBlended {
    // `sizeof(PelageWeightedBlended)`.
    uint32_t struct_size;
    // `PELAGE_WEIGHT_...`.
    uint32_t weight;
    // For `PELAGE_WEIGHT_EXPONENTIAL`, from 0 to 100: the hair's optical depth.
    float falloff;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageWeightedBlended;

// Settings of depth peeling. 52 bytes a pixel.
typedef struct PelageDepthPeeling {
    // `sizeof(PelageDepthPeeling)`.
    uint32_t struct_size;
    // Fragments of a pixel that are composited in their order, from 1 to 1024; what lies behind them is merged.
    uint32_t peels;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageDepthPeeling;

// Settings of random subsets. 8 bytes a pixel and subset, and 4 a pixel for the exact opacity.
typedef struct PelageRandomSubsets {
    // `sizeof(PelageRandomSubsets)`.
    uint32_t struct_size;
    // Subsets, from 1 to 32.
    uint32_t subsets;
    // What strands are parted by: another seed, another picture.
    uint32_t seed;
    // 1: a pixel has the opacity of all its fragments; 0: as published, only that of those that are kept.
    uint32_t exact_alpha;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageRandomSubsets;

// Settings of sorted blending. It draws ribbons, whatever their width.
typedef struct PelageSortedBlending {
    // `sizeof(PelageSortedBlending)`.
    uint32_t struct_size;
    // Bins of depth, from 1 to 4096.
    uint32_t bins;
    // `PELAGE_BLEND_ORDER_...`.
    uint32_t order;
    // Frames after a sorted one that take its order, as long as they draw the same hair; 0: every frame is sorted.
    uint32_t reuse;
    // 0: blended as 16-bit floats, 8 bytes a pixel; 1: as 32-bit floats where the device blends these, 16 bytes a pixel.
    uint32_t full_precision;
} PelageSortedBlending;

// Settings of the k-buffer.
typedef struct PelageKBuffer {
    // `sizeof(PelageKBuffer)`.
    uint32_t struct_size;
    // Fragments of a pixel that keep their order, from 1 to 64.
    uint32_t k;
    // `PELAGE_REST_...`.
    uint32_t rest;
    // `PELAGE_SELECTION_...`; the picture does not depend on it.
    uint32_t selection;
    // `PELAGE_STORAGE_...`.
    uint32_t storage;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
    // Bytes of the fragment pool, at least 12; 0: the library estimates, and grows it within the byte budget.
    uint64_t pool_bytes;
} PelageKBuffer;

// Settings of the k+-buffer.
typedef struct PelageKPlusBuffer {
    // `sizeof(PelageKPlusBuffer)`.
    uint32_t struct_size;
    // Fragments of a pixel that are kept, from 1 to 64, in 8 bytes each.
    uint32_t k;
    // `PELAGE_REST_...`.
    uint32_t rest;
    // `PELAGE_ATOMICS_...`; the picture does not depend on it.
    uint32_t atomics;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageKPlusBuffer;

// Settings of the single-pass k-buffer.
typedef struct PelageKBufferSinglePass {
    // `sizeof(PelageKBufferSinglePass)`.
    uint32_t struct_size;
    // Fragments of a pixel that keep their order, from 1 to 64.
    uint32_t k;
    // `PELAGE_REST_...`.
    uint32_t rest;
    // How often a fragment tries again, where others were faster, before it is merged: up to 255.
    uint32_t retries;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
    // 0.
    uint32_t reserved;
    // Bytes of the fragment pool, at least 12; 0: the library estimates, and grows it within the byte budget.
    uint64_t pool_bytes;
} PelageKBufferSinglePass;

// Settings of moment-based transparency.
typedef struct PelageMoment {
    // `sizeof(PelageMoment)`.
    uint32_t struct_size;
    // `PELAGE_RASTER_...`.
    uint32_t raster;
} PelageMoment;

// A transparency technique with its settings.
typedef struct PelageTransparency {
    // `sizeof(PelageTransparency)`.
    uint32_t struct_size;
    // `PELAGE_TRANSPARENCY_...`.
    uint32_t technique;
    // For `PELAGE_TRANSPARENCY_OPAQUE`; NULL: as `PELAGE_OPAQUE_INIT`.
    const struct PelageOpaque *opaque;
    // For `PELAGE_TRANSPARENCY_A_BUFFER`; NULL: as `PELAGE_A_BUFFER_INIT`.
    const struct PelageABuffer *a_buffer;
    // For `PELAGE_TRANSPARENCY_DBK_BUFFER`; NULL: as `PELAGE_DBK_BUFFER_INIT`.
    const struct PelageDbkBuffer *dbk_buffer;
    // For `PELAGE_TRANSPARENCY_WEIGHTED_BLENDED`; NULL: as `PELAGE_WEIGHTED_BLENDED_INIT`.
    const struct PelageWeightedBlended *weighted_blended;
    // For `PELAGE_TRANSPARENCY_DEPTH_PEELING`; NULL: as `PELAGE_DEPTH_PEELING_INIT`.
    const struct PelageDepthPeeling *depth_peeling;
    // For `PELAGE_TRANSPARENCY_RANDOM_SUBSETS`; NULL: as `PELAGE_RANDOM_SUBSETS_INIT`.
    const struct PelageRandomSubsets *random_subsets;
    // For `PELAGE_TRANSPARENCY_SORTED_BLENDING`; NULL: as `PELAGE_SORTED_BLENDING_INIT`.
    const struct PelageSortedBlending *sorted_blending;
    // For `PELAGE_TRANSPARENCY_K_BUFFER`; NULL: as `PELAGE_K_BUFFER_INIT`.
    const struct PelageKBuffer *k_buffer;
    // For `PELAGE_TRANSPARENCY_K_PLUS_BUFFER`; NULL: as `PELAGE_K_PLUS_BUFFER_INIT`.
    const struct PelageKPlusBuffer *k_plus_buffer;
    // For `PELAGE_TRANSPARENCY_K_BUFFER_SINGLE_PASS`; NULL: as `PELAGE_K_BUFFER_SINGLE_PASS_INIT`.
    const struct PelageKBufferSinglePass *k_buffer_single_pass;
    // For `PELAGE_TRANSPARENCY_MOMENT`; NULL: as `PELAGE_MOMENT_INIT`.
    const struct PelageMoment *moment;
} PelageTransparency;

// How a target is made.
typedef struct PelageTargetDescriptor {
    // `sizeof(PelageTargetDescriptor)`.
    uint32_t struct_size;
    // Width in pixels, at least 1 and at most what the device takes (8192 or more).
    uint32_t width;
    // Height in pixels, likewise.
    uint32_t height;
    // `PELAGE_FORMAT_...` of the colour: linear, premultiplied.
    uint32_t format;
    // 1: with a depth, of 32-bit floats, for an opaque scene that hides hair.
    uint32_t with_depth;
    // Any of `PELAGE_OUTPUT_...`, or 0: what is written beside the colour.
    uint32_t outputs;
} PelageTargetDescriptor;

// An image to draw into, with an optional depth. All zero: no target.
typedef struct PelageTarget {
    // Opaque; 0 is NULL.
    uint64_t id;
} PelageTarget;

// An image on its way back from the GPU. All zero: no readback.
typedef struct PelageReadback {
    // Opaque; 0 is NULL.
    uint64_t id;
} PelageReadback;

// A camera. Right-handed world, clip depth from 0 to 1, row 0 of the image at the top.
//
// World coordinates may be large: the matrices are composed in double precision.
typedef struct PelageView {
    // `sizeof(PelageView)`.
    uint32_t struct_size;
    // Any of `PELAGE_VIEW_...`, or 0.
    uint32_t flags;
    // Camera space from world space, column-major; the camera looks along -z. Can be inverted.
    double view_from_world[16];
    // Clip space from camera space, column-major. Can be inverted.
    double clip_from_view[16];
    // With `PELAGE_VIEW_PREVIOUS`: both matrices of the frame before.
    double previous_view_from_world[16];
    // See above.
    double previous_clip_from_view[16];
    // How far `clip_from_view` shifts the image for temporal antialiasing, in pixels, +x right, +y down; it is taken out of
    // motion vectors and changes nothing else.
    float jitter[2];
    // The same of the frame before.
    float previous_jitter[2];
    // The part of the target that the view fills: left, top, width, height in pixels; all 0: the whole target.
    uint32_t rectangle[4];
} PelageView;

// One light.
typedef struct PelageLight {
    // `sizeof(PelageLight)`.
    uint32_t struct_size;
    // `PELAGE_LIGHT_...`.
    uint32_t kind;
    // Of a directional light or a spot: the way it travels, in world space; any length but zero.
    double direction[3];
    // Of a point light or a spot: world space, host units.
    double position[3];
    // Linear RGB, at least 0. Of a directional light: irradiance on a plane that faces it. Of a point light or a spot:
    // radiant intensity, that is irradiance times squared distance.
    float power[3];
    // 0.
    uint32_t reserved;
    // How hair shadows this light; NULL: as the frame's hairs wish.
    const struct PelageShadow *shadow;
    // Of a spot: the angle from its axis up to which it has all of its intensity, in radians, from 0 to `outer_angle`.
    float inner_angle;
    // Of a spot: the angle from which on it has none, in radians, above 0 and up to pi/2.
    float outer_angle;
} PelageLight;

// What one frame draws. Read during the call only.
typedef struct PelageFrame {
    // `sizeof(PelageFrame)`.
    uint32_t struct_size;
    // The number of hairs.
    uint32_t hair_count;
    // The hairs, each once; they sort and shadow against each other.
    const struct PelageHair *hairs;
    // The lights, each begun with `PELAGE_LIGHT_INIT`.
    const struct PelageLight *lights;
    // From where, and through which lens. Not NULL.
    const struct PelageView *view;
    // The transparency technique; NULL: what all hairs wish for.
    const struct PelageTransparency *transparency;
    // The number of lights, at most `PELAGE_MAX_LIGHTS`.
    uint32_t light_count;
    // Radiance of a uniform environment, linear RGB, at least 0; it reaches every fibre unshadowed.
    float ambient[3];
} PelageFrame;

// GPU memory that a context will hold once a frame has been rendered, in bytes, the targets left out.
typedef struct PelageMemoryEstimate {
    // `sizeof(PelageMemoryEstimate)`.
    uint32_t struct_size;
    // 0.
    uint32_t reserved;
    // All of it: what is held now, with all hairs, and what the frame adds.
    uint64_t bytes_total;
    // Of these, what is not held yet.
    uint64_t bytes_added;
    // Hairs, and their points and segments as they are projected.
    uint64_t bytes_geometry;
    // Shaded points, and the shading models' tables.
    uint64_t bytes_shading;
    // The lights' maps.
    uint64_t bytes_shadow;
    // The transparency technique's: pixels, and the pool of fragments.
    uint64_t bytes_transparency;
    // The rasteriser's.
    uint64_t bytes_raster;
} PelageMemoryEstimate;

// What a frame did, and what a context holds.
typedef struct PelageStatistics {
    // `sizeof(PelageStatistics)`.
    uint32_t struct_size;
    // 0.
    uint32_t reserved;
    // Strands drawn by the latest frame.
    uint64_t strands;
    // Segments drawn by the latest frame, after curves were cut into straight ones.
    uint64_t segments;
    // Fragments that the rasteriser found within the view's depth range, like all counts of fragments below of the latest
    // frame whose counters have come back: after `pelage_wait`, the latest.
    uint64_t fragments_produced;
    // Of these, dropped before they were stored: since they cannot be seen, or since the technique leaves out what it does
    // not keep.
    uint64_t fragments_culled;
    // Stored one by one.
    uint64_t fragments_stored;
    // Merged into one layer of their pixel: since the pool was too small, or since the technique stores fewer or none.
    uint64_t fragments_merged;
    // Pixels that hold a fragment; counted arrays only, 0 elsewhere.
    uint64_t covered_pixels;
    // Bytes of GPU memory that the context holds beside its targets.
    uint64_t bytes_total;
    // The largest `bytes_total` so far.
    uint64_t bytes_peak;
    // Shadow maps that the latest frame fills: six of a light among the hair, else one a light.
    uint64_t shadow_maps_filled;
    // Shadow maps that it takes as an earlier frame has filled them; see `pelage_context_set_shadow_reuse`.
    uint64_t shadow_maps_taken;
} PelageStatistics;

// GPU memory held under one label. Never grows.
typedef struct PelageLabelBytes {
    // What the memory is for, ended by a NUL.
    char label[PELAGE_LABEL_SIZE];
    // Bytes.
    uint64_t bytes;
} PelageLabelBytes;

// The time of one pass. Never grows.
typedef struct PelagePassTime {
    // The pass's label, as GPU debuggers show it too, ended by a NUL.
    char label[PELAGE_LABEL_SIZE];
    // Milliseconds from its submission to the GPU's end.
    double ms;
} PelagePassTime;

// The host's instance of Vulkan.
typedef struct PelageVulkanInstance {
    // `sizeof(PelageVulkanInstance)`.
    uint32_t struct_size;
    // The `apiVersion` of the `VkApplicationInfo` that it was made with: `VK_API_VERSION_1_3` or newer. No extension of
    // the instance is needed.
    uint32_t api_version;
    // `VkInstance`.
    PelageVkInstance instance;
    // `vkGetInstanceProcAddr`: every function of Vulkan is asked of it.
    PelageVkGetInstanceProcAddr get_instance_proc_addr;
    // 1: the instance was made with `VK_EXT_debug_utils`, and passes shall bear their labels in GPU debuggers.
    uint32_t debug_utils;
    // 0.
    uint32_t reserved;
} PelageVulkanInstance;

// What a device must be made with. It holds structs that `features` points to: do not copy or move it before the device
// has been made.
typedef struct PelageVulkanRequirements {
    // `sizeof(PelageVulkanRequirements)`.
    uint32_t struct_size;
    // `VkQueueFlags` that the family of the queue must have: graphics and compute.
    uint32_t queue_flags;
    // Given: the host's own features, a `VkPhysicalDeviceFeatures2` with its chain, or NULL for none. Set: the same, to be
    // put into `VkDeviceCreateInfo.pNext` (with `pEnabledFeatures` NULL); what pelage requires has been set in the host's
    // structs, and what they have no place for appended to their chain. What the host has set is kept.
    PelageVkFeatures *features;
    // Extensions that the device must be made with beside the host's own: `device_extension_count` names, valid for ever.
    const char *device_extensions[PELAGE_VULKAN_MAX_EXTENSIONS];
    // How many there are.
    uint32_t device_extension_count;
    // 0.
    uint32_t reserved;
    // Where what is appended lives.
    uint64_t storage[PELAGE_VULKAN_FEATURE_STORAGE];
} PelageVulkanRequirements;

// Locks the host's queue, or unlocks it; `user` is what was given with the callback. It must return: no exception, no
// longjmp. It must not call the library.
typedef void (*PelageVulkanLockCallback)(void *user);

// The host's device, and the queue that pelage submits to.
typedef struct PelageVulkanDevice {
    // `sizeof(PelageVulkanDevice)`.
    uint32_t struct_size;
    // The family of the queue.
    uint32_t queue_family;
    // The queue's number within its family, as `vkGetDeviceQueue` takes it.
    uint32_t queue_index;
    // The number of extensions.
    uint32_t extension_count;
    // The extensions that the device was made with: those that were required, at least.
    const char *const *extensions;
    // The instance. Not NULL.
    const struct PelageVulkanInstance *instance;
    // `VkPhysicalDevice`, one of the instance's.
    PelageVkPhysicalDevice physical_device;
    // `VkDevice`, made with what `pelage_vulkan_requirements` has said.
    PelageVkDevice device;
    // Called before the queue is used, on the thread that called the library, by `pelage_vulkan_render` and
    // `pelage_context_destroy` alone. NULL where no other thread uses the queue at the same time.
    PelageVulkanLockCallback lock;
    // Called after it. NULL if `lock` is.
    PelageVulkanLockCallback unlock;
    // Given to both.
    void *lock_user;
    // Bytes of GPU memory that the context may take; 0 for no limit.
    uint64_t byte_budget;
} PelageVulkanDevice;

// An image of the host's: one layer and one mip level of a 2D image. The other ones are not touched, and neither are their
// layouts.
//
// An image of `VK_SHARING_MODE_EXCLUSIVE` that another family of queues has used, or will use next, changes hands. Then the
// submission acquires it in `layout_in` before all else, or releases it in `layout_out` in the end: one half of the transfer,
// by a barrier of that layer and mip level, of all aspects of the format, whose old and new layout are the same. The host
// records the other half with the same layouts, families and subresource on the other queue, and orders the two by a
// semaphore.
typedef struct PelageVulkanImage {
    // `sizeof(PelageVulkanImage)`.
    uint32_t struct_size;
    // `VkFormat`, as the image was made.
    uint32_t format;
    // `VkImage`.
    PelageVkImage image;
    // Width in pixels of mip level 0.
    uint32_t width;
    // Height in pixels of mip level 0.
    uint32_t height;
    // `VkImageUsageFlags`, as the image was made. A colour needs `VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT`, a depth
    // `VK_IMAGE_USAGE_SAMPLED_BIT`, and `VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT` where it is written.
    uint32_t usage;
    // `VkSampleCountFlagBits`, as the image was made: 1. An image of several samples is refused.
    uint32_t samples;
    // `VkImageLayout` in which the image is when the submission begins. `VK_IMAGE_LAYOUT_UNDEFINED`: what it holds is lost,
    // which only a colour that is cleared takes.
    uint32_t layout_in;
    // `VkImageLayout` in which the submission leaves it.
    uint32_t layout_out;
    // `arrayLayers`, as the image was made.
    uint32_t array_layers;
    // `mipLevels`, as the image was made.
    uint32_t mip_levels;
    // The layer that is meant, below `array_layers`.
    uint32_t layer;
    // The mip level that is meant, below `mip_levels`.
    uint32_t mip_level;
    // The family of queues from which the submission acquires the image, as the host has released it there; the number of
    // one of the device's families, `VK_QUEUE_FAMILY_EXTERNAL`, or `VK_QUEUE_FAMILY_FOREIGN_EXT` on a device that was made with
    // `VK_EXT_queue_family_foreign`. The queue's own family and `PELAGE_VULKAN_QUEUE_FAMILY_IGNORED`: it is there already.
    uint32_t owner_before;
    // The family to which the submission releases the image, likewise.
    uint32_t owner_after;
} PelageVulkanImage;

// A shadow map of the host's, by which its opaque scene shadows the hair from one light. Of several maps for one light the
// first decides in whose clip space a point lies; what lies in none is lit.
typedef struct PelageVulkanOccluder {
    // `sizeof(PelageVulkanOccluder)`.
    uint32_t struct_size;
    // The light's place in the frame.
    uint32_t light;
    // The depth of the opaque scene as the light sees it, with `VK_IMAGE_USAGE_SAMPLED_BIT`. Not NULL.
    const struct PelageVulkanImage *depth;
    // The clip space of that depth from world space, column-major. Can be inverted.
    double clip_from_world[16];
    // `PELAGE_VIEW_REVERSE_Z` or `PELAGE_VIEW_FLIP_Y`, both, or 0.
    uint32_t flags;
    // Width of the filter in texels: 1, 3 or 5.
    uint32_t pcf;
    // How far a point is moved towards the light before it is compared, in host units, at least 0.
    float bias;
    // 0.
    uint32_t reserved;
} PelageVulkanOccluder;

// An image of the hair's shadow from one light on the host's opaque scene, for the host's own lighting: each pixel of the
// view's rectangle holds the part of the light, 0 to 1, that the hair lets through to the point that the view's depth stands
// for; 1 at the far plane.
typedef struct PelageVulkanShadowImage {
    // `sizeof(PelageVulkanShadowImage)`.
    uint32_t struct_size;
    // The light's place in the frame.
    uint32_t light;
    // Of the colour's size, with `VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT`: `VK_FORMAT_R32_SFLOAT`, `VK_FORMAT_R16_SFLOAT`,
    // `VK_FORMAT_R8_UNORM`, `VK_FORMAT_R16G16B16A16_SFLOAT` or `VK_FORMAT_R8G8B8A8_UNORM`. Not NULL.
    const struct PelageVulkanImage *image;
} PelageVulkanShadowImage;

// One view of a submission: a frame, and the images that it goes into.
typedef struct PelageVulkanView {
    // `sizeof(PelageVulkanView)`.
    uint32_t struct_size;
    // Any of `PELAGE_RENDER_...`, or 0.
    uint32_t flags;
    // What is drawn. Not NULL.
    const struct PelageFrame *frame;
    // Hair is blended over what it holds, premultiplied. Not NULL.
    const struct PelageVulkanImage *colour;
    // The opaque scene's depth, of the colour's size: it hides hair. NULL for none.
    const struct PelageVulkanImage *depth;
    // What else is written, as `PELAGE_OUTPUT_...` of a target; each NULL for none. All are of the colour's size, with
    // `VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT`, and keep what they hold outside the view's rectangle: only a view that fills
    // them takes `VK_IMAGE_LAYOUT_UNDEFINED`.
    //
    // The nearest fibre's depth: `VK_FORMAT_R32_SFLOAT`.
    const struct PelageVulkanImage *nearest_depth;
    // The part of the pixel that hair covers: `VK_FORMAT_R32_SFLOAT`, `VK_FORMAT_R16_SFLOAT` or `VK_FORMAT_R8_UNORM`.
    const struct PelageVulkanImage *coverage;
    // Motion on the screen: `VK_FORMAT_R32G32_SFLOAT` or `VK_FORMAT_R16G16_SFLOAT`.
    const struct PelageVulkanImage *motion;
    // Hair, instance and strand: `VK_FORMAT_R32G32_UINT`.
    const struct PelageVulkanImage *ids;
    // The host's shadow maps.
    const struct PelageVulkanOccluder *occluders;
    // Images of the hair's shadow on the opaque scene; they need a depth.
    const struct PelageVulkanShadowImage *shadow_images;
    // The number of shadow maps, at most `PELAGE_MAX_OCCLUDERS`.
    uint32_t occluder_count;
    // The number of images, at most `PELAGE_MAX_LIGHTS`.
    uint32_t shadow_image_count;
} PelageVulkanView;

// A semaphore to wait on, or to signal.
typedef struct PelageVulkanSemaphore {
    // `sizeof(PelageVulkanSemaphore)`.
    uint32_t struct_size;
    // `PELAGE_VULKAN_SEMAPHORE_...`, as it was made.
    uint32_t kind;
    // `VkSemaphore`.
    PelageVkSemaphore semaphore;
    // The value of a timeline semaphore; 0 for a binary one.
    uint64_t value;
} PelageVulkanSemaphore;

// One submission to the host's queue. Read during the call only.
typedef struct PelageVulkanSubmit {
    // `sizeof(PelageVulkanSubmit)`.
    uint32_t struct_size;
    // The number of views, at most `PELAGE_VULKAN_MAX_VIEWS`; 0 for a submission of semaphores alone.
    uint32_t view_count;
    // The views, drawn one after another. Where one layer and level of an image is in several, a view finds it in the layout
    // in which the one before has left it, and with that owner.
    const struct PelageVulkanView *views;
    // The semaphores that the submission waits on, before any of its commands.
    const struct PelageVulkanSemaphore *waits;
    // The semaphores that it signals, after all of its commands.
    const struct PelageVulkanSemaphore *signals;
    // The number of semaphores to wait on, at most `PELAGE_VULKAN_MAX_SEMAPHORES`.
    uint32_t wait_count;
    // The number of semaphores to signal, likewise.
    uint32_t signal_count;
} PelageVulkanSubmit;

// Positions in a buffer of the host's: three 32-bit floats a point, in the groom's own space, strand after strand, root first.
typedef struct PelageVulkanPoints {
    // `sizeof(PelageVulkanPoints)`.
    uint32_t struct_size;
    // `VkBufferUsageFlags`, as the buffer was made: with `VK_BUFFER_USAGE_STORAGE_BUFFER_BIT`.
    uint32_t usage;
    // `VkBuffer`, bound to memory.
    PelageVkBuffer buffer;
    // Its size in bytes, as it was made.
    uint64_t size;
    // Bytes before the first position, a multiple of 4.
    uint64_t offset;
    // Bytes from one position to the next: a multiple of 4, at least 12.
    uint64_t stride;
    // The lowest corner of a box around all points, and the curves through them, in the groom's own space. What lies outside
    // the box is drawn, but its shadow may be cut off.
    double low[3];
    // The highest corner.
    double high[3];
    // The family of queues from which the whole buffer is acquired before it is read, as `PelageVulkanImage` has it: the
    // host has released it there, with offset 0 and `VK_WHOLE_SIZE`.
    uint32_t owner_before;
    // The family to which it is released afterwards.
    uint32_t owner_after;
} PelageVulkanPoints;

// A window of the host's, by its raw handles.
typedef struct PelageWindow {
    // `sizeof(PelageWindow)`.
    uint32_t struct_size;
    // `PELAGE_WINDOW_...`: whose handles they are.
    uint32_t kind;
    // As the kind says.
    void *display;
    // As the kind says: a number, or a pointer cast to `uintptr_t`.
    uint64_t window;
    // The number of the X11 screen; otherwise 0.
    uint32_t screen;
    // Width in pixels. Taken where the window system leaves it to the program (Wayland); may be 0 elsewhere.
    uint32_t width;
    // Height in pixels, likewise.
    uint32_t height;
    // `PELAGE_SURFACE_...`.
    uint32_t format;
    // `PELAGE_PRESENT_...`.
    uint32_t present_mode;
    // 1: take a software driver even where a GPU is present.
    uint32_t force_software;
    // 1: load Vulkan's validation layer where it is installed; it writes what it finds to the standard output.
    uint32_t validation;
    // 0.
    uint32_t reserved;
    // Bytes of GPU memory that the context may take beside its targets and the window; 0 for no limit.
    uint64_t byte_budget;
} PelageWindow;

// What a window's surface is, and what it could be.
typedef struct PelageWindowInfo {
    // `sizeof(PelageWindowInfo)`.
    uint32_t struct_size;
    // Width in pixels: that of the target to render; 0 for a window that is minimised.
    uint32_t width;
    // Height in pixels, likewise.
    uint32_t height;
    // `PELAGE_SURFACE_...`, never `PELAGE_SURFACE_AUTO`.
    uint32_t format;
    // `PELAGE_PRESENT_...`.
    uint32_t present_mode;
    // The formats that the surface has: bit `1 << PELAGE_SURFACE_...` of each.
    uint32_t formats;
    // The present modes that it has: bit `1 << PELAGE_PRESENT_...` of each.
    uint32_t present_modes;
} PelageWindowInfo;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library that is linked, as "major.minor.patch". Cannot fail; any thread; valid for ever.
const char *pelage_version(void);

// The ABI's version of the library that is linked: to be compared with `PELAGE_ABI_VERSION`. Cannot fail; any thread.
uint32_t pelage_abi_version(void);

// The sentence of the latest call on this thread that failed; empty if none has. It names the value at fault.
//
// UTF-8, valid until the next failing call on the same thread; never NULL. Calls that succeed keep it. Cannot fail;
// takes no lock, so that it may be called from the log callback too (where it is still the sentence of an earlier call).
const char *pelage_last_error(void);

// Sets the callback that receives the log of the whole process up to `level` (`PELAGE_LOG_...`); NULL, the default, for
// none. There is one: a new one replaces it.
//
// When it returns, the old callback is running on no thread and will not be called again. It therefore waits for one that
// runs: do not call it with a lock held for which the callback waits. Any thread.
//
// Errors: an unknown level; a call from within the callback; a Rust host that has set a logger of its own
// (`PELAGE_UNSUPPORTED`).
PelageResult pelage_set_log_callback(uint32_t level,
                                     PelageLogCallback callback,
                                     void *user);

// Opens a device and makes a context on it, which `*context` receives.
//
// Calls on one context, and on what was made on it, may come from any thread and wait for each other; contexts run beside
// each other.
//
// Errors: `PELAGE_UNSUPPORTED` where there is no Vulkan driver, or one that falls short.
PelageResult pelage_context_create(const struct PelageContextDescriptor *descriptor,
                                   struct PelageContext *context);

// Destroys a context with all its hairs, targets and readbacks, whose handles are stale from then on. Waits for calls on
// it that run on other threads.
PelageResult pelage_context_destroy(struct PelageContext context);

// Says what a context runs on.
PelageResult pelage_context_adapter(struct PelageContext context, struct PelageAdapter *adapter);

// Limits the GPU memory that a context takes beside its targets to `bytes`; 0 lifts the limit. What it holds is kept.
PelageResult pelage_context_set_byte_budget(struct PelageContext context, uint64_t bytes);

// Whether frames take the shadow maps that an earlier frame has filled, where all is as it was then: the hairs' points, places
// and opacities, the light and its technique, whatever the view. 1, which is the default, does not change the picture; 0 is for
// measurements of frames with everything new.
PelageResult pelage_context_set_shadow_reuse(struct PelageContext context,
                                             uint32_t reuse);

// Waits until the GPU has done all that was asked of it on a context. Other calls on the context wait too.
//
// Errors: `PELAGE_DEVICE_LOST`.
PelageResult pelage_wait(struct PelageContext context);

// Absorption per fibre radius, linear RGB, of hair with these concentrations of melanin, each from 0 to 100000; brown hair
// has 1.3 and 0. `sigma_a` takes three floats.
//
// Errors: a concentration out of its range; NULL.
PelageResult pelage_sigma_a_from_melanin(float eumelanin,
                                         float pheomelanin,
                                         float *sigma_a);

// Absorption per fibre radius, linear RGB, with which a volume of hair has about this linear colour (each channel above 0,
// at most 1) after all scattering, at an azimuthal roughness from 0.001 to 1. `colour` has and `sigma_a` takes three floats.
//
// Errors: a value out of its range; NULL.
PelageResult pelage_sigma_a_from_reflectance(const float *colour,
                                             float beta_n,
                                             float *sigma_a);

// Absorption per fibre radius, linear RGB, of `PELAGE_HAIR_COLOUR_...`. `sigma_a` takes three floats.
//
// Errors: an unknown colour; NULL.
PelageResult pelage_sigma_a_of(uint32_t colour, float *sigma_a);

// Makes a hair of strands: default shading, fully opaque fibres, no wishes, and the identity for its transform.
//
// Errors: a value out of its range, named by strand and point; no memory.
PelageResult pelage_hair_create_from_strands(struct PelageContext context,
                                             const struct PelageStrands *strands,
                                             struct PelageHair *hair);

// Makes a hair of many strands between few guides that grow from a mesh. The guides themselves are not among them.
//
// A triangle gets area times density strands, each a blend of its three guides.
//
// Errors: as `pelage_hair_create_from_strands`; a triangle that names no guide; guides without triangles; more than 2^24
// strands to be expected.
PelageResult pelage_hair_create_interpolated_on_mesh(struct PelageContext context,
                                                     const struct PelageStrands *guides,
                                                     const struct PelageInterpolationSettings *settings,
                                                     struct PelageHair *hair);

// As `pelage_hair_create_interpolated_on_mesh`, for a hair that remembers its guides: `pelage_hair_update_guides` moves them,
// and all strands after them. Takes 12 bytes of GPU memory more a point, and 48 a strand.
PelageResult pelage_hair_create_guided_on_mesh(struct PelageContext context,
                                               const struct PelageStrands *guides,
                                               const struct PelageInterpolationSettings *settings,
                                               struct PelageHair *hair);

// Makes a hair of guides, each with followers around it; no mesh is needed. A guide comes first, then its followers.
//
// Errors: as `pelage_hair_create_from_strands`; more than 2^24 strands.
PelageResult pelage_hair_create_interpolated_clumps(struct PelageContext context,
                                                    const struct PelageStrands *guides,
                                                    const struct PelageClumpSettings *settings,
                                                    struct PelageHair *hair);

// As `pelage_hair_create_interpolated_clumps`, for a hair that remembers its guides: `pelage_hair_update_guides` moves them,
// and all strands after them. Takes 12 bytes of GPU memory more a point, and 24 a follower.
PelageResult pelage_hair_create_guided_clumps(struct PelageContext context,
                                              const struct PelageStrands *guides,
                                              const struct PelageClumpSettings *settings,
                                              struct PelageHair *hair);

// Makes a hair of a file in memory.
//
// Errors: `PELAGE_INVALID_FILE` for bytes that are neither format, truncated or corrupt; a radius out of its range.
PelageResult pelage_hair_create_from_file(struct PelageContext context,
                                          const struct PelageFile *file,
                                          struct PelageHair *hair);

// Makes a hair out of nothing: `strand_count` strands (0 to about 2^23) of a built-in groom (`PELAGE_BUILTIN_...`) on a
// head-shaped scalp, in metres, +y up, the face towards +z, the origin between the ears. The same on every call.
//
// Errors: an unknown groom; too many strands.
PelageResult pelage_hair_create_builtin(struct PelageContext context,
                                        uint32_t groom,
                                        uint64_t strand_count,
                                        struct PelageHair *hair);

// States in `*bytes` the GPU memory that a hair of strands will take, in bytes, before it is made. As much work as
// `pelage_hair_create_from_strands`, but for the upload; allocates no GPU memory.
//
// Errors: as that function's.
PelageResult pelage_hair_memory_estimate(struct PelageContext context,
                                         const struct PelageStrands *strands,
                                         uint64_t *bytes);

// Destroys a hair. Frames that were rendered with it are not touched.
PelageResult pelage_hair_destroy(struct PelageHair hair);

// Says what a hair is made of. The box is that of the positions that the CPU gave last; those of guides or of a buffer are not
// known to it.
PelageResult pelage_hair_info(struct PelageHair hair,
                              struct PelageHairInfo *info);

// Copies a hair's positions, as the CPU gave them last (guides and buffers do not change them), into `positions`: three floats a point, `size` bytes in all, which
// must be 12 times the number of points.
PelageResult pelage_hair_points(struct PelageHair hair,
                                float *positions,
                                uint64_t size);

// Moves a hair: replaces every position by three floats of `positions` a point, `point_count` points, as many as the hair
// has. Takes effect with the next frame rendered.
//
// Errors: another number of points; a position that is not finite; on the host's Vulkan device, an update of this hair by its
// guides or by a buffer that no submission has taken yet, or 16 updates of any kind (`PELAGE_CONFLICT`): render first.
PelageResult pelage_hair_update_points(struct PelageHair hair,
                                       const float *positions,
                                       uint64_t point_count);

// Moves the guides of a hair that remembers them, and all its strands after them, on the GPU: three floats of `positions` a
// point of the guides, `point_count` points, as many as they have. Takes effect with the next frame rendered; on the host's
// Vulkan device as the first thing that the next submission does.
//
// The number of strands, and what was drawn by chance, stays as it was. `pelage_hair_points` is not told of the new positions.
//
// Errors: a hair that was not made by `pelage_hair_create_guided_...`; another number of points; a position that is not
// finite; no memory; on the host's Vulkan device, 16 updates of this hair that no submission has taken yet (`PELAGE_CONFLICT`).
PelageResult pelage_hair_update_guides(struct PelageHair hair,
                                       const float *positions,
                                       uint64_t point_count);

// Places a hair: `world_from_object`, 16 doubles, column-major, an affine transform that can be inverted.
PelageResult pelage_hair_set_transform(struct PelageHair hair, const double *world_from_object);

// Says where a hair was in the frame before, for motion vectors: `world_from_object` of then, 16 doubles, column-major. NULL: where
// it is.
PelageResult pelage_hair_set_previous_transform(struct PelageHair hair,
                                                const double *world_from_object);

// Draws `count` copies of a hair, up to 65535, each placed by its own transform and then by the hair's:
// `object_from_instance`, 16 doubles a copy, column-major, affine transforms that can be inverted.
// `previous_object_from_instance`: the same of the frame before, for motion vectors, or NULL. 0 copies: the hair itself, once.
//
// Errors: a transform that is not affine, not finite or cannot be inverted; too many copies.
PelageResult pelage_hair_set_instances(struct PelageHair hair,
                                       const double *object_from_instance,
                                       const double *previous_object_from_instance,
                                       uint32_t count);

// Says that a hair's points have not moved since the frame before, whatever `pelage_hair_update_points` did then: their motion is
// zero until the next update.
PelageResult pelage_hair_rest(struct PelageHair hair);

// Sets the fibres' own opacity, from 0 to 1.
PelageResult pelage_hair_set_opacity(struct PelageHair hair, float opacity);

// Sets a hair's shading model, and where it is evaluated.
PelageResult pelage_hair_set_shading(struct PelageHair hair, const struct PelageShading *shading);

// Sets the shadow technique that a hair wishes for lights that name none; NULL: no wish. Where no hair has one, lights
// are shadowed as `PELAGE_SHADOW_INIT` says.
PelageResult pelage_hair_set_shadow(struct PelageHair hair, const struct PelageShadow *shadow);

// Sets the transparency technique that a hair wishes for frames that name none; NULL: no wish. Where no hair has one,
// frames are drawn as `PELAGE_TRANSPARENCY_INIT` says.
PelageResult pelage_hair_set_transparency(struct PelageHair hair, const struct PelageTransparency *transparency);

// Makes a target: its colour transparent black, its depth, if it has one, 1.
//
// Errors: a size of zero or beyond the device's largest; an unknown format; no memory.
PelageResult pelage_target_create(struct PelageContext context,
                                  const struct PelageTargetDescriptor *descriptor,
                                  struct PelageTarget *target);

// Destroys a target. Readbacks of it are not touched.
PelageResult pelage_target_destroy(struct PelageTarget target);

// Writes a target's colour: the opaque scene under the hair. Four floats a pixel whatever the format, row 0 at the top,
// `size` bytes in all: 16 times width times height. 16-bit floats hold 65504 at most; what is beyond is held at that.
//
// Errors: another size; a value that is not finite.
PelageResult pelage_target_write_colour(struct PelageTarget target, const float *pixels, uint64_t size);

// Writes a target's depth: what of the opaque scene hides hair. One float a pixel, 0 to 1, row 0 at the top, `size`
// bytes in all: 4 times width times height.
//
// Errors: a target without a depth; another size; a value outside 0 to 1.
PelageResult pelage_target_write_depth(struct PelageTarget target, const float *depths, uint64_t size);

// Reads a target's colour as it is after all rendering so far, into `pixels`: four floats a pixel whatever the format,
// row 0 at the top, `size` bytes in all: 16 times width times height. Waits for the GPU; see `pelage_readback_begin_colour`.
//
// Errors: another size; `PELAGE_DEVICE_LOST`.
PelageResult pelage_target_read_colour(struct PelageTarget target,
                                       float *pixels,
                                       uint64_t size);

// Reads a target's depth as it is after all rendering so far, into `depths`: one float a pixel, row 0 at the top, `size`
// bytes in all: 4 times width times height. Waits for the GPU; see `pelage_readback_begin_depth`.
//
// Errors: a target without a depth; another size; `PELAGE_DEVICE_LOST`.
PelageResult pelage_target_read_depth(struct PelageTarget target,
                                      float *depths,
                                      uint64_t size);

// Reads one of a target's outputs (`PELAGE_OUTPUT_...`) as it is after all rendering so far into `values`, row 0 at the top, `size`
// bytes in all: 4 times width times height, or 8 times for motion and ids. Waits for the GPU.
//
// Errors: not exactly one output; one that the target was made without; another size; `PELAGE_DEVICE_LOST`.
PelageResult pelage_target_read_output(struct PelageTarget target,
                                       uint32_t which,
                                       void *values,
                                       uint64_t size);

// Sends a copy of a target's colour, as it is after all rendering so far, on its way to the host. Does not wait.
//
// Errors: an image larger than the device's largest buffer; no memory.
PelageResult pelage_readback_begin_colour(struct PelageTarget target, struct PelageReadback *readback);

// Sends a copy of a target's depth on its way to the host; see `pelage_readback_begin_colour`.
//
// Errors: a target without a depth; likewise.
PelageResult pelage_readback_begin_depth(struct PelageTarget target, struct PelageReadback *readback);

// Sets `*arrived` to 1 if the image has arrived, else to 0. Does not wait for the GPU.
//
// Errors: `PELAGE_DEVICE_LOST`.
PelageResult pelage_readback_poll(struct PelageReadback readback, uint32_t *arrived);

// Copies the image into `values`: of a colour four floats a pixel, of a depth one, row 0 at the top, `size` bytes in all.
// Waits for it if it has not arrived. May be called again.
//
// Errors: another size; `PELAGE_DEVICE_LOST`.
PelageResult pelage_readback_copy(struct PelageReadback readback,
                                  float *values,
                                  uint64_t size);

// Destroys a readback, whether the image has arrived or not.
PelageResult pelage_readback_destroy(struct PelageReadback readback);

// Fills `*view`, begun with `PELAGE_VIEW_INIT`, with a perspective view from `eye` towards `target` (three doubles each,
// world space). `up` is not parallel to the way from eye to target; `vertical_fov` is in radians, above 0 and below pi;
// `aspect` is width over height; clip depth is 0 at `near_plane` and 1 at `far_plane`, both distances above 0.
//
// Errors: values that are not finite or make no view.
PelageResult pelage_view_perspective(const double *eye,
                                     const double *target,
                                     const double *up,
                                     double vertical_fov,
                                     double aspect,
                                     double near_plane,
                                     double far_plane,
                                     struct PelageView *view);

// Renders a frame into a target of the same context: the target's depth, if it has one, hides hair. `flags`: any of
// `PELAGE_RENDER_...`, or 0. Gives the work to the GPU and does not wait for it; what reads the target afterwards does.
//
// Errors: a value out of its range; hairs that wish for different techniques (`PELAGE_CONFLICT`);
// `PELAGE_RENDER_WRITE_DEPTH` or `PELAGE_RENDER_RECEIVE_SHADOW` without a depth; no memory. Nothing is then drawn.
PelageResult pelage_render(struct PelageContext context,
                           const struct PelageFrame *frame,
                           struct PelageTarget target,
                           uint32_t flags);

// As `pelage_render`, but gives pass after pass to the GPU, waits for each, and keeps their times for
// `pelage_pass_times`. Slower by the waits.
PelageResult pelage_render_timed(struct PelageContext context,
                                 const struct PelageFrame *frame,
                                 struct PelageTarget target,
                                 uint32_t flags);

// States in `*estimate`, begun with `PELAGE_MEMORY_ESTIMATE_INIT`, the GPU memory that the context will hold once `frame` has
// been rendered with `flags` into a target like `*target`, which need not exist. It follows from the techniques, the hairs,
// the size, `pool_bytes` and the byte budget, and from what the last frames left. Renders and allocates nothing. A view's
// occluders and shadow images take nothing more; of a view that writes these alone `PELAGE_RENDER_SHADOWS_ONLY` says so.
//
// Errors: as `pelage_render`, but for memory.
PelageResult pelage_frame_memory_estimate(struct PelageContext context,
                                          const struct PelageFrame *frame,
                                          const struct PelageTargetDescriptor *target,
                                          uint32_t flags,
                                          struct PelageMemoryEstimate *estimate);

// Says what the latest frame did, and what the context holds, in `*statistics`, begun with `PELAGE_STATISTICS_INIT`.
// Does not wait.
PelageResult pelage_statistics(struct PelageContext context, struct PelageStatistics *statistics);

// Lists the GPU memory that a context holds beside its targets, by label: fills at most `capacity` entries and sets
// `*count` to how many there are. `entries` may be NULL if `capacity` is 0.
PelageResult pelage_bytes_by_label(struct PelageContext context,
                                   uint64_t capacity,
                                   struct PelageLabelBytes *entries,
                                   uint64_t *count);

// Lists the passes of a context's latest `pelage_render_timed`, in their order: fills at most `capacity` entries and sets
// `*count` to how many there are, 0 if there was no such frame. `entries` may be NULL if `capacity` is 0.
PelageResult pelage_pass_times(struct PelageContext context,
                               uint64_t capacity,
                               struct PelagePassTime *entries,
                               uint64_t *count);

// Says whether pelage runs on a physical device, and what a `VkDevice` of it must be made with. Call it before the device
// is made, with `*requirements` begun with `PELAGE_VULKAN_REQUIREMENTS_INIT` and its `features` set to the host's own.
//
// `PELAGE_OK` is the yes. `PELAGE_UNSUPPORTED` is the no, and `pelage_last_error` the reason.
//
// Errors: a handle that is NULL or does not belong to the instance.
PelageResult pelage_vulkan_requirements(const struct PelageVulkanInstance *instance,
                                        PelageVkPhysicalDevice physical_device,
                                        struct PelageVulkanRequirements *requirements);

// Makes a context on the host's device, which `*context` receives. All functions but those of targets, readbacks and
// `pelage_render` serve it; `pelage_vulkan_render` draws. Several contexts may share a device and a queue.
//
// The host keeps the instance and the device until the context has been destroyed. Nothing of the host's is destroyed.
//
// Errors: a handle that is NULL or does not belong to the others; a queue that is not there; an extension that is required
// and missing; a device that falls short (`PELAGE_UNSUPPORTED`); no memory.
PelageResult pelage_vulkan_context_create(const struct PelageVulkanDevice *device,
                                          struct PelageContext *context);

// Records views of hair into the host's images and submits them to the host's queue, all at once. Does not wait for the
// GPU, unless more than `PELAGE_VULKAN_MAX_VIEWS` views of the context are on their way.
//
// In the queue's order a full barrier stands before the commands of each view and after them: what the host submits to the
// same queue before or after needs no semaphore. Images stay valid until the GPU is done with the submission.
//
// Do not hold what `lock` locks. Wait for what has been submitted already, or is signalled by another thread: drivers may
// block within `vkQueueSubmit` as long as an earlier submission cannot begin.
//
// Errors: an image that cannot be drawn into; all of `pelage_render`'s; a context with a device of its own
// (`PELAGE_UNSUPPORTED`). Nothing is then submitted, and no semaphore waited on or signalled. `PELAGE_DEVICE_LOST`, or
// `PELAGE_OUT_OF_MEMORY` from the driver at the submission: the context is dead; destroy it.
PelageResult pelage_vulkan_render(struct PelageContext context,
                                  const struct PelageVulkanSubmit *submit);

// Moves a hair on the host's Vulkan device by positions in a buffer of the host's, in the host's order of strands. The next
// `pelage_vulkan_render` of the context that succeeds reads them, before its views and after the semaphores that it waits
// on; one of no views does too. Several updates of a hair happen in turn.
//
// In the queue's order a full barrier stands before the buffer is read and after: what the host submits to the same queue to
// fill it, before or after, needs no semaphore. The buffer belongs to the queue's family, is `CONCURRENT`, or changes hands by
// `owner_before` and `owner_after`; where several updates read one buffer, the first acquires it and the last releases it. It
// and its memory stay valid until the GPU is done with that submission, or the context has been destroyed. It is never
// destroyed.
//
// A position that is not finite leaves its point where it was. `pelage_hair_points` is not told of the new positions.
//
// Errors: a buffer that is NULL, too small or without its usage; an offset, stride, box or family out of range; no memory; 16
// updates of this hair that no submission has taken yet (`PELAGE_CONFLICT`); a context with a device of its own
// (`PELAGE_UNSUPPORTED`).
PelageResult pelage_vulkan_update_points(struct PelageHair hair,
                                         const struct PelageVulkanPoints *points);

// As `pelage_vulkan_update_points`, for the guides of a hair that remembers them: all strands follow. The box is that of the
// guides; what stands out from them is added, as long as guides keep their length.
//
// Errors: those; a hair that was not made by `pelage_hair_create_guided_...`.
PelageResult pelage_vulkan_update_guides(struct PelageHair hair,
                                         const struct PelageVulkanPoints *points);

// Opens a device that can show its pictures in a window of the host's, and makes a context on it, which `*context`
// receives. All functions that serve a context of `pelage_context_create` serve it too: render into a target, then
// `pelage_window_present` it. One context a window.
//
// The window stays the host's, with its events; it is destroyed after the context. Its handles may be used on every thread
// that uses the context: with Xlib call `XInitThreads` first, on macOS use the main thread alone.
//
// Errors: handles that are NULL or of no kind; `PELAGE_UNSUPPORTED` where no Vulkan driver can show the window, or its
// surface lacks the format or the present mode.
PelageResult pelage_window_context_create(const struct PelageWindow *window,
                                          struct PelageContext *context);

// Says that a context's window has another size, in pixels; 0 and 0 where it is minimised. Targets are the host's to make
// anew, in the size that `pelage_window_info` says.
//
// Errors: `PELAGE_UNSUPPORTED` for a context without a window.
PelageResult pelage_window_resize(struct PelageContext context,
                                  uint32_t width,
                                  uint32_t height);

// Changes how frames come to the screen: `PELAGE_PRESENT_...`.
//
// Errors: `PELAGE_UNSUPPORTED` for a mode that the window does not have, which leaves the old one; for a context without
// a window.
PelageResult pelage_window_set_present_mode(struct PelageContext context,
                                            uint32_t present_mode);

// Says what a context's window is now, in `*info`, begun with `PELAGE_WINDOW_INFO_INIT`.
//
// Errors: `PELAGE_UNSUPPORTED` for a window that is no more, and for a context without one.
PelageResult pelage_window_info(struct PelageContext context, struct PelageWindowInfo *info);

// Shows a target in the context's window, over `clear`, three floats, linear RGB; NULL for black. The target's upper left
// is the window's; what it does not reach shows `clear`, what does not fit is cut off. Sets `*outcome` to
// `PELAGE_PRESENTED`, or to the `PELAGE_SKIPPED_...` that says why the window still shows what it did; `outcome` may be NULL.
//
// A surface that is lost or outdated is made anew. With `PELAGE_PRESENT_FIFO` the call may wait for the screen, and other
// calls on the context with it.
//
// Errors: a colour that is not finite; a target of another context; `PELAGE_UNSUPPORTED` for a window that is no more, and
// for a context without one; `PELAGE_DEVICE_LOST`.
PelageResult pelage_window_present(struct PelageContext context,
                                   struct PelageTarget target,
                                   const float *clear,
                                   uint32_t *outcome);

/* What structs begin with. */
#define PELAGE_CONTEXT_DESCRIPTOR_INIT { sizeof(PelageContextDescriptor), 0, 0, 0, 0 }
#define PELAGE_ADAPTER_INIT { sizeof(PelageAdapter), 0, { 0 }, { 0 } }
#define PELAGE_STRANDS_INIT { sizeof(PelageStrands), 0, NULL, 0, NULL, 0, NULL, NULL, NULL, 0.0f, 0.0f }
#define PELAGE_INTERPOLATION_SETTINGS_INIT { sizeof(PelageInterpolationSettings), 0, NULL, 0, 0.0f, 0.75f, 0.0f, 0.0f }
#define PELAGE_CLUMP_SETTINGS_INIT { sizeof(PelageClumpSettings), 0, 4, 0.0f, 0.5f, 0.0f, 0.0f, 0 }
#define PELAGE_FILE_INIT { sizeof(PelageFile), 0, NULL, 0, 0.0f, 0.0f }
#define PELAGE_HAIR_INFO_INIT { sizeof(PelageHairInfo), 0, 0, 0, { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f } }
#define PELAGE_KAJIYA_KAY_INIT { sizeof(PelageKajiyaKay), { 0.2324944f, 0.18368948f, 0.09059402f }, { 0.09f, 0.09f, 0.09f }, 60.0f }
#define PELAGE_SCHEUERMANN_INIT { sizeof(PelageScheuermann), { 0.2324944f, 0.18368948f, 0.09059402f }, { { 0.06f, 0.06f, 0.06f }, 120.0f, 0.07f }, { { 0.2324944f, 0.18368948f, 0.09059402f }, 30.0f, -0.1f } }
#define PELAGE_MARSCHNER_INIT { sizeof(PelageMarschner), 1.55f, { 0.54469997f, 0.9061f, 1.7809999f }, { -0.1308997f, 0.06544985f, 0.19634955f }, { 0.1308997f, 0.06544985f, 0.2617994f }, 1.0f, 0, 1, 0.2617994f, 0.5f, 0.3f, 0.5f, { 1.0f, 1.0f, 1.0f }, 64, 0, 0, 1.0f, 0.7f, 0.0f, 1.0f, 0.0f, 1.0f }
#define PELAGE_SADEGHI_INIT { sizeof(PelageSadeghi), { { 1.0f, 1.0f, 1.0f }, 0.3f, -0.1308997f, 0.1308997f }, { { 0.9f, 0.7f, 0.4f }, 0.8f, 0.06544985f, 0.06544985f }, { { 0.8f, 0.5f, 0.25f }, 0.2f, 0.19634955f, 0.2617994f }, 0.34906584f, 0.5f, 0.17453292f, { 0.5235988f, 0.7853982f }, 1, { 1.0f, 1.0f, 1.0f }, 0, 1.0f, 0.7f, 0.0f, 1.0f, 0.0f, 1.0f }
#define PELAGE_CHIANG_INIT { sizeof(PelageChiang), 0.3f, 0.3f, 0.034906585f, 1.55f, { 0.54469997f, 0.9061f, 1.7809999f }, { 1.0f, 1.0f, 1.0f }, 32, 64, 0, 0, 1.0f, 0.7f, 0.0f, 1.0f, 0.0f, 0, 1.0f }
#define PELAGE_SHADING_INIT { sizeof(PelageShading), 0, NULL, NULL, NULL, NULL, NULL, 0, 0 }
#define PELAGE_DEEP_OPACITY_MAP_INIT { sizeof(PelageDeepOpacityMap), 512, 16, 1, 1.0f, 0, { 0.0f, 0.0f, 0.0f } }
#define PELAGE_MOMENT_OPACITY_MAP_INIT { sizeof(PelageMomentOpacityMap), 512, 6, 1, { 0.0f, 0.0f, 0.0f }, 0 }
#define PELAGE_K_BUFFER_VOLUME_INIT { sizeof(PelageKBufferVolume), 512, 16, 3, 1, 0, 1.55f, { 0.0f, 0.0f, 0.0f }, 0 }
#define PELAGE_SHADOW_INIT { sizeof(PelageShadow), 1, NULL, NULL, NULL, NULL, NULL, NULL }
#define PELAGE_SHADOW_MAP_INIT { sizeof(PelageShadowMap), 512, 5, 1.0f, 0 }
#define PELAGE_APPROXIMATED_DEEP_SHADOW_MAP_INIT { sizeof(PelageApproximatedDeepShadowMap), 512, 3, 0.0f, 0.0f, 0 }
#define PELAGE_OPACITY_SHADOW_MAPS_INIT { sizeof(PelageOpacityShadowMaps), 256, 256, 0.0f, 3, 0 }
#define PELAGE_OPAQUE_INIT { sizeof(PelageOpaque), 0 }
#define PELAGE_A_BUFFER_INIT { sizeof(PelageABuffer), 0, 0, 0, 0 }
#define PELAGE_WEIGHTED_BLENDED_INIT { sizeof(PelageWeightedBlended), 2, 4.0f, 0 }
#define PELAGE_DEPTH_PEELING_INIT { sizeof(PelageDepthPeeling), 16, 0 }
#define PELAGE_RANDOM_SUBSETS_INIT { sizeof(PelageRandomSubsets), 8, 0, 1, 0 }
#define PELAGE_SORTED_BLENDING_INIT { sizeof(PelageSortedBlending), 1024, 0, 0, 0 }
#define PELAGE_K_BUFFER_INIT { sizeof(PelageKBuffer), 16, 0, 0, 0, 0, 0 }
#define PELAGE_K_PLUS_BUFFER_INIT { sizeof(PelageKPlusBuffer), 8, 1, 0, 0 }
#define PELAGE_K_BUFFER_SINGLE_PASS_INIT { sizeof(PelageKBufferSinglePass), 8, 0, 32, 0, 0, 0 }
#define PELAGE_MOMENT_INIT { sizeof(PelageMoment), 0 }
#define PELAGE_TRANSPARENCY_INIT { sizeof(PelageTransparency), 10, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL }
#define PELAGE_DBK_BUFFER_INIT { sizeof(PelageDbkBuffer), 0.00390625f, 0.0f, 0, 0, 0, 0 }
#define PELAGE_VIEW_INIT { sizeof(PelageView), 0, { 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 }, { 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 }, { 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 }, { 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 }, { 0.0f, 0.0f }, { 0.0f, 0.0f }, { 0, 0, 0, 0 } }
#define PELAGE_LIGHT_INIT { sizeof(PelageLight), 0, { 0.0, -1.0, 0.0 }, { 0.0, 0.0, 0.0 }, { 1.0f, 1.0f, 1.0f }, 0, NULL, 0.4f, 0.5f }
#define PELAGE_FRAME_INIT { sizeof(PelageFrame), 0, NULL, NULL, NULL, NULL, 0, { 0.0f, 0.0f, 0.0f } }
#define PELAGE_TARGET_DESCRIPTOR_INIT { sizeof(PelageTargetDescriptor), 0, 0, 0, 0, 0 }
#define PELAGE_MEMORY_ESTIMATE_INIT { sizeof(PelageMemoryEstimate), 0, 0, 0, 0, 0, 0, 0, 0 }
#define PELAGE_STATISTICS_INIT { sizeof(PelageStatistics), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }
#define PELAGE_VULKAN_INSTANCE_INIT { sizeof(PelageVulkanInstance), 0, NULL, NULL, 0, 0 }
#define PELAGE_VULKAN_REQUIREMENTS_INIT { sizeof(PelageVulkanRequirements), 0, NULL, { NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL }, 0, 0, { 0 } }
#define PELAGE_VULKAN_DEVICE_INIT { sizeof(PelageVulkanDevice), 0, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL, 0 }
#define PELAGE_VULKAN_IMAGE_INIT { sizeof(PelageVulkanImage), 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 4294967295, 4294967295 }
#define PELAGE_VULKAN_VIEW_INIT { sizeof(PelageVulkanView), 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, 0, 0 }
#define PELAGE_VULKAN_OCCLUDER_INIT { sizeof(PelageVulkanOccluder), 0, NULL, { 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 }, 0, 3, 0.0f, 0 }
#define PELAGE_VULKAN_SHADOW_IMAGE_INIT { sizeof(PelageVulkanShadowImage), 0, NULL }
#define PELAGE_VULKAN_POINTS_INIT { sizeof(PelageVulkanPoints), 0, 0, 0, 0, 12, { 0.0, 0.0, 0.0 }, { 0.0, 0.0, 0.0 }, 4294967295, 4294967295 }
#define PELAGE_VULKAN_SEMAPHORE_INIT { sizeof(PelageVulkanSemaphore), 0, 0, 0 }
#define PELAGE_VULKAN_SUBMIT_INIT { sizeof(PelageVulkanSubmit), 0, NULL, NULL, NULL, 0, 0 }
#define PELAGE_WINDOW_INIT { sizeof(PelageWindow), 0, NULL, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }
#define PELAGE_WINDOW_INFO_INIT { sizeof(PelageWindowInfo), 0, 0, 0, 0, 0, 0 }

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PELAGE_H */
