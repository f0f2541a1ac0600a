// Strand points → points on the screen or on a light's map: position and half-width in pixels, depth, and the plane
// that parts the two segments of each joint.
//
// The half-width is that of the silhouette: with o = normalize(T × V), T the strand's tangent and V the way to the
// eye, it is the distance of the projection of P + r·o from the projected axis. Written as the exact difference
// r (c_xy - ndc c_w) / (w + r c_w), c = M (o, 0), it does not cancel for fibres of 0.01 px.
//
// The header says whether the near plane may cross the hair's box, CROSSES, and whether what cannot be seen is sought, VIEW:
// drivers that run on a CPU would pay for both wherever they were not.

@group(1) @binding(0) var<storage, read> points: array<Point>;
@group(1) @binding(1) var<storage, read> attributes: array<PointAttributes>;
@group(1) @binding(2) var<storage, read_write> projected_out: array<Projected>;
@group(1) @binding(3) var<storage, read> host_tiles: array<vec2u>;

// Points closer than this on the screen coincide.
const PROJECT_COINCIDENT_PX: f32 = 1e-4;
// How many neighbours are looked at in search of a direction and of an end within a pixel.
const PROJECT_SEARCH: u32 = 64u;

fn project_relative(index: u32) -> vec3f {
    return (drawing.relative_from_object * vec4f(points[index].position, 1.0)).xyz;
}

fn project_clip(position: vec3f) -> vec4f {
    return drawing.clip_from_relative * vec4f(position, 1.0);
}

// Positive in front of the near plane.
fn project_near_distance(clip: vec4f) -> f32 {
    return select(clip.z, clip.w - clip.z, (drawing.flags & DRAWING_REVERSE_Z) != 0u);
}

fn project_pixel(clip: vec4f) -> vec2f {
    let ndc = clip.xy / clip.w;
    return vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * drawing.viewport;
}

fn project_unit(v: vec3f) -> vec3f {
    let size = length(v);
    return select(vec3f(0.0), v / max(size, 1e-30), size > 1e-30);
}

// How far from the point behind it to the one before it a segment crosses the near plane, from 0 to 1.
fn project_crossing(behind: vec3f, before: vec3f) -> f32 {
    let g0 = project_near_distance(project_clip(behind));
    let g1 = project_near_distance(project_clip(before));
    return clamp(g0 / (g0 - g1), 0.0, 1.0);
}

fn project_cut(behind: vec3f, before: vec3f) -> vec3f {
    return mix(behind, before, project_crossing(behind, before));
}

// What one side of a point looks like.
struct ProjectSide {
    // On the screen: unit direction towards the nearest point that tells one; zero where there is none.
    direction: vec2f,
    // Along the strand to its end on the screen, or to a turn as sharp as one, or 1 where that is farther.
    distance: f32,
    // Unit direction towards the next distinct point.
    tangent: vec3f,
}

fn project_side(index: u32, position: vec3f, forward: bool) -> ProjectSide {
    let stop = select(POINT_FIRST, POINT_LAST, forward);
    var side = ProjectSide(vec2f(0.0), 0.0, vec3f(0.0));
    let own = project_pixel(project_clip(position));
    var here = own;
    var last = vec2f(0.0);
    var at = index;
    var measured = false;
    for (var step = 0u; step < PROJECT_SEARCH; step++) {
        if (attributes[at].strand & stop) != 0u { break; }
        at = select(at - 1u, at + 1u, forward);
        var neighbour = project_relative(at);
        if all(side.tangent == vec3f(0.0)) { side.tangent = project_unit(neighbour - position); }
        if !measured {
            var cut = false;
            if CROSSES {
                cut = project_near_distance(project_clip(neighbour)) < 0.0;
                if cut { neighbour = project_cut(neighbour, position); }
            }
            let there = project_pixel(project_clip(neighbour));
            let offset = there - here;
            let distance = length(offset);
            if all(side.direction == vec2f(0.0)) {
                let way = there - own;
                if length(way) > PROJECTED_DIRECTION_PX { side.direction = normalize(way); }
            }
            let tells = distance > PROJECTED_DIRECTION_PX;
            let unit = select(last, offset / distance, tells);
            let turned = dot(last, unit) < -0.5;
            last = unit;
            if !turned { side.distance += distance; }
            measured = turned || cut || side.distance >= 1.0;
            // Points that coincide are measured from the last distinct one.
            if distance > PROJECT_COINCIDENT_PX { here = there; } else if !measured { side.distance -= distance; }
        }
        if measured && any(side.tangent != vec3f(0.0)) { break; }
    }
    side.distance = min(side.distance, 1.0);
    return side;
}

