//! One meaning of the tolerance, for bodies alone and in joints: the sum of the errors of all steps.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use dynamics::{
    ConservativeBody, Initial, LoadFn, Marker, MotionState, Observation, Physics, PointShapes, PointSpring, Rows,
    SharedLoad, Simulation, Start, StatedError, StepControl, System, SystemMotion, SystemScheme, SystemSetup,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

use crate::flexible::{Jointed, rod};
use crate::mechanism::{angle, at_rest};
use crate::rigid::{GRAVITY, pendulum};

/// The last row of a run of a system, and the error that it states.
fn end_of(
    (system, states): (System, Vec<MotionState>),
    start: Start,
    tolerance: f64,
    end: f64,
) -> (Vec<Observation>, StatedError, u64) {
    let points = vec![Vec::new(); states.len()];
    let setup = SystemSetup {
        system,
        states,
        start,
        scheme: SystemScheme::Radau,
        control: StepControl::Tolerance(tolerance),
        end,
        rows: Rows::Interval(end),
        points,
    };
    let mut simulation = Simulation::of_system(setup).unwrap();
    while !simulation.is_over() {
        simulation.advance(1000).unwrap();
    }
    let stats = simulation.stats();
    (simulation.system_observation().unwrap().bodies, stats.error.unwrap(), stats.evaluations)
}

/// Independent reference: the same run at 1e-10. A body tumbles near its unstable axis for a minute, alone and tied by a spring that does
/// nothing: at 1e-4 its attitude is right to 1e-4 rad, at 1e-6 to 1e-6 rad, in both.
#[test]
fn a_tied_body_is_as_right_as_one_alone() {
    let inertia = Matrix3::from_diagonal(&Vector3::new(4.0, 5.0, 7.0));
    let reduced = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let omega = Vector3::new(0.01, 3.0, 0.02);
    let alone = |tolerance: f64| {
        let initial = Initial { omega, ..Initial::at_rest(0) };
        let run = Simulation::builder(&reduced, StepControl::Tolerance(tolerance), 60.0).initial(initial);
        let mut simulation = run.rows(Rows::Interval(60.0)).build().unwrap();
        let last = simulation.by_ref().last().unwrap().unwrap();
        (last.attitude, simulation.stats().error.unwrap())
    };
    let tied = |tolerance: f64| {
        let body = ConservativeBody::new(&reduced, &[], Vec::new(), &Physics::default()).unwrap();
        let axes = Matrix3::identity();
        let markers = [Marker::on_rigid(0, Vector3::zeros(), axes), Marker::on_ground(Vector3::z(), axes)];
        let nothing = PointSpring { markers, stiffness: 1e-9, damping: 0.0, free_length: 1.0 };
        let system = System::new(vec![body], Vec::new()).unwrap().with_elements(vec![Arc::new(nothing)]).unwrap();
        let state = MotionState { omega_body: omega, ..at_rest(Vector3::zeros()) };
        let (rows, error, _) = end_of((system, vec![state]), Start::AsPlaced, tolerance, 60.0);
        (rows[0].attitude, error)
    };
    let (reference, _) = alone(1e-10);
    for tolerance in [1e-4, 1e-6] {
        for (name, (attitude, error)) in [("alone", alone(tolerance)), ("tied", tied(tolerance))] {
            let off = attitude.angle_to(&reference);
            println!("{name} {tolerance:e}: {off:e} rad, stated {:e}", error.sum);
            assert!(off < tolerance && error.sum <= tolerance, "{name} {tolerance:e}: {off:e} {error:?}");
        }
    }
}

/// Closed form: a pendulum that is let go from the horizontal is at its lowest point after a quarter of a period and any number of periods.
/// After two hundred its angle is off by less than twenty times the tolerance, at any tolerance: of errors of its speed it remembers the
/// phase.
#[test]
fn a_pendulum_keeps_its_phase_over_many_periods() {
    let (mut a, mut g) = (1.0, f64::cos(0.25 * PI));
    while f64::abs(a - g) > 1e-15 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    let period = 2.0 * PI * f64::sqrt(2.0 / 3.0 / GRAVITY) / a;
    for scheme in [SystemScheme::Radau, SystemScheme::Gauss] {
        for tolerance in [1e-3, 1e-4, 1e-6] {
            let mut motion = pendulum(FRAC_PI_2).with_scheme(scheme);
            let steps = motion.advance(200.25 * period, tolerance, &mut 1e-3).unwrap();
            let off = angle(&motion, 0).abs();
            println!("{scheme:?} {tolerance:e}: {steps} steps, {off:e} rad");
            assert!(off < 20.0 * tolerance, "{scheme:?} {tolerance:e}: {off:e}");
        }
    }
}

