/*
 * Stands in the place of the Vulkan loader, passes every call on, and lets the images of windows fail: made as
 * libvulkan.so.1 and found by LD_LIBRARY_PATH. The real one is SHIM_VULKAN, a path.
 *
 * SHIM_RESULT is what vkAcquireNextImageKHR returns, as a number, instead of image SHIM_FIRST to SHIM_LAST, counted from 1.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

static PFN_vkGetInstanceProcAddr real_instance;
static PFN_vkGetDeviceProcAddr real_device;
static PFN_vkAcquireNextImageKHR real_acquire;

static long number(const char *name) {
    const char *value = getenv(name);
    return value ? strtol(value, NULL, 10) : 0;
}

static VKAPI_ATTR VkResult VKAPI_CALL acquire(VkDevice device, VkSwapchainKHR swapchain, uint64_t timeout,
                                              VkSemaphore semaphore, VkFence fence, uint32_t *index) {
    static long count;
    count++;
    if (count >= number("SHIM_FIRST") && count <= number("SHIM_LAST")) {
        printf("shim: image %ld fails\n", count);
        fflush(stdout);
        return (VkResult)number("SHIM_RESULT");
    }
    return real_acquire(device, swapchain, timeout, semaphore, fence, index);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char *name) {
    PFN_vkVoidFunction found = real_device(device, name);
    if (found && !strcmp(name, "vkAcquireNextImageKHR")) {
        real_acquire = (PFN_vkAcquireNextImageKHR)found;
        return (PFN_vkVoidFunction)acquire;
    }
    return found;
}

__attribute__((visibility("default"))) VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL
vkGetInstanceProcAddr(VkInstance instance, const char *name) {
    if (!real_instance) {
        void *library = dlopen(getenv("SHIM_VULKAN"), RTLD_NOW | RTLD_LOCAL);
        /* How POSIX says that a function's address is taken from a pointer. */
        if (library) {
            *(void **)&real_instance = dlsym(library, "vkGetInstanceProcAddr");
        }
        if (!real_instance) {
            fprintf(stderr, "shim: %s\n", dlerror());
            abort();
        }
    }
    PFN_vkVoidFunction found = real_instance(instance, name);
    if (found && !strcmp(name, "vkGetDeviceProcAddr")) {
        real_device = (PFN_vkGetDeviceProcAddr)found;
        return (PFN_vkVoidFunction)device_function;
    }
    return found;
}
