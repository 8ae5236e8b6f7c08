//! How an axis shows its values: its range, where its ticks are, and what they say.
//!
//! plotters draws axes, but its own ticks are not used: they are wrong where a range is below 1e-16, such as that of a
//! balance of energy, and its logarithmic axis has none below 2e-16.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;

/// How an axis maps values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// Evenly, between two values, the lower one first: lines are cut off there, and points beyond are left out.
    Window(f64, f64),
    /// By decades; values must be positive.
    Log,
}

/// An axis. It counts in shown values: in decades if it is logarithmic, else in `unit` from `offset`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    is_log: bool,
    offset: f64,
    unit: f64,
    decimals: usize,
    /// Lowest and highest shown value.
    pub(crate) range: (f64, f64),
    ticks: Vec<f64>,
    /// Ticks without a label.
    minor: Vec<f64>,
    /// Factor and offset of all labels, "×10⁻³" or "+ 0.00935".
    pub(crate) note: String,
}

impl Axis {
    /// An axis for these values, with about `count` ticks. A linear one has a margin on both sides, as a fraction of the
    /// extent of the values.
    pub(crate) fn new(scale: Scale, values: impl IntoIterator<Item = f64>, margin: f64, count: usize) -> Self {
        let empty = (f64::INFINITY, f64::NEG_INFINITY);
        let (min, max) = values.into_iter().fold(empty, |(min, max), v| (min.min(v), max.max(v)));
        match scale {
            Scale::Linear => Self::linear(linear_range(min, max, margin), count),
            Scale::Window(min, max) => Self::linear((min, max), count),
            Scale::Log => Self::logarithmic(decades(min, max), count),
        }
    }

    /// Ticks at round numbers (1, 2, 5 times a power of ten apart).
    fn linear((min, max): (f64, f64), count: usize) -> Self {
        let step = round_step((max - min) / count.max(1) as f64);
        // Many digits in front of those that change are said once, in the note.
        let offset = if step < 1e-5 * min.abs().max(max.abs()) { roundest(min, max) } else { 0.0 };
        let (min, max) = (min - offset, max - offset);
        let magnitude = magnitude(min.abs().max(max.abs()));
        let exponent = if (-3..=4).contains(&magnitude) { 0 } else { 3 * magnitude.div_euclid(3) };
        let unit = 10_f64.powi(exponent);
        let (range, step) = ((min / unit, max / unit), step / unit);
        let (first, last) = ((range.0 / step).ceil() as i64, (range.1 / step).floor() as i64);

        let mut note = Vec::new();
        if exponent != 0 {
            note.push(format!("×10{}", superscript(exponent)));
        }
        if offset != 0.0 {
            note.push(format!("{} {}", if offset < 0.0 { "\u{2212}" } else { "+" }, offset.abs()));
        }
        Self {
            is_log: false,
            offset,
            unit,
            // The tolerance catches steps that were rounded to just below a power of ten.
            decimals: (-self::magnitude(step * (1.0 + 1e-9))).max(0) as usize,
            range,
            ticks: (first..=last).map(|i| i as f64 * step).collect(),
            minor: Vec::new(),
            note: note.join(" "),
        }
    }

    /// A tick per decade, about `count` of them with a label; two to nine between them if there is room.
    fn logarithmic((low, high): (i32, i32), count: usize) -> Self {
        let stride = (f64::from(high - low) / count.max(1) as f64).ceil().max(1.0) as i32;
        let (ticks, others): (Vec<i32>, Vec<i32>) = (low..=high).partition(|k| k.rem_euclid(stride) == 0);
        let mut minor: Vec<f64> = others.into_iter().map(f64::from).collect();
        if stride == 1 {
            minor.extend((low..high).flat_map(|k| (2..10).map(move |i| f64::from(k) + f64::from(i).log10())));
        }
        Self {
            is_log: true,
            offset: 0.0,
            unit: 1.0,
            decimals: 0,
            range: (low.into(), high.into()),
            ticks: ticks.into_iter().map(f64::from).collect(),
            minor,
            note: String::new(),
        }
    }

    pub(crate) fn shown(&self, value: f64) -> f64 {
        if self.is_log { value.log10() } else { (value - self.offset) / self.unit }
    }

    /// Lowest and highest value of a linear axis.
    pub(crate) fn values(&self) -> (f64, f64) {
        (self.offset + self.unit * self.range.0, self.offset + self.unit * self.range.1)
    }

    pub(crate) fn labels(&self) -> impl Iterator<Item = String> {
        self.labelled().map(|(_, label)| label)
    }