fn project_depth(position: vec3f, clip: vec4f) -> f32 {
    let depth = dot(drawing.depth_row, vec4f(position, 1.0));
    return select(depth, depth / clip.w, (drawing.flags & DRAWING_DEPTH_OVER_W) != 0u);
}

// Segments over more tiles than this are not looked up.
const PROJECT_TILES: u32 = 64u;

// What is known of the whole segment to the next point: whether it crosses the near plane or lies outside the image, the
// host's tiles that it may touch, and the range of its depth.
struct ProjectReach {
    known: bool,
    outside: bool,
    // The tiles that hold its box.
    first: vec2u,
    last: vec2u,
    nearest: u32,
    farthest: u32,
    // Its ends in pixels, and how far from the line between them it can touch a pixel.
    start: vec2f,
    end: vec2f,
    reach: f32,
}

fn project_reach(here: Projected, next: vec3f, next_radius: f32) -> ProjectReach {
    var found = ProjectReach(false, false, vec2u(0u), vec2u(0u), 0u, 0u, vec2f(0.0), vec2f(0.0), 0.0);
    let clip = project_clip(next);
    if project_near_distance(clip) < 0.0 || clip.w <= 0.0 { return found; }
    let there = project_pixel(clip);
    // A sphere of the radius at the next point: its centre's shift on the screen has at most these rows' lengths, twice
    // over where the sphere is close to the eye; and the footprint's skirt.
    let m = drawing.clip_from_relative;
    let rows = vec2f(length(vec3f(m[0].x, m[1].x, m[2].x)), length(vec3f(m[0].y, m[1].y, m[2].y)));
    let row_w = length(vec3f(m[0].w, m[1].w, m[2].w));
    let radius = next_radius * drawing.radius_scale;
    let ndc = abs(clip.xy / clip.w);
    let shift = 0.5 * drawing.viewport * (rows + ndc * row_w) * radius / max(clip.w - radius * row_w, 0.5 * clip.w);
    let reach = max(here.depth_width.y, max(shift.x, shift.y)) + 1.0;
    let low = min(here.position, there) - reach;
    let high = max(here.position, there) + reach;
    found.known = true;
    found.start = here.position;
    found.end = there;
    found.reach = reach;
    found.outside = any(high < vec2f(0.0)) || any(low > drawing.viewport);
    found.first = vec2u(clamp(low, vec2f(0.0), drawing.viewport - 1.0)) / HOST_TILE;
    found.last = vec2u(clamp(high, vec2f(0.0), drawing.viewport - 1.0)) / HOST_TILE;
    let keys = vec2u(depth_key(here.depth_width.x), depth_key(project_depth(next, clip)));
    found.nearest = min(keys.x, keys.y);
    found.farthest = max(keys.x, keys.y);
    return found;
}

// How a segment's tiles are visited: in steps along the axis on which it covers more of them, and at each step those of its box
// that the line, as wide as it is, may touch.
struct ProjectWay {
    steep: bool,
    first: vec2u,
    last: vec2u,
    start: vec2f,
    slope: f32,
    extent: f32,
}

fn project_way(found: ProjectReach) -> ProjectWay {
    let way = found.end - found.start;
    var w: ProjectWay;
    w.steep = abs(way.y) > abs(way.x);
    w.first = select(found.first.xy, found.first.yx, w.steep);
    w.last = select(found.last.xy, found.last.yx, w.steep);
    w.start = select(found.start.xy, found.start.yx, w.steep);
    let along = select(way.xy, way.yx, w.steep);
    w.slope = select(along.y / along.x, 0.0, along.x == 0.0);
    // The line's distance from a point along the minor axis, for a distance of `reach` across it: at most √2 times as much. And
    // half a tile's change, and a little for rounding.
    w.extent = 1.4143 * found.reach + 0.5 * f32(HOST_TILE) * abs(w.slope) + 0.01;
    return w;
}

