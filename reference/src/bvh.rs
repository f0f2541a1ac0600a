//! A hierarchy of boxes, to find which of many small things a ray may touch.
//!
//! A complete binary tree: node k's children are 2k + 1 and 2k + 2, each holds half of its items, split at the median of
//! their centres along the axis in which these spread most; so a node's range follows from its place, and only boxes are
//! stored.

use glam::DVec3;
use rayon::prelude::*;

/// Leaves hold no more items than this.
const LEAF_ITEMS: usize = 4;

/// Nodes with fewer items than this are built by one thread.
const ITEMS_PER_TASK: usize = 4096;

/// Deeper than any tree that fits in memory.
const STACK: usize = 64;

/// An axis-aligned box.
#[derive(Clone, Copy)]
pub(crate) struct Aabb {
    pub min: DVec3,
    pub max: DVec3,
}

impl Aabb {
    const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

/// A ray from `origin`, up to `length` (which may be infinite) along the unit vector `direction`.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
    pub length: f64,
}

/// The hierarchy over items 0..n.
pub(crate) struct Bvh {
    order: Vec<u32>,
    boxes: Vec<Aabb>,
    leaf_depth: u32,
}

/// Orders items so that each node's lie together.
fn split(order: &mut [u32], boxes: &[Aabb], levels: u32) {
    if levels == 0 {
        return;
    }
    // Twice the centre serves as well as the centre.
    let centre = |&item: &u32| boxes[item as usize].min + boxes[item as usize].max;
    let spread = order
        .iter()
        .map(centre)
        .fold(Aabb::EMPTY, |all, c| all.union(Aabb { min: c, max: c }));
    let extent = spread.max - spread.min;
    let axis = (0..3).fold(0, |widest, axis| {
        if extent[axis] > extent[widest] {
            axis
        } else {
            widest
        }
    });

    let middle = order.len() / 2;
    // The item's own number decides ties, so that the tree is the same on every run.
    order.select_nth_unstable_by(middle, |a, b| {
        centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(b))
    });
    let (low, high) = order.split_at_mut(middle);
    if low.len() + high.len() < ITEMS_PER_TASK {
        split(low, boxes, levels - 1);
        split(high, boxes, levels - 1);
    } else {
        rayon::join(
            || split(low, boxes, levels - 1),
            || split(high, boxes, levels - 1),
        );
    }
}

impl Bvh {
    /// Builds the hierarchy over items whose boxes are given.
    pub fn new(items: &[Aabb]) -> Self {
        let mut leaf_depth = 0;
        while items.len() >> leaf_depth > LEAF_ITEMS {
            leaf_depth += 1;
        }
        let mut order: Vec<u32> = (0..items.len() as u32).collect();
        split(&mut order, items, leaf_depth);

        // Leaves first, each from its own range, then each level from the one below.
        let first_leaf = (1usize << leaf_depth) - 1;
        let mut boxes = vec![Aabb::EMPTY; 2 * first_leaf + 1];
        boxes[first_leaf..]
            .par_iter_mut()
            .enumerate()
            .with_min_len(1024)
            .for_each(|(leaf, bounds)| {
                let (start, end) = leaf_range(leaf, leaf_depth, items.len());
                *bounds = order[start..end]
                    .iter()
                    .fold(Aabb::EMPTY, |all, &item| all.union(items[item as usize]));
            });
        for node in (0..first_leaf).rev() {
            boxes[node] = boxes[2 * node + 1].union(boxes[2 * node + 2]);
        }
        Self {
            order,
            boxes,
            leaf_depth,
        }
    }

    /// The items in the order in which `visit_ranges` counts them.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Calls `visit` with every range of ordered items whose box the ray meets.
    pub fn visit_ranges(&self, ray: &Ray, mut visit: impl FnMut(std::ops::Range<usize>)) {
        let inverse = ray.direction.recip();
        let mut stack = [(0usize, 0usize, 0usize); STACK];
        stack[0] = (0, 0, self.order.len());
        let mut top = 1;
        let first_leaf = (1usize << self.leaf_depth) - 1;
        while top > 0 {
            top -= 1;
            let (node, start, end) = stack[top];
            if !meets(&self.boxes[node], ray, inverse) {
                continue;
            }
            if node >= first_leaf {
                visit(start..end);
                continue;
            }
            let middle = start + (end - start) / 2;
            stack[top] = (2 * node + 2, middle, end);
            stack[top + 1] = (2 * node + 1, start, middle);
            top += 2;
        }
    }
}

/// The ordered items of a leaf: the same halving as `split`'s.
fn leaf_range(leaf: usize, leaf_depth: u32, items: usize) -> (usize, usize) {
    let [mut start, mut end] = [0, items];
    for level in (0..leaf_depth).rev() {
        let middle = start + (end - start) / 2;
        if leaf >> level & 1 == 0 {
            end = middle
        } else {
            start = middle
        }
    }
    (start, end)
}

/// Whether a ray meets a box (slabs; Kay and Kajiya, *Ray Tracing Complex Scenes*, 1986).
fn meets(bounds: &Aabb, ray: &Ray, inverse: DVec3) -> bool {
    let [mut near, mut far] = [0.0_f64, ray.length];
    for axis in 0..3 {
        if ray.direction[axis] == 0.0 {
            // 0 · ∞ has no value; such a ray is inside the slab throughout or not at all.
            if ray.origin[axis] < bounds.min[axis] || ray.origin[axis] > bounds.max[axis] {
                return false;
            }
            continue;
        }
        let a = (bounds.min[axis] - ray.origin[axis]) * inverse[axis];
        let b = (bounds.max[axis] - ray.origin[axis]) * inverse[axis];
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    near <= far
}
