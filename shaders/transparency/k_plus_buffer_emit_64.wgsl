// The chain of a k⁺-buffer in one pass of 64-bit atomics.

@group(3) @binding(3) var<storage, read_write> fragments_0: array<atomic<u64>>;

// Whether a place that was empty is taken.
fn k_plus_insert(first: u32, halves: vec2u) -> bool {
    var carry = (u64(halves.x) << 32u) | u64(halves.y);
    if atomicLoad(&fragments_0[first + K - 1u]) >= carry { return false; }
    // Words only grow, and none is ever greater than the one before it: what is found to be nearer may be passed over.
    var low = 0u;
    var high = K - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if atomicLoad(&fragments_0[first + middle]) >= carry { low = middle + 1u; } else { high = middle; }
    }
    for (var i = low; i < K; i++) {
        let before = atomicMax(&fragments_0[first + i], carry);
        carry = min(before, carry);
        if carry == 0lu { return true; }
    }
    return false;
}

// There is no second pass.
fn k_plus_store(first: u32, halves: vec2u) {}
