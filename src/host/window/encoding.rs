//! How frames come to the screen, and what a surface's pixels are.

use crate::error::{Error, Result};

/// How frames come to the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PresentMode {
    /// Each frame in its turn, at the screen's rate; the host waits where it is faster. Every surface has it.
    #[default]
    Fifo,
    /// The newest frame at the screen's next refresh; older ones are dropped, and the host does not wait.
    Mailbox,
    /// At once, even while the screen is being refreshed.
    Immediate,
}

/// All present modes.
pub const PRESENT_MODES: [PresentMode; 3] = [
    PresentMode::Fifo,
    PresentMode::Mailbox,
    PresentMode::Immediate,
];

impl PresentMode {
    pub(super) fn wgpu(self) -> wgpu::PresentMode {
        match self {
            Self::Fifo => wgpu::PresentMode::Fifo,
            Self::Mailbox => wgpu::PresentMode::Mailbox,
            Self::Immediate => wgpu::PresentMode::Immediate,
        }
    }

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fifo => "fifo",
            Self::Mailbox => "mailbox",
            Self::Immediate => "immediate",
        }
    }
}

/// What a surface's pixels are, and so who encodes linear colour for the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// 8 bits a channel of the sRGB curve; the GPU encodes.
    Srgb8,
    /// The same 8 bits, encoded by the library: a surface whose format does not know of the curve.
    Unorm8,
    /// 10 bits a channel of the sRGB curve, encoded by the library.
    Unorm10,
    /// 16-bit floats, linear, beyond 1 too (extended linear sRGB); nobody encodes but the screen.
    Float16,
}

/// All encodings, the first that a surface has being the one taken where the host does not choose.
pub const ENCODINGS: [Encoding; 4] = [
    Encoding::Srgb8,
    Encoding::Unorm8,
    Encoding::Unorm10,
    Encoding::Float16,
];

impl Encoding {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Srgb8 => "srgb8",
            Self::Unorm8 => "unorm8",
            Self::Unorm10 => "unorm10",
            Self::Float16 => "float16",
        }
    }

    /// The format among a surface's own that has this encoding.
    pub(super) fn find(self, offered: &wgpu::SurfaceCapabilities) -> Option<wgpu::TextureFormat> {
        use wgpu::{SurfaceColorSpaces as Spaces, TextureFormat as Format};
        let (formats, space): (&[_], _) = match self {
            Self::Srgb8 => (
                &[Format::Bgra8UnormSrgb, Format::Rgba8UnormSrgb],
                Spaces::SRGB,
            ),
            Self::Unorm8 => (&[Format::Bgra8Unorm, Format::Rgba8Unorm], Spaces::SRGB),
            Self::Unorm10 => (&[Format::Rgb10a2Unorm], Spaces::SRGB),
            Self::Float16 => (&[Format::Rgba16Float], Spaces::EXTENDED_SRGB_LINEAR),
        };
        formats
            .iter()
            .copied()
            .find(|format| offered.color_spaces(*format).contains(space))
    }

    pub(super) fn colour_space(self) -> wgpu::SurfaceColorSpace {
        match self {
            Self::Float16 => wgpu::SurfaceColorSpace::ExtendedSrgbLinear,
            _ => wgpu::SurfaceColorSpace::Srgb,
        }
    }

    /// Whether the presenting pass applies the sRGB curve.
    pub(super) fn by_the_pass(self) -> bool {
        matches!(self, Self::Unorm8 | Self::Unorm10)
    }
}

pub(super) fn modes(offered: &wgpu::SurfaceCapabilities) -> impl Iterator<Item = PresentMode> {
    PRESENT_MODES
        .into_iter()
        .filter(|mode| offered.present_modes.contains(&mode.wgpu()))
}

pub(super) fn encodings(offered: &wgpu::SurfaceCapabilities) -> impl Iterator<Item = Encoding> {
    ENCODINGS
        .into_iter()
        .filter(|encoding| encoding.find(offered).is_some())
}

fn list(names: impl Iterator<Item = &'static str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}

pub(super) fn check_mode(mode: PresentMode, offered: &wgpu::SurfaceCapabilities) -> Result<()> {
    if modes(offered).any(|has| has == mode) {
        return Ok(());
    }
    Err(Error::Unsupported(format!(
        "the window's surface has no present mode {}; it has {}",
        mode.name(),
        list(modes(offered).map(PresentMode::name))
    )))
}

pub(super) fn choose(
    wanted: Option<Encoding>,
    offered: &wgpu::SurfaceCapabilities,
) -> Result<Encoding> {
    let Some(wanted) = wanted else {
        return encodings(offered).next().ok_or_else(no_format);
    };
    if encodings(offered).any(|has| has == wanted) {
        return Ok(wanted);
    }
    Err(Error::Unsupported(format!(
        "the window's surface has no format {}; it has {}",
        wanted.name(),
        list(encodings(offered).map(Encoding::name))
    )))
}

pub(super) fn no_format() -> Error {
    Error::Unsupported("the window's surface has no format that the library can encode for".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offering(formats: &[wgpu::TextureFormat]) -> wgpu::SurfaceCapabilities {
        let capability = |format: &wgpu::TextureFormat| wgpu::SurfaceFormatCapabilities {
            format: *format,
            color_spaces: wgpu::SurfaceColorSpaces::SRGB,
        };
        wgpu::SurfaceCapabilities {
            formats: formats.to_vec(),
            format_capabilities: formats.iter().map(capability).collect(),
            present_modes: vec![wgpu::PresentMode::Fifo, wgpu::PresentMode::FifoRelaxed],
            ..Default::default()
        }
    }

    #[test]
    fn a_present_mode_that_the_surface_lacks_is_named_with_those_that_it_has() {
        let offered = offering(&[wgpu::TextureFormat::Bgra8Unorm]);
        assert_eq!(check_mode(PresentMode::Fifo, &offered), Ok(()));
        assert_eq!(
            check_mode(PresentMode::Mailbox, &offered)
                .unwrap_err()
                .to_string(),
            "the window's surface has no present mode mailbox; it has fifo"
        );
    }

    #[test]
    fn the_first_encoding_that_the_surface_has_is_taken() {
        use wgpu::TextureFormat as Format;
        let both = offering(&[
            Format::Rgba8Unorm,
            Format::Bgra8Unorm,
            Format::Rgba8UnormSrgb,
        ]);
        assert_eq!(choose(None, &both), Ok(Encoding::Srgb8));
        assert_eq!(choose(Some(Encoding::Unorm8), &both), Ok(Encoding::Unorm8));
        assert_eq!(Encoding::Unorm8.find(&both), Some(Format::Bgra8Unorm));
        let plain = offering(&[Format::Rgb10a2Unorm]);
        assert_eq!(choose(None, &plain), Ok(Encoding::Unorm10));
        // Floats that are not linear are not what the library writes.
        let floats = offering(&[Format::Rgba16Float]);
        assert!(choose(None, &floats).is_err());
    }
}
