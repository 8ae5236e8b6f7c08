//! Vibrations of systems, against closed forms, the whole body and runs.

use std::sync::Arc;

use dynamics::{
    Bushing, CommonSpin, ConservativeBody, Coordinate, ForceElement, Joint, JointForce, LoadFn, Marker, MotionState,
    Physics, PointShapes, SharedLoad, System, SystemMode, SystemMotion,
};
use fem_tet10::Material;
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::Attitude;

use crate::flexible::Jointed;
use crate::linear::{changed_by, rigid};
use crate::mechanism::{Link, Mechanism, at_rest};
use crate::rigid::weight;

const GRAVITY: f64 = 9.81;

fn modes(motion: &SystemMotion, spin: &CommonSpin) -> (usize, Vec<SystemMode>) {
    let found = motion.steady_state(spin).unwrap().linear.vibrations().unwrap();
    (found.rigid.ncols(), found.modes)
}

/// A rod of a metre and a kilogram that hangs, its upper end at a place.
fn rod(x: f64, top: f64, mass: f64) -> Link {
    Link {
        mass,
        inertia: Vector3::new(mass / 12.0, 1e-3, mass / 12.0),
        center: [x, top - 0.5],
        angle: 0.0,
        loads: vec![weight(mass)],
    }
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "{found} {expected}");
}

/// Closed form: two equal rods of length l, ω² of [[4/3, 1/2], [1/2, 1/3]] against (g/l) diag(3/2, 1/2): 3 (1 ∓ 2/√7) g/l.
#[test]
fn a_double_pendulum_has_its_two_frequencies() {
    let mut mechanism = Mechanism::default();
    let [upper, lower] = [0.0, -1.0].map(|top| mechanism.link(rod(0.0, top, 1.0)));
    mechanism.hinge([None, Some(upper)], [0.0; 2]);
    mechanism.hinge([Some(upper), Some(lower)], [0.0, -1.0]);
    let (rigid, found) = modes(&mechanism.rests(), &CommonSpin::REST);
    assert_eq!((rigid, found.len()), (0, 2));
    for (mode, sign) in found.iter().zip([-1.0, 1.0]) {
        near(mode.circular_frequency().powi(2), 3.0 * (1.0 + sign * 2.0 / 7f64.sqrt()) * GRAVITY, 1e-12);
        assert_eq!(mode.growth(), 0.0);
        // Half of it is not elastic: gravity holds it, by the forces of the hinges.
        assert!(mode.elastic.iter().all(|part| *part == 0.0));
        near(mode.kinetic.iter().sum(), 1.0, 1e-12);
    }
}

/// Closed form: a rod that hangs swings with ω² = 3/2 g/l; a fast part on it that its damper keeps from swinging comes after that.
#[test]
fn a_fast_part_that_does_not_swing_comes_after_the_slow_vibrations() {
    let mut mechanism = Mechanism::default();
    let long = mechanism.link(rod(0.0, 0.0, 1.0));
    let part = mechanism.link(Link {
        mass: 1e-6,
        inertia: Vector3::new(1e-9, 1e-9, 1e-9),
        center: [0.0, -0.5],
        angle: 0.0,
        loads: Vec::new(),
    });
    mechanism.hinge([None, Some(long)], [0.0; 2]);
    mechanism.hinge([Some(long), Some(part)], [0.0, -0.5]);
    // 1e4 rad/s, damped three times as much as it needs not to swing.
    let (omega, inertia) = (1e4_f64, 1e-9);
    let (stiffness, damping) = (inertia * omega.powi(2), 6.0 * inertia * omega);
    mechanism.with_force(JointForce { stiffness, damping, ..JointForce::default() });
    let (_, found) = modes(&mechanism.rests(), &CommonSpin::REST);
    assert_eq!(found.len(), 3);
    near(found[0].circular_frequency(), (1.5 * GRAVITY).sqrt(), 1e-5);
    for (mode, root) in found[1..].iter().zip([3.0 - 8f64.sqrt(), 3.0 + 8f64.sqrt()]) {
        assert_eq!(mode.circular_frequency(), 0.0);
        near(mode.growth(), -root * omega, 1e-5);
    }
}

