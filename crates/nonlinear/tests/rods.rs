//! A soft rod that swings, and bodies under pressure.

use nonlinear::cases;

#[test]
#[ignore = "minutes: just nonlinear"]
fn a_soft_rod_swings_as_the_whole_mesh_does() {
    for (young_modulus, end, steps) in [(2e8, 1.2, 2400), (2e7, 1.2, 1200)] {
        let courses = cases::pendulum(young_modulus, end, steps, &[
            "[modes]\nflexible = 8\n[effects]\nlarge_deflection = false\ngeometric_stiffening = false\nrefuse = false",
            "[modes]\nflexible = 8\n[effects]\nlarge_deflection = false\nrefuse = false",
            "[modes]\nflexible = 8\nlarge = 4\n[effects]\nlarge_deflection = true\nrefuse = false",
        ]).unwrap();
        let peak = courses[0].peak();
        let off: Vec<f64> = courses[1..].iter().map(|course| course.distance(&courses[0]) / peak).collect();
        println!("E {young_modulus:e}: peak {peak:.5}; linear, stiffened and manifold off {off:?}");
    }
}

#[test]
fn pressures() {
    let young_modulus = 2e9;
    for size in [1e6, 2e6] {
        println!("all round {size:e}: {:?}", cases::pressed("rod", young_modulus, &[("all", size)], |_| true));
    }
    let inside = |x: nalgebra::Vector3<f64>| (0.02 - 1e-9..=0.98 + 1e-9).contains(&x.x) && x.y.abs() < 0.0401 && x.z.abs() < 0.0401;
    for size in [5e5, 1e6, 2e6] {
        println!("tube {size:e} {:?}", cases::pressed("tube", young_modulus, &[("inside", size)], inside));
    }
}
