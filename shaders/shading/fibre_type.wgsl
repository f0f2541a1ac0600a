// A point of a strand, as every shading model sees it.

struct Fibre {
    // Unit, from root to tip, in relative space.
    tangent: vec3f,
    // The strand's colour factor.
    colour: vec3f,
    // Root-to-tip coordinate.
    coordinate: f32,
    strand: u32,
    // The part of the fibre's width that is seen, from -1 to 1 across it; `NEAR` says whether a model asks.
    across: vec2f,
}
