// Bind group 0: what every pass of a frame sees.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> drawing: Drawing;
@group(0) @binding(2) var<uniform> material: Material;
@group(0) @binding(3) var host_depth: texture_depth_2d;
