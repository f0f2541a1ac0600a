//! ꟻLIP (Andersson et al. 2020): how different two pictures look to someone who flips between them.

use pelage_reference::composite::Image;

/// Whether it is built in.
pub const IS_BUILT_IN: bool = cfg!(feature = "flip");

/// The background, linear: hair that is dark or light shows alike.
#[cfg(feature = "flip")]
const MID_GREY: f64 = 0.18;

/// The mean over the picture; `None` where it is not built in.
#[cfg(feature = "flip")]
pub fn mean(actual: &Image, truth: &Image) -> Option<f64> {
    let [actual, truth] = [actual, truth].map(|image| {
        let over = image.over([MID_GREY; 3]);
        let bytes: Vec<u8> = over
            .pixels
            .iter()
            .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
            .map(srgb_byte)
            .collect();
        nv_flip::FlipImageRgb8::with_data(image.width as u32, image.height as u32, &bytes)
    });
    let map = nv_flip::flip(truth, actual, nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    Some(f64::from(nv_flip::FlipPool::from_image(&map).mean()))
}

/// IEC 61966-2-1.
#[cfg(feature = "flip")]
fn srgb_byte(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * encoded).round() as u8
}

/// Not built in.
#[cfg(not(feature = "flip"))]
pub fn mean(_: &Image, _: &Image) -> Option<f64> {
    None
}
