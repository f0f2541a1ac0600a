// Each pixel's nearest fragment as `nearest_emit` has found it; none where nothing asked for it.

@group(3) @binding(1) var<storage, read> fill: array<u32>;
@group(3) @binding(2) var<storage, read> links: array<u32>;

fn nearest_key(number: u32) -> u32 {
    if (frame.flags & FRAME_NEAREST) == 0u { return 0xffffffffu; }
    return 0xffffffffu - fill[number];
}

// Together with the opacity of all of the pixel's fragments.
fn nearest_of(number: u32, opacity: f32) -> Nearest {
    let key = nearest_key(number);
    if key == 0xffffffffu { return Nearest(0xffffffffu, 0xffffffffu, 0.0, opacity); }
    // Where no output asks for the segment, `links` holds nothing of this frame, and nothing reads what it says.
    let winner = 0xffffffffu - links[number];
    return Nearest(key, winner >> 8u, f32(winner & 255u) / 255.0, opacity);
}
