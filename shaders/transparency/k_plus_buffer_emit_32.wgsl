// The chain of a k⁺-buffer in two passes of 32-bit atomics: the first keeps the K nearest upper halves, the second chains
// the lower halves of the fragments that have them, those of equal upper halves among themselves. The words are then the
// same as those of 64-bit atomics.

// Lower and upper half of each word, in turn.
@group(3) @binding(3) var<storage, read_write> fragments_0: array<atomic<u32>>;

// The first of a pixel's upper halves that is `half` or farther, or else the last.
fn k_plus_find(first: u32, half: u32) -> u32 {
    // Halves only grow, and none is ever greater than the one before it: what is found to be nearer may be passed over.
    var low = 0u;
    var high = K - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if atomicLoad(&fragments_0[2u * (first + middle) + 1u]) > half { low = middle + 1u; } else { high = middle; }
    }
    return low;
}

// Whether a place that was empty is taken.
fn k_plus_insert(first: u32, halves: vec2u) -> bool {
    var carry = halves.x;
    if atomicLoad(&fragments_0[2u * (first + K - 1u) + 1u]) >= carry { return false; }
    for (var i = k_plus_find(first, carry); i < K; i++) {
        let before = atomicMax(&fragments_0[2u * (first + i) + 1u], carry);
        carry = min(before, carry);
        if carry == 0u { return true; }
    }
    return false;
}

fn k_plus_store(first: u32, halves: vec2u) {
    if atomicLoad(&fragments_0[2u * (first + K - 1u) + 1u]) > halves.x { return; }
    var carry = halves.y;
    // The half is among the K, or nearer halves fill them all.
    for (var i = k_plus_find(first, halves.x); i < K; i++) {
        if atomicLoad(&fragments_0[2u * (first + i) + 1u]) != halves.x { return; }
        carry = min(atomicMax(&fragments_0[2u * (first + i)], carry), carry);
    }
}
