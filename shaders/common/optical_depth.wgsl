// Optical depth Ω = -ln(1 - opacity): sums of it give the exact product of transmittances, exp(-Ω).

// An opaque fibre counts as this much: exp(-16) = 1.1e-7.
const OPTICAL_DEPTH_OPAQUE: f32 = 16.0;
// Steps of the fixed-point sums: 1/65536, so that a sum holds 4,096 opaque fibres before it sticks.
const OPTICAL_DEPTH_SCALE: f32 = 65536.0;

fn optical_depth(opacity: f32) -> f32 {
    return select(OPTICAL_DEPTH_OPAQUE, min(-log(1.0 - opacity), OPTICAL_DEPTH_OPAQUE), opacity < 1.0);
}
