#!/usr/bin/env bash
# Runs all tests on Mesa's software driver with the Vulkan validation layer active. Fails on any validation message, and
# under CI=true on any GPU test that did not run.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh --test

# The software driver alone: golden images are its own. A host that chooses another has its reasons.
if [ -z "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ]; then
    driver=$(find /usr/share/vulkan/icd.d /usr/local/share/vulkan/icd.d /etc/vulkan/icd.d -name 'lvp_icd*.json' 2>/dev/null | paste -sd: -)
    export VK_DRIVER_FILES="$driver" VK_ICD_FILENAMES="$driver"
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
