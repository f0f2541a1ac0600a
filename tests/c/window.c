/*
 * Windows of an X server, drawn into through pelage.h: what tests/capi/window.rs runs, a mode at a time. The last line says
 * how many things were wrong. The screen is read back from the server, and held to what the same frame is offscreen.
 */
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <xcb/xcb.h>

#include "pelage.h"

enum { WIDTH = 200, HEIGHT = 160, STRANDS = 300 };

/* Of a target against one of another context: both run the same commands on the same driver. */
static const float TARGET_TOLERANCE = 1e-4f;
/* Of the screen: 8 bits, and drivers round the sRGB curve their own way. */
static const int SCREEN_TOLERANCE = 1;

static const float CLEAR[3] = { 0.1f, 0.3f, 0.7f };

static int failures;
static Display *display;

static void expect(int holds, const char *what) {
    if (!holds) {
        printf("wrong: %s (%s)\n", what, pelage_last_error());
        failures++;
    }
}

static void ok(PelageResult result, const char *what) {
    if (result != PELAGE_OK) {
        printf("wrong: %s: %s\n", what, pelage_last_error());
        exit(1);
    }
}

/* The call has failed with `status`, and with a sentence that holds `words`. */
static void fails(PelageResult result, PelageResult status, const char *words) {
    if (result != status || !strstr(pelage_last_error(), words)) {
        printf("wrong: status %u, \"%s\"; expected %u and \"%s\"\n", (unsigned)result, pelage_last_error(),
               (unsigned)status, words);
        failures++;
    }
}

static void print_message(uint32_t level, const char *message, void *user) {
    (void)user;
    printf("log %u: %s\n", (unsigned)level, message);
}

static void nap(void) {
    struct timespec time = { 0, 20 * 1000 * 1000 };
    nanosleep(&time, NULL);
}

/* A window, and its handles as `kind` has them. */
typedef struct {
    Window window;
    xcb_connection_t *connection;
    PelageWindow raw;
} Host;

static Host open_window(uint32_t kind) {
    Host host = { 0, NULL, PELAGE_WINDOW_INIT };
    host.raw.kind = kind;
    host.raw.force_software = 1;
    if (kind == PELAGE_WINDOW_XCB) {
        host.connection = xcb_connect(NULL, NULL);
        xcb_screen_t *screen = xcb_setup_roots_iterator(xcb_get_setup(host.connection)).data;
        xcb_window_t window = xcb_generate_id(host.connection);
        xcb_create_window(host.connection, XCB_COPY_FROM_PARENT, window, screen->root, 0, 0, WIDTH, HEIGHT, 0,
                          XCB_WINDOW_CLASS_INPUT_OUTPUT, screen->root_visual, 0, NULL);
        xcb_map_window(host.connection, window);
        /* An answer says that the server has come so far. */
        free(xcb_get_input_focus_reply(host.connection, xcb_get_input_focus(host.connection), NULL));
        host.window = window;
        host.raw.display = host.connection;
    } else {
        host.window = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, WIDTH, HEIGHT, 0, 0, 0);
        XMapRaised(display, host.window);
        XSync(display, False);
        host.raw.display = display;
    }
    host.raw.window = host.window;
    return host;
}

static void close_window(Host *host) {
    XDestroyWindow(display, host->window);
    XSync(display, False);
    if (host->connection) {
        xcb_disconnect(host->connection);
    }
}

static PelageContext window_context(const Host *host) {
    PelageContext context;
    ok(pelage_window_context_create(&host->raw, &context), "window context");
    return context;
}

static PelageContext offscreen_context(void) {
    PelageContextDescriptor device = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    device.force_software = 1;
    PelageContext context;
    ok(pelage_context_create(&device, &context), "context");
    return context;
}

