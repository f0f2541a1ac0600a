//! Maps that a frame takes as an earlier one has filled them: in a viewport the camera moves more often than light or hair.
//!
//! A map is told by all that its passes read: its technique and shape, the uniform blocks of its drawings, and the points of
//! its runs. Nothing of this depends on the view. What was recorded counts only once it is known to have run.

use std::ops::Range;

use super::{Shadow, Shape};
use crate::plan::{Plan, PlannedMap, PlannedRun};
use crate::raster::Rasteriser;

/// What a map's words depend on.
#[derive(Debug)]
struct Content {
    technique: Shadow,
    shape: Shape,
    rasteriser: Rasteriser,
    crosses: bool,
    splits: u32,
    runs: Vec<PlannedRun>,
    /// [`Plan::contents`].
    points: Vec<u64>,
    /// Matrices, opacities, the technique's values, and where the words lie.
    blocks: Vec<u8>,
}

impl Content {
    fn new(plan: &Plan, map: &PlannedMap) -> Self {
        Self {
            technique: map.technique,
            shape: map.shape,
            rasteriser: map.rasteriser,
            crosses: map.crosses,
            splits: map.splits,
            runs: plan.runs.clone(),
            points: plan.contents.clone(),
            blocks: plan.map_blocks(map).to_vec(),
        }
    }

    fn is_of(&self, plan: &Plan, map: &PlannedMap) -> bool {
        self.technique == map.technique
            && self.shape == map.shape
            && self.rasteriser == map.rasteriser
            && self.crosses == map.crosses
            && self.splits == map.splits
            && self.points == plan.contents
            && self.runs == plan.runs
            && self.blocks == plan.map_blocks(map)
    }
}

/// A map in the buffer.
#[derive(Debug)]
struct Held {
    words: Range<u64>,
    content: Content,
    number: u64,
    /// Whether a frame that fills it is known to have run.
    known: bool,
}

/// The maps in the buffer that frames have filled.
#[derive(Debug)]
pub(crate) struct HeldMaps {
    reuse: bool,
    maps: Vec<Held>,
    last: u64,
}

impl Default for HeldMaps {
    fn default() -> Self {
        Self {
            reuse: true,
            maps: Vec::new(),
            last: 0,
        }
    }
}

impl HeldMaps {
    pub fn set_reuse(&mut self, reuse: bool) {
        self.reuse = reuse;
        self.forget();
    }

    /// The buffer is another one.
    pub fn forget(&mut self) {
        self.maps.clear();
    }

    /// Decides which of its maps a frame takes. `fills`: those of the others that later frames may take.
    pub fn take(&mut self, plan: &mut Plan, fills: &mut Vec<u64>) {
        fills.clear();
        if !self.reuse {
            return;
        }
        for at in 0..plan.maps.len() {
            let map = &plan.maps[at];
            let words = map.words.clone();
            let same = |held: &&Held| held.words == words && held.content.is_of(plan, map);
            if let Some(held) = self.maps.iter().find(same) {
                if !held.known {
                    fills.push(held.number);
                }
                plan.maps[at].filled = !held.known;
                continue;
            }
            let beside =
                |held: &Held| held.words.end <= words.start || words.end <= held.words.start;
            self.maps.retain(beside);
            if !plan.landed {
                continue;
            }
            self.last += 1;
            fills.push(self.last);
            self.maps.push(Held {
                content: Content::new(plan, map),
                words,
                number: self.last,
                known: false,
            });
        }
    }

    /// A frame that fills these has run.
    pub fn mark_filled(&mut self, fills: &[u64]) {
        for held in &mut self.maps {
            held.known |= fills.contains(&held.number);
        }
    }
}
