// Deep opacity map: each texel's layers become sums from the front, once, so that a look-up reads two words.

@group(2) @binding(0) var<storage, read_write> layers: array<u32>;

@compute @workgroup_size(64)
fn deep_opacity_map_prefix(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let texel = invocation.x + invocation.y * groups.x * 64u;
    let width = u32(drawing.viewport.x);
    if texel >= width * u32(drawing.viewport.y) { return; }
    // Texels without hair, most of a map, are left as they are.
    if layers[drawing.front_base + texel] == 0u { return; }
    let first = drawing.layer_base + texel * drawing.layer_count;
    var sum = 0u;
    for (var layer = 0u; layer < drawing.layer_count; layer++) {
        let value = layers[first + layer];
        sum = select(sum + value, 0xffffffffu, sum > 0xffffffffu - value);
        layers[first + layer] = sum;
    }
}