/// Closed form: a turntable that only a damper resists, with a small part on a spring: in a turn of the ground about its axis the table's
/// motion, which has no frequency, carries all but what swings: nothing of the inertia moves with the ground.
#[test]
fn what_only_a_damper_resists_carries_mass_apart_from_the_vibrations() {
    let mut mechanism = Mechanism::default();
    let link = |inertia: f64, x: f64| Link {
        mass: 1.0,
        inertia: Vector3::new(0.3, 0.2, inertia),
        center: [x, 0.0],
        angle: 0.0,
        loads: Vec::new(),
    };
    let [table, part] = [(0.5, 0.0), (0.2, 0.0)].map(|(inertia, x)| mechanism.link(link(inertia, x)));
    mechanism.hinge([None, Some(table)], [0.0; 2]);
    mechanism.with_force(JointForce { damping: 0.1, ..JointForce::default() });
    mechanism.hinge([Some(table), Some(part)], [0.0; 2]);
    mechanism.with_force(JointForce { stiffness: 1e8, ..JointForce::default() });
    let motion = mechanism.rests();
    let steady = motion.steady_state(&CommonSpin::REST).unwrap();
    let found = steady.participation(&motion, None).unwrap().unwrap();
    assert_eq!(found.circular_frequencies.len(), 1, "{found:?}");
    near(found.circular_frequencies[0].powi(2), 1e8 * (1.0 / 0.5 + 1.0 / 0.2), 1e-12);
    let participation = &found.participation;
    near(participation.rigid[5], 0.7, 1e-12);
    assert!(participation.factors[0][5].powi(2) < 1e-20 && participation.missed()[5] < 1e-12, "{participation:?}");
}

/// Closed form: in a push of the ground along x two hanging rods carry pᵀM⁻¹p of their 2m, p = (3/2, 1/2) m l and M as above; in a turn
/// of the ground about the hinge all of their inertia; along the rods nothing.
#[test]
fn a_double_pendulum_carries_its_part_of_the_mass() {
    let mut mechanism = Mechanism::default();
    let [upper, lower] = [0.0, -1.0].map(|top| mechanism.link(rod(0.3, top, 1.0)));
    mechanism.hinge([None, Some(upper)], [0.3, 0.0]);
    mechanism.hinge([Some(upper), Some(lower)], [0.3, -1.0]);
    let motion = mechanism.rests();
    let steady = motion.steady_state(&CommonSpin::REST).unwrap();
    let found = steady.participation(&motion, None).unwrap().unwrap();
    assert_eq!(found.participation.about, Vector3::new(0.3, 0.0, 0.0));
    for (omega, sign) in found.circular_frequencies.iter().zip([-1.0, 1.0]) {
        near(omega.powi(2), 3.0 * (1.0 + sign * 2.0 / 7f64.sqrt()) * GRAVITY, 1e-12);
    }
    let carried = |i: usize| found.participation.effective_masses().iter().map(|of| of[i]).sum::<f64>();
    // det M = 4/9 − 1/4 = 7/36 and pᵀ adj(M) p = 9/4·1/3 − 2·3/4·1/2 + 1/4·4/3 = 1/3.
    near(carried(0), 36.0 / 21.0, 1e-12);
    assert!(carried(1) < 1e-20 && found.participation.rigid == [0.0; 6]);
    near(found.participation.whole[0], 2.0, 1e-14);
    // About the hinge: 1/3 of the upper rod, 1/12 + (3/2)² of the lower one.
    near(found.participation.whole[5], 1.0 / 3.0 + 1.0 / 12.0 + 2.25, 1e-12);
    near(carried(5), found.participation.whole[5], 1e-12);
    near(1.0 - found.participation.missed()[0], 36.0 / 42.0, 1e-12);
}

