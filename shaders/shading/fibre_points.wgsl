// What shading at fragments asks of a strand point, pooled for all runs of a frame in two vectors a point: position, radius and
// tangent in relative space, and what the strand has of its own; and for each run its model's parameters, behind the points of
// all. `shading/fragments` reads it.

@group(1) @binding(4) var<storage, read_write> fibre_points: array<vec4u>;

// A unit vector on the octahedron: 5e-5 rad.
fn fibre_points_packed(v: vec3f) -> u32 {
    let flat = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    let folded = (vec2f(1.0) - abs(flat.yx)) * select(vec2f(-1.0), vec2f(1.0), flat >= vec2f(0.0));
    return pack2x16snorm(select(flat, folded, v.z < 0.0));
}

@compute @workgroup_size(64)
fn gather_fibre_points(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index < FIBRE_RUN_VECTORS {
        var value = vec4u(frame.light_count, bitcast<u32>(drawing.largest_radius), bitcast<u32>(drawing.opacity), 0u);
        if index < MATERIAL_VECTORS { value = bitcast<vec4u>(material.values[index]); }
        fibre_points[drawing.fibre_run + index] = value;
    }
    if index >= drawing.point_count || !points_seen(index) { return; }
    let strand = attributes[index].strand;
    let position = points_relative(index);
    let tangent = points_tangent(position - points_before(index, strand), points_after(index, strand) - position);
    let at = (drawing.point_base + index) * FIBRE_POINT_VECTORS;
    fibre_points[at] = vec4u(bitcast<vec3u>(position), fibre_points_packed(tangent));
    let colour = strand_colours[strand & POINT_STRAND];
    let coordinate = u32(clamp(attributes[index].coordinate, 0.0, 1.0) * 65535.0 + 0.5);
    let radius = points[index].radius * drawing.radius_scale / max(drawing.largest_radius, 1e-30);
    fibre_points[at + 1u] = vec4u(
        colour.x,
        (colour.y & 0xffffu) | (coordinate << 16u),
        strand,
        (pack2x16float(vec2f(radius, 0.0)) & 0xffffu) | (drawing.fibre_run_number << 16u),
    );
}
