//! What frames did and cost, and the memory held.

use std::ffi::c_char;

use super::descriptor::{self, descriptor};
use super::error::{PelageResult, guard};
use super::input::{self, output, outputs};
use super::registry::PelageContext;
use crate::error::{Result, invalid};
use crate::statistics::Statistics;

/// What a frame did, and what a context holds.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageStatistics {
    /// `sizeof(PelageStatistics)`.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// Strands drawn by the latest frame.
    pub strands: u64,
    /// Segments drawn by the latest frame, after curves were cut into straight ones.
    pub segments: u64,
    /// Fragments that the rasteriser found within the view's depth range, like all counts of fragments below of the latest
    /// frame whose counters have come back: after `pelage_wait`, the latest.
    pub fragments_produced: u64,
    /// Of these, dropped before they were stored: since they cannot be seen, or since the technique leaves out what it does
    /// not keep.
    pub fragments_culled: u64,
    /// Stored one by one.
    pub fragments_stored: u64,
    /// Merged into one layer of their pixel: since the pool was too small, or since the technique stores fewer or none.
    pub fragments_merged: u64,
    /// Pixels that hold a fragment; counted arrays only, 0 elsewhere.
    pub covered_pixels: u64,
    /// Bytes of GPU memory that the context holds beside its targets.
    pub bytes_total: u64,
    /// The largest `bytes_total` so far.
    pub bytes_peak: u64,
    /// Shadow maps that the latest frame fills: six of a light among the hair, else one a light.
    pub shadow_maps_filled: u64,
    /// Shadow maps that it takes as an earlier frame has filled them; see `pelage_context_set_shadow_reuse`.
    pub shadow_maps_taken: u64,
}

impl Default for PelageStatistics {
    fn default() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            reserved: 0,
            strands: 0,
            segments: 0,
            fragments_produced: 0,
            fragments_culled: 0,
            fragments_stored: 0,
            fragments_merged: 0,
            covered_pixels: 0,
            bytes_total: 0,
            bytes_peak: 0,
            shadow_maps_filled: 0,
            shadow_maps_taken: 0,
        }
    }
}

descriptor!(PelageStatistics, "PELAGE_STATISTICS_INIT", shadow_maps_taken: u64);

/// Bytes of a label, its NUL included.
pub const PELAGE_LABEL_SIZE: usize = 96;

/// GPU memory held under one label. Never grows.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelageLabelBytes {
    /// What the memory is for, ended by a NUL.
    pub label: [c_char; PELAGE_LABEL_SIZE],
    /// Bytes.
    pub bytes: u64,
}

/// The time of one pass. Never grows.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct PelagePassTime {
    /// The pass's label, as GPU debuggers show it too, ended by a NUL.
    pub label: [c_char; PELAGE_LABEL_SIZE],
    /// Milliseconds from its submission to the GPU's end.
    pub ms: f64,
}

/// Says what the latest frame did, and what the context holds, in `*statistics`, begun with `PELAGE_STATISTICS_INIT`.
/// Does not wait.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_statistics(
    context: PelageContext,
    statistics: *mut PelageStatistics,
) -> PelageResult {
    guard(|| {
        let now = statistics_of(context)?;
        let value = PelageStatistics {
            strands: now.strands,
            segments: now.segments,
            fragments_produced: now.fragments.produced,
            fragments_culled: now.fragments.culled,
            fragments_stored: now.fragments.stored,
            fragments_merged: now.fragments.merged,
            covered_pixels: now.covered_pixels,
            bytes_total: now.bytes_total,
            bytes_peak: now.bytes_peak,
            shadow_maps_filled: now.shadow_maps_filled,
            shadow_maps_taken: now.shadow_maps_taken,
            ..Default::default()
        };
        // SAFETY: the rule of the module `capi`.
        unsafe { descriptor::write("statistics", statistics, &value) }
    })
}

/// Lists the GPU memory that a context holds beside its targets, by label: fills at most `capacity` entries and sets
/// `*count` to how many there are. `entries` may be NULL if `capacity` is 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_bytes_by_label(
    context: PelageContext,
    capacity: u64,
    entries: *mut PelageLabelBytes,
    count: *mut u64,
) -> PelageResult {
    guard(|| {
        let bytes = statistics_of(context)?.bytes;
        let list = bytes.iter().map(|(label, bytes)| PelageLabelBytes {
            label: label_of(label),
            bytes: *bytes,
        });
        // SAFETY: the rule of the module `capi`.
        unsafe { fill(list, capacity, entries, count) }
    })
}

/// Lists the passes of a context's latest `pelage_render_timed`, in their order: fills at most `capacity` entries and sets
/// `*count` to how many there are, 0 if there was no such frame. `entries` may be NULL if `capacity` is 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_pass_times(
    context: PelageContext,
    capacity: u64,
    entries: *mut PelagePassTime,
    count: *mut u64,
) -> PelageResult {
    guard(|| {
        let passes = context.with(|state| Ok(state.passes.clone()))?;
        let list = passes.iter().map(|pass| PelagePassTime {
            label: label_of(&pass.label),
            ms: pass.ms,
        });
        // SAFETY: the rule of the module `capi`.
        unsafe { fill(list, capacity, entries, count) }
    })
}

fn statistics_of(context: PelageContext) -> Result<Statistics> {
    context.with(|state| {
        state
            .host
            .with_renderer(|renderer| Ok(renderer.statistics()))
    })
}

/// Writes a list into a host's array.
unsafe fn fill<T>(
    list: impl ExactSizeIterator<Item = T>,
    capacity: u64,
    entries: *mut T,
    count: *mut u64,
) -> Result<()> {
    // SAFETY: the rule of the module `capi`.
    let count = unsafe { output("count", count) }?;
    if capacity > 0 && entries.is_null() {
        return invalid!("entries is NULL, but its capacity is {capacity}");
    }
    let length = list.len();
    let room = usize::try_from(capacity).unwrap_or(usize::MAX).min(length);
    // SAFETY: the rule of the module `capi`; `room` is at most the host's capacity.
    let out = unsafe { outputs("entries", entries, room) }?;
    input::fill(out, list);
    count.write(length as u64);
    Ok(())
}

fn label_of(label: &str) -> [c_char; PELAGE_LABEL_SIZE] {
    let mut out = [0; PELAGE_LABEL_SIZE];
    copy_text(label, &mut out);
    out
}

/// Copies text, cut off at a character's end where it is too long, and ends it by a NUL.
pub(super) fn copy_text(text: &str, out: &mut [c_char]) {
    let mut end = text.len().min(out.len().saturating_sub(1));
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    out.fill(0);
    out.iter_mut()
        .zip(&text.as_bytes()[..end])
        .for_each(|(to, from)| *to = *from as c_char);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_that_is_too_long_ends_at_a_whole_character() {
        let mut out = [1 as c_char; 4];
        copy_text("aéé", &mut out);
        assert_eq!(out.map(|c| c as u8), [b'a', 0xc3, 0xa9, 0]);
    }
}
