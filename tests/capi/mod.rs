//! The C ABI, as a C host sees it.

mod handles;
mod header;
mod hostile;
mod programs;
mod rendering;
mod support;
