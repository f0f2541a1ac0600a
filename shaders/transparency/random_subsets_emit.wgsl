// Random subsets (Hunz 2016, §5.4), as the rasterisers fill them. The strands are parted into k subsets by a hash; each is
// drawn as if it were opaque: a pixel keeps the nearest fragment of every subset. Stage NEAREST finds the upper half of its word,
// stage WINNER the lower one, so that nothing depends on the order in which fragments come.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// Σ -ln(1 - opacity) of all of a pixel's fragments.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
// The upper and the lower halves of a word for each pixel's each subset, inverted: cleared words are the farthest.
@group(3) @binding(3) var<storage, read_write> fragments_0: array<atomic<u32>>;
@group(3) @binding(4) var<storage, read_write> fragments_1: array<atomic<u32>>;

const STAGE_NEAREST: u32 = 0u;
const STAGE_WINNER: u32 = 1u;

var<private> random_subsets_produced: u32;
var<private> random_subsets_culled: u32;
var<private> random_subsets_count: u32;
var<private> random_subsets_sums: bool;

fn emit_begin() -> bool {
    emit_common_begin();
    word_begin();
    random_subsets_produced = 0u;
    random_subsets_culled = 0u;
    random_subsets_count = u32(frame.technique.x);
    random_subsets_sums = frame.technique.y != 0.0;
    return true;
}

fn emit_end() {
    if random_subsets_produced > 0u { atomicAdd(&counters.produced, random_subsets_produced); }
    if random_subsets_culled > 0u { atomicAdd(&counters.culled, random_subsets_culled); }
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) {
        if STAGE == STAGE_NEAREST { random_subsets_culled += 1u; }
        return;
    }
    let number = pixel_number(pixel);
    let subset = (shaded_hash(fragment.point) * random_subsets_count) >> 16u;
    let place = number * random_subsets_count + subset;
    let word = ~word_pack(StoredFragment(key, fragment.point, fragment.opacity, fragment.along));
    if STAGE == STAGE_NEAREST {
        random_subsets_produced += 1u;
        atomicMax(&fragments_0[place], word.x);
        if random_subsets_sums {
            let depth = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
            let before = atomicAdd(&fill[number], depth);
            // A wrapped sum is held above half of the range, where the transmittance is 0 all the same.
            if before + depth < before { atomicOr(&fill[number], 0x80000000u); }
        }
    } else if atomicLoad(&fragments_0[place]) == word.x {
        atomicMax(&fragments_1[place], word.y);
    }
}
