// k⁺-buffer, as the rasterisers fill it; `k_plus_insert` and `k_plus_store` come from the form, of 64 or of 32 bits.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// Σ -ln(1 - opacity) of all fragments of a pixel.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
@group(3) @binding(5) var<storage, read_write> overflow: array<atomic<u32>>;

// STAGE: the pass in its lowest bit, then two bits of REST, then K.
const K_PLUS_STORES: bool = (STAGE & 1u) != 0u;
const REST: u32 = (STAGE >> 1u) & 3u;
const K: u32 = STAGE >> 3u;

var<private> k_plus_produced: u32;
var<private> k_plus_culled: u32;
var<private> k_plus_stored: u32;

fn emit_begin() -> bool {
    k_plus_produced = 0u;
    k_plus_culled = 0u;
    k_plus_stored = 0u;
    emit_common_begin();
    k_plus_begin();
    return true;
}

fn emit_end() {
    if K_PLUS_STORES { return; }
    var rest = k_plus_produced - k_plus_stored;
    if k_plus_stored > 0u { atomicAdd(&counters.stored, k_plus_stored); }
    if REST == REST_DROPPED {
        k_plus_culled += rest;
        k_plus_produced = k_plus_stored;
        rest = 0u;
    }
    if k_plus_produced > 0u { atomicAdd(&counters.produced, k_plus_produced); }
    if k_plus_culled > 0u { atomicAdd(&counters.culled, k_plus_culled); }
    if rest > 0u { atomicAdd(&counters.merged, rest); }
}

// Adds a fragment to the sums of its pixel, kept or not: the resolve takes off what was kept.
fn k_plus_sum(number: u32, fragment: StoredFragment) {
    let steps = k_plus_steps(fragment);
    for (var i = 0u; i < 4u; i++) {
        let before = atomicAdd(&overflow[number * K_PLUS_SUMS + i], steps[i]);
        if before + steps[i] < before {
            atomicAdd(&overflow[number * K_PLUS_SUMS + K_PLUS_CARRIES], 1u << (i * TAIL_CARRY_BITS));
        }
    }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) {
        k_plus_culled += 1u;
        return;
    }
    let number = pixel_number(pixel);
    let word = word_pack(StoredFragment(key, fragment.point, fragment.opacity, fragment.along));
    if K_PLUS_STORES {
        k_plus_store(number * K, ~word);
        return;
    }
    k_plus_produced += 1u;
    if REST != REST_DROPPED {
        let depth = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
        let before = atomicAdd(&fill[number], depth);
        // A wrapped sum is held above half of the range, where the transmittance is 0 all the same.
        if before + depth < before { atomicOr(&fill[number], 0x80000000u); }
    }
    if REST == REST_MERGED { k_plus_sum(number, word_unpack(word)); }
    if k_plus_insert(number * K, ~word) { k_plus_stored += 1u; }
}
