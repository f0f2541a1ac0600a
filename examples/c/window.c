/*
 * A built-in hairstyle in a window, seen by a camera that goes round it. The window is GLFW's; pelage gets its raw handles.
 *
 *     cc examples/c/window.c -Iinclude -Ltarget/release -lpelage -lglfw -lX11 -lm -o window
 *     ./window [--frames N] [--screenshot picture.ppm] [--size WxH] [--strands N] [--turn RADIANS] [--format srgb8|unorm8]
 *
 * Add -DPELAGE_EXAMPLE_WAYLAND, without -lX11, where GLFW is built for Wayland. The camera turns by --turn a frame.
 * --screenshot reads the window's own pixels back from the X server after the last frame.
 *
 * Keys: T transparency, S shadow, R rasteriser, P present mode, space stops the camera, escape ends.
 */
#if defined(_WIN32)
#define GLFW_EXPOSE_NATIVE_WIN32
#elif defined(__APPLE__)
#define GLFW_EXPOSE_NATIVE_COCOA
#elif defined(PELAGE_EXAMPLE_WAYLAND)
#define GLFW_EXPOSE_NATIVE_WAYLAND
#else
#define GLFW_EXPOSE_NATIVE_X11
#define SCREENSHOTS 1
#endif
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#if defined(SCREENSHOTS)
#include <X11/Xutil.h>
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelage.h"

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

/* What the keys change. */
typedef struct {
    int transparency, shadow, raster, present, stopped;
    int resized;
} Choices;

static const char *const transparencies[] = { "DBK-buffer", "A-buffer, counted", "A-buffer, lists", "opaque" };
static const char *const shadows[] = { "deep opacity map", "no shadow" };
static const char *const rasters[] = { "auto", "ribbons", "walk" };
static const char *const present_modes[] = { "fifo", "mailbox", "immediate" };

static void on_key(GLFWwindow *window, int key, int scancode, int action, int modifiers) {
    Choices *choices = glfwGetWindowUserPointer(window);
    (void)scancode;
    (void)modifiers;
    if (action != GLFW_PRESS) {
        return;
    }
    switch (key) {
    case GLFW_KEY_T: choices->transparency = (choices->transparency + 1) % 4; break;
    case GLFW_KEY_S: choices->shadow = (choices->shadow + 1) % 2; break;
    case GLFW_KEY_R: choices->raster = (choices->raster + 1) % 3; break;
    case GLFW_KEY_P: choices->present = (choices->present + 1) % 3; break;
    case GLFW_KEY_SPACE: choices->stopped = !choices->stopped; break;
    case GLFW_KEY_ESCAPE: glfwSetWindowShouldClose(window, GLFW_TRUE); break;
    default: break;
    }
}

static void on_size(GLFWwindow *window, int width, int height) {
    Choices *choices = glfwGetWindowUserPointer(window);
    (void)width;
    (void)height;
    choices->resized = 1;
}

/* The window's raw handles, as pelage takes them. */
static PelageWindow describe(GLFWwindow *window) {
    PelageWindow raw = PELAGE_WINDOW_INIT;
    int width, height;
    glfwGetFramebufferSize(window, &width, &height);
    raw.width = (uint32_t)width;
    raw.height = (uint32_t)height;
#if defined(_WIN32)
    raw.kind = PELAGE_WINDOW_WIN32;
    raw.display = GetModuleHandle(NULL);
    raw.window = (uintptr_t)glfwGetWin32Window(window);
#elif defined(__APPLE__)
    /* The view of the NSWindow: [window contentView], which plain C asks for through the Objective-C runtime. */
    extern void *objc_msgSend(void *object, void *selector);
    extern void *sel_registerName(const char *name);
    raw.kind = PELAGE_WINDOW_APPKIT;
    raw.window = (uintptr_t)objc_msgSend(glfwGetCocoaWindow(window), sel_registerName("contentView"));
#elif defined(PELAGE_EXAMPLE_WAYLAND)
    raw.kind = PELAGE_WINDOW_WAYLAND;
    raw.display = glfwGetWaylandDisplay();
    raw.window = (uintptr_t)glfwGetWaylandWindow(window);
#else
    raw.kind = PELAGE_WINDOW_XLIB;
    raw.display = glfwGetX11Display();
    raw.window = glfwGetX11Window(window);
    raw.screen = (uint32_t)DefaultScreen(glfwGetX11Display());
#endif
    return raw;
}

/* A target of the window's size in the place of the old one; none while the window has no pixels. */
static PelageTarget fit_target(PelageContext context, PelageTarget old, const PelageWindowInfo *info) {
    PelageTarget target = { 0 };
    if (old.id) {
        check(pelage_target_destroy(old), "target");
    }
    if (info->width && info->height) {
        PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
        image.width = info->width;
        image.height = info->height;
        check(pelage_target_create(context, &image, &target), "target");
    }
    return target;
}

