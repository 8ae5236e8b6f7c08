//! Bodies under pressure: frequencies of small vibrations about their rest.

use nalgebra::Vector3;
use verification::nonlinear::cases::pressed;

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
#[ignore = "a minute: just nonlinear"]
fn a_closed_tube_stiffens_under_inner_pressure_as_the_whole_mesh() {
    let inside = |x: Vector3<f64>| {
        let ends = (0.02 - 1e-9..=0.98 + 1e-9).contains(&x.x);
        ends && x.y.abs() < 0.0401 && x.z.abs() < 0.0401
    };
    for size in [5e5, 2e6] {
        let [expected, free, found] = pressed("tube", 2e9, &[("inside", size)], inside, Some(0.3)).unwrap();
        println!("{size:e}: {found:.4} Hz, nonlinear elements {expected:.4}, free {free:.4}");
        // To a hundredth of the shift; the stress alone gives a quarter of it.
        assert!((found - expected).abs() < 0.01 * (expected - free).abs(), "{found} {expected} {free}");
    }
}

/// Independent reference: the nonlinear finite elements of this crate. 10 and 20 bar on all sides of a free rod of 2
/// GPa.
#[test]
#[ignore = "a minute: just nonlinear"]
fn a_rod_under_pressure_on_all_sides_as_the_whole_mesh() {
    for size in [1e6, 2e6] {
        let [expected, free, found] = pressed("rod", 2e9, &[("all", size)], |_| true, None).unwrap();
        println!("{size:e}: {found:.4} Hz, nonlinear elements {expected:.4}, free {free:.4}");
        // What is left is the strain itself, of the size of a thousandth.
        assert!((found / expected - 1.0).abs() < 5e-4, "{found} {expected} {free}");
    }
}

/// Independent reference: the nonlinear finite elements of this crate. A pressure on one end of a free rod: its
/// thrust follows the rod.
#[test]
#[ignore = "a minute: just nonlinear"]
fn a_rod_under_thrust_as_the_whole_mesh() {
    for size in [1e6, 2e6] {
        let [expected, free, found] =
            pressed("rod", 2e9, &[("tip", size)], |x: Vector3<f64>| x.x > 1.0 - 1e-9, None).unwrap();
        println!("{size:e}: {found:.4} Hz, nonlinear elements {expected:.4}, free {free:.4}");
        assert!((found - expected).abs() < 0.02 * (expected - free).abs(), "{found} {expected} {free}");
    }
}
