// A-buffer: the resolve. Selects a pixel's fragments in order of (depth, segment), eight at a time in registers, and
// composites them front to back until the rest cannot be seen; then the overflow's tail.
//
// A pixel whose list is so long that ordering it would take more than A_BUFFER_STEPS steps has its farthest part
// merged like a tail: exact transmittance, weighted colour.

struct Candidate {
    key: u32,
    place: u32,
}

fn a_buffer_order(near: ptr<function, Candidate>, far: ptr<function, Candidate>) {
    if (*far).key < (*near).key {
        let moved = *near;
        *near = *far;
        *far = moved;
    }
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    shaded_begin(pixel);
    let number = pixel_number(pixel);
    let first = a_buffer_first(number);
    let count = a_buffer_count(number, first);
    var result = Resolved(vec4f(0.0), A_BUFFER_NONE);
    var transmittance = 1.0;
    var colour = vec3f(0.0);
    // Fragments with a lower key are done. Where more of one key than a round holds are left, `grouped` is set, and of
    // that key those whose points come before `point` are done.
    var key = 0u;
    var point = 0u;
    var grouped = false;
    var done = 0u;
    let rounds = A_BUFFER_STEPS / (count + 9u);
    for (var round = 0u; round < rounds && done < count && transmittance > A_BUFFER_UNSEEN; round++) {
        let none = Candidate(A_BUFFER_NONE, A_BUFFER_NONE);
        var k0 = none;
        var k1 = none;
        var k2 = none;
        var k3 = none;
        var k4 = none;
        var k5 = none;
        var k6 = none;
        var k7 = none;
        // Whether a fragment of the last one's key was left out.
        var tied = false;
        var node = first;
        for (var i = 0u; i < count && !grouped; i++) {
            let place = select(first + i, node - 1u, LISTS);
            if LISTS { node = links[place]; }
            let candidate = Candidate(a_buffer_word(place, 0u), place);
            if candidate.key < key || candidate.key > k7.key { continue; }
            if candidate.key == k7.key {
                tied = true;
                continue;
            }
            let evicted = k7.key;
            k7 = candidate;
            a_buffer_order(&k6, &k7);
            a_buffer_order(&k5, &k6);
            a_buffer_order(&k4, &k5);
            a_buffer_order(&k3, &k4);
            a_buffer_order(&k2, &k3);
            a_buffer_order(&k1, &k2);
            a_buffer_order(&k0, &k1);
            tied = evicted == k7.key && evicted != A_BUFFER_NONE;
        }
        // A key of which some were left out waits for the next round as a whole; or goes one by one, if it alone fills
        // this one.
        if tied && k0.key == k7.key {
            grouped = true;
            key = k0.key;
            point = 0u;
        }
        if grouped { k0 = a_buffer_next(first, count, key, point); }
        var chosen = array<Candidate, 8>(k0, k1, k2, k3, k4, k5, k6, k7);
        let end = select(select(A_BUFFER_NONE, k7.key, tied), A_BUFFER_NONE, grouped);
        let take = select(8u, 1u, grouped);
        var unordered = !grouped;
        for (var pass_number = 0u; pass_number < 8u && unordered; pass_number++) {
            unordered = false;
            for (var i = 0u; i < 7u; i++) {
                if chosen[i].key == chosen[i + 1u].key && chosen[i].place != A_BUFFER_NONE {
                    if a_buffer_word(chosen[i].place, 1u) > a_buffer_word(chosen[i + 1u].place, 1u) {
                        let moved = chosen[i];
                        chosen[i] = chosen[i + 1u];
                        chosen[i + 1u] = moved;
                        unordered = true;
                    }
                }
            }
        }
        for (var i = 0u; i < take && chosen[i].key < end && transmittance > A_BUFFER_UNSEEN; i++) {
            let value = a_buffer_value(chosen[i].place);
            let chosen_point = a_buffer_word(chosen[i].place, 1u);
            colour += transmittance * value.x * shaded_colour(chosen_point, value.y);
            transmittance *= 1.0 - value.x;
            if result.key == A_BUFFER_NONE && value.x > 0.0 { result.key = chosen[i].key; }
            key = select(chosen[i].key + 1u, key, grouped);
            point = chosen_point + 1u;
            done += 1u;
        }
        // None is left but equal fragments of one segment, which cannot be parted; there are none, but a fault must
        // not loop.
        if !grouped && k0.place == A_BUFFER_NONE { break; }
        // The group has ended.
        if grouped && k0.place == A_BUFFER_NONE {
            grouped = false;
            key += 1u;
        }
    }
    if done < count && transmittance > A_BUFFER_UNSEEN {
        var depth = 0.0;
        var weight = 0.0;
        var sum = vec3f(0.0);
        var node = first;
        for (var i = 0u; i < count; i++) {
            let place = select(first + i, node - 1u, LISTS);
            if LISTS { node = links[place]; }
            let candidate_key = a_buffer_word(place, 0u);
            let candidate_point = a_buffer_word(place, 1u);
            if candidate_key < key || (grouped && candidate_key == key && candidate_point < point) { continue; }
            let value = a_buffer_value(place);
            depth += optical_depth(value.x);
            weight += value.x;
            sum += value.x * shaded_colour(candidate_point, value.y);
        }
        let through = exp(-depth);
        colour += transmittance * (1.0 - through) * sum / max(weight, 1e-20);
        transmittance *= through;
    }
    if a_buffer_overflowed() && transmittance > A_BUFFER_UNSEEN {
        let tail = tail_of(number);
        colour += transmittance * tail.xyz;
        transmittance *= tail.w;
        if result.key == A_BUFFER_NONE && tail.w < 1.0 { result.key = a_buffer_tail_key(number); }
    }
    if transmittance > A_BUFFER_UNSEEN {
        let beyond = resolve_beyond(number);
        colour += transmittance * beyond.xyz;
        transmittance *= beyond.w;
    }
    result.colour = vec4f(colour, 1.0 - transmittance);
    return result;
}

// Of a pixel's fragments with a key, the one with the lowest point from `point` on.
fn a_buffer_next(first: u32, count: u32, key: u32, point: u32) -> Candidate {
    var lowest = A_BUFFER_NONE;
    var found = Candidate(A_BUFFER_NONE, A_BUFFER_NONE);
    var node = first;
    for (var i = 0u; i < count; i++) {
        let place = select(first + i, node - 1u, LISTS);
        if LISTS { node = links[place]; }
        if a_buffer_word(place, 0u) != key { continue; }
        let candidate = a_buffer_word(place, 1u);
        if candidate >= point && candidate < lowest {
            lowest = candidate;
            found = Candidate(key, place);
        }
    }
    return found;
}

fn nearest(pixel: vec2u) -> Nearest {
    return a_buffer_nearest(pixel);
}
