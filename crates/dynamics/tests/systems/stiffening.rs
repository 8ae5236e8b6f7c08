//! Joints whose forces stiffen their bodies.

use std::sync::{Arc, OnceLock};

use dynamics::{
    CommonSpin, Expression, History, Joint, JointDrive, Marker, MotionState, Observation, PointForce, PointSpring,
    System, SystemMode, SystemMotion,
};
use fem_tet10::Material;
use nalgebra::{Matrix3, Vector3};
use rigid_kin::Attitude;

use crate::flexible::Jointed;

/// N/mm², t/mm³.
const YOUNG: f64 = 70_000.0;
const LENGTH: f64 = 200.0;

/// A bar of 200 × 10 × 10 mm, with its ends for patches.
fn bar() -> &'static Jointed {
    static BAR: OnceLock<Jointed> = OnceLock::new();
    let aluminium = Material { young_modulus: YOUNG, poisson_ratio: 0.0, density: 2.7e-9 };
    BAR.get_or_init(|| Jointed::new("half_bar", aluminium, 4, &["left", "right"]))
}

/// Deflection across of the end of a bar that is held by a joint at the other end and pulled at this one.
fn deflection(pull: f64, across: f64, joint_stiffens: bool) -> f64 {
    let bar = bar();
    let (point, _) = &bar.patches[1];
    let point = point.clone().with_second_order(bar.second_orders[1][0].clone());
    let load = PointForce::dead(point.clone(), Vector3::new(pull, across, 0.0), History::Constant);
    let body = bar.damped(1.0, vec![Arc::new(load)]);
    let start = bar.at_rest(Vector3::new(0.5 * LENGTH, 0.0, 0.0), Attitude::identity());
    let marker = if joint_stiffens { bar.stiffening_marker(0, 0) } else { bar.marker(0, 0) };
    let weld = Joint::fixed("weld", [Marker::on_ground(Vector3::zeros(), Matrix3::identity()), marker]);
    let mut motion = SystemMotion::new(System::new(vec![body], vec![weld]).unwrap(), &[start]).unwrap();
    motion.assemble().unwrap();
    motion.advance(0.2, 1e-6, &mut 1e-4).unwrap();
    motion.find_reactions().unwrap();
    let mut out = Observation::new(bar.body.circular_frequencies.len(), 1);
    motion.observe(0, &[point], &mut out).unwrap();
    out.points[0].displacement.y
}

/// Closed form: a cantilever that is pulled with P bends by Q (L − tanh(kL)/k)/P under Q across its end, k² = P/EI. The
/// joint's force has its part in that.
#[test]
fn a_pulled_bar_on_a_joint_bends_less() {
    let bending = YOUNG * 1e4 / 12.0;
    let across = 1.0;
    let [free, pulled, by_load_alone] = [(0.0, true), (4.0, true), (4.0, false)]
        .map(|(square, joint_stiffens)| deflection(square * bending / (LENGTH * LENGTH), across, joint_stiffens));
    // With what the weld of a mean patch gives way, and shear.
    let slender = across * LENGTH.powi(3) / (3.0 * bending);
    println!("bends by {free}, {pulled}, {by_load_alone}; a beam by {slender}");
    assert!((free / slender - 1.0).abs() < 0.03, "{free} {slender}");
    let expected = 3.0 * (1.0 - 2.0_f64.tanh() / 2.0) / 4.0;
    assert!((pulled / free / expected - 1.0).abs() < 0.02, "{} {expected}", pulled / free);
    assert!(by_load_alone / free > 1.05 * expected, "{} {expected}", by_load_alone / free);
}

