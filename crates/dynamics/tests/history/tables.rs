//! Tables: lines between rows, discontinuities where the slope changes.

use crate::{at, sides, table};

fn discontinuities_of(times: &[f64], values: &[f64]) -> Vec<f64> {
    table(times, values).discontinuities()
}

/// Closed form: straight lines between rows.
#[test]
fn a_table_goes_straight_between_rows_and_holds_its_ends() {
    let history = table(&[1.0, 2.0, 4.0], &[3.0, -1.0, 0.0]);
    for (t, value) in [(-5.0, 3.0), (1.0, 3.0), (1.25, 2.0), (2.0, -1.0), (3.0, -0.5), (4.0, 0.0), (9.0, 0.0)] {
        assert_eq!(at(&history, t), value, "{t}");
    }
    for (t, value) in [(1.0, 3.0), (2.0, -1.0), (4.0, 0.0)] {
        assert_eq!(sides(&history, t), [value; 2], "{t}");
    }
    assert_eq!(history.discontinuities(), [1.0, 2.0, 4.0]);
}

#[test]
fn discontinuities_are_where_the_slope_changes() {
    assert!(discontinuities_of(&[0.0, 1.0, 2.0, 3.0], &[5.0; 4]).is_empty());
    assert_eq!(discontinuities_of(&[0.0, 1.0, 3.0], &[0.0, 2.0, 6.0]), [0.0, 3.0]);
    assert_eq!(discontinuities_of(&[0.0, 1.0, 2.0, 3.0], &[1.0, 1.0, 2.0, 2.0]), [1.0, 2.0]);
    // A kink of 1e-9 of the slope is none of rounding.
    assert_eq!(discontinuities_of(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0 + 1e-9]), [0.0, 1.0, 2.0]);
}

/// Closed form: a straight line. Ten thousand rows of it, rounded: a step may go from the first to the last.
#[test]
fn rounded_rows_of_a_line_have_no_discontinuities_between() {
    let times: Vec<f64> = (0..10_000).map(|k| 0.3 + f64::from(k) * 0.1).collect();
    let values: Vec<f64> = times.iter().map(|t| 7.3 * t - 1e3 / 3.0).collect();
    let history = table(&times, &values);
    let (first, last) = (times[0], times[9999]);
    assert_eq!(history.discontinuities(), [first, last]);
    for t in [first, 17.77, 500.123, last] {
        let value = history.at(t, 500.0);
        assert!((value - (7.3 * t - 1e3 / 3.0)).abs() < 1e-11, "{t} {value}");
    }
    // One row moved by a millionth is a discontinuity with its neighbours.
    let mut moved = values;
    moved[5000] += 1e-6;
    assert_eq!(table(&times, &moved).discontinuities(), [first, times[4999], times[5000], times[5001], last]);
}

/// Closed form: the sine, and h²ω²/8 of linear interpolation.
#[test]
fn ten_thousand_rows_of_a_sine_are_found_by_the_rows_beside() {
    let times: Vec<f64> = (0..10_000).map(|k| f64::from(k) * 1e-3).collect();
    let values: Vec<f64> = times.iter().map(|t| (5.0 * t).sin()).collect();
    let history = table(&times, &values);
    let mut worst = 0.0_f64;
    for k in 0..99_990 {
        let t = f64::from(k) * 1e-4;
        worst = worst.max((at(&history, t) - (5.0 * t).sin()).abs());
    }
    // Interpolation errs by (5e-3)²/8 = 3.1e-6.
    assert!(worst < 3.2e-6, "{worst:e}");
    assert!(history.discontinuities().len() > 9_990, "{}", history.discontinuities().len());
}

/// Closed form: straight lines: what lies on the two sides of a step's ends does not matter, whatever the stage.
#[test]
fn a_step_between_rows_sees_one_line() {
    let history = table(&[0.0, 1.0, 2.0], &[0.0, 1.0, -1.0]);
    assert_eq!([1.0, 1.5, 2.0].map(|t| history.at(t, 1.5)), [1.0, 0.0, -1.0]);
    assert_eq!([0.0, 0.5, 1.0].map(|t| history.at(t, 0.25)), [0.0, 0.5, 1.0]);
    let [before, after] = [[-1.0, 0.0], [2.0, 3.0]].map(|ends| ends.map(|t| history.at(t, 0.5 * (ends[0] + ends[1]))));
    assert_eq!((before, after), ([0.0; 2], [-1.0; 2]));
    assert_eq!(history.check(), Ok(()));
}
