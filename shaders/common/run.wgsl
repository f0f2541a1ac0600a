// What the rasterisers read of a run. `transparency/sorted_blending_points` stands in its place where all runs are drawn at once.

@group(1) @binding(0) var<storage, read> projected: array<Projected>;
// First points of the run's segments in the order in which the walk takes them; its last word is their number.
@group(1) @binding(1) var<storage, read> order: array<u32>;

fn projected_point(index: u32) -> Projected {
    return projected[index];
}
