// The hair's shadow on the host's opaque scene: for each pixel with a depth, the part of the light's power that the
// hair lets through to the point behind it, multiplied into the target's colour.
//
// Several lights and the ambient term weigh by their power, which is exact for one light and a white diffuse scene.

@group(1) @binding(0) var<storage, read> host_tiles: array<vec2u>;

// Texels by which a tile is seen from a light wider than it is, for the filter and for rounding.
const RECEIVE_MARGIN: f32 = 4.0;

// Whether the hair's shadow may fall on the opaque scene in a tile: it has depths other than the far plane's, and some of what
// lies between its nearest and its farthest one is within a light's map, beyond the plane where that begins.
fn tile_drawn(t: Tile) -> bool {
    let columns = (frame.width + HOST_TILE - 1u) / HOST_TILE;
    let last = (t.end - 1u) / HOST_TILE;
    let far = depth_key(select(1.0, 0.0, pixels_reverse));
    var nearest = far;
    var farthest = 0u;
    for (var y = t.first.y / HOST_TILE; y <= last.y; y++) {
        for (var x = t.first.x / HOST_TILE; x <= last.x; x++) {
            let keys = host_tiles[y * columns + x];
            if keys.y < far {
                nearest = min(nearest, keys.y);
                farthest = max(farthest, keys.x);
            }
        }
    }
    if nearest >= far { return false; }
    var found = false;
    for (var light = 0u; light < frame.light_count; light++) {
        let first = frame.lights[light].map_first;
        let end = first + frame.lights[light].map_count;
        let reach = 1.0 + 2.0 * (RECEIVE_MARGIN + f32(frame.lights[light].pcf)) / f32(frame.lights[light].resolution);
        for (var map = first; map < end; map++) {
            // What lies on the inner side of a plane of the map's box for any of the corners.
            var inside = vec4<bool>(false);
            var beyond = false;
            for (var corner = 0u; corner < 8u; corner++) {
                let local = vec2f(select(t.first, t.end, vec2<bool>((corner & 1u) != 0u, (corner & 2u) != 0u)));
                let ndc = vec2f(2.0, -2.0) * local / vec2f(f32(frame.width), f32(frame.height)) + vec2f(-1.0, 1.0);
                let depth = depth_of_key(select(nearest, farthest, (corner & 4u) != 0u));
                // Linear all the way, so that what holds for the corners holds for all between them, at infinity too.
                let place = frame.relative_from_clip * vec4f(ndc, depth, 1.0);
                let clip = frame.shadow_views[map].clip_from_relative * place;
                inside = inside | (vec4f(clip.xy, -clip.xy) <= vec4f(reach * clip.w));
                beyond = beyond || dot(frame.shadow_views[map].depth_row, place) > frame.lights[light].bias * place.w;
            }
            found = found || (all(inside) && beyond);
        }
    }
    return found;
}

struct ReceiveVertex {
    @builtin(position) position: vec4f,
    // By way of the vertices, since one software driver compiles a fragment shader anew, at every draw, whose loop ends
    // at a uniform.
    @location(0) @interpolate(flat, either) light_count: u32,
}

@vertex
fn receive_vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> ReceiveVertex {
    pixels_begin();
    let t = tile(number, vec2u(0u, frame.height));
    return ReceiveVertex(select(TILE_NOWHERE, tile_corner(t, vertex), tile_drawn(t)), frame.light_count);
}

@fragment
fn receive(in: ReceiveVertex) -> @location(0) vec4f {
    let pixel = in.position;
    let depth = textureLoad(host_depth, vec2u(pixel.xy), 0);
    let far = select(1.0, 0.0, (frame.flags & FRAME_REVERSE_Z) != 0u);
    if depth == far { discard; }
    let position = host_position(pixel.xy, depth);
    var total = frame.ambient;
    var reached = frame.ambient;
    for (var light = 0u; light < in.light_count; light++) {
        let power = light_reach(light, position).irradiance;
        total += power;
        reached += power * shadow_received(position, light).transmittance;
    }
    return vec4f(select(vec3f(1.0), reached / max(total, vec3f(1e-20)), total > vec3f(0.0)), 1.0);
}
