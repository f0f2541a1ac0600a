//! What a frame did, and what it cost.

/// Fragments of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Fragments {
    /// Found by the rasteriser within the view's depth range. Segments outside the view or wholly behind the opaque scene
    /// are dropped before, and count nowhere.
    pub produced: u64,
    /// Of these, dropped before they were stored: since they cannot be seen, or since the technique leaves out what it does
    /// not keep.
    pub culled: u64,
    /// Stored one by one.
    pub stored: u64,
    /// Merged into one layer of their pixel: since the pool was too small, or since the technique stores fewer or none.
    pub merged: u64,
}

/// The time of one pass.
#[derive(Debug, Clone, PartialEq)]
pub struct PassTime {
    /// The pass's label, as GPU debuggers show it too.
    pub label: String,
    /// Wall clock from its submission to the GPU's end, in milliseconds.
    pub ms: f64,
}

/// What a frame did, and what the library holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Statistics {
    /// Strands drawn.
    pub strands: u64,
    /// Segments drawn, after curves were cut into straight ones.
    pub segments: u64,
    /// Fragments of the latest frame whose counters have come back.
    pub fragments: Fragments,
    /// Pixels that hold a fragment (counted arrays only; 0 elsewhere).
    pub covered_pixels: u64,
    /// Shadow maps that the latest frame recorded fills: six of a light among the hair, else one a light.
    pub shadow_maps_filled: u64,
    /// Shadow maps that it takes as an earlier frame has filled them; see [`crate::Renderer::set_shadow_reuse`].
    pub shadow_maps_taken: u64,
    /// Bytes of GPU memory held, by label.
    pub bytes: Vec<(String, u64)>,
    /// Sum of `bytes`.
    pub bytes_total: u64,
    /// The largest `bytes_total` so far.
    pub bytes_peak: u64,
    /// Time of each pass; only from a profiled frame.
    pub passes: Vec<PassTime>,
}
