//! What can go wrong, each as one sentence that names the value at fault.

/// An error of the library. Its `Display` is one sentence that names the value at fault.
///
/// After an error nothing has changed: what was given before is kept, and what was asked for has not been done.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A value given by the host is out of range, not finite, or does not fit the others.
    #[error("{0}")]
    InvalidValue(String),
    /// Bytes of a file do not follow their format.
    #[error("{0}")]
    InvalidFile(String),
    /// A handle is NULL, was destroyed, or belongs to something else.
    #[error("{0}")]
    InvalidHandle(String),
    /// Hairs of one frame wish for different techniques and the frame names none.
    #[error("{0}")]
    Conflict(String),
    /// The adapter, the driver or a target cannot do what was asked.
    #[error("{0}")]
    Unsupported(String),
    /// No memory was left, on the GPU or within the host's byte budget.
    #[error("{0}")]
    OutOfMemory(String),
    /// The device is lost. The context is dead, and safe to drop.
    #[error("the device is lost: {0}")]
    DeviceLost(String),
    /// A fault of the library itself.
    #[error("internal error: {0}")]
    Internal(String),
}

/// The result of a call of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// `Err(Error::InvalidValue(format!(…)))`.
macro_rules! invalid {
    ($($argument:tt)*) => { Err($crate::error::Error::InvalidValue(format!($($argument)*))) };
}
pub(crate) use invalid;
