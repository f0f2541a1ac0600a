// The rows that are drawn, in tiles: each an instance, a strip of four vertices. A pass that has nothing to do in a tile leaves it
// out in its vertices: drivers that run on a CPU execute all of a fragment shader, whatever its branches.

struct Tile {
    first: vec2u,
    end: vec2u,
}

// `rows`: the first of the rows that are drawn, and their end.
fn tile(number: u32, rows: vec2u) -> Tile {
    let columns = (frame.width + TILE - 1u) / TILE;
    let first = vec2u(number % columns, number / columns) * TILE + vec2u(0u, rows.x);
    return Tile(first, min(first + TILE, vec2u(frame.width, rows.y)));
}

fn tile_corner(t: Tile, vertex: u32) -> vec4f {
    let corner = vec2f(select(t.first, t.end, vec2<bool>((vertex & 1u) != 0u, vertex >= 2u)));
    let ndc = vec2f(2.0, -2.0) * corner / vec2f(f32(frame.width), f32(frame.height)) + vec2f(-1.0, 1.0);
    return vec4f(ndc, 0.0, 1.0);
}

// A corner of nothing.
const TILE_NOWHERE: vec4f = vec4f(2.0, 2.0, 0.0, 1.0);
