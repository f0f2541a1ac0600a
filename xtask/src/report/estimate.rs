//! What is missing from the report, and about how long it will take.

use std::fmt::Write;

use super::Group;
use super::kept;
use super::ladder::Case;
use super::row::{Row, without_bytes};
use super::scenes::{SCENES, Scene};

/// Seconds of a row beside its frames: a device is opened, shaders are compiled, the error is found.
const ROW_SECONDS: f64 = 2.5;
/// Frames of a row: those that warm up, those that are timed, and one pass by pass.
const ROW_FRAMES: f64 = 8.0;
/// Seconds of a frame for each million fragments, of a technique of which no row is known.
const FRAME_SECONDS: f64 = 0.1;
/// Seconds of the reference for each million fragments.
const TRUTH_SECONDS: f64 = 1.0;
/// Seconds of the transmittances of a scene's probes, and of its squares.
const PROBE_SECONDS: f64 = 30.0;

/// Seconds that a case will take on a scene, by the rows that are most like it.
fn seconds(case: &Case, scene: &Scene, rows: &[Row]) -> f64 {
    let settings = without_bytes(&case.settings());
    let fragments = |row: &Row| {
        let scene = SCENES.iter().find(|scene| scene.name == row.scene);
        scene.map(|scene| scene.fragments)
    };
    let like = |row: &&Row| {
        row.group == case.group.name()
            && row.technique == case.technique()
            && fragments(row).is_some()
    };
    let unlike = |row: &&Row| {
        let far = (fragments(row).unwrap_or(1.0) / scene.fragments).ln().abs();
        (without_bytes(&row.settings) != settings, far)
    };
    let best = rows.iter().filter(like).min_by(|a, b| {
        let ((a, far_a), (b, far_b)) = (unlike(a), unlike(b));
        a.cmp(&b).then(far_a.total_cmp(&far_b))
    });
    let frame = match best {
        Some(row) => {
            let ms = row.ms.median / 1e3 * ROW_FRAMES;
            let whole = row.seconds.map_or(ms, |seconds| seconds - ROW_SECONDS);
            whole.max(0.0) * scene.fragments / fragments(row).unwrap_or(scene.fragments)
        }
        None => ROW_FRAMES * FRAME_SECONDS * scene.fragments,
    };
    ROW_SECONDS + frame
}

/// Seconds until a scene's truth is known.
fn truth_seconds(scene: &Scene, missing: &[Case]) -> f64 {
    let of = |what: &str, seconds: f64| match kept::is_there(&format!("{}-{what}", scene.name)) {
        true => 0.0,
        false => seconds,
    };
    let shadows = missing.iter().any(|case| case.group == Group::Shadow);
    let probes = if shadows { PROBE_SECONDS } else { 0.0 };
    let known = of("probes", probes) + of("squares", probes);
    of("pixels", TRUTH_SECONDS * scene.fragments) + known
}

/// One line a scene and group, and a sum.
pub fn list<'a>(missing: impl Iterator<Item = (&'a Scene, Vec<Case>)>, rows: &[Row]) -> String {
    let mut text = format!(
        "{:15} {:13} {:>7} {:>8}\n",
        "scene", "group", "missing", "minutes"
    );
    let (mut count, mut sum) = (0, 0.0);
    // Writing to a string does not fail.
    let mut line = |scene: &str, group: &str, rows: usize, seconds: f64| {
        writeln!(
            text,
            "{scene:15} {group:13} {rows:7} {:8.1}",
            seconds / 60.0
        )
        .ok();
    };
    for (scene, cases) in missing {
        if cases.is_empty() {
            continue;
        }
        if !scene.is_there() {
            line(scene.name, "(not there)", cases.len(), 0.0);
            continue;
        }
        let truth = truth_seconds(scene, &cases);
        line(scene.name, "(reference)", 0, truth);
        sum += truth;
        for (group, _) in scene.groups {
            let of_group: Vec<&Case> = cases.iter().filter(|case| case.group == *group).collect();
            if of_group.is_empty() {
                continue;
            }
            let seconds = of_group.iter().map(|case| seconds(case, scene, rows)).sum();
            line(scene.name, group.name(), of_group.len(), seconds);
            count += of_group.len();
            sum += seconds;
        }
    }
    line("all", "", count, sum);
    text
}
