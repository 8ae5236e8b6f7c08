//! Reactions against sums over the nodes: what holds the body gives M a of the particles less the loads. No constant of the
//! reduced body enters.

use dynamics::{
    Drive, DrivenMotion, DrivenSpeed, Effect, History, Initial, Observation, Physics, PointShapes, Rows, Setup,
    Simulation, StepControl,
};
use modal::{Modes, Solver, Support};
use nalgebra::Vector3;
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};

use crate::common::{dead_force, ring};
use crate::dalembert::{sum, times};
use crate::run::EXPONENTIAL;

const FLEXIBLE: usize = 8;
const FORCE: [f64; 3] = [30.0, -50.0, 80.0];
const AT: [f64; 3] = [95.0, 30.0, 20.0];

fn axis() -> Vector3<f64> {
    Vector3::new(1.0, 2.0, -2.0) / 3.0
}

/// The ring, held where it is farthest along −x.
struct Held {
    modes: Modes,
    body: ReducedBody,
}

fn held(motion: RigidMotion) -> Held {
    let ring = ring();
    let nodes = ring.mesh.nodes_in_box([-101.0, -40.0, -100.0], [-80.0, 40.0, 100.0]);
    assert!(nodes.len() > 3);
    let (k, m) = (ring.matrices.stiffness(), ring.matrices.mass());
    let support = Support::new(motion, nodes);
    let modes = Solver::new(k, m, ring.mesh.positions(), &support).unwrap().modes(FLEXIBLE, |_| ()).unwrap();
    let body = modes.reduced(m, ring.mesh.positions()).unwrap();
    Held { modes, body }
}

impl Held {
    fn point(&self, at: [f64; 3]) -> PointShapes {
        let location = ring().mesh.locate(at).unwrap();
        let positions = ring().mesh.positions();
        PointShapes::new(&self.body, &self.modes.point(positions, &location.nodes, &location.weights).unwrap())
    }

    /// Φ c at the nodes.
    fn field(&self, c: &[f64]) -> Vec<Vector3<f64>> {
        let at = |row: usize| c.iter().enumerate().map(|(k, c)| self.modes.shapes[(row, k)] * c).sum();
        (0..ring().mesh.positions().len()).map(|n| Vector3::from_fn(|axis, _| at(3 * n + axis))).collect()
    }

    /// In motion, under a load, after a while; the acceleration of the origin is that of the point.
    fn run(&self, drive: Option<Drive>) -> Observation {
        let list = |seed: f64, size: f64| (0..FLEXIBLE).map(|k| size * (seed + (k * k) as f64).sin()).collect();
        let initial = Initial {
            attitude: rigid_kin::Attitude::identity(),
            origin: None,
            velocity: 300.0 * axis(),
            omega: match self.body.motion.rotations() {
                [one] => one * 70.0,
                _ => Vector3::new(40.0, -60.0, 70.0),
            },
            modal_displacement: list(1.0, 0.02),
            modal_velocity: list(2.0, 30.0),
        };
        let mut physics = Physics { drive, ..Physics::default() };
        physics.effects[Effect::LargeDeflection] = false;
        let at_node = ring().mesh.positions()[ring().nearest_node(AT)];
        let load = dead_force(self.point(at_node), FORCE.into(), History::HalfSine { start: 0.0, duration: 0.03 });
        let origin = BodyPoint { position_body: Vector3::zeros(), shapes: faer::Mat::zeros(3, FLEXIBLE) };
        let mut simulation = Simulation::new(&Setup {
            body: &self.body,
            damping_ratios: &[0.03; FLEXIBLE],
            loads: &[load],
            physics: &physics,
            initial: &initial,
            method: &EXPONENTIAL,
            control: StepControl::Fixed(2e-5),
            end: 0.01,
            rows: Rows::Interval(0.01),
            points: &[PointShapes::new(&self.body, &origin)],
        })
        .unwrap();
        simulation.by_ref().last().unwrap().unwrap()
    }

    /// Force and moment about the origin, body components, by the particles.
    fn expected(&self, now: &Observation) -> [Vector3<f64>; 2] {
        let ring = ring();
        let to_body = |v: &Vector3<f64>| now.attitude.to_body(v);
        let (omega, alpha, of_origin) = (now.omega_body, now.alpha_body, to_body(&now.points[0].acceleration));
        let [u, v, a] = [&now.modal_displacement, &now.modal_velocity, &now.modal_acceleration].map(|c| self.field(c));
        let undeformed = ring.mesh.positions().iter().map(|x| Vector3::from(*x) - self.body.origin);
        let x: Vec<Vector3<f64>> = undeformed.zip(&u).map(|(x, u)| x + u).collect();
        let accelerations: Vec<Vector3<f64>> = (x.iter().zip(&v).zip(&a))
            .map(|((x, v), a)| of_origin + alpha.cross(x) + omega.cross(&omega.cross(x)) + 2.0 * omega.cross(v) + a)
            .collect();
        let inertia = times(ring.matrices.mass(), &accelerations);
        let load = to_body(&Vector3::from(FORCE)) * (std::f64::consts::PI * now.time / 0.03).sin();
        let struck = x[ring.nearest_node(AT)];
        [inertia.iter().sum::<Vector3<f64>>() - load, sum(&x, &inertia) - struck.cross(&load)]
    }