// The first and the last tile of a step, across.
fn project_step(w: ProjectWay, major: u32) -> vec2u {
    let middle = w.start.y + ((f32(major) + 0.5) * f32(HOST_TILE) - w.start.x) * w.slope;
    let bounds = clamp(vec2f(middle - w.extent, middle + w.extent), vec2f(0.0), vec2f(1e6));
    return clamp(vec2u(bounds) / HOST_TILE, vec2u(w.first.y), vec2u(w.last.y));
}

// PROJECTED_UNSEEN, PROJECTED_IN_FRONT, or neither.
fn project_visibility(found: ProjectReach) -> u32 {
    if !found.known { return 0u; }
    if found.outside { return PROJECTED_UNSEEN; }
    if (drawing.flags & DRAWING_HOST_DEPTH) == 0u { return PROJECTED_IN_FRONT; }
    let size = found.last - found.first + 1u;
    if size.x * size.y > PROJECT_TILES { return 0u; }
    let way = project_way(found);
    let columns = (u32(drawing.viewport.x) + HOST_TILE - 1u) / HOST_TILE;
    var hidden = true;
    var in_front = true;
    for (var major = way.first.x; major <= way.last.x; major++) {
        let minors = project_step(way, major);
        for (var minor = minors.x; minor <= minors.y; minor++) {
            let place = select(minor * columns + major, major * columns + minor, way.steep);
            let tile = host_tiles[place];
            hidden = hidden && found.nearest > tile.x;
            in_front = in_front && found.farthest < tile.y;
        }
    }
    return select(select(0u, PROJECTED_IN_FRONT, in_front), PROJECTED_UNSEEN, hidden);
}

// The crossing of a point's last segment, where its own place holds the following one's, is packed within a range well
// outside the image: this part of the way from the segment's other end to the crossing lies within it.
fn project_second_part(other: vec2f, cut: vec2f) -> f32 {
    let range = PROJECTED_SECOND_RANGE * max(drawing.viewport.x, drawing.viewport.y);
    let way = cut - other;
    let room = (vec2f(range) - sign(way) * other) / max(abs(way), vec2f(1e-6));
    return clamp(min(room.x, room.y), 0.0, 1.0);
}

// Projected tangents shorter than this part of the projected radius have no direction that single precision tells.
const PROJECT_DEGENERATE_TANGENT: f32 = 1e-4;

// Half a fibre's width in pixels at a position before the near plane: how far the silhouette lies from the axis, across the
// projected tangent. Not across the bisector of the segments on the screen, which foreshortening turns.
fn project_half_width(position: vec3f, tangent: vec3f, radius: f32) -> f32 {
    let clip = project_clip(position);
    let outwards = project_unit(cross(tangent, drawing.eye.xyz - position * drawing.eye.w));
    if all(outwards == vec3f(0.0)) || clip.w <= 0.0 { return 0.0; }
    let scaled = radius * drawing.radius_scale;
    var c = drawing.clip_from_relative * vec4f(outwards * scaled, 0.0);
    // Either silhouette will do; one of them is before the eye.
    c = select(c, -c, clip.w + c.w <= 0.0);
    let ndc = clip.xy / clip.w;
    let offset = (c.xy - ndc * c.w) / (clip.w + c.w) * 0.5 * drawing.viewport;
    let a = drawing.clip_from_relative * vec4f(project_unit(tangent) * scaled, 0.0);
    let along = (a.xy - ndc * a.w) / clip.w * 0.5 * drawing.viewport;
    if length(along) <= PROJECT_DEGENERATE_TANGENT * length(offset) { return length(offset); }
    return abs(offset.x * along.y - offset.y * along.x) / length(along);
}

