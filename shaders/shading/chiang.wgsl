// Chiang et al. 2016, d'Eon et al. 2011: S = Σ_p M_p(θ_i, θ_o) ½ ∫ A_p(θ_o, h) N_p(φ; h) dh, the far field.
//
// M_p = i0e(a) exp(-2 sin² θ_h / v) / (v (1 - e^(-2/v))), a = cos θ_i cos θ_o / v, with θ_o tilted by the lobe: the powers
// of e are joined, so that nothing overflows. The cosine is inside. With σ_a = 0 the integral over all lights is 1.

fn chiang_sigma_a() -> vec3f { return material_value(0u).xyz; }
fn chiang_eta() -> f32 { return material_value(0u).w; }
fn chiang_v() -> vec4f {
    if VARIES { return chiang_varied_v; }
    return material_value(1u);
}
// What is added to the view's θ, by lobe.
fn chiang_tilt() -> vec4f { return material_value(2u); }
fn chiang_s() -> f32 {
    if VARIES { return chiang_varied_s; }
    return material_value(3u).x;
}
fn chiang_intervals() -> u32 { return u32(material_value(3u).y); }
// Transmittance of one crossing at the tip; 1 at the root.
fn chiang_tip() -> vec3f { return material_value(4u).xyz; }

// Of this fibre, where roughness varies.
var<private> chiang_varied_v: vec4f;
var<private> chiang_varied_s: f32;

// v(β_m) = (0.726 β + 0.812 β² + 3.7 β²⁰)², s(β_n) = √(π/8) (0.265 β + 1.194 β² + 5.372 β²²).
fn chiang_vary(fibre: Fibre) {
    let beta = clamp(material_value(13u).zw * fibre_roughness(fibre), vec2f(1e-3), vec2f(1.0));
    let square = beta * beta;
    let tenth = square * square * square * square * square;
    let deviation = 0.726 * beta.x + 0.812 * square.x + 3.7 * tenth.x * tenth.x;
    chiang_varied_v = deviation * deviation * vec4f(1.0, 0.25, 4.0, 4.0);
    chiang_varied_s = 0.62665707 * (0.265 * beta.y + 1.194 * square.y + 5.372 * tenth.y * tenth.y * square.y);
}

// e^-x I_0(x) for x ≥ 0 (Abramowitz and Stegun 9.8.1, 9.8.2): 2e-7.
fn chiang_i0e(x: f32) -> f32 {
    if x < 3.75 {
        let t = (x / 3.75) * (x / 3.75);
        let i0 = 1.0 + t * (3.5156229 + t * (3.0899424 + t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813)))));
        return i0 * exp(-x);
    }
    let t = 3.75 / x;
    let sum = 0.39894228 + t * (0.01328592 + t * (0.00225319 + t * (-0.00157565 + t * (0.00916281
        + t * (-0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377)))))));
    return sum * inverseSqrt(x);
}

fn chiang_longitudinal(v: f32, theta_i: f32, view: f32, cos_i: f32) -> f32 {
    // Tilted past ±π/2 the function is that of the supplementary angle.
    let theta_o = select(view, sign(view) * FIBRE_PI - view, abs(view) > FIBRE_HALF_PI);
    let a = cos_i * max(cos(theta_o), 0.0) / v;
    let sin_h = sin(0.5 * (theta_i + theta_o));
    return chiang_i0e(a) * exp(-2.0 * sin_h * sin_h / v) / (v * fibre_one_minus_exp(2.0 / v));
}

// M_p of all lobes, wider by `variance`.
fn chiang_m(pair: FibrePair, variance: f32) -> vec4f {
    var m: vec4f;
    for (var p = 0u; p < 4u; p++) {
        if !TRANSMITS && p == 1u { continue; }
        m[p] = chiang_longitudinal(chiang_v()[p] + variance, pair.theta_i, pair.theta_o + chiang_tilt()[p], pair.cos_i);
    }
    return m;
}

fn chiang_direct(theta_o: f32, phi: f32, intervals: u32, spread: bool) -> FibreLobes {
    return fibre_azimuthal(fibre_cylinder(chiang_eta(), theta_o), chiang_sigma_a(), chiang_s(), phi, intervals, spread);
}

// What the tables hold.
fn tabulated(theta: f32, phi: f32, spread: bool) -> FibreLobes {
    return chiang_direct(theta, phi, 128u, spread);
}

fn chiang_azimuthal(pair: FibrePair, spread: bool) -> FibreLobes {
    if FIBRE_TABLES { return fibre_look_up(pair.theta_o, pair.phi, select(0u, 1u, spread)); }
    return chiang_direct(pair.theta_o, pair.phi, chiang_intervals(), spread);
}