/// Conserved: energy and momenta of a free pair of bars that spins fast, welded by a joint that stiffens them.
#[test]
fn joints_that_stiffen_keep_energy_and_momenta() {
    let bar = bar();
    let weld = Joint::fixed("weld", [bar.stiffening_marker(0, 1), bar.stiffening_marker(1, 0)]);
    let system = System::new(vec![bar.conservative(), bar.conservative()], vec![weld]).unwrap();
    let omega = Vector3::new(0.0, 3.0, 200.0);
    let start = |x: f64| {
        let mut state = MotionState {
            velocity_global: omega.cross(&Vector3::new(x, 0.0, 0.0)),
            omega_body: omega,
            ..bar.at_rest(Vector3::new(x, 0.0, 0.0), Attitude::identity())
        };
        state.modal_displacement[0] = 1e-6;
        state
    };
    let mut motion = SystemMotion::new(system, &[start(-100.0), start(100.0)]).unwrap();
    motion.relax().unwrap();
    let mut drifts = Vec::new();
    for tolerance in [1e-4, 1e-6] {
        let mut motion = motion.clone();
        let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
        let steps = motion.advance(0.02, tolerance, &mut 1e-5).unwrap();
        let drift = (motion.energy().unwrap() / energy - 1.0).abs();
        let [of_momentum, of_spin] =
            [0, 1].map(|k: usize| (motion.momenta()[k] - momenta[k]).norm() / momenta[1].norm());
        println!("{tolerance:e}: {steps} steps, energy {drift:e}, momenta {of_momentum:e} {of_spin:e}");
        // Rounding of each step.
        assert!(of_spin < 1e-14 * (steps as f64).sqrt(), "{of_spin:e}");
        drifts.push(drift);
    }
    assert!(drifts[1] < 1e-7, "{drifts:?}");
}

/// First circular frequency of a cantilever of stiffness EI, mass per length and length, under a tension along it that is linear from the
/// root to the free end: EI w⁗ − (T w′)′ = m ω² w, by shooting.
fn of_pulled_cantilever([bending, mass, length]: [f64; 3], [root, end]: [f64; 2]) -> f64 {
    let slope = (end - root) / length;
    let determinant = |omega: f64| {
        let solution = |start: [f64; 4]| {
            let rates = |x: f64, w: [f64; 4]| {
                let fourth = ((root + slope * x) * w[2] + slope * w[1] + mass * omega * omega * w[0]) / bending;
                [w[1], w[2], w[3], fourth]
            };
            let steps = 400;
            let h = length / f64::from(steps);
            let mut w = start;
            for step in 0..steps {
                let x = h * f64::from(step);
                let plus = |k: [f64; 4], part: f64| std::array::from_fn(|i| w[i] + part * h * k[i]);
                let first = rates(x, w);
                let second = rates(x + 0.5 * h, plus(first, 0.5));
                let third = rates(x + 0.5 * h, plus(second, 0.5));
                let fourth = rates(x + h, plus(third, 1.0));
                w = std::array::from_fn(|i| w[i] + h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]));
            }
            [w[2], bending * w[3] - end * w[1]]
        };
        let [a, b] = [solution([0.0, 0.0, 1.0, 0.0]), solution([0.0, 0.0, 0.0, 1.0])];
        a[0] * b[1] - a[1] * b[0]
    };
    let beam = (bending / mass).sqrt() / (length * length);
    let (mut low, mut step) = (0.5 * beam, 0.1 * beam);
    let sign = determinant(low).signum();
    while step > 1e-10 * beam {
        if determinant(low + step).signum() == sign {
            low += step;
        } else {
            step *= 0.5;
        }
    }
    low
}

/// Closed form: frequencies of a beam under tension. A bar on a weld is pulled at its end by a long soft spring: only forces of joints and
/// elements stiffen it.
#[test]
fn forces_of_a_joint_and_a_spring_raise_a_frequency_as_the_tension_of_a_beam() {
    let bar = bar();
    let (bending, mass) = (YOUNG * 1e4 / 12.0, 2.7e-9 * 100.0);
    let pull = 4.0 * bending / (LENGTH * LENGTH);
    let far = 1e9;
    let spring = PointSpring {
        markers: [bar.stiffening_marker(0, 1), Marker::on_ground(Vector3::x() * (far + LENGTH), Matrix3::identity())],
        stiffness: pull / far,
        damping: 0.0,
        free_length: 0.0,
    };
    let weld =
        Joint::fixed("weld", [Marker::on_ground(Vector3::zeros(), Matrix3::identity()), bar.stiffening_marker(0, 0)]);
    let system = System::new(vec![bar.conservative()], vec![weld]).unwrap();
    let system = system.with_elements(vec![Arc::new(spring)]).unwrap();
    let start = bar.at_rest(Vector3::new(0.5 * LENGTH, 0.0, 0.0), Attitude::identity());
    let mut motion = SystemMotion::new(system, &[start]).unwrap();
    motion.assemble().unwrap();
    let [found] = &motion.stiffening().unwrap()[..] else { panic!() };
    let beam = |tension: f64| of_pulled_cantilever([bending, mass, LENGTH], [tension; 2]);
    let expected = beam(pull) / beam(0.0);
    // Free bending of a clamped beam, 1.8751² √(EI/m)/l².
    assert!((beam(0.0) * LENGTH * LENGTH / (bending / mass).sqrt() / 3.516_015_3 - 1.0).abs() < 1e-6);
    assert!((found.force / pull - 1.0).abs() < 1e-6, "{} {pull}", found.force);
    // Two planes.
    for mode in &found.modes[..2] {
        let ratio = mode.moving / mode.unloaded;
        println!("{mode:?} {ratio} {expected}");
        assert!((ratio / expected - 1.0).abs() < 0.02, "{ratio} {expected}");
        assert!((mode.unloaded / beam(0.0) - 1.0).abs() < 0.03);
        assert!(mode.unloaded < mode.without_stress && mode.without_stress < mode.moving);
    }
}

