// Moment opacity map: the look-up.

// A fibre that is no farther behind the front than this part of its radius is the front: maps and look-ups round differently, and at
// a place a little beside its own mass it would find that mass before it.
const MOMENT_OWN_FRONT: f32 = 0.0625;

fn moment_sum(texel: u32, sum: u32, carries: u32) -> f32 {
    let carried = (carries >> (sum * MOMENT_CARRY_BITS)) & MOMENT_CARRY_MASK;
    return f32(shadow_maps[texel + sum]) + f32(carried) * 4294967296.0;
}

fn shadow_texel(place: vec2u, map: u32, light: u32, depth: f32) -> ShadowTexel {
    let words = frame.lights[light].layer_count;
    let at = place.y * frame.lights[light].resolution + place.x;
    let texel = frame.shadow_views[map].layer_base + at * words;
    let front = shadow_front(shadow_maps[frame.shadow_views[map].front_base + at]);
    let carries = shadow_maps[texel + words - 1u];
    let total = moment_sum(texel, 0u, carries);
    // The point stands where its own fibre lies in this texel, whose mass is taken off there: a place beside it would have
    // the fibre's own mass close by, on either side.
    let own = shadow_own(place);
    let before = select(depth, own.depth, own.optical_depth > 0.0);
    let own_mass = min(own.optical_depth, MOMENT_OPAQUE);
    let behind = before - front;
    let nearest = max(shadow_depth_rounding, MOMENT_OWN_FRONT * shadow_fibre.radius);
    if total == 0.0 || !(behind > nearest) { return ShadowTexel(vec3f(1.0), 0.0); }
    let x = moment_place(behind / frame.shadow_views[map].values.x);
    if (carries & MOMENT_OVERFLOWED) != 0u {
        return shadow_passed(MOMENT_OVERFLOW_DEPTH * 0.5 * (x + 1.0), map);
    }
    // Behind all hair nothing is left to guess.
    if before >= frame.shadow_views[map].values.y { return shadow_passed(max(total / MOMENT_SCALE - own_mass, 0.0), map); }
    let six = words == 8u;
    let kept = 1.0 - min(MOMENT_BIAS + MOMENT_BIAS_STEPS / total, 1.0);
    var b: array<f32, 6>;
    for (var k = 1u; k + 1u < words; k++) {
        b[k - 1u] = kept * (2.0 * moment_sum(texel, k, carries) / total - 1.0);
    }
    let bounds = clamp(moment_before(b, x, own_mass * MOMENT_SCALE / total, six), vec2f(0.0), vec2f(1.0));
    let least = shadow_passed(total / MOMENT_SCALE * bounds.x, map);
    let most = shadow_passed(total / MOMENT_SCALE * bounds.y, map);
    return ShadowTexel(mix(least.transmittance, most.transmittance, MOMENT_PART), mix(least.fibres, most.fibres, MOMENT_PART));
}