/// Closed form: a system that the ground does not hold has no part in its motions; one on a ball that nothing resists moves apart from its
/// vibrations.
#[test]
fn motions_that_nothing_resists_carry_mass_apart_from_the_vibrations() {
    let mut free = Mechanism::default();
    let [first, second] = [0.0, -1.0].map(|top| free.link(rod(0.0, top, 1.0)));
    free.hinge([Some(first), Some(second)], [0.0, -1.0]);
    let motion = free.rests();
    let steady = motion.steady_state(&CommonSpin::REST).unwrap();
    assert_eq!(steady.participation(&motion, None).unwrap(), None);
    // Without weight a rod on a hinge has no vibration: 3/4 of its mass stay behind in a push along x.
    let mut held = Mechanism::default();
    let rod = held.link(Link { loads: Vec::new(), ..rod(0.0, 0.0, 1.0) });
    held.hinge([None, Some(rod)], [0.0; 2]);
    let motion = held.rests();
    let steady = motion.steady_state(&CommonSpin::REST).unwrap();
    let found = steady.participation(&motion, Some(Vector3::new(0.0, -1.0, 0.0))).unwrap().unwrap();
    assert!(found.circular_frequencies.is_empty() && found.participation.factors.is_empty());
    near(found.participation.rigid[0], 0.75, 1e-12);
    // About its end: the turn of the ground moves the hinge along by −1 as well; (1/3 − 1/2)²/(1/3) of 1/3.
    near(found.participation.whole[5], 1.0 / 3.0, 1e-12);
    near(found.participation.rigid[5], (1.0_f64 / 6.0).powi(2) * 3.0, 1e-12);
}

/// Closed form: two cranks of mass m and length l with a coupler of mass M, which goes without turning:
/// ω² = (m + M)/(2m/3 + M) g/l.
#[test]
fn a_four_bar_swings_as_its_coupler() {
    let (crank, coupler) = (0.7, 1.9);
    let mut mechanism = Mechanism::default();
    let [left, right] = [0.0, 2.0].map(|x| mechanism.link(rod(x, 0.0, crank)));
    let bar = mechanism.link(Link { center: [1.0, -1.0], ..rod(0.0, 0.0, coupler) });
    for (link, x) in [(left, 0.0), (right, 2.0)] {
        mechanism.hinge([None, Some(link)], [x, 0.0]);
        mechanism.hinge([Some(link), Some(bar)], [x, -1.0]);
    }
    let motion = mechanism.rests();
    let steady = motion.steady_state(&CommonSpin::REST).unwrap();
    assert_eq!(steady.implied_rows(), 3);
    let (rigid, found) = modes(&motion, &CommonSpin::REST);
    assert_eq!((rigid, found.len()), (0, 1));
    near(found[0].circular_frequency().powi(2), (crank + coupler) / (2.0 * crank / 3.0 + coupler) * GRAVITY, 1e-12);
}

/// Closed form: a free hub and a panel on a hinge with a spring k and a damper c: −½c/J ± i√(k/J − (½c/J)²) with 1/J of both
/// about the hinge's axis, the hub's and the panel's centres on it.
#[test]
fn a_free_hub_with_a_sprung_panel_has_six_rigid_motions_and_one_vibration() {
    let (stiffness, damping) = (3.0, 0.02);
    let mut mechanism = Mechanism::default();
    let link = |inertia: f64| Link {
        mass: 1.0,
        inertia: Vector3::new(0.3, 0.2, inertia),
        center: [0.0; 2],
        angle: 0.0,
        loads: Vec::new(),
    };
    let [hub, panel] = [0.5, 0.2].map(|inertia| mechanism.link(link(inertia)));
    mechanism.hinge([Some(hub), Some(panel)], [0.0; 2]);
    mechanism.with_force(JointForce { stiffness, damping, ..JointForce::default() });
    let (rigid, found) = modes(&mechanism.rests(), &CommonSpin::REST);
    assert_eq!((rigid, found.len()), (6, 1));
    let inverse = 1.0 / 0.5 + 1.0 / 0.2;
    near(found[0].growth(), -0.5 * damping * inverse, 1e-11);
    near(found[0].eigenvalue.norm().powi(2), stiffness * inverse, 1e-11);
    near(found[0].damping_ratio(), 0.5 * damping * (inverse / stiffness).sqrt(), 1e-11);
    // The hub and the panel move against each other as their inertias.
    near(found[0].kinetic[0], 0.2 / 0.7, 1e-10);
    near(found[0].elastic[2], 1.0, 1e-12);
}