/// Closed form: a cantilever whose root is pulled along it with the acceleration a bears m a (L − x), as one that hangs from its root.
#[test]
fn a_bar_that_is_pulled_faster_and_faster_stiffens_as_one_that_hangs() {
    let bar = bar();
    let (bending, mass) = (YOUNG * 1e4 / 12.0, 2.7e-9 * 100.0);
    let pull = 8.0 * bending / (LENGTH * LENGTH);
    let acceleration = pull / (mass * LENGTH);
    // The z axis of a slide is along x.
    let slide = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    let history = History::Expression(Expression::new("-0.5*t*t", Vec::new()).unwrap());
    let ends = [Marker::on_ground(Vector3::zeros(), slide), bar.turned_stiffening_marker(0, 0, slide)];
    let rail = Joint::prismatic("rail", ends).moved_by(JointDrive { amplitude: acceleration, history });
    let system = System::new(vec![bar.conservative()], vec![rail]).unwrap();
    let start = bar.at_rest(Vector3::new(0.5 * LENGTH, 0.0, 0.0), Attitude::identity());
    let mut motion = SystemMotion::new(system, &[start]).unwrap();
    motion.assemble().unwrap();
    let [found] = &motion.stiffening().unwrap()[..] else { panic!() };
    let beam = |tension: f64| of_pulled_cantilever([bending, mass, LENGTH], [tension, 0.0]);
    let expected = beam(pull) / beam(0.0);
    println!("{found:?} {expected}");
    assert!((found.force / pull - 1.0).abs() < 0.01, "{} {pull}", found.force);
    for mode in &found.modes[..2] {
        let ratio = mode.moving / mode.unloaded;
        assert!((ratio / expected - 1.0).abs() < 0.02, "{ratio} {expected}");
    }
}

/// Conserved: a pair that spins as one has in its motion the vibrations of the common spin.
#[test]
fn a_common_spin_is_a_motion_like_others() {
    let bar = bar();
    let weld = Joint::fixed("weld", [bar.stiffening_marker(0, 1), bar.stiffening_marker(1, 0)]);
    let system = System::new(vec![bar.conservative(), bar.conservative()], vec![weld]).unwrap();
    let omega = Vector3::new(0.0, 0.0, 200.0);
    let start = |x: f64| MotionState {
        velocity_global: omega.cross(&Vector3::new(x, 0.0, 0.0)),
        omega_body: omega,
        ..bar.at_rest(Vector3::new(x, 0.0, 0.0), Attitude::identity())
    };
    let mut motion = SystemMotion::new(system, &[start(-100.0), start(100.0)]).unwrap();
    motion.assemble().unwrap();
    let spin = CommonSpin { omega_global: omega, point_global: Vector3::zeros() };
    let [expected, found] = [motion.steady_state(&spin), motion.moving_state()].map(Result::unwrap);
    assert_eq!(expected.spin(), Some(&spin));
    assert_eq!(found.spin(), None);
    let [of_spin, of_motion] = [&expected, &found].map(|state| state.linear.vibrations().unwrap().modes);
    let frequencies = |modes: &[SystemMode]| -> Vec<f64> {
        modes.iter().map(SystemMode::circular_frequency).filter(|omega| *omega > 1.0).collect()
    };
    let [of_spin, of_motion] = [of_spin, of_motion].map(|modes| frequencies(&modes));
    assert_eq!(of_spin.len(), of_motion.len());
    for (a, b) in of_spin.iter().zip(&of_motion) {
        assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    }
}