    /// Shown values of the ticks, with their labels.
    pub(crate) fn labelled(&self) -> impl Iterator<Item = (f64, String)> {
        self.ticks.iter().map(|tick| (*tick, self.format_ext(tick)))
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, shown: &f64, units: (i32, i32)) -> i32 {
        RangedCoordf64::from(self.range()).map(shown, units)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { self.minor.clone() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.range.0..self.range.1
    }
}

impl ValueFormatter<f64> for Axis {
    /// Label of a tick at a shown value.
    fn format_ext(&self, shown: &f64) -> String {
        if self.is_log {
            return format!("10{}", superscript(shown.round() as i32));
        }
        minus_sign(&format!("{shown:.*}", self.decimals))
    }
}

/// The range that an axis shows for data from `min` to `max`, with a margin on both sides as a fraction of their distance.
/// Data that do not vary, up to rounding, stand in the middle.
pub(crate) fn linear_range(min: f64, max: f64, margin: f64) -> (f64, f64) {
    let size = min.abs().max(max.abs());
    let extent = max - min;
    if extent > 64.0 * f64::EPSILON * size {
        (min - margin * extent, max + margin * extent)
    } else if size > 0.0 {
        (min - 0.5 * size, max + 0.5 * size)
    } else {
        (-1.0, 1.0)
    }
}

/// Whole decades around positive data, as exponents of ten.
fn decades(min: f64, max: f64) -> (i32, i32) {
    let (low, high) = (min.log10().floor() as i32, max.log10().ceil() as i32);
    if low == high { (low - 1, high + 1) } else { (low, high) }
}

/// The nearest, by ratio, of 1, 2, 5 times a power of ten to a positive number.
pub(crate) fn round_step(step: f64) -> f64 {
    let unit = 10_f64.powi(magnitude(step));
    let bounds = [(1.0, 2_f64.sqrt()), (2.0, 10_f64.sqrt()), (5.0, 50_f64.sqrt())];
    let factor = bounds.into_iter().find(|(_, bound)| step <= bound * unit);
    factor.map_or(10.0, |(factor, _)| factor) * unit
}

/// The number with the fewest digits between two that differ by little.
fn roundest(min: f64, max: f64) -> f64 {
    let middle = 0.5 * (min + max);
    let start = magnitude(middle);
    // A quotient of whole numbers has no rounding dust.
    let rounded = |digit: i32| match 10_f64.powi(digit.abs()) {
        power if digit < 0 => (middle * power).round() / power,
        power => (middle / power).round() * power,
    };
    (start - 17..=start).rev().map(rounded).find(|number| (min..=max).contains(number)).unwrap_or(middle)
}

/// The power of ten of a number's first digit.
fn magnitude(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// A number with two digits and a power of ten, such as 7.6·10⁻⁷; 0 is 0.
pub(crate) fn power_of_ten(value: f64) -> String {
    let text = format!("{value:.1e}");
    match text.split_once('e').and_then(|(digits, exponent)| Some((digits, exponent.parse().ok()?))) {
        Some((digits, exponent)) if value != 0.0 => minus_sign(&format!("{digits}·10{}", superscript(exponent))),
        _ => "0".to_owned(),
    }
}

fn minus_sign(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(min: f64, max: f64, count: usize) -> Axis {
        Axis::linear((min, max), count)
    }

    fn labels(axis: &Axis) -> Vec<String> {
        axis.labels().collect()
    }

    #[test]
    fn plain_numbers_have_no_rounding_dust() {
        assert_eq!(labels(&linear(0.0, 0.5, 5)), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(labels(&linear(-1.0, 1.0, 4)), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(&linear(0.0, 40000.0, 4)), ["0", "10000", "20000", "30000", "40000"]);
    }

    #[test]
    fn small_and_large_numbers_share_a_power_of_ten() {
        let axis = linear(-1.1e-12, 2.3e-12, 4);
        assert_eq!((labels(&axis), axis.note.as_str()), (["−1", "0", "1", "2"].map(String::from).to_vec(), "×10⁻¹²"));
        let axis = linear(0.0, 3e7, 3);
        assert_eq!((labels(&axis), axis.note.as_str()), (["0", "10", "20", "30"].map(String::from).to_vec(), "×10⁶"));
        assert_eq!((axis.shown(3e7), axis.ticks[3], axis.range), (30.0, 30.0, (0.0, 30.0)));
    }

    #[test]
    fn a_small_change_of_a_large_number_is_counted_from_a_note() {
        let axis = linear(0.00935 - 1e-12, 0.00935 + 1e-12, 4);
        assert_eq!(axis.note, "×10⁻¹² + 0.00935");
        assert_eq!(labels(&axis), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert!(axis.shown(0.00935) == 0.0 && (axis.shown(0.00935 + 5e-13) - 0.5).abs() < 1e-5);
        let axis = linear(-250.002, -250.0, 4);
        assert_eq!((axis.note.as_str(), labels(&axis)[0].as_str()), ("− 250", "−0.0020"));
    }

    /// Closed form: half of the value on each side.
    #[test]
    fn what_does_not_vary_stands_in_the_middle() {
        assert_eq!(linear_range(0.0, 0.0, 0.05), (-1.0, 1.0));
        assert_eq!(linear_range(-4.0, -4.0, 0.05), (-6.0, -2.0));
        let (low, high) = linear_range(0.3, 0.1 + 0.2, 0.0);
        assert!((low - 0.15).abs() < 1e-15 && (high - 0.45).abs() < 1e-15);
        assert_eq!(linear_range(0.0, 10.0, 0.1), (-1.0, 11.0));
    }

    #[test]
    fn small_numbers_are_written_with_a_power_of_ten() {
        assert_eq!(power_of_ten(7.64e-7), "7.6·10⁻⁷");
        assert_eq!(power_of_ten(9.96), "1.0·10¹");
        assert_eq!((power_of_ten(-3.0).as_str(), power_of_ten(0.0).as_str()), ("−3.0·10⁰", "0"));
    }

    #[test]
    fn decades_enclose_the_data() {
        assert_eq!(decades(3e-9, 2e-3), (-9, -2));
        assert_eq!(decades(1.0, 1.0), (-1, 1));
        let axis = Axis::new(Scale::Log, [2e-3, 3e-9], 0.0, 8);
        assert_eq!((labels(&axis)[0].as_str(), axis.ticks.len(), axis.minor.len()), ("10⁻⁹", 8, 7 * 8));
        assert_eq!((axis.range, axis.shown(1e-5)), ((-9.0, -2.0), -5.0));
        // With room for few labels, every second decade has one and the tens between have none.
        let axis = Axis::logarithmic((-16, 0), 8);
        assert_eq!((axis.ticks.len(), axis.minor.len()), (9, 8));
    }
}
