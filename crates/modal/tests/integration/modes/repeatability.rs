//! Signs are fixed, runs agree bit for bit on any number of threads, and what they take is told before.

use modal::{Modes, Progress, Support};

use crate::bodies::{block, mesh_file};

#[test]
fn the_factorisation_is_estimated_once_and_rightly() {
    let body = block([40.0, 6.0, 6.0], [6, 2, 2]);
    let solver = body.held(&Support::free());
    let mut told = Vec::new();
    let modes = solver.modes(4, |progress| told.push(progress)).unwrap();
    let [Progress::Ordering, Progress::Factorizing(forecast), Progress::Lanczos { .. }, ..] = told[..] else {
        panic!("{told:?}")
    };
    assert_eq!(forecast.factor_entries, modes.stats.factor_entries);
    // The basis may become as large as there is room for, and mostly stays smaller.
    assert!(forecast.peak_bytes >= modes.stats.peak_bytes, "{} < {}", forecast.peak_bytes, modes.stats.peak_bytes);
    // The factor is there at the second call.
    told.clear();
    solver.modes(4, |progress| told.push(progress)).unwrap();
    assert!(told.iter().all(|progress| matches!(progress, Progress::Lanczos { .. })), "{told:?}");
}

#[test]
fn the_component_of_largest_magnitude_is_positive_and_the_first_node_breaks_ties() {
    let modes = block([40.0, 6.0, 6.0], [6, 2, 2]).modes(14);
    let mut ties = 0;
    for shape in modes.shapes.col_iter() {
        let largest = shape.norm_max();
        let leading: Vec<f64> = shape.iter().copied().filter(|u| u.abs() > (1.0 - 1e-6) * largest).collect();
        assert!(leading[0] > 0.0, "{leading:?}");
        ties += usize::from(leading.iter().any(|u| *u < 0.0));
    }
    // A symmetric body has modes where the rule for ties is needed.
    assert!(ties > 0);
}

fn assert_identical(a: &Modes, b: &Modes, what: &str) {
    assert!(a.eigenvalues.iter().zip(&b.eigenvalues).all(|(a, b)| a.to_bits() == b.to_bits()), "{what}: eigenvalues");
    for (a, b) in a.shapes.col_iter().zip(b.shapes.col_iter()) {
        assert!(a.iter().zip(b.iter()).all(|(a, b)| a.to_bits() == b.to_bits()), "{what}: shapes");
    }
}

/// Conserved: the same bits on one and two threads.
#[test]
fn runs_agree_bit_for_bit_on_one_and_two_threads() {
    let plate = crate::bodies::Body::new(&mesh_file("plate.msh"), crate::bodies::STEEL);
    let on = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| plate.modes(10))
    };
    let one = on(1);
    assert_identical(&one, &on(1), "one thread again");
    assert_identical(&one, &on(2), "two threads");
}
