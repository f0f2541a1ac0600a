/*
 * A host's Vulkan device, used rightly and wrongly; tests/capi/vulkan.rs runs this program, and reads what it prints. Its
 * first argument is what to do:
 *
 *     compare     pictures on the host's device and on one of the library's own are equal
 *     outputs     depth, coverage, motion and ids beside the colour, in a rectangle too, are the library's own
 *     layers      layers and mip levels of array images, as both eyes of one submission
 *     owners      images that change hands between families of queues
 *     shadows     the hair's shadow as an image, and the host's own shadow maps over the hair
 *     moving      points and guides from the host's buffers
 *     formats     every format of colour and depth, many layouts, binary semaphores
 *     backlog     more frames than may be on their way
 *     refusals    what is wrong is refused with a sentence
 *     short       physical devices that fall short
 *     lock        the queue is used with the host's lock held, by two contexts on two threads
 *     lost        a lost device, and one without memory
 *     stress N    N times a context and all that is on it, by two threads; from 100 on, the process must not grow
 *     hazard      a mistake of the host's own, which the validation layer must notice
 *
 * All calls of the library's pass through functions of vulkan/watch.h, which watch them and fail where they are told to.
 */
#define _POSIX_C_SOURCE 200809L
#include "vulkan/watch.h"

#include "vulkan/host.h"

#include "vulkan/pictures.h"

#include "vulkan/layers.h"

#include "vulkan/moving.h"

#include "vulkan/refusals.h"

#include "vulkan/lifetimes.h"

#include "vulkan/shadows.h"

int main(int argc, char **argv) {
    const char *what = argc > 1 ? argv[1] : "";
    static const struct { const char *name; void (*run)(void); } runs[] = {
        { "compare", compare }, { "outputs", outputs }, { "layers", layers }, { "owners", owners }, { "shadows", shadows }, { "moving", moving }, { "formats", formats }, { "backlog", backlog }, { "refusals", refusals }, { "short", short_devices },
        { "lock", locks }, { "lost", lost }, { "hazard", hazard },
    };
    int ran = 0;
    open_host();
    for (size_t at = 0; at < sizeof runs / sizeof runs[0]; at++) {
        if (strcmp(what, runs[at].name) == 0) {
            runs[at].run();
            ran = 1;
        }
    }
    if (strcmp(what, "stress") == 0 && argc > 2) {
        stress(atoi(argv[2]));
        ran = 1;
    }
    TRUE(ran);
    close_host();
    printf("%d failures\n", failures);
    return failures != 0;
}
