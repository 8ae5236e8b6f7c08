//! A soft rod that swings.

use nonlinear::cases;

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

#[test]
fn a_soft_rod_falls_as_the_whole_mesh_does() {
    let (peak, [_, stiffened, large]) = off(2e7, 0.32, 160);
    assert!(peak > 0.07);
    assert!(large < 0.02 && stiffened > 4.0 * large, "{stiffened} {large}");
}

#[test]
#[ignore = "minutes: just nonlinear"]
fn a_soft_rod_swings_as_the_whole_mesh_does() {
    // Of the stiffest the midpoint rule needs short steps.
    for (young_modulus, end, tolerance) in [(6e8, 0.5, 0.015), (2e8, 1.0, 0.015), (5e7, 1.0, 0.03), (2e7, 1.0, 0.03)] {
        let (_, [_, _, large]) = off(young_modulus, end, 2000);
        assert!(large < tolerance, "{large}");
    }
}
