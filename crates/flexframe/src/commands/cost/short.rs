//! Times and settings in a few characters.

use super::setting::Setting;

/// A time with three digits.
pub fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (1e6 * s, "µs"),
        s if s < 1.0 => (1e3 * s, "ms"),
        s => (s, "s"),
    };
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.decimals$} {unit}")
}

/// A step or a tolerance with the digits that it needs.
pub fn setting(setting: Setting) -> String {
    match setting {
        Setting::Step(step) => format!("step {}", digits(step)),
        Setting::Tolerance(tolerance) => format!("tol. {}", digits(tolerance)),
    }
}

fn digits(value: f64) -> String {
    let (all, short) = (format!("{value:e}"), format!("{value:.5e}"));
    if all.len() <= short.len() { all } else { short }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_three_digits_and_settings_those_they_need() {
        assert_eq!(duration(1.234e-4), "123 µs");
        assert_eq!(duration(0.01234), "12.3 ms");
        assert_eq!(duration(1.234), "1.23 s");
        assert_eq!(setting(Setting::Step(2.5e-4)), "step 2.5e-4");
        assert_eq!(setting(Setting::Step(0.37 / 700.0)), "step 5.28571e-4");
        assert_eq!(setting(Setting::Tolerance(1e-8)), "tol. 1e-8");
    }
}
