//! Formulas in t: read, and evaluated where they were taken.
#![no_main]

use dynamics::{Expression, History};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match Expression::new(text, vec![0.5]) {
        Ok(expression) => {
            let history = History::Expression(expression);
            for time in [-1.0, 0.0, 1e-300, 0.3, 0.5, 0.7, 1e300] {
                let _ = history.at(time, time);
                let _ = history.rate(time, time);
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
