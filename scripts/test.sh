#!/usr/bin/env bash
# Runs all tests on Mesa's software driver with the Vulkan validation layer active. Fails on any validation message, and
# under CI=true on any GPU test that did not run, and on any that was skipped for want of a package that is there.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh --test

# The software driver alone: golden images are its own. A host that chooses another has its reasons.
if [ -z "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ]; then
    shopt -s nullglob
    drivers=(/usr/share/vulkan/icd.d/lvp_icd*.json /usr/local/share/vulkan/icd.d/lvp_icd*.json /etc/vulkan/icd.d/lvp_icd*.json)
    VK_DRIVER_FILES=$(IFS=:; echo "${drivers[*]}")
    export VK_DRIVER_FILES VK_ICD_FILENAMES="$VK_DRIVER_FILES"
fi
export VK_INSTANCE_LAYERS="${VK_INSTANCE_LAYERS:-VK_LAYER_KHRONOS_validation}"
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-${TMPDIR:-/tmp}}"

log=target/test.log
mkdir -p target
cargo test --workspace 2>&1 | tee "$log"

if grep -nE 'VUID-|Validation (Error|Warning)|UNASSIGNED-' "$log"; then
    echo "make test: the validation layer has complained, see above." >&2
    exit 1
fi
if [ "${CI:-}" = true ] && grep -niE 'GPU test skipped|skipped: no (GPU|Vulkan|adapter)' "$log"; then
    echo "make test: a GPU test was skipped, see above." >&2
    exit 1
fi
skipped=$(grep -o 'skipped: [a-zA-Z0-9_:]*: no .*' "$log" | sort -u || true)
if [ -n "$skipped" ]; then
    # A test names the packages that it takes. Only one that is not there, because it could not be installed, excuses it.
    missing=" $(scripts/setup.sh --missing) "
    while read -r line; do
        packages=${line##*Debian\'s } excused=
        for package in $(tr ',' ' ' <<<"${packages%%)*}"); do
            [[ $missing != *" $package "* ]] || excused=yes
        done
        if [ "${CI:-}" = true ] && [ -z "$excused" ]; then
            echo "make test: $line, which is there." >&2
            exit 1
        fi
    done <<<"$skipped"
    echo "make test: $(wc -l <<<"$skipped") tests were skipped, or a part of them, for want of a program or a package; see above."
fi
