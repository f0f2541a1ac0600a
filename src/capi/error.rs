//! Results, the sentence of the last error, and the one wrapper in which every call runs.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::logging;
use crate::error::{Error, Result};

/// What a call returns: `PELAGE_OK`, or what went wrong. After an error nothing has changed, and `pelage_last_error`
/// says in one sentence what was wrong with which value.
pub type PelageResult = u32;

/// Done.
pub const PELAGE_OK: u32 = 0;
/// A value is out of range, not finite, NULL where it must not be, or does not fit the others.
pub const PELAGE_INVALID_VALUE: u32 = 1;
/// Bytes of a file do not follow their format.
pub const PELAGE_INVALID_FILE: u32 = 2;
/// A handle is NULL, was destroyed, or belongs to something else.
pub const PELAGE_INVALID_HANDLE: u32 = 3;
/// Hairs of one frame wish for different techniques and the frame names none.
pub const PELAGE_CONFLICT: u32 = 4;
/// The adapter, the driver or a target cannot do what was asked.
pub const PELAGE_UNSUPPORTED: u32 = 5;
/// No memory was left, on the GPU or within the byte budget.
pub const PELAGE_OUT_OF_MEMORY: u32 = 6;
/// The device is lost. The context is dead; destroy it.
pub const PELAGE_DEVICE_LOST: u32 = 7;
/// A fault of the library itself.
pub const PELAGE_INTERNAL: u32 = 8;
/// A fault of the library itself, caught while it unwound. The context of the call is dead; destroy it.
pub const PELAGE_PANIC: u32 = 9;

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// The sentence of the latest call on this thread that failed; empty if none has. It names the value at fault.
///
/// UTF-8, valid until the next failing call on the same thread; never NULL. Calls that succeed keep it. Cannot fail;
/// takes no lock, so that it may be called from the log callback too (where it is still the sentence of an earlier call).
#[unsafe(no_mangle)]
pub extern "C" fn pelage_last_error() -> *const c_char {
    LAST_ERROR
        .try_with(|last| last.borrow().as_ptr())
        .unwrap_or(c"".as_ptr())
}

/// Runs a call: an error becomes its status and the thread's last error, a panic goes no further, and the log is
/// delivered when all locks have been released.
pub(super) fn guard(call: impl FnOnce() -> Result<()>) -> PelageResult {
    let held = logging::hold();
    let outcome = catch_unwind(AssertUnwindSafe(call));
    drop(held);
    let (status, sentence) = match outcome {
        Ok(Ok(())) => return PELAGE_OK,
        Ok(Err(error)) => (status(&error), error.to_string()),
        Err(panic) => (
            PELAGE_PANIC,
            format!("internal error, caught: {}", message(&*panic)),
        ),
    };
    LAST_ERROR
        .try_with(|last| *last.borrow_mut() = c_string(&sentence))
        .ok();
    status
}

fn status(error: &Error) -> PelageResult {
    match error {
        Error::InvalidValue(_) => PELAGE_INVALID_VALUE,
        Error::InvalidFile(_) => PELAGE_INVALID_FILE,
        Error::InvalidHandle(_) => PELAGE_INVALID_HANDLE,
        Error::Conflict(_) => PELAGE_CONFLICT,
        Error::Unsupported(_) => PELAGE_UNSUPPORTED,
        Error::OutOfMemory(_) => PELAGE_OUT_OF_MEMORY,
        Error::DeviceLost(_) => PELAGE_DEVICE_LOST,
        Error::Internal(_) => PELAGE_INTERNAL,
    }
}

/// What a panic says.
fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or(panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("a panic without words")
}

/// Text for C: a NUL inside would end it early.
pub(super) fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last() -> String {
        // SAFETY: the sentence is valid until the next failing call on this thread.
        unsafe { std::ffi::CStr::from_ptr(pelage_last_error()) }
            .to_string_lossy()
            .into_owned()
    }

    #[test]
    fn a_panic_becomes_a_status_and_a_sentence() {
        assert_eq!(guard(|| panic!("strand {} fell out", 7)), PELAGE_PANIC);
        assert_eq!(last(), "internal error, caught: strand 7 fell out");
    }

    #[test]
    fn success_keeps_the_last_error() {
        assert_eq!(
            guard(|| Err(Error::Conflict("a\0b".into()))),
            PELAGE_CONFLICT
        );
        assert_eq!(guard(|| Ok(())), PELAGE_OK);
        assert_eq!(last(), "a\u{fffd}b");
    }
}
