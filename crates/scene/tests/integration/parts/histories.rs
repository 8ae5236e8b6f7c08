//! How loads go with time. Tables in files have a test of their own.

use scene::{Formula, History, Interpolation, TablePoints};

const HALF_SINE: &str = "history = { kind = \"half-sine\", start = 0.0, duration = 0.02 }";

fn history(written: &str) -> History {
    let scene = crate::parts::with(
        "[[loads]]",
        "[time]",
        &crate::parts::section("[[loads]]", "[time]").replace(HALF_SINE, written),
    );
    match &scene.loads[..] {
        [load] => load.history.clone(),
        loads => panic!("{loads:?}"),
    }
}

#[test]
fn every_kind() {
    let (start, duration) = (0.0, 2.0);
    for (keys, wanted) in [
        ("kind = 'constant'", History::Constant),
        ("kind = 'step', at = 0.5", History::Step { at: 0.5 }),
        ("kind = 'ramp', duration = 2", History::Ramp { start, duration }),
        ("kind = 'ramp', start = -1, duration = 2", History::Ramp { start: -1.0, duration }),
        ("kind = 'half-sine', duration = 2", History::HalfSine { start, duration }),
        ("kind = 'sine', frequency = 5", History::Sine { frequency: 5.0, phase: 0.0, start, duration: None }),
        (
            "kind = 'sine', frequency = 5, phase = 1, start = 3, duration = 2",
            History::Sine { frequency: 5.0, phase: 1.0, start: 3.0, duration: Some(2.0) },
        ),
        ("kind = 'sweep', from = 0, to = 9, duration = 2", History::Sweep { from: 0.0, to: 9.0, start, duration }),
        ("kind = 'sweep', from = 9, to = 0, start = 1, duration = 2", {
            History::Sweep { from: 9.0, to: 0.0, start: 1.0, duration }
        }),
        (
            "kind = 'table', points = [[0, 1], [2, 3.5]]",
            History::Table(TablePoints {
                points: vec![[0.0, 1.0], [2.0, 3.5]],
                file: None,
                interpolation: Interpolation::Linear,
            }),
        ),
        (
            "kind = 'table', points = [[0, 1], [2, 3.5]], interpolation = 'monotone-cubic'",
            History::Table(TablePoints {
                points: vec![[0.0, 1.0], [2.0, 3.5]],
                file: None,
                interpolation: Interpolation::MonotoneCubic,
            }),
        ),
        (
            "kind = 'expression', formula = 'sin(2*pi*t)'",
            History::Expression(Formula { formula: "sin(2*pi*t)".to_owned(), discontinuities: vec![] }),
        ),
        (
            "kind = 'expression', formula = 'abs(t - 1)', discontinuities = [1, 2]",
            History::Expression(Formula { formula: "abs(t - 1)".to_owned(), discontinuities: vec![1.0, 2.0] }),
        ),
        (
            "kind = 'product', factors = ['constant', { kind = 'product', factors = [{ kind = 'step', at = 1 }] }]",
            History::Product {
                factors: vec![History::Constant, History::Product { factors: vec![History::Step { at: 1.0 }] }],
            },
        ),
    ] {
        assert_eq!(history(&format!("history = {{ {keys} }}")), wanted, "{keys}");
    }
    // As short as the stepper can tell, a part of 1e-12 of the end.
    let duration = 6e-13;
    assert_eq!(
        history(&format!("history = {{ kind = 'ramp', duration = {duration} }}")),
        History::Ramp { start, duration }
    );
    assert_eq!(history("history = \"constant\""), History::Constant);
    assert_eq!(history(""), History::Constant);
}

