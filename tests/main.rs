//! All tests of the library as one binary.

mod capi;
mod groom;
mod render;
