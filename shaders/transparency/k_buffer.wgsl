// k-buffer from the A-buffer (Yu et al. 2012, §5.1): one way through a pixel's list keeps its K nearest fragments, which
// are composited front to back. REGISTERS of them are kept at a time: K (Yu), 8, or 1, which is the selection sort of
// the K foremost (Yang et al. 2010) that Yu compares with.
//
// Yu keeps the registers unordered and looks for the farthest at each replacement. Here they are in order, four to a
// vector: the farthest is the last one, and an insertion is one step a vector, with no sort afterwards. The order is by
// (depth, point), as the words' is, so that neither equal depths nor the storage's order change the picture.
//
// The rest, which Yu leaves out, is a layer behind them: REST_MERGED by exact transmittance and weighted colour, in integer
// sums; REST_ALPHA by exact transmittance in the colour of the K; REST_DROPPED not at all.

const REST_MERGED: u32 = 0u;
const REST_ALPHA: u32 = 1u;
const REST_DROPPED: u32 = 2u;

// Vectors of registers.
const K_BUFFER_BLOCKS: u32 = (REGISTERS + 3u) / 4u;

// Σ opacity and Σ opacity × colour in the steps of the overflow's tail, with their carries.
struct KBufferSums {
    low: vec4u,
    high: vec4u,
}

fn k_buffer_add(sums: KBufferSums, steps: vec4u) -> KBufferSums {
    let low = sums.low + steps;
    return KBufferSums(low, sums.high + select(vec4u(0u), vec4u(1u), low < steps));
}

// Colour and transmittance of the fragments from a word on.
fn k_buffer_rest(first: u32, count: u32, from_word: vec2u) -> vec4f {
    // Where nothing was kept there is no other colour.
    let with_colour = REST == REST_MERGED || all(from_word == vec2u(0u));
    var sums = KBufferSums(vec4u(0u), vec4u(0u));
    // From 2^31 on, an optical depth of 32,768, it stays.
    var depth = 0u;
    var node = first;
    for (var i = 0u; i < count; i++) {
        let place = select(first + i, node - 1u, LISTS);
        if LISTS { node = links[place]; }
        let upper = a_buffer_upper(place);
        if upper < from_word.x { continue; }
        let word = vec2u(upper, fragments_1[place]);
        if word_before(word, from_word) { continue; }
        let value = word_value(word.y);
        depth = min(depth + u32(optical_depth(value.x) * OPTICAL_DEPTH_SCALE + 0.5), 0x80000000u);
        if with_colour {
            let colour = min(value.x * shaded_colour(word_point(word), value.y) * frame.tail_scale, vec3f(TAIL_LARGEST));
            sums = k_buffer_add(sums, vec4u(vec4f(value.x * TAIL_WEIGHT_SCALE, colour) + 0.5));
        }
    }
    let through = exp(-f32(depth) / OPTICAL_DEPTH_SCALE);
    let total = vec4f(sums.low) + vec4f(sums.high) * 4294967296.0;
    let weight = max(total.x / TAIL_WEIGHT_SCALE, 1e-20);
    return vec4f(total.yzw / frame.tail_scale / weight, through);
}

