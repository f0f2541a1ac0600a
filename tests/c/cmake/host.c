/* The least that a host does with an installed pelage: a context, hair, and what is known of it. */
#include <pelage.h>
#include <stdio.h>

int main(void) {
    PelageContextDescriptor device = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    PelageHairInfo info = PELAGE_HAIR_INFO_INIT;
    PelageContext context;
    PelageHair hair;
    device.force_software = 1;
    if (pelage_abi_version() != PELAGE_ABI_VERSION || pelage_context_create(&device, &context) != PELAGE_OK ||
        pelage_hair_create_builtin(context, PELAGE_BUILTIN_CURLY, 12, &hair) != PELAGE_OK ||
        pelage_hair_info(hair, &info) != PELAGE_OK || pelage_context_destroy(context) != PELAGE_OK) {
        fprintf(stderr, "%s\n", pelage_last_error());
        return 1;
    }
    printf("pelage %s, %u strands\n", pelage_version(), (unsigned)info.strand_count);
    return 0;
}
