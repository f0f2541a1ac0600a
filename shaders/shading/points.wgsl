// Shading at strand points (Kim §5): each point's outgoing radiance towards the eye, once a view; fragments
// interpolate along their segments.

@group(1) @binding(4) var<storage, read_write> shaded: array<vec2u>;
// The tables of all hairs' models; models without tables do not read it.
@group(1) @binding(5) var<storage, read> shading_tables: array<u32>;

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
    let index = spread_number(invocation.x + invocation.y * groups.x * 64u, groups.x * groups.y, drawing.point_count);
    if index >= drawing.point_count || !points_seen(index) { return; }
    let strand = attributes[index].strand;
    let colour = strand_colours[strand & POINT_STRAND];
    let position = points_relative(index);
    let before = points_before(index, strand);
    let after = points_after(index, strand);
    let radius = points[index].radius * drawing.radius_scale;
    let starts = (strand & POINT_FIRST) != 0u;
    let ends = (strand & POINT_LAST) != 0u;
    shadow_fibre = ShadowFibre(before, after, radius, drawing.opacity, starts, ends);
    var fibre: Fibre;
    fibre.tangent = points_tangent(position - before, after - position);
    fibre.colour = vec3f(unpack2x16float(colour.x), unpack2x16float(colour.y).x);
    fibre.coordinate = attributes[index].coordinate;
    fibre.strand = strand & POINT_STRAND;
    fibre.across = vec2f(-1.0, 1.0);
    let radiance = shading_radiance(fibre, position, frame.light_count);
    let hash = points_hash(strand & POINT_STRAND);
    let words = vec2u(pack2x16float(radiance.xy), pack2x16float(vec2f(radiance.z, 0.0)) | (hash << 16u));
    shaded[drawing.point_base + index] = words;
}
