//! What is no history, with the number or the place that is wrong.

use frames_rk4::{Expression, History, SetupError, Table};

use crate::{formula, table};

#[test]
fn numbers_outside_their_range() {
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let sine = |frequency, phase, start, duration| History::Sine { frequency, phase, start, duration: Some(duration) };
    let sweep = |from, to, start, duration| History::Sweep { from, to, start, duration };
    let cases = [
        (History::Step { at: nan }, "the time of a step is NaN; expected a finite number"),
        (History::Ramp { start: inf, duration: 1.0 }, "the start of a ramp is inf; expected a finite number"),
        (History::Ramp { start: 0.0, duration: 0.0 }, "the duration of a ramp is 0; expected a positive number"),
        (History::HalfSine { start: 0.0, duration: -1.0 }, "the duration of a half-sine is -1; expected a positive"),
        (sine(0.0, 0.0, 0.0, 1.0), "the frequency of a sine is 0; expected a positive number"),
        (sine(1.0, nan, 0.0, 1.0), "the phase of a sine is NaN"),
        (sine(1.0, 0.0, nan, 1.0), "the start of a sine is NaN"),
        (sine(1.0, 0.0, 0.0, inf), "the duration of a sine is inf"),
        (sweep(-1.0, 1.0, 0.0, 1.0), "the first frequency of a sweep is -1; expected zero or more"),
        (sweep(1.0, inf, 0.0, 1.0), "the last frequency of a sweep is inf"),
        (sweep(1.0, 2.0, nan, 1.0), "the start of a sweep is NaN"),
        (sweep(1.0, 2.0, 0.0, 0.0), "the duration of a sweep is 0"),
        (History::Product(vec![]), "a product of histories has 0 entries; expected at least one"),
        (
            History::Product(vec![History::Constant, History::Product(vec![History::Step { at: nan }])]),
            "the time of a step is NaN",
        ),
    ];
    for (history, message) in cases {
        let error = history.check().unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
    for history in [
        History::Constant,
        History::Sine { frequency: 1.0, phase: -9.0, start: -1.0, duration: None },
        sweep(0.0, 2.0, 0.0, 1.0),
        table(&[0.0, 1.0], &[0.0, 1.0]),
        formula("t"),
    ] {
        assert_eq!(history.check(), Ok(()));
    }
}

#[test]
fn tables_that_are_none() {
    let error = |times: &[f64], values: &[f64]| Table::new(times.to_vec(), values.to_vec()).unwrap_err();
    assert!(matches!(error(&[0.0], &[1.0]), SetupError::Entries { found: 1, .. }));
    let lengths = error(&[0.0, 1.0, 2.0], &[1.0, 2.0]);
    assert_eq!(lengths.to_string(), "the list of values of a table has 2 entries; expected 3, one for each time");
    for times in [[0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 0.5, 2.0]] {
        let error = error(&times, &[0.0; 4]);
        let found = times[2];
        let expected =
            |e: &SetupError| matches!(e, SetupError::NotRising { row: 3, previous: 1.0, found: f, .. } if *f == found);
        assert!(expected(&error), "{error}");
    }
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(matches!(error(&[0.0, bad], &[0.0, 1.0]), SetupError::Value { what: "a time of a table", .. }));
        assert!(matches!(error(&[0.0, 1.0], &[bad, 1.0]), SetupError::Value { what: "a value of a table", .. }));
    }
}

#[test]
fn formulas_that_are_none_with_the_place() {
    let cases = [
        ("sin(t) + omega*t", 10, "`omega` is not known"),
        ("foo(t)", 1, "`foo` is not known"),
        ("2*x + y", 3, "`x` is not known"),
        ("T", 1, "`T` is not known"),
        ("log(t)", 1, "`log` means two things; write ln or log10"),
        ("1 + t^2^3", 8, "a power of a power"),
        ("t^-2^2", 5, "a power of a power"),
        ("2*π*t", 3, "`π` is not known"),
        ("t**2", 3, "Illegal character: `*`"),
        ("", 1, "it ends too early"),
        ("t +", 3, "it ends too early"),
        ("(t", 3, "Expected token"),
        ("1..2", 1, "Malformed number: `1..2`"),
        ("sin(1, 2)", 1, "Too many arguments"),
        ("t > 1", 3, ""),
        ("1,5*t", 2, ""),
    ];
    for (text, place, what) in cases {
        match Expression::new(text, vec![]) {
            Err(SetupError::Expression { text: found, position, problem }) => {
                assert!(found == text && position == place && problem.contains(what), "{text}: {position} {problem}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
    let message = Expression::new("1 + omega", vec![]).unwrap_err().to_string();
    assert!(message.starts_with(
        "the expression \"1 + omega\" at character 5: `omega` is not known; an expression has t, numbers"
    ));
    assert!(message.contains("sin, cos"));
    assert!(matches!(Expression::new("t", vec![0.0, f64::NAN]), Err(SetupError::Value { .. })));
}

#[test]
fn an_expression_that_is_no_number_somewhere() {
    let cases = [("1/t", 0.0, f64::INFINITY), ("0/t", 0.0, f64::NAN), ("sqrt(0.5 - t)", 0.5, f64::NAN)];
    for (text, near, value) in cases {
        for history in [formula(text), History::Product(vec![History::Constant, formula(text)])] {
            match history.check_over(2.0) {
                Err(SetupError::HistoryNotFinite { time, found }) => {
                    assert!((time - near).abs() < 1e-3, "{text} {time}");
                    assert!(found == value || found.is_nan() && value.is_nan(), "{text} {found}");
                }
                other => panic!("{text}: {other:?}"),
            }
            assert!(!history.largest(2.0).is_finite());
            assert!(!history.magnitude_integral(2.0).is_finite());
            assert!(!history.amplitude_at(1.0, 2.0).is_finite());
        }
    }
    assert_eq!(formula("1/(1 + t)").check_over(2.0), Ok(()));
    assert_eq!(formula("sqrt(2 - t)").check_over(2.0), Ok(()));
}
