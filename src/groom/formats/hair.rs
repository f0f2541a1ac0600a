//! Cem Yuksel's binary `.hair` files (<http://www.cemyuksel.com/research/hairmodels/>).
//!
//! A header of 128 bytes, then the arrays that its flags announce, in the order of the flag bits: segments a strand
//! (u16), points (3 f32), thickness a point (f32), transparency a point (f32), colour a point (3 f32). What has no array
//! takes the header's default. All little-endian.

use super::bytes::{Bytes, floats, vectors};
use crate::error::{Result, invalid};
use crate::groom::Strands;

/// The first four bytes of every file.
pub(super) const MAGIC: &[u8; 4] = b"HAIR";

const HEADER_BYTES: u64 = 128;
const HAS_SEGMENTS: u32 = 1;
const HAS_POINTS: u32 = 1 << 1;
const HAS_THICKNESS: u32 = 1 << 2;
const HAS_TRANSPARENCY: u32 = 1 << 3;
const HAS_COLOURS: u32 = 1 << 4;

/// The text that [`write_hair`] leaves in the header's 88 bytes for remarks.
const REMARK: &[u8] = b"pelage";

/// The header's fields, as they stand.
struct Header {
    strands: u32,
    points: u32,
    flags: u32,
    segments: u32,
    thickness: f32,
    colour: [f32; 3],
}

/// Reads strands from the bytes of a `.hair` file.
///
/// Thickness is a diameter: the radius is half of it. Colours come one a point and are averaged over each strand.
/// Transparency is passed over, as are further bytes at the end. Coordinates are by arc length.
///
/// # Errors
/// [`InvalidFile`](crate::Error::InvalidFile): bytes that are missing, counts that do not fit one another or the file's
/// size, a file without points, a value that [`Strands`] does not take (not finite, negative).
pub fn read_hair(bytes: &[u8]) -> Result<Strands> {
    let file = Bytes::new(bytes, "HAIR");
    let header = read_header(&file, bytes)?;
    let (strand_count, point_count) = (u64::from(header.strands), u64::from(header.points));
    let mut at = HEADER_BYTES;
    let mut next = |flag: u32, count: u64, stride: u64, name: &str| -> Result<Option<&[u8]>> {
        if header.flags & flag == 0 {
            return Ok(None);
        }
        let array = file.array(at, count, stride, name)?;
        at += array.len() as u64;
        Ok(Some(array))
    };
    let segments = next(HAS_SEGMENTS, strand_count, 2, "segment counts")?;
    let points = next(HAS_POINTS, point_count, 12, "points")?;
    let thickness = next(HAS_THICKNESS, point_count, 4, "thicknesses")?;
    next(HAS_TRANSPARENCY, point_count, 4, "transparencies")?;
    let colours = next(HAS_COLOURS, point_count, 12, "colours")?;

    let Some(points) = points else {
        return file.error("the flags announce no points");
    };
    let counts = point_counts(&file, &header, segments)?;
    let strands = file.blame(Strands::new(vectors(points, 12), &counts, 0.0))?;
    let radii = match thickness {
        Some(array) => floats(array).map(|diameter| 0.5 * diameter).collect(),
        None => vec![0.5 * header.thickness; header.points as usize],
    };
    let colours = match colours {
        Some(array) => mean_colours(&strands, &vectors(array, 12)),
        None => vec![header.colour; strands.strand_count()],
    };
    file.blame(
        strands
            .with_point_radii(radii)
            .and_then(|s| s.with_colours(colours)),
    )
}

