//! Linearised equations of systems: against the equations of the run, and against closed forms.

use std::sync::{Arc, OnceLock};

use dynamics::{
    Bushing, CommonSpin, ConservativeBody, Coordinate, ForceElement, History, Joint, JointDrive, JointForce, LoadFrame,
    Marker, MotionState, Observation, Physics, PointForce, PointSpring, SteadyState, System, SystemMode, SystemMotion,
    Table,
};
use faer::c64;
use fem_tet10::Material;
use nalgebra::{Matrix3, Vector3};
use reduced_body::{ReducedBody, RigidMotion};
use rigid_kin::Attitude;

use crate::flexible::Jointed;
use crate::mechanism::at_rest;

/// A bar of 200 × 10 × 10 mm, with its ends for patches; N, mm, t.
fn bar() -> &'static Jointed {
    static BAR: OnceLock<Jointed> = OnceLock::new();
    let aluminium = Material { young_modulus: 70_000.0, poisson_ratio: 0.33, density: 2.7e-9 };
    BAR.get_or_init(|| Jointed::new("half_bar", aluminium, 4, &["left", "right"]))
}

/// Accelerations V̇, ω̇ of each body in its axes, and q̈.
fn accelerations(motion: &mut SystemMotion) -> Vec<f64> {
    motion.find_reactions().unwrap();
    let mut all = Vec::new();
    for body in 0..motion.system().bodies().len() {
        let state = motion.state(body).unwrap();
        let mut out = Observation::new(state.modal_displacement.len(), 0);
        motion.observe(body, &[], &mut out).unwrap();
        let velocity = state.attitude.to_body(&state.velocity_global);
        let turned = state.attitude.to_body(&out.origin_acceleration_global) - state.omega_body.cross(&velocity);
        all.extend(turned.iter().chain(&out.alpha_body).chain(&out.modal_acceleration));
    }
    all
}

/// The states after changes of place and of velocities, body by body.
fn changed(states: &[MotionState], place: &[f64], velocity: &[f64]) -> Vec<MotionState> {
    let mut first = 0;
    let of_body = |state: &MotionState| {
        let n = 6 + state.modal_displacement.len();
        let [x, v] = [&place[first..first + n], &velocity[first..first + n]];
        first += n;
        let part = |list: &[f64], at: usize| Vector3::new(list[at], list[at + 1], list[at + 2]);
        let attitude = state.attitude.advanced_by(&part(x, 3));
        let of_origin = state.attitude.to_body(&state.velocity_global) + part(v, 0);
        MotionState {
            origin_global: state.origin_global + state.attitude.to_global(&part(x, 0)),
            attitude,
            velocity_global: attitude.to_global(&of_origin),
            omega_body: state.omega_body + part(v, 3),
            modal_displacement: state.modal_displacement.iter().zip(&x[6..]).map(|(q, dq)| q + dq).collect(),
            modal_velocity: v[6..].to_vec(),
            ..state.clone()
        }
    };
    states.iter().map(of_body).collect()
}

/// L x of all bodies.
fn convected(states: &[MotionState], x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; x.len()];
    let mut first = 0;
    for state in states {
        let part = |at: usize| Vector3::new(x[first + at], x[first + at + 1], x[first + at + 2]);
        let velocity = state.attitude.to_body(&state.velocity_global);
        let moved = state.omega_body.cross(&part(0)) + velocity.cross(&part(3));
        out[first..first + 3].copy_from_slice(moved.as_slice());
        out[first + 3..first + 6].copy_from_slice(state.omega_body.cross(&part(3)).as_slice());
        first += 6 + state.modal_displacement.len();
    }
    out
}

/// The largest difference between η̈ = −C η̇ − K η and central differences of the accelerations of the run, over all directions,
/// relative to the largest entry of its row: the root mean square by mass.
fn error(system: &System, steady: &SteadyState) -> f64 {
    let states = steady.states();
    let linear = &steady.linear;
    let (n, size) = (linear.basis.nrows(), linear.size());
    let column = |k: usize| -> Vec<f64> { (0..n).map(|i| linear.basis[(i, k)]).collect() };
    // The same states with V' and ω' in the place of velocities.
    let accelerated: Vec<MotionState> = states
        .iter()
        .zip(steady.unbalance.accelerations.iter().zip(&steady.unbalance.angular_accelerations))
        .map(|(state, (rate, omega_rate))| MotionState {
            velocity_global: state.attitude.to_global(rate),
            omega_body: *omega_rate,
            ..state.clone()
        })
        .collect();
    let mut worst: f64 = 0.0;
    for (of_velocity, k) in [false, true].into_iter().flat_map(|of| (0..size).map(move |k| (of, k))) {
        let direction = column(k);
        // Of stiff coordinates a small step.
        let step = if of_velocity { 1e-2 } else { 1e-5 / linear.stiffness[(k, k)].abs().sqrt().max(10.0) };
        let mut found = vec![0.0; n];
        for sign in [1.0, -1.0] {
            let scaled: Vec<f64> = direction.iter().map(|x| sign * step * x).collect();
            let zeros = vec![0.0; n];
            let moved = match of_velocity {
                true => changed(&states, &zeros, &scaled),
                false => changed(&states, &scaled, &convected(&states, &scaled)),
            };
            let mut motion = SystemMotion::new(system.clone(), &moved).unwrap();
            let of = accelerations(&mut motion);
            found.iter_mut().zip(&of).for_each(|(sum, a)| *sum += sign * a / (2.0 * step));
        }
        // δv̇ = N η̈ + L N η̇ + L' N η
        let rates: Vec<f64> =
            (0..size).map(|i| -if of_velocity { linear.damping[(i, k)] } else { linear.stiffness[(i, k)] }).collect();
        let mut expected: Vec<f64> =
            (0..n).map(|i| (0..size).map(|j| linear.basis[(i, j)] * rates[j]).sum::<f64>()).collect();
        let moving = if of_velocity { &states } else { &accelerated };
        expected.iter_mut().zip(convected(moving, &direction)).for_each(|(a, more)| *a += more);
        let size_of = |list: &[f64]| list.iter().map(|x| x * x).sum::<f64>().sqrt();
        let off: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
        let scale = size_of(&expected) + if of_velocity { 1.0 } else { 100.0 };
        let relative = size_of(&off) / scale;
        if relative > 1e-5 {
            println!("velocity {of_velocity}, coordinate {k}: {relative:e} of {scale:e}");
        }
        worst = worst.max(relative);
    }
    worst
}

