//! A soft rod that swings.

use nalgebra::DMatrix;
use verification::nonlinear::{bodies, cases, signal};

/// Largest distance from the nonlinear body of the deflection of linear modes, stiffened modes and large modes, over its
/// peak, which is a part of the length.
fn off(young_modulus: f64, end: f64, steps: usize) -> (f64, [f64; 3]) {
    let scenes = [
        "[modes]\nflexible = 8\n[effects]\nlarge_deflection = false\ngeometric_stiffening = false\nrefuse = false",
        "[modes]\nflexible = 8\n[effects]\nlarge_deflection = false\nrefuse = false",
        "[modes]\nflexible = 8\nlarge = 4\n[effects]\nlarge_deflection = true\nrefuse = false",
    ];
    let courses = cases::pendulum(young_modulus, end, steps, &scenes).unwrap();
    let peak = courses[0].peak();
    let off = [1, 2, 3].map(|i| courses[i].distance(&courses[0]) / peak);
    println!("E {young_modulus:e}: peak {peak:.5}; linear, stiffened and large modes off by {off:.4?} of it");
    (peak, off)
}

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
fn a_soft_rod_falls_as_the_whole_mesh_does() {
    let (peak, [_, stiffened, large]) = off(2e7, 0.32, 160);
    assert!(peak > 0.07);
    assert!(large < 0.02 && stiffened > 4.0 * large, "{stiffened} {large}");
}

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
#[ignore = "minutes: just nonlinear"]
fn a_soft_rod_swings_as_the_whole_mesh_does() {
    // Of the stiffest the midpoint rule needs short steps.
    for (young_modulus, end, tolerance) in [(6e8, 0.5, 0.015), (2e8, 1.0, 0.015), (5e7, 1.0, 0.03), (2e7, 1.0, 0.03)] {
        let (_, [_, _, large]) = off(young_modulus, end, 2000);
        assert!(large < tolerance, "{large}");
    }
}

/// Circular frequencies of small swings of a heavy thin rod that hangs from a hinge, slowest first, by Ritz on polynomials:
/// L = ρA = 1, EI over ρA as given.
fn heavy_rod(bending: f64, gravity: f64) -> Vec<f64> {
    let count = 8;
    let power = |i: usize| (i + 1) as f64;
    let stiffness = DMatrix::from_fn(count, count, |i, j| {
        let (a, b) = (power(i), power(j));
        let bends = if i > 0 && j > 0 { a * (a - 1.0) * b * (b - 1.0) / (a + b - 3.0) } else { 0.0 };
        // ∫ x^n (1 − x) dx
        let n = a + b - 2.0;
        bending * bends + gravity * a * b * (1.0 / (n + 1.0) - 1.0 / (n + 2.0))
    });
    let mass = DMatrix::from_fn(count, count, |i, j| 1.0 / (power(i) + power(j) + 1.0));
    let inverse = mass.cholesky().unwrap().l().try_inverse().unwrap();
    let squares = (&inverse * stiffness * inverse.transpose()).symmetric_eigenvalues();
    let mut found: Vec<f64> = squares.iter().map(|square| square.sqrt()).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Independent reference: Ritz on polynomials for a heavy beam. A hinged rod that hangs at rest and bends a little:
/// its weight stiffens it by a quarter.
#[test]
fn a_hanging_rod_has_the_frequency_of_a_heavy_beam() {
    let young_modulus = 2e7;
    let bending = young_modulus * 0.02 * 0.02 / 12.0 / 1000.0;
    let text = |rest: &str| {
        format!(
            "{rest}\n[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\n\
             [[loads]]\nkind = \"gravity\"\ndirection = [1.0, 0.0, 0.0]\namplitude = 9.81\n\
             [time]\nend = 8.0\nstep = 1e-3\n"
        )
    };
    let modes = "[modes]\nflexible = 8\n";
    let (_, rest) = cases::built("rod", bodies::soft(young_modulus), &text(modes)).unwrap();
    let bends = (0..8).find(|k| {
        let [peak, across] = cases::peaks(&cases::shape(&rest, *k), 2);
        across > 0.9 * peak
    });
    let bends = bends.unwrap();
    let mut q = vec![0.0; bends + 1];
    q[bends] = 1e-4;
    let free = rest.body.circular_frequencies[bends];
    let expected = heavy_rod(bending, 9.81)[1];
    for (large, effects) in [("", "large_deflection = false"), ("large = 4", "large_deflection = true")] {
        let all = format!(
            "{modes}{large}\n[effects]\ngeometric_stiffening = true\n{effects}\n[initial]\nmodal_displacement = {q:?}\n"
        );
        let (scene, model) = cases::built("rod", bodies::soft(young_modulus), &text(&all)).unwrap();
        let rows = cases::rows(&scene, &model).unwrap();
        let times: Vec<f64> = rows.iter().step_by(10).map(|row| row.time).collect();
        let values: Vec<f64> = rows.iter().step_by(10).map(|row| row.modal_displacement[bends]).collect();
        let found = signal::frequency(&times, &values, expected, 1);
        println!("{effects}: {found:.4} rad/s, heavy beam {expected:.4}, without weight {free:.4}");
        // Measured: 2.6e-4 and 9e-5.
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} instead of {expected}");
        assert!(free < 0.85 * expected);
    }
}
