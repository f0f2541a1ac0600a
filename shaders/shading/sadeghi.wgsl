// Sadeghi et al. 2010 (Hunz §3.4): f′ = (1 / cos² θ_d) Σ_p C_p I_p g′(β_p, θ_h - α_p) N′_p(φ) times cos θ_i, g′ of unit height,
// N′_R = cos(φ/2), N′_TT = g′(δ_TT, π - |φ|), N′_TRT = cos(φ/2) + I_G g′(δ_G, G - |φ|). The normalised form divides by
// max(1, E(θ_i), E(θ_o)), E the part of the light that is scattered.

// C_p I_p and the shift α_p.
fn sadeghi_lobe(p: u32) -> vec4f { return material_value(p); }
// β_p, and δ_TT.
fn sadeghi_widths() -> vec4f { return material_value(3u); }
// I_G, δ_G, and the range of G, within which a strand's own lies.
fn sadeghi_glint() -> vec4f { return material_value(4u); }
fn sadeghi_normalised() -> bool { return material_value(5u).w > 0.0; }
// Transmittance of one crossing at the tip; 1 at the root.
fn sadeghi_tip() -> vec3f { return material_value(5u).xyz; }

fn sadeghi_glint_angle(fibre: Fibre) -> f32 {
    let glint = sadeghi_glint();
    return mix(glint.z, glint.w, fibre_random(fibre.strand, 2u));
}

// N′ of R, TT, TRT.
fn sadeghi_azimuthal(phi: f32, angle: f32) -> vec3f {
    let base = max(cos(0.5 * phi), 0.0);
    let glint = sadeghi_glint();
    return vec3f(base, fibre_gaussian(sadeghi_widths().w, FIBRE_PI - phi),
        base + glint.x * fibre_gaussian(glint.y, angle - phi));
}

// Abramowitz and Stegun 7.1.26: 1.5e-7.
fn sadeghi_erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.3275911 * abs(x));
    let sum = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
    return sign(x) * (1.0 - sum * exp(-x * x));
}

// ∫ N′ from 0 to u, u up to π.
fn sadeghi_integral(u: f32, angle: f32) -> vec3f {
    let glint = sadeghi_glint();
    let centres = vec2f(FIBRE_PI, angle);
    let widths = vec2f(sadeghi_widths().w, glint.y);
    var gaussians: vec2f;
    for (var i = 0u; i < 2u; i++) {
        let scale = 0.70710678 / widths[i];
        gaussians[i] = 1.25331414 * widths[i] * (sadeghi_erf((u - centres[i]) * scale) + sadeghi_erf(centres[i] * scale));
    }
    let base = 2.0 * sin(0.5 * u);
    return vec3f(base, gaussians.x, base + glint.x * gaussians.y);
}

// The mean of N′ over the half circle around φ: a part of |φ| below 0 and one above π are folded back.
fn sadeghi_half_circle(phi: f32, angle: f32) -> vec3f {
    let low = phi - FIBRE_HALF_PI;
    let high = phi + FIBRE_HALF_PI;
    var sum = sadeghi_integral(min(high, FIBRE_PI), angle) - sadeghi_integral(max(low, 0.0), angle);
    if low < 0.0 { sum += sadeghi_integral(-low, angle); }
    if high > FIBRE_PI { sum += sadeghi_integral(FIBRE_PI, angle) - sadeghi_integral(FIBRE_TAU - high, angle); }
    return max(sum, vec3f(0.0)) / FIBRE_PI;
}

var<private> sadeghi_roughness: f32;

// Σ_p C_p I_p M_p N_p, M_p wider by `variance` of θ_i + θ_o.
fn sadeghi_sum(pair: FibrePair, n: vec3f, variance: f32, colour: vec3f) -> vec3f {
    let sum_of_angles = pair.theta_i + pair.theta_o;
    var tint = vec3f(1.0);
    var value = vec3f(0.0);
    for (var p = 0u; p < 3u; p++) {
        if !TRANSMITS && p == 1u {
            tint *= colour;
            continue;
        }
        let lobe = sadeghi_lobe(p);
        let width = 2.0 * sadeghi_widths()[p];
        var rough = width;
        if VARIES { rough = 2.0 * clamp(sadeghi_widths()[p] * sadeghi_roughness, 1e-5, 10.0); }
        let wide = sqrt(rough * rough + variance);
        value += lobe.xyz * tint * (width / wide * fibre_gaussian(wide, sum_of_angles - 2.0 * lobe.w) * n[p]);
        tint *= colour;
    }
    return value;
}

fn sadeghi_divisor(pair: FibrePair) -> vec3f {
    if !sadeghi_normalised() { return vec3f(1.0); }
    return max(vec3f(1.0), max(fibre_angle(pair.theta_i, FIBRE_ALBEDO), fibre_angle(pair.theta_o, FIBRE_ALBEDO)));
}

fn scatter(fibre: Fibre, wi: vec3f, wo: vec3f, shadow: ShadowSample) -> vec3f {
    if VARIES { sadeghi_roughness = fibre_roughness(fibre); }
    let pair = fibre_pair(fibre.tangent, wi, wo);
    let angle = sadeghi_glint_angle(fibre);
    let colour = fibre.colour * mix(vec3f(1.0), sadeghi_tip(), fibre.coordinate);
    let factor = fibre_cosine_factor(pair) / sadeghi_divisor(pair);
    let single = factor * sadeghi_sum(pair, sadeghi_azimuthal(pair.phi, angle), 0.0, colour);
    if !FIBRE_DUAL { return shadow.transmittance * single; }

    let back = fibre_back(pair, vec3f(0.0), select(0.0, 1.0, pair.phi < FIBRE_HALF_PI));
    if shadow.fibres <= 0.0 { return shadow.transmittance * (single + back); }
    let forward = fibre_forward(pair.theta_i, shadow.fibres);
    let n = sadeghi_half_circle(pair.phi, angle);
    var spread: vec3f;
    for (var c = 0u; c < 3u; c++) { spread[c] = factor[c] * sadeghi_sum(pair, n, forward.variance[c], colour)[c]; }
    let spread_back = fibre_back(pair, forward.variance, 1.0 - pair.phi / FIBRE_PI);
    return shadow.transmittance * (single + back) + forward.transmittance * (spread + spread_back);
}

fn scatter_uniform(fibre: Fibre, wo: vec3f) -> vec3f {
    return fibre.colour * fibre_angle(fibre_atan2(dot(fibre.tangent, wo), length(cross(fibre.tangent, wo))), FIBRE_UNIFORM);
}
