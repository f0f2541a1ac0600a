//! The host's own Vulkan device: C programs that have one, under the validation layer.
//!
//! `tests/c/vulkan.c` does the work, with what lies in `tests/c/vulkan`; it stands between the library and Vulkan, so that it
//! sees every use of the queue and can let things go wrong.

use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

use super::programs::{compile, folder, run};

/// The program, compiled once.
fn program() -> &'static PathBuf {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        compile(
            "vulkan",
            "tests/c/vulkan.c",
            &["-lvulkan", "-lm", "-lpthread"],
        )
    })
}

/// Runs a program under the validation layer, with synchronisation validation; what it and the layer say.
pub(super) fn validated(command: &mut Command) -> String {
    run(command
        .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
        .env(
            "VK_LAYER_ENABLES",
            "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT",
        ))
}

/// What the program says of a mode that must go right, without a word of the layer's.
#[track_caller]
fn goes_right(mode: &[&str]) -> String {
    let printed = validated(Command::new(program()).args(mode));
    silent(&printed);
    assert_eq!(printed.lines().last(), Some("0 failures"), "{printed}");
    printed
}

#[track_caller]
pub(super) fn silent(printed: &str) {
    for word in ["Validation", "VUID-", "SYNC-HAZARD", "UNASSIGNED-"] {
        assert!(!printed.contains(word), "{printed}");
    }
}

#[test]
fn the_layer_notices_a_hazard_of_the_hosts_own() {
    let printed = validated(Command::new(program()).arg("hazard"));
    assert!(
        printed.contains("SYNC-HAZARD-READ-AFTER-WRITE"),
        "{printed}"
    );
}

#[test]
fn pictures_on_the_hosts_device_are_those_of_the_librarys_own() {
    let printed = goes_right(&["compare"]);
    assert_eq!(printed.matches("pixels of hair").count(), 4, "{printed}");
}

#[test]
fn outputs_on_the_hosts_device_are_those_of_the_librarys_own() {
    let printed = goes_right(&["outputs"]);
    assert_eq!(
        printed.matches(": 0 values are wrong").count(),
        3,
        "{printed}"
    );
}

#[test]
fn the_hosts_scene_and_the_hair_shadow_each_other() {
    let printed = goes_right(&["shadows"]);
    assert!(printed.contains(": 0 values are wrong"), "{printed}");
}

#[test]
fn hair_moves_by_the_hosts_buffers_as_it_does_by_the_cpus_arrays() {
    let printed = goes_right(&["moving"]);
    assert_eq!(printed.matches("px of motion").count(), 12, "{printed}");
}

#[test]
fn two_layers_of_one_image_are_both_eyes_of_a_submission_and_the_others_are_left_alone() {
    let printed = goes_right(&["layers"]);
    assert!(
        printed.contains("layers: 0 bytes differ, 0 of other parts"),
        "{printed}"
    );
}

#[test]
fn images_change_hands_between_families_of_queues() {
    let printed = goes_right(&["owners"]);
    assert_eq!(
        printed.matches("3 acquired, 3 released").count(),
        2,
        "{printed}"
    );
}

#[test]
fn every_format_and_layout_is_drawn_into_and_several_views_at_once() {
    let printed = goes_right(&["formats"]);
    assert_eq!(
        printed.matches(": 0 values are wrong").count(),
        8,
        "{printed}"
    );
}

#[test]
fn eight_frames_are_handed_over_without_a_wait_and_the_ninth_waits() {
    goes_right(&["backlog"]);
}

#[test]
fn what_is_wrong_is_refused_with_a_sentence_and_submits_nothing() {
    goes_right(&["refusals"]);
}

#[test]
fn a_device_that_falls_short_is_told_from_one_that_does_not() {
    goes_right(&["short"]);
}

#[test]
fn the_queue_is_used_with_the_hosts_lock_held() {
    goes_right(&["lock"]);
}

#[test]
fn a_lost_device_and_one_without_memory_are_errors_and_the_context_can_be_destroyed() {
    goes_right(&["lost"]);
}

#[test]
fn two_hundred_contexts_on_two_threads_leave_nothing_behind() {
    goes_right(&["stress", "20"]);
    // The layer itself grows with every object.
    let printed = run(Command::new(program())
        .args(["stress", "200"])
        .env_remove("VK_INSTANCE_LAYERS"));
    assert_eq!(printed.lines().last(), Some("0 failures"), "{printed}");
}

#[test]
fn the_example_draws_hair_between_its_own_passes() {
    let folder = folder("vulkan_host");
    let program = compile(
        "vulkan_host",
        "examples/c/vulkan_host.c",
        &["-lvulkan", "-lm"],
    );
    let printed = validated(
        Command::new(program)
            .args(["picture.png", "2000"])
            .current_dir(&folder),
    );
    silent(&printed);
    assert!(
        printed.contains("2000 strands") && printed.contains("wrote picture.png"),
        "{printed}"
    );
    let file = std::io::BufReader::new(std::fs::File::open(folder.join("picture.png")).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (480, 640));
    let pixels: Vec<_> = pixels.chunks(3).collect();
    let wall = pixels[0];
    let hairy = pixels.iter().filter(|pixel| **pixel != wall).count();
    assert!(
        hairy > 480 * 640 / 10,
        "{hairy} pixels show hair or a sphere"
    );
    // The ball of the last pass is bluer than anything else, and hair stands before a part of it.
    let blue = pixels
        .iter()
        .filter(|pixel| pixel[2] > pixel[0].saturating_add(30))
        .count();
    assert!(
        (1_000..12_000).contains(&blue),
        "{blue} pixels show the ball"
    );
}
