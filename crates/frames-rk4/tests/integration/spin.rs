//! The scheme creates and destroys spin at the relative rate ∓ω²Δt/2: it fades while no kept mode answers the
//! centrifugal field, and grows once one does.

use nalgebra::Vector3;

use crate::common::Synthesis as _;
use crate::common::{Specimen, advance, plate};

/// (|ω|/|ω₀| − 1) after half a second, of a free spin at 5 rad/s.
fn gain(specimen: &Specimen, axis: Vector3<f64>, step: f64) -> f64 {
    let mut scheme = specimen.scheme(0.05, vec![], &specimen.spinning(5.0 * axis), step);
    advance(&mut scheme, (0.5 / step).round() as usize);
    scheme.state().omega_body.norm() / 5.0 - 1.0
}

/// ω²Δt/2 · 0.5 s at 5 rad/s and 5e-4 s.
const EXPECTED: f64 = 25.0 * 5e-4 / 2.0 * 0.5;

/// Closed form: the relative rate −ω²Δt/2.
#[test]
fn a_rigid_body_loses_spin_about_every_axis() {
    let rigid = plate().truncated(0);
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        // Measured: −0.9953 and half of −0.9977 of the rate, about each axis.
        for (step, expected) in [(5e-4, EXPECTED), (2.5e-4, 0.5 * EXPECTED)] {
            let gain = gain(&rigid, axis, step);
            assert!((gain / expected + 1.0).abs() < 0.006, "{axis:?}, {step}: {gain}");
        }
    }
}

/// Regression only: the parts of ω²Δt/2 as measured here. Mode 8 (537 Hz) is the plate's first axial mode: the first
/// that the centrifugal field of a spin about axis 2 or 3 excites.
#[test]
fn spin_across_the_plate_grows_once_its_axial_mode_is_kept() {
    let excited = &plate().body.position_products[0][0][6..];
    let others = excited.iter().enumerate().filter(|(k, _)| *k != 7).fold(0.0_f64, |most, (_, c)| most.max(c.abs()));
    assert!(excited[7].abs() > 400.0 * others, "{excited:?}");

    // Measured, of ω²Δt/2 · 0.5 s = 0.3125 %: −0.995 about each axis with seven modes; −0.938, 0.925, 0.891 with ten, which is
    // −0.293 %, +0.289 %, +0.278 %.
    for (flexible, ratios) in [(7, [-0.995; 3]), (10, [-0.938, 0.925, 0.891])] {
        let plate = plate().truncated(flexible);
        for (axis, ratio) in [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().zip(ratios) {
            let gain = gain(&plate, axis, 5e-4);
            assert!((gain / EXPECTED - ratio).abs() < 0.002, "{flexible} modes, {axis:?}: {}", gain / EXPECTED);
        }
    }
}
