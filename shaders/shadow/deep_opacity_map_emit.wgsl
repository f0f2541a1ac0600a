// Deep opacity map, as the rasterisers fill it (Hunz §4.2, after Yuksel and Keyser 2008). Stage FRONT finds the
// nearest depth of each block of texels; stage LAYERS adds each fragment's -ln(1 - opacity) to the layer that its depth behind the
// front falls in. Sums are fixed-point integers: their order does not matter, and one that would wrap sticks.

@group(2) @binding(0) var<storage, read_write> shadow_maps: array<atomic<u32>>;

const STAGE_FRONT: u32 = 0u;
const STAGE_LAYERS: u32 = 1u;

const EMIT_COMPARES: bool = false;

// Read once an invocation: some drivers would read a uniform anew at every texel.
var<private> map_width: u32;
var<private> map_front: u32;
var<private> map_front_shift: u32;
var<private> map_layers: u32;
var<private> map_layer_count: u32;
var<private> map_extent: f32;

fn emit_begin() -> bool {
    // In the pixels of this stage.
    map_width = u32(segment_viewport().x);
    map_front = drawing.front_base;
    map_front_shift = drawing.front_shift;
    map_layers = drawing.layer_base;
    map_layer_count = drawing.layer_count;
    map_extent = 1.0 / drawing.map_values.x;
    return true;
}

fn emit_end() {}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if STAGE == STAGE_FRONT {
        let place = map_front + pixel.y * map_width + pixel.x;
        // Most fragments lie behind the front; a look is cheaper than an atomic maximum.
        let word = shadow_front_word(fragment.depth);
        if word > atomicLoad(&shadow_maps[place]) {
            atomicMax(&shadow_maps[place], word);
        }
    } else {
        let texel = pixel.y * map_width + pixel.x;
        let front_place = map_front + shadow_front_place(pixel, map_width, map_front_shift);
        let front = shadow_front(atomicLoad(&shadow_maps[front_place]));
        let layer = deep_opacity_layer((fragment.depth - front) * map_extent, map_layer_count);
        let word = map_layers + texel * map_layer_count + layer;
        let depth = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
        let before = atomicAdd(&shadow_maps[word], depth);
        // A wrapped sum is held above half of the range, where the transmittance is 0 all the same.
        if before + depth < before { atomicOr(&shadow_maps[word], 0x80000000u); }
    }
}
