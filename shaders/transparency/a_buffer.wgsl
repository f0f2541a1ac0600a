// A-buffer: the resolve. Composites a pixel's fragments front to back until the rest cannot be seen, and then the overflow's
// tail. `a_buffer_sorted` orders most of counted arrays; what it leaves, and lists, are selected here in order of
// (depth, segment), eight at a time in registers, by the upper halves of their words.
//
// Each round reads all of the pixel's fragments, eight at a time, puts these in order by Batcher's network, and takes of them and of the
// eight that are kept the lower ones, in order again by half a bitonic network: 39 steps without a branch for eight of them,
// where insertion one by one takes 56, masked, on drivers whose lanes go together.
//
// A pixel whose list is so long that ordering it would take more than A_BUFFER_STEPS steps has its farthest part
// merged like a tail: exact transmittance, weighted colour.

// A fragment: the upper half of its word, and its place.
struct Candidate {
    upper: u32,
    place: u32,
}

fn a_buffer_order(near: ptr<function, Candidate>, far: ptr<function, Candidate>) {
    if (*far).upper < (*near).upper {
        let moved = *near;
        *near = *far;
        *far = moved;
    }
}

// A fragment that is not done yet, or none.
fn a_buffer_candidate(upper: u32, place: u32, least: u32) -> Candidate {
    if upper < least { return Candidate(A_BUFFER_NONE, A_BUFFER_NONE); }
    return Candidate(upper, place);
}

fn a_buffer_within(upper: u32, place: u32, least: u32, first: u32, end: u32) -> Candidate {
    return a_buffer_candidate(upper, place, select(A_BUFFER_NONE, least, place >= first && place < end));
}

// The fragment of a list's node, of which there may be none, and then the next node.
fn a_buffer_listed(node: ptr<function, u32>, least: u32) -> Candidate {
    if *node == 0u { return Candidate(A_BUFFER_NONE, A_BUFFER_NONE); }
    let place = *node - 1u;
    *node = links[place];
    return a_buffer_candidate(a_buffer_upper(place), place, least);
}

// Keeps the lower of two; the upper half of the other's word.
fn a_buffer_lower(kept: ptr<function, Candidate>, other: Candidate) -> u32 {
    let left = max((*kept).upper, other.upper);
    if other.upper < (*kept).upper { *kept = other; }
    return left;
}

