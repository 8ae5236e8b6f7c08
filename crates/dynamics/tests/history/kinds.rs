//! Each kind against its formula, and its law on both sides of its discontinuities.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, TAU};

use dynamics::{Expression, History};

use crate::{at, formula, sides, table};

/// Closed form: one.
#[test]
fn a_constant_is_one_and_has_no_discontinuity() {
    assert_eq!([-1e9, 0.0, 1e9].map(|t| at(&History::Constant, t)), [1.0; 3]);
    assert!(History::Constant.discontinuities().is_empty());
}

/// Closed form: zero and one.
#[test]
fn a_step_is_seen_from_its_side() {
    let step = History::Step { at: 2.0 };
    assert_eq!((at(&step, 1.999), at(&step, 2.001)), (0.0, 1.0));
    assert_eq!(sides(&step, 2.0), [0.0, 1.0]);
    assert_eq!(step.discontinuities(), [2.0]);
}

/// Closed form: (t − t₀)/T.
#[test]
fn a_ramp_rises_straight_and_stays() {
    let ramp = History::Ramp { start: 1.0, duration: 4.0 };
    assert_eq!([0.5, 2.0, 4.0, 5.5].map(|t| at(&ramp, t)), [0.0, 0.25, 0.75, 1.0]);
    assert_eq!((sides(&ramp, 1.0), sides(&ramp, 5.0)), ([0.0; 2], [1.0; 2]));
    assert_eq!(ramp.discontinuities(), [1.0, 5.0]);
}

/// Closed form: sin π(t − t₀)/T.
#[test]
fn a_half_sine_rises_falls_and_ends() {
    let pulse = History::HalfSine { start: 1.0, duration: 0.5 };
    assert_eq!((at(&pulse, 0.999), at(&pulse, 1.0), at(&pulse, 1.51)), (0.0, 0.0, 0.0));
    assert!((at(&pulse, 1.25) - 1.0).abs() < 1e-15);
    assert!((at(&pulse, 1.125) - 0.5_f64.sqrt()).abs() < 1e-15);
    assert!(at(&pulse, 1.5).abs() < 1e-15);
    assert_eq!(pulse.discontinuities(), [1.0, 1.5]);
}

/// Closed form: sin(2πf(t − t₀) + φ).
#[test]
fn a_sine_begins_with_its_phase_and_ends_with_its_duration() {
    let sine = |duration| History::Sine { frequency: 3.0, phase: FRAC_PI_6, start: 0.5, duration };
    for t in [0.5, 0.7, 1.1, 40.0] {
        assert_eq!(at(&sine(None), t), (TAU * 3.0 * (t - 0.5) + FRAC_PI_6).sin());
    }
    assert_eq!(sides(&sine(None), 0.5), [0.0, FRAC_PI_6.sin()]);
    assert_eq!(sine(None).discontinuities(), [0.5]);
    // 3.25 cycles: it ends at sin(π/2 + π/6).
    let burst = sine(Some(3.25 / 3.0));
    let end = 0.5 + 3.25 / 3.0;
    let [before, after] = sides(&burst, end);
    assert!((before - (FRAC_PI_2 + FRAC_PI_6).sin()).abs() < 1e-14 && after == 0.0, "{before} {after}");
    assert_eq!(burst.discontinuities(), [0.5, end]);
}

