//! Several threads, several contexts.

use super::support::*;
use pelage::capi::*;

#[test]
fn contexts_on_two_threads_draw_the_same_picture() {
    let draw = || {
        let context = Context::new();
        let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA32F, false));
        (0..8).for_each(|_| ok(render(&context, &[hair], target, PELAGE_RENDER_CLEAR)));
        read(target)
    };
    let (one, other) = std::thread::scope(|scope| {
        let (one, other) = (scope.spawn(draw), scope.spawn(draw));
        (one.join().unwrap(), other.join().unwrap())
    });
    assert!(one == other && one[MIDDLE][3] > 0.99);
}

#[test]
fn one_context_serves_several_threads_and_may_be_destroyed_under_them() {
    let context = Context::new();
    let (hair, target) = (context.hair(), context.target(PELAGE_FORMAT_RGBA16F, false));
    let id = context.0;
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                for _ in 0..1000 {
                    let result = render(&context, &[hair], target, PELAGE_RENDER_CLEAR);
                    let mut pixels = vec![0.0f32; (SIDE * SIDE * 4) as usize];
                    let size = size_of_val(&pixels[..]) as u64;
                    // SAFETY: the array is as large as it says.
                    unsafe { pelage_target_read_colour(target, pixels.as_mut_ptr(), size) };
                    if result != PELAGE_OK {
                        return fails(result, PELAGE_INVALID_HANDLE, "stale");
                    }
                }
            });
        }
        std::thread::sleep(std::time::Duration::from_millis(200));
        ok(pelage_context_destroy(id));
    });
}

#[test]
fn the_last_error_is_each_threads_own() {
    fails(
        pelage_wait(PelageContext { id: 0 }),
        PELAGE_INVALID_HANDLE,
        "NULL",
    );
    std::thread::spawn(|| assert_eq!(last_error(), ""))
        .join()
        .unwrap();
    fails(PELAGE_INVALID_HANDLE, PELAGE_INVALID_HANDLE, "NULL");
}