/// Writes strands as a `.hair` file: points, segment counts, and thicknesses and colours where they vary.
///
/// Reading it back gives the same points, radii and colours (to a rounding where a radius is subnormal or above half of
/// the largest float); coordinates are then by arc length and the curve is a polyline, for the format holds neither.
///
/// # Errors
/// [`InvalidValue`](crate::Error::InvalidValue): a strand of more than 65535 segments, a radius whose double is not
/// finite.
pub fn write_hair(strands: &Strands) -> Result<Vec<u8>> {
    let mut segments = Vec::with_capacity(2 * strands.strand_count());
    for strand in 0..strands.strand_count() {
        let count = strands.range(strand).len() - 1;
        let Ok(count) = u16::try_from(count) else {
            return invalid!(
                "strand {strand}: {count} segments, but a .hair file holds at most 65535 a strand"
            );
        };
        segments.extend(count.to_le_bytes());
    }
    if let Some(radius) = strands
        .radii()
        .iter()
        .find(|radius| !(2.0 * **radius).is_finite())
    {
        return invalid!("radius {radius} is too large for a .hair file, which holds diameters");
    }
    let radius = strands.radii().first().copied().unwrap_or(0.0);
    let colour = strands.colours().first().copied().unwrap_or([1.0; 3]);
    let radii_vary = strands.radii().iter().any(|r| *r != radius);
    let colours_vary = strands.colours().iter().any(|c| *c != colour);
    let flags = HAS_SEGMENTS
        | HAS_POINTS
        | if radii_vary { HAS_THICKNESS } else { 0 }
        | if colours_vary { HAS_COLOURS } else { 0 };

    let mut bytes = write_header(strands, flags, 2.0 * radius, colour);
    bytes.extend(segments);
    bytes.extend(
        strands
            .points()
            .iter()
            .flatten()
            .flat_map(|axis| axis.to_le_bytes()),
    );
    if radii_vary {
        bytes.extend(
            strands
                .radii()
                .iter()
                .flat_map(|radius| (2.0 * radius).to_le_bytes()),
        );
    }
    if colours_vary {
        for strand in 0..strands.strand_count() {
            let colour = strands.colours()[strand].map(f32::to_le_bytes);
            bytes.extend(colour.as_flattened().repeat(strands.range(strand).len()));
        }
    }
    Ok(bytes)
}

fn read_header(file: &Bytes, bytes: &[u8]) -> Result<Header> {
    if !bytes.starts_with(MAGIC) {
        return file.error("does not start with \"HAIR\"");
    }
    file.array(0, 1, HEADER_BYTES, "header")?;
    Ok(Header {
        strands: file.u32(4, "strand count")?,
        points: file.u32(8, "point count")?,
        flags: file.u32(12, "flags")?,
        segments: file.u32(16, "default segments")?,
        thickness: file.f32(20, "default thickness")?,
        colour: [
            file.f32(28, "default red")?,
            file.f32(32, "default green")?,
            file.f32(36, "default blue")?,
        ],
    })
}

/// Points a strand, which must sum to the header's point count (whose bytes are known to be there).
fn point_counts(file: &Bytes, header: &Header, segments: Option<&[u8]>) -> Result<Vec<u32>> {
    let each = u64::from(header.segments) + 1;
    let sum = match segments {
        Some(array) => array
            .chunks_exact(2)
            .map(|word| segment_count(word) + 1)
            .sum(),
        None => u64::from(header.strands).saturating_mul(each),
    };
    if sum != u64::from(header.points) {
        return file.error(format_args!(
            "{} strands with their segments make {sum} points, but the header says {}",
            header.strands, header.points
        ));
    }
    Ok(match segments {
        Some(array) => array
            .chunks_exact(2)
            .map(|word| segment_count(word) as u32 + 1)
            .collect(),
        None => vec![each as u32; header.strands as usize],
    })
}

fn segment_count(word: &[u8]) -> u64 {
    u64::from(u16::from_le_bytes([word[0], word[1]]))
}

/// The mean over each strand of the colours of its points.
fn mean_colours(strands: &Strands, colours: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let mean = |strand| {
        let own = &colours[strands.range(strand)];
        std::array::from_fn(|channel| {
            let sum: f64 = own.iter().map(|colour| f64::from(colour[channel])).sum();
            (sum / own.len() as f64) as f32
        })
    };
    (0..strands.strand_count()).map(mean).collect()
}

fn write_header(strands: &Strands, flags: u32, thickness: f32, colour: [f32; 3]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    let counts = [
        strands.strand_count() as u32,
        strands.points().len() as u32,
        flags,
        0,
    ];
    bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
    // Default transparency: 0, opaque.
    let defaults = [thickness, 0.0, colour[0], colour[1], colour[2]];
    bytes.extend(defaults.iter().flat_map(|value| value.to_le_bytes()));
    bytes.extend(REMARK);
    bytes.resize(HEADER_BYTES as usize, 0);
    bytes
}