/* The hair from an angle around the head, lit by one sun, by the techniques that are chosen. */
static void render(PelageContext context, PelageHair hair, PelageTarget target, double angle, double aspect,
                   const Choices *choices) {
    /* The head's origin lies between the ears; it looks along +z, in metres. */
    const double start[2] = { 0.6, -0.75 };
    const double eye[3] = { cos(angle) * start[0] - sin(angle) * start[1], 0.15,
                            sin(angle) * start[0] + cos(angle) * start[1] };
    const double middle[3] = { 0.0, -0.06, 0.0 }, up[3] = { 0.0, 1.0, 0.0 };
    PelageView view = PELAGE_VIEW_INIT;
    check(pelage_view_perspective(eye, middle, up, 0.5, aspect, 0.1, 10.0, &view), "view");

    PelageShadow shadow = PELAGE_SHADOW_INIT;
    shadow.technique = choices->shadow == 0 ? PELAGE_SHADOW_DEEP_OPACITY_MAP : PELAGE_SHADOW_NONE;

    PelageABuffer a_buffer = PELAGE_A_BUFFER_INIT;
    a_buffer.storage = choices->transparency == 2 ? PELAGE_STORAGE_LISTS : PELAGE_STORAGE_COUNTED;
    a_buffer.raster = (uint32_t)choices->raster;
    PelageDbkBuffer dbk_buffer = PELAGE_DBK_BUFFER_INIT;
    dbk_buffer.raster = (uint32_t)choices->raster;
    PelageOpaque opaque = PELAGE_OPAQUE_INIT;
    opaque.raster = (uint32_t)choices->raster;
    PelageTransparency transparency = PELAGE_TRANSPARENCY_INIT;
    static const uint32_t techniques[] = { PELAGE_TRANSPARENCY_DBK_BUFFER, PELAGE_TRANSPARENCY_A_BUFFER,
                                           PELAGE_TRANSPARENCY_A_BUFFER, PELAGE_TRANSPARENCY_OPAQUE };
    transparency.technique = techniques[choices->transparency];
    transparency.dbk_buffer = &dbk_buffer;
    transparency.a_buffer = &a_buffer;
    transparency.opaque = &opaque;

    PelageLight sun = PELAGE_LIGHT_INIT;
    sun.direction[0] = -0.9;
    sun.direction[1] = -0.8;
    sun.direction[2] = 0.2;
    sun.power[0] = sun.power[1] = sun.power[2] = 3.0f;
    sun.shadow = &shadow;

    PelageFrame frame = PELAGE_FRAME_INIT;
    frame.hairs = &hair;
    frame.hair_count = 1;
    frame.lights = &sun;
    frame.light_count = 1;
    frame.ambient[0] = frame.ambient[1] = frame.ambient[2] = 0.05f;
    frame.view = &view;
    frame.transparency = &transparency;
    check(pelage_render(context, &frame, target, PELAGE_RENDER_CLEAR), "render");
}

/* What the window shows, from the X server. */
static void write_screenshot(GLFWwindow *window, const char *path) {
#if defined(SCREENSHOTS)
    Display *display = glfwGetX11Display();
    Window drawable = glfwGetX11Window(window);
    XWindowAttributes attributes;
    XSync(display, False);
    if (!XGetWindowAttributes(display, drawable, &attributes)) {
        fprintf(stderr, "the window has no attributes\n");
        exit(1);
    }
    XImage *image = XGetImage(display, drawable, 0, 0, (unsigned)attributes.width, (unsigned)attributes.height,
                              AllPlanes, ZPixmap);
    FILE *file = fopen(path, "wb");
    if (!image || !file) {
        fprintf(stderr, "%s cannot be written\n", path);
        exit(1);
    }
    fprintf(file, "P6\n%d %d\n255\n", image->width, image->height);
    for (int y = 0; y < image->height; y++) {
        for (int x = 0; x < image->width; x++) {
            unsigned long pixel = XGetPixel(image, x, y);
            fputc((int)(pixel >> 16 & 0xff), file);
            fputc((int)(pixel >> 8 & 0xff), file);
            fputc((int)(pixel & 0xff), file);
        }
    }
    fclose(file);
    XDestroyImage(image);
    printf("wrote %s\n", path);
#else
    (void)window;
    fprintf(stderr, "%s: screenshots are taken from X servers alone\n", path);
    exit(1);
#endif
}