fn resolve(pixel: vec2u) -> Resolved {
    pixels_begin();
    word_begin();
    shaded_begin(pixel);
    let number = pixel_number(pixel);
    let first = a_buffer_first(number);
    let count = a_buffer_count(number, first);
    var result = Resolved(vec4f(0.0), A_BUFFER_NONE);
    if count == 0u && !a_buffer_overflowed() { return result; }
    var transmittance = 1.0;
    var colour = vec3f(0.0);
    // Fragments before this word are done.
    var next_word = vec2u(0u);
    var kept = 0u;
    // A list so long that keeping K of it would take more than A_BUFFER_STEPS steps keeps fewer.
    let steps = A_BUFFER_STEPS / (count + 1u);
    let blocks = clamp(steps, 3u, K_BUFFER_BLOCKS + 2u) - 2u;
    // One for which even that is too much is the rest as a whole.
    let rounds = select(max(steps / (blocks + 1u), 2u) - 1u, 0u, steps < 3u && REST != REST_DROPPED);
    for (var round = 0u; round < rounds && kept < min(K, count) && transmittance > A_BUFFER_UNSEEN; round++) {
        var uppers: array<vec4u, K_BUFFER_BLOCKS>;
        var lowers: array<vec4u, K_BUFFER_BLOCKS>;
        for (var block = 0u; block < K_BUFFER_BLOCKS; block++) { uppers[block] = vec4u(A_BUFFER_NONE); }
        var last = vec2u(A_BUFFER_NONE, 0u);
        var node = first;
        for (var i = 0u; i < count; i++) {
            let place = select(first + i, node - 1u, LISTS);
            if LISTS { node = links[place]; }
            var carry = vec2u(a_buffer_upper(place), 0u);
            if carry.x < next_word.x || carry.x > last.x { continue; }
            carry.y = fragments_1[place];
            if word_before(carry, next_word) || !word_before(carry, last) { continue; }
            // What covers nothing takes nobody's place.
            if word_value(carry.y).x == 0.0 { continue; }
            if REGISTERS == 1u {
                uppers[0].x = carry.x;
                lowers[0].x = carry.y;
                last = carry;
                continue;
            }
            for (var block = 0u; block < K_BUFFER_BLOCKS; block++) {
                if block >= blocks { break; }
                let old_uppers = uppers[block];
                let old_lowers = lowers[block];
                let upper = vec4u(carry.x);
                let lower = vec4u(carry.y);
                let before = (upper < old_uppers) | ((upper == old_uppers) & (lower < old_lowers));
                let shifted = vec4<bool>(false, before.xyz);
                uppers[block] = select(old_uppers, select(upper, vec4u(0u, old_uppers.xyz), shifted), before);
                lowers[block] = select(old_lowers, select(lower, vec4u(0u, old_lowers.xyz), shifted), before);
                carry = select(carry, vec2u(old_uppers.w, old_lowers.w), before.w);
                last = vec2u(uppers[block].w, lowers[block].w);
            }
        }
        if uppers[0].x == A_BUFFER_NONE { break; }
        for (var i = 0u; i < min(REGISTERS, 4u * blocks) && kept < K && transmittance > A_BUFFER_UNSEEN; i++) {
            let word = vec2u(uppers[i / 4u][i % 4u], lowers[i / 4u][i % 4u]);
            if word.x == A_BUFFER_NONE { break; }
            let value = word_value(word.y);
            colour += transmittance * value.x * shaded_colour(word_point(word), value.y);
            transmittance *= 1.0 - value.x;
            if kept == 0u { result.key = word_key(word.x); }
            next_word = vec2u(word.x, word.y + 1u);
            kept += 1u;
        }
    }
    if REST != REST_DROPPED && kept < count && transmittance > A_BUFFER_UNSEEN {
        let rest = k_buffer_rest(first, count, next_word);
        let opacity = transmittance * (1.0 - rest.w);
        let own = select(colour / (1.0 - transmittance), vec3f(0.0), kept == 0u);
        colour += opacity * select(own, rest.xyz, REST == REST_MERGED || kept == 0u);
        transmittance -= opacity;
    }
    if a_buffer_overflowed() && transmittance > A_BUFFER_UNSEEN {
        let tail = tail_of(number);
        colour += transmittance * tail.xyz;
        transmittance *= tail.w;
        if result.key == A_BUFFER_NONE && tail.w < 1.0 { result.key = a_buffer_tail_key(number); }
    }
    result.colour = vec4f(colour, 1.0 - transmittance);
    return result;
}

// What the outputs beside the colour say is covered is what is drawn.
fn nearest(pixel: vec2u) -> Nearest {
    var near = a_buffer_nearest(pixel);
    if REST == REST_DROPPED { near.opacity = resolve(pixel).colour.w; }
    return near;
}
