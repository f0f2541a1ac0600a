// Shading at strand points (Kim §5): each point's outgoing radiance towards the eye, once a view; fragments
// interpolate along their segments. The model's file supplies `scatter`, which takes the shadow in, and `scatter_uniform`.

@group(1) @binding(0) var<storage, read> points: array<Point>;
@group(1) @binding(1) var<storage, read> attributes: array<PointAttributes>;
// Linear RGB, 16-bit floats.
@group(1) @binding(2) var<storage, read> strand_colours: array<vec2u>;
@group(1) @binding(3) var<storage, read> projected: array<Projected>;
@group(1) @binding(4) var<storage, read_write> shaded: array<vec2u>;
// The tables of all hairs' models; models without tables do not read it.
@group(1) @binding(5) var<storage, read> shading_tables: array<u32>;

// Whether one of the point's two segments may be drawn.
fn points_seen(index: u32) -> bool {
    if (projected[index].flags & (PROJECTED_LAST | PROJECTED_UNSEEN)) == 0u { return true; }
    return (projected[max(index, 1u) - 1u].flags & (PROJECTED_LAST | PROJECTED_UNSEEN)) == 0u;
}

fn points_relative(index: u32) -> vec3f {
    return (drawing.relative_from_object * vec4f(points[index].position, 1.0)).xyz;
}

// Unit tangent of the circle through a point and its two neighbours, from the ways between them: it parts the turn between the
// two segments as their lengths do, so that unevenly spaced points are lit as even ones are. Some unit vector where the
// strand has no length here.
fn points_tangent(before: vec3f, after: vec3f) -> vec3f {
    let lengths = vec2f(length(before), length(after));
    let parts = lengths / max(lengths.yx, vec2f(1e-30));
    var sum = before / max(parts.x, 1e-30) + after / max(parts.y, 1e-30);
    // At an end, or beside a point that coincides, there is one segment.
    if min(lengths.x, lengths.y) <= 1e-30 { sum = before + after; }
    let size = length(sum);
    return select(vec3f(0.0, 1.0, 0.0), sum / max(size, 1e-30), size > 1e-30);
}

@compute @workgroup_size(64)
fn shade_points(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= drawing.point_count || !points_seen(index) { return; }
    let strand = attributes[index].strand;
    let position = points_relative(index);
    let colour = strand_colours[strand & POINT_STRAND];
    let starts = (strand & POINT_FIRST) != 0u;
    let ends = (strand & POINT_LAST) != 0u;
    let before = points_relative(select(index - 1u, index, starts));
    let after = points_relative(select(index + 1u, index, ends));
    let radius = points[index].radius * drawing.radius_scale;
    shadow_fibre = ShadowFibre(before, after, radius, drawing.opacity, starts, ends);
    var fibre: Fibre;
    fibre.tangent = points_tangent(position - before, after - position);
    fibre.colour = vec3f(unpack2x16float(colour.x), unpack2x16float(colour.y).x);
    fibre.coordinate = attributes[index].coordinate;
    fibre.strand = strand & POINT_STRAND;
    let to_eye = frame.eye.xyz - position * frame.eye.w;
    let wo = to_eye / max(length(to_eye), 1e-30);

    var radiance = vec3f(0.0);
    if any(frame.ambient > vec3f(0.0)) { radiance = frame.ambient * scatter_uniform(fibre, wo); }
    for (var light = 0u; light < frame.light_count; light++) {
        let reach = light_reach(light, position);
        let wi = reach.wi;
        // Along a strand that leans towards the light its own depth changes within the filter: the look-up moves
        // towards the light by twice the bias times the slope.
        let lean = abs(dot(fibre.tangent, wi));
        let slope = lean / max(sqrt(max(1.0 - lean * lean, 0.0)), 0.125);
        let visible = shadow(position + wi * (2.0 * slope * frame.lights[light].bias), light);
        radiance += occlusion(position, wi, light) * reach.irradiance * scatter(fibre, wi, wo, visible);
    }
    // The largest 16-bit float; also what becomes of an infinity.
    radiance = min(max(radiance, vec3f(0.0)), vec3f(65504.0));
    shaded[drawing.point_base + index] = vec2u(pack2x16float(radiance.xy), pack2x16float(vec2f(radiance.z, 0.0)));
}
