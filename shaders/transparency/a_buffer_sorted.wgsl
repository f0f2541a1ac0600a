// A-buffer, counted arrays: a pixel's fragments front to back by ranks: the top of a fragment's word, and in the lowest bits its
// place in the pixel's array, so that the least of two is found without a branch and no place is carried beside it.
//
// Each round reads all upper halves, sixteen at a time, puts their ranks in order by a network (Batcher's bitonic merges), and takes
// of them and of the sixteen that are kept the lower ones. Two fragments whose ranks differ by their places alone are ordered by
// their whole words; where more are alike the composition stops, and `resolve` goes on by the words themselves.

struct Sixteen {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    d: vec4u,
}

// Sorts four of which the first rise and the others fall, or the other way round.
fn a_buffer_clean_4(v: vec4u) -> vec4u {
    let near = min(v.xy, v.zw);
    let far = max(v.xy, v.zw);
    let even = vec2u(near.x, far.x);
    let odd = vec2u(near.y, far.y);
    let low = min(even, odd);
    let high = max(even, odd);
    return vec4u(low.x, high.x, low.y, high.y);
}

// The same of sixteen.
fn a_buffer_clean_16(s: Sixteen) -> Sixteen {
    let a = min(s.a, s.c);
    let b = min(s.b, s.d);
    let c = max(s.a, s.c);
    let d = max(s.b, s.d);
    return Sixteen(
        a_buffer_clean_4(min(a, b)),
        a_buffer_clean_4(max(a, b)),
        a_buffer_clean_4(min(c, d)),
        a_buffer_clean_4(max(c, d)),
    );
}

fn a_buffer_sort_16(s: Sixteen) -> Sixteen {
    // Four columns, each in order.
    let low_a = min(s.a, s.b);
    let high_a = max(s.a, s.b);
    let low_c = min(s.c, s.d);
    let high_c = max(s.c, s.d);
    let v0 = min(low_a, low_c);
    let v3 = max(high_a, high_c);
    let middle_a = max(low_a, low_c);
    let middle_c = min(high_a, high_c);
    let v1 = min(middle_a, middle_c);
    let v2 = max(middle_a, middle_c);
    // Two and two of them, the second turned round; then these.
    let x = vec4u(v0.x, v1.x, v2.x, v3.x);
    let y = vec4u(v3.y, v2.y, v1.y, v0.y);
    let z = vec4u(v0.z, v1.z, v2.z, v3.z);
    let w = vec4u(v3.w, v2.w, v1.w, v0.w);
    let p0 = a_buffer_clean_4(min(x, y));
    let p1 = a_buffer_clean_4(max(x, y));
    let q0 = a_buffer_clean_4(min(z, w)).wzyx;
    let q1 = a_buffer_clean_4(max(z, w)).wzyx;
    return a_buffer_clean_16(Sixteen(p0, p1, q1, q0));
}

// How a pixel's ranks are made.
struct Ranks {
    // The pixel's first fragment, and how many there are; and the place that the ranks' places count from.
    first: u32,
    count: u32,
    begin: u32,
    // The bits of a rank that are a place.
    place_mask: u32,
}

fn a_buffer_four(ranks: Ranks, base: u32, after: u32) -> vec4u {
    // The end of a pixel's array may lie before that of its batch.
    let upper = fragments_0[min(base, ranks.first + ranks.count - 1u) / 4u];
    let place = base + vec4u(0u, 1u, 2u, 3u);
    let rank = (upper & vec4u(~ranks.place_mask)) | (place - ranks.begin);
    let taken = (place - ranks.first < vec4u(ranks.count)) & (rank >= vec4u(after));
    return select(vec4u(A_BUFFER_NONE), rank, taken);
}

struct Composition {
    colour: vec3f,
    transmittance: f32,
    // Fragments that are done, and an upper half below which they are.
    done: u32,
    upper: u32,
    // Key of the nearest one that shows.
    nearest: u32,
    // Colour of the first that was left out, where there is one.
    beyond: vec3f,
}

// The most fragments of a pixel that are ordered this way.
const A_BUFFER_SORTED_MOST: u32 = 1020u;

