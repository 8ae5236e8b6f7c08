//! Every hard case, with every scheme, held to its bound; the longest runs shortened.

use verification::stability::systems::SCHEMES;
use verification::stability::{BOUNDED, Extent, sections};

fn hold(section: &str) {
    let (_, cases) = sections().into_iter().find(|(title, _)| *title == section).unwrap();
    let mut broken = Vec::new();
    for case in &cases {
        let name = case.name;
        if let Some(check) = &case.body {
            let outcome = check.run();
            println!("{name}: {} {outcome:?}", check.what);
            if !check.expected.holds(&outcome) {
                broken.push(format!("{name}, {}: {outcome:?}, but {}", check.what, check.expected));
            }
        }
        for method in BOUNDED {
            let begin = std::time::Instant::now();
            let outcome = (case.run)(method, Extent::Test);
            println!("{name}: {method:?} {outcome:?} {:.2?}", begin.elapsed());
            if let Some(expected) = case.expected_of(method).filter(|expected| !expected.holds(&outcome)) {
                broken.push(format!("{name}, {method:?}: {outcome:?}, but {expected}"));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// Closed form: torque-free and free motions, in the bounds of each case; besides, energy and momenta.
#[test]
fn motion() {
    hold("Motion");
}

/// Closed form: vibrations of one mode, in the bounds of each case; besides, energy and momenta.
#[test]
fn time() {
    hold("Time");
}

/// Conserved: energy and angular momentum, in the bounds of each case; besides, closed forms.
#[test]
fn structure() {
    hold("Structure");
}

/// Conserved: energy and angular momentum, in the bounds of each case; besides, closed forms.
#[test]
fn mesh_and_material() {
    hold("Mesh and material");
}

/// Conserved: energy and momenta, in the bounds of each case; besides, closed forms.
#[test]
fn systems() {
    let mut broken = Vec::new();
    for case in verification::stability::systems::cases() {
        for (number, (scheme, _)) in SCHEMES.iter().enumerate() {
            let begin = std::time::Instant::now();
            let (outcome, expected) = (case.outcome(number, Extent::Test), &case.expected[number]);
            println!("{}: {scheme} {outcome:?} {:.2?}", case.name, begin.elapsed());
            if !expected.holds(&outcome) {
                broken.push(format!("{}, {scheme}: {outcome:?}, but {expected}", case.name));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
