//! All tests of the library as one binary.

mod groom;
mod render;
