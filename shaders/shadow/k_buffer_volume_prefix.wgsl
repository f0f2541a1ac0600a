// K-buffer volumetric shadow: each texel's events become the light left behind each, once, so that a look-up reads one.

@group(2) @binding(0) var<storage, read_write> layers: array<u32>;

// What of the light goes straight through a fibre, by its inclination.
var<workgroup> volume_passed: array<vec3f, VOLUME_INCLINATIONS>;

const VOLUME_OFFSETS: u32 = 16u;

fn volume_reflectance(cos_i: f32, eta: f32) -> f32 {
    let cos_t = sqrt(max(1.0 - (1.0 - cos_i * cos_i) / (eta * eta), 0.0));
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return 0.5 * (perpendicular * perpendicular + parallel * parallel);
}

// ½ ∫ (1 - F)² exp(-2 σ_a cos γ_t / cos θ_t) dh over the fibre's width, h = sin γ.
fn volume_transmitted(inclination: f32, eta: f32, sigma_a: vec3f) -> vec3f {
    let sin_theta = sin(inclination);
    let cos_theta = cos(inclination);
    let cos_theta_t = sqrt(1.0 - sin_theta * sin_theta / (eta * eta));
    let eta_perpendicular = sqrt(eta * eta - sin_theta * sin_theta) / cos_theta;
    let step = 1.5707964 / f32(VOLUME_OFFSETS);
    var sum = vec3f(0.0);
    for (var i = 0u; i < VOLUME_OFFSETS; i++) {
        let gamma = (f32(i) + 0.5) * step;
        let passed = 1.0 - volume_reflectance(cos_theta * cos(gamma), eta);
        let sin_gamma_t = sin(gamma) / eta_perpendicular;
        let path = 2.0 * sqrt(max(1.0 - sin_gamma_t * sin_gamma_t, 0.0)) / cos_theta_t;
        sum += step * cos(gamma) * passed * passed * exp(-sigma_a * path);
    }
    return sum;
}

@compute @workgroup_size(64)
fn k_buffer_volume_prefix(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let coloured = drawing.map_colour.w > 0.0;
    if coloured && local < VOLUME_INCLINATIONS {
        let inclination = (f32(local) + 0.5) * (1.5707964 / f32(VOLUME_INCLINATIONS));
        volume_passed[local] = volume_transmitted(inclination, drawing.map_colour.w, drawing.map_colour.xyz);
    }
    workgroupBarrier();
    let texel = invocation.x + invocation.y * groups.x * 64u;
    let width = u32(drawing.viewport.x);
    if texel >= width * u32(drawing.viewport.y) { return; }
    let first = drawing.layer_base + texel * drawing.layer_count;
    let k = u32(drawing.map_values.y);
    let colours = first + k + VOLUME_TAIL_WORDS;
    var left = vec3f(1.0);
    var depth = 0.0;
    var count = 0u;
    for (var slot = 0u; slot < k; slot++) {
        let word = layers[first + slot];
        if word == 0u { break; }
        let payload = ~word & VOLUME_PAYLOAD_MASK;
        let opacity = volume_opacity(payload, coloured);
        if coloured {
            left *= 1.0 - opacity * (1.0 - volume_passed[payload & (VOLUME_INCLINATIONS - 1u)]);
            layers[colours + slot] = volume_pack(left);
        } else {
            left *= 1.0 - opacity;
            let root = u32(sqrt(left.x) * VOLUME_PAYLOAD_LAST + 0.5);
            // As in `emit`, no word is 0.
            layers[first + slot] = max(~((~word & ~VOLUME_PAYLOAD_MASK) | root), 1u);
        }
        depth += optical_depth(opacity);
        count += 1u;
    }
    // What was not kept; the sums of the kept ones differ by their rounding.
    let rest = f32(layers[first + k + VOLUME_REST]) / OPTICAL_DEPTH_SCALE - depth;
    layers[first + k + VOLUME_REST] = bitcast<u32>(select(0.0, max(rest, 0.0), count == k));
    // Its colour is that of the kept ones.
    let colour = select(vec3f(1.0), clamp(-log(max(left, vec3f(1e-7))) / max(depth, 1e-7), vec3f(0.0), vec3f(1.0)), coloured);
    layers[first + k + VOLUME_COLOUR] = pack4x8unorm(vec4f(colour, 1.0));
}
