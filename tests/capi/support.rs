//! What the C ABI's tests share. They call the library as C does, through pointers.

use std::ffi::CStr;

use pelage::capi::*;

/// A square target's side in pixels.
pub const SIDE: u32 = 32;

/// The sentence of this thread's last error.
pub fn last_error() -> String {
    // SAFETY: the sentence is valid until the next failing call on this thread.
    unsafe { CStr::from_ptr(pelage_last_error()) }
        .to_str()
        .unwrap()
        .into()
}

/// A call that must work.
#[track_caller]
pub fn ok(result: PelageResult) {
    assert_eq!(result, PELAGE_OK, "{}", last_error());
}

/// A call that must fail with `status`, and with a sentence that holds the parts of `words` between "…", in this order.
#[track_caller]
pub fn fails(result: PelageResult, status: PelageResult, words: &str) {
    let sentence = last_error();
    assert_eq!(result, status, "{sentence}");
    let mut rest = sentence.as_str();
    for word in words.split('…') {
        match rest.split_once(word) {
            Some((_, after)) => rest = after,
            None => panic!("{sentence:?} does not hold {words:?}"),
        }
    }
}

/// A call that must fail with `PELAGE_INVALID_VALUE`.
#[track_caller]
pub fn wrong(result: PelageResult, words: &str) {
    fails(result, PELAGE_INVALID_VALUE, words);
}

/// A software context, destroyed at the end.
pub struct Context(pub PelageContext);

impl Context {
    pub fn new() -> Self {
        let descriptor = PelageContextDescriptor {
            force_software: 1,
            ..Default::default()
        };
        let mut context = PelageContext::default();
        // SAFETY: both pointers are to values of their types.
        ok(unsafe { pelage_context_create(&descriptor, &mut context) });
        Self(context)
    }

    /// Two crossing strands around the origin, in the plane z = 0.
    pub fn hair(&self) -> PelageHair {
        let mut hair = PelageHair::default();
        let arrays = Arrays::crossing();
        // SAFETY: both pointers are to values of their types, the arrays are as long as they say.
        ok(unsafe { pelage_hair_create_from_strands(self.0, &arrays.strands(), &mut hair) });
        hair
    }

    /// A target of `SIDE` × `SIDE` pixels.
    pub fn target(&self, format: u32, with_depth: bool) -> PelageTarget {
        let descriptor = PelageTargetDescriptor {
            width: SIDE,
            height: SIDE,
            format,
            with_depth: u32::from(with_depth),
            ..Default::default()
        };
        let mut target = PelageTarget::default();
        // SAFETY: both pointers are to values of their types.
        ok(unsafe { pelage_target_create(self.0, &descriptor, &mut target) });
        target
    }

    pub fn statistics(&self) -> PelageStatistics {
        let mut statistics = PelageStatistics::default();
        // SAFETY: the pointer is to a value of its type.
        ok(unsafe { pelage_statistics(self.0, &mut statistics) });
        statistics
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        pelage_context_destroy(self.0);
    }
}

/// Arrays of strands, which a descriptor points to.
pub struct Arrays {
    pub positions: Vec<[f32; 3]>,
    pub counts: Vec<u32>,
}

impl Arrays {
    pub fn crossing() -> Self {
        let positions = vec![
            [-1.0, -1.0, 0.0],
            [0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, -1.0, 0.1],
            [-1.0, 1.0, 0.1],
        ];
        Self {
            positions,
            counts: vec![3, 2],
        }
    }

    pub fn strands(&self) -> PelageStrands {
        PelageStrands {
            positions: self.positions.as_ptr().cast(),
            point_count: self.positions.len() as u64,
            counts: self.counts.as_ptr(),
            strand_count: self.counts.len() as u64,
            root_radius: 0.1,
            tip_radius: 0.1,
            ..Default::default()
        }
    }
}

/// A view of the origin from 3 units along z.
pub fn view() -> PelageView {
    let mut view = PelageView::default();
    let (eye, target, up) = ([0.0, 0.0, 3.0], [0.0; 3], [0.0, 1.0, 0.0]);
    // SAFETY: three doubles each, and a value of its type.
    ok(unsafe {
        pelage_view_perspective(
            eye.as_ptr(),
            target.as_ptr(),
            up.as_ptr(),
            0.9,
            1.0,
            0.1,
            10.0,
            &mut view,
        )
    });
    view
}

/// A frame of its parts, which it points to.
pub fn frame(hairs: &[PelageHair], lights: &[PelageLight], view: &PelageView) -> PelageFrame {
    PelageFrame {
        hair_count: hairs.len() as u32,
        hairs: hairs.as_ptr(),
        lights: lights.as_ptr(),
        light_count: lights.len() as u32,
        view,
        ambient: [0.1; 3],
        ..Default::default()
    }
}

/// Renders hairs under one light, without an opaque scene.
pub fn render(
    context: &Context,
    hairs: &[PelageHair],
    target: PelageTarget,
    flags: u32,
) -> PelageResult {
    let (lights, view) = ([PelageLight::default()], view());
    // SAFETY: the frame points to values that live.
    unsafe { pelage_render(context.0, &frame(hairs, &lights, &view), target, flags) }
}

/// A target's colour.
pub fn read(target: PelageTarget) -> Vec<[f32; 4]> {
    let mut pixels = vec![[f32::NAN; 4]; (SIDE * SIDE) as usize];
    // SAFETY: the array is as large as it says.
    ok(unsafe {
        pelage_target_read_colour(
            target,
            pixels.as_mut_ptr().cast(),
            size_of_val(&pixels[..]) as u64,
        )
    });
    pixels
}

/// The middle pixel.
pub const MIDDLE: usize = (SIDE * SIDE / 2 + SIDE / 2) as usize;

/// What an output holds before a call that fails, and after it.
pub const UNTOUCHED: u64 = 0x5555;

/// Makes a hair of strands that may be wrong.
pub fn create(context: &Context, strands: &PelageStrands) -> PelageResult {
    let mut hair = PelageHair { id: UNTOUCHED };
    // SAFETY: the pointers are to values of their types, or wrong on purpose in a way that the call must notice.
    let result = unsafe { pelage_hair_create_from_strands(context.0, strands, &mut hair) };
    assert_eq!(
        result == PELAGE_OK,
        hair.id != UNTOUCHED,
        "an output is written by success alone"
    );
    result
}