/* The one frame, on any context: the target's colour in `pixels`. */
static PelageTarget draw(PelageContext context, uint32_t width, uint32_t height, float *pixels) {
    PelageHair hair;
    ok(pelage_hair_create_builtin(context, PELAGE_BUILTIN_CURLY, STRANDS, &hair), "hair");
    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    image.width = width;
    image.height = height;
    image.format = PELAGE_FORMAT_RGBA32F;
    PelageTarget target;
    ok(pelage_target_create(context, &image, &target), "target");
    const double eye[3] = { 0.6, 0.15, -0.75 }, middle[3] = { 0, -0.06, 0 }, up[3] = { 0, 1, 0 };
    PelageView view = PELAGE_VIEW_INIT;
    ok(pelage_view_perspective(eye, middle, up, 0.5, (double)width / height, 0.1, 10.0, &view), "view");
    PelageLight sun = PELAGE_LIGHT_INIT;
    sun.power[0] = sun.power[1] = sun.power[2] = 3.0f;
    PelageFrame frame = PELAGE_FRAME_INIT;
    frame.hairs = &hair;
    frame.hair_count = 1;
    frame.lights = &sun;
    frame.light_count = 1;
    frame.ambient[0] = frame.ambient[1] = frame.ambient[2] = 0.1f;
    frame.view = &view;
    ok(pelage_render(context, &frame, target, PELAGE_RENDER_CLEAR), "render");
    ok(pelage_target_read_colour(target, pixels, (uint64_t)width * height * 16), "read");
    PelageStatistics statistics = PELAGE_STATISTICS_INIT;
    ok(pelage_statistics(context, &statistics), "statistics");
    expect(statistics.strands == STRANDS, "the frame's statistics are the window's context's too");
    ok(pelage_hair_destroy(hair), "hair");
    return target;
}

static PelageWindowInfo info_of(PelageContext context) {
    PelageWindowInfo info = PELAGE_WINDOW_INFO_INIT;
    ok(pelage_window_info(context, &info), "info");
    return info;
}

static int srgb(double v) {
    v = v < 0.0 ? 0.0 : v > 1.0 ? 1.0 : v;
    return (int)(255.0 * (v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055) + 0.5);
}

/* The furthest that the window is from pixels over the clear colour; beyond them it should be clear alone. */
static int screen_error(const Host *host, int width, int height, const float *pixels, int columns, int rows) {
    XImage *image = XGetImage(display, host->window, 0, 0, (unsigned)width, (unsigned)height, AllPlanes, ZPixmap);
    int worst = 0;
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            unsigned long shown = XGetPixel(image, x, y);
            for (int channel = 0; channel < 3; channel++) {
                double value = CLEAR[channel];
                if (x < columns && y < rows) {
                    const float *pixel = pixels + 4 * (y * columns + x);
                    value = pixel[channel] + (1.0 - pixel[3]) * value;
                }
                int is = (int)(shown >> (16 - 8 * channel) & 0xff);
                int error = abs(is - srgb(value));
                worst = error > worst ? error : worst;
            }
        }
    }
    XDestroyImage(image);
    return worst;
}

/* Presents until the screen shows it: the server takes its time. */
static void shows(const Host *host, PelageContext context, PelageTarget target, int width, int height,
                  const float *pixels, int columns, int rows, const char *what) {
    int worst = 256;
    for (int attempt = 0; attempt < 200 && worst > SCREEN_TOLERANCE; attempt++) {
        if (attempt % 10 == 0) {
            uint32_t outcome = 77;
            ok(pelage_window_present(context, target, CLEAR, &outcome), what);
            expect(outcome == PELAGE_PRESENTED, what);
        }
        ok(pelage_wait(context), "wait");
        worst = screen_error(host, width, height, pixels, columns, rows);
        if (worst > SCREEN_TOLERANCE) {
            nap();
        }
    }
    printf("%s: the screen is off by %d of 255\n", what, worst);
    expect(worst <= SCREEN_TOLERANCE, what);
}

static float window_pixels[4 * 512 * 512], offscreen_pixels[4 * 512 * 512];

/* The picture offscreen, in a window's target and on the screen, by both kinds of handles and both formats. */
static void compare(void) {
    const uint32_t kinds[2] = { PELAGE_WINDOW_XLIB, PELAGE_WINDOW_XCB };
    const uint32_t formats[2] = { PELAGE_SURFACE_SRGB8, PELAGE_SURFACE_UNORM8 };
    PelageContext offscreen = offscreen_context();
    draw(offscreen, WIDTH, HEIGHT, offscreen_pixels);
    int hairy = 0;
    for (int at = 0; at < WIDTH * HEIGHT; at++) {
        hairy += offscreen_pixels[4 * at + 3] > 0.01f;
    }
    printf("%d pixels of hair\n", hairy);
    expect(hairy > WIDTH * HEIGHT / 20, "the picture shows hair");
    for (int at = 0; at < 4; at++) {
        Host host = open_window(kinds[at / 2]);
        host.raw.format = formats[at % 2];
        PelageContext context = window_context(&host);
        PelageTarget target = draw(context, WIDTH, HEIGHT, window_pixels);
        float worst = 0.0f;
        for (int value = 0; value < 4 * WIDTH * HEIGHT; value++) {
            worst = fmaxf(worst, fabsf(window_pixels[value] - offscreen_pixels[value]));
        }
        printf("kind %d, format %d: the target is off by %g\n", at / 2, at % 2, (double)worst);
        expect(worst <= TARGET_TOLERANCE, "the window's target is as the offscreen one");
        PelageWindowInfo info = info_of(context);
        expect(info.format == formats[at % 2], "the format that was asked for");
        expect(info.width == WIDTH && info.height == HEIGHT, "the window's size");
        shows(&host, context, target, WIDTH, HEIGHT, offscreen_pixels, WIDTH, HEIGHT, "compare");
        ok(pelage_context_destroy(context), "destroy");
        close_window(&host);
    }
    ok(pelage_context_destroy(offscreen), "destroy");
}

