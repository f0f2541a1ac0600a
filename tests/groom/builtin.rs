//! The built-in head and hairstyles.

use super::strands_of;
use pelage::groom::{BuiltinGroom, MAX_INTERPOLATED_STRANDS, builtin, head_distance, head_mesh};
use std::collections::HashMap;

#[test]
fn as_many_strands_are_made_as_asked_for() {
    for groom in BuiltinGroom::ALL {
        for count in [0, 1, 7, 1000] {
            assert_eq!(builtin(groom, count).unwrap().strand_count(), count);
        }
        let error = builtin(groom, MAX_INTERPOLATED_STRANDS + 1)
            .unwrap_err()
            .to_string();
        assert!(error.contains("strand_count 16777217"), "{error}");
    }
}

#[test]
fn hairstyles_are_the_same_every_time() {
    for groom in BuiltinGroom::ALL {
        assert_eq!(builtin(groom, 300).unwrap(), builtin(groom, 300).unwrap());
    }
}

#[test]
fn no_point_of_a_hairstyle_lies_in_the_head() {
    for groom in BuiltinGroom::ALL {
        for (at, points) in strands_of(&builtin(groom, 4000).unwrap()).enumerate() {
            for (i, p) in points.iter().enumerate() {
                let distance = head_distance(*p);
                // Roots lie on triangles with edges of 8 mm, whose middles are 0.3 mm deep in a head of 80 mm.
                let deepest = if i == 0 { -0.0005 } else { 0.0 };
                assert!(
                    distance >= deepest,
                    "{groom:?}, strand {at}, point {i}: {distance}"
                );
            }
        }
    }
}

#[test]
fn roots_are_on_the_scalp_and_leave_the_face_free() {
    for groom in BuiltinGroom::ALL {
        for points in strands_of(&builtin(groom, 4000).unwrap()) {
            let [_, y, z] = points[0];
            assert!(head_distance(points[0]) < 0.001);
            assert!(
                y > 0.06 || z < 0.07,
                "a root on the face at {:?}",
                points[0]
            );
            let free = points
                .iter()
                .all(|p| !(p[0].abs() < 0.04 && p[2] > 0.05 && (-0.12..0.05).contains(&p[1])));
            assert!(
                free,
                "{groom:?}: a strand before the face from {:?}",
                points[0]
            );
        }
    }
}

#[test]
fn radii_suit_the_count_and_taper() {
    let strands = builtin(BuiltinGroom::Straight, 5000).unwrap();
    assert!((strands.radii()[0] - 4.5e-4).abs() < 1e-8);
    assert!((strands.radii()[16] - 0.35 * 4.5e-4).abs() < 1e-8);
}

#[test]
fn the_scalp_has_no_bald_patches() {
    // Every place of the scalp well above the hairline has a root near it: 4000 roots on 0.06 m² are 4 mm apart.
    let strands = builtin(BuiltinGroom::Straight, 4000).unwrap();
    let roots: Vec<[f32; 3]> = strands_of(&strands).map(|points| points[0]).collect();
    for p in head_mesh().positions.iter().filter(|p| p[1] > 0.09) {
        let near = roots.iter().any(|r| {
            (0..3).map(|axis| (r[axis] - p[axis]).powi(2)).sum::<f32>() < 0.012f32.powi(2)
        });
        assert!(near, "no root within 12 mm of {p:?}");
    }
}

#[test]
fn the_head_is_one_closed_surface_that_faces_outwards() {
    let mesh = head_mesh();
    assert!(
        (10_000..25_000).contains(&mesh.triangle_count()),
        "{}",
        mesh.triangle_count()
    );
    let mut edges = HashMap::new();
    let mut volume = 0.0;
    for triangle in mesh.indices.chunks_exact(3) {
        for k in 0..3 {
            *edges
                .entry((triangle[k], triangle[(k + 1) % 3]))
                .or_insert(0) += 1;
        }
        let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[triangle[k] as usize].map(f64::from));
        let cross = [
            b[1] * c[2] - b[2] * c[1],
            b[2] * c[0] - b[0] * c[2],
            b[0] * c[1] - b[1] * c[0],
        ];
        volume += (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0;
    }
    for ((a, b), count) in &edges {
        assert_eq!(
            edges.get(&(*b, *a)),
            Some(count),
            "the edge from {a} to {b} has no partner"
        );
    }
    // A head of about 4 l, the neck and the tops of the shoulders.
    assert!((0.004..0.012).contains(&volume), "{volume} m³");
    for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
        let length = n.iter().map(|v| v * v).sum::<f32>().sqrt();
        assert!((length - 1.0).abs() < 1e-4);
        // A quad's vertex may lie off the field's surface by a part of its cell of at most 10 mm.
        assert!(head_distance(*p).abs() < 0.003, "{p:?}");
    }
}
