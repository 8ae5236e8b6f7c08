//! Vibrations of a body in steady spin.

use dynamics::{Effect, EffectMap, SteadySpin};
use faer::Mat;
use nalgebra::Vector3;
use reduced_body::{ReducedBody, RigidMotion};

use crate::sample::body;

/// A point on a round spring that turns about the third axis: q are its first and second coordinate.
fn round_spring(omega: f64) -> ReducedBody {
    crate::sample::changed(body(RigidMotion::clamp(Vector3::zeros()), &[omega, omega]), |body| {
        body.inertia_second[2] = Mat::identity(2, 2);
        // qᵀ G q̇ = −e₃·(q × q̇)
        body.gyroscopic[2] = Mat::from_fn(2, 2, |i, j| i as f64 - j as f64);
    })
}

/// Closed form: |ω ± Ω|.
#[test]
fn a_point_on_a_round_spring_circles_by_the_sum_and_the_difference_of_frequency_and_spin() {
    let spin = SteadySpin::new(&round_spring(3.0), &Vector3::z(), &EffectMap::all());
    for speed in [0.5, 2.0, 2.9, 5.0] {
        let modes = spin.modes(speed).unwrap();
        // Beyond its frequency a body overtakes the circle that goes forwards, which it then sees go backwards.
        let forwards = if speed < 3.0 { 1.0 } else { -1.0 };
        for (mode, (omega, whirl)) in modes.iter().zip([((3.0 - speed).abs(), forwards), (3.0 + speed, -1.0)]) {
            assert!((mode.circular_frequency - omega).abs() < 1e-12 * (3.0 + speed), "{speed}: {mode:?}");
            assert!((mode.whirl - whirl).abs() < 1e-12 && mode.growth == 0.0, "{speed}: {mode:?}");
            assert!((mode.state.iter().map(|x| x.norm_sqr()).sum::<f64>() - 1.0).abs() < 1e-14);
        }
    }
}

/// Closed form: |ω ∓ Ω| = nΩ.
#[test]
fn critical_speeds_of_a_round_spring_are_fractions_of_its_frequency() {
    let spin = SteadySpin::new(&round_spring(3.0), &Vector3::z(), &EffectMap::all());
    // |3 − Ω| = nΩ and 3 + Ω = nΩ.
    for (order, expected) in [(0.0, vec![3.0, 3.0]), (0.5, vec![2.0, 6.0]), (1.0, vec![1.5]), (2.0, vec![1.0, 3.0])] {
        let found = spin.critical_speeds(order).unwrap();
        // At order 1 the other one is at infinite speed, and rounding leaves it there or at a speed that is as good.
        let found: Vec<f64> = found.into_iter().filter(|speed| *speed < 1e6).collect();
        assert_eq!(found.len(), expected.len(), "{order}: {found:?}");
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{order}: {found:?}");
    }
    assert!((spin.critical_speed().unwrap() - 3.0).abs() < 1e-12);
}

/// Conserved: ω = nΩ at a critical speed.
#[test]
fn at_a_critical_speed_some_frequency_is_a_multiple_of_the_spin() {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0, 14.0]);
    let axis = Vector3::new(1.0, 2.0, -2.0) / 3.0;
    let spin = SteadySpin::new(&body, &axis, &EffectMap::all());
    for order in [1.0, 2.5, 4.0] {
        let speeds = spin.critical_speeds(order).unwrap();
        assert!(!speeds.is_empty());
        for speed in speeds {
            let off = |mode: &dynamics::SpinMode| (mode.circular_frequency - order * speed).abs();
            let nearest = spin.modes(speed).unwrap().iter().map(off).fold(f64::INFINITY, f64::min);
            // Measured: 1.4e-15 at most.
            assert!(nearest < 1e-12 * order * speed, "{order} {speed}: {nearest:e}");
        }
    }
}

/// Closed form: the growth √(Ω² − ω²).
#[test]
fn without_coriolis_terms_what_loses_definiteness_grows() {
    let effects = EffectMap::all().without(Effect::Coriolis);
    let spin = SteadySpin::new(&round_spring(3.0), &Vector3::z(), &effects);
    for mode in spin.modes(5.0).unwrap() {
        // ω² = 3² − 5²
        assert!(mode.circular_frequency == 0.0 && (mode.growth - 4.0).abs() < 1e-12 && mode.whirl == 0.0, "{mode:?}");
    }
}
