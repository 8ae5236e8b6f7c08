//! Bars whose frequencies are known in closed form.

use std::f64::consts::TAU;

use fem_tet10::Material;

use crate::bodies::{Body, STEEL, block_mesh};

/// Closed form: Euler–Bernoulli, free at both ends: βL of cosh x cos x = 1.
#[test]
fn a_slender_bar_bends_as_beam_theory_says() {
    // Two directions, two thicknesses; Timoshenko's correction of the first mode is below 0.1 % at this slenderness.
    let (length, height, width) = (400.0, 6.0, 4.0);
    let modes =
        Body::new(&block_mesh([length, width, height], [40, 1, 1]), Material { poisson_ratio: 0.0, ..STEEL }).modes(4);
    let wave_speed = (STEEL.young_modulus / STEEL.density).sqrt();
    let bending = |root: f64, thickness: f64| (root / length).powi(2) * wave_speed * thickness / 12.0f64.sqrt() / TAU;
    let (first, second) = (4.730_040_744_862_704, 7.853_204_624_095_838);
    let expected = [bending(first, width), bending(first, height), bending(second, width), bending(second, height)];
    for (found, euler_bernoulli) in modes.natural_frequencies().into_iter().zip(expected) {
        let off = found / euler_bernoulli - 1.0;
        assert!(off.abs() < 0.004, "{found} instead of {euler_bernoulli}: {off:e}");
    }
}

/// Closed form: f = k c/(2L), c = √(E/ρ).
#[test]
fn a_bar_without_poisson_effect_rings_at_multiples_of_c_over_2_l() {
    let length = 40.0;
    let bar = Body::new(&block_mesh([length, 6.0, 5.0], [20, 1, 1]), Material { poisson_ratio: 0.0, ..STEEL });
    let modes = bar.modes(20);
    let wave_speed = (STEEL.young_modulus / STEEL.density).sqrt();
    // Axial modes are those with (nearly) all of their displacement along the bar.
    let axial: Vec<f64> = (0..20)
        .filter(|k| {
            let shape = modes.shapes.col(*k);
            let across = shape.iter().enumerate().filter(|(i, _)| i % 3 != 0).map(|(_, u)| u.abs()).fold(0.0, f64::max);
            across < 1e-2 * shape.norm_max()
        })
        .map(|k| modes.natural_frequencies()[k])
        .collect();
    assert!(axial.len() >= 2, "{axial:?} of {:?}", modes.natural_frequencies());
    for (k, found) in (1..).zip(&axial[..2]) {
        let expected = f64::from(k) * wave_speed / (2.0 * length);
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} instead of {expected}");
    }
}
