// A-buffer, counted arrays: a pixel's fragments front to back by words that hold a key and, in their lowest bits, the fragment's place
// in the pixel's array, so that the least of two is found without a branch and no place is carried beside its key.
//
// Each round reads all keys, sixteen at a time, puts these in order by a network (Batcher's bitonic merges), and takes of them and of
// the sixteen that are kept the lower ones. Where keys are too fine for the bits that are left they are cut off. Two fragments of one
// word's key are ordered by their points; where more are alike, or what was cut off may part them, the composition stops, and
// `resolve` goes on by the keys themselves.

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

// How a pixel's words are made of keys.
struct Words {
    // The pixel's first fragment, and how many there are; and the place that the words' places count from.
    first: u32,
    count: u32,
    begin: u32,
    // The least key, the greatest beyond it, bits of a place, and bits by which keys are cut off.
    key_first: u32,
    key_most: u32,
    place_bits: u32,
    key_shift: u32,
}

fn a_buffer_four(words: Words, base: u32, after: u32) -> vec4u {
    // The end of a pixel's array may lie before that of its batch.
    let keys = fragments_0[min(base, words.first + words.count - 1u) / 4u];
    let place = base + vec4u(0u, 1u, 2u, 3u);
    let key = min(max(keys, vec4u(words.key_first)) - words.key_first, vec4u(words.key_most)) >> vec4u(words.key_shift);
    let word = key << vec4u(words.place_bits) | (place - words.begin);
    let taken = (place - words.first < vec4u(words.count)) & (word >= vec4u(after));
    return select(vec4u(A_BUFFER_NONE), word, taken);
}

struct Composition {
    colour: vec3f,
    transmittance: f32,
    // Fragments that are done, and a key below which they are.
    done: u32,
    key: u32,
    // Key of the nearest one that shows.
    nearest: u32,
    // Colour of the first that was left out, where there is one.
    beyond: vec3f,
}

// The most fragments of a pixel that are ordered this way.
const A_BUFFER_SORTED_MOST: u32 = 1020u;
// Bits of a key that frame.key_packing leaves to the DBK-buffer's bins.
const A_BUFFER_BIN_BITS: u32 = 17u;

fn a_buffer_sorted(first: u32, count: u32) -> Composition {
    var result = Composition(vec3f(0.0), 1.0, 0u, 0u, A_BUFFER_NONE, vec3f(0.0));
    if count == 0u || count > A_BUFFER_SORTED_MOST { return result; }
    let begin = first & ~3u;
    // A word is never all ones.
    let place_bits = 32u - countLeadingZeros(count + 4u);
    let key_bits = (frame.key_packing >> 16u) + A_BUFFER_BIN_BITS;
    let key_shift = max(key_bits + place_bits, 32u) - 32u;
    let key_most = 0xffffffffu >> (32u - key_bits);
    let words = Words(first, count, begin, frame.key_first, key_most, place_bits, key_shift);
    let place_mask = (1u << place_bits) - 1u;
    let end = first + count;
    let unseen = frame.unseen;
    let none = vec4u(A_BUFFER_NONE);
    var nearest = A_BUFFER_NONE;
    // One more than the last word that is done.
    var after = 0u;
    var alike = false;
    while !alike && result.done < count && result.transmittance > unseen {
        var kept = Sixteen(none, none, none, none);
        // The least of those that were left out.
        var left = A_BUFFER_NONE;
        for (var base = begin; base < end; base += 16u) {
            let read = a_buffer_sort_16(Sixteen(
                a_buffer_four(words, base, after),
                a_buffer_four(words, base + 4u, after),
                a_buffer_four(words, base + 8u, after),
                a_buffer_four(words, base + 12u, after),
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
        // A key of which some were left out waits for the next round as a whole.
        let tied = left != A_BUFFER_NONE && (kept.d.w ^ left) >> place_bits == 0u;
        let stop = select(A_BUFFER_NONE, left >> place_bits << place_bits, tied);
        // More of one key than a round holds; or nothing, which cannot be, but a fault must not loop.
        alike = kept.a.x >= stop;
        var here = kept.a.x;
        var here_words = a_buffer_words(begin + select(here & place_mask, 0u, alike));
        // One of the sixteen stays, to be the first of what may be left out; two of one key stay together.
        for (var i = 0u; i < 15u && here < stop && result.transmittance > unseen; i++) {
            var next = kept.a.y;
            let third = kept.a.z;
            var next_words = a_buffer_words(begin + (select(next, here, next == A_BUFFER_NONE) & place_mask));
            if next != A_BUFFER_NONE && (here ^ next) >> place_bits == 0u {
                if i == 14u { break; }
                alike = key_shift > 0u || (third != A_BUFFER_NONE && (next ^ third) >> place_bits == 0u);
                if alike { break; }
                if here_words.x > next_words.x {
                    let moved = here;
                    here = next;
                    next = moved;
                    let moved_words = here_words;
                    here_words = next_words;
                    next_words = moved_words;
                }
            }
            let value = a_buffer_value(here_words.y);
            result.colour += result.transmittance * value.x * shaded_colour(here_words.x, value.y);
            result.transmittance *= 1.0 - value.x;
            if nearest == A_BUFFER_NONE && value.x > 0.0 { nearest = begin + (here & place_mask); }
            after = max(after, here + 1u);
            result.done += 1u;
            here = next;
            here_words = next_words;
            kept = Sixteen(
                vec4u(next, kept.a.zw, kept.b.x),
                vec4u(kept.b.yzw, kept.c.x),
                vec4u(kept.c.yzw, kept.d.x),
                vec4u(kept.d.yzw, A_BUFFER_NONE),
            );
        }
        if result.transmittance <= unseen && unseen > A_BUFFER_UNSEEN {
            // Which of several of one key would be first is the scheduler's choice.
            let beside = min(kept.a.y, left);
            let alone = here != A_BUFFER_NONE && (beside == A_BUFFER_NONE || (here ^ beside) >> place_bits != 0u);
            if alone { result.beyond = shaded_colour(here_words.x, a_buffer_value(here_words.y).y); }
        }
        let key = here >> place_bits;
        if alike && key > 0u { result.key = words.key_first + (key << key_shift); }
    }
    if nearest != A_BUFFER_NONE { result.nearest = a_buffer_key(nearest); }
    return result;
}