/// Conserved: the energy of a rod that hangs undamped from the ground by a joint and rings, in a thousand periods of its first mode: at 1e-4
/// it loses less than 1 %, and the card's sums are within the tolerance and what may be forgotten.
#[test]
fn a_rod_at_a_joint_keeps_ringing() {
    let rod: &Jointed = rod();
    let weld =
        dynamics::Joint::fixed("weld", [Marker::on_ground(Vector3::zeros(), Matrix3::identity()), rod.marker(0, 0)]);
    let mut state = rod.at_rest(Vector3::new(0.15, 0.0, 0.0), Attitude::identity());
    state.modal_displacement[0] = 1e-5;
    let system = System::new(vec![rod.conservative()], vec![weld]).unwrap();
    let mut motion = SystemMotion::new(system.clone(), &[state.clone()]).unwrap();
    motion.assemble().unwrap();
    let energy = motion.energy().unwrap();
    let end = 50.0 * 2.0 * PI / rod.body.circular_frequencies[0];
    for tolerance in [1e-2, 1e-4] {
        let (rows, error, evaluations) = end_of((system.clone(), vec![state.clone()]), Start::AsPlaced, tolerance, end);
        let lost = 1.0 - rows[0].energy() / energy;
        println!("{tolerance:e}: {lost:e} lost, {evaluations} evaluations, {error:?}");
        assert!(lost.abs() < 10.0 * (error.sum + error.forgotten), "{lost:e} {error:?}");
        assert!(error.sum <= tolerance && error.forgotten <= f64::min(1e-2, 10.0 * tolerance), "{error:?}");
    }
}

/// Closed form: v₀ exp(−ct/m), Ft²/2m, v₀/ω sin ωt, and a load of 1e-9 N. Laws of their own move a ball that nothing ties, as they do in a
/// run of a body alone.
#[test]
fn laws_move_a_free_ball_of_a_system() {
    const MASS: f64 = 0.2;
    const END: f64 = 3.0;
    let reduced = ReducedBody::rigid(MASS, Vector3::zeros(), Matrix3::identity() * 1e-4, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    type Law = fn(Vector3<f64>, Vector3<f64>) -> Vector3<f64>;
    let (push, tiny) = (Vector3::new(0.1, 0.0, 0.2), Vector3::new(0.0, 0.0, 1e-9));
    let thrown = Vector3::new(20.0, 5.0, -3.0);
    let decay = f64::exp(-0.1 * END / MASS);
    let omega = f64::sqrt(5.0 / MASS);
    let cases: [(&str, Law, Vector3<f64>, Vector3<f64>); 6] = [
        ("drag", |_, v| v * -0.1, thrown, thrown * (MASS / 0.1 * (1.0 - decay))),
        ("push", |_, _| Vector3::new(0.1, 0.0, 0.2), Vector3::zeros(), push * (0.5 * END * END / MASS)),
        ("spring", |x, _| x * -5.0, Vector3::y() * 0.3, Vector3::y() * (0.3 * (END * omega).sin() / omega)),
        (
            "tiny, thrown",
            |_, v| Vector3::new(0.0, 0.0, 1e-9 * (1.0 + v.x)),
            thrown,
            thrown * END + tiny * (21.0 * 0.5 * END * END / MASS),
        ),
        ("tiny, at rest", |_, _| Vector3::new(0.0, 0.0, 1e-9), Vector3::zeros(), tiny * (0.5 * END * END / MASS)),
        (
            "tiny spring",
            |x, _| (Vector3::x() * 1e-9 - x) * 5.0,
            Vector3::zeros(),
            Vector3::x() * (1e-9 * (1.0 - (END * omega).cos())),
        ),
    ];
    for (name, law, velocity, expected) in cases {
        for tolerance in [1e-3, 1e-4, 1e-6, 1e-8, 1e-10] {
            let point = center.clone();
            let load: SharedLoad = Arc::new(LoadFn::new("law", move |motion, applied| {
                let force = law(motion.position_global(&point), motion.velocity_global(&point));
                applied.force(&point, &(motion.body_from_global * force));
            }));
            let body = ConservativeBody::new(&reduced, &[], vec![load], &Physics::default()).unwrap();
            let system = System::new(vec![body], Vec::new()).unwrap();
            let state = MotionState { velocity_global: velocity, ..at_rest(Vector3::zeros()) };
            let (rows, error, evaluations) = end_of((system, vec![state]), Start::AsPlaced, tolerance, END);
            let off = (rows[0].origin_global - expected).norm() / expected.norm();
            println!("{name} {tolerance:e}: {off:.1e} off, stated {:.1e}, {evaluations} evaluations", error.sum);
            assert!(off < 10.0 * tolerance && evaluations < 30_000, "{name} {tolerance:e}: {off:e}, {evaluations}");
        }
    }
}
