// Moment opacity map, as the rasterisers fill it: one pass, since depths are those of the whole map and no front is
// needed first.

@group(2) @binding(0) var<storage, read_write> shadow_maps: array<atomic<u32>>;

const EMIT_COMPARES: bool = false;

// Read once an invocation: some drivers would read a uniform anew at every texel.
var<private> map_width: u32;
var<private> map_layers: u32;
var<private> map_words: u32;
var<private> map_scale: f32;

fn emit_begin() -> bool {
    map_width = u32(segment_viewport().x);
    map_layers = drawing.layer_base;
    map_words = drawing.layer_count;
    map_scale = 2.0 / drawing.map_values.x;
    return true;
}

fn emit_end() {}

fn moment_add(texel: u32, sum: u32, value: f32) {
    let steps = u32(value + 0.5);
    let before = atomicAdd(&shadow_maps[texel + sum], steps);
    if before + steps < before {
        let carries = texel + map_words - 1u;
        let shift = sum * MOMENT_CARRY_BITS;
        let counted = atomicAdd(&shadow_maps[carries], 1u << shift) >> shift;
        if (counted & MOMENT_CARRY_MASK) == MOMENT_CARRY_MASK { atomicOr(&shadow_maps[carries], MOMENT_OVERFLOWED); }
    }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    let texel = map_layers + (pixel.y * map_width + pixel.x) * map_words;
    let mass = min(optical_depth(fragment.opacity), MOMENT_OPAQUE) * MOMENT_SCALE;
    if mass < 0.5 { return; }
    let x = clamp(fragment.depth * map_scale - 1.0, -1.0, 1.0);
    moment_add(texel, 0u, mass);
    var before = 1.0;
    var polynomial = x;
    for (var k = 1u; k + 1u < map_words; k++) {
        moment_add(texel, k, mass * (0.5 + 0.5 * polynomial));
        let next = 2.0 * x * polynomial - before;
        before = polynomial;
        polynomial = next;
    }
}
