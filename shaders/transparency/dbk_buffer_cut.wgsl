// DBK-buffer: a pixel's cut-off from its bins: the end of the bin in which the fragments' optical depth reaches frame.cut_depth, so
// that what is kept lets through no more than the tolerance.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
@group(3) @binding(1) var<storage, read_write> fill: array<u32>;
@group(3) @binding(2) var<storage, read_write> links: array<u32>;
// A pixel's bins are two vectors.
@group(3) @binding(5) var<storage, read_write> overflow: array<vec4u>;

var<workgroup> dbk_culled: atomic<u32>;

@compute @workgroup_size(64)
fn dbk_buffer_cut(
    @builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    pixels_begin();
    let number = dbk_number(invocation, groups);
    let pixels = dbk_pixels();
    if number < pixels {
        let enough = u32(ceil(frame.cut_depth * DBK_DEPTH_SCALE));
        let whole = links[number];
        var depth = 0u;
        var kept = 0u;
        var all = 0u;
        var last = DBK_BINS;
        let words = array(overflow[number * 2u], overflow[number * 2u + 1u]);
        for (var bin = 0u; bin < DBK_BINS; bin++) {
            let word = words[bin / 4u][bin % 4u];
            all += word & DBK_COUNT_MAX;
            depth += word >> DBK_COUNT_BITS;
            if last == DBK_BINS { kept = all; }
            if last == DBK_BINS && depth >= enough { last = bin; }
        }
        var cut = DBK_NO_CUT;
        if whole != 0u {
            kept = all + whole;
        } else if last + 1u < DBK_BINS {
            let pixel = vec2u(number % pixels_width, number / pixels_width);
            cut = dbk_bin_end(last, fill[dbk_tile_words(pixels, dbk_tile(dbk_columns(), pixel))], dbk_steps());
            if cut == DBK_NO_CUT { kept = all; }
            if all > kept { atomicAdd(&dbk_culled, all - kept); }
        }
        fill[number] = kept;
        fill[pixels + number] = cut;
    }
    workgroupBarrier();
    if local == 0u {
        let culled = atomicLoad(&dbk_culled);
        if culled > 0u { atomicAdd(&counters.culled, culled); }
    }
}
