// What the outputs beside the colour tell of each point: its motion on the screen since the frame before, and whose it is.

@group(1) @binding(0) var<storage, read> points: array<Point>;
@group(1) @binding(1) var<storage, read> previous_points: array<Point>;
@group(1) @binding(2) var<storage, read> attributes: array<PointAttributes>;
@group(1) @binding(3) var<storage, read_write> point_outputs: array<PointOutput>;

fn track_pixel(clip: vec4f) -> vec2f {
    return vec2f(0.5, -0.5) * clip.xy / clip.w * drawing.viewport;
}

@compute @workgroup_size(64)
fn track(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= drawing.point_count { return; }
    let now = drawing.clip_from_object * vec4f(points[index].position, 1.0);
    let before = drawing.previous_clip_from_object * vec4f(previous_points[index].position, 1.0);
    var motion = vec2f(0.0);
    // Behind either eye there is no place to tell of.
    if now.w > 0.0 && before.w > 0.0 { motion = track_pixel(now) - track_pixel(before) - drawing.jitter_motion; }
    let strand = attributes[index].strand & POINT_STRAND;
    point_outputs[drawing.point_base + index] = PointOutput(motion, drawing.hair, strand);
}
