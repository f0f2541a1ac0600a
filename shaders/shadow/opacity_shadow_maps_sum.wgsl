// Opacity shadow maps: each texel's slabs become the sums up to their far planes, once, so that a look-up reads two words.

@group(2) @binding(0) var<storage, read_write> layers: array<u32>;

@compute @workgroup_size(64)
fn opacity_shadow_maps_sum(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let texel = invocation.x + invocation.y * groups.x * 64u;
    if texel >= u32(drawing.viewport.x) * u32(drawing.viewport.y) { return; }
    let count = drawing.layer_count;
    let first = drawing.layer_base + texel * count;
    var sum = 0u;
    for (var layer = 0u; layer < count; layer++) {
        let value = layers[first + layer];
        sum = select(sum + value, 0xffffffffu, sum > 0xffffffffu - value);
        layers[first + layer] = sum;
    }
}