/// Closed form: a blade on a flap hinge at a part e of its radius swings with √(1 + 3e/(2(1 − e))) times the spin, and on a
/// lag hinge with √(3e/(2(1 − e))).
#[test]
fn a_blade_flaps_and_lags_as_its_spin_holds_it() {
    let (speed, offset) = (31.0, 0.08);
    let length = 1.0 - offset;
    // The blade is along x; the hinge axes are along y (flap) and z (lag).
    let along_y = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    for (axes, constant) in [(along_y, 1.0), (Matrix3::identity(), 0.0)] {
        let blade = rigid(2.0, [1e-9, 2.0 * length * length / 12.0, 2.0 * length * length / 12.0]);
        let hub = rigid(1.0, [0.1, 0.1, 0.2]);
        let hinge = Joint::revolute(
            "hinge",
            [Marker::on_rigid(0, Vector3::x() * offset, axes), Marker::on_rigid(1, -Vector3::x() * 0.5 * length, axes)],
        );
        let still = Matrix3::identity();
        let shaft = [Marker::on_ground(Vector3::zeros(), still), Marker::on_rigid(0, Vector3::zeros(), still)];
        let drive = dynamics::JointDrive { amplitude: 0.0, history: dynamics::History::Constant };
        let shaft = Joint::revolute("shaft", shaft).turned_by(drive);
        let system = System::new(vec![hub, blade], vec![shaft, hinge]).unwrap();
        let at = |x: f64| at_rest(Vector3::x() * x);
        let motion = SystemMotion::new(system, &[at(0.0), at(offset + 0.5 * length)]).unwrap();
        let spin = CommonSpin { omega_global: Vector3::z() * speed, point_global: Vector3::zeros() };
        let (rigid, found) = modes(&motion, &spin);
        assert_eq!((rigid, found.len()), (0, 1));
        let expected = speed * f64::sqrt(constant + 1.5 * offset / (1.0 - offset));
        near(found[0].circular_frequency(), expected, 1e-9);
    }
}

/// Independent reference: the whole bar without joints. Two halves with six natural modes and six static shapes, joined by the
/// mean of their faces: −0.15 to 0 % in the table given with the project.
#[test]
fn two_welded_halves_have_the_frequencies_of_the_whole() {
    let aluminium = Material { young_modulus: 70_000.0, poisson_ratio: 0.33, density: 2.7e-9 };
    let whole = Jointed::new("slender_bar", aluminium, 8, &[]);
    let [left, right] = ["right", "left"].map(|patch| Jointed::new("half_bar", aluminium, 6, &[patch]));
    let weld = Joint::fixed("weld", [left.marker(0, 0), right.marker(1, 0)]);
    let system = System::new(vec![left.conservative(), right.conservative()], vec![weld]).unwrap();
    let start = |x: f64, body: &Jointed| body.at_rest(Vector3::new(x, 0.0, 0.0), Attitude::identity());
    let motion = SystemMotion::new(system, &[start(-100.0, &left), start(100.0, &right)]).unwrap();
    let (rigid, found) = modes(&motion, &CommonSpin::REST);
    assert_eq!(rigid, 6);
    for (mode, expected) in found.iter().zip(&whole.body.circular_frequencies) {
        let off = mode.circular_frequency() / expected - 1.0;
        println!("{:.2} rad/s: {:.3} %", expected, 100.0 * off);
        assert!((-2e-3..2e-4).contains(&off), "{off}");
    }
}

/// A hub that is turned about z, with a blade on a flap hinge with a spring and a damper.
pub fn blade(speed: f64) -> (System, Vec<MotionState>) {
    let (offset, length) = (0.08, 0.92);
    let along_y = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    let bodies = vec![
        rigid(1.0, [0.1, 0.1, 0.2]),
        rigid(2.0, [1e-3, 2.0 * length * length / 12.0, 2.0 * length * length / 12.0]),
    ];
    let history = dynamics::History::Table(dynamics::Table::new(vec![0.0, 10.0], vec![0.0, 10.0]).unwrap());
    let at = |x: f64| Vector3::new(x, 0.0, 0.0);
    let still = Matrix3::identity();
    let joints = vec![
        Joint::revolute("shaft", [Marker::on_ground(at(0.0), still), Marker::on_rigid(0, at(0.0), still)])
            .turned_by(dynamics::JointDrive { amplitude: speed, history }),
        Joint::revolute(
            "hinge",
            [Marker::on_rigid(0, at(offset), along_y), Marker::on_rigid(1, at(-0.5 * length), along_y)],
        )
        .with_force(dynamics::Coordinate::Turn, JointForce { stiffness: 120.0, damping: 1.5, ..JointForce::default() }),
    ];
    let state = |x: f64| at_rest(at(x));
    (System::new(bodies, joints).unwrap(), vec![state(0.0), state(offset + 0.5 * length)])
}