int main(int argc, char **argv) {
    long frames = -1;
    const char *screenshot = NULL;
    int width = 480, height = 640;
    uint64_t strands = PELAGE_BUILTIN_STRAND_COUNT;
    double turn = 0.02;
    uint32_t format = PELAGE_SURFACE_AUTO;
    for (int at = 1; at + 1 < argc; at += 2) {
        const char *option = argv[at], *value = argv[at + 1];
        if (!strcmp(option, "--frames")) {
            frames = strtol(value, NULL, 10);
        } else if (!strcmp(option, "--screenshot")) {
            screenshot = value;
        } else if (!strcmp(option, "--strands")) {
            strands = strtoull(value, NULL, 10);
        } else if (!strcmp(option, "--turn")) {
            turn = strtod(value, NULL);
        } else if (!strcmp(option, "--format") && !strcmp(value, "srgb8")) {
            format = PELAGE_SURFACE_SRGB8;
        } else if (!strcmp(option, "--format") && !strcmp(value, "unorm8")) {
            format = PELAGE_SURFACE_UNORM8;
        } else if (strcmp(option, "--size") || sscanf(value, "%dx%d", &width, &height) != 2) {
            fprintf(stderr, "%s %s is no option of this program\n", option, value);
            return 2;
        }
    }

    check(pelage_set_log_callback(PELAGE_LOG_WARN, print_message, stderr), "log");
    if (!glfwInit()) {
        fprintf(stderr, "GLFW finds no display\n");
        return 1;
    }
    /* The surface is pelage's business. */
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    GLFWwindow *window = glfwCreateWindow(width, height, "pelage", NULL, NULL);
    if (!window) {
        fprintf(stderr, "GLFW makes no window\n");
        return 1;
    }
    Choices choices = { 0, 0, 0, 0, 0, 0 };
    int present_mode = 0;
    glfwSetWindowUserPointer(window, &choices);
    glfwSetKeyCallback(window, on_key);
    glfwSetFramebufferSizeCallback(window, on_size);

    PelageWindow raw = describe(window);
    raw.format = format;
    PelageContext context;
    check(pelage_window_context_create(&raw, &context), "context");
    PelageAdapter adapter = PELAGE_ADAPTER_INIT;
    check(pelage_context_adapter(context, &adapter), "adapter");
    PelageHair hair;
    check(pelage_hair_create_builtin(context, PELAGE_BUILTIN_WAVY, strands, &hair), "hair");
    PelageWindowInfo info = PELAGE_WINDOW_INFO_INIT;
    check(pelage_window_info(context, &info), "window");
    printf("pelage %s on %s, a window of %ux%u, format %u\n", pelage_version(), adapter.name, info.width, info.height,
           info.format);
    PelageTarget target = fit_target(context, (PelageTarget){ 0 }, &info);

    const float wall[3] = { 0.18f, 0.18f, 0.18f };
    double angle = 0.0;
    long shown = 0, skipped = 0;
    for (long frame = 0; frame != frames && !glfwWindowShouldClose(window); frame++) {
        double began = glfwGetTime();
        glfwPollEvents();
        if (choices.resized) {
            int w, h;
            choices.resized = 0;
            glfwGetFramebufferSize(window, &w, &h);
            check(pelage_window_resize(context, (uint32_t)w, (uint32_t)h), "resize");
            check(pelage_window_info(context, &info), "window");
            target = fit_target(context, target, &info);
        }
        if (!target.id) {
            skipped++;
            glfwWaitEventsTimeout(0.1); /* minimised: there is nothing to draw for */
            continue;
        }
        if (choices.present != present_mode) {
            present_mode = choices.present;
            /* Not every surface has every mode; the sentence says which it has. */
            if (pelage_window_set_present_mode(context, (uint32_t)present_mode) != PELAGE_OK) {
                fprintf(stderr, "%s\n", pelage_last_error());
            }
        }
        render(context, hair, target, angle, (double)info.width / info.height, &choices);
        uint32_t outcome;
        check(pelage_window_present(context, target, wall, &outcome), "present");
        if (outcome == PELAGE_PRESENTED) {
            shown++;
        } else {
            skipped++;
        }
        if (!choices.stopped) {
            angle += turn;
        }
        char title[160];
        snprintf(title, sizeof title, "pelage: %s, %s, %s, %s, %.0f ms", transparencies[choices.transparency],
                 shadows[choices.shadow], rasters[choices.raster], present_modes[present_mode],
                 1000.0 * (glfwGetTime() - began));
        glfwSetWindowTitle(window, title);
    }

    if (screenshot) {
        check(pelage_wait(context), "wait");
        write_screenshot(window, screenshot);
    }
    PelageStatistics statistics = PELAGE_STATISTICS_INIT;
    check(pelage_statistics(context, &statistics), "statistics");
    printf("%llu strands, %ld frames shown, %ld skipped\n", (unsigned long long)statistics.strands, shown, skipped);
    /* The context first: the surface is the window's. */
    check(pelage_context_destroy(context), "destroy");
    glfwDestroyWindow(window);
    glfwTerminate();
    return 0;
}
