// DBK-buffer: nearest and farthest depth of the strands' points in each tile, from which its bins take their range. Points
// are enough: what lies before the nearest falls into the first bin, and what lies behind the farthest into the last.

@group(1) @binding(0) var<storage, read> projected: array<Projected>;
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;

@compute @workgroup_size(64)
fn dbk_buffer_depths(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    pixels_begin();
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= drawing.point_count { return; }
    let point = projected[index];
    if (point.flags & (PROJECTED_LAST | PROJECTED_BEHIND | PROJECTED_UNSEEN)) != 0u || point.half_width <= 0.0 { return; }
    let end = vec2f(drawing.viewport.x, f32(drawing.row_end));
    if any(point.position < vec2f(0.0, f32(drawing.row_first))) || any(point.position >= end) { return; }
    if point.depth < 0.0 || point.depth > 1.0 { return; }
    let key = depth_key(point.depth);
    let tile = dbk_tile(dbk_pixels(), dbk_columns(), vec2u(point.position) - vec2u(0u, drawing.row_first));
    atomicMax(&fill[tile], 0xffffffffu - key);
    atomicMax(&fill[tile + 1u], key);
}
