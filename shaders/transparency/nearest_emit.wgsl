// Each pixel's nearest fragment, for techniques that keep no order and only where an output or the host's depth asks for
// it: stage NEAREST finds its depth, stage WINNER its segment.

// Distance of the nearest key from the largest, so that a cleared word is the farthest.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
// Distance of (point, place along the segment) from the largest; the lower wins.
@group(3) @binding(2) var<storage, read_write> links: array<atomic<u32>>;

const STAGE_NEAREST: u32 = 0u;
const STAGE_WINNER: u32 = 1u;

fn emit_begin() -> bool {
    emit_common_begin();
    return true;
}

fn emit_end() {}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) { return; }
    let number = pixel_number(pixel);
    if STAGE == STAGE_NEAREST {
        atomicMax(&fill[number], 0xffffffffu - key);
    } else if atomicLoad(&fill[number]) == 0xffffffffu - key {
        let along = u32(fragment.along * 255.0 + 0.5);
        atomicMax(&links[number], 0xffffffffu - ((fragment.point << 8u) | along));
    }
}
