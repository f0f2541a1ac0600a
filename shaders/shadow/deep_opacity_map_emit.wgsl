// Deep opacity map, as the rasterisers fill it (Hunz §4.2, after Yuksel and Keyser 2008). Stage FRONT finds the
// nearest depth of each texel; stage LAYERS adds each fragment's -ln(1 - opacity) to the layer that its depth
// behind the front falls in.

const STAGE_FRONT: u32 = 0u;
const STAGE_LAYERS: u32 = 1u;

var<private> map_extent: f32;

fn emit_begin() -> bool {
    map_begin();
    map_extent = 1.0 / drawing.map_values.x;
    return true;
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if STAGE == STAGE_FRONT {
        map_nearest(pixel, fragment.depth);
    } else {
        let front = shadow_front(atomicLoad(&shadow_maps[map_fronts + pixel.y * map_width + pixel.x]));
        let layer = deep_opacity_layer((fragment.depth - front) * map_extent, map_layer_count);
        map_add(pixel, layer, fragment.opacity);
    }
}
