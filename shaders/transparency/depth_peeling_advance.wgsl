// Depth peeling, between two peels: each pixel's last peel goes under those before it, and what was found takes its place.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
@group(3) @binding(3) var<storage, read_write> peeled: array<u32>;
@group(3) @binding(6) var<storage, read_write> overflow: array<u32>;

var<workgroup> depth_peeling_found: atomic<u32>;

// Whether the pixel goes on.
fn depth_peeling_pixel(number: u32) -> bool {
    let words = number * PEEL_WORDS;
    let found = number * OVERFLOW_WORDS;
    if peeled[words + PEEL_KEY] == PEEL_DONE { return false; }
    var transmittance = bitcast<f32>(peeled[words + PEEL_TRANSMITTANCE] ^ PEEL_ONE);
    let word = peeled[words + PEEL_VALUE];
    if word != 0u {
        let value = depth_peeling_value(word);
        let colour = transmittance * value.x * shaded_colour(peeled[words + PEEL_POINT] - 1u, value.y);
        for (var i = 0u; i < 3u; i++) {
            let sum = bitcast<f32>(peeled[words + PEEL_COLOUR + i]) + colour[i];
            peeled[words + PEEL_COLOUR + i] = bitcast<u32>(sum);
        }
        transmittance *= 1.0 - value.x;
        peeled[words + PEEL_TRANSMITTANCE] = bitcast<u32>(transmittance) ^ PEEL_ONE;
        peeled[words + PEEL_VALUE] = 0u;
    }
    let key = overflow[found + FOUND_KEY];
    let point = overflow[found + FOUND_POINT];
    overflow[found + FOUND_KEY] = 0u;
    overflow[found + FOUND_POINT] = 0u;
    let goes_on = key != 0u && transmittance > PEEL_UNSEEN;
    peeled[words + PEEL_KEY] = select(PEEL_DONE, 0xffffffffu - key, goes_on);
    peeled[words + PEEL_POINT] = (0xffffffffu - point) + 1u;
    return goes_on;
}

@compute @workgroup_size(64)
fn depth_peeling_advance(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let number = invocation.x + invocation.y * groups.x * 64u;
    let count = (drawing.row_end - drawing.row_first) * u32(drawing.viewport.x);
    if number < count {
        if depth_peeling_pixel(number) { atomicAdd(&depth_peeling_found, 1u); }
    }
    workgroupBarrier();
    if local == 0u {
        let found = atomicLoad(&depth_peeling_found);
        if found > 0u {
            atomicAdd(&counters.stored, found);
            atomicStore(&counters.overflow, 1u);
        }
    }
}
