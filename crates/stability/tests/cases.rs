//! Every hard case, with every scheme, held to its bound; the longest runs shortened.

use stability::{Case, Extent, SCHEMES, sections};

fn hold(section: &str) {
    let (_, cases) = sections().into_iter().find(|(title, _)| *title == section).unwrap();
    let mut broken = Vec::new();
    for Case { name, run, expected, body, .. } in &cases {
        if let Some(check) = body {
            let outcome = check.run();
            println!("{name}: {} {outcome:?}", check.what);
            if !check.expected.holds(&outcome) {
                broken.push(format!("{name}, {}: {outcome:?}, but {}", check.what, check.expected));
            }
        }
        for (method, expected) in SCHEMES.into_iter().zip(expected) {
            let begin = std::time::Instant::now();
            let outcome = run(method, Extent::Test);
            println!("{name}: {method:?} {outcome:?} {:.2?}", begin.elapsed());
            if !expected.holds(&outcome) {
                broken.push(format!("{name}, {method:?}: {outcome:?}, but {expected}"));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn motion() {
    hold("Motion");
}

#[test]
fn time() {
    hold("Time");
}

#[test]
fn structure() {
    hold("Structure");
}

#[test]
fn mesh_and_material() {
    hold("Mesh and material");
}
