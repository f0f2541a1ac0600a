// Chiang et al. 2016, d'Eon et al. 2011: S = Σ_p M_p(θ_i, θ_o) ½ ∫ A_p(θ_o, h) N_p(φ; h) dh, the far field.
//
// M_p = i0e(a) exp(-2 sin² θ_h / v) / (v (1 - e^(-2/v))), a = cos θ_i cos θ_o / v, with θ_o tilted by the lobe: the powers
// of e are joined, so that nothing overflows. The cosine is inside. With σ_a = 0 the integral over all lights is 1.

fn chiang_sigma_a() -> vec3f { return material.values[0].xyz; }
fn chiang_eta() -> f32 { return material.values[0].w; }
fn chiang_v() -> vec4f { return material.values[1]; }
// What is added to the view's θ, by lobe.
fn chiang_tilt() -> vec4f { return material.values[2]; }
fn chiang_s() -> f32 { return material.values[3].x; }
fn chiang_intervals() -> u32 { return u32(material.values[3].y); }
// Transmittance of one crossing at the tip; 1 at the root.
fn chiang_tip() -> vec3f { return material.values[4].xyz; }

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

fn scatter(fibre: Fibre, wi: vec3f, wo: vec3f, shadow: ShadowSample) -> vec3f {
    let pair = fibre_pair(fibre.tangent, wi, wo);
    let colour = fibre.colour * mix(vec3f(1.0), chiang_tip(), fibre.coordinate);
    let m = chiang_m(pair, 0.0);
    let n = fibre_tinted(chiang_azimuthal(pair, false), colour);
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
