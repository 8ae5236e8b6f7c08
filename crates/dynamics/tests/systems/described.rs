//! A run of bodies with joints that goes through its data and comes back is the same run.

use std::sync::Arc;

use dynamics::{
    Bushing, Coordinate, Coupling, DescribedBody, DescriptionError, Friction, History, Joint, JointDrive, JointForce,
    JointLawFn, Marker, Method, MotionState, Physics, PointForce, PointShapes, PointSpring, Rows, RunDescription,
    Start, StepControl, Stops, SystemObservation, SystemScheme, Table,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

use crate::flexible::rod;

/// A flexible rod on a hinge with a spring, and a rigid rod on a second one, which a gear couples with the first; a spring and a
/// bushing to the ground.
pub fn run() -> RunDescription {
    let conrod = rod();
    let inertia = Matrix3::from_diagonal(&Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0));
    let rod = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&rod, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center.clone(), Vector3::new(0.0, -9.81, 0.0), History::Constant);
    let axes = Matrix3::identity();
    let hinge = Marker::on_ground(conrod.body.origin + conrod.patches[0].0.position_body(), axes);
    let spring = JointForce {
        stiffness: 2.0,
        damping: 0.1,
        free: 0.2,
        stops: Some(Stops { limits: [-1.0, 1.0], stiffness: 1e3, damping: 1.0 }),
        friction: Some(Friction { force: 0.01, rate_scale: 0.1 }),
        motor: Some(JointDrive {
            amplitude: 0.3,
            history: History::Table(Table::new(vec![0.0, 0.1], vec![0.0, 1.0]).unwrap()),
        }),
        ..JointForce::default()
    };
    let root = conrod.stiffening_marker(0, 0);
    let tip = conrod.marker(0, 1);
    let far = Marker::on_ground(Vector3::new(5.0, 0.0, 0.0), axes);
    let first = Joint::revolute("first", [hinge, root]).with_force(Coordinate::Turn, spring);
    let second = Joint::revolute("second", [far.clone(), Marker::on_rigid(1, Vector3::x() * -0.5, axes)]);
    let described = |body: ReducedBody, loads, points| DescribedBody {
        damping_ratios: vec![0.01; body.flexible()],
        body,
        loads,
        physics: Physics::default(),
        points,
        name: None,
    };
    let at = |body: &ReducedBody, origin: Vector3<f64>| MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: origin,
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::zeros(),
        modal_displacement: vec![0.0; body.flexible()],
        modal_velocity: vec![0.0; body.flexible()],
    };
    let states = vec![at(&conrod.body, conrod.body.origin), at(&rod, Vector3::new(5.5, 0.0, 0.0))];
    let free_length = 0.5 * (conrod.body.origin - Vector3::x() * 5.0).norm();
    RunDescription {
        states,
        bodies: vec![
            described(conrod.body.clone(), Vec::new(), vec![conrod.patches[1].0.clone()]),
            described(rod, vec![Arc::new(weight)], vec![center]),
        ],
        joints: vec![first, second],
        couplings: vec![Coupling::gear("gear", [0, 1], -2.0)],
        elements: vec![
            Arc::new(PointSpring { markers: [far.clone(), tip.clone()], stiffness: 0.5, damping: 0.01, free_length }),
            Arc::new(Bushing {
                markers: [far, tip],
                stiffness: [Vector3::new(0.1, 0.2, 0.3), Vector3::new(0.01, 0.0, 0.02)],
                damping: [Vector3::new(0.01, 0.0, 0.0), Vector3::zeros()],
            }),
        ],
        start: Start::AsPlaced,
        method: Method::of_joints(SystemScheme::Radau),
        control: StepControl::Tolerance(1e-5),
        end: 0.2,
        rows: Rows::Interval(0.02),
    }
}

fn rows(run: &RunDescription) -> Vec<SystemObservation> {
    let mut simulation = run.begin().unwrap();
    let mut rows = vec![simulation.system_observation().unwrap()];
    while !simulation.is_over() {
        if simulation.advance(1).unwrap() == dynamics::Reached::Row {
            rows.push(simulation.system_observation().unwrap());
        }
    }
    rows
}

/// Conserved: every number of every row, to the last bit.
#[test]
fn a_system_through_its_data_is_the_same() {
    let gauss = RunDescription {
        method: Method::of_joints(SystemScheme::Gauss),
        control: StepControl::Fixed(2e-3),
        start: Start::Relaxed,
        ..run()
    };
    for run in [run(), gauss] {
        let found = rows(&RunDescription::from_bytes(&run.to_bytes().unwrap()).unwrap());
        assert!(found.len() > 9 && found[9].bodies[1].omega_body.norm() > 1e-3);
        assert_eq!(rows(&run), found);
    }
}

#[test]
fn a_law_of_one_s_own_is_refused_with_its_joint() {
    let mut run = run();
    let law = Arc::new(JointLawFn::new("PD", |_, angle, rate| -angle - rate));
    run.joints[1].turn_force = Some(JointForce { laws: vec![law], ..JointForce::default() });
    let refused = run.to_bytes().unwrap_err();
    assert_eq!(refused, DescriptionError::Law { joint: "second".into() });
}
