// Deep opacity map, as the rasterisers fill it (Hunz §4.2, after Yuksel and Keyser 2008). Stage FRONT finds the
// nearest depth a texel; stage LAYERS adds each fragment's -ln(1 - opacity) to the layer that its depth behind the
// front falls in. Sums are fixed-point integers: their order does not matter, and one that would wrap sticks.

@group(2) @binding(0) var<storage, read_write> shadow_maps: array<atomic<u32>>;

const STAGE_FRONT: u32 = 0u;
const STAGE_LAYERS: u32 = 1u;

fn emit_begin() -> bool { return true; }
fn emit_end() {}

fn emit(pixel: vec2u, fragment: Fragment) {
    let texel = pixel.y * u32(drawing.viewport.x) + pixel.x;
    if STAGE == STAGE_FRONT {
        // Most fragments lie behind the front; a look is cheaper than an atomic maximum.
        let word = deep_opacity_front_word(fragment.depth);
        if fragment.opacity > 0.0 && word > atomicLoad(&shadow_maps[drawing.front_base + texel]) {
            atomicMax(&shadow_maps[drawing.front_base + texel], word);
        }
    } else {
        let front = deep_opacity_front(atomicLoad(&shadow_maps[drawing.front_base + texel]));
        let layer = deep_opacity_layer((fragment.depth - front) / drawing.layer_extent, drawing.layer_count);
        let word = drawing.layer_base + texel * drawing.layer_count + layer;
        let depth = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
        let before = atomicAdd(&shadow_maps[word], depth);
        // A wrapped sum is held above half of the range, where the transmittance is 0 all the same.
        if before + depth < before { atomicOr(&shadow_maps[word], 0x80000000u); }
    }
}
