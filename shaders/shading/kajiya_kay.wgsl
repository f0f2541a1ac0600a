// Kajiya and Kay 1989 (Kim §5, Hunz §3.2): Ψ = k_d sin(t, l) + k_s max(0, sin(t, l) sin(t, e) - (t·l)(t·e))^m, with
// both directions leaving the fibre. The cosine is inside: radiance = Ψ × irradiance on a plane facing the light.

fn kajiya_kay_diffuse() -> vec3f { return material_value(0u).xyz; }
fn kajiya_kay_exponent() -> f32 { return material_value(0u).w; }
fn kajiya_kay_specular() -> vec3f { return material_value(1u).xyz; }
// ∫ cos^(m+1) over the half circle, from the host.
fn kajiya_kay_lobe_width() -> f32 { return material_value(1u).w; }

fn scatter(fibre: Fibre, wi: vec3f, wo: vec3f, shadow: ShadowSample) -> vec3f {
    let cos_l = clamp(dot(fibre.tangent, wi), -1.0, 1.0);
    let cos_e = clamp(dot(fibre.tangent, wo), -1.0, 1.0);
    let sin_l = sqrt(max(1.0 - cos_l * cos_l, 0.0));
    let sin_e = sqrt(max(1.0 - cos_e * cos_e, 0.0));
    let lobe = pow(max(sin_l * sin_e - cos_l * cos_e, 1e-20), kajiya_kay_exponent());
    return shadow.transmittance * (kajiya_kay_diffuse() * fibre.colour * sin_l + kajiya_kay_specular() * lobe);
}

// ∫ Ψ dω over the sphere: k_d π², and for the lobe 2π (cos θ_o W + sin^(m+1) |θ_o| / (m + 1)), W = ∫ cos^(m+1). The
// lobe's own cut at grazing θ_o is left out; that errs by at most k_s 2π / (m + 2), 5 % of the lobe at m = 60.
fn scatter_uniform(fibre: Fibre, wo: vec3f) -> vec3f {
    let sin_theta = abs(clamp(dot(fibre.tangent, wo), -1.0, 1.0));
    let cos_theta = sqrt(1.0 - sin_theta * sin_theta);
    let m = kajiya_kay_exponent();
    let lobe = 6.2831853 * (cos_theta * kajiya_kay_lobe_width() + pow(max(sin_theta, 1e-20), m + 1.0) / (m + 1.0));
    return kajiya_kay_diffuse() * fibre.colour * 9.8696044 + kajiya_kay_specular() * lobe;
}
