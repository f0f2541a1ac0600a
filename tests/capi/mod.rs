//! The C ABI, as a C host sees it.

mod header;
