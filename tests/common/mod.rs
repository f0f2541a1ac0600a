//! What all tests on a device share: one device a process, whose messages are watched; images compared with the
//! reference, and written where they differ.

pub mod images;
pub mod scenes;

use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, MutexGuard, Once, OnceLock};

use pelage::Renderer;
use pelage::host::offscreen::{Offscreen, OffscreenOptions};

/// Messages since the device was taken: errors of any origin, and whatever the validation layer warns of.
static MESSAGES: Mutex<Vec<String>> = Mutex::new(Vec::new());
static DEVICE: OnceLock<Option<Mutex<Offscreen>>> = OnceLock::new();

struct Recorder;

impl log::Log for Recorder {
    fn enabled(&self, metadata: &log::Metadata) -> bool {
        metadata.level() <= log::Level::Warn
    }

    fn log(&self, record: &log::Record) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let message = format!("{} {}: {}", record.level(), record.target(), record.args());
        eprintln!("{message}");
        let validation = record.target().starts_with("wgpu_hal")
            && message.to_lowercase().contains("validation");
        if record.level() == log::Level::Error || validation {
            lock(&MESSAGES).push(message);
        }
    }

    fn flush(&self) {}
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// The process's device, taken for one test. When it is given back no message may have come.
pub struct Device(MutexGuard<'static, Offscreen>);

impl Deref for Device {
    type Target = Offscreen;
    fn deref(&self) -> &Offscreen {
        &self.0
    }
}

impl DerefMut for Device {
    fn deref_mut(&mut self) -> &mut Offscreen {
        &mut self.0
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        let messages = std::mem::take(&mut *lock(&MESSAGES));
        if !std::thread::panicking() {
            assert!(
                messages.is_empty(),
                "the device complained:\n{}",
                messages.join("\n")
            );
        }
    }
}

impl Device {
    /// Makes a renderer that remembers no frame. Hair made before is the old one's, and not to be drawn any more.
    pub fn forget(&mut self) {
        let (device, queue) = (
            self.renderer.device().clone(),
            self.renderer.queue().clone(),
        );
        self.renderer = Renderer::new(&device, &queue).unwrap();
    }
}

/// Takes the process's device, with a renderer that remembers no frame. Where there is none the test is skipped, which in CI is a failure.
pub fn device() -> Option<Device> {
    static RECORDER: Once = Once::new();
    RECORDER.call_once(|| {
        log::set_logger(&Recorder).unwrap();
        log::set_max_level(log::LevelFilter::Warn);
    });
    let opened = DEVICE.get_or_init(|| {
        match Offscreen::new(&OffscreenOptions {
            validation: true,
            ..Default::default()
        }) {
            Ok(offscreen) => {
                eprintln!("device: {}", offscreen.adapter_info().name);
                Some(Mutex::new(offscreen))
            }
            Err(error) => {
                eprintln!("{error}");
                None
            }
        }
    });
    let Some(offscreen) = opened else {
        println!(
            "skipped: {}: no Vulkan adapter",
            std::thread::current().name().unwrap_or("a test")
        );
        assert!(
            std::env::var_os("CI").is_none(),
            "no test may be skipped in CI"
        );
        return None;
    };
    let mut taken = Device(lock(offscreen));
    taken.forget();
    Some(taken)
}
