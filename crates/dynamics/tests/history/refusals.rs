//! Refused histories, with the number or the place that is wrong.

use dynamics::{Expression, History, SetupError, Table};

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
        (History::Product { factors: vec![] }, "a product of histories has 0 entries; expected at least one"),
        (
            History::Product {
                factors: vec![History::Constant, History::Product { factors: vec![History::Step { at: nan }] }],
            },
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
        ("T", 1, "`T` is not known; write t"),
        ("log(t)", 1, "`log` means two things; write ln or log10"),
        ("1 + t^2^3", 8, "a power of a power"),
        ("t^-2^2", 5, "a power of a power"),
        ("2*π*t", 3, "`π` is not known; write pi"),
        ("2 * \0", 5, "`\\0` is not known"),
        ("t > 1", 3, "`>` is not known; a formula has no conditions"),
        ("3!", 2, "`!` is not known"),
        ("t**2", 2, "`**` is not an operator; write a power with ^"),
        ("t*", 3, "it ends too early"),
        ("2 * * t", 5, "`*` cannot stand here"),
        ("t²", 2, "`²` is not known; write a power with ^"),
        ("Sin(t)", 1, "`Sin` is not known; write sin, in small letters"),
        ("np.sin(t)", 1, "write functions without a module"),
        ("if(t, 1, 0)", 1, "a formula has no conditions"),
        ("1 − t", 3, "the minus sign of the keyboard"),
        ("t)", 2, "`)` cannot stand here"),
        ("()", 2, "`)` cannot stand here"),
        ("", 1, "it ends too early"),
        ("t +", 4, "it ends too early"),
        ("(t", 3, "it ends too early: `)` is missing"),
        ("1..2", 1, "`1..2` is not a number"),
        ("t - .", 5, "`.` is not a number"),
        ("1e999", 1, "`1e999` is too large"),
        ("2 3", 3, "a number right after a factor; write `*` between them"),
        ("t 2", 3, "a number right after a factor; write `*` between them"),
        ("sin t", 1, "`sin` needs parentheses after it; write them, as in sin(t)"),
        ("2 + sin(1, 2)", 5, "`sin` takes one argument, found 2"),
        ("atan2(t)", 1, "`atan2` takes two arguments, found 1"),
        ("hypot(t, 1, 2)", 1, "`hypot` takes two arguments, found 3"),
        ("max()", 5, "`)` cannot stand here"),
        ("1,5*t", 2, "decimals with a point"),
        ("(1, 2)", 3, "decimals with a point"),
    ];
    for (text, place, what) in cases {
        match Expression::new(text, vec![]) {
            Err(SetupError::Expression { text: found, position, problem, help }) => {
                let said = format!("{problem}; {help}");
                assert!(&*found == text && position == place && said.contains(what), "{text}: {position} {said}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
    let message = Expression::new("1 + omega", vec![]).unwrap_err().to_string();
    assert!(message.starts_with(
        "the expression \"1 + omega\" at character 5: `omega` is not known; a formula has the time t, numbers"
    ));
    assert!(
        message.contains("sin, cos, tan, asin,") && message.ends_with("fract; write other quantities as numbers"),
        "{message}"
    );
    assert!(matches!(Expression::new("t", vec![0.0, f64::NAN]), Err(SetupError::Value { .. })));
}

/// Formulas as deep as they may be, in a thread with little stack, and deeper and longer ones: read by recursion, these
/// would overflow the stack, and the program would be gone without a word.
#[test]
fn deep_and_long_formulas() {
    let formulas = |n: usize| {
        [
            "(".repeat(n),
            "-".repeat(n - 1) + "t",
            "(".repeat(n / 2 - 1) + "t" + &")".repeat(n / 2 - 1),
            "sin(".repeat(n / 5 - 1) + "t" + &")".repeat(n / 5 - 1),
            "-(".repeat(100) + "t" + &")".repeat(100) + &"(t)".repeat(n / 3 - 101),
            "t".to_owned() + &" t".repeat(n / 2 - 1),
            "t".to_owned() + &"+t".repeat(n / 2 - 1),
            "t".to_owned() + &"*-t".repeat(n / 3 - 1),
            format!("max(t{})", ",t".repeat(n / 2 - 4)),
            "1".repeat(n),
        ]
    };
    let all = move || {
        for text in formulas(1000) {
            match Expression::new(&text, vec![]) {
                Ok(expression) => {
                    let history = History::Expression(expression);
                    assert!(!history.at(0.5, 0.5).is_nan() && !history.rate(0.5, 0.5).is_nan(), "{text}");
                }
                Err(error) => assert!(matches!(error, SetupError::Expression { .. }), "{error}"),
            }
        }
    };
    std::thread::Builder::new().stack_size(1 << 20).spawn(all).unwrap().join().unwrap();
    let nested = |n: usize| Expression::new(&("(".repeat(n) + "t" + &")".repeat(n)), vec![]);
    assert!(nested(100).is_ok());
    let message = nested(101).unwrap_err().to_string();
    assert!(message.contains("at character 101: it has more than 100 parentheses within each other"), "{message}");
    for text in formulas(1020).into_iter().chain(formulas(100_000)) {
        let error = Expression::new(&text, vec![]).unwrap_err();
        assert!(matches!(error, SetupError::LongExpression { most: 1000, .. }), "{error}");
        assert!(error.to_string().contains("longer than 1000; write it shorter"), "{error}");
    }
}

/// Whatever the text, the answer is an error or a formula that can be evaluated.
#[test]
fn spoiled_formulas() {
    const PIECES: [&str; 31] = [
        "t", "(", ")", "+", "-", "*", "/", "%", "^", "!", ",", " ", ".", "1", "e", "pi", "1e", "_", "'", "sin", "max(",
        "atan2(", "hypot(", "log(", "1e999", "0", "é", "\0", "\n", "9e-9", "min()",
    ];
    let (mut state, mut taken) = (1_u64, 0);
    // Knuth's MMIX linear congruential generator.
    let mut below = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let good = ["sin(2*pi*50*t)*exp(-t/0.02)", "-t^2 + (t^2)^3 - 2 t % 3!", "atan2(t,1)+hypot(t,2)*max(0,min(1,t))"];
    for round in 0..20_000 {
        let mut text = if round % 2 == 0 { String::new() } else { good[below(good.len())].to_owned() };
        for _ in 0..1 + below(8) {
            let at = (0..=text.len()).rev().find(|at| *at <= below(text.len() + 1) && text.is_char_boundary(*at));
            text.insert_str(at.unwrap_or(0), PIECES[below(PIECES.len())]);
        }
        match Expression::new(&text, vec![0.5]) {
            Ok(expression) => {
                taken += 1;
                let history = History::Expression(expression);
                for time in [-1.0, 0.0, 0.5, 1e300] {
                    let _ = (history.at(time, time), history.rate(time, time));
                }
            }
            Err(error) => assert!(error.to_string().len() < 1000, "{error}"),
        }
    }
    // Measured: 1134 of 20 000.
    assert!((100..19_900).contains(&taken), "{taken} taken");
}

#[test]
fn an_expression_that_is_no_number_somewhere() {
    let cases = [("1/t", 0.0, f64::INFINITY), ("0/t", 0.0, f64::NAN), ("sqrt(0.5 - t)", 0.5, f64::NAN)];
    // A bound does not hide it.
    let bounded = [("max(0, sqrt(0.5 - t))", 0.5, f64::NAN), ("min(sqrt(0.5 - t), 1)", 0.5, f64::NAN)];
    for (text, near, value) in cases.into_iter().chain(bounded) {
        for history in [formula(text), History::Product { factors: vec![History::Constant, formula(text)] }] {
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
