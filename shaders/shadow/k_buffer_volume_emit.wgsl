// K-buffer volumetric shadow, as the rasterisers fill it.

var<private> map_extent: f32;
var<private> map_k: u32;
var<private> map_tail: bool;
var<private> map_coloured: bool;
var<private> map_point_base: u32;
var<private> map_texel: f32;

fn emit_begin() -> bool {
    map_begin();
    map_extent = drawing.map_values.x;
    map_k = u32(drawing.map_values.y);
    map_tail = drawing.map_values.z > 0.0;
    map_texel = drawing.map_values.w;
    map_coloured = drawing.map_colour.w > 0.0;
    map_point_base = drawing.point_base;
    return true;
}

// The angle between the light and the normal plane of a fragment's segment.
fn volume_inclination(point: u32) -> f32 {
    let index = point - map_point_base;
    let across = length(projected[index + 1u].position - projected[index].position) * map_texel;
    return atan2(abs(projected[index + 1u].depth_width.x - projected[index].depth_width.x), max(across, 1e-30));
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    let texel = map_layers + (pixel.y * map_width + pixel.x) * map_layer_count;
    let depth = volume_depth(fragment.depth, map_extent);
    var inclination = 0.0;
    if map_coloured { inclination = volume_inclination(fragment.point); }
    let payload = volume_payload(fragment.opacity, inclination, map_coloured);
    if payload == 0u { return; }
    if map_tail {
        let rest = texel + map_k;
        let steps = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
        let before = atomicAdd(&shadow_maps[rest + VOLUME_REST], steps);
        if before + steps < before { atomicOr(&shadow_maps[rest + VOLUME_REST], VOLUME_DENSE); }
        if depth > atomicLoad(&shadow_maps[rest + VOLUME_BACK]) { atomicMax(&shadow_maps[rest + VOLUME_BACK], depth); }
    }
    // 0 stands for an empty slot: the farthest event of all must not be it.
    var word = max(~((depth << VOLUME_PAYLOAD_BITS) | payload), 1u);
    // Slots only ever grow and never fall below the next one: what an old look excludes stays excluded.
    if word <= atomicLoad(&shadow_maps[texel + map_k - 1u]) { return; }
    var low = 0u;
    var high = map_k - 1u;
    for (var i = 0u; i < 6u && low < high; i++) {
        let middle = (low + high) / 2u;
        if atomicLoad(&shadow_maps[texel + middle]) < word { high = middle; } else { low = middle + 1u; }
    }
    for (var slot = low; slot < map_k && word != 0u; slot++) {
        word = min(atomicMax(&shadow_maps[texel + slot], word), word);
    }
}
