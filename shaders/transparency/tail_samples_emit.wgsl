// The colour of an overflow's tail, where colours are found in the resolve alone: three of its fragments, drawn by hash, so that
// the draw does not depend on their order. Each word keeps the largest of an invertible hash of (point, place along it).

const TAIL_HASHES: vec3u = vec3u(0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du);

fn tail_merge_colour(pixel: u32, fragment: Fragment) {
    if fragment.opacity == 0.0 { return; }
    // Never 0: no segment begins at the last point that there can be.
    let name = ~((fragment.point << 8u) | u32(fragment.along * 255.0 + 0.5));
    for (var i = 0u; i < 3u; i++) {
        atomicMax(&overflow[pixel * OVERFLOW_WORDS + TAIL_COLOUR + i], name * TAIL_HASHES[i]);
    }
}
