//! Static equilibria: against closed forms, and against the accelerations of the run.

use std::sync::Arc;

use dynamics::{
    ConservativeBody, Coordinate, Equilibrium, ForceElement, History, Joint, JointForce, Marker, MotionState,
    Observation, Physics, PointForce, PointShapes, PointSpring, SteadyError, Stops, System, SystemMotion,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

use crate::flexible::rod;
use crate::mechanism::at_rest;

const MASS: f64 = 2.0;
const GRAVITY: f64 = 9.81;

/// A body of 2 kg with a weight along −y.
fn heavy() -> ConservativeBody {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.01, 0.2, 0.2));
    let reduced = ReducedBody::rigid(MASS, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, -MASS * GRAVITY, 0.0), History::Constant);
    ConservativeBody::new(&reduced, &[], vec![Arc::new(weight)], &Physics::default()).unwrap()
}

/// A rod of 2 m, turned from the x axis by an angle, on a hinge of the ground at its end.
fn pendulum(angle: f64, force: JointForce) -> SystemMotion {
    let attitude = Attitude::identity().advanced_by(&Vector3::new(0.0, 0.0, angle));
    let state = MotionState { attitude, ..at_rest(Vector3::new(angle.cos(), angle.sin(), 0.0)) };
    let markers = [
        Marker::on_ground(Vector3::zeros(), Matrix3::identity()),
        Marker::on_rigid(0, Vector3::new(-1.0, 0.0, 0.0), Matrix3::identity()),
    ];
    let hinge = Joint::revolute("hinge", markers).with_force(Coordinate::Turn, force);
    SystemMotion::new(System::new(vec![heavy()], vec![hinge]).unwrap(), &[state]).unwrap()
}

/// The angle of the first body about z.
fn angle(found: &Equilibrium) -> f64 {
    let axis = found.steady.states()[0].attitude.to_global(&Vector3::x());
    axis.y.atan2(axis.x)
}

/// The largest acceleration of a body that the equations of the run have at an equilibrium.
fn acceleration(motion: &SystemMotion, found: &Equilibrium) -> f64 {
    let mut motion = SystemMotion::new(motion.system().clone(), &found.steady.states()).unwrap();
    motion.find_reactions().unwrap();
    let count = motion.system().bodies().len();
    let largest = |body: usize| {
        let state = motion.state(body).unwrap();
        let mut out = Observation::new(state.modal_displacement.len(), 0);
        motion.observe(body, &[], &mut out).unwrap();
        out.origin_acceleration_global.norm().max(out.alpha_body.norm())
    };
    (0..count).map(largest).fold(0.0, f64::max)
}

/// Closed form: a pendulum hangs; where it stands on its head, it is unstable, and another equilibrium is where it hangs.
#[test]
fn a_pendulum_hangs_and_on_its_head_it_is_unstable() {
    let down = -std::f64::consts::FRAC_PI_2;
    for start in [0.0, 1.4, 3.0, -3.0] {
        let motion = pendulum(start, JointForce::default());
        let found = motion.equilibrium().unwrap();
        assert!(
            (angle(&found) - down).abs() < 1e-12 && found.stability.unstable == 0 && found.stability.indifferent == 0,
            "{start}"
        );
        assert!(motion.other_equilibria(&found).unwrap().iter().all(|other| other.stability.unstable == 1));
    }
    let motion = pendulum(-down, JointForce::default());
    let found = motion.equilibrium().unwrap();
    assert!((angle(&found) + down).abs() < 1e-12 && found.stability.unstable == 1);
    let others = motion.other_equilibria(&found).unwrap();
    assert!(others.len() == 1 && (angle(&others[0]) - down).abs() < 1e-12 && others[0].stability.unstable == 0);
}

/// Closed form: a spring of moment k about the hinge, k φ = m g l cos φ from below, also where it is soft and has turned more than once.
#[test]
fn a_spring_at_the_hinge_holds_it() {
    for (stiffness, free) in [(40.0, 0.0), (40.0, 7.0), (1e6, 0.3)] {
        let motion = pendulum(0.0, JointForce { stiffness, free, ..JointForce::default() });
        let found = motion.equilibrium().unwrap();
        // The turn is counted from the start, where it is 0.
        let turn = angle(&found) + if free > 6.0 { 2.0 * std::f64::consts::PI } else { 0.0 };
        let moment = stiffness * (turn - free) + MASS * GRAVITY * turn.cos();
        assert!(moment.abs() < 1e-8 * (stiffness + 20.0), "{stiffness} {free}: {turn} {moment}");
        assert!(found.stability.unstable == 0, "{stiffness} {free}");
        // A run counts turns from less than half a one.
        assert_eq!(found.wound().map(|(joint, _)| joint), (free > 6.0).then_some("hinge"));
        assert!(free > 6.0 || acceleration(&motion, &found) < 1e-8 * (1.0 + stiffness), "{stiffness} {free}");
    }
}

