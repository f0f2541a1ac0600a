// What an optical depth leaves of the light where fibres pass a part of each channel on: it counts by the rest of that.

fn shadow_passed(optical_depth: f32, map: u32) -> ShadowTexel {
    return ShadowTexel(exp(-optical_depth * frame.shadow_views[map].colour.xyz), optical_depth);
}
