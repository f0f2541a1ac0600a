// DBK-buffer: segments that lie behind the cut-off of every pixel that they may touch are dropped whole, and their points
// need not be shaded.

@compute @workgroup_size(64)
fn dbk_buffer_drop(@builtin(global_invocation_id) invocation: vec3u, @builtin(num_workgroups) groups: vec3u) {
    pixels_begin();
    let index = invocation.x + invocation.y * groups.x * 64u;
    if index >= drawing.point_count { return; }
    let here = projected_out[index];
    if (here.bisector_flags.y & (PROJECTED_LAST | PROJECTED_BEHIND | PROJECTED_UNSEEN)) != 0u { return; }
    let found = project_reach(here, project_relative(index + 1u), points[index + 1u].radius);
    let size = found.last - found.first + 1u;
    if !found.known || size.x * size.y > PROJECT_TILES { return; }
    let columns = (u32(drawing.viewport.x) + HOST_TILE - 1u) / HOST_TILE;
    var hidden = true;
    let way = project_way(found);
    for (var major = way.first.x; major <= way.last.x && hidden; major++) {
        let minors = project_step(way, major);
        for (var minor = minors.x; minor <= minors.y && hidden; minor++) {
            let place = select(minor * columns + major, major * columns + minor, way.steep);
            hidden = found.nearest > host_tiles[place].x;
        }
    }
    if hidden { projected_out[index].bisector_flags.y = here.bisector_flags.y | PROJECTED_UNSEEN; }
}
