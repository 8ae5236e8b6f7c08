//! `docs/evidence/stability.md`.

use std::fmt::Write;
use std::time::Instant;

use crate::stability::systems::{self, SCHEMES, SystemCase};
use crate::stability::{BOUNDED, Bound, Extent, HardCase, TrialOutcome, sections};

/// The page, and the outcomes that are not what is asked for.
pub fn page(extent: Extent, mut progress: impl FnMut(&str)) -> (String, Vec<String>) {
    let mut page = String::from(
        "# Hard cases\n\n\
         Every case is run with every scheme by `./dev stability`. A cell has the largest error or drift of \
         the whole run; tests assert bounds of them, and `crates/verification/src/stability` says why each case is hard. Errors are \
         against closed forms where nothing else is said; attitudes are in rad; \"drift\" is of energy and angular \
         momentum, relative. \"(1)\" means that the body is refused, or that the run ends at its first bad step, with the words \
         below the table in its message. Nothing ends in NaN.\n",
    );
    let mut broken = Vec::new();
    for (title, cases) in sections() {
        let mut refusals: Vec<String> = Vec::new();
        // Writing to a String cannot fail.
        let _ = write!(page, "\n## {title}\n\n| case | measured |");
        let schemes = BOUNDED;
        for method in &schemes {
            let _ = write!(page, " {} |", name(*method));
        }
        let _ = writeln!(page, "\n|---|---|{}", "---|".repeat(schemes.len()));
        for case in cases {
            row(&mut page, &case, extent, &mut refusals, &mut broken, &mut progress);
        }
        below(&mut page, &refusals);
    }
    let (systems, of_systems) = of_systems(extent, &mut progress);
    broken.extend(of_systems);
    (page + &systems, broken)
}

/// The section of systems, which have schemes of their own, and their outcomes that are not what is asked for.
pub fn of_systems(extent: Extent, progress: &mut impl FnMut(&str)) -> (String, Vec<String>) {
    let (mut page, mut broken) = (String::new(), Vec::new());
    let mut refusals: Vec<String> = Vec::new();
    let _ = writeln!(
        page,
        "\n## Systems of bodies\n\nBy the schemes of systems with step control, at tolerance 1e-7 where nothing else is said.\n\n\
         | case | measured | {} | {} |\n|---|---|---|---|",
        SCHEMES[0].0, SCHEMES[1].0
    );
    for case in systems::cases() {
        let SystemCase { name, why, measure, expected, .. } = &case;
        let _ = write!(page, "| {name} | {measure} |");
        for (number, ((scheme, _), expected)) in SCHEMES.iter().zip(expected).enumerate() {
            let begin = Instant::now();
            let outcome = case.outcome(number, extent);
            progress(&format!("{name}, {scheme}: {outcome:?} in {:.1} s", begin.elapsed().as_secs_f64()));
            if !expected.holds(&outcome) {
                broken.push(format!("{name} ({why}), {scheme}: {outcome:?} is not {expected}"));
            }
            let _ = write!(page, " {} |", cell(&outcome, Some(expected), &mut refusals));
        }
        let _ = writeln!(page);
    }
    below(&mut page, &refusals);
    (page, broken)
}

/// The words of refusals, by the numbers that cells have.
fn below(page: &mut String, refusals: &[String]) {
    let words: Vec<String> = refusals.iter().enumerate().map(|(k, words)| format!("({}) {words}", k + 1)).collect();
    if !words.is_empty() {
        let _ = writeln!(page, "\nMessages: {}.", words.join("; "));
    }
}

fn row(
    page: &mut String,
    case: &HardCase,
    extent: Extent,
    refusals: &mut Vec<String>,
    broken: &mut Vec<String>,
    progress: &mut impl FnMut(&str),
) {
    let HardCase { name: title, why, measure, .. } = case;
    let _ = write!(page, "| {title} | {measure}");
    let mut judge = |who: &str, outcome: &TrialOutcome, expected: Option<&Bound>| {
        if let Some(expected) = expected.filter(|expected| !expected.holds(outcome)) {
            broken.push(format!("{title} ({why}), {who}: {outcome:?} is not {expected}"));
        }
    };
    if let Some(check) = &case.body {
        let outcome = check.run();
        judge("body", &outcome, Some(&check.expected));
        let _ = write!(page, "; {}: {}", check.what, cell(&outcome, Some(&check.expected), refusals));
    }
    let _ = write!(page, " |");
    for method in BOUNDED {
        let expected = case.expected_of(method);
        let begin = Instant::now();
        let outcome = (case.run)(method, extent);
        progress(&format!("{title}, {}: {outcome:?} in {:.1} s", name(method), begin.elapsed().as_secs_f64()));
        judge(&name(method), &outcome, expected);
        let _ = write!(page, " {} |", cell(&outcome, expected, refusals));
    }
    let _ = writeln!(page);
}

/// An outcome; words of refusals go below the table, each once.
fn cell(outcome: &TrialOutcome, expected: Option<&Bound>, refusals: &mut Vec<String>) -> String {
    match outcome {
        TrialOutcome::Ran(0.0) => "0".to_owned(),
        TrialOutcome::Ran(error) => format!("{error:.1e}"),
        TrialOutcome::Refused(message) => {
            let words = match expected {
                Some(Bound::Refused(part)) => part,
                _ => message.as_str(),
            };
            let place = refusals.iter().position(|known| known == words).unwrap_or_else(|| {
                refusals.push(words.to_owned());
                refusals.len() - 1
            });
            format!("({})", place + 1)
        }
    }
}

fn name(method: dynamics::Method) -> String {
    match method.formulation {
        "paper" if method.scheme == "rkmk4" => "paper rkmk4".to_owned(),
        _ => method.scheme.to_owned(),
    }
}
