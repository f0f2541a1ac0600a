/*
 * Stands in the place of the Vulkan loader, passes every call on, and lets some fail: made as libvulkan.so.1 and found by
 * LD_LIBRARY_PATH. The real one is SHIM_VULKAN, a path.
 *
 * SHIM_RESULT is what vkAcquireNextImageKHR returns, as a number, instead of image SHIM_FIRST to SHIM_LAST, counted from 1.
 *
 * SHIM_SUBMIT and SHIM_ALLOCATE are what vkQueueSubmit and vkAllocateMemory return while they are set, which a program may do
 * as it runs. When SHIM_SUBMIT is that the device is lost, all waits say so too.
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

static PFN_vkQueueSubmit real_submit;
static PFN_vkQueueWaitIdle real_wait_idle;
static PFN_vkWaitSemaphores real_wait;
static PFN_vkAllocateMemory real_allocate;

static VKAPI_ATTR VkResult VKAPI_CALL submit(VkQueue queue, uint32_t count, const VkSubmitInfo *infos, VkFence fence) {
    VkResult result = (VkResult)number("SHIM_SUBMIT");
    return result ? result : real_submit(queue, count, infos, fence);
}

static VkResult lost(void) {
    return number("SHIM_SUBMIT") == VK_ERROR_DEVICE_LOST ? VK_ERROR_DEVICE_LOST : VK_SUCCESS;
}

/* What has been submitted runs on without a device that is said to be lost: it is waited for all the same. */
static VKAPI_ATTR VkResult VKAPI_CALL wait_idle(VkQueue queue) {
    VkResult result = real_wait_idle(queue);
    return lost() ? lost() : result;
}

static VKAPI_ATTR VkResult VKAPI_CALL wait_semaphores(VkDevice device, const VkSemaphoreWaitInfo *info, uint64_t timeout) {
    return lost() ? lost() : real_wait(device, info, timeout);
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate(VkDevice device, const VkMemoryAllocateInfo *info,
                                               const VkAllocationCallbacks *callbacks, VkDeviceMemory *memory) {
    VkResult result = (VkResult)number("SHIM_ALLOCATE");
    return result ? result : real_allocate(device, info, callbacks, memory);
}

/* Passes a function on by `own`, and keeps it in `real`. */
#define PASS_ON(function, own, real)              \
    if (found && !strcmp(name, #function)) {      \
        real = (PFN_##function)found;             \
        return (PFN_vkVoidFunction)own;           \
    }

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char *name) {
    PFN_vkVoidFunction found = real_device(device, name);
    PASS_ON(vkAcquireNextImageKHR, acquire, real_acquire)
    PASS_ON(vkQueueSubmit, submit, real_submit)
    PASS_ON(vkQueueWaitIdle, wait_idle, real_wait_idle)
    PASS_ON(vkWaitSemaphores, wait_semaphores, real_wait)
    PASS_ON(vkAllocateMemory, allocate, real_allocate)
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