/* A window that grows and shrinks, with targets of the old size and of the new; and one that is minimised. */
static void resize(void) {
    Host host = open_window(PELAGE_WINDOW_XLIB);
    PelageContext context = window_context(&host);
    PelageTarget target = draw(context, WIDTH, HEIGHT, window_pixels);
    shows(&host, context, target, WIDTH, HEIGHT, window_pixels, WIDTH, HEIGHT, "before");
    const int sizes[3][2] = { { 320, 240 }, { 64, 48 }, { 150, 300 } };
    for (int at = 0; at < 3; at++) {
        const int *size = sizes[at];
        XResizeWindow(display, host.window, (unsigned)size[0], (unsigned)size[1]);
        XSync(display, False);
        /* Even where the host does not say so: the surface is outdated. */
        if (at > 0) {
            ok(pelage_window_resize(context, (uint32_t)size[0], (uint32_t)size[1]), "resize");
        }
        PelageWindowInfo info = info_of(context);
        expect((int)info.width == size[0] && (int)info.height == size[1], "the window's new size");
        shows(&host, context, target, size[0], size[1], window_pixels, WIDTH, HEIGHT, "an old target");
    }
    PelageTarget fitting = draw(context, 150, 300, offscreen_pixels);
    shows(&host, context, fitting, 150, 300, offscreen_pixels, 150, 300, "a new target");

    ok(pelage_window_resize(context, 0, 0), "minimise");
    PelageWindowInfo info = info_of(context);
    expect(info.width == 0 && info.height == 0, "a minimised window has no pixels");
    uint32_t outcome = 77;
    ok(pelage_window_present(context, target, CLEAR, &outcome), "minimised");
    expect(outcome == PELAGE_SKIPPED_MINIMISED, "a minimised window's frame is skipped");
    expect(screen_error(&host, 150, 300, offscreen_pixels, 150, 300) <= SCREEN_TOLERANCE, "the screen stays");
    ok(pelage_window_resize(context, 150, 300), "restore");
    shows(&host, context, target, 150, 300, window_pixels, WIDTH, HEIGHT, "restored");
    ok(pelage_context_destroy(context), "destroy");
    close_window(&host);
}

/* Present modes: those that the surface has work, the others are refused by name. */
static void modes(void) {
    static const char *const names[3] = { "fifo", "mailbox", "immediate" };
    Host host = open_window(PELAGE_WINDOW_XLIB);
    PelageContext context = window_context(&host);
    PelageTarget target = draw(context, WIDTH, HEIGHT, window_pixels);
    PelageWindowInfo info = info_of(context);
    printf("present modes %#x, formats %#x\n", (unsigned)info.present_modes, (unsigned)info.formats);
    expect(info.present_modes & 1u << PELAGE_PRESENT_FIFO, "every surface has fifo");
    for (uint32_t mode = 0; mode < 3; mode++) {
        uint32_t before = info_of(context).present_mode;
        if (info.present_modes & 1u << mode) {
            ok(pelage_window_set_present_mode(context, mode), "mode");
            expect(info_of(context).present_mode == mode, "the mode that was set");
            shows(&host, context, target, WIDTH, HEIGHT, window_pixels, WIDTH, HEIGHT, names[mode]);
        } else {
            fails(pelage_window_set_present_mode(context, mode), PELAGE_UNSUPPORTED, names[mode]);
            expect(info_of(context).present_mode == before, "the old mode stays");
            Host other = open_window(PELAGE_WINDOW_XLIB);
            other.raw.present_mode = mode;
            PelageContext none = { 0 };
            fails(pelage_window_context_create(&other.raw, &none), PELAGE_UNSUPPORTED, names[mode]);
            close_window(&other);
        }
    }
    fails(pelage_window_set_present_mode(context, 3), PELAGE_INVALID_VALUE, "present_mode 3");
    int refused = 0;
    static const char *const formats[5] = { "", "srgb8", "unorm8", "unorm10", "float16" };
    for (uint32_t format = 1; format < 5; format++) {
        if (!(info.formats & 1u << format)) {
            Host other = open_window(PELAGE_WINDOW_XLIB);
            other.raw.format = format;
            PelageContext none = { 0 };
            fails(pelage_window_context_create(&other.raw, &none), PELAGE_UNSUPPORTED, formats[format]);
            fails(PELAGE_UNSUPPORTED, PELAGE_UNSUPPORTED, "it has srgb8, unorm8");
            expect(none.id == 0, "an error makes no context");
            close_window(&other);
            refused++;
        }
    }
    expect(refused > 0, "no screen of 8 bits shows floats");
    ok(pelage_context_destroy(context), "destroy");
    close_window(&host);
}