// Intervals of the part of a fibre that one pixel sees.
const CHIANG_NEAR_INTERVALS: u32 = 8u;

// The azimuthal functions at φ from the view to the light, signed, of the part of the fibre between the offsets `across`: their mean
// over h. With all of it the far field's.
fn chiang_near(pair: FibrePair, phi: f32, across: vec2f) -> FibreLobes {
    let cylinder = fibre_cylinder(chiang_eta(), pair.theta_o);
    let l = fibre_logistic(chiang_s());
    let ends = vec2f(fibre_asin(across.x), fibre_asin(across.y));
    let step = (ends.y - ends.x) / f32(CHIANG_NEAR_INTERVALS);
    var sum: FibreLobes;
    var before: array<FibreNode, 3>;
    var weight_before: FibreLobes;
    for (var i = 0u; i <= CHIANG_NEAR_INTERVALS; i++) {
        let gamma = ends.x + step * f32(i);
        let h = sin(gamma);
        let cos_gamma = max(cos(gamma), 0.0);
        let gamma_t = fibre_asin(h * cylinder.inverse_eta_prime);
        let a = fibre_attenuations(cylinder, chiang_sigma_a(), h, cos_gamma);
        let weight = FibreLobes(a.r * cos_gamma, a.tt * cos_gamma, a.trt * cos_gamma, a.residual * cos_gamma);
        let now = array<FibreNode, 3>(fibre_node(l, phi + 2.0 * gamma),
            fibre_node(l, phi - 2.0 * gamma_t + 2.0 * gamma - FIBRE_PI),
            fibre_node(l, phi - 4.0 * gamma_t + 2.0 * gamma - FIBRE_TAU));
        if i > 0u {
            sum.r += fibre_interval(l, before[0], now[0], vec3f(weight_before.r), vec3f(weight.r)).x;
            sum.tt += fibre_interval(l, before[1], now[1], weight_before.tt, weight.tt);
            sum.trt += fibre_interval(l, before[2], now[2], weight_before.trt, weight.trt);
            sum.residual += (weight_before.residual + weight.residual) * (0.5 / FIBRE_TAU);
        }
        before = now;
        weight_before = weight;
    }
    // The trapezoids of cos γ sum to the range of h times (step / 2) cot(step / 2).
    let scale = 2.0 * tan(0.5 * step) / max(across.y - across.x, 1e-6);
    return FibreLobes(sum.r * scale, sum.tt * scale, sum.trt * scale, sum.residual * scale);
}

fn scatter(fibre: Fibre, wi: vec3f, wo: vec3f, shadow: ShadowSample) -> vec3f {
    if VARIES { chiang_vary(fibre); }
    let pair = fibre_pair(fibre.tangent, wi, wo);
    let colour = fibre.colour * mix(vec3f(1.0), chiang_tip(), fibre.coordinate);
    let m = chiang_m(pair, 0.0);
    var azimuthal: FibreLobes;
    if NEAR && fibre.across.y - fibre.across.x < 2.0 {
        azimuthal = chiang_near(pair, fibre_turn(fibre.tangent, wo, wi), fibre.across);
    } else {
        azimuthal = chiang_azimuthal(pair, false);
    }
    let n = fibre_tinted(azimuthal, colour);
    let single = vec3f(m.x * n.r) + m.y * n.tt + m.z * n.trt + m.w * n.residual;
    if !FIBRE_DUAL { return shadow.transmittance * single; }

    let back = fibre_back(pair, vec3f(0.0), select(0.0, 1.0, pair.phi < FIBRE_HALF_PI));
    let forward = fibre_forward(pair.theta_i, shadow.fibres);
    if shadow.fibres <= 0.0 { return shadow.transmittance * (single + back); }
    let g = fibre_tinted(chiang_azimuthal(pair, true), colour);
    var spread: vec3f;
    for (var c = 0u; c < 3u; c++) {
        let wide = chiang_m(pair, forward.variance[c]);
        spread[c] = wide.x * g.r + wide.y * g.tt[c] + wide.z * g.trt[c] + wide.w * g.residual[c];
    }
    let spread_back = fibre_back(pair, forward.variance, 1.0 - pair.phi / FIBRE_PI);
    return shadow.transmittance * (single + back) + forward.transmittance * (spread + spread_back);
}

fn scatter_uniform(fibre: Fibre, wo: vec3f) -> vec3f {
    return fibre.colour * fibre_angle(fibre_atan2(dot(fibre.tangent, wo), length(cross(fibre.tangent, wo))), FIBRE_UNIFORM);
}
