// Marschner et al. 2003 (Hunz §3.3): S = Σ_p M_p N_p / cos² θ_d times cos θ_i, with M_p = ½ g(β_p, θ_h - α_p) and
// N_p = Σ_r A(p, h_r) |2 dφ/dh|⁻¹ over the roots of φ(p, γ_i) = 2p γ_t - 2γ_i + pπ.
//
// R and TT have one root in closed form; TRT's are bracketed between its turning points and found by Newton's steps, or
// halves where these leave the bracket. With `cubic` φ is its fit by a polynomial (Hunz eq. 46). TRT's caustic is taken
// out by algorithm 1, corrected as the reference says; an elliptic section gives TRT η*(φ_h).

fn marschner_sigma_a() -> vec3f { return material_value(0u).xyz; }
fn marschner_eta() -> f32 { return material_value(0u).w; }
fn marschner_alpha() -> vec3f { return material_value(1u).xyz; }
fn marschner_eccentricity() -> f32 { return material_value(1u).w; }
fn marschner_beta() -> vec3f {
    if VARIES { return clamp(material_value(2u).xyz * marschner_roughness, vec3f(1e-5), vec3f(10.0)); }
    return material_value(2u).xyz;
}
var<private> marschner_roughness: f32;
// w_c, k_G, Δη', Δh.
fn marschner_caustic() -> vec4f { return material_value(3u); }
fn marschner_removes_caustic() -> bool { return material_value(4u).w > 0.0; }
// Transmittance of one crossing at the tip; 1 at the root.
fn marschner_tip() -> vec3f { return material_value(4u).xyz; }

// At a caustic the true N is infinite; here it ends.
const MARSCHNER_MIN_SLOPE: f32 = 1e-6;
// Newton's steps double the digits; halves are needed near turning points alone.
const MARSCHNER_STEPS: u32 = 32u;
// Intervals of the means over half circles, and the logistic's scale there: narrower than any half circle's edge shows.
const MARSCHNER_INTERVALS: u32 = 48u;
const MARSCHNER_SHARP: f32 = 2e-3;

struct MarschnerExit {
    p: f32,
    inverse_eta_prime: f32,
    // asin(1 / η'), of the fit.
    c: f32,
}

fn marschner_exit_value(e: MarschnerExit, gamma: f32) -> f32 {
    let u = gamma / FIBRE_PI;
    var gamma_t = e.c * u * (3.0 - 4.0 * u * u);
    if !MARSCHNER_CUBIC { gamma_t = fibre_asin(sin(gamma) * e.inverse_eta_prime); }
    return 2.0 * e.p * gamma_t - 2.0 * gamma + e.p * FIBRE_PI;
}

fn marschner_exit_slope(e: MarschnerExit, gamma: f32) -> f32 {
    if MARSCHNER_CUBIC {
        let u = gamma / FIBRE_PI;
        return 2.0 * e.p * e.c / FIBRE_PI * (3.0 - 12.0 * u * u) - 2.0;
    }
    let s = sin(gamma) * e.inverse_eta_prime;
    return 2.0 * e.p * max(cos(gamma), 0.0) * e.inverse_eta_prime / sqrt(max((1.0 - s) * (1.0 + s), 1e-12)) - 2.0;
}

// γ_c > 0 at which φ turns back, or -1 where it is monotonic.
fn marschner_turning_point(e: MarschnerExit) -> f32 {
    if MARSCHNER_CUBIC {
        let pc = 3.0 * e.p * e.c;
        if pc <= FIBRE_PI { return -1.0; }
        let gamma = FIBRE_PI * sqrt((pc - FIBRE_PI) / (4.0 * pc));
        return select(-1.0, gamma, gamma < FIBRE_HALF_PI);
    }
    let eta = 1.0 / max(e.inverse_eta_prime, 1e-20);
    if e.p < 2.0 || eta >= 2.0 { return -1.0; }
    return fibre_asin(sqrt(min((2.0 - eta) * (2.0 + eta) / 3.0, 1.0)));
}

