// DBK-buffer: a pixel's passes. The cut-off from its bins: the end of the bin in which the fragments' optical depth
// reaches frame.cut_depth, so that what is kept lets through no more than the tolerance; or from its nearest depth and a
// shift along the ray. And what the cut-offs mean to segments: the farthest of each of the host's tiles.

@group(1) @binding(0) var<storage, read_write> host_tiles: array<vec2u>;
@group(3) @binding(0) var<storage, read_write> counters: Counters;
@group(3) @binding(1) var<storage, read_write> fill: array<u32>;
@group(3) @binding(2) var<storage, read_write> links: array<u32>;
@group(3) @binding(6) var<storage, read_write> overflow: array<u32>;

// A mix of two depths may fall short of both by its rounding.
const DBK_ROUNDING: u32 = 16u;

var<workgroup> dbk_culled: atomic<u32>;

fn dbk_number(invocation: vec3u, groups: vec3u) -> u32 {
    return invocation.x + invocation.y * groups.x * 64u;
}

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
        for (var bin = 0u; bin < DBK_BINS; bin++) {
            let word = overflow[number * DBK_BINS + bin];
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
            let tile = dbk_tile(pixels, dbk_columns(), pixel);
            let front = 0xffffffffu - fill[tile];
            cut = dbk_bin_end(last, front, dbk_unit(front, fill[tile + 1u]));
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

@compute @workgroup_size(64)
fn dbk_buffer_shift(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    pixels_begin();
    let number = dbk_number(invocation, groups);
    let pixels = dbk_pixels();
    if number >= pixels { return; }
    let front = overflow[number * DBK_BINS];
    overflow[number * DBK_BINS] = 0u;
    var cut = DBK_NO_CUT;
    if front != 0u {
        let depth = depth_of_key(0xffffffffu - front);
        let centre = vec2f(vec2u(number % pixels_width, number / pixels_width + drawing.row_first)) + 0.5;
        let ndc = vec2f(2.0, -2.0) * centre / drawing.viewport + vec2f(-1.0, 1.0);
        let here = frame.relative_from_clip * vec4f(ndc, depth, 1.0);
        let position = here.xyz / here.w;
        let away = position * frame.eye.w - frame.eye.xyz;
        let beyond = position + away / max(length(away), 1e-30) * frame.depth_shift;
        let clip = drawing.clip_from_relative * vec4f(beyond, 1.0);
        // A shift too small for the depth's precision keeps the nearest fragment all the same.
        cut = max(depth_key(clamp(clip.z / clip.w, 0.0, 1.0)), 0xffffffffu - front) + 1u;
    }
    fill[pixels + number] = cut;
}

@compute @workgroup_size(64)
fn dbk_buffer_kept(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let number = dbk_number(invocation, groups);
    if number < dbk_pixels() { fill[number] = links[number]; }
}

@compute @workgroup_size(64)
fn dbk_buffer_tiles(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let number = dbk_number(invocation, groups);
    let size = vec2u(u32(drawing.viewport.x), drawing.row_end - drawing.row_first);
    let columns = (size.x + HOST_TILE - 1u) / HOST_TILE;
    if number >= columns * ((size.y + HOST_TILE - 1u) / HOST_TILE) { return; }
    let first = vec2u(number % columns, number / columns) * HOST_TILE;
    let end = min(first + HOST_TILE, size);
    let pixels = dbk_pixels();
    var farthest = 0u;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            farthest = max(farthest, fill[pixels + y * size.x + x]);
        }
    }
    host_tiles[number].x = select(0xffffffffu, farthest + DBK_ROUNDING, farthest < 0xffffffffu - DBK_ROUNDING);
}
