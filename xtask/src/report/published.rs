//! What the sources say of memory and time, beside what is measured here.

use std::fmt::Write;

use pelage::glam::{DVec3, Vec3};
use pelage::groom::Strands;
use pelage::host::offscreen::{Offscreen, OffscreenOptions};
use pelage::transparency::a_buffer::{FRAGMENT_BYTES, NODE_BYTES};
use pelage::transparency::{
    ABuffer, DbkBuffer, KPlusBuffer, RandomSubsets, Rest, Storage, Transparency,
};
use pelage::{Frame, View, Viewport};
use serde_json::Value;

use super::measure::sentence;
use super::row::Row;
use crate::Result;

/// Hunz's viewport, and the fragments of his A-buffer and his DBK-buffer in it (2016, §6.3.3).
const VIEWPORT: [u32; 2] = [656, 861];
const A_BUFFER_FRAGMENTS: u64 = 12_959_208;
const DBK_FRAGMENTS: u64 = 4_518_344;
const MIB: f64 = 1024.0 * 1024.0;

/// His MiB beside what the library states for as many fragments.
pub fn memory() -> Result<String> {
    let pool = |fragments, each| Some(fragments * each);
    let cases = [
        (
            "A-buffer, lists",
            "150.46",
            Transparency::ABuffer(ABuffer {
                storage: Storage::Lists,
                pool_bytes: pool(A_BUFFER_FRAGMENTS, NODE_BYTES),
                ..ABuffer::default()
            }),
        ),
        (
            "A-buffer, counted",
            "–",
            Transparency::ABuffer(ABuffer {
                storage: Storage::Counted,
                pool_bytes: pool(A_BUFFER_FRAGMENTS, FRAGMENT_BYTES),
                ..ABuffer::default()
            }),
        ),
        (
            "DBK-buffer",
            "59.25",
            Transparency::DbkBuffer(DbkBuffer {
                depth_shift: Some(1.0),
                pool_bytes: pool(DBK_FRAGMENTS, FRAGMENT_BYTES),
                ..DbkBuffer::default()
            }),
        ),
        (
            "k⁺-buffer, k = 8, the rest dropped",
            "36.63",
            Transparency::KPlusBuffer(KPlusBuffer {
                k: 8,
                rest: Rest::Dropped,
                ..KPlusBuffer::default()
            }),
        ),
        (
            "random subsets, k = 8",
            "34.47 (43.09 with their depth buffers)",
            Transparency::RandomSubsets(RandomSubsets {
                subsets: 8,
                exact_alpha: false,
                ..RandomSubsets::default()
            }),
        ),
    ];
    let mut offscreen = Offscreen::new(&OffscreenOptions::default()).map_err(sentence)?;
    // Pixels alone count here: any hair will do.
    let points = vec![[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]];
    let strands = Strands::new(points, &[2], 0.01).map_err(sentence)?;
    let hair = offscreen.renderer.create_hair(&strands).map_err(sentence)?;
    let (eye, aspect) = (DVec3::Z, f64::from(VIEWPORT[0]) / f64::from(VIEWPORT[1]));
    let view = View::perspective(eye, DVec3::ZERO, DVec3::Y, 0.5, aspect, [0.1, 10.0])
        .map_err(sentence)?;
    let mut text = "| technique | Hunz, MiB | here, MiB |\n|---|---|---|\n".to_owned();
    for (name, published, transparency) in cases {
        let frame = Frame {
            hairs: &[&hair],
            lights: &[],
            ambient: Vec3::ZERO,
            view,
            transparency: Some(transparency),
        };
        // On a renderer of its own: pools are kept.
        let (device, queue) = (offscreen.renderer.device(), offscreen.renderer.queue());
        let mut renderer = pelage::Renderer::new(device, queue).map_err(sentence)?;
        let viewport = Viewport {
            width: VIEWPORT[0],
            height: VIEWPORT[1],
            ..Viewport::default()
        };
        let estimate = renderer
            .memory_estimate(&frame, &viewport)
            .map_err(sentence)?;
        let here = estimate.of("pelage.transparency.") as f64 / MIB;
        // Writing to a string does not fail.
        writeln!(text, "| {name} | {published} | {here:.2} |").ok();
    }
    Ok(text)
}

/// The row of a scene with these settings among its own.
fn find<'a>(
    rows: &'a [Row],
    scene: &str,
    technique: &str,
    wanted: &[(&str, Value)],
) -> Option<&'a Row> {
    let has = |row: &Row| {
        let of = |(key, value): &(&str, Value)| row.settings.get(key) == Some(value);
        wanted.iter().all(of) && row.settings.get("pool_part").is_none()
    };
    let own = |row: &&Row| {
        row.group == "transparency" && row.scene == scene && row.technique == technique && has(row)
    };
    rows.iter().find(own)
}

/// Time of the passes that resolve.
fn resolve_ms(row: &Row) -> Option<f64> {
    row.passes.get("pelage.composite.resolve").copied()
}

/// Hunz's order of times and Yu's speed-ups, each confirmed or refuted by rows of the scene that is like theirs; empty until
/// these are measured.
pub fn times(rows: &[Row]) -> String {
    const SCENE: &str = "straight";
    let row = |technique, wanted: &[(&str, Value)]| find(rows, SCENE, technique, wanted);
    let mut lines = Vec::new();
    let verdict = |holds| if holds { "confirmed" } else { "refuted" };
    let lists = [("storage", "lists".into()), ("raster", "walk".into())];
    let order = [
        row("dbk_buffer", &[("shift_part", 0.5.into())]),
        row("k_plus_buffer", &[("k", 8.into())]),
        row("a_buffer", &lists),
    ];
    if let [Some(dbk), Some(k_plus), Some(a_buffer)] = order {
        let [dbk, k_plus, a_buffer] = [dbk, k_plus, a_buffer].map(|row| row.ms.median);
        lines.push(format!(
            "| DBK-buffer by a depth shift, k⁺-buffer (k = 8), A-buffer (lists) | each faster than the next | {dbk:.0}, {k_plus:.0}, {a_buffer:.0} ms | {} |",
            verdict(dbk < k_plus && k_plus < a_buffer)
        ));
    }
    for (k, published) in [(16, 2.6), (64, 6.2)] {
        let of = |selection: &str| {
            let wanted = [
                ("k", k.into()),
                ("selection", selection.into()),
                ("rest", "merged".into()),
            ];
            row("k_buffer", &wanted)
        };
        let (Some(registers), Some(sort)) = (of("registers"), of("sort")) else {
            continue;
        };
        let frame = sort.ms.median / registers.ms.median;
        let resolve = match (resolve_ms(sort), resolve_ms(registers)) {
            (Some(sort), Some(registers)) => sort / registers,
            _ => f64::NAN,
        };
        lines.push(format!(
            "| K = {k} in registers, over selection sort of the foremost {k} | {published} times as fast (Yu) | {frame:.2} of the frame, {resolve:.2} of the resolve | {} |",
            verdict(frame.max(resolve) >= 0.8 * published)
        ));
    }
    if lines.is_empty() {
        return String::new();
    }
    let heading = "| what | published | here | |\n|---|---|---|---|\n";
    heading.to_owned() + &lines.join("\n") + "\n"
}
