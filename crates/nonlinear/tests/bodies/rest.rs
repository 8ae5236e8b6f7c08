//! Equilibria.

use modal::Support;
use nalgebra::Vector3;
use nonlinear::{Acting, EquilibriumSettings, ExternalForces, equilibrium};
use reduced_body::RigidMotion;

use crate::fixtures::{COLUMN, COLUMN_BENDING, L, body, column, force, mesh, modes, node, nodes};

/// The elastica under a dead end force α EI/L² across it: deflection of the tip over the length,
/// by shooting.
fn elastica(alpha: f64) -> f64 {
    let shoot = |curvature: f64| {
        let (mut theta, mut slope, mut height) = (0.0_f64, curvature, 0.0);
        let (steps, h) = (2000, 1.0 / 2000.0);
        for _ in 0..steps {
            let middle = theta + 0.5 * h * slope;
            let half = slope - 0.5 * h * alpha * theta.cos();
            height += h * middle.sin();
            theta += h * half;
            slope -= h * alpha * middle.cos();
        }
        (slope, height)
    };
    let (mut low, mut high) = (0.0, 2.0 * alpha);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if shoot(middle).0 < 0.0 { low = middle } else { high = middle }
    }
    shoot(low).1
}

/// Independent reference: the elastica by shooting.
#[test]
fn a_dead_end_force_bends_the_column_as_the_elastica_in_a_handful_of_factors() {
    let body = column();
    let tip = node(body.mesh(), [1.0, 0.0, 0.0]);
    for (alpha, most) in [(0.9, 7), (4.0, 12)] {
        let forces = ExternalForces::dead(force(&body, tip, [0.0, 0.0, alpha * COLUMN_BENDING]));
        let settings = EquilibriumSettings { steps: &[1], ..EquilibriumSettings::default() };
        let rest = equilibrium(&body, &forces, &Vector3::zeros(), None, &settings).unwrap();
        let found = rest.displacement[3 * tip + 2];
        println!("{alpha}: {found:.5} in {} factors, elastica {:.5}", rest.factors, elastica(alpha));
        // Shear and the elements along the column: 0.1 %.
        assert!((found / elastica(alpha) - 1.0).abs() < 2e-3);
        assert!(rest.factors <= most, "{}", rest.factors);
        assert_eq!(rest.negative_pivots, 0);
    }
}

/// Closed form: a column buckles under π²EI/4L² in each of its two planes alike; a prismatic bar stretches by the root of
/// the cubic that its stretch has.
#[test]
fn a_column_has_two_negative_pivots_beyond_the_load_of_euler_and_none_below() {
    let body = column();
    let euler = std::f64::consts::PI.powi(2) / 4.0 * COLUMN_BENDING;
    let (tip_nodes, weights) = body.mesh().surface_weights("tip").unwrap();
    let area: f64 = weights.iter().sum();
    let pressed = |part: f64| {
        let mut forces = vec![0.0; body.dofs()];
        for (node, weight) in tip_nodes.iter().zip(&weights) {
            forces[3 * *node as usize] = -part * euler * weight / area;
        }
        ExternalForces::dead(forces)
    };
    for (part, negative) in [(-3.0, 0), (0.97, 0), (1.03, 2), (8.0, 2), (9.5, 4)] {
        let rest =
            equilibrium(&body, &pressed(part), &Vector3::zeros(), None, &EquilibriumSettings::default()).unwrap();
        assert_eq!(rest.negative_pivots, negative, "{part}");
        // E A λ (λ² − 1)/2 = P along the bar, λ its stretch.
        let tip = node(body.mesh(), [1.0, 0.0, 0.0]);
        let stretch = 1.0 + rest.displacement[3 * tip];
        let force = COLUMN.young_modulus * area * stretch * (stretch * stretch - 1.0) / 2.0;
        assert!((force / (-part * euler) - 1.0).abs() < 1e-9, "{part}: {force}");
    }
}

/// Closed form: a moment m at its end bends a column to a circle of curvature m/EI, whichever way the moment turns.
#[test]
fn an_end_moment_bends_the_column_to_a_circle() {
    let body = column();
    let tip = node(body.mesh(), [1.0, 0.0, 0.0]);
    let angle = 1.2_f64;
    for turns in [false, true] {
        let patch = body.mesh().mean_rotation([1.0, 0.0, 0.0], Some(0.03)).unwrap();
        let moment = Vector3::new(0.0, -angle * COLUMN_BENDING, 0.0);
        let forces = ExternalForces(vec![Acting::Moment { patch, moment, turns }]);
        let rest = equilibrium(&body, &forces, &Vector3::zeros(), None, &EquilibriumSettings::default()).unwrap();
        let found = Vector3::from_column_slice(&rest.displacement[3 * tip..3 * tip + 3]);
        let expected = Vector3::new(angle.sin() / angle - 1.0, 0.0, (1.0 - angle.cos()) / angle);
        println!("{found:?} {expected:?} {}", rest.factors);
        // The moment is spread over the last 3 % of the length.
        assert!((found - expected).norm() < 0.03 * expected.norm());
    }
}

/// Closed form: a pressure p all round a body is a stress −p: without Poisson's ratio each side shrinks by the root of its
/// cubic. The body is free.
#[test]
fn a_free_body_under_pressure_all_round_shrinks_alike_and_does_not_move() {
    let mesh = mesh("l");
    let soft = fem_tet10::Material { poisson_ratio: 0.0, ..L };
    let body = body(mesh, soft, &Support::free());
    let pressure = 0.05 * soft.young_modulus;
    let forces = ExternalForces(vec![Acting::Pressure { group: "all".to_owned(), pressure }]);
    let rest = equilibrium(&body, &forces, &Vector3::zeros(), None, &EquilibriumSettings::default()).unwrap();
    // E (λ² − 1)/2 = −p λ: the second Piola–Kirchhoff stress of a Cauchy stress −p under F = λ 1 is −p λ.
    let ratio = pressure / soft.young_modulus;
    let stretch = (ratio * ratio + 1.0).sqrt() - ratio;
    let mean = body.origin();
    for (x, u) in body.mesh().positions().iter().zip(rest.displacement.chunks_exact(3)) {
        let expected = (stretch - 1.0) * (Vector3::from(*x) - mean);
        assert!((Vector3::from_column_slice(u) - expected).norm() < 1e-8, "{u:?} {expected:?}");
    }
}

/// Closed form: a shaft that turns about its own axis loses its stiffness at its first frequency, in two directions alike.
#[test]
fn a_shaft_beyond_its_critical_speed_has_negative_pivots() {
    let body = column();
    let support = Support::new(RigidMotion::clamp(Vector3::zeros()), nodes(body.mesh(), |x| x.x < 1e-9));
    let (frequencies, _) = modes(&body, &support, 2);
    for (part, negative) in [(0.98, 0), (1.02, 2)] {
        let omega = Vector3::x() * (part * frequencies[0]);
        let settings = EquilibriumSettings::default();
        let rest = equilibrium(&body, &ExternalForces::default(), &omega, None, &settings).unwrap();
        assert_eq!(rest.negative_pivots, negative, "{part}");
    }
}