// |d²φ/dh²| at a turning point.
fn marschner_curvature(e: MarschnerExit, gamma: f32) -> f32 {
    let h = sin(gamma);
    let c = max(cos(gamma), 1e-4);
    if MARSCHNER_CUBIC { return 48.0 * e.p * e.c / (FIBRE_PI * FIBRE_PI * FIBRE_PI) * gamma / (c * c); }
    let i = e.inverse_eta_prime;
    let inside = max(1.0 - h * h * i * i, 1e-8);
    return abs(2.0 * e.p * h * i * i * i / (inside * sqrt(inside)) - 2.0 * h / (c * c * c));
}

fn marschner_root(e: MarschnerExit, from_end: f32, to_end: f32, target_value: f32) -> f32 {
    var low = from_end;
    var high = to_end;
    let rising = marschner_exit_value(e, high) > marschner_exit_value(e, low);
    var gamma = 0.5 * (low + high);
    for (var i = 0u; i < MARSCHNER_STEPS; i++) {
        let excess = marschner_exit_value(e, gamma) - target_value;
        if (excess > 0.0) == rising { high = gamma; } else { low = gamma; }
        let slope = marschner_exit_slope(e, gamma);
        var next = gamma - excess / select(slope, 1e-12, abs(slope) < 1e-12);
        if !(next > low && next < high) { next = 0.5 * (low + high); }
        let moved = abs(next - gamma);
        gamma = next;
        if moved < 1e-7 { break; }
    }
    return gamma;
}

// A(p, h) |2 dφ/dh|⁻¹ of one root; one component of the attenuations.
fn marschner_of_root(cylinder: FibreCylinder, slope: f32, h: f32, cos_gamma: f32) -> FibreLobes {
    let a = fibre_attenuations(cylinder, marschner_sigma_a(), h, cos_gamma);
    let scale = 0.5 * cos_gamma / max(abs(slope), MARSCHNER_MIN_SLOPE);
    return FibreLobes(a.r * scale, a.tt * scale, a.trt * scale, vec3f(0.0));
}

fn marschner_tt(cylinder: FibreCylinder, phi: f32) -> vec3f {
    let inverse = cylinder.inverse_eta_prime;
    if MARSCHNER_CUBIC {
        let e = MarschnerExit(1.0, inverse, fibre_asin(inverse));
        return marschner_sum(cylinder, e, marschner_turning_point(e), phi).tt;
    }
    // γ_i - γ_t = δ: tan γ_i = sin δ / (cos δ - 1/η'), with cos δ - 1/η' = (1 - 1/η') - 2 sin²(δ/2).
    let delta = 0.5 * (FIBRE_PI - phi);
    let half_sine = sin(0.5 * delta);
    let eta = cylinder.eta;
    let root = sqrt((eta - 1.0) * (eta + 1.0) + cylinder.cos_theta * cylinder.cos_theta);
    let above = (eta - 1.0) * (eta + 1.0) / (root * (root + cylinder.cos_theta));
    let forward = above - 2.0 * half_sine * half_sine;
    if forward <= 0.0 { return vec3f(0.0); }
    let size = sqrt(above * above + 4.0 * inverse * half_sine * half_sine);
    let h = sin(delta) / size;
    let cos_gamma = forward / size;
    let sin_t = h * inverse;
    let slope = 2.0 * cos_gamma * inverse / sqrt(max((1.0 - sin_t) * (1.0 + sin_t), 1e-12)) - 2.0;
    return marschner_of_root(cylinder, slope, h, cos_gamma).tt;
}

