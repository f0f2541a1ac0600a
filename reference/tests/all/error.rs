use pelage_reference::composite::Image;
use pelage_reference::error::{ImageError, alpha_error, colour_error};

fn image(pixels: Vec<[f64; 4]>) -> Image {
    Image {
        width: pixels.len(),
        height: 1,
        pixels,
    }
}

#[test]
fn equal_images_have_no_error() {
    let a = image(vec![[0.1, 0.2, 0.3, 1.0]; 7]);
    assert_eq!(
        colour_error(&a, &a, None),
        ImageError {
            pixels: 7,
            ..ImageError::default()
        }
    );
}

#[test]
fn a_constant_difference_is_its_own_mean_percentile_and_maximum() {
    let [a, b] = [0.5, 0.75].map(|v| image(vec![[v, v, v, 1.0]; 50]));
    let error = colour_error(&a, &b, None);
    assert_eq!([error.rmse, error.p99, error.max], [0.25; 3]);
    assert_eq!(alpha_error(&a, &b, None).max, 0.0);
}

#[test]
fn the_percentile_leaves_out_the_hundredth_part() {
    let reference = image(vec![[0.0, 0.0, 0.0, 1.0]; 100]);
    let mut actual = reference.clone();
    actual.pixels[17] = [1.0, 1.0, 1.0, 1.0];
    let error = colour_error(&actual, &reference, None);
    assert_eq!([error.p99, error.max], [0.0, 1.0]);
    assert!((error.rmse - 0.1).abs() < 1e-15);
    actual.pixels[18] = [0.0, 0.5, 0.0, 1.0];
    assert_eq!(colour_error(&actual, &reference, None).p99, 0.5);
}

#[test]
fn pixels_without_hair_do_not_count_but_are_watched() {
    let reference = image(vec![[0.0; 4], [0.5, 0.5, 0.5, 0.5]]);
    let actual = image(vec![[0.0, 0.0, 0.0, 0.25], [0.5, 0.5, 0.5, 0.5]]);
    let error = colour_error(&actual, &reference, None);
    assert_eq!(
        (error.max, error.pixels, error.max_elsewhere),
        (0.0, 1, 0.25)
    );
    assert_eq!(
        alpha_error(&actual, &reference, Some(&[true, false])).max,
        0.25
    );
    assert_eq!(
        colour_error(&actual, &reference, Some(&[false, false])).pixels,
        0
    );
}

#[test]
fn what_is_not_a_number_is_infinitely_wrong() {
    let reference = image(vec![[0.5; 4]; 3]);
    let mut actual = reference.clone();
    actual.pixels[1][2] = f64::NAN;
    let error = colour_error(&actual, &reference, None);
    assert_eq!([error.rmse, error.max], [f64::INFINITY; 2]);
}
