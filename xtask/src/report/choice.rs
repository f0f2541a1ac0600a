//! Which technique to choose when: of each scene's rows, the fastest and the smallest within an error.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::row::Row;
use super::tables::settings;

/// Root mean square errors that a host may ask for: what is not seen, a step of 8 bits, what is seen where one looks for it,
/// and what is seen.
const LIMITS: [(f64, &str); 4] = [
    (1e-3, "exact"),
    (1.0 / 256.0, "a step of 8 bits"),
    (0.015, "hardly seen"),
    (0.05, "seen"),
];

/// The row that is least by some measure among those within an error.
fn best<'a>(rows: &[&'a Row], limit: f64, measure: fn(&Row) -> f64) -> Option<&'a Row> {
    let within = rows.iter().filter(|row| row.error.rmse <= limit);
    let least = within.min_by(|a, b| measure(a).total_cmp(&measure(b)));
    least.copied()
}

fn ms(row: &Row) -> f64 {
    row.ms.median
}

fn bytes(row: &Row) -> f64 {
    row.bytes as f64
}

fn cell(row: Option<&Row>) -> String {
    row.map_or("none".into(), |row| {
        format!(
            "`{}` {}: {:.1} ms, {:.1} MB, RMSE {:.1e}",
            row.technique,
            settings(&row.settings),
            row.ms.median,
            row.bytes as f64 / 1e6,
            row.error.rmse
        )
    })
}

/// Of one scene and group.
pub fn of_scene(rows: &[&Row]) -> String {
    let mut text = "| error wanted | the fastest | the smallest |\n|---|---|---|\n".to_owned();
    for (limit, words) in LIMITS {
        let [fastest, smallest] = [ms, bytes].map(|measure| cell(best(rows, limit, measure)));
        // Writing to a string does not fail.
        writeln!(
            text,
            "| {words}, RMSE ≤ {limit:.4} | {fastest} | {smallest} |"
        )
        .ok();
    }
    text
}

/// Of a group over all its scenes: the technique that is fastest, and the one that is smallest, on each of them.
pub fn of_group(group: &str, rows: &[Row]) -> String {
    let mut scenes: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.group == group) {
        scenes.entry(&row.scene).or_default().push(row);
    }
    let mut text =
        "| scene | error wanted | the fastest | the smallest |\n|---|---|---|---|\n".to_owned();
    for (scene, rows) in scenes {
        for (limit, words) in LIMITS {
            let [fastest, smallest] = [ms, bytes].map(|measure| {
                best(&rows, limit, measure).map_or("none", |row| row.technique.as_str())
            });
            writeln!(text, "| {scene} | {words} | {fastest} | {smallest} |").ok();
        }
    }
    text
}
