use crate::Random;
use pelage_reference::glam::{DMat4, DVec2, DVec3};
use pelage_reference::project::{curve_tangents, project_strand, tangents};
use pelage_reference::scene::{Camera, Strands, look_at};

/// Products of a few numbers of order 1 to 1000: measured 7e-16 relative.
const ROUNDING: f64 = 1e-11;

fn view(eye: DVec3) -> DMat4 {
    look_at(eye, DVec3::ZERO, DVec3::Y)
}

fn half_widths(strand: &[(DVec3, f64)], camera: &Camera) -> [f64; 2] {
    let runs = project_strand(&Strands::from_polylines([strand]), camera, 0);
    [
        runs[0][0].start.half_width,
        runs[0].last().unwrap().end.half_width,
    ]
}

#[test]
fn pixels_count_from_the_upper_left_and_depth_from_the_near_plane() {
    let camera = Camera::perspective(view(DVec3::Z * 5.0), 1.0, [1.0, 9.0], [200, 100]);
    let strand = [
        (DVec3::new(0.0, 0.0, 4.0), 0.1),
        (DVec3::new(0.1, 0.1, -4.0), 0.1),
    ];
    let runs = project_strand(&Strands::from_polylines([strand]), &camera, 0);
    let [start, end] = [runs[0][0].start, runs[0][0].end];
    assert!(start.pixel.distance(DVec2::new(100.0, 50.0)) < ROUNDING);
    assert!(
        end.pixel.x > 100.0 && end.pixel.y < 50.0,
        "right is right and up is up: {}",
        end.pixel
    );
    assert!(start.depth.abs() < ROUNDING && (end.depth - 1.0).abs() < ROUNDING);
}

#[test]
fn an_orthographic_width_does_not_depend_on_the_inclination() {
    let camera = Camera::orthographic(
        view(DVec3::new(3.0, 2.0, 5.0)),
        2.0,
        [0.1, 50.0],
        [320, 240],
    );
    let mut random = Random(1);
    for _ in 0..200 {
        let [start, end] = [random.point(DVec3::ONE), random.point(DVec3::ONE)];
        let measured = half_widths(&[(start, 0.01), (end, 0.02)], &camera);
        for (measured, radius) in measured.into_iter().zip([0.01, 0.02]) {
            let expected = radius * 240.0 / 4.0;
            assert!(
                (measured / expected - 1.0).abs() < ROUNDING,
                "{measured} {expected}"
            );
        }
    }
}

#[test]
fn a_perspective_width_is_that_of_the_planes_through_the_eye_that_touch_the_fibre() {
    /// Radius over distance is below 2e-5: o = T × V touches the fibre to first order in it. Measured 6e-7.
    const FIRST_ORDER: f64 = 1e-5;
    const RADIUS: f64 = 1e-5;
    let eye = DVec3::new(0.5, -0.3, 3.0);
    let camera = Camera::perspective(view(eye), 0.8, [0.1, 50.0], [640, 480]);
    let pixel = |p: DVec3| camera.pixel_from_clip(camera.clip_from_world * p.extend(1.0));
    let mut random = Random(2);
    for _ in 0..200 {
        let [start, end] = [random.point(DVec3::ONE), random.point(DVec3::ONE)];
        let tangent = (end - start).normalize();
        let to_eye = eye - start;
        let nearest = to_eye - tangent * to_eye.dot(tangent);
        if nearest.length() < 0.5 {
            continue;
        }
        // The touching plane holds the eye and the tangent; its normal leans by asin(r / D) towards the eye.
        let lean = RADIUS / nearest.length();
        let across = tangent.cross(nearest).normalize();
        let normal = across * (1.0 - lean * lean).sqrt() + nearest.normalize() * lean;
        let touched = start + normal * RADIUS;
        let silhouette = (pixel(touched + tangent * 0.01) - pixel(touched)).normalize();
        let expected = silhouette.perp_dot(pixel(start) - pixel(touched)).abs();
        let [measured, _] = half_widths(&[(start, RADIUS), (end, RADIUS)], &camera);
        assert!(
            (measured / expected - 1.0).abs() < FIRST_ORDER,
            "{measured} {expected}"
        );
    }
}

