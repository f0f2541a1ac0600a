// Opacity shadow maps, as the rasterisers fill them (Kim §4, after Kim and Neumann 2001): each fragment's
// -ln(1 - opacity) is added to the slab between two planes that its depth falls in.
//
// Kim draws the hair once a plane, clipped, into an 8-bit alpha; four planes in the channels of each of several render
// targets are how hardware without atomics did several at once. Here one walk fills all of them: each fragment is one
// atomic addition, however many planes there are.

var<private> map_extent: f32;
var<private> map_uneven: f32;

fn emit_begin() -> bool {
    map_begin();
    map_extent = 1.0 / drawing.map_values.x;
    map_uneven = drawing.map_values.y;
    return true;
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    map_add(pixel, opacity_slab(fragment.depth * map_extent, map_uneven, map_layer_count), fragment.opacity);
}
