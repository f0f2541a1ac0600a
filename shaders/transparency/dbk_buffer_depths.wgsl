// DBK-buffer: the depths in each tile, from which its bins take their places: DEPTHS finds the nearest and the farthest of
// the strands' points, ESTIMATE sums between them the optical depth of one place on each segment, as if all of the segment
// lay there. Neither bounds anything: a poor guess only costs memory.

@group(1) @binding(0) var<storage, read> projected: array<Projected>;
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
@group(3) @binding(5) var<storage, read_write> overflow: array<atomic<u32>>;

// The tile of a place within the band; columns × rows, one too many, where it lies outside.
fn dbk_tile_at(position: vec2f, columns: u32, rows: u32) -> u32 {
    let first = f32(drawing.row_first);
    let inside = all(position >= vec2f(0.0, first)) && all(position < vec2f(drawing.viewport.x, f32(drawing.row_end)));
    return select(columns * rows, dbk_tile(columns, vec2u(position) - vec2u(0u, drawing.row_first)), inside);
}

fn dbk_rows() -> u32 {
    return (drawing.row_end - drawing.row_first + DBK_TILE - 1u) / DBK_TILE;
}

@compute @workgroup_size(64)
fn dbk_buffer_depths(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    pixels_begin();
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= drawing.point_count { return; }
    let point = projected[index];
    if (point.bisector_flags.y & (PROJECTED_BEHIND | PROJECTED_UNSEEN)) != 0u || !(point.depth_width.x >= 0.0 && point.depth_width.x <= 1.0) { return; }
    let columns = dbk_columns();
    let rows = dbk_rows();
    let tile = dbk_tile_at(point.position, columns, rows);
    if tile == columns * rows { return; }
    let key = depth_key(point.depth_width.x);
    let words = dbk_tile_words(dbk_pixels(), tile);
    atomicMax(&fill[words], 0xffffffffu - key);
    atomicMax(&fill[words + 1u], key);
}

@compute @workgroup_size(64)
fn dbk_buffer_estimate(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    pixels_begin();
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index + 1u >= drawing.point_count { return; }
    let here = projected[index];
    let next = projected[index + 1u];
    if (here.bisector_flags.y & (PROJECTED_LAST | PROJECTED_BEHIND | PROJECTED_UNSEEN)) != 0u { return; }
    if (next.bisector_flags.y & PROJECTED_BEHIND) != 0u { return; }
    // Some place that differs from strand to strand.
    let part = f32((index * 0x9e3779b9u) >> 8u) / 16777216.0;
    let columns = dbk_columns();
    let rows = dbk_rows();
    let tile = dbk_tile_at(mix(here.position, next.position, part), columns, rows);
    let depth = mix(here.depth_width.x, next.depth_width.x, part);
    if tile == columns * rows || !(depth >= 0.0 && depth <= 1.0) { return; }
    let words = dbk_tile_words(dbk_pixels(), tile);
    let front = 0xffffffffu - atomicLoad(&fill[words]);
    let back = atomicLoad(&fill[words + 1u]);
    if back <= front { return; }
    let place = f32(depth_key(depth) - min(front, depth_key(depth))) / f32(back - front);
    let step = min(u32(place * f32(DBK_STEPS)), DBK_STEPS - 1u);
    // A fibre of width w touches w + 4/π pixels a pixel of its length, each by as much on average.
    let width = 2.0 * max(mix(here.depth_width.y, next.depth_width.y, part), 0.0);
    let touched = width + 1.28;
    let each = min(optical_depth(drawing.opacity * width / touched), frame.cut_depth);
    let sum = distance(here.position, next.position) * touched * each;
    let steps = u32(min(sum * DBK_ESTIMATE_SCALE, 1e6) + 0.5);
    if steps > 0u { atomicAdd(&overflow[tile * DBK_STEPS + step], steps); }
}
