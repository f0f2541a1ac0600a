/* Prints every initialiser's bytes, for the test to compare with the library's own defaults. */
#include <stdio.h>

#include "pelage.h"

static void print(const char *name, const void *bytes, size_t size) {
    printf("%s ", name);
    for (size_t at = 0; at < size; at++) {
        printf("%02x", ((const unsigned char *)bytes)[at]);
    }
    printf("\n");
}

#define PRINT(type, initialiser)           \
    do {                                   \
        type value = initialiser;          \
        print(#type, &value, sizeof value); \
    } while (0)

int main(void) {
    PRINT(PelageContextDescriptor, PELAGE_CONTEXT_DESCRIPTOR_INIT);
    PRINT(PelageAdapter, PELAGE_ADAPTER_INIT);
    PRINT(PelageStrands, PELAGE_STRANDS_INIT);
    PRINT(PelageInterpolationSettings, PELAGE_INTERPOLATION_SETTINGS_INIT);
    PRINT(PelageClumpSettings, PELAGE_CLUMP_SETTINGS_INIT);
    PRINT(PelageFile, PELAGE_FILE_INIT);
    PRINT(PelageHairInfo, PELAGE_HAIR_INFO_INIT);
    PRINT(PelageKajiyaKay, PELAGE_KAJIYA_KAY_INIT);
    PRINT(PelageScheuermann, PELAGE_SCHEUERMANN_INIT);
    PRINT(PelageMarschner, PELAGE_MARSCHNER_INIT);
    PRINT(PelageSadeghi, PELAGE_SADEGHI_INIT);
    PRINT(PelageChiang, PELAGE_CHIANG_INIT);
    PRINT(PelageShading, PELAGE_SHADING_INIT);
    PRINT(PelageDeepOpacityMap, PELAGE_DEEP_OPACITY_MAP_INIT);
    PRINT(PelageShadowMap, PELAGE_SHADOW_MAP_INIT);
    PRINT(PelageApproximatedDeepShadowMap, PELAGE_APPROXIMATED_DEEP_SHADOW_MAP_INIT);
    PRINT(PelageOpacityShadowMaps, PELAGE_OPACITY_SHADOW_MAPS_INIT);
    PRINT(PelageMomentOpacityMap, PELAGE_MOMENT_OPACITY_MAP_INIT);
    PRINT(PelageKBufferVolume, PELAGE_K_BUFFER_VOLUME_INIT);
    PRINT(PelageShadow, PELAGE_SHADOW_INIT);
    PRINT(PelageOpaque, PELAGE_OPAQUE_INIT);
    PRINT(PelageABuffer, PELAGE_A_BUFFER_INIT);
    PRINT(PelageDbkBuffer, PELAGE_DBK_BUFFER_INIT);
    PRINT(PelageWeightedBlended, PELAGE_WEIGHTED_BLENDED_INIT);
    PRINT(PelageDepthPeeling, PELAGE_DEPTH_PEELING_INIT);
    PRINT(PelageRandomSubsets, PELAGE_RANDOM_SUBSETS_INIT);
    PRINT(PelageSortedBlending, PELAGE_SORTED_BLENDING_INIT);
    PRINT(PelageKBuffer, PELAGE_K_BUFFER_INIT);
    PRINT(PelageKPlusBuffer, PELAGE_K_PLUS_BUFFER_INIT);
    PRINT(PelageKBufferSinglePass, PELAGE_K_BUFFER_SINGLE_PASS_INIT);
    PRINT(PelageMoment, PELAGE_MOMENT_INIT);
    PRINT(PelageTransparency, PELAGE_TRANSPARENCY_INIT);
    PRINT(PelageView, PELAGE_VIEW_INIT);
    PRINT(PelageLight, PELAGE_LIGHT_INIT);
    PRINT(PelageFrame, PELAGE_FRAME_INIT);
    PRINT(PelageTargetDescriptor, PELAGE_TARGET_DESCRIPTOR_INIT);
    PRINT(PelageMemoryEstimate, PELAGE_MEMORY_ESTIMATE_INIT);
    PRINT(PelageStatistics, PELAGE_STATISTICS_INIT);
    PRINT(PelageVulkanInstance, PELAGE_VULKAN_INSTANCE_INIT);
    PRINT(PelageVulkanRequirements, PELAGE_VULKAN_REQUIREMENTS_INIT);
    PRINT(PelageVulkanDevice, PELAGE_VULKAN_DEVICE_INIT);
    PRINT(PelageVulkanImage, PELAGE_VULKAN_IMAGE_INIT);
    PRINT(PelageVulkanView, PELAGE_VULKAN_VIEW_INIT);
    PRINT(PelageVulkanOccluder, PELAGE_VULKAN_OCCLUDER_INIT);
    PRINT(PelageVulkanShadowImage, PELAGE_VULKAN_SHADOW_IMAGE_INIT);
    PRINT(PelageVulkanPoints, PELAGE_VULKAN_POINTS_INIT);
    PRINT(PelageVulkanSemaphore, PELAGE_VULKAN_SEMAPHORE_INIT);
    PRINT(PelageVulkanSubmit, PELAGE_VULKAN_SUBMIT_INIT);
    PRINT(PelageWindow, PELAGE_WINDOW_INIT);
    PRINT(PelageWindowInfo, PELAGE_WINDOW_INFO_INIT);
    return 0;
}
