//! pelage renders hair and fur inside other people's programs.

pub mod error;
pub mod groom;

pub use error::{Error, Result};
