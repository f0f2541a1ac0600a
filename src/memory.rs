//! What a frame will take of the device's memory, before it is recorded.

use std::collections::BTreeMap;

use crate::frame::Target;
use crate::host::offscreen::WantedOutputs;

/// What a frame's memory depends on of what it is drawn into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Viewport {
    /// Pixels in a row of what the view fills.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// An opaque scene's depth hides hair.
    pub depth: bool,
    /// The nearest hair's depth is written.
    pub write_depth: bool,
    /// What else is written.
    pub outputs: WantedOutputs,
    /// Shadow images alone are written ([`Target::shadows_only`]): then there are no pixels' buffers. Those images, like occluders
    /// and a received shadow, take nothing of the renderer's memory.
    pub shadows_only: bool,
}

impl From<&Target<'_>> for Viewport {
    fn from(target: &Target) -> Self {
        let [_, _, width, height] = target.area();
        let outputs = &target.outputs;
        Self {
            width,
            height,
            depth: target.depth.is_some(),
            write_depth: target.write_depth,
            outputs: WantedOutputs {
                nearest_depth: outputs.nearest_depth.is_some(),
                coverage: outputs.coverage.is_some(),
                motion: outputs.motion.is_some(),
                ids: outputs.ids.is_some(),
            },
            shadows_only: target.shadows_only,
        }
    }
}

impl Viewport {
    /// Whether an output takes a record of each point.
    pub(crate) fn tracked(&self) -> bool {
        self.outputs.motion || self.outputs.ids
    }
}

/// GPU memory that a renderer will hold once a frame has been recorded, the host's images left out.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MemoryEstimate {
    /// Bytes by label, as [`crate::Statistics::bytes`] has them: what is held now, all hairs among it, and what the frame adds.
    pub bytes: Vec<(String, u64)>,
    /// Sum of `bytes`.
    pub total: u64,
    /// Of these, what is not held yet; 0 where the frame needs no more than the last ones left.
    pub added: u64,
}

impl MemoryEstimate {
    /// Bytes of all labels that begin so: `"pelage.transparency."` for the transparency technique, `"pelage.shadow."`,
    /// `"pelage.shading."`, `"pelage.geometry."`, `"pelage.raster."`.
    pub fn of(&self, prefix: &str) -> u64 {
        let own = |(label, _): &&(String, u64)| label.starts_with(prefix);
        self.bytes.iter().filter(own).map(|(_, bytes)| bytes).sum()
    }
}

/// Bytes by label while buffers are yet to grow.
pub(crate) struct Forecast {
    by_label: BTreeMap<&'static str, u64>,
    held: u64,
    total: u64,
    budget: Option<u64>,
}

impl Forecast {
    /// Of what is held now.
    pub fn new(by_label: BTreeMap<&'static str, u64>, budget: Option<u64>) -> Self {
        let total = by_label.values().sum();
        Self {
            by_label,
            held: total,
            total,
            budget,
        }
    }

    /// A buffer or image of `before` bytes gives way to one of `after`.
    pub fn replace(&mut self, label: &'static str, before: u64, after: u64) {
        let bytes = self.by_label.entry(label).or_default();
        *bytes = *bytes + after - before;
        self.total = self.total + after - before;
    }

    /// Bytes left within the budget.
    pub fn left(&self) -> u64 {
        let left = |budget: u64| budget.saturating_sub(self.total);
        self.budget.map_or(u64::MAX, left)
    }

    /// What will be held.
    pub fn estimate(self) -> MemoryEstimate {
        let of = |(label, bytes): (&str, u64)| (bytes > 0).then(|| (label.to_owned(), bytes));
        MemoryEstimate {
            total: self.total,
            added: self.total.saturating_sub(self.held),
            bytes: self.by_label.into_iter().filter_map(of).collect(),
        }
    }
}
