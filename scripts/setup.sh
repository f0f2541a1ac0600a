#!/usr/bin/env bash
# Makes sure that what pelage needs beside cargo is there: a C and C++ compiler, and a Vulkan driver (Mesa's software
# one where there is no other). With --test also that software driver itself, the validation layer and Vulkan's headers, as
# tests run on them, and what single tests take: an X server without a screen, GLFW, CMake, pkg-config, NumPy. Installs what
# is missing where it may (root or passwordless sudo, and apt-get); otherwise says what to install. Where what single tests
# take cannot be had, it says so and goes on: those tests are skipped, by name, and counted. Under CI=true that is an error if
# apt-get knows the packages.
# With --missing: prints, of what single tests take, the packages that are not there, and installs nothing.
set -euo pipefail

manifest() { compgen -G "/usr/share/vulkan/$1" || compgen -G "/usr/local/share/vulkan/$1" || compgen -G "/etc/vulkan/$1"; }

has_header() { printf '#include <stdio.h>\n#include <%s>\n' "$1" | cc -fsyntax-only -x c - 2>/dev/null; }

missing=() optional=()
command -v make >/dev/null || missing+=(make)
command -v cc >/dev/null && command -v c++ >/dev/null || missing+=(build-essential)
if [ "${1:-}" = --test ] || [ "${1:-}" = --missing ]; then
    manifest 'icd.d/lvp_icd*.json' >/dev/null || missing+=(mesa-vulkan-drivers)
    manifest 'explicit_layer.d/VkLayer_khronos_validation.json' >/dev/null || missing+=(vulkan-validationlayers)
    # C programs with a Vulkan device of their own.
    has_header vulkan/vulkan.h || missing+=(libvulkan-dev)
    command -v Xvfb >/dev/null || optional+=(xvfb)
    { has_header X11/Xutil.h && has_header xcb/xcb.h; } || optional+=(libx11-dev)
    has_header GLFW/glfw3.h || optional+=(libglfw3-dev)
    has_header X11/extensions/Xrandr.h || optional+=(libxrandr-dev)
    command -v cmake >/dev/null || optional+=(cmake)
    command -v pkg-config >/dev/null || optional+=(pkg-config)
    command -v python3 >/dev/null || optional+=(python3)
    python3 -c 'import numpy' 2>/dev/null || /usr/bin/python3 -c 'import numpy' 2>/dev/null || optional+=(python3-numpy)
else
    [ -n "${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}" ] || manifest 'icd.d/*.json' >/dev/null || missing+=(mesa-vulkan-drivers)
fi
if [ "${1:-}" = --missing ]; then
    echo "${optional[*]}"
    exit 0
fi
PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null | grep 'libvulkan\.so\.1' >/dev/null || missing+=(libvulkan1)
[ $((${#missing[@]} + ${#optional[@]})) -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo -n)
fi
install() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null; }
if command -v apt-get >/dev/null && "${as_root[@]}" true 2>/dev/null; then
    echo "Installing ${missing[*]} ${optional[*]}"
    known=true
    "${as_root[@]}" apt-get update -qq -o APT::Update::Error-Mode=any || known=false
    [ ${#missing[@]} -eq 0 ] || install "${missing[@]}"
    if [ ${#optional[@]} -gt 0 ] && ! install "${optional[@]}"; then
        if [ "${CI:-}" = true ] && $known && apt-cache show "${optional[@]}" >/dev/null 2>&1; then
            echo "${optional[*]} could not be installed, and CI must not lose the tests that need them." >&2
            exit 1
        fi
        echo "Tests that need one of ${optional[*]} will be skipped." >&2
    fi
    exit 0
fi
if [ ${#missing[@]} -gt 0 ]; then
    echo "pelage needs these packages (Debian's names): ${missing[*]}; please install them." >&2
    exit 1
fi
echo "Tests that need one of ${optional[*]} (Debian's names) will be skipped." >&2
