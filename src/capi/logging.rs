//! The log: what the library has to say beside its errors, handed to the host's callback.

use std::cell::{Cell, RefCell};
use std::ffi::{CStr, CString, c_char, c_void};
use std::sync::{OnceLock, RwLock};

use log::{LevelFilter, Log, Metadata, Record};

use super::error::{PelageResult, c_string, guard};
use crate::error::{Error, Result, invalid};

/// No messages.
pub const PELAGE_LOG_OFF: u32 = 0;
/// Faults of the library.
pub const PELAGE_LOG_ERROR: u32 = 1;
/// What a host should know: a fragment pool that was too small.
pub const PELAGE_LOG_WARN: u32 = 2;
/// Steps of the device's setup.
pub const PELAGE_LOG_INFO: u32 = 3;
/// For the library's developers.
pub const PELAGE_LOG_DEBUG: u32 = 4;
/// For the library's developers, very much of it.
pub const PELAGE_LOG_TRACE: u32 = 5;

/// Receives one message, UTF-8, valid for the length of the call; `user` is what was given with the callback.
///
/// Called on any thread: mostly at the end of the `pelage_…` call that caused the message, when the library holds no lock,
/// so that it may call any function of the library but `pelage_set_log_callback`. What the library logs meanwhile on the
/// same thread is dropped. It must return: no exception, no longjmp.
pub type PelageLogCallback =
    Option<unsafe extern "C" fn(level: u32, message: *const c_char, user: *mut c_void)>;

/// Sets the callback that receives the log of the whole process up to `level` (`PELAGE_LOG_…`); NULL, the default, for
/// none. There is one: a new one replaces it.
///
/// When it returns, the old callback is running on no thread and will not be called again. It therefore waits for one that
/// runs: do not call it with a lock held for which the callback waits. Any thread.
///
/// Errors: an unknown level; a call from within the callback; a Rust host that has set a logger of its own
/// (`PELAGE_UNSUPPORTED`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pelage_set_log_callback(
    level: u32,
    callback: PelageLogCallback,
    user: *mut c_void,
) -> PelageResult {
    guard(|| set(level, callback.map(|function| Callback { function, user })))
}

/// The host's callback.
#[derive(Clone, Copy)]
struct Callback {
    function: unsafe extern "C" fn(u32, *const c_char, *mut c_void),
    user: *mut c_void,
}

// SAFETY: the host promises that its callback may be called, with its pointer, on any thread.
unsafe impl Send for Callback {}
// SAFETY: as above.
unsafe impl Sync for Callback {}

static CALLBACK: RwLock<Option<Callback>> = RwLock::new(None);
static INSTALLED: OnceLock<bool> = OnceLock::new();

thread_local! {
    /// Calls of the library that are under way on this thread.
    static CALLS: Cell<u32> = const { Cell::new(0) };
    /// Messages that wait for their end.
    static WAITING: RefCell<Vec<(u32, CString)>> = const { RefCell::new(Vec::new()) };
    /// Whether the callback is running on this thread.
    static DELIVERING: Cell<bool> = const { Cell::new(false) };
}

fn set(level: u32, callback: Option<Callback>) -> Result<()> {
    let filter = match level {
        PELAGE_LOG_OFF => LevelFilter::Off,
        PELAGE_LOG_ERROR => LevelFilter::Error,
        PELAGE_LOG_WARN => LevelFilter::Warn,
        PELAGE_LOG_INFO => LevelFilter::Info,
        PELAGE_LOG_DEBUG => LevelFilter::Debug,
        PELAGE_LOG_TRACE => LevelFilter::Trace,
        _ => return invalid!("level {level} is not one of PELAGE_LOG_…"),
    };
    if DELIVERING.get() {
        return invalid!("the log callback cannot be set from within the log callback");
    }
    if callback.is_some() && !INSTALLED.get_or_init(|| log::set_logger(&Logger).is_ok()) {
        return Err(Error::Unsupported(
            "this process has another logger; take pelage's messages from that".into(),
        ));
    }
    let mut current = CALLBACK
        .write()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    *current = callback;
    if INSTALLED.get() == Some(&true) {
        log::set_max_level(if current.is_some() {
            filter
        } else {
            LevelFilter::Off
        });
    }
    Ok(())
}

/// Hands records to the callback.
struct Logger;

impl Log for Logger {
    fn enabled(&self, _: &Metadata) -> bool {
        !DELIVERING.try_with(Cell::get).unwrap_or(true)
    }

    fn log(&self, record: &Record) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let text = match record.target() {
            own if own.starts_with("pelage") => record.args().to_string(),
            other => format!("{other}: {}", record.args()),
        };
        let (level, message) = (record.level() as u32, c_string(&text));
        if CALLS.try_with(Cell::get).unwrap_or(0) > 0 {
            WAITING
                .try_with(|waiting| waiting.borrow_mut().push((level, message)))
                .ok();
        } else {
            deliver(level, &message);
        }
    }

    fn flush(&self) {}
}

/// Calls the callback, if there is one.
fn deliver(level: u32, message: &CStr) {
    let current = CALLBACK
        .read()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some(callback) = *current {
        DELIVERING.set(true);
        // SAFETY: the lock keeps the callback set, which the host promises to be callable with its pointer until then.
        unsafe { (callback.function)(level, message.as_ptr(), callback.user) };
        DELIVERING.set(false);
    }
}

/// While it lives, messages of this thread wait; the outermost one's end delivers them.
pub(super) struct Held;

/// See [`Held`].
pub(super) fn hold() -> Held {
    CALLS.set(CALLS.get() + 1);
    Held
}

impl Drop for Held {
    fn drop(&mut self) {
        CALLS.set(CALLS.get() - 1);
        if CALLS.get() == 0 && !DELIVERING.get() {
            let waiting = WAITING.with(|waiting| std::mem::take(&mut *waiting.borrow_mut()));
            waiting
                .iter()
                .for_each(|(level, message)| deliver(*level, message));
        }
    }
}
