// The order in which a walk takes a run's segments: by the tile of the image that their middle lies in, so that what runs
// side by side touches the same memory; in each tile the strands' ends, whose coverage is dearer, apart from the others.
// What cannot be seen is left out. A counting sort: COUNT, SCAN by one workgroup, PLACE. Which of a tile's segments comes first
// is the scheduler's choice, and changes no image.
//
// The run's last word, which no segment needs, holds the number of segments.

@group(1) @binding(0) var<storage, read> projected: array<Projected>;
@group(1) @binding(1) var<storage, read_write> order: array<u32>;
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;

// Pixels a side of a tile at least, and tiles at most.
const ORDER_TILE: u32 = 32u;
const ORDER_TILES: u32 = 1024u;
const ORDER_KEYS: u32 = 2048u;
const ORDER_INVOCATIONS: u32 = 256u;
const ORDER_EACH: u32 = 8u;

var<workgroup> order_sums: array<u32, ORDER_INVOCATIONS>;

// The segment's key; ORDER_KEYS where there is none, or none to be seen.
fn order_key(index: u32) -> u32 {
    if index + 1u >= drawing.point_count { return ORDER_KEYS; }
    let here = projected[index];
    if (here.bisector_flags.y & (PROJECTED_LAST | PROJECTED_UNSEEN)) != 0u { return ORDER_KEYS; }
    let next = projected[index + 1u];
    let size = vec2u(max(drawing.viewport, vec2f(1.0)));
    var tile = ORDER_TILE;
    for (var i = 0u; i < 16u; i++) {
        let tiles = (size + tile - 1u) / tile;
        if tiles.x * tiles.y <= ORDER_TILES { break; }
        tile *= 2u;
    }
    let middle = clamp(0.5 * (here.position + next.position), vec2f(0.0), vec2f(size) - 1.0);
    let place = vec2u(middle) / tile;
    let ends = (here.bisector_flags.y & PROJECTED_FIRST) != 0u || (next.bisector_flags.y & PROJECTED_LAST) != 0u;
    return 2u * (place.y * ((size.x + tile - 1u) / tile) + place.x) + select(1u, 0u, ends);
}

@compute @workgroup_size(64)
fn order_count(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let key = order_key(invocation.x + invocation.y * groups.x * 64u);
    if key < ORDER_KEYS { atomicAdd(&counts[key], 1u); }
}

@compute @workgroup_size(ORDER_INVOCATIONS)
fn order_scan(@builtin(local_invocation_index) local: u32) {
    let first = local * ORDER_EACH;
    var sum = 0u;
    for (var i = 0u; i < ORDER_EACH; i++) { sum += atomicLoad(&counts[first + i]); }
    order_sums[local] = sum;
    workgroupBarrier();
    if local == 0u {
        var total = 0u;
        for (var i = 0u; i < ORDER_INVOCATIONS; i++) {
            let value = order_sums[i];
            order_sums[i] = total;
            total += value;
        }
        order[drawing.point_count - 1u] = total;
    }
    workgroupBarrier();
    var place = order_sums[local];
    for (var i = 0u; i < ORDER_EACH; i++) {
        let value = atomicLoad(&counts[first + i]);
        atomicStore(&counts[first + i], place);
        place += value;
    }
}

@compute @workgroup_size(64)
fn order_place(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = invocation.x + invocation.y * groups.x * 64u;
    let key = order_key(index);
    if key < ORDER_KEYS { order[atomicAdd(&counts[key], 1u)] = index; }
}
