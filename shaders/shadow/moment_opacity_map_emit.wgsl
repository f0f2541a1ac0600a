// Moment opacity map, as the rasterisers fill it. Stage FRONT finds the nearest depth of each texel; stage MOMENTS adds each
// fragment's -ln(1 - opacity) at its place behind the front.

const STAGE_FRONT: u32 = 0u;
const STAGE_MOMENTS: u32 = 1u;

var<private> map_scale: f32;

fn emit_begin() -> bool {
    map_begin();
    map_scale = 1.0 / drawing.map_values.x;
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
    if STAGE == STAGE_FRONT {
        map_nearest(pixel, fragment.depth);
        return;
    }
    let place = pixel.y * map_width + pixel.x;
    let texel = map_layers + place * map_layer_count;
    let mass = min(optical_depth(fragment.opacity), MOMENT_OPAQUE) * MOMENT_SCALE;
    if mass < 0.5 { return; }
    let front = shadow_front(atomicLoad(&shadow_maps[map_fronts + place]));
    let x = moment_place(max(fragment.depth - front, 0.0) * map_scale);
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
