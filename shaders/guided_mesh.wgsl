// Strands between three guides each: what `blended` in src/groom/interpolate.rs does, one strand an invocation.

@group(1) @binding(0) var<uniform> guided_of: Guided;
@group(1) @binding(1) var<storage, read> guided_points: array<f32>;
@group(1) @binding(2) var<storage, read> guided_placements: array<Placement>;
@group(1) @binding(6) var<storage, read_write> guided_strands: array<f32>;

fn guided_mesh_guide(guide: u32, point: u32) -> vec3f {
    let at = 3u * (guide * guided_of.points_each + point);
    return vec3f(guided_points[at], guided_points[at + 1u], guided_points[at + 2u]);
}

// The strand's point `point`, without the displacement of strays; `along` runs from 0 at the root to 1 at the tip.
fn guided_mesh_blend(placement: Placement, point: u32, along: f32) -> vec3f {
    let weights = placement.root * (1.0 - along) + placement.tip * along;
    return guided_mesh_guide(placement.guide_0, point) * weights.x
        + guided_mesh_guide(placement.guide_1, point) * weights.y
        + guided_mesh_guide(placement.guide_2, point) * (1.0 - weights.x - weights.y);
}

@compute @workgroup_size(64)
fn guided_mesh(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let strand = invocation.x + invocation.y * groups.x * 64u;
    if strand >= guided_of.count { return; }
    let placement = guided_placements[strand];
    let each = guided_of.points_each;
    let last = f32(max(each, 2u) - 1u);
    var length_of = 0.0;
    if any(placement.stray != vec3f(0.0)) {
        var before = guided_mesh_blend(placement, 0u, 0.0);
        for (var point = 1u; point < each; point++) {
            let position = guided_mesh_blend(placement, point, f32(point) / last);
            length_of += distance(before, position);
            before = position;
        }
    }
    for (var point = 0u; point < each; point++) {
        let along = f32(point) / last;
        let position = guided_mesh_blend(placement, point, along) + placement.stray * (length_of * along * along);
        let at = guided_of.strands_base + 3u * (strand * each + point);
        for (var axis = 0u; axis < 3u; axis++) { guided_strands[at + axis] = position[axis]; }
    }
}