static void refusals(void) {
    Host host = open_window(PELAGE_WINDOW_XLIB);
    PelageContext none = { 0 };
    PelageWindow raw = host.raw;
#define REFUSED(field, value, status, words)                            \
    raw = host.raw;                                                     \
    raw.field = value;                                                  \
    fails(pelage_window_context_create(&raw, &none), status, words);    \
    expect(none.id == 0, "an error makes no context")
    REFUSED(kind, 0, PELAGE_INVALID_VALUE, "kind 0");
    REFUSED(kind, 6, PELAGE_INVALID_VALUE, "kind 6");
    REFUSED(display, NULL, PELAGE_INVALID_VALUE, "display is NULL");
    REFUSED(window, 0, PELAGE_INVALID_VALUE, "window 0x0");
    REFUSED(window, UINT64_MAX, PELAGE_INVALID_VALUE, "is no window of its kind");
    REFUSED(format, 5, PELAGE_INVALID_VALUE, "format 5");
    REFUSED(present_mode, 9, PELAGE_INVALID_VALUE, "present_mode 9");
    REFUSED(force_software, 2, PELAGE_INVALID_VALUE, "force_software 2");
    REFUSED(validation, 2, PELAGE_INVALID_VALUE, "validation 2");
    REFUSED(reserved, 1, PELAGE_INVALID_VALUE, "PelageWindow.reserved");
    REFUSED(struct_size, 8, PELAGE_INVALID_VALUE, "struct_size 8");
    /* Another system's handles. */
    REFUSED(kind, PELAGE_WINDOW_WIN32, PELAGE_UNSUPPORTED, "this window takes no Vulkan surface");
    REFUSED(kind, PELAGE_WINDOW_APPKIT, PELAGE_UNSUPPORTED, "this window takes no Vulkan surface");
    fails(pelage_window_context_create(NULL, &none), PELAGE_INVALID_VALUE, "window is NULL");
    fails(pelage_window_context_create(&host.raw, NULL), PELAGE_INVALID_VALUE, "context is NULL");

    PelageContext context = window_context(&host), offscreen = offscreen_context();
    PelageTarget target = draw(context, WIDTH, HEIGHT, window_pixels);
    PelageTarget foreign = draw(offscreen, WIDTH, HEIGHT, offscreen_pixels);
    const float bad[3] = { 0.0f, NAN, 0.0f };
    uint32_t outcome = 77;
    fails(pelage_window_present(context, target, bad, &outcome), PELAGE_INVALID_VALUE, "not finite");
    fails(pelage_window_present(context, foreign, CLEAR, &outcome), PELAGE_INVALID_HANDLE, "another context");
    fails(pelage_window_present(none, target, CLEAR, &outcome), PELAGE_INVALID_HANDLE, "NULL");
    fails(pelage_window_present(offscreen, foreign, CLEAR, &outcome), PELAGE_UNSUPPORTED, "no window");
    fails(pelage_window_resize(offscreen, 1, 1), PELAGE_UNSUPPORTED, "no window");
    fails(pelage_window_set_present_mode(offscreen, 0), PELAGE_UNSUPPORTED, "no window");
    PelageWindowInfo info = PELAGE_WINDOW_INFO_INIT;
    fails(pelage_window_info(offscreen, &info), PELAGE_UNSUPPORTED, "no window");
    fails(pelage_window_info(context, NULL), PELAGE_INVALID_VALUE, "info is NULL");
    PelageVulkanSubmit submit = PELAGE_VULKAN_SUBMIT_INIT;
    fails(pelage_vulkan_render(context, &submit), PELAGE_UNSUPPORTED, "device of its own");
    expect(outcome == 77, "an error leaves the outcome as it was");
    /* Neither colour nor outcome need be given. */
    ok(pelage_window_present(context, target, NULL, NULL), "present");
    ok(pelage_context_destroy(context), "destroy");
    fails(pelage_window_present(context, target, CLEAR, &outcome), PELAGE_INVALID_HANDLE, "stale");
    ok(pelage_context_destroy(offscreen), "destroy");
    close_window(&host);
}

