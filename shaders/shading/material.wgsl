// The parameters of the hair that is shaded: the uniform block of its own.

fn material_value(i: u32) -> vec4f { return material.values[i]; }
