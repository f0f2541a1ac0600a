// The host's opaque scene in tiles: the farthest and the nearest depth key of each, so that a segment behind all of it is
// dropped as a whole before any of its fragments is found, and one before all of it is not compared again.

@group(1) @binding(0) var<storage, read_write> host_tiles: array<vec2u>;

@compute @workgroup_size(64)
fn host_tiles_range(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    pixels_begin();
    let number = invocation.x + invocation.y * groups.x * 64u;
    let columns = (frame.width + HOST_TILE - 1u) / HOST_TILE;
    let rows = (frame.height + HOST_TILE - 1u) / HOST_TILE;
    if number >= columns * rows { return; }
    let first = vec2u(number % columns, number / columns) * HOST_TILE;
    let end = min(first + HOST_TILE, vec2u(frame.width, frame.height));
    var farthest = 0u;
    var nearest = 0xffffffffu;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            let key = depth_key(textureLoad(host_depth, vec2u(x, y), 0));
            farthest = max(farthest, key);
            nearest = min(nearest, key);
        }
    }
    host_tiles[number] = vec2u(farthest, nearest);
}
