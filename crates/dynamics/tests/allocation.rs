//! A step allocates nothing.

#[allow(dead_code)] // shared with the other test programs, which use all of it
mod common;

use std::sync::Arc;

use allocation_counter::measure;
use dynamics::{
    Bushing, ConservativeBody, Coordinate, Expression, Friction, History, Initial, Joint, JointForce, Marker, Method,
    MotionState, Physics, Reached, Rows, Setup, Simulation, StepControl, Stops, System, SystemMotion, SystemScheme,
    Table,
};
use frames_rk4::Paper;
use nalgebra::Vector3;

fn spinning() -> Initial {
    Initial { omega: Vector3::new(4.0, -6.0, 7.0), ..Initial::at_rest(10) }
}

/// A run of the ring under a load, with a point that is observed.
fn simulation(method: Method, control: StepControl, end: f64) -> Simulation {
    let ring = common::ring();
    Simulation::new(&Setup {
        physics: &Physics::default(),
        body: &ring.body,
        damping_ratios: &[0.0; 10],
        loads: &[ring.half_sine([-100.0, 0.0, 0.0], [10.0, 20.0, 30.0], end)],
        initial: &spinning(),
        method: Paper { reference_points: ring.reference_points_body() }.or(&method),
        control,
        end,
        rows: Rows::EverySteps(10),
        points: &[ring.point([0.0, -80.0, 20.0])],
    })
    .unwrap()
}

/// Allocations of 1000 steps with a row after each ten, after `warm` such rows.
fn allocations(mut simulation: Simulation, warm: usize) -> u64 {
    let mut out = simulation.observation().unwrap();
    let mut rows = |count| {
        for _ in 0..count {
            assert_eq!(simulation.advance(u64::MAX).unwrap(), Reached::Row);
            simulation.observe([&mut out]).unwrap();
        }
    };
    rows(warm);
    measure(|| rows(100)).count_total
}

#[test]
fn steps_and_rows_of_a_run_allocate_nothing_once_the_step_is_known() {
    for method in common::METHODS {
        assert_eq!(allocations(simulation(method, StepControl::Fixed(5e-5), 1.0), 1), 0, "{method:?}");
    }
    for method in [Method::EXPONENTIAL, Method::RKMK4] {
        assert_eq!(allocations(simulation(method, StepControl::Tolerance(1e-6), 1.0), 200), 0, "{method:?}");
    }
}

#[test]
fn histories_allocate_nothing() {
    let text = "min(exp(-t^2), 2)*max(sin(2*pi*t), cos(t), 0.5)*abs(t)^0.3 + hypot(atan2(t, 2), sqrt(t))";
    let rows: Vec<f64> = (0..1000).map(f64::from).collect();
    let history = History::Product {
        factors: vec![
            History::Sweep { from: 1.0, to: 9.0, start: 0.0, duration: 10.0 },
            History::Table(Table::new(rows.clone(), rows.iter().map(|t| t.sin()).collect()).unwrap()),
            History::Expression(Expression::new(text, vec![3.0]).unwrap()),
            History::Ramp { start: 1.0, duration: 1.0 },
        ],
    };
    let mut sum = 0.0;
    let memory = measure(|| sum = (0..1000).map(|k| 0.01 * f64::from(k)).map(|t| history.at(t, t + 0.005)).sum());
    assert_eq!(memory.count_total, 0);
    assert!(sum.is_finite() && sum != 0.0);
}

#[test]
fn steps_of_a_system_with_joints_allocate_nothing() {
    let ring = common::ring();
    let body = ConservativeBody::new(&ring.body, &[0.0; 10], Vec::new(), &Physics::default()).unwrap();
    let axes = nalgebra::Matrix3::identity();
    let pin = Marker::on_rigid(0, Vector3::new(-100.0, 0.0, 0.0), axes);
    let joints = vec![
        Joint::revolute("hinge", [Marker::on_ground(Vector3::zeros(), axes), pin]).with_force(
            Coordinate::Turn,
            JointForce {
                stiffness: 3.0,
                stops: Some(Stops { limits: [-0.1, 0.1], stiffness: 1e6, damping: 0.0 }),
                friction: Some(Friction { force: 1.0, rate_scale: 0.1 }),
                ..JointForce::default()
            },
        ),
        Joint::spherical(
            "between",
            [Marker::on_rigid(0, Vector3::x() * 90.0, axes), Marker::on_rigid(1, Vector3::y(), axes)],
        ),
    ];
    let bushing = Bushing {
        markers: [Marker::on_rigid(0, Vector3::x() * 90.0, axes), Marker::on_rigid(1, Vector3::y(), axes)],
        stiffness: [Vector3::zeros(), Vector3::repeat(1e4)],
        damping: [Vector3::zeros(); 2],
    };
    let system = System::new(vec![body.clone(), body], joints).unwrap();
    let system = system.with_elements(vec![Arc::new(bushing)]).unwrap();
    let start = |x: f64| MotionState {
        time: 0.0,
        attitude: rigid_kin::Attitude::identity(),
        origin_global: Vector3::new(x, 0.0, 0.0),
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::new(0.0, 0.0, 3.0),
        modal_displacement: vec![0.0; 10],
        modal_velocity: vec![0.0; 10],
    };
    let mut at_start = SystemMotion::new(system, &[start(100.0), start(190.0)]).unwrap();
    at_start.assemble().unwrap();
    for (scheme, end) in [(SystemScheme::Radau, 2e-2), (SystemScheme::Rkmk4, 1e-2)] {
        let mut motion = at_start.clone().with_scheme(scheme);
        let mut h = 1e-5;
        motion.advance(1e-3, 1e-8, &mut h).unwrap();
        let steps = || assert!(motion.advance(end, 1e-8, &mut h).unwrap() > 10);
        assert_eq!(measure(steps).count_total, 0, "{scheme:?}");
        motion.find_reactions().unwrap();
        assert_eq!(measure(|| assert!(motion.observe_element(0).is_finite())).count_total, 0, "{scheme:?}");
    }
}