/* A window that the host has destroyed too early. */
static void gone(void) {
    Host host = open_window(PELAGE_WINDOW_XCB);
    PelageContext context = window_context(&host);
    PelageTarget target = draw(context, WIDTH, HEIGHT, window_pixels);
    shows(&host, context, target, WIDTH, HEIGHT, window_pixels, WIDTH, HEIGHT, "before");
    xcb_destroy_window(host.connection, (xcb_window_t)host.window);
    free(xcb_get_input_focus_reply(host.connection, xcb_get_input_focus(host.connection), NULL));
    uint32_t outcome = 77;
    for (int attempt = 0; attempt < 3; attempt++) {
        fails(pelage_window_present(context, target, CLEAR, &outcome), PELAGE_UNSUPPORTED, "surface is lost");
    }
    expect(outcome == 77, "an error leaves the outcome as it was");
    PelageWindowInfo info = PELAGE_WINDOW_INFO_INIT;
    fails(pelage_window_info(context, &info), PELAGE_UNSUPPORTED, "surface is lost");
    /* All else goes on. */
    ok(pelage_target_read_colour(target, offscreen_pixels, (uint64_t)WIDTH * HEIGHT * 16), "read");
    expect(!memcmp(offscreen_pixels, window_pixels, (size_t)WIDTH * HEIGHT * 16), "the target is as it was");
    ok(pelage_context_destroy(context), "destroy");
    xcb_disconnect(host.connection);
}

/* With tests/c/vulkan_shim.c in the place of Vulkan: the third image of the window is lost, or outdated. */
static void lost(void) {
    Host host = open_window(PELAGE_WINDOW_XLIB);
    PelageContext context = window_context(&host);
    PelageTarget target = draw(context, WIDTH, HEIGHT, window_pixels);
    for (int frame = 0; frame < 6; frame++) {
        uint32_t outcome = 77;
        ok(pelage_window_present(context, target, CLEAR, &outcome), "present");
        expect(outcome == PELAGE_PRESENTED, "a surface is made anew within the call");
    }
    shows(&host, context, target, WIDTH, HEIGHT, window_pixels, WIDTH, HEIGHT, "after");
    ok(pelage_context_destroy(context), "destroy");
    close_window(&host);
}

/* With the shim, which loses every image: a window that never comes to rest skips its frames. */
static void never(uint32_t expected) {
    Host host = open_window(PELAGE_WINDOW_XLIB);
    PelageContext context = window_context(&host);
    PelageTarget target = draw(context, WIDTH, HEIGHT, window_pixels);
    uint32_t outcome = 77;
    ok(pelage_window_present(context, target, CLEAR, &outcome), "present");
    expect(outcome == expected, "the frame is skipped, and says why");
    ok(pelage_context_destroy(context), "destroy");
    close_window(&host);
}

/* With the shim: the device itself is lost. */
static void device(void) {
    Host host = open_window(PELAGE_WINDOW_XLIB);
    PelageContext context = window_context(&host);
    PelageTarget target = draw(context, WIDTH, HEIGHT, window_pixels);
    uint32_t outcome = 77;
    for (int attempt = 0; attempt < 2; attempt++) {
        fails(pelage_window_present(context, target, CLEAR, &outcome), PELAGE_DEVICE_LOST, "the device is lost");
    }
    expect(outcome == 77, "an error leaves the outcome as it was");
    ok(pelage_context_destroy(context), "destroy");
    close_window(&host);
}

int main(int argc, char **argv) {
    const char *mode = argc > 1 ? argv[1] : "";
    XInitThreads();
    display = XOpenDisplay(NULL);
    if (!display) {
        printf("wrong: no display\n");
        return 1;
    }
    pelage_set_log_callback(PELAGE_LOG_INFO, print_message, NULL);
    if (!strcmp(mode, "compare")) {
        compare();
    } else if (!strcmp(mode, "resize")) {
        resize();
    } else if (!strcmp(mode, "modes")) {
        modes();
    } else if (!strcmp(mode, "refusals")) {
        refusals();
    } else if (!strcmp(mode, "gone")) {
        gone();
    } else if (!strcmp(mode, "lost")) {
        lost();
    } else if (!strcmp(mode, "changing")) {
        never(PELAGE_SKIPPED_CHANGING);
    } else if (!strcmp(mode, "timeout")) {
        never(PELAGE_SKIPPED_TIMEOUT);
    } else if (!strcmp(mode, "device")) {
        device();
    } else {
        printf("wrong: no mode %s\n", mode);
        return 1;
    }
    XCloseDisplay(display);
    printf("%d failures\n", failures);
    return failures != 0;
}
