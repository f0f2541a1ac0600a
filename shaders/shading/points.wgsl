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

// Unit tangent of the circle through the point and its two neighbours: it parts the turn between the two segments as their
// lengths do, so that unevenly spaced points are lit as even ones are. Some unit vector where the strand has no length here.
fn points_tangent(index: u32, strand: u32) -> vec3f {
    let here = points_relative(index);
    let before = here - points_relative(select(index - 1u, index, (strand & POINT_FIRST) != 0u));
    let after = points_relative(select(index + 1u, index, (strand & POINT_LAST) != 0u)) - here;
    let lengths = vec2f(length(before), length(after));
    let parts = lengths / max(lengths.yx, vec2f(1e-30));
    var sum = before / max(parts.x, 1e-30) + after / max(parts.y, 1e-30);
    // At an end, or beside a point that coincides, there is one segment.
    if min(lengths.x, lengths.y) <= 1e-30 { sum = before + after; }
    let size = length(sum);
    return select(vec3f(0.0, 1.0, 0.0), sum / max(size, 1e-30), size > 1e-30);
}

// MurmurHash3's finaliser.
fn points_mix(word: u32) -> u32 {
    let a = (word ^ (word >> 16u)) * 0x85ebca6bu;
    let b = (a ^ (a >> 13u)) * 0xc2b2ae35u;
    return b ^ (b >> 16u);
}

// 16 random bits of a strand, by which techniques part strands.
fn points_hash(strand: u32) -> u32 {
    return points_mix(strand ^ points_mix(drawing.hair ^ points_mix(frame.seed + 0x9e3779b9u))) >> 16u;
}

@compute @workgroup_size(64)
fn shade_points(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= drawing.point_count || !points_seen(index) { return; }
    let strand = attributes[index].strand;
    let position = points_relative(index);
    let colour = strand_colours[strand & POINT_STRAND];
    var fibre: Fibre;
    fibre.tangent = points_tangent(index, strand);
    fibre.colour = vec3f(unpack2x16float(colour.x), unpack2x16float(colour.y).x);
    fibre.coordinate = attributes[index].coordinate;
    fibre.strand = strand & POINT_STRAND;
    let to_eye = frame.eye.xyz - position * frame.eye.w;
    let wo = to_eye / max(length(to_eye), 1e-30);

    var radiance = vec3f(0.0);
    if any(frame.ambient > vec3f(0.0)) { radiance = frame.ambient * scatter_uniform(fibre, wo); }
    for (var light = 0u; light < frame.light_count; light++) {
        let place = frame.lights[light].place;
        let to_light = place.xyz - position * place.w;
        let distance = max(length(to_light), 1e-20);
        let falloff = select(1.0, 1.0 / (distance * distance), place.w > 0.0);
        let wi = to_light / distance;
        // Along a strand that leans towards the light its own depth changes within the filter: the look-up moves
        // towards the light by twice the bias times the slope.
        let lean = abs(dot(fibre.tangent, wi));
        let slope = lean / max(sqrt(max(1.0 - lean * lean, 0.0)), 0.125);
        let visible = shadow(position + wi * (2.0 * slope * frame.lights[light].bias), light);
        radiance += frame.lights[light].power * falloff * scatter(fibre, wi, wo, visible);
    }
    // The largest 16-bit float; also what becomes of an infinity.
    radiance = min(max(radiance, vec3f(0.0)), vec3f(65504.0));
    let hash = points_hash(strand & POINT_STRAND);
    let words = vec2u(pack2x16float(radiance.xy), pack2x16float(vec2f(radiance.z, 0.0)) | (hash << 16u));
    shaded[drawing.point_base + index] = words;
}