// Whether two candidates in order are alike, so that the lower halves decide.
fn a_buffer_equal(near: Candidate, far: Candidate) -> bool {
    return near.upper == far.upper && far.place != A_BUFFER_NONE;
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    word_begin();
    shaded_begin(pixel);
    let number = pixel_number(pixel);
    let first = a_buffer_first(number);
    let count = a_buffer_count(number, first);
    var begun = Composition(vec3f(0.0), 1.0, 0u, 0u, A_BUFFER_NONE, vec3f(0.0));
    if !LISTS { begun = a_buffer_sorted(first, count); }
    let unseen = frame.unseen;
    var result = Resolved(vec4f(0.0), begun.nearest);
    var transmittance = begun.transmittance;
    var colour = begun.colour;
    // Fragments with a lower upper half are done. Where more of one upper half than a round holds are left, `grouped` is set, and
    // of these those with a lower lower half are done.
    var upper = begun.upper;
    var lower = 0u;
    var grouped = false;
    var done = begun.done;
    // Steps that are left, but for those that count a list and merge a rest; and those of a round and of a fragment of a group.
    var steps_left = A_BUFFER_STEPS - min(select(count, 2u * count, LISTS), A_BUFFER_STEPS);
    let round_steps = count / 8u + 16u;
    let group_steps = count + 4u;
    while steps_left > round_steps && (!grouped || steps_left > group_steps) && done < count && transmittance > unseen {
        steps_left -= select(round_steps, group_steps, grouped);
        let none = Candidate(A_BUFFER_NONE, A_BUFFER_NONE);
        var k0 = none;
        var k1 = none;
        var k2 = none;
        var k3 = none;
        var k4 = none;
        var k5 = none;
        var k6 = none;
        var k7 = none;
        // The lowest of those that were left out.
        var left = A_BUFFER_NONE;
        var node = first;
        // Eight at a time: put in order by a network (19 steps, the fewest), and merged with the eight kept ones. Counted arrays are
        // read by fours, which may begin before the pixel's own.
        let begin = select(first & ~3u, 0u, LISTS);
        let end_place = select(first + count, count, LISTS);
        for (var base = begin; base < end_place && !grouped; base += 8u) {
            var c0 = none;
            var c1 = none;
            var c2 = none;
            var c3 = none;
            var c4 = none;
            var c5 = none;
            var c6 = none;
            var c7 = none;
            if LISTS {
                c0 = a_buffer_listed(&node, upper);
                c1 = a_buffer_listed(&node, upper);
                c2 = a_buffer_listed(&node, upper);
                c3 = a_buffer_listed(&node, upper);
                c4 = a_buffer_listed(&node, upper);
                c5 = a_buffer_listed(&node, upper);
                c6 = a_buffer_listed(&node, upper);
                c7 = a_buffer_listed(&node, upper);
            } else {
                let low = fragments_0[base / 4u];
                let high = fragments_0[min(base / 4u + 1u, (end_place - 1u) / 4u)];
                c0 = a_buffer_within(low.x, base, upper, first, end_place);
                c1 = a_buffer_within(low.y, base + 1u, upper, first, end_place);
                c2 = a_buffer_within(low.z, base + 2u, upper, first, end_place);
                c3 = a_buffer_within(low.w, base + 3u, upper, first, end_place);
                c4 = a_buffer_within(high.x, base + 4u, upper, first, end_place);
                c5 = a_buffer_within(high.y, base + 5u, upper, first, end_place);
                c6 = a_buffer_within(high.z, base + 6u, upper, first, end_place);
                c7 = a_buffer_within(high.w, base + 7u, upper, first, end_place);
            }
            a_buffer_order(&c0, &c1);
            a_buffer_order(&c2, &c3);
            a_buffer_order(&c4, &c5);
            a_buffer_order(&c6, &c7);
            a_buffer_order(&c0, &c2);
            a_buffer_order(&c1, &c3);
            a_buffer_order(&c4, &c6);
            a_buffer_order(&c5, &c7);
            a_buffer_order(&c1, &c2);
            a_buffer_order(&c5, &c6);
            a_buffer_order(&c0, &c4);
            a_buffer_order(&c3, &c7);
            a_buffer_order(&c1, &c5);
            a_buffer_order(&c2, &c6);
            a_buffer_order(&c1, &c4);
            a_buffer_order(&c3, &c6);
            a_buffer_order(&c2, &c4);
            a_buffer_order(&c3, &c5);
            a_buffer_order(&c3, &c4);
            left = min(left, a_buffer_lower(&k0, c7));
            left = min(left, a_buffer_lower(&k1, c6));
            left = min(left, a_buffer_lower(&k2, c5));
            left = min(left, a_buffer_lower(&k3, c4));
            left = min(left, a_buffer_lower(&k4, c3));
            left = min(left, a_buffer_lower(&k5, c2));
            left = min(left, a_buffer_lower(&k6, c1));
            left = min(left, a_buffer_lower(&k7, c0));
            a_buffer_order(&k0, &k4);
            a_buffer_order(&k1, &k5);
            a_buffer_order(&k2, &k6);
            a_buffer_order(&k3, &k7);
            a_buffer_order(&k0, &k2);
            a_buffer_order(&k1, &k3);
            a_buffer_order(&k4, &k6);
            a_buffer_order(&k5, &k7);
            a_buffer_order(&k0, &k1);
            a_buffer_order(&k2, &k3);
            a_buffer_order(&k4, &k5);
            a_buffer_order(&k6, &k7);
        }
        // Whether one alike to the last was left out.
        let tied = left == k7.upper && k7.upper != A_BUFFER_NONE;
        // Those that are alike and of which some were left out wait for the next round together; or go one by one, if they alone
        // fill this one.
        if tied && k0.upper == k7.upper {
            grouped = true;
            upper = k0.upper;
            lower = 0u;
        }
        if grouped { k0 = a_buffer_next(first, count, upper, lower); }
        let end = select(select(A_BUFFER_NONE, k7.upper, tied), A_BUFFER_NONE, grouped);
        let take = select(8u, 1u, grouped);
        let found = k0.place != A_BUFFER_NONE;
        // Those that are alike are put in the order of their lower halves: seven ways through the registers, which are turned by one
        // at each step, so that none of them is chosen by an index.
        let equal = a_buffer_equal(k0, k1) || a_buffer_equal(k1, k2) || a_buffer_equal(k2, k3) || a_buffer_equal(k3, k4)
            || a_buffer_equal(k4, k5) || a_buffer_equal(k5, k6) || a_buffer_equal(k6, k7);
        let steps = select(0u, 56u, equal && !grouped);
        for (var step = 0u; step < steps; step++) {
            if step % 8u < 7u && a_buffer_equal(k0, k1) && fragments_1[k0.place] > fragments_1[k1.place] {
                let moved = k0;
                k0 = k1;
                k1 = moved;
            }
            let moved = k0;
            k0 = k1;
            k1 = k2;
            k2 = k3;
            k3 = k4;
            k4 = k5;
            k5 = k6;
            k6 = k7;
            k7 = moved;
        }
        for (var i = 0u; i < take && k0.upper < end && transmittance > unseen; i++) {
            let word = vec2u(k0.upper, fragments_1[k0.place]);
            let value = word_value(word.y);
            colour += transmittance * value.x * shaded_colour(word_point(word), value.y);
            transmittance *= 1.0 - value.x;
            if result.key == A_BUFFER_NONE && value.x > 0.0 { result.key = word_key(word.x); }
            upper = select(word.x + 1u, upper, grouped);
            lower = word.y + 1u;
            done += 1u;
            k0 = k1;
            k1 = k2;
            k2 = k3;
            k3 = k4;
            k4 = k5;
            k5 = k6;
            k6 = k7;
            k7 = none;
        }
        // None is left but equal fragments of one segment, which cannot be parted; there are none, but a fault must
        // not loop.
        if !grouped && !found { break; }
        // The group has ended.
        if grouped && !found {
            grouped = false;
            upper += 1u;
        }
    }
    if done < count && transmittance > unseen {
        var depth = 0.0;
        var weight = 0.0;
        var sum = vec3f(0.0);
        var node = first;
        for (var i = 0u; i < count; i++) {
            let place = select(first + i, node - 1u, LISTS);
            if LISTS { node = links[place]; }
            let word = a_buffer_word(place);
            if word.x < upper || (grouped && word.x == upper && word.y < lower) { continue; }
            let value = word_value(word.y);
            depth += optical_depth(value.x);
            weight += value.x;
            sum += value.x * shaded_colour(word_point(word), value.y);
        }
        let through = exp(-depth);
        colour += transmittance * (1.0 - through) * sum / max(weight, 1e-20);
        transmittance *= through;
    }
    // What was left out is taken to hide as much, each, as what was not, and to have the colour of the first of it: a guess, but
    // one that errs by no more than what is behind the transmittance could add. The A-buffer's own limit is too small for it.
    if done < count && transmittance <= unseen && unseen > A_BUFFER_UNSEEN {
        let through = pow(max(transmittance, 1e-30), f32(count) / f32(done));
        colour += (transmittance - through) * begun.beyond;
        transmittance = through;
    }
    if a_buffer_overflowed() && transmittance > unseen {
        let tail = tail_of(number);
        colour += transmittance * tail.xyz;
        transmittance *= tail.w;
        if result.key == A_BUFFER_NONE && tail.w < 1.0 { result.key = a_buffer_tail_key(number); }
    }
    if transmittance > unseen {
        let beyond = resolve_beyond(number);
        colour += transmittance * beyond.xyz;
        transmittance *= beyond.w;
    }
    result.colour = vec4f(colour, 1.0 - transmittance);
    return result;
}

// Of a pixel's fragments with an upper half, the one with the lowest lower half from `lower` on.
fn a_buffer_next(first: u32, count: u32, upper: u32, lower: u32) -> Candidate {
    var lowest = A_BUFFER_NONE;
    var found = Candidate(A_BUFFER_NONE, A_BUFFER_NONE);
    var node = first;
    for (var i = 0u; i < count; i++) {
        let place = select(first + i, node - 1u, LISTS);
        if LISTS { node = links[place]; }
        if a_buffer_upper(place) != upper { continue; }
        let candidate = fragments_1[place];
        if candidate >= lower && candidate < lowest {
            lowest = candidate;
            found = Candidate(upper, place);
        }
    }
    return found;
}

fn nearest(pixel: vec2u) -> Nearest {
    return a_buffer_nearest(pixel);
}
