//! Sizes as people read them.

use std::fmt;

/// A number of bytes for people to read: "841 MB", "1.5 GB".
#[derive(Debug, Clone, Copy)]
pub struct Bytes(pub usize);

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.0 as f64;
        if bytes < 999.5e6 { write!(f, "{:.0} MB", (bytes * 1e-6).ceil()) } else { write!(f, "{:.1} GB", bytes * 1e-9) }
    }
}
