//! A part of a whole.

/// part/whole, at most 1; 1 where something is changed of nothing.
pub(crate) fn relative(part: f64, whole: f64) -> f64 {
    if part <= 0.0 {
        0.0
    } else if part >= whole || part.is_nan() || whole.is_nan() {
        1.0
    } else {
        part / whole
    }
}