/// Closed form: the frequency is the rate of the phase, from h = sin φ and h' = φ' cos φ where cos φ is not small.
#[test]
fn a_sweep_goes_straight_from_one_frequency_to_the_other() {
    for (from, to) in [(2.0, 20.0), (20.0, 0.0)] {
        let sweep = History::Sweep { from, to, start: 1.0, duration: 5.0 };
        let (mut largest, mut seen) = (0.0_f64, 0);
        for k in 1..5000 {
            let t = 1.0 + 1e-3 * f64::from(k);
            let (h, step) = (at(&sweep, t), 1e-6);
            if h.abs() < 0.9 {
                let rate = (sweep.at(t + step, t) - sweep.at(t - step, t)) / (2.0 * step);
                let found = rate.abs() / (1.0 - h * h).sqrt() / TAU;
                largest = largest.max((found - (from + (to - from) * (t - 1.0) / 5.0)).abs());
                seen += 1;
            }
        }
        // Measured: 3.1e-9 at worst.
        assert!(seen > 2000 && largest < 1e-7, "{seen} {largest:e}");
        // 11 and 10 times 5 cycles on the average: whole ones.
        assert!(sides(&sweep, 6.0)[0].abs() < 1e-12);
        assert_eq!((at(&sweep, 0.9), at(&sweep, 6.1), sweep.discontinuities()), (0.0, 0.0, vec![1.0, 6.0]));
    }
}

/// Conserved: the product of the factors.
#[test]
fn a_product_is_that_of_its_factors_with_all_their_discontinuities() {
    let factors = vec![
        History::Step { at: 2.0 },
        History::Ramp { start: 0.0, duration: 4.0 },
        table(&[1.0, 2.0, 3.0], &[1.0, 3.0, 1.0]),
        formula("exp(-t)"),
    ];
    let product = History::Product { factors: factors.clone() };
    assert_eq!(product.discontinuities(), [0.0, 1.0, 2.0, 3.0, 4.0]);
    for t in [0.5, 1.5, 2.5, 3.5, 4.5] {
        assert_eq!(at(&product, t), factors.iter().map(|factor| at(factor, t)).product::<f64>());
    }
    assert_eq!(sides(&product, 2.0), [0.0, 0.5 * 3.0 * (-2.0_f64).exp()]);
    // Products nest.
    let nested = History::Product { factors: vec![product, History::Step { at: 0.5 }] };
    assert_eq!(nested.discontinuities(), [0.0, 0.5, 1.0, 2.0, 3.0, 4.0]);
}

/// Independent reference: five-point differences of values, and at a discontinuity on either side.
#[test]
fn rates_are_those_of_the_values() {
    let sine = History::Sine { frequency: 3.0, phase: 0.4, start: 0.1, duration: Some(2.0) };
    let histories = [
        History::Constant,
        History::Step { at: 0.5 },
        History::Ramp { start: 0.2, duration: 0.7 },
        History::HalfSine { start: 0.2, duration: 0.7 },
        sine.clone(),
        History::Sweep { from: 1.0, to: 5.0, start: 0.2, duration: 2.0 },
        table(&[0.0, 0.4, 1.0], &[1.0, 3.0, -2.0]),
        formula("exp(-t)*sin(7*t^2)"),
        History::Product { factors: vec![sine, formula("t^3"), History::Ramp { start: 0.0, duration: 1.0 }] },
    ];
    let h = 1e-5;
    for history in histories {
        for time in [0.05, 0.3, 0.6, 0.95, 1.7, 2.5] {
            let at = |offset: f64| history.at(time + offset, time);
            let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            let rate = history.rate(time, time);
            // Measured: 6e-10, the rounding of the difference.
            assert!(
                (rate - difference).abs() <= 1e-8 * (1.0 + rate.abs()),
                "{history:?} at {time}: {rate} {difference}"
            );
        }
    }
}

/// Closed form: ±cos, at a formula's discontinuity and just beside it, only to the side of `inside`.
#[test]
fn the_rate_of_a_formula_does_not_look_across_its_discontinuity() {
    let kinked = History::Expression(Expression::new("abs(sin(t - 1))", vec![1.0]).unwrap());
    for (inside, sign) in [(0.9, -1.0), (1.1, 1.0)] {
        for offset in [0.0, 1e-9, 1e-5] {
            let rate = kinked.rate(1.0 + sign * offset, inside);
            assert!((rate - sign * offset.cos()).abs() < 1e-12, "{rate}");
        }
    }
}