#[test]
fn what_is_no_history() {
    let positive = "expected a number greater than 0";
    for (keys, mark, key, words) in [
        ("kind = 'stepp', at = 1", "'stepp'", "kind", "did you mean `step`?"),
        ("kind = 'constant', at = 1", "at = 1 }", "at", "unknown key `at`"),
        ("kind = 'step'", "{ kind = 'step'", "at", "`at` is missing"),
        ("kind = 'step', at = 'now'", "'now'", "at", "found the string 'now', expected a finite number"),
        ("kind = 'ramp', duration = 0", "0 }", "duration", positive),
        ("kind = 'ramp'", "{ kind = 'ramp'", "duration", "`duration` is missing"),
        ("kind = 'sine', frequency = 0", "0 }", "frequency", positive),
        ("kind = 'sine'", "{ kind = 'sine'", "frequency", "frequency = 50.0"),
        ("kind = 'sine', frequency = 1, duration = 0", "0 }", "duration", positive),
        ("kind = 'sine', frequency = 1, fase = 0", "fase", "fase", "did you mean `phase`?"),
        ("kind = 'sweep', from = -1, to = 1, duration = 1", "-1,", "from", "found -1, expected a number of 0 or more"),
        ("kind = 'sweep', from = 1, to = -1, duration = 1", "-1,", "to", "found -1, expected a number of 0 or more"),
        ("kind = 'sweep', from = 1, to = 2, duration = 0", "0 }", "duration", positive),
        ("kind = 'table'", "{ kind = 'table'", "points", "found neither `points` nor `file`, expected exactly one"),
        ("kind = 'table', points = []", "[] }", "points", "found [], expected at least two pairs of time and factor"),
        ("kind = 'table', points = [[0, 1]]", "[[0, 1]]", "points", "expected at least two pairs"),
        ("kind = 'table', points = [[0, 1], [0, 2]]", "0, 2]", "points[1][0]", "found 0.0 after 0.0, expected times"),
        ("kind = 'table', points = [[0, 1], [1]]", "[1]]", "points[1]", "expected a list of 2 numbers"),
        ("kind = 'table', points = [[0, 1], [1, nan]]", "nan", "points[1][1]", "expected a finite number"),
        ("kind = 'table', points = [], file = 'a.csv'", "'a.csv'", "file", "found both `points` and `file`"),
        ("kind = 'expression', formula = ' '", "' '", "formula", "expected a formula in the time t"),
        ("kind = 'expression'", "{ kind = 'expr", "formula", "formula = \"sin(2*pi*t)\""),
        (
            "kind = 'expression', formula = 't', discontinuities = [2, 1]",
            "1] }",
            "discontinuities[1]",
            "found 1.0 after 2.0",
        ),
        (
            "kind = 'ramp', duration = 4e-13",
            "4e-13",
            "duration",
            "a duration that is not lost in rounding beside the end",
        ),
        ("kind = 'sine', frequency = 1, duration = 4e-13", "4e-13", "duration", "make the duration longer"),
        ("kind = 'sweep', from = 1, to = 2, duration = 4e-13", "4e-13", "duration", "end of the run, 0.5"),
        (
            "kind = 'table', points = [[0, 1], [0.1, 1], [0.1000000000004, 2]]",
            "0.1000000000004, 2]",
            "points[2][0]",
            "found 0.1000000000004 after 0.1, expected times whose distance is not lost in rounding",
        ),
        (
            "kind = 'expression', formula = 't', discontinuities = [1e-3, 1.0000000004e-3]",
            "1.0000000004e-3] }",
            "discontinuities[1]",
            "for a jump use",
        ),
        ("kind = 'product', factors = []", "[] }", "factors", "found [], expected at least one history"),
        ("kind = 'product'", "{ kind = 'prod", "factors", "`factors` is missing"),
        ("kind = 'product', factors = ['sine']", "'sine'", "factors[0]", "found the string 'sine', expected a table"),
        (
            "kind = 'product', factors = ['constant', { kind = 'ramp', duration = -3 }]",
            "-3 }",
            "factors[1].duration",
            positive,
        ),
    ] {
        let to = format!("history = {{ {keys} }}");
        crate::common::refused(HALF_SINE, &to, mark, &format!("loads[0].history.{key}"), &[words]);
    }
}