/// Conserved: a run that begins in a mode with a small amplitude goes on as exp(λt), damped and in spin.
#[test]
fn a_run_rings_down_as_its_mode_says() {
    for speed in [0.0, 21.0] {
        let (system, states) = blade(speed);
        let mut motion = SystemMotion::new(system.clone(), &states).unwrap();
        motion.assemble().unwrap();
        let spin = CommonSpin { omega_global: Vector3::z() * speed, point_global: Vector3::zeros() };
        let steady = motion.steady_state(&spin).unwrap();
        let mode = &steady.linear.vibrations().unwrap().modes[0];
        // Where the mode is real, and a quarter of a period later; the hinge's turn is linear in both.
        let amplitude = 1e-3 / mode.motion.iter().map(|x| x.norm()).fold(0.0, f64::max);
        let turns = |phase: faer::c64, time: f64| {
            let of = |sign: f64| {
                let start = changed_by(&steady, mode, phase * (sign * amplitude));
                let mut motion = SystemMotion::new(system.clone(), &start).unwrap();
                motion.assemble().unwrap();
                let first = motion.joint_coordinates(1).turn;
                motion.advance(time, 1e-11, &mut 1e-4).unwrap();
                [first, motion.joint_coordinates(1).turn]
            };
            // The part of odd order in the amplitude.
            let [ahead, back] = [1.0, -1.0].map(of);
            [0, 1].map(|k: usize| 0.5 * (ahead[k] - back[k]))
        };
        let time = 2.3 * std::f64::consts::TAU / mode.circular_frequency();
        let [real, imaginary] = [faer::c64::new(1.0, 0.0), faer::c64::new(0.0, -1.0)].map(|phase| turns(phase, time));
        let [first, last] = [0, 1].map(|k: usize| faer::c64::new(real[k], imaginary[k]));
        let found = (last / first).ln();
        let expected = mode.eigenvalue * time;
        // Whole turns apart.
        let off = [found.re - expected.re, (found.im - expected.im + 1e-3).rem_euclid(std::f64::consts::TAU) - 1e-3];
        println!("at {speed}: {}, off by {off:?} after {time}", mode.eigenvalue);
        assert!(off.iter().all(|off| off.abs() < 1e-6 * expected.norm()), "{off:?}");
    }
}

/// A force along y at the centre of mass, in global axes or in those of the body.
fn push(force: f64, turns_with_body: bool) -> SharedLoad {
    let body = ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity(), RigidMotion::free()).unwrap();
    let center = PointShapes::new(&body, &BodyPoint::rigid(Vector3::zeros()));
    Arc::new(LoadFn::new("push", move |motion, applied| {
        let along = Vector3::new(0.0, force, 0.0);
        applied.force(&center, &if turns_with_body { along } else { motion.body_from_global * along });
    }))
}

/// Closed form: a rod of 0.8 m that hangs behind a cart, which is pushed with 2 m/s²: 3/2 a/l = ω², and a rod that is let go at an angle α to the
/// vertical, whose variations obey δα̈ = −(3/2)(g/l) cos α δα.
#[test]
fn vibrations_are_about_the_accelerated_motion() {
    let mut mechanism = Mechanism::default();
    let link = |mass: f64, length: f64, center: [f64; 2], angle: f64, loads| Link {
        mass,
        inertia: Vector3::new(mass * length.powi(2) / 12.0, 1e-3, mass * length.powi(2) / 12.0),
        center,
        angle,
        loads,
    };
    let cart = mechanism.link(link(1000.0, 1.0, [0.0; 2], 0.0, vec![push(1150.0 * 2.0, false)]));
    let rod = mechanism.link(link(150.0, 0.8, [0.0, -0.4], 0.0, Vec::new()));
    let rail = |name: &str, markers| Joint::locked(name, markers, [true, false, true], [true; 3]);
    mechanism.joint(rail, [None, Some(cart)], [0.0; 2]);
    mechanism.hinge([Some(cart), Some(rod)], [0.0; 2]);
    let (rigid, found) = modes(&mechanism.rests(), &CommonSpin::REST);
    assert_eq!((rigid, found.len()), (1, 1));
    near(found[0].circular_frequency().powi(2), 1.5 * 2.0 / 0.8, 1e-12);

    let mut mechanism = Mechanism::default();
    let angle = 1.1_f64;
    let center = [0.5 * angle.sin(), -0.5 * angle.cos()];
    let rod = mechanism.link(link(1.0, 1.0, center, angle, vec![weight(1.0)]));
    mechanism.hinge([None, Some(rod)], [0.0; 2]);
    let (_, found) = modes(&mechanism.rests(), &CommonSpin::REST);
    near(found[0].circular_frequency().powi(2), 1.5 * GRAVITY * angle.cos(), 1e-10);
}

