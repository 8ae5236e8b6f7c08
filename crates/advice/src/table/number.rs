//! Numbers for people to read.

use std::fmt;

/// A number with four digits: as a decimal where that is short, with a power of ten where it is very small or large.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        if magnitude == 0.0 {
            write!(f, "0")
        } else if (1e-2..1e5).contains(&magnitude) {
            let decimals = (3 - magnitude.log10().floor() as i32).max(0) as usize;
            write!(f, "{:.decimals$}", self.0)
        } else {
            write!(f, "{:.3e}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Number;

    #[test]
    fn no_small_number_is_written_as_zero() {
        let texts = [0.0, 3.2e-5, 0.0123456, 1.0, 160.04, 12345.6, -2.5e7].map(|x| Number(x).to_string());
        assert_eq!(texts, ["0", "3.200e-5", "0.01235", "1.000", "160.0", "12346", "-2.500e7"]);
    }
}
