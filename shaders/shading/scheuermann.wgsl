// Scheuermann 2004 (Hunz §3.2): Kajiya-Kay with two highlights,
// k_d sin(t, l) + Σ_j k_j max(0, sin(t_j, l) sin(t_j, e) - (t_j·l)(t_j·e))^m_j, t_j = normalise(t + shift_j n), n the part of
// the view's direction perpendicular to the tangent. The cosine is inside.

fn scheuermann_diffuse() -> vec3f { return material_value(0u).xyz; }
// Colour and exponent.
fn scheuermann_highlight(j: u32) -> vec4f { return material_value(1u + j); }
fn scheuermann_shift(j: u32) -> f32 { return material_value(3u)[j]; }
// ∫ cos^(m+1) over the half circle, from the host.
fn scheuermann_lobe_width(j: u32) -> f32 { return material_value(3u)[2u + j]; }

// Sines are lengths of cross products, which keep their digits where directions are parallel.
fn scheuermann_lobe(tangent: vec3f, wi: vec3f, wo: vec3f, exponent: f32) -> f32 {
    let sin_l = length(cross(tangent, wi));
    let sin_e = length(cross(tangent, wo));
    return pow(clamp(sin_l * sin_e - dot(tangent, wi) * dot(tangent, wo), 1e-20, 1.0), exponent);
}

fn scatter(fibre: Fibre, wi: vec3f, wo: vec3f, shadow: ShadowSample) -> vec3f {
    let across = wo - fibre.tangent * dot(fibre.tangent, wo);
    let size = length(across);
    // A view along the tangent has no normal: the highlights are not shifted.
    let normal = select(vec3f(0.0), across / max(size, 1e-20), size > 1e-6);
    var value = scheuermann_diffuse() * fibre.colour * length(cross(fibre.tangent, wi));
    for (var j = 0u; j < 2u; j++) {
        let highlight = scheuermann_highlight(j);
        let tangent = normalize(fibre.tangent + normal * scheuermann_shift(j));
        // The second highlight has passed through the fibre, and has the strand's colour.
        let colour = select(highlight.xyz * fibre.colour, highlight.xyz, j == 0u);
        value += colour * scheuermann_lobe(tangent, wi, wo, highlight.w);
    }
    return shadow.transmittance * value;
}

// ∫ over all lights: k_d π² and 2π k_j (cos θ W + sin^(m+1) |θ| / (m + 1)) with θ the view's inclination to the turned tangent,
// as for Kajiya-Kay. The turn moves θ by atan(shift).
fn scatter_uniform(fibre: Fibre, wo: vec3f) -> vec3f {
    let sin_theta = clamp(dot(fibre.tangent, wo), -1.0, 1.0);
    let cos_theta = length(cross(fibre.tangent, wo));
    var value = scheuermann_diffuse() * fibre.colour * 9.8696044;
    for (var j = 0u; j < 2u; j++) {
        let highlight = scheuermann_highlight(j);
        let shift = select(0.0, scheuermann_shift(j), cos_theta > 1e-6);
        let length_of = sqrt(1.0 + shift * shift);
        let s = abs(sin_theta + shift * cos_theta) / length_of;
        let c = abs(cos_theta - shift * sin_theta) / length_of;
        let m = highlight.w;
        let colour = select(highlight.xyz * fibre.colour, highlight.xyz, j == 0u);
        value += colour * 6.2831853 * (c * scheuermann_lobe_width(j) + pow(max(min(s, 1.0), 1e-20), m + 1.0) / (m + 1.0));
    }
    return value;
}
