// The same where no hair shadows anything.

@fragment
fn shadow_image_none() -> @location(0) vec4f {
    return vec4f(1.0);
}
