//! Frequencies of held bars against beam theory.

use std::f64::consts::TAU;

use fem_tet10::Material;
use modal::{Modes, Support};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::bodies::{Body, STEEL, block_mesh};
use crate::held::supports::nodes;

const LENGTH: f64 = 400.0;
const WIDTH: f64 = 4.0;
const HEIGHT: f64 = 6.0;

/// A bar along x, symmetric about the planes of its axes.
fn bar() -> Body {
    let material = Material { poisson_ratio: 0.0, ..STEEL };
    Body::new(&block_mesh([LENGTH, WIDTH, HEIGHT], [40, 2, 2]), material)
}

/// Euler–Bernoulli: cycles per time for βL and the thickness in the plane of bending.
fn bending(root: f64, thickness: f64) -> f64 {
    (root / LENGTH).powi(2) * (STEEL.young_modulus / STEEL.density).sqrt() * thickness / 12.0f64.sqrt() / TAU
}

/// Frequencies of the modes that move along `axis` for the most part.
fn along(modes: &Modes, axis: usize) -> Vec<f64> {
    let largest = |k: usize, axis: usize| {
        (axis..modes.shapes.nrows()).step_by(3).map(|i| modes.shapes[(i, k)].abs()).fold(0.0, f64::max)
    };
    let is_along = |k: &usize| (0..3).all(|other| other == axis || largest(*k, other) < 0.2 * largest(*k, axis));
    (0..modes.natural()).filter(is_along).map(|k| modes.natural_frequencies()[k]).collect()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    let off = found / expected - 1.0;
    assert!(off.abs() < tolerance, "{found} instead of {expected}: {off:e}");
}

/// Closed form: Euler–Bernoulli, clamped and free: βL of cosh x cos x = −1.
#[test]
fn a_clamped_bar_bends_as_beam_theory_says() {
    let bar = bar();
    let end = Vector3::new(-0.5 * LENGTH, 0.0, 0.0);
    let clamp = Support::new(RigidMotion::clamp(end), nodes(&bar.positions, |x| x.x < end.x + 1e-9));
    let modes = bar.held(&clamp).modes(6, |_| ()).unwrap();
    for (axis, thickness) in [(1, WIDTH), (2, HEIGHT)] {
        let found = along(&modes, axis);
        // 4.0e-6 and 2.9e-5.
        assert_near(found[0], bending(1.875_104_068_711_961, thickness), 1e-4);
        // −9.8e-5 and −6.8e-4, by shear.
        assert_near(found[1], bending(4.694_091_132_974_174, thickness), 1e-3);
    }
}

/// Closed form: Euler–Bernoulli, pinned and free: βL of tan x = tanh x; clamped and free in the other plane.
#[test]
fn a_hinged_bar_swings_freely_in_one_plane_and_is_clamped_in_the_other() {
    let bar = bar();
    let point = Vector3::new(-0.5 * LENGTH, 0.0, 0.0);
    let axis = Vector3::y();
    // A rigid shaft through the whole end.
    let hinge = Support::new(RigidMotion::hinge(point, axis), nodes(&bar.positions, |x| x.x < point.x + 1e-9));
    let modes = bar.held(&hinge).modes(6, |_| ()).unwrap();
    // −3.9e-4, by shear, and 4.0e-6.
    assert_near(along(&modes, 2)[0], bending(3.926_602_312_047_919, HEIGHT), 1e-3);
    assert_near(along(&modes, 1)[0], bending(1.875_104_068_711_961, WIDTH), 1e-4);
}

/// Closed form: Euler–Bernoulli, pinned and free: βL of tan x = tanh x.
#[test]
fn a_bar_pinned_at_its_end_bends_as_pinned_and_free() {
    let bar = bar();
    let point = Vector3::new(-0.5 * LENGTH, 0.0, 0.0);
    let pin = Support::new(RigidMotion::pin(point), nodes(&bar.positions, |x| x.x < point.x + 1e-9));
    let modes = bar.held(&pin).modes(4, |_| ()).unwrap();
    for (axis, thickness) in [(1, WIDTH), (2, HEIGHT)] {
        // −5.5e-5 and −3.9e-4, by shear.
        assert_near(along(&modes, axis)[0], bending(3.926_602_312_047_919, thickness), 1e-3);
    }
}

/// Closed form: Euler–Bernoulli, clamped and free, of half the length.
#[test]
fn a_bar_pinned_at_its_middle_bends_as_two_clamped_ones_or_as_if_free() {
    let bar = bar();
    let point = Vector3::zeros();
    let pin = Support::new(RigidMotion::pin(point), nodes(&bar.positions, |x| *x == point));
    assert_eq!(pin.nodes.len(), 1);
    let (pinned, free) = (bar.held(&pin).modes(6, |_| ()).unwrap(), bar.modes(6));
    for (axis, thickness) in [(1, WIDTH), (2, HEIGHT)] {
        let (found, free) = (along(&pinned, axis), along(&free, axis));
        // Both halves bend to the same side about a middle that does not turn.
        // 1.3e-5 and −4.0e-4.
        assert_near(found[0], bending(2.0 * 1.875_104_068_711_961, thickness), 1e-3);
        // The second mode of the free bar has its node at the middle: the pin takes no force.
        // 1.6e-11.
        assert_near(found[1], free[1], 1e-9);
    }
}
