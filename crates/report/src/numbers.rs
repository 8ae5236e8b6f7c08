//! Lists of numbers as the page reads them: little-endian bytes in base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// A list of numbers of one type, and the factor that takes them to what they stand for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Numbers {
    r#type: &'static str,
    factor: f64,
    base64: String,
}

impl Numbers {
    fn of_bytes<const N: usize>(r#type: &'static str, factor: f64, values: impl Iterator<Item = [u8; N]>) -> Self {
        let bytes: Vec<u8> = values.flatten().collect();
        Self { r#type, factor, base64: STANDARD.encode(bytes) }
    }

    /// In double precision.
    pub(crate) fn double(values: impl Iterator<Item = f64>) -> Self {
        Self::of_bytes("f64", 1.0, values.map(f64::to_le_bytes))
    }

    /// In single precision.
    pub(crate) fn single(values: impl Iterator<Item = f64>) -> Self {
        Self::of_bytes("f32", 1.0, values.map(|value| (value as f32).to_le_bytes()))
    }

    /// Indices below `count`, in two bytes where that is enough.
    pub(crate) fn indices(indices: &[u32], count: usize) -> Self {
        if count <= 1 << 16 {
            Self::of_bytes("u16", 1.0, indices.iter().map(|index| (*index as u16).to_le_bytes()))
        } else {
            Self::of_bytes("u32", 1.0, indices.iter().map(|index| index.to_le_bytes()))
        }
    }

    /// In steps of 1/32767 of the greatest magnitude: the error is at most half a step, 1.6e-5 of it.
    pub(crate) fn quantised(values: &[f32]) -> Self {
        let greatest = values.iter().fold(0.0_f32, |greatest, value| greatest.max(value.abs()));
        let step = if greatest > 0.0 { f64::from(greatest) / f64::from(i16::MAX) } else { 1.0 };
        let count = |value: &f32| ((f64::from(*value) / step).round() as i16).to_le_bytes();
        Self::of_bytes("i16", step, values.iter().map(count))
    }
}

#[cfg(test)]
mod tests {
    use super::{Engine, Numbers, STANDARD};

    /// Closed form: half a step of 16 bits.
    #[test]
    fn quantised_numbers_come_back_within_half_a_step() {
        let values: Vec<f32> = (0..1000).map(|i| (f64::from(i) * 0.37).sin() as f32 * 3.7e-5).collect();
        let numbers = Numbers::quantised(&values);
        let bytes = STANDARD.decode(&numbers.base64).unwrap();
        let greatest = values.iter().fold(0.0_f32, |greatest, value| greatest.max(value.abs()));
        let mut worst = 0.0_f64;
        for (value, pair) in values.iter().zip(bytes.chunks_exact(2)) {
            let back = f64::from(i16::from_le_bytes([pair[0], pair[1]])) * numbers.factor;
            worst = worst.max((back - f64::from(*value)).abs());
        }
        assert!(worst <= 1.6e-5 * f64::from(greatest) && worst > 0.0, "{worst}");
        assert_eq!(Numbers::quantised(&[0.0, 0.0]).base64, "AAAAAA==");
    }

    #[test]
    fn types_are_little_endian_and_as_small_as_they_may_be() {
        assert_eq!(Numbers::single([1.0].into_iter()).base64, STANDARD.encode([0, 0, 128, 63]));
        assert_eq!(Numbers::indices(&[258], 65_536), Numbers { r#type: "u16", factor: 1.0, base64: "AgE=".into() });
        assert_eq!(Numbers::indices(&[258], 65_537).r#type, "u32");
    }
}
