//! Lists of numbers as the page reads them: bytes, packed by gzip, in base64.
//!
//! Before that each number is taken from the one a stride before it, as integers of its bytes, and bytes of the same place are put beside
//! each other: neighbours differ little, so that most high bytes are zero. No bit is lost.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::packed::packed;

/// Steps to the greatest magnitude of shapes, whose form is seen and exaggerated.
const FINE: f64 = i16::MAX as f64;
/// Steps to the greatest magnitude of stresses, which are seen as 256 colours.
const COARSE: f64 = 2047.0;

/// A list of numbers of one type, and the factor that takes them to what they stand for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Numbers {
    r#type: &'static str,
    factor: f64,
    stride: usize,
    packed: String,
}

impl Numbers {
    fn of_bytes<const N: usize>(
        r#type: &'static str,
        factor: f64,
        stride: usize,
        values: impl Iterator<Item = [u8; N]>,
    ) -> Self {
        let values: Vec<[u8; N]> = values.collect();
        Self { r#type, factor, stride, packed: STANDARD.encode(packed(&in_planes(&values, stride))) }
    }

    /// In double precision.
    pub(crate) fn double(values: impl Iterator<Item = f64>) -> Self {
        Self::of_bytes("f64", 1.0, 1, values.map(f64::to_le_bytes))
    }

    /// In single precision, with the number of components in a row.
    pub(crate) fn single(values: impl Iterator<Item = f64>, components: usize) -> Self {
        Self::of_bytes("f32", 1.0, components.max(1), values.map(|value| (value as f32).to_le_bytes()))
    }

    /// Indices below `count`, in two bytes where that is enough.
    pub(crate) fn indices(indices: &[u32], count: usize) -> Self {
        if count <= 1 << 16 {
            Self::of_bytes("u16", 1.0, 1, indices.iter().map(|index| (*index as u16).to_le_bytes()))
        } else {
            Self::of_bytes("u32", 1.0, 1, indices.iter().map(|index| index.to_le_bytes()))
        }
    }

    /// In steps of 1/32767 of the greatest magnitude: the error is at most half a step, 1.6e-5 of it.
    pub(crate) fn quantised<const N: usize>(values: &[[f32; N]]) -> Self {
        Self::in_steps(values, FINE)
    }

    /// In steps of 1/2047 of the greatest magnitude: the error is at most half a step, 2.5e-4 of it.
    pub(crate) fn coarse<const N: usize>(values: &[[f32; N]]) -> Self {
        Self::in_steps(values, COARSE)
    }

    fn in_steps<const N: usize>(values: &[[f32; N]], steps: f64) -> Self {
        let values = values.as_flattened();
        let greatest = values.iter().fold(0.0_f32, |greatest, value| greatest.max(value.abs()));
        let step = if greatest > 0.0 { f64::from(greatest) / steps } else { 1.0 };
        let count = |value: &f32| ((f64::from(*value) / step).round() as i16).to_le_bytes();
        Self::of_bytes("i16", step, N, values.iter().map(count))
    }
}

/// Differences to the numbers a stride before, as little-endian integers; first the low bytes of all, then the next ones.
fn in_planes<const N: usize>(values: &[[u8; N]], stride: usize) -> Vec<u8> {
    let mut planes = vec![0; N * values.len()];
    for (i, value) in values.iter().enumerate() {
        let before = i.checked_sub(stride).map_or([0; N], |before| values[before]);
        let mut borrow = false;
        for byte in 0..N {
            let (difference, first) = value[byte].overflowing_sub(before[byte]);
            let (difference, second) = difference.overflowing_sub(u8::from(borrow));
            borrow = first || second;
            planes[byte * values.len() + i] = difference;
        }
    }
    planes
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use flate2::read::GzDecoder;

    use super::{Engine, Numbers, STANDARD};

    /// The numbers as the page unpacks them, as integers of `bytes` bytes.
    fn unpacked(numbers: &Numbers, bytes: usize) -> Vec<u64> {
        let mut planes = Vec::new();
        GzDecoder::new(&STANDARD.decode(&numbers.packed).unwrap()[..]).read_to_end(&mut planes).unwrap();
        let count = planes.len() / bytes;
        let mask = u64::MAX >> (64 - 8 * bytes);
        let mut values = vec![0_u64; count];
        for i in 0..count {
            let difference = (0..bytes).map(|byte| u64::from(planes[byte * count + i]) << (8 * byte)).sum::<u64>();
            let before = i.checked_sub(numbers.stride).map_or(0, |before| values[before]);
            values[i] = before.wrapping_add(difference) & mask;
        }
        values
    }

    /// Closed form: half a step of 16 and of 12 bits.
    #[test]
    fn numbers_in_steps_come_back_within_half_a_step() {
        let values: Vec<[f32; 1]> = (0..1000).map(|i| [(f64::from(i) * 0.37).sin() as f32 * 3.7e-5]).collect();
        let greatest = values.iter().fold(0.0_f32, |greatest, [value]| greatest.max(value.abs()));
        for (numbers, bound) in [(Numbers::quantised(&values), 1.6e-5), (Numbers::coarse(&values), 2.5e-4)] {
            let mut worst = 0.0_f64;
            for ([value], bits) in values.iter().zip(unpacked(&numbers, 2)) {
                let back = f64::from(bits as u16 as i16) * numbers.factor;
                worst = worst.max((back - f64::from(*value)).abs());
            }
            assert!(worst <= bound * f64::from(greatest) && worst > 0.5 * bound * f64::from(greatest), "{worst}");
        }
        assert_eq!(unpacked(&Numbers::quantised(&[[0.0], [0.0]]), 2), [0, 0]);
    }

    /// Conserved: every bit, whatever the stride.
    #[test]
    fn no_bit_of_a_list_is_lost() {
        let values: Vec<f64> = (0..500).map(|i| (f64::from(i) * 12.9898).sin() * 1e3_f64.powi(i % 7 - 3)).collect();
        let back = unpacked(&Numbers::double(values.iter().copied()), 8);
        assert!(values.iter().zip(&back).all(|(value, bits)| value.to_bits() == *bits));
        for components in [0, 1, 3, 7, 600] {
            let back = unpacked(&Numbers::single(values.iter().copied(), components), 4);
            assert!(values.iter().zip(&back).all(|(value, bits)| u64::from((*value as f32).to_bits()) == *bits));
        }
        let indices = [7, 3, 65_535, 0, 12];
        assert_eq!(unpacked(&Numbers::indices(&indices, 65_536), 2), indices.map(u64::from));
        assert_eq!(unpacked(&Numbers::indices(&[258, 70_000], 70_001), 4), [258, 70_000]);
        assert_eq!([Numbers::indices(&[258], 65_536).r#type, Numbers::indices(&[258], 65_537).r#type], ["u16", "u32"]);
    }

    /// Smooth courses have a small part of their bytes.
    #[test]
    fn what_changes_little_takes_little_room() {
        let times = Numbers::double((0..4000).map(|i| 1e-3 * f64::from(i)));
        assert!(times.packed.len() < 4000 * 8 / 4, "{}", times.packed.len());
    }
}