fn marschner_trt(cylinder: FibreCylinder, phi: f32) -> vec3f {
    let e = MarschnerExit(2.0, cylinder.inverse_eta_prime, fibre_asin(cylinder.inverse_eta_prime));
    let turn = marschner_turning_point(e);
    let n = marschner_sum(cylinder, e, turn, phi).trt;
    if !marschner_removes_caustic() { return n; }

    let caustic = marschner_caustic();
    var gamma_c = 0.0;
    var delta_h = caustic.w;
    var t = 1.0;
    var phi_c = 0.0;
    if turn >= 0.0 {
        gamma_c = turn;
        delta_h = min(2.0 * sqrt(2.0 * caustic.x / max(marschner_curvature(e, turn), 1e-12)), caustic.w);
        phi_c = fibre_wrap(marschner_exit_value(e, turn));
    } else {
        let x = clamp((1.0 / max(e.inverse_eta_prime, 1e-20) - 2.0) / caustic.z, 0.0, 1.0);
        t = 1.0 - x * x * (3.0 - 2.0 * x);
    }
    if t <= 0.0 { return n; }
    let ahead = fibre_gaussian(caustic.x, fibre_wrap(phi - phi_c));
    let behind = fibre_gaussian(caustic.x, fibre_wrap(phi + phi_c));
    let glints = (ahead + behind) / (caustic.x * sqrt(FIBRE_TAU));
    let a_c = fibre_attenuations(cylinder, marschner_sigma_a(), sin(gamma_c), cos(gamma_c)).trt;
    // Where the true N has no limit the factor before it goes to 0 faster.
    return n * ((1.0 - t * ahead) * (1.0 - t * behind)) + a_c * (t * caustic.y * delta_h * glints);
}

// Σ over all roots, with caustics.
fn marschner_sum(cylinder: FibreCylinder, e: MarschnerExit, turn: f32, phi: f32) -> FibreLobes {
    var ends = array<f32, 4>(-FIBRE_HALF_PI, -turn, turn, FIBRE_HALF_PI);
    var pieces = 3u;
    if turn < 0.0 {
        ends[1] = FIBRE_HALF_PI;
        pieces = 1u;
    }
    var n: FibreLobes;
    for (var piece = 0u; piece < pieces; piece++) {
        let a = marschner_exit_value(e, ends[piece]);
        let b = marschner_exit_value(e, ends[piece + 1u]);
        // One root for each multiple of 2π in the range: never more than two.
        let first = ceil((min(a, b) - phi) / FIBRE_TAU);
        let last = floor((max(a, b) - phi) / FIBRE_TAU);
        for (var k = 0u; k < 3u; k++) {
            let turns = first + f32(k);
            if turns > last { break; }
            let gamma = marschner_root(e, ends[piece], ends[piece + 1u], phi + FIBRE_TAU * turns);
            let one = marschner_of_root(cylinder, marschner_exit_slope(e, gamma), sin(gamma), max(cos(gamma), 0.0));
            n.tt += one.tt;
            n.trt += one.trt;
        }
    }
    return n;
}

// η*(φ_h) of a section whose axis along φ = 0 is `a` times the other (Hunz eq. 58, 59, corrected).
fn marschner_elliptic_eta(eta: f32, a: f32, phi_h: f32) -> f32 {
    let wide = 2.0 * (eta - 1.0) * a * a - eta + 2.0;
    let narrow = 2.0 * (eta - 1.0) / (a * a) - eta + 2.0;
    return 0.5 * ((wide + narrow) + cos(2.0 * phi_h) * (wide - narrow));
}

fn marschner_direct(theta_d: f32, phi: f32, spread: bool) -> FibreLobes {
    let cylinder = fibre_cylinder(marschner_eta(), theta_d);
    if spread {
        return fibre_azimuthal(cylinder, marschner_sigma_a(), MARSCHNER_SHARP, phi, MARSCHNER_INTERVALS, true);
    }
    let cos_half = max(cos(0.5 * phi), 0.0);
    var lobes: FibreLobes;
    lobes.r = 0.25 * cos_half * fibre_fresnel(cylinder.eta, cylinder.cos_theta * cos_half);
    if TRANSMITS { lobes.tt = marschner_tt(cylinder, phi); }
    lobes.trt = marschner_trt(cylinder, phi);
    return lobes;
}

