#!/usr/bin/env bash
# Renders the three built-in grooms into out/ and prints adapter, time and memory of each.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-${TMPDIR:-/tmp}}"

cargo build --release --example render
mkdir -p out
for groom in straight wavy curly; do
    echo "{\"hair\": \"builtin:$groom\"}" >"out/$groom.scene.json"
    cargo run --release --quiet --example render -- "out/$groom.scene.json" \
        --out "out/$groom.exr" --stats "out/$groom.json"
done
