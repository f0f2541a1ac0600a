// What the rasterisers' writes to a light's map have in common: nearest depths and sums. Sums are fixed-point integers:
// their order does not matter, and one that would wrap sticks.

@group(2) @binding(0) var<storage, read_write> shadow_maps: array<atomic<u32>>;

const EMIT_COMPARES: bool = false;

fn emit_end() {}

// Read once an invocation: some drivers would read a uniform anew at every texel.
var<private> map_width: u32;
var<private> map_fronts: u32;
var<private> map_layers: u32;
var<private> map_layer_count: u32;

fn map_begin() {
    // In the pixels of this stage.
    map_width = u32(drawing.viewport.x);
    map_fronts = drawing.front_base;
    map_layers = drawing.layer_base;
    map_layer_count = drawing.layer_count;
}

// Takes a fragment's depth into a pixel's front.
fn map_nearest(pixel: vec2u, depth: f32) {
    let place = map_fronts + pixel.y * map_width + pixel.x;
    // Most fragments lie behind the front; a look is cheaper than an atomic maximum.
    let word = shadow_front_word(depth);
    if word > atomicLoad(&shadow_maps[place]) { atomicMax(&shadow_maps[place], word); }
}

// Adds a fragment's -ln(1 - opacity) to one of its texel's layers.
fn map_add(pixel: vec2u, layer: u32, opacity: f32) {
    let word = map_layers + (pixel.y * map_width + pixel.x) * map_layer_count + layer;
    let depth = u32(optical_depth(opacity) * OPTICAL_DEPTH_SCALE + 0.5);
    let before = atomicAdd(&shadow_maps[word], depth);
    // A wrapped sum is held above half of the range, where the transmittance is 0 all the same.
    if before + depth < before { atomicOr(&shadow_maps[word], 0x80000000u); }
}
