// The same by pelage.hpp.
#include <iostream>
#include <pelage.hpp>

int main() {
    PelageContextDescriptor device = PELAGE_CONTEXT_DESCRIPTOR_INIT;
    device.force_software = 1;
    const pelage::Context context = pelage::Context::offscreen(device);
    const pelage::Hair hair = context.builtin(PELAGE_BUILTIN_CURLY, 12);
    std::cout << "pelage " << pelage_version() << ", " << hair.info().strand_count << " strands\n";
}
