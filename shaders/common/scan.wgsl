// Exclusive prefix sum of a pass's fragment counts: pixel counts in `fill` → first places in `links`, whose last word
// but the block sums is the total. Blocks of 2,048 pixels, then the blocks' sums, then both together.
//
// It runs a second time after the overflow's search has lowered the counts, and returns at once where it has not.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
@group(3) @binding(1) var<storage, read_write> fill: array<u32>;
@group(3) @binding(2) var<storage, read_write> links: array<u32>;

const SCAN_INVOCATIONS: u32 = 256u;
const SCAN_EACH: u32 = 8u;
const SCAN_BLOCK: u32 = 2048u;

var<workgroup> scan_sums: array<u32, SCAN_INVOCATIONS>;
var<workgroup> scan_covered: atomic<u32>;
var<workgroup> scan_crowded: atomic<u32>;

fn scan_count() -> u32 {
    return (drawing.row_end - drawing.row_first) * u32(drawing.viewport.x);
}

fn scan_runs() -> bool {
    return !SCAN_AGAIN || atomicLoad(&counters.overflow) != 0u;
}

@compute @workgroup_size(SCAN_INVOCATIONS)
fn scan_blocks(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let count = scan_count();
    let runs = scan_runs();
    let first = group.x * SCAN_BLOCK + local * SCAN_EACH;
    var sum = 0u;
    var covered = 0u;
    if runs {
        for (var i = 0u; i < SCAN_EACH && first + i < count; i++) {
            let value = fill[first + i];
            sum += value;
            covered += select(0u, 1u, value > 0u);
            if value > PIXEL_MOST && !SCAN_AGAIN { atomicStore(&scan_crowded, 1u); }
        }
    }
    scan_sums[local] = sum;
    if covered > 0u && !SCAN_AGAIN { atomicAdd(&scan_covered, covered); }
    workgroupBarrier();
    if local == 0u && runs {
        var total = 0u;
        for (var i = 0u; i < SCAN_INVOCATIONS; i++) {
            let value = scan_sums[i];
            scan_sums[i] = total;
            total += value;
        }
        links[count + 1u + group.x] = total;
        if !SCAN_AGAIN {
            atomicAdd(&counters.covered, atomicLoad(&scan_covered));
            if atomicLoad(&scan_crowded) != 0u { atomicStore(&counters.crowded, 1u); }
        }
    }
    workgroupBarrier();
    if runs {
        var place = scan_sums[local];
        for (var i = 0u; i < SCAN_EACH && first + i < count; i++) {
            links[first + i] = place;
            place += fill[first + i];
        }
    }
}

@compute @workgroup_size(SCAN_INVOCATIONS)
fn scan_totals(@builtin(local_invocation_index) local: u32) {
    let count = scan_count();
    let runs = scan_runs();
    let blocks = (count + SCAN_BLOCK - 1u) / SCAN_BLOCK;
    let each = (blocks + SCAN_INVOCATIONS - 1u) / SCAN_INVOCATIONS;
    let first = local * each;
    var sum = 0u;
    if runs {
        for (var i = 0u; i < each && first + i < blocks; i++) { sum += links[count + 1u + first + i]; }
    }
    scan_sums[local] = sum;
    workgroupBarrier();
    if local == 0u && runs {
        var total = 0u;
        for (var i = 0u; i < SCAN_INVOCATIONS; i++) {
            let value = scan_sums[i];
            scan_sums[i] = total;
            total += value;
        }
        links[count] = total;
        if !SCAN_AGAIN {
            atomicStore(&counters.produced, total);
            atomicAdd(&counters.stored, total);
            if total > frame.capacity || atomicLoad(&counters.crowded) != 0u {
                atomicStore(&counters.overflow, 1u);
                let each = (frame.run_points + 64u * SPREAD_PARTS - 1u) / (64u * SPREAD_PARTS);
                let columns = clamp(each * SPREAD_PARTS, SPREAD_PARTS, 32768u);
                counters.walk_arguments = vec4u(columns, frame.run_rows, drawing.splits, 0u);
                counters.ribbon_arguments = vec4u(4u, frame.run_points, 0u, 0u);
            }
        } else {
            let produced = atomicLoad(&counters.produced);
            atomicSub(&counters.stored, produced - total);
            atomicAdd(&counters.merged, produced - total);
        }
    }
    workgroupBarrier();
    if runs {
        var place = scan_sums[local];
        for (var i = 0u; i < each && first + i < blocks; i++) {
            let value = links[count + 1u + first + i];
            links[count + 1u + first + i] = place;
            place += value;
        }
    }
}

@compute @workgroup_size(SCAN_INVOCATIONS)
fn scan_add(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    if !scan_runs() { return; }
    let count = scan_count();
    let base = links[count + 1u + group.x];
    let first = group.x * SCAN_BLOCK + local * SCAN_EACH;
    for (var i = 0u; i < SCAN_EACH && first + i < count; i++) { links[first + i] += base; }
}
