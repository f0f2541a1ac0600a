// Nearest depths alone, as the rasterisers fill them: all that a shadow map and an approximated deep shadow map hold.

fn emit_begin() -> bool {
    map_begin();
    return true;
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    map_nearest(pixel, fragment.depth);
}