pub fn rigid(mass: f64, inertia: [f64; 3]) -> ConservativeBody {
    let inertia = Matrix3::from_diagonal(&Vector3::from(inertia));
    let reduced = ReducedBody::rigid(mass, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    ConservativeBody::new(&reduced, &[], Vec::new(), &Physics::default()).unwrap()
}

/// A hub that turns at 40 rad/s about z, a bar that is welded to it and pulled, and a second bar on a flap hinge with a spring and a
/// damper, which a spring and a bushing tie as well.
fn rotor(speed: f64) -> (System, Vec<MotionState>) {
    let bar = bar();
    let (tip, _) = &bar.patches[1];
    let tip = tip.clone().with_second_order(bar.second_orders[1][0].clone());
    let pull = PointForce {
        frame: LoadFrame::Body,
        ..PointForce::dead(tip, Vector3::new(300.0, 0.0, 0.0), History::Constant)
    };
    let bodies =
        vec![rigid(1e-4, [0.2, 0.3, 0.4]), bar.damped(0.02, vec![Arc::new(pull)]), bar.damped(0.01, Vec::new())];
    let history = History::Table(Table::new(vec![0.0, 1.0], vec![0.0, 1.0]).unwrap());
    let still = Matrix3::identity();
    // The z axis of the flap hinge is along y.
    let flap = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    let spring = JointForce { stiffness: 2e3, damping: 0.5, ..JointForce::default() };
    let joints = vec![
        Joint::revolute(
            "shaft",
            [Marker::on_ground(Vector3::zeros(), still), Marker::on_rigid(0, Vector3::zeros(), still)],
        )
        .turned_by(JointDrive { amplitude: speed, history }),
        Joint::fixed("weld", [Marker::on_rigid(0, Vector3::new(50.0, 0.0, 0.0), still), bar.stiffening_marker(1, 0)]),
        Joint::revolute("flap", [bar.turned_stiffening_marker(1, 1, flap), bar.turned_stiffening_marker(2, 0, flap)])
            .with_force(Coordinate::Turn, spring),
    ];
    let strut = PointSpring {
        markers: [Marker::on_rigid(0, Vector3::new(0.0, 0.0, 80.0), still), bar.marker(2, 0)],
        stiffness: 3.0,
        damping: 0.01,
        free_length: 260.0,
    };
    let pad = Bushing {
        markers: [Marker::on_rigid(0, Vector3::new(50.0, 5.0, 0.0), still), bar.marker(2, 1)],
        stiffness: [Vector3::new(0.5, 0.7, 0.9), Vector3::new(300.0, 200.0, 100.0)],
        damping: [Vector3::new(1e-3, 2e-3, 3e-3), Vector3::new(0.1, 0.2, 0.3)],
    };
    let elements: Vec<Arc<dyn ForceElement>> = vec![Arc::new(strut), Arc::new(pad)];
    let system = System::new(bodies, joints).unwrap().with_elements(elements).unwrap();
    let hub = at_rest(Vector3::zeros());
    let at = |x: f64| bar.at_rest(Vector3::new(x, 0.0, 0.0), Attitude::identity());
    (system, vec![hub, at(150.0), at(350.0)])
}

/// The states of a steady motion moved by the real part of a mode times an amplitude.
pub fn changed_by(steady: &SteadyState, mode: &SystemMode, amplitude: c64) -> Vec<MotionState> {
    let states = steady.states();
    let place: Vec<f64> = mode.motion.iter().map(|x| (*x * amplitude).re).collect();
    let mut velocity = convected(&states, &place);
    velocity.iter_mut().zip(&mode.motion).for_each(|(v, x)| *v += (*x * amplitude * mode.eigenvalue).re);
    changed(&states, &place, &velocity)
}

/// Independent reference: central differences of the accelerations that the equations of the run give.
#[test]
fn the_linear_equations_are_those_of_differences_of_the_run() {
    for speed in [0.0, 40.0] {
        let (system, states) = rotor(speed);
        let mut motion = SystemMotion::new(system.clone(), &states).unwrap();
        motion.assemble().unwrap();
        let spin = CommonSpin { omega_global: Vector3::z() * speed, point_global: Vector3::zeros() };
        let steady = motion.steady_state(&spin).unwrap();
        let off = error(&system, &steady);
        println!(
            "at {speed} rad/s: off by {off:e}; {} coordinates, {} rigid",
            steady.linear.size(),
            steady.linear.rigid
        );
        assert!(off < 1e-5, "{off:e}");
    }
}