fn a_buffer_sorted(first: u32, count: u32) -> Composition {
    var result = Composition(vec3f(0.0), 1.0, 0u, 0u, A_BUFFER_NONE, vec3f(0.0));
    if count == 0u || count > A_BUFFER_SORTED_MOST { return result; }
    let begin = first & ~3u;
    // A rank is never all ones.
    let place_bits = 32u - countLeadingZeros(count + 4u);
    let place_mask = (1u << place_bits) - 1u;
    let ranks = Ranks(first, count, begin, place_mask);
    let end = first + count;
    let unseen = frame.unseen;
    let none = vec4u(A_BUFFER_NONE);
    var nearest = A_BUFFER_NONE;
    // One more than the last rank that is done.
    var after = 0u;
    var alike = false;
    while !alike && result.done < count && result.transmittance > unseen {
        var kept = Sixteen(none, none, none, none);
        // The least of those that were left out.
        var left = A_BUFFER_NONE;
        for (var base = begin; base < end; base += 16u) {
            let read = a_buffer_sort_16(Sixteen(
                a_buffer_four(ranks, base, after),
                a_buffer_four(ranks, base + 4u, after),
                a_buffer_four(ranks, base + 8u, after),
                a_buffer_four(ranks, base + 12u, after),
            ));
            let turned = Sixteen(read.d.wzyx, read.c.wzyx, read.b.wzyx, read.a.wzyx);
            let most = min(min(max(kept.a, turned.a), max(kept.b, turned.b)), min(max(kept.c, turned.c), max(kept.d, turned.d)));
            left = min(left, min(min(most.x, most.y), min(most.z, most.w)));
            kept = a_buffer_clean_16(Sixteen(
                min(kept.a, turned.a),
                min(kept.b, turned.b),
                min(kept.c, turned.c),
                min(kept.d, turned.d),
            ));
        }
        // Those that are alike and of which some were left out wait for the next round together.
        let tied = left != A_BUFFER_NONE && (kept.d.w ^ left) >> place_bits == 0u;
        let stop = select(A_BUFFER_NONE, left & ~place_mask, tied);
        // More alike than a round holds; or nothing, which cannot be, but a fault must not loop.
        alike = kept.a.x >= stop;
        var here = kept.a.x;
        var here_word = a_buffer_word(begin + select(here & place_mask, 0u, alike));
        // One of the sixteen stays, to be the first of what may be left out; two that are alike stay together.
        for (var i = 0u; i < 15u && here < stop && result.transmittance > unseen; i++) {
            var next = kept.a.y;
            let third = kept.a.z;
            var next_word = a_buffer_word(begin + (select(next, here, next == A_BUFFER_NONE) & place_mask));
            if next != A_BUFFER_NONE && (here ^ next) >> place_bits == 0u {
                if i == 14u { break; }
                alike = third != A_BUFFER_NONE && (next ^ third) >> place_bits == 0u;
                if alike { break; }
                if word_before(next_word, here_word) {
                    let moved = here;
                    here = next;
                    next = moved;
                    let moved_word = here_word;
                    here_word = next_word;
                    next_word = moved_word;
                }
            }
            let value = word_value(here_word.y);
            result.colour += result.transmittance * value.x * shaded_colour(word_point(here_word), value.y);
            result.transmittance *= 1.0 - value.x;
            if nearest == A_BUFFER_NONE && value.x > 0.0 { nearest = begin + (here & place_mask); }
            after = max(after, here + 1u);
            result.done += 1u;
            here = next;
            here_word = next_word;
            kept = Sixteen(
                vec4u(next, kept.a.zw, kept.b.x),
                vec4u(kept.b.yzw, kept.c.x),
                vec4u(kept.c.yzw, kept.d.x),
                vec4u(kept.d.yzw, A_BUFFER_NONE),
            );
        }
        if result.transmittance <= unseen && unseen > A_BUFFER_UNSEEN {
            // Which of several that are alike would be first is the scheduler's choice.
            let beside = min(kept.a.y, left);
            let alone = here != A_BUFFER_NONE && (beside == A_BUFFER_NONE || (here ^ beside) >> place_bits != 0u);
            if alone { result.beyond = shaded_colour(word_point(here_word), word_value(here_word.y).y); }
        }
        if alike { result.upper = here & ~place_mask; }
    }
    if nearest != A_BUFFER_NONE { result.nearest = word_key(a_buffer_upper(nearest)); }
    return result;
}
