// Depth peeling, after a peel: what was found goes under what the peels before have found.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
@group(3) @binding(3) var<storage, read_write> peeled: array<u32>;
@group(3) @binding(5) var<storage, read_write> overflow: array<u32>;

var<workgroup> depth_peeling_found: atomic<u32>;
var<workgroup> depth_peeling_stored: atomic<u32>;

// Whether the pixel goes on.
fn depth_peeling_pixel(number: u32) -> bool {
    let state = number * PEEL_WORDS;
    let found = number * OVERFLOW_WORDS;
    if peeled[state + PEEL_UPPER] == PEEL_DONE { return false; }
    let word = ~vec2u(overflow[found + FOUND_UPPER], overflow[found + FOUND_LOWER]);
    overflow[found + FOUND_UPPER] = 0u;
    overflow[found + FOUND_LOWER] = 0u;
    var goes_on = word.x != PEEL_DONE;
    if goes_on {
        let fragment = word_unpack(word);
        var transmittance = bitcast<f32>(peeled[state + PEEL_TRANSMITTANCE] ^ PEEL_ONE);
        let colour = transmittance * fragment.opacity * shaded_colour(fragment.point, fragment.along);
        for (var i = 0u; i < 3u; i++) {
            let sum = bitcast<f32>(peeled[state + PEEL_COLOUR + i]) + colour[i];
            peeled[state + PEEL_COLOUR + i] = bitcast<u32>(sum);
        }
        transmittance *= 1.0 - fragment.opacity;
        peeled[state + PEEL_TRANSMITTANCE] = bitcast<u32>(transmittance) ^ PEEL_ONE;
        goes_on = transmittance > PEEL_UNSEEN;
        atomicAdd(&depth_peeling_stored, 1u);
    }
    peeled[state + PEEL_UPPER] = select(PEEL_DONE, word.x, goes_on);
    peeled[state + PEEL_LOWER] = word.y;
    return goes_on;
}

@compute @workgroup_size(64)
fn depth_peeling_advance(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    word_begin();
    let number = invocation.x + invocation.y * groups.x * 64u;
    let count = (drawing.row_end - drawing.row_first) * u32(drawing.viewport.x);
    if number < count {
        if depth_peeling_pixel(number) { atomicAdd(&depth_peeling_found, 1u); }
    }
    workgroupBarrier();
    if local == 0u {
        let stored = atomicLoad(&depth_peeling_stored);
        if stored > 0u { atomicAdd(&counters.stored, stored); }
        if atomicLoad(&depth_peeling_found) > 0u { atomicStore(&counters.overflow, 1u); }
    }
}
