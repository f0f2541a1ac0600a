// What an optical depth leaves of grey light.

fn shadow_passed(optical_depth: f32, map: u32) -> ShadowTexel {
    return ShadowTexel(vec3f(exp(-optical_depth)), optical_depth);
}
