// Sorted blending: a counting sort of all segments by the depth of their farther end (Kim 2003, §3).
//
// A run's points lie in chunks; the segments that begin there are counted and scattered by one invocation, one after the other, so
// that segments of one bin keep their order, and a frame drawn again is the same. The histogram has a row of chunks for each
// bin; a prefix sum over all of it gives each chunk's first place in each bin.

// Two words a segment: its first point among the frame's pooled points, and its fibre's opacity.
@group(3) @binding(0) var<storage, read_write> sorted: array<u32>;
// bins × chunks, then the bins' totals, in HISTOGRAM_PARTS bindings, since one may be too small for them. Each but the last holds
// HISTOGRAM_EACH words.
@group(3) @binding(1) var<storage, read_write> histogram_0: array<u32>;
@group(3) @binding(2) var<storage, read_write> histogram_1: array<u32>;
@group(3) @binding(3) var<storage, read_write> histogram_2: array<u32>;
@group(3) @binding(4) var<storage, read_write> histogram_3: array<u32>;

// A workgroup's part of the bins' totals.
const SORT_INVOCATIONS: u32 = 256u;

struct Sort {
    bins: u32,
    chunks: u32,
    // Points of a chunk.
    each: u32,
    front_to_back: bool,
    place: vec4f,
}

fn sort_settings() -> Sort {
    let values = vec4u(frame.technique);
    return Sort(values.x, values.y, values.z, values.w != 0u, frame.place_of_depth);
}

fn sort_histogram(word: u32) -> u32 {
    if HISTOGRAM_PARTS == 1u || word < HISTOGRAM_EACH { return histogram_0[word]; }
    if HISTOGRAM_PARTS == 2u || word < 2u * HISTOGRAM_EACH { return histogram_1[word - HISTOGRAM_EACH]; }
    if HISTOGRAM_PARTS == 3u || word < 3u * HISTOGRAM_EACH { return histogram_2[word - 2u * HISTOGRAM_EACH]; }
    return histogram_3[word - 3u * HISTOGRAM_EACH];
}

fn sort_histogram_set(word: u32, value: u32) {
    if HISTOGRAM_PARTS == 1u || word < HISTOGRAM_EACH {
        histogram_0[word] = value;
    } else if HISTOGRAM_PARTS == 2u || word < 2u * HISTOGRAM_EACH {
        histogram_1[word - HISTOGRAM_EACH] = value;
    } else if HISTOGRAM_PARTS == 3u || word < 3u * HISTOGRAM_EACH {
        histogram_2[word - 2u * HISTOGRAM_EACH] = value;
    } else {
        histogram_3[word - 3u * HISTOGRAM_EACH] = value;
    }
}

// Whether a segment begins at the point; each does, seen or not, so that their number is known.
fn sort_begins(index: u32) -> bool {
    return (projected[index].bisector_flags.y & PROJECTED_LAST) == 0u;
}

// The bin of a segment, in the order in which they are drawn. Segments that are not seen may lie in any.
fn sort_bin(sort: Sort, index: u32) -> u32 {
    let s = segment(index);
    if !s.valid { return 0u; }
    let far = max(place_in_extent(sort.place, s.start_depth), place_in_extent(sort.place, s.end_depth));
    let bin = min(u32(far * f32(sort.bins)), sort.bins - 1u);
    return select(sort.bins - 1u - bin, bin, sort.front_to_back);
}

@compute @workgroup_size(64)
fn sort_count(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let sort = sort_settings();
    let chunk = invocation.x + invocation.y * groups.x * 64u;
    let end = min((chunk + 1u) * sort.each, drawing.point_count);
    for (var index = chunk * sort.each; index < end; index++) {
        if !sort_begins(index) { continue; }
        let word = sort_bin(sort, index) * sort.chunks + drawing.chunk_base + chunk;
        sort_histogram_set(word, sort_histogram(word) + 1u);
    }
}

// Each bin's row becomes places within the bin.
@compute @workgroup_size(64)
fn sort_rows(@builtin(global_invocation_id) invocation: vec3u) {
    let sort = sort_settings();
    let bin = invocation.x;
    if bin >= sort.bins { return; }
    var total = 0u;
    for (var word = bin * sort.chunks; word < (bin + 1u) * sort.chunks; word++) {
        let value = sort_histogram(word);
        sort_histogram_set(word, total);
        total += value;
    }
    sort_histogram_set(sort.bins * sort.chunks + bin, total);
}

var<workgroup> sort_sums: array<u32, SORT_INVOCATIONS>;

// The bins' totals become their first places.
@compute @workgroup_size(SORT_INVOCATIONS)
fn sort_totals(@builtin(local_invocation_index) local: u32) {
    let sort = sort_settings();
    let totals = sort.bins * sort.chunks;
    let each = (sort.bins + SORT_INVOCATIONS - 1u) / SORT_INVOCATIONS;
    let first = min(local * each, sort.bins);
    let end = min(first + each, sort.bins);
    var sum = 0u;
    for (var bin = first; bin < end; bin++) { sum += sort_histogram(totals + bin); }
    sort_sums[local] = sum;
    workgroupBarrier();
    if local == 0u {
        var total = 0u;
        for (var i = 0u; i < SORT_INVOCATIONS; i++) {
            let value = sort_sums[i];
            sort_sums[i] = total;
            total += value;
        }
    }
    workgroupBarrier();
    var place = sort_sums[local];
    for (var bin = first; bin < end; bin++) {
        let value = sort_histogram(totals + bin);
        sort_histogram_set(totals + bin, place);
        place += value;
    }
}

@compute @workgroup_size(64)
fn sort_scatter(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let sort = sort_settings();
    let chunk = invocation.x + invocation.y * groups.x * 64u;
    let end = min((chunk + 1u) * sort.each, drawing.point_count);
    for (var index = chunk * sort.each; index < end; index++) {
        if !sort_begins(index) { continue; }
        let bin = sort_bin(sort, index);
        let word = bin * sort.chunks + drawing.chunk_base + chunk;
        let before = sort_histogram(word);
        let place = sort_histogram(sort.bins * sort.chunks + bin) + before;
        sort_histogram_set(word, before + 1u);
        sorted[2u * place] = drawing.point_base + index;
        sorted[2u * place + 1u] = bitcast<u32>(drawing.opacity);
    }
}
