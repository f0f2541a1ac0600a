// What every transparency technique asks of a fragment before it stores it: that it lies within the view's depth range,
// in front of the host's opaque scene.

fn fragment_in_range(fragment: Fragment) -> bool {
    return fragment.opacity > 0.0 && fragment.depth >= 0.0 && fragment.depth <= 1.0;
}

// Whether the host's opaque scene hides a fragment.
fn fragment_hidden(pixel: vec2u, key: u32) -> bool {
    if segment_in_front || (drawing.flags & DRAWING_HOST_DEPTH) == 0u { return false; }
    return key >= depth_key(textureLoad(host_depth, pixel, 0));
}
