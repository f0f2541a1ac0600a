// Opaque, as the rasterisers fill it: stage NEAREST finds a pixel's nearest depth and its whole optical depth, stage
// WINNER the fragment that has it.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// Distance of the nearest key from the largest, so that a cleared word is the farthest.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
// Distance of (point, place along the segment) from the largest; the lower wins.
@group(3) @binding(2) var<storage, read_write> links: array<atomic<u32>>;
// Σ -ln(1 - opacity).
@group(3) @binding(3) var<storage, read_write> fragment_keys: array<atomic<u32>>;

const STAGE_NEAREST: u32 = 0u;
const STAGE_WINNER: u32 = 1u;

var<private> opaque_produced: u32;
var<private> opaque_culled: u32;

fn emit_begin() -> bool {
    opaque_produced = 0u;
    opaque_culled = 0u;
    pixels_begin();
    emit_host_depth = (drawing.flags & DRAWING_HOST_DEPTH) != 0u;
    return true;
}

fn emit_end() {
    if opaque_produced > 0u { atomicAdd(&counters.produced, opaque_produced); }
    if opaque_culled > 0u { atomicAdd(&counters.culled, opaque_culled); }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    let number = pixel_number(pixel);
    if fragment_hidden(pixel, key, compare) {
        if STAGE == STAGE_NEAREST { opaque_culled += 1u; }
        return;
    }
    if STAGE == STAGE_NEAREST {
        opaque_produced += 1u;
        atomicMax(&fill[number], 0xffffffffu - key);
        let depth = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
        let before = atomicAdd(&fragment_keys[number], depth);
        // A wrapped sum is held above half of the range, where the transmittance is 0 all the same.
        if before + depth < before { atomicOr(&fragment_keys[number], 0x80000000u); }
    } else if atomicLoad(&fill[number]) == 0xffffffffu - key {
        let along = u32(fragment.along * 255.0 + 0.5);
        atomicMax(&links[number], 0xffffffffu - ((fragment.point << 8u) | along));
    }
}
