// Single-pass k-buffer (Yu et al. 2012, §5.2), as the rasterisers fill it: a fragment looks along its pixel's list for the
// two nodes that it belongs between, takes a node of the pool, and puts it there by compare-and-exchange, which is the
// verification that the successor is still the one that was found; where it is not the search goes on from there. What has
// K nodes before it is not stored.
//
// What differs from Yu, and why:
// - WGSL's atomics order nothing but themselves: whoever finds a node need not yet see what was written into it. So each
//   word of a node that others read is written once, over a zero, and cannot be mistaken for what it was before: a fragment's
//   words are stored inverted, and none is ever all ones; a successor is never 0. Zero means not seen yet, and is read again. Older
//   successors do no harm, since nodes are never taken out: they lead past nodes, and the exchange then fails.
// - Nobody is promised progress, so that nobody waits without end: after RETRIES failures a fragment goes to its pixel's
//   tail, as does one that finds the pool used up.
// - The order is by (depth, point), as the words' is, so that equal depths do not leave it to the scheduler.
// - What was stored and then pushed behind K others is merged with the rest in the resolve, by the same integer sums. So the
//   picture is the same, bit for bit, whoever came first, as long as nothing has failed.

@group(3) @binding(0) var<storage, read_write> counters: Counters;
// First node of a pixel's list, 0 = none, else node + 1.
@group(3) @binding(1) var<storage, read_write> fill: array<atomic<u32>>;
// Next node + 1; 0 = not seen yet.
@group(3) @binding(2) var<storage, read_write> links: array<atomic<u32>>;
// The upper and the lower halves of the nodes' words, inverted.
@group(3) @binding(3) var<storage, read_write> fragments_0: array<atomic<u32>>;
@group(3) @binding(4) var<storage, read_write> fragments_1: array<atomic<u32>>;
@group(3) @binding(5) var<storage, read_write> overflow: array<atomic<u32>>;

const REST_MERGED: u32 = 0u;
const REST_ALPHA: u32 = 1u;
const REST_DROPPED: u32 = 2u;
const SINGLE_PASS_END: u32 = 0xffffffffu;

// STAGE: two bits of REST, seven of K, then RETRIES.
const REST: u32 = STAGE & 3u;
const K: u32 = (STAGE >> 2u) & 127u;
const RETRIES: u32 = STAGE >> 9u;

var<private> single_pass_produced: u32;
var<private> single_pass_culled: u32;
var<private> single_pass_merged: u32;
var<private> single_pass_capacity: u32;
var<private> single_pass_tail_scale: f32;

fn emit_begin() -> bool {
    emit_common_begin();
    single_pass_produced = 0u;
    single_pass_culled = 0u;
    single_pass_merged = 0u;
    single_pass_capacity = frame.capacity;
    word_begin();
    single_pass_tail_scale = frame.tail_scale;
    return true;
}

fn emit_end() {
    if single_pass_produced > 0u { atomicAdd(&counters.produced, single_pass_produced); }
    if single_pass_culled > 0u { atomicAdd(&counters.culled, single_pass_culled); }
    if single_pass_merged > 0u { atomicAdd(&counters.merged, single_pass_merged); }
}

// The link that leads to a node: of the pixel where `node` is 0, else of node - 1.
fn single_pass_next(number: u32, node: u32) -> u32 {
    if node == 0u {
        let head = atomicLoad(&fill[number]);
        return select(head, SINGLE_PASS_END, head == 0u);
    }
    return atomicLoad(&links[node - 1u]);
}

// Puts a node into that link where it still leads to `next`; what it led to.
fn single_pass_exchange(number: u32, node: u32, next: u32, new_node: u32) -> u32 {
    if node == 0u {
        let head = select(next, 0u, next == SINGLE_PASS_END);
        let found = atomicCompareExchangeWeak(&fill[number], head, new_node);
        if found.exchanged { return 0u; }
        return select(found.old_value, SINGLE_PASS_END, found.old_value == 0u);
    }
    let found = atomicCompareExchangeWeak(&links[node - 1u], next, new_node);
    return select(found.old_value, 0u, found.exchanged);
}

// Adds to one sum of a pixel's tail; its carries are counted beside it.
fn single_pass_tail_add(pixel: u32, sum: u32, steps: u32) {
    let before = atomicAdd(&overflow[pixel * OVERFLOW_WORDS + sum], steps);
    if before + steps < before {
        atomicAdd(&overflow[pixel * OVERFLOW_WORDS + TAIL_CARRIES], 1u << (sum * TAIL_CARRY_BITS));
    }
}

fn single_pass_merge(pixel: u32, key: u32, fragment: StoredFragment, with_colour: bool) {
    let steps = single_pass_steps(fragment, single_pass_tail_scale);
    single_pass_tail_add(pixel, TAIL_DEPTH, single_pass_depth_steps(fragment));
    if with_colour {
        for (var i = 0u; i < 4u; i++) { single_pass_tail_add(pixel, TAIL_WEIGHT + i, steps[i]); }
        // In case nothing else of the pixel is stored.
        atomicMax(&overflow[pixel * OVERFLOW_WORDS + TAIL_FIRST_KEY], ~key);
    }
    single_pass_merged += 1u;
}

fn emit(pixel: vec2u, fragment: Fragment, compare: bool) {
    if !fragment_in_range(fragment) || fragment.opacity == 0.0 { return; }
    let key = depth_key(fragment.depth);
    if fragment_hidden(pixel, key, compare) {
        single_pass_culled += 1u;
        return;
    }
    let number = pixel_number(pixel);
    let word = word_pack(StoredFragment(key, fragment.point, fragment.opacity, fragment.along));
    var failures = 0u;
    var passed = 0u;
    var last = 0u;
    var own = 0u;
    var next = single_pass_next(number, 0u);
    // Each step passes a node, fails, or is the last.
    for (var step = 0u; step <= K + RETRIES; step++) {
        if passed == K || failures > RETRIES { break; }
        var seen = next != 0u;
        var before = false;
        if seen && next != SINGLE_PASS_END {
            let other = ~atomicLoad(&fragments_0[next - 1u]);
            seen = other != 0xffffffffu;
            before = other < word.x;
            if other == word.x {
                let other_lower = ~atomicLoad(&fragments_1[next - 1u]);
                seen = other_lower != 0xffffffffu;
                before = other_lower < word.y;
            }
        }
        if !seen {
            failures += 1u;
            next = single_pass_next(number, last);
            continue;
        }
        if before {
            passed += 1u;
            last = next;
            next = single_pass_next(number, last);
            continue;
        }
        if own == 0u {
            let node = atomicAdd(&counters.stored, 1u);
            if node >= single_pass_capacity {
                failures = RETRIES + 1u;
                break;
            }
            own = node + 1u;
            atomicStore(&fragments_0[node], ~word.x);
            atomicStore(&fragments_1[node], ~word.y);
        }
        atomicStore(&links[own - 1u], next);
        next = single_pass_exchange(number, last, next, own);
        if next == 0u {
            single_pass_produced += 1u;
            return;
        }
        failures += 1u;
    }
    // Behind K others: the rest. Else it has failed.
    if passed == K && REST == REST_DROPPED {
        single_pass_culled += 1u;
        return;
    }
    single_pass_produced += 1u;
    single_pass_merge(number, key, word_unpack(word), passed < K || REST == REST_MERGED);
}
