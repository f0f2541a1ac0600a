// A point of a strand, as every shading model sees it.

struct Fibre {
    // Unit, from root to tip, in relative space.
    tangent: vec3f,
    // The strand's colour factor.
    colour: vec3f,
    // Root-to-tip coordinate.
    coordinate: f32,
    strand: u32,
}
