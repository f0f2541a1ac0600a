/* What a test expects, and functions between the library and Vulkan, which watch its calls and fail where they are told to. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#define PELAGE_VULKAN
#include "pelage.h"

enum { SIDE = 64, MOST_BYTES = SIDE * SIDE * 16 };

static int failures = 0;

static void fail(int line, const char *what, const char *more) {
    printf("line %d: %s: %s\n", line, what, more);
    failures++;
}

#define OK(call)                                        \
    do {                                                \
        if ((call) != PELAGE_OK) {                      \
            fail(__LINE__, #call, pelage_last_error()); \
        }                                               \
    } while (0)

#define VK(call)                                  \
    do {                                          \
        VkResult result_ = (call);                \
        if (result_ != VK_SUCCESS) {              \
            printf("%s: %d\n", #call, (int)result_); \
            exit(1);                              \
        }                                         \
    } while (0)

#define TRUE(condition)                                    \
    do {                                                   \
        if (!(condition)) {                                \
            fail(__LINE__, #condition, "does not hold");   \
        }                                                  \
    } while (0)

/* A call that must fail with this status, and with these words in its sentence. */
#define REFUSED(status, words, call)                                                          \
    do {                                                                                      \
        PelageResult result_ = (call);                                                        \
        if (result_ != (status) || !strstr(pelage_last_error(), (words))) {                   \
            printf("line %d: wanted %u and \"%s\", got %u\n", __LINE__, (unsigned)(status), (words), (unsigned)result_); \
            fail(__LINE__, #call, result_ ? pelage_last_error() : "no error");                \
        }                                                                                     \
    } while (0)

/* The host's lock, and what is known of the queue's uses. */
static struct Watch {
    pthread_mutex_t mutex;
    int held;
    pthread_t holder;
    unsigned locks, unlocks, submits, idles, waits, unlocked_uses, objects_taken;
    unsigned acquired, released, misplaced; /* what changes hands between families of queues */
} watch = { .mutex = PTHREAD_MUTEX_INITIALIZER };

/* What goes wrong from now on. */
static VkResult fail_submit = VK_SUCCESS, fail_allocate = VK_SUCCESS;
static struct {
    uint32_t api_version, sets, storage_buffers, invocations;
    int no_graphics, no_compute, no_stores, no_timeline, second_family;
} fake;

static void lock(void *user) {
    struct Watch *watch_ = user;
    pthread_mutex_lock(&watch_->mutex);
    watch_->held = 1;
    watch_->holder = pthread_self();
    watch_->locks++;
}

static void unlock(void *user) {
    struct Watch *watch_ = user;
    watch_->held = 0;
    watch_->unlocks++;
    pthread_mutex_unlock(&watch_->mutex);
}

static void use_queue(void) {
    if (!watch.held || !pthread_equal(watch.holder, pthread_self())) {
        watch.unlocked_uses++;
    }
}

#define REAL_DEVICE(name) ((PFN_##name)vkGetDeviceProcAddr(the_device, #name))
static VkDevice the_device;

static VKAPI_ATTR VkResult VKAPI_CALL queue_submit(VkQueue queue, uint32_t count, const VkSubmitInfo *infos, VkFence fence) {
    use_queue();
    watch.submits++;
    return fail_submit ? fail_submit : REAL_DEVICE(vkQueueSubmit)(queue, count, infos, fence);
}

static VKAPI_ATTR VkResult VKAPI_CALL queue_wait_idle(VkQueue queue) {
    use_queue();
    watch.idles++;
    return fail_submit ? fail_submit : REAL_DEVICE(vkQueueWaitIdle)(queue);
}

static VKAPI_ATTR VkResult VKAPI_CALL device_wait_idle(VkDevice device) {
    use_queue();
    return REAL_DEVICE(vkDeviceWaitIdle)(device);
}

static VKAPI_ATTR VkResult VKAPI_CALL allocate_memory(VkDevice device, const VkMemoryAllocateInfo *info, const VkAllocationCallbacks *callbacks, VkDeviceMemory *memory) {
    return fail_allocate ? fail_allocate : REAL_DEVICE(vkAllocateMemory)(device, info, callbacks, memory);
}

/* While set, no submission seems to end before it is waited for. */
static int slow = 0;

static VKAPI_ATTR VkResult VKAPI_CALL semaphore_value(VkDevice device, VkSemaphore semaphore, uint64_t *value) {
    VkResult result = REAL_DEVICE(vkGetSemaphoreCounterValue)(device, semaphore, value);
    *value = slow ? 0 : *value;
    return result;
}

static VKAPI_ATTR VkResult VKAPI_CALL wait_semaphores(VkDevice device, const VkSemaphoreWaitInfo *info, uint64_t timeout) {
    watch.waits++;
    slow = 0;
    return REAL_DEVICE(vkWaitSemaphores)(device, info, timeout);
}

static VkBuffer points_buffer;

static VKAPI_ATTR void VKAPI_CALL destroy_buffer(VkDevice device, VkBuffer buffer, const VkAllocationCallbacks *callbacks) {
    watch.objects_taken += buffer && buffer == points_buffer;
    REAL_DEVICE(vkDestroyBuffer)(device, buffer, callbacks);
}

static VKAPI_ATTR void VKAPI_CALL destroy_device(VkDevice device, const VkAllocationCallbacks *callbacks) {
    (void)device, (void)callbacks;
    watch.objects_taken++;
}

static VKAPI_ATTR void VKAPI_CALL destroy_instance(VkInstance instance, const VkAllocationCallbacks *callbacks) {
    (void)instance, (void)callbacks;
    watch.objects_taken++;
}

static VKAPI_ATTR void VKAPI_CALL properties(VkPhysicalDevice device, VkPhysicalDeviceProperties *out) {
    vkGetPhysicalDeviceProperties(device, out);
    out->apiVersion = fake.api_version ? fake.api_version : out->apiVersion;
    out->limits.maxBoundDescriptorSets = fake.sets ? fake.sets : out->limits.maxBoundDescriptorSets;
    if (fake.storage_buffers) {
        out->limits.maxPerStageDescriptorStorageBuffers = fake.storage_buffers;
    }
    if (fake.invocations) {
        out->limits.maxComputeWorkGroupInvocations = fake.invocations;
    }
}

static VKAPI_ATTR void VKAPI_CALL properties_2(VkPhysicalDevice device, VkPhysicalDeviceProperties2 *out) {
    vkGetPhysicalDeviceProperties2(device, out);
    properties(device, &out->properties);
}

static VKAPI_ATTR void VKAPI_CALL features_2(VkPhysicalDevice device, VkPhysicalDeviceFeatures2 *out) {
    vkGetPhysicalDeviceFeatures2(device, out);
    if (fake.no_stores) {
        out->features.fragmentStoresAndAtomics = VK_FALSE;
    }
    for (VkBaseOutStructure *at = out->pNext; at; at = at->pNext) {
        if (fake.no_timeline && at->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_TIMELINE_SEMAPHORE_FEATURES) {
            ((VkPhysicalDeviceTimelineSemaphoreFeatures *)(void *)at)->timelineSemaphore = VK_FALSE;
        }
    }
}

static VKAPI_ATTR void VKAPI_CALL families(VkPhysicalDevice device, uint32_t *count, VkQueueFamilyProperties *out) {
    uint32_t room = *count;
    vkGetPhysicalDeviceQueueFamilyProperties(device, count, out);
    if (fake.second_family) {
        if (out && room > *count) {
            out[*count] = out[0];
        }
        *count += !out || room > *count;
    }
    for (uint32_t at = 0; out && at < *count; at++) {
        out[at].queueFlags &= ~(VkQueueFlags)((fake.no_graphics ? VK_QUEUE_GRAPHICS_BIT : 0) | (fake.no_compute ? VK_QUEUE_COMPUTE_BIT : 0));
    }
}

/* The other family, with which things are exchanged. */
static uint32_t other_family = VK_QUEUE_FAMILY_IGNORED;

/* Counts the halves of transfers between families 0 and the other one. A family that is not there is not for the driver. */
static void hand_over(uint32_t *from, uint32_t *to) {
    if (*from == *to) {
        return;
    }
    watch.acquired += *from == other_family && *to == 0;
    watch.released += *from == 0 && *to == other_family;
    watch.misplaced += !((*from == other_family && *to == 0) || (*from == 0 && *to == other_family));
    if (fake.second_family) {
        *from = *to = VK_QUEUE_FAMILY_IGNORED;
    }
}

enum { MOST_BARRIERS = 32 };

static VKAPI_ATTR void VKAPI_CALL pipeline_barrier(VkCommandBuffer commands, VkPipelineStageFlags before, VkPipelineStageFlags after, VkDependencyFlags flags,
                                                   uint32_t memories, const VkMemoryBarrier *memory, uint32_t buffers, const VkBufferMemoryBarrier *buffer,
                                                   uint32_t images, const VkImageMemoryBarrier *image) {
    VkBufferMemoryBarrier own_buffers[MOST_BARRIERS];
    VkImageMemoryBarrier own_images[MOST_BARRIERS];
    if (buffers <= MOST_BARRIERS && images <= MOST_BARRIERS) {
        for (uint32_t at = 0; at < buffers; at++) {
            own_buffers[at] = buffer[at];
            hand_over(&own_buffers[at].srcQueueFamilyIndex, &own_buffers[at].dstQueueFamilyIndex);
        }
        for (uint32_t at = 0; at < images; at++) {
            own_images[at] = image[at];
            hand_over(&own_images[at].srcQueueFamilyIndex, &own_images[at].dstQueueFamilyIndex);
        }
        buffer = own_buffers;
        image = own_images;
    }
    REAL_DEVICE(vkCmdPipelineBarrier)(commands, before, after, flags, memories, memory, buffers, buffer, images, image);
}

#define INSTEAD(function, own)        \
    if (strcmp(name, function) == 0) { \
        return (PFN_vkVoidFunction)(own); \
    }

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device(VkDevice device, const char *name) {
    INSTEAD("vkQueueSubmit", queue_submit)
    INSTEAD("vkQueueWaitIdle", queue_wait_idle)
    INSTEAD("vkDeviceWaitIdle", device_wait_idle)
    INSTEAD("vkAllocateMemory", allocate_memory)
    INSTEAD("vkGetSemaphoreCounterValue", semaphore_value)
    INSTEAD("vkWaitSemaphores", wait_semaphores)
    INSTEAD("vkDestroyBuffer", destroy_buffer)
    INSTEAD("vkCmdPipelineBarrier", pipeline_barrier)
    INSTEAD("vkDestroyDevice", destroy_device)
    return vkGetDeviceProcAddr(device, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_instance(VkInstance instance, const char *name) {
    INSTEAD("vkGetDeviceProcAddr", get_device)
    INSTEAD("vkDestroyInstance", destroy_instance)
    INSTEAD("vkGetPhysicalDeviceProperties", properties)
    INSTEAD("vkGetPhysicalDeviceProperties2", properties_2)
    INSTEAD("vkGetPhysicalDeviceFeatures2", features_2)
    INSTEAD("vkGetPhysicalDeviceQueueFamilyProperties", families)
    return vkGetInstanceProcAddr(instance, name);
}