@compute @workgroup_size(64)
fn project(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    pixels_begin();
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= drawing.point_count { return; }
    let strand = attributes[index].strand;
    let is_first = (strand & POINT_FIRST) != 0u;
    let is_last = (strand & POINT_LAST) != 0u;
    var flags = select(0u, PROJECTED_FIRST, is_first) | select(0u, PROJECTED_LAST, is_last);
    var position = project_relative(index);
    var radius = points[index].radius;
    var tangent = vec3f(0.0);
    var second = 0u;
    var second_half_width = 0.0;

    // Behind the near plane the point stands for the crossings of its segments: the following one's in its own place,
    // the last one's there too, or else beside it.
    let exact = position;
    let limit = f32(PROJECTED_DISTANCE_MAX);
    if project_near_distance(project_clip(exact)) < 0.0 {
        flags |= PROJECTED_BEHIND;
        if CROSSES {
            if !is_last {
                let next = project_relative(index + 1u);
                if project_near_distance(project_clip(next)) >= 0.0 {
                    position = project_cut(exact, next);
                    tangent = project_unit(next - exact);
                    radius = mix(radius, points[index + 1u].radius, project_crossing(exact, next));
                    flags |= PROJECTED_CUT_START | u32(project_crossing(exact, next) * limit + 0.5);
                }
            }
            if !is_first {
                let previous = project_relative(index - 1u);
                if project_near_distance(project_clip(previous)) >= 0.0 {
                    let cut = project_cut(exact, previous);
                    let crossing = project_crossing(exact, previous);
                    let cut_radius = mix(points[index].radius, points[index - 1u].radius, crossing);
                    var along = 1.0 - crossing;
                    if (flags & PROJECTED_CUT_START) == 0u {
                        position = cut;
                        tangent = project_unit(exact - previous);
                        radius = cut_radius;
                    } else {
                        let from_pixel = project_pixel(project_clip(previous));
                        let to_pixel = project_pixel(project_clip(cut));
                        let part = project_second_part(from_pixel, to_pixel);
                        let range = PROJECTED_SECOND_RANGE * max(drawing.viewport.x, drawing.viewport.y);
                        let unit = project_unit(exact - previous);
                        let from_half_width = project_half_width(previous, unit, points[index - 1u].radius);
                        let to_half_width = project_half_width(cut, unit, cut_radius);
                        second = pack2x16snorm(mix(from_pixel, to_pixel, part) / range);
                        second_half_width = mix(from_half_width, to_half_width, part);
                        along *= part;
                    }
                    flags |= PROJECTED_CUT_END | (u32(along * limit + 0.5) << PROJECTED_DISTANCE_BITS);
                }
            }
        }
    }

    var before = ProjectSide(vec2f(0.0), 0.0, vec3f(0.0));
    var after = ProjectSide(vec2f(0.0), 0.0, vec3f(0.0));
    if (flags & PROJECTED_CUT_START) == 0u { before = project_side(index, position, false); }
    if (flags & PROJECTED_CUT_END) == 0u { after = project_side(index, position, true); }
    // Both directions lead away from the point: a straight strand has -1 here, a turn of more than 120° above ½.
    if dot(before.direction, after.direction) > 0.5 { flags |= PROJECTED_BREAK; }
    // A strand shorter than what tells a direction covers nothing. Where the near plane cuts, directions are not asked for.
    if (flags & PROJECTED_BEHIND) == 0u && all(before.direction == vec2f(0.0)) && all(after.direction == vec2f(0.0)) {
        flags |= PROJECTED_UNSEEN;
    }
    let sum = after.direction - before.direction;
    let bisector = select(vec2f(1.0, 0.0), sum / max(length(sum), 1e-12), dot(sum, sum) > 1e-8);

    // The strand's tangent in relative space: the sum of its segments' unit directions.
    if (flags & PROJECTED_BEHIND) == 0u {
        tangent = after.tangent - before.tangent;
        // Where the strand folds back upon itself, the segment before says which way it leads.
        if dot(tangent, tangent) < 1e-10 { tangent = before.tangent; }
    }
    let clip = project_clip(position);
    let half_width = project_half_width(position, tangent, radius);
    let here = Projected(project_pixel(clip), vec2f(project_depth(position, clip), half_width), vec2u(0u));
    let twice = (flags & PROJECTED_CUT_START) != 0u && (flags & PROJECTED_CUT_END) != 0u;
    let depth = select(here.depth_width.x, second_half_width, twice);
    if VIEW && !is_last && (flags & PROJECTED_BEHIND) == 0u {
        let next = project_relative(index + 1u);
        flags |= project_visibility(project_reach(here, next, points[index + 1u].radius));
    }
    var word = pack2x16snorm(bisector);
    if (flags & PROJECTED_BEHIND) == 0u {
        flags |= u32(before.distance * limit + 0.5) << PROJECTED_DISTANCE_BITS;
        flags |= u32(after.distance * limit + 0.5);
    } else if twice {
        word = second;
    }
    projected_out[index] = Projected(here.position, vec2f(depth, half_width), vec2u(word, flags));
}
