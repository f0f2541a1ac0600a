// Random subsets (Hunz 2016, §5.4), as the rasterisers fill them. The strands are parted into k subsets by a hash; each is
// drawn as if it were opaque: a pixel keeps the nearest fragment of every subset. Stage NEAREST finds its depth, stage
// WINNER its segment, opacity and place on the segment. Where two fragments of a subset lie at one depth it shows the colour
// of the first segment and the larger opacity, so that nothing depends on the order in which they come.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// Σ -ln(1 - opacity) of all of a pixel's fragments.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
// A word for each pixel's each subset: distance of its nearest key from the largest, distance of the first segment from the
// largest, and opacity with place. Cleared words are the farthest.
@group(3) @binding(2) var<storage, read_write> links: array<atomic<u32>>;
@group(3) @binding(3) var<storage, read_write> subset_points: array<atomic<u32>>;
@group(3) @binding(6) var<storage, read_write> subset_values: array<atomic<u32>>;

const STAGE_NEAREST: u32 = 0u;
const STAGE_WINNER: u32 = 1u;

var<private> random_subsets_produced: u32;
var<private> random_subsets_culled: u32;
var<private> random_subsets_count: u32;
var<private> random_subsets_sums: bool;

fn emit_begin() -> bool {
    emit_common_begin();
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
    let word = number * random_subsets_count + subset;
    if STAGE == STAGE_NEAREST {
        random_subsets_produced += 1u;
        atomicMax(&links[word], 0xffffffffu - key);
        if random_subsets_sums {
            let depth = u32(optical_depth(fragment.opacity) * OPTICAL_DEPTH_SCALE + 0.5);
            let before = atomicAdd(&fill[number], depth);
            // A wrapped sum is held above half of the range, where the transmittance is 0 all the same.
            if before + depth < before { atomicOr(&fill[number], 0x80000000u); }
        }
    } else if atomicLoad(&links[word]) == 0xffffffffu - key {
        let value = (u32(sqrt(fragment.opacity) * 65535.0 + 0.5) << 16u) | u32(fragment.along * 65535.0 + 0.5);
        atomicMax(&subset_points[word], 0xffffffffu - fragment.point);
        atomicMax(&subset_values[word], value);
    }
}
