// DBK-buffer: passes over tiles and pixels. A tile's bins, from its histogram. By a depth shift, a pixel's cut-off: from its nearest
// depth and a shift along the ray. And what the cut-offs mean to segments: the farthest of each of the host's tiles.

@group(1) @binding(0) var<storage, read_write> host_tiles: array<vec2u>;
@group(3) @binding(1) var<storage, read_write> fill: array<u32>;
@group(3) @binding(2) var<storage, read_write> links: array<u32>;
@group(3) @binding(5) var<storage, read_write> overflow: array<u32>;

// A mix of two depths may fall short of both by its rounding.
const DBK_ROUNDING: u32 = 16u;

// A tile's histogram → its bins; the histogram is cleared.
@compute @workgroup_size(64)
fn dbk_buffer_ranges(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let tile = dbk_number(invocation, groups);
    let rows = (drawing.row_end - drawing.row_first + DBK_TILE - 1u) / DBK_TILE;
    if tile >= dbk_columns() * rows { return; }
    let words = dbk_tile_words(dbk_pixels(), tile);
    let front = 0xffffffffu - fill[words];
    let back = fill[words + 1u];
    let enough = frame.cut_depth * f32(DBK_TILE * DBK_TILE) * DBK_ESTIMATE_SCALE;
    let step = f32(back - min(front, back)) / f32(DBK_STEPS);
    var sum = 0.0;
    var first = DBK_NO_CUT;
    var end = back;
    for (var i = 0u; i < DBK_STEPS; i++) {
        let value = f32(overflow[tile * DBK_STEPS + i]);
        overflow[tile * DBK_STEPS + i] = 0u;
        let after = sum + value;
        if sum < DBK_FIRST * enough && after >= DBK_FIRST * enough {
            first = front + u32((f32(i) + (DBK_FIRST * enough - sum) / value) * step);
        }
        if sum < DBK_LAST * enough && after >= DBK_LAST * enough {
            end = front + u32((f32(i) + (DBK_LAST * enough - sum) / value) * step);
        }
        sum = after;
    }
    let steps = dbk_steps();
    let place = clamp(dbk_step(first, steps), 1u, DBK_FIRST_MAX);
    let width = min(((end - min(first, end)) / (DBK_BINS - 2u)) >> steps.y, DBK_WIDTH_MAX);
    fill[words] = select(place << DBK_WIDTH_BITS | width, DBK_NO_BINS, first == DBK_NO_CUT);
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