// What the tables hold.
fn tabulated(theta: f32, phi: f32, spread: bool) -> FibreLobes {
    return marschner_direct(theta, phi, spread);
}

fn marschner_azimuthal(theta_d: f32, phi: f32, spread: bool) -> FibreLobes {
    if FIBRE_TABLES { return fibre_look_up(theta_d, phi, select(0u, 1u, spread)); }
    return marschner_direct(theta_d, phi, spread);
}

// M_p of R, TT, TRT, wider by `variance` of θ_i + θ_o.
fn marschner_m(pair: FibrePair, variance: f32) -> vec3f {
    let off = vec3f(pair.theta_i + pair.theta_o) - 2.0 * marschner_alpha();
    if variance == 0.0 {
        let t = 0.5 * off / marschner_beta();
        return exp(-0.5 * t * t) * (0.5 / sqrt(FIBRE_TAU)) / marschner_beta();
    }
    let wide = 4.0 * marschner_beta() * marschner_beta() + vec3f(variance);
    return exp(-0.5 * off * off / wide) * inverseSqrt(FIBRE_TAU * wide);
}

// φ_h from an axis across the strand that is fixed by the strand's number: cuticles are not known to have any order.
fn marschner_phi_h(fibre: Fibre, wi: vec3f, wo: vec3f) -> f32 {
    let up = select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(fibre.tangent.y) > 0.9);
    let first = normalize(cross(fibre.tangent, up));
    let second = cross(fibre.tangent, first);
    let phi_i = fibre_atan2(dot(wi, second), dot(wi, first));
    let phi_o = fibre_atan2(dot(wo, second), dot(wo, first));
    return 0.5 * (phi_i + phi_o) + FIBRE_PI * fibre_random(fibre.strand, 1u);
}

fn scatter(fibre: Fibre, wi: vec3f, wo: vec3f, shadow: ShadowSample) -> vec3f {
    if VARIES { marschner_roughness = fibre_roughness(fibre); }
    let pair = fibre_pair(fibre.tangent, wi, wo);
    let theta_d = 0.5 * (pair.theta_o - pair.theta_i);
    let colour = fibre.colour * mix(vec3f(1.0), marschner_tip(), fibre.coordinate);
    let factor = fibre_cosine_factor(pair);
    let m = marschner_m(pair, 0.0);
    var n = marschner_azimuthal(theta_d, pair.phi, false);
    if MARSCHNER_ELLIPTIC {
        let eta = marschner_elliptic_eta(marschner_eta(), marschner_eccentricity(), marschner_phi_h(fibre, wi, wo));
        n.trt = marschner_trt(fibre_cylinder(eta, theta_d), pair.phi);
    }
    n = fibre_tinted(n, colour);
    let single = (vec3f(m.x * n.r) + m.y * n.tt + m.z * n.trt) * factor;
    if !FIBRE_DUAL { return shadow.transmittance * single; }

    let back = fibre_back(pair, vec3f(0.0), select(0.0, 1.0, pair.phi < FIBRE_HALF_PI));
    if shadow.fibres <= 0.0 { return shadow.transmittance * (single + back); }
    let forward = fibre_forward(pair.theta_i, shadow.fibres);
    let g = fibre_tinted(marschner_azimuthal(theta_d, pair.phi, true), colour);
    var spread: vec3f;
    for (var c = 0u; c < 3u; c++) {
        let wide = marschner_m(pair, forward.variance[c]);
        spread[c] = (wide.x * g.r + wide.y * g.tt[c] + wide.z * g.trt[c]) * factor;
    }
    let spread_back = fibre_back(pair, forward.variance, 1.0 - pair.phi / FIBRE_PI);
    return shadow.transmittance * (single + back) + forward.transmittance * (spread + spread_back);
}

fn scatter_uniform(fibre: Fibre, wo: vec3f) -> vec3f {
    return fibre.colour * fibre_angle(fibre_atan2(dot(fibre.tangent, wo), length(cross(fibre.tangent, wo))), FIBRE_UNIFORM);
}
