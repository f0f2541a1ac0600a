#!/usr/bin/env bash
# Makes sure that what pelage needs beside cargo is there: a C and C++ compiler, and a Vulkan driver (Mesa's software
# one where there is no other). With --test also that software driver itself, the validation layer and Vulkan's headers, as
# tests run on them. Installs what is missing where it may (root or passwordless sudo, and apt-get); otherwise says what to install.
set -euo pipefail

manifest() { compgen -G "/usr/share/vulkan/$1" || compgen -G "/usr/local/share/vulkan/$1" || compgen -G "/etc/vulkan/$1"; }

missing=()
command -v make >/dev/null || missing+=(make)
command -v cc >/dev/null && command -v c++ >/dev/null || missing+=(build-essential)
if [ "${1:-}" = --test ]; then
    manifest 'icd.d/lvp_icd*.json' >/dev/null || missing+=(mesa-vulkan-drivers)
    manifest 'explicit_layer.d/VkLayer_khronos_validation.json' >/dev/null || missing+=(vulkan-validationlayers)
    # C programs with a Vulkan device of their own.
    echo '#include <vulkan/vulkan.h>' | cc -fsyntax-only -x c - 2>/dev/null || missing+=(libvulkan-dev)
else
    [ -n "${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}" ] || manifest 'icd.d/*.json' >/dev/null || missing+=(mesa-vulkan-drivers)
fi
PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null | grep 'libvulkan\.so\.1' >/dev/null || missing+=(libvulkan1)
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo -n)
fi
if ! command -v apt-get >/dev/null || ! "${as_root[@]}" true 2>/dev/null; then
    echo "pelage needs these packages (Debian's names): ${missing[*]}; please install them." >&2
    exit 1
fi
echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
