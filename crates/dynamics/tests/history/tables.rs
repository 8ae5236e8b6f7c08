//! Tables: lines between rows, discontinuities where the slope changes.

use dynamics::{History, Table};

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

fn smooth(times: &[f64], values: &[f64]) -> History {
    History::Table(Table::monotone_cubic(times.to_vec(), values.to_vec()).unwrap())
}

/// Independent reference: `PchipInterpolator` of SciPy 1.17.1, and its derivative.
#[test]
fn cubics_are_those_of_another_program() {
    let history = smooth(&[0.0, 0.5, 1.25, 2.0, 3.0, 4.5], &[0.0, 1.0, 1.5, 1.2, 1.2, 3.0]);
    for (time, value, rate) in [
        (0.0, 0.0, 2.533_333_333_333_333),
        (0.2, 0.484_744_827_586_206_96, 2.244_965_517_241_379_6),
        (0.5, 1.0, 1.034_482_758_620_689_7),
        (0.9, 1.365_077_905_491_698_4, 0.705_900_383_141_762_4),
        (1.25, 1.5, 0.0),
        (1.7, 1.305_6, -0.576),
        (2.4, 1.2, 0.0),
        (3.3, 1.295_04, 0.614_4),
        (4.4, 2.809_813_333_333_333_5, 1.881_6),
    ] {
        assert!((at(&history, time) - value).abs() < 1e-14, "{time}");
        assert!((history.rate(time, time) - rate).abs() < 1e-14, "{time}");
    }
    // The first and the last value are held.
    assert_eq!([-1.0, 4.5, 9.0].map(|time| at(&history, time)), [0.0, 3.0, 3.0]);
    assert_eq!([-1.0, 9.0].map(|time| history.rate(time, time)), [0.0; 2]);
}

/// Closed form: two rows, and rows of one line, make a line, which a step may cross.
#[test]
fn cubics_of_rows_on_a_line_are_the_line() {
    let times: Vec<f64> = (0..1000).map(|k| 0.3 + f64::from(k) * 0.1).collect();
    let values: Vec<f64> = times.iter().map(|t| 7.3 * t - 1e3 / 3.0).collect();
    let history = smooth(&times, &values);
    assert_eq!(history.discontinuities(), [times[0], times[999]]);
    assert!((at(&history, 50.05) - (7.3 * 50.05 - 1e3 / 3.0)).abs() < 1e-11);
    assert_eq!([0.0, 1.0, 1.5, 2.0].map(|time| at(&smooth(&[1.0, 2.0], &[3.0, 5.0]), time)), [3.0, 3.0, 4.0, 5.0]);
}

/// Closed form: tanh. The rates are of second order where it does not bend to and fro, so the cubics of third and the rates of second;
/// straight lines have second and first. Where rows repeat, the value does not overshoot.
#[test]
fn cubics_are_monotone_and_of_third_order_with_rates_that_do_not_jump() {
    let errors = |make: fn(&[f64], &[f64]) -> History, rows: u32| {
        let times: Vec<f64> = (0..=rows).map(|k| 0.5 + 2.0 * f64::from(k) / f64::from(rows)).collect();
        let values: Vec<f64> = times.iter().map(|t| t.tanh()).collect();
        let history = make(&times, &values);
        let mut worst = [0.0_f64; 2];
        for k in 1..4000 {
            let time = 0.5 + 2.0 * f64::from(k) / 4000.0 + 1e-7;
            worst[0] = worst[0].max((at(&history, time) - time.tanh()).abs());
            worst[1] = worst[1].max((history.rate(time, time) - time.cosh().powi(-2)).abs());
        }
        worst
    };
    for (make, orders) in [(smooth as fn(&[f64], &[f64]) -> History, [3.0, 2.0]), (table, [2.0, 1.0])] {
        let [coarse, fine] = [40, 80].map(|rows| errors(make, rows));
        for k in 0..2 {
            let order = (coarse[k] / fine[k]).log2();
            assert!((order - orders[k]).abs() < 0.15, "{order} {coarse:?} {fine:?}");
        }
    }
    let times: Vec<f64> = (0..60).map(|k| f64::from(k) + 0.4 * f64::from(k * k % 7) / 7.0).collect();
    let mut values: Vec<f64> = (0..60).map(|k: u32| f64::from(k * k * 37 % 101) / 10.0).collect();
    values.sort_by(f64::total_cmp);
    let repeated = values[20];
    values[20..30].fill(repeated);
    let history = smooth(&times, &values);
    let mut before = f64::NEG_INFINITY;
    for k in 0..60_000 {
        let time = f64::from(k) * 1e-3;
        let value = at(&history, time);
        assert!(value >= before - 1e-14, "{time}");
        before = value;
    }
    for time in &times[1..59] {
        let [left, right] = [-1e-9, 1e-9].map(|by| history.rate(*time, time + by));
        assert!((left - right).abs() < 1e-12, "{time}: {left} {right}");
    }
}

/// Conserved: a table as data, and its key.
#[test]
fn a_smooth_table_is_the_same_as_data() {
    let [times, values] = [vec![0.0, 1.0, 3.0], vec![0.0, 1.0, -1.0]];
    let made = Table::monotone_cubic(times.clone(), values.clone()).unwrap();
    let data: (Vec<f64>, Vec<f64>) = made.clone().into();
    assert_eq!(Table::try_from(data).unwrap(), made);
    let lines = Table::new(times.clone(), values.clone()).unwrap();
    let key = |table: &Table| keys::Keyed::key(table, keys::Key::new()).finish();
    assert_ne!(key(&made), key(&lines));
    assert_eq!(<(Vec<f64>, Vec<f64>)>::from(lines), (times.clone(), values.clone()));
    assert!(Table::try_from((times, vec![0.0, 1.0, -1.0, f64::NAN, 0.0, 0.0])).is_err());
}