/// Closed form: a free body with a force along its y axis, through its centre of mass, drifts as it turns; all its eigenvalues are zero. The same
/// with a force that keeps its direction.
#[test]
fn a_rocket_has_motions_that_nothing_resists_alone() {
    for turns_with_body in [true, false] {
        let mut mechanism = Mechanism::default();
        let link =
            |loads| Link { mass: 3.0, inertia: Vector3::new(0.3, 0.2, 0.4), center: [0.0; 2], angle: 0.3, loads };
        let rocket = mechanism.link(link(vec![push(30.0, turns_with_body)]));
        let tank = mechanism.link(link(Vec::new()));
        mechanism.joint(Joint::fixed, [Some(rocket), Some(tank)], [0.0; 2]);
        let (rigid, found) = modes(&mechanism.rests(), &CommonSpin::REST);
        assert_eq!((rigid, found.len()), (6, 0), "{:?}", found.iter().map(|mode| mode.eigenvalue).collect::<Vec<_>>());
    }
}

/// Closed form: a damped pendulum of a metre with a small body on a bushing: the slow vibration and its decay keep their digits however stiff the bushing is. The fast ones
/// are √(k/m) of the small body against one that is heavy.
#[test]
fn a_slow_vibration_keeps_its_digits_beside_fast_ones() {
    const DAMPER: f64 = 2e-5;
    for stiffness in [1e3, 1e9, 1e13, 1e15] {
        let bodies = vec![
            ConservativeBody::new(
                &ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity() * 1e-3, RigidMotion::free()).unwrap(),
                &[],
                vec![weight(1.0)],
                &Physics::default(),
            )
            .unwrap(),
            rigid(1e-4, [1e-10; 3]),
        ];
        let turned = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
        let hinge = Joint::revolute(
            "hinge",
            [
                Marker::on_ground(Vector3::zeros(), Matrix3::identity()),
                Marker::on_rigid(0, Vector3::new(0.0, 1.0, 0.0), Matrix3::identity()),
            ],
        )
        .with_force(Coordinate::Turn, JointForce { damping: DAMPER, ..JointForce::default() });
        let bushing = Bushing {
            markers: [
                Marker::on_rigid(0, Vector3::new(0.1, 0.0, 0.0), turned),
                Marker::on_rigid(1, Vector3::zeros(), turned),
            ],
            stiffness: [Vector3::repeat(stiffness), Vector3::repeat(1e-6 * stiffness)],
            damping: [Vector3::zeros(); 2],
        };
        let elements: Vec<Arc<dyn ForceElement>> = vec![Arc::new(bushing)];
        let system = System::new(bodies, vec![hinge]).unwrap().with_elements(elements).unwrap();
        let motion =
            SystemMotion::new(system, &[at_rest(Vector3::new(0.0, -1.0, 0.0)), at_rest(Vector3::new(0.1, -1.0, 0.0))])
                .unwrap();
        let (rigid, found) = modes(&motion, &CommonSpin::REST);
        assert_eq!((rigid, found.len()), (0, 7), "{stiffness:e}");
        let off = found[0].circular_frequency().powi(2) / (GRAVITY / (1.001 + 1e-4 * 1.01 + 1e-10)) - 1.0;
        println!(
            "{stiffness:e}: slow off by {off:e}, fast {:e}",
            found[1].circular_frequency() / (stiffness / 1e-4).sqrt()
        );
        assert!(off.abs() < 1e-8, "{stiffness:e}: {off:e}");
        near(found[0].growth(), -0.5 * DAMPER / (1.001 + 1e-4 * 1.01 + 1e-10), 1e-6);
    }
}