/// Closed form: on a stop, k (φ − φ₀) = −m g l cos φ; above it the pendulum is free.
#[test]
fn a_stop_holds_it() {
    let stops = Stops { limits: [-0.5, f64::INFINITY], stiffness: 1e4, damping: 3.0 };
    for start in [0.3, 1.5, -0.499, -0.6] {
        let motion = pendulum(start, JointForce { stops: Some(stops), ..JointForce::default() });
        let found = motion.equilibrium().unwrap();
        let turn = angle(&found);
        let moment = stops.stiffness * (turn - stops.limits[0]) + MASS * GRAVITY * turn.cos();
        assert!(moment.abs() < 1e-7 && found.stability.unstable == 0, "{start}: {turn} {moment}");
    }
}

/// Closed form: a mass on two inclined springs, (L − L₀) k y / L · 2 = −m g, has two stable places and an unstable one between.
#[test]
fn a_shallow_truss_has_three_equilibria() {
    let (half, stiffness, free_length) = (1.0, 4e3, 1.04_f64);
    let spring = |side: f64| PointSpring {
        markers: [
            Marker::on_ground(Vector3::new(side * half, 0.0, 0.0), Matrix3::identity()),
            Marker::on_rigid(0, Vector3::zeros(), Matrix3::identity()),
        ],
        stiffness,
        damping: 0.0,
        free_length,
    };
    let elements: Vec<Arc<dyn ForceElement>> = vec![Arc::new(spring(1.0)), Arc::new(spring(-1.0))];
    let upright = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    let guide = [Marker::on_ground(Vector3::zeros(), upright), Marker::on_rigid(0, Vector3::zeros(), upright)];
    let system = System::new(vec![heavy()], vec![Joint::prismatic("guide", guide)]).unwrap().with_elements(elements);
    let motion = SystemMotion::new(system.unwrap(), &[at_rest(Vector3::new(0.0, 0.25, 0.0))]).unwrap();
    let first = motion.equilibrium().unwrap();
    let mut all = motion.other_equilibria(&first).unwrap();
    all.push(first);
    let mut places: Vec<(f64, usize)> =
        all.iter().map(|found| (found.steady.states()[0].origin_global.y, found.stability.unstable)).collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(places.iter().map(|(_, unstable)| *unstable).collect::<Vec<_>>(), [0, 1, 0], "{places:?}");
    for (y, _) in places {
        let length = y.hypot(half);
        let force = -2.0 * stiffness * (length - free_length) * y / length - MASS * GRAVITY;
        assert!(force.abs() < 1e-9, "{y} {force}");
    }
}

/// Independent reference: a flexible rod on a hinge with a weight at its end hangs, stretched as the static solution of the hanging rod
/// that is fixed there.
#[test]
fn a_flexible_rod_hangs_stretched() {
    let rod = rod();
    let pull = Vector3::new(0.0, -2e4, 0.0);
    let load = || PointForce::dead(rod.patches[1].0.clone(), pull, History::Constant);
    let at = |angle: f64| {
        let attitude = Attitude::identity().advanced_by(&Vector3::new(0.0, 0.0, angle));
        rod.at_rest(attitude.to_global(&Vector3::new(0.15, 0.0, 0.0)), attitude)
    };
    let motion = |joint: fn(&str, [Marker; 2]) -> Joint, axes: Matrix3<f64>, state: MotionState| {
        let markers = [Marker::on_ground(Vector3::zeros(), axes), rod.marker(0, 0)];
        let body = rod.damped(0.01, vec![Arc::new(load())]);
        SystemMotion::new(System::new(vec![body], vec![joint("end", markers)]).unwrap(), &[state]).unwrap()
    };
    let hanging = motion(Joint::revolute, Matrix3::identity(), at(-1.0));
    let found = hanging.equilibrium().unwrap();
    assert!(
        (angle(&found) + std::f64::consts::FRAC_PI_2).abs() < 1e-6 && found.stability.unstable == 0,
        "{}",
        angle(&found)
    );
    let upright = at(-std::f64::consts::FRAC_PI_2);
    let axes = upright.attitude.global_to_body().transpose();
    let fixed = motion(Joint::fixed, axes, upright);
    let expected = fixed.equilibrium().unwrap();
    let [q, expected] = [&found, &expected].map(|found| found.steady.modal_displacement(0).to_vec());
    let size = expected.iter().map(|q| q.abs()).fold(0.0, f64::max);
    let off = q.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-6 * size, "{off} of {size}");
    assert!(acceleration(&hanging, &found) < 1e-5 * pull.norm() / rod.body.mass);
}

/// A body that nothing holds falls for ever.
#[test]
fn nothing_holds_a_free_body() {
    let system = System::new(vec![heavy()], Vec::new()).unwrap().with_names(vec!["stone".into()]);
    let motion = SystemMotion::new(system, &[at_rest(Vector3::zeros())]).unwrap();
    let error = motion.equilibrium().unwrap_err();
    assert!(matches!(&error, SteadyError::NoEquilibrium { body, .. } if body.contains("stone")), "{error}");
}
