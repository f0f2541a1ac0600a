// K-buffer volumetric shadow: the look-up.

fn shadow_texel(place: vec2u, map: u32, light: u32, depth: f32) -> ShadowTexel {
    let words = frame.lights[light].layer_count;
    let first = frame.shadow_views[map].layer_base + (place.y * frame.lights[light].resolution + place.x) * words;
    let extent = frame.shadow_views[map].values.x;
    let k = u32(frame.shadow_views[map].values.y);
    let coloured = frame.shadow_views[map].colour.w > 0.0;
    // Without the point's own fibre, whose event is as deep as it is in this texel.
    let own = shadow_own(place);
    let before = select(depth, min(depth, own.depth - shadow_fibre.radius), own.optical_depth > 0.0);
    if !(before > 0.0) { return ShadowTexel(vec3f(1.0), 0.0); }
    let key = volume_depth(before, extent);

    // How many events lie before the depth: all of them behind the hair.
    let behind = before > extent;
    var low = 0u;
    var high = k;
    for (var i = 0u; i < 7u && low < high; i++) {
        let middle = (low + high) / 2u;
        let word = shadow_maps[first + middle];
        if word != 0u && (behind || (~word >> VOLUME_PAYLOAD_BITS) < key) { low = middle + 1u; } else { high = middle; }
    }
    if low == 0u { return ShadowTexel(vec3f(1.0), 0.0); }
    let last = ~shadow_maps[first + low - 1u];
    var left: vec3f;
    if coloured {
        left = volume_unpack(shadow_maps[first + k + VOLUME_TAIL_WORDS + low - 1u]);
    } else {
        let root = f32(last & VOLUME_PAYLOAD_MASK) / VOLUME_PAYLOAD_LAST;
        left = vec3f(root * root);
    }
    if low == k {
        let rest = bitcast<f32>(shadow_maps[first + k + VOLUME_REST]);
        let start = f32(last >> VOLUME_PAYLOAD_BITS);
        let end = f32(shadow_maps[first + k + VOLUME_BACK]);
        var part = clamp((f32(key) - start) / max(end - start, 1.0), 0.0, 1.0);
        if behind { part = 1.0; }
        left *= exp(-rest * part * unpack4x8unorm(shadow_maps[first + k + VOLUME_COLOUR]).xyz);
    }
    // Where light passes through fibres this counts what they take as fewer fibres.
    return ShadowTexel(left, -log(max(left.y, 1e-7)));
}