    /// The observation agrees with the particles; the largest difference, relative.
    fn check(&self, drive: Option<Drive>) -> Observation {
        let now = self.run(drive);
        let [force, moment] = self.expected(&now);
        let found = now.reaction;
        let errors =
            [(found.force_body - force).norm() / force.norm(), (found.moment_body - moment).norm() / moment.norm()];
        // Measured: 6e-11 at the most.
        assert!(errors.iter().all(|error| *error < 1e-9), "{errors:?} {force} {moment} {found:?}");
        now
    }
}

const POINT: Vector3<f64> = Vector3::new(-95.0, 3.0, 10.0);

/// Independent reference: M a of the particles less the loads.
#[test]
fn a_pin_gives_no_moment_and_all_else_is_that_of_the_particles() {
    let pinned = held(RigidMotion::pin(POINT));
    let now = pinned.run(None);
    let [force, _] = pinned.expected(&now);
    let found = now.reaction;
    assert!((found.force_body - force).norm() < 1e-9 * force.norm(), "{force} {found:?}");
    // The force at the other end of the ring would have this moment. Measured: 1e-13.
    assert!(found.moment_body.norm() < 1e-9 * force.norm() * 200.0, "{found:?}");
}

/// Independent reference: M a of the particles less the loads.
#[test]
fn a_hinge_gives_no_moment_about_its_axis() {
    let now = held(RigidMotion::hinge(POINT, axis())).check(None);
    let found = now.reaction;
    assert!(found.moment_body.dot(&axis()).abs() < 1e-9 * found.moment_body.norm(), "{found:?}");
    assert!((found.hinge_rate - now.omega_body.dot(&axis())).abs() < 1e-12 * found.hinge_rate.abs());
    // Below half a turn it is that of the attitude.
    assert!((found.hinge_angle - now.attitude.angle_to(&rigid_kin::Attitude::identity())).abs() < 1e-12, "{found:?}");
    assert_eq!([found.drive, found.drive_power, found.slider_position, found.slider_velocity], [0.0; 4]);
}

/// Independent reference: M a of the particles less the loads.
#[test]
fn a_slider_gives_no_force_along_its_direction() {
    let slider = held(RigidMotion::slider(axis()));
    let now = slider.check(None);
    let found = now.reaction;
    assert!(found.force_body.dot(&axis()).abs() < 1e-9 * found.force_body.norm(), "{found:?}");
    let moved = axis().dot(&now.origin_global);
    let start = axis().dot(&slider.body.origin);
    assert!((found.slider_position - (moved - start)).abs() < 1e-12 && found.slider_position > 0.1, "{found:?}");
    assert!(
        (found.slider_velocity - axis().dot(&now.points[0].velocity)).abs() < 1e-9 * found.slider_velocity.abs(),
        "{found:?}"
    );
}

/// Independent reference: M a of the particles less the loads.
#[test]
fn a_clamp_gives_what_the_particles_need() {
    let now = held(RigidMotion::clamp(POINT)).check(None);
    assert_eq!([now.reaction.hinge_angle, now.reaction.slider_position], [0.0; 2]);
}

/// Independent reference: M a of the particles less the loads.
#[test]
fn a_drive_gives_what_is_along_its_axis() {
    let history = History::Ramp { start: 0.0, duration: 0.02 };
    for motion in [DrivenMotion::Turn { axis: axis() }, DrivenMotion::Slide { direction: axis() }] {
        let drive = Drive { motion, speed: DrivenSpeed { amplitude: 90.0, history: history.clone() }, added: None };
        let now = held(RigidMotion::clamp(POINT)).check(Some(drive));
        let found = now.reaction;
        let (along, [way, speed]) = match motion {
            DrivenMotion::Turn { .. } => (found.moment_body.dot(&axis()), [found.hinge_angle, found.hinge_rate]),
            DrivenMotion::Slide { .. } => {
                (found.force_body.dot(&axis()), [found.slider_position, found.slider_velocity])
            }
        };
        assert!((found.drive - along).abs() < 1e-12 * found.drive.abs(), "{found:?}");
        assert!((found.drive_power - found.drive * 45.0).abs() < 1e-9 * found.drive_power.abs(), "{found:?}");
        assert!((speed - 45.0).abs() < 1e-9 && (way - 0.225).abs() < 1e-12, "{found:?}");
    }
}
