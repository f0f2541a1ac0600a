//! AMD TressFX `.tfx` files, versions 3 and 4 (<https://github.com/GPUOpen-Effects/TressFX>, MIT).
//!
//! Every strand of a file has the same number of vertices. Version 3: a header of 36 words (version f32, guides,
//! vertices a strand, follow hairs a guide, both ends fixed, 31 reserved) and a table of 64-bit offsets, the first of
//! them to the positions (3 f32 each). Version 4: version f32, strands, vertices a strand, then 32-bit offsets, the first
//! of them to the positions (4 f32 each, of which the last is the inverse mass). All little-endian.

use super::bytes::{Bytes, vectors};
use crate::error::Result;
use crate::groom::Strands;

/// Byte of the 64-bit offset to the positions in version 3.
const POSITIONS_AT_V3: u64 = 144;

/// Byte of the 32-bit offset to the positions in version 4.
const POSITIONS_AT_V4: u64 = 12;

/// Size of the header of version 4.
const HEADER_BYTES_V4: u64 = 160;

/// A tip's radius over the root's.
const TIP_TAPER: f32 = 0.5;

/// Whether `version` is one that [`read_tfx`] knows.
pub(super) fn is_version(version: f32) -> bool {
    (3.0..5.0).contains(&version)
}

/// Reads strands from the bytes of a `.tfx` file of version 3 or 4.
///
/// The format holds no radius: strands get [`Strands::fitting_radius`] at the root and half of it at the tip. Texture
/// coordinates, thickness factors and vertex colours are passed over, and follow hairs are not made (see
/// [`interpolate_clumps`](crate::groom::interpolate_clumps)).
///
/// # Errors
/// [`InvalidFile`](crate::Error::InvalidFile): an unknown version, bytes that are missing, no vertices a strand, a
/// position that is not finite.
pub fn read_tfx(bytes: &[u8]) -> Result<Strands> {
    let file = Bytes::new(bytes, "TressFX");
    let version = file.f32(0, "version")?;
    if !is_version(version) {
        return file.error(format_args!("version {version} is not known; 3 and 4 are"));
    }
    let strand_count = file.u32(4, "strand count")?;
    let each = file.u32(8, "vertices a strand")?;
    if each == 0 {
        return file.error("0 vertices a strand; a strand has at least one");
    }
    let (first, header_end, stride) = if version < 4.0 {
        (
            file.u64(POSITIONS_AT_V3, "offset to positions")?,
            POSITIONS_AT_V3 + 8,
            12,
        )
    } else {
        (
            u64::from(file.u32(POSITIONS_AT_V4, "offset to positions")?),
            HEADER_BYTES_V4,
            16,
        )
    };
    if first < header_end {
        return file.error(format_args!(
            "the positions at byte {first} lie in the header"
        ));
    }
    let vertices = u64::from(strand_count) * u64::from(each);
    let positions = vectors(
        file.array(first, vertices, stride, "positions")?,
        stride as usize,
    );
    let counts = vec![each; strand_count as usize];
    let strands = file.blame(Strands::new(positions, &counts, 0.0))?;
    let radius = strands.fitting_radius();
    file.blame(strands.with_root_tip_radii(radius, TIP_TAPER * radius))
}