#[test]
fn a_fibre_seen_end_on_keeps_its_width() {
    let camera = Camera::orthographic(view(DVec3::Z * 5.0), 1.0, [0.1, 50.0], [100, 100]);
    let [start, end] = half_widths(&[(DVec3::Z, 0.05), (-DVec3::Z, 0.02)], &camera);
    assert!(
        (start - 2.5).abs() < ROUNDING && (end - 1.0).abs() < ROUNDING,
        "{start} {end}"
    );
}

#[test]
fn tangents_pass_over_coincident_points() {
    let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)];
    let plain = tangents(&[a, b, c]).unwrap();
    let doubled = tangents(&[a, a, b, b, b, c, c]).unwrap();
    assert_eq!(doubled, [0, 0, 1, 1, 1, 2, 2].map(|i| plain[i]));
    assert!(plain[1].distance(DVec3::new(1.0, 1.0, 0.0).normalize()) < ROUNDING);
    assert_eq!(tangents(&[a, a]), None);
    assert_eq!(tangents(&[a]), None);
    assert_eq!(tangents(&[]), None);
    assert_eq!(
        tangents(&[a, b, a]).unwrap()[1],
        DVec3::X,
        "a turn of 180° takes the direction before"
    );
}

#[test]
fn the_near_plane_cuts_where_a_strand_passes_it() {
    let camera = Camera::perspective(view(DVec3::Z * 5.0), 1.0, [1.0, 20.0], [200, 100]);
    // In, out behind the eye, and in again: two runs that end on the near plane, z = 4.
    let place = |x: f64, z: f64| (DVec3::new(x, 0.2, z), 0.01);
    let strand = [
        place(-1.0, 0.0),
        place(-0.5, 2.0),
        place(0.0, 8.0),
        place(0.5, 2.0),
        place(1.0, 0.0),
    ];
    let runs = project_strand(&Strands::from_polylines([strand]), &camera, 0);
    assert_eq!(runs.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
    let [out, back] = [runs[0][1], runs[1][0]];
    assert_eq!([out.segment, back.segment], [1, 2]);
    assert!(
        (out.span[1] - 1.0 / 3.0).abs() < ROUNDING && (back.span[0] - 2.0 / 3.0).abs() < ROUNDING
    );
    assert!(out.end.depth < ROUNDING && back.start.depth < ROUNDING);
    // Distance 1 before the eye: half the screen's height is tan ½, at 50 pixels.
    let expected = DVec2::new(
        100.0 - 1.0 / 3.0 / 0.5f64.tan() * 50.0,
        50.0 - 0.2 / 0.5f64.tan() * 50.0,
    );
    assert!(
        out.end.pixel.distance(expected) < 1e-9,
        "{} {expected}",
        out.end.pixel
    );
}

#[test]
fn what_lies_behind_the_eye_gives_nothing() {
    let camera = Camera::perspective(view(DVec3::Z * 5.0), 1.0, [1.0, 20.0], [200, 100]);
    let strand = [
        (DVec3::new(0.0, 0.0, 6.0), 0.1),
        (DVec3::new(0.0, 1.0, 7.0), 0.1),
    ];
    assert!(project_strand(&Strands::from_polylines([strand]), &camera, 0).is_empty());
}

#[test]
fn a_curves_tangents_are_the_circles_however_its_points_are_spaced() {
    let mut random = Random(5);
    for _ in 0..200 {
        let radius = random.within(0.1, 10.0);
        let mut angle = random.within(0.0, 6.0);
        let mut points = Vec::new();
        let mut exact = Vec::new();
        for _ in 0..8 {
            angle += random.within(0.01, 0.6);
            points.push(radius * DVec3::new(angle.cos(), angle.sin(), 0.0));
            exact.push(DVec3::new(-angle.sin(), angle.cos(), 0.0));
        }
        for (found, exact) in curve_tangents(&points).iter().zip(&exact).skip(1).take(6) {
            // Weights by chords in place of arcs: 0.6 rad beside 0.01 errs by 0.6³ / 24 of the turn at most.
            let found = found.unwrap();
            assert!(found.angle_between(*exact) < 5e-3, "{found} for {exact}");
        }
    }
    let [a, b] = [DVec3::ZERO, DVec3::X];
    assert_eq!(curve_tangents(&[a, a, b]), [None, Some(b), Some(b)]);
    assert_eq!(curve_tangents(&[a, b, a])[1], None);
    assert!(curve_tangents(&[a]) == [None] && curve_tangents(&[]).is_empty());
}
