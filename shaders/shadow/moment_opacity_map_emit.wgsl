// Moment opacity map, as the rasterisers fill it: one pass, since depths are those of the whole map and no front is
// needed first.

var<private> map_scale: f32;

fn emit_begin() -> bool {
    map_begin();
    map_scale = 2.0 / drawing.map_values.x;
    return true;
}

fn moment_add(texel: u32, sum: u32, value: f32) {
    let steps = u32(value + 0.5);
    let before = atomicAdd(&shadow_maps[texel + sum], steps);
    if before + steps < before {
        let carries = texel + map_layer_count - 1u;
        let shift = sum * MOMENT_CARRY_BITS;
        let counted = atomicAdd(&shadow_maps[carries], 1u << shift) >> shift;
        if (counted & MOMENT_CARRY_MASK) == MOMENT_CARRY_MASK { atomicOr(&shadow_maps[carries], MOMENT_OVERFLOWED); }
    }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    let texel = map_layers + (pixel.y * map_width + pixel.x) * map_layer_count;
    let mass = min(optical_depth(fragment.opacity), MOMENT_OPAQUE) * MOMENT_SCALE;
    if mass < 0.5 { return; }
    let x = clamp(fragment.depth * map_scale - 1.0, -1.0, 1.0);
    moment_add(texel, 0u, mass);
    var before = 1.0;
    var polynomial = x;
    for (var k = 1u; k + 1u < map_layer_count; k++) {
        moment_add(texel, k, mass * (0.5 + 0.5 * polynomial));
        let next = 2.0 * x * polynomial - before;
        before = polynomial;
        polynomial = next;
    }
}
