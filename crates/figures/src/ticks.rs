//! Where an axis has its ticks, and what they say.

/// The ticks of one axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    /// Value and label.
    pub(crate) major: Vec<(f64, String)>,
    /// Values of the ticks without a label.
    pub(crate) minor: Vec<f64>,
    /// What all labels are multiplied by and counted from, "×10⁻³" or "+ 0.00935".
    pub(crate) note: String,
}

/// The range that an axis shows for data from `min` to `max`, with a margin on both sides as a
/// fraction of their distance. Data that do not vary, up to rounding, stand in the middle.
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

/// Round numbers (1, 2, 5 times a power of ten apart), about `count` of them.
pub(crate) fn linear(min: f64, max: f64, count: usize) -> Ticks {
    let step = round_step((max - min) / count.max(1) as f64);
    // The tolerance catches steps that were rounded to just below a power of ten.
    let step_digits = magnitude(step * (1.0 + 1e-9));
    let (first, last) = ((min / step).ceil() as i64, (max / step).floor() as i64);
    let largest = min.abs().max(max.abs());

    // Many digits in front of those that change are said once, in the note.
    let trailing_zeros = |i: &i64| (1..).take_while(|&k| i % 10_i64.pow(k) == 0).take(18).count();
    let roundest = (first..=last).max_by_key(trailing_zeros);
    let offset = roundest.filter(|_| step < 1e-5 * largest).unwrap_or(0);
    let shown = if offset == 0 { largest } else { (last - offset).max(offset - first) as f64 * step };
    let magnitude = magnitude(shown);
    let exponent = if (-3..=4).contains(&magnitude) { 0 } else { 3 * magnitude.div_euclid(3) };
    let decimals = (exponent - step_digits).max(0) as usize;
    let unit = 10_f64.powi(exponent);
    let label = |i: i64| minus_sign(&format!("{:.decimals$}", (i - offset) as f64 * step / unit));

    let mut note = String::new();
    if exponent != 0 {
        note = format!("×10{}", superscript(exponent));
    }
    if offset != 0 {
        let value = offset as f64 * step;
        let sign = if value < 0.0 { "\u{2212}" } else { "+" };
        let separator = if note.is_empty() { "" } else { " " };
        note = format!("{note}{separator}{sign} {}", number(value.abs(), step_digits));
    }
    Ticks { major: (first..=last).map(|i| (i as f64 * step, label(i))).collect(), minor: Vec::new(), note }
}

/// Whole decades around positive data, as exponents of ten.
pub(crate) fn decades(min: f64, max: f64) -> (i32, i32) {
    let (low, high) = (min.log10().floor() as i32, max.log10().ceil() as i32);
    if low == high { (low - 1, high + 1) } else { (low, high) }
}

/// A tick per decade, about `count` of them with a label; two to nine between them if there is room.
pub(crate) fn logarithmic((low, high): (i32, i32), count: usize) -> Ticks {
    let stride = ((high - low) as f64 / count.max(1) as f64).ceil().max(1.0) as i32;
    let labelled = |k: i32| k.rem_euclid(stride) == 0;
    let mut minor: Vec<f64> = (low..=high).filter(|&k| !labelled(k)).map(|k| 10_f64.powi(k)).collect();
    if stride == 1 {
        minor.extend((low..high).flat_map(|k| (2..10).map(move |i| f64::from(i) * 10_f64.powi(k))));
    }
    let major = (low..=high).filter(|&k| labelled(k));
    Ticks {
        major: major.map(|k| (10_f64.powi(k), format!("10{}", superscript(k)))).collect(),
        minor,
        note: String::new(),
    }
}

/// The nearest, by ratio, of 1, 2, 5 times a power of ten to a positive number.
pub(crate) fn round_step(step: f64) -> f64 {
    let unit = 10_f64.powi(magnitude(step));
    let bounds = [(1.0, 2_f64.sqrt()), (2.0, 10_f64.sqrt()), (5.0, 50_f64.sqrt())];
    let factor = bounds.into_iter().find(|(_, bound)| step <= bound * unit);
    factor.map_or(10.0, |(factor, _)| factor) * unit
}

/// The power of ten of a number's first digit.
fn magnitude(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// A number down to the digit 10^`last_digit`, without trailing zeros.
fn number(value: f64, last_digit: i32) -> String {
    let exponent = magnitude(value);
    let trimmed = |text: String| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    };
    if (-4..6).contains(&exponent) {
        return minus_sign(&trimmed(format!("{value:.*}", (-last_digit).max(0) as usize)));
    }
    let digits = (exponent - last_digit).max(0) as usize;
    let mantissa = trimmed(format!("{:.digits$}", value / 10_f64.powi(exponent)));
    minus_sign(&format!("{mantissa}×10{}", superscript(exponent)))
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

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn plain_numbers_have_no_rounding_dust() {
        assert_eq!(labels(&linear(0.0, 0.5, 5)), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(labels(&linear(-1.0, 1.0, 4)), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(&linear(0.0, 40000.0, 4)), ["0", "10000", "20000", "30000", "40000"]);
    }

    #[test]
    fn small_and_large_numbers_share_a_power_of_ten() {
        let ticks = linear(-1.1e-12, 2.3e-12, 4);
        assert_eq!((labels(&ticks), ticks.note.as_str()), (vec!["−1", "0", "1", "2"], "×10⁻¹²"));
        let ticks = linear(0.0, 3e7, 3);
        assert_eq!((labels(&ticks), ticks.note.as_str()), (vec!["0", "10", "20", "30"], "×10⁶"));
        assert_eq!((ticks.major[3].0 - 3e7).abs(), 0.0);
    }

    #[test]
    fn a_small_change_of_a_large_number_is_counted_from_a_note() {
        let ticks = linear(0.00935 - 1e-12, 0.00935 + 1e-12, 4);
        assert_eq!(ticks.note, "×10⁻¹² + 0.00935");
        assert_eq!(labels(&ticks), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        let ticks = linear(-250.002, -250.0, 4);
        assert_eq!((ticks.note.as_str(), labels(&ticks)[0]), ("− 250", "−0.0020"));
    }

    #[test]
    fn what_does_not_vary_stands_in_the_middle() {
        assert_eq!(linear_range(0.0, 0.0, 0.05), (-1.0, 1.0));
        assert_eq!(linear_range(-4.0, -4.0, 0.05), (-6.0, -2.0));
        let (low, high) = linear_range(0.3, 0.1 + 0.2, 0.0);
        assert!((low - 0.15).abs() < 1e-15 && (high - 0.45).abs() < 1e-15);
        assert_eq!(linear_range(0.0, 10.0, 0.1), (-1.0, 11.0));
    }

    #[test]
    fn decades_enclose_the_data() {
        assert_eq!(decades(3e-9, 2e-3), (-9, -2));
        assert_eq!(decades(1.0, 1.0), (-1, 1));
        let ticks = logarithmic((-9, -2), 8);
        assert_eq!((labels(&ticks)[0], ticks.major.len(), ticks.minor.len()), ("10⁻⁹", 8, 7 * 8));
        // With room for few labels, every second decade has one and the tens between have none.
        let ticks = logarithmic((-16, 0), 8);
        assert_eq!((ticks.major.len(), ticks.minor.len()), (9, 8));
    }
}
