//! Double-precision ground truth.
