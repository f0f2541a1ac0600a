// What every transparency technique asks of a fragment before it stores it: that it lies within the view's depth range,
// in front of the host's opaque scene.

// Whether a segment that lies before all of the host's opaque scene is better treated apart.
const EMIT_COMPARES: bool = true;

var<private> emit_host_depth: bool;

fn fragment_in_range(fragment: Fragment) -> bool {
    return fragment.depth >= 0.0 && fragment.depth <= 1.0;
}

// Whether the host's opaque scene hides a fragment.
fn fragment_hidden(pixel: vec2u, key: u32, compare: bool) -> bool {
    if !compare || !emit_host_depth { return false; }
    return key >= depth_key(textureLoad(host_depth, pixel, 0));
}
