// The host's opaque scene in tiles: the farthest depth of each, so that a segment behind it is dropped as a whole
// before any of its fragments is found.

@group(1) @binding(0) var<storage, read_write> host_tiles: array<u32>;

@compute @workgroup_size(64)
fn host_tiles_farthest(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let number = invocation.x + invocation.y * groups.x * 64u;
    let columns = (frame.width + HOST_TILE - 1u) / HOST_TILE;
    let rows = (frame.height + HOST_TILE - 1u) / HOST_TILE;
    if number >= columns * rows { return; }
    let first = vec2u(number % columns, number / columns) * HOST_TILE;
    let end = min(first + HOST_TILE, vec2u(frame.width, frame.height));
    var farthest = 0u;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            farthest = max(farthest, depth_key(textureLoad(host_depth, vec2u(x, y), 0)));
        }
    }
    host_tiles[number] = farthest;
}
