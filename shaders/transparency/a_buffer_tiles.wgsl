// Which tiles the composite draws where fragments lie in counted arrays: those with a fragment, and all of them where some have
// been merged.

fn tile_drawn(t: Tile) -> bool {
    var found = a_buffer_overflowed();
    for (var y = t.first.y; y < t.end.y && !found; y++) {
        let number = pixel_number(vec2u(t.first.x, y));
        found = links[number + t.end.x - t.first.x - 1u] > a_buffer_first(number);
    }
    return found;
}

@vertex
fn tiles_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> @builtin(position) vec4f {
    pixels_begin();
    let t = tile(number, vec2u(drawing.row_first, drawing.row_end));
    return select(TILE_NOWHERE, tile_corner(t, vertex), tile_drawn(t));
}
