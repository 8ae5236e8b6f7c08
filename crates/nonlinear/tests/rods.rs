//! A soft rod that swings.

use nonlinear::cases;

#[test]
#[ignore = "minutes: just nonlinear"]
fn a_soft_rod_swings_as_the_whole_mesh_does() {
    // Of 2e7, which bends by 7.5 % of the length, the manifold is off by the whole peak: see docs/nonlinear.md, Limits.
    for (young_modulus, end, steps, tolerance) in [(2e8, 1.0, 2000, 0.015)] {
        let courses = cases::pendulum(
            young_modulus,
            end,
            steps,
            &[
                "[modes]\nflexible = 8\n[effects]\nlarge_deflection = false\ngeometric_stiffening = false\nrefuse = false",
                "[modes]\nflexible = 8\n[effects]\nlarge_deflection = false\nrefuse = false",
                "[modes]\nflexible = 8\nlarge = 4\n[effects]\nlarge_deflection = true\nrefuse = false",
            ],
        )
        .unwrap();
        let peak = courses[0].peak();
        let off: Vec<f64> = courses[1..].iter().map(|course| course.distance(&courses[0]) / peak).collect();
        println!("E {young_modulus:e}: peak {peak:.5}; linear, stiffened and manifold off by {off:.4?} of it");
        assert!(off[2] < tolerance, "{off:?}");
    }
}
