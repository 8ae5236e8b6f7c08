//! A rotor on a support that does not turn.

use std::sync::Arc;

use dynamics::{
    Bushing, CommonSpin, Coordinate, ForceElement, History, Joint, JointDrive, JointForce, Marker, MotionState, Rotor,
    RotorError, SpinMode, System, SystemMotion, Table, TurningJoint,
};
use faer::c64;
use fem_tet10::Material;
use nalgebra::{Matrix3, Vector3};
use rigid_kin::Attitude;

use crate::flexible::Jointed;
use crate::linear::{changed_by, rigid};
use crate::mechanism::at_rest;
use crate::vibrations::blade;

/// Axes whose z is along x.
fn along_x() -> Matrix3<f64> {
    Matrix3::from_columns(&[Vector3::y(), Vector3::z(), Vector3::x()])
}

fn at(x: f64) -> MotionState {
    at_rest(Vector3::new(x, 0.0, 0.0))
}

fn driven(joint: Joint, speed: f64) -> Joint {
    let history = History::Table(Table::new(vec![0.0, 100.0], vec![0.0, 100.0]).unwrap());
    joint.turned_by(JointDrive { amplitude: speed, history })
}

/// A stand on a bushing, with a disk that spins about x, so far before its center.
fn stand(disk: [f64; 3], before: f64, pad: ([f64; 3], [f64; 3], f64), speed: f64) -> (System, SystemMotion) {
    let bodies = vec![rigid(3.0, [0.2, 0.3, 0.3]), rigid(2.0, disk)];
    let (stiffness, turning, damping) = pad;
    let pad = Bushing {
        markers: [
            Marker::on_ground(Vector3::zeros(), Matrix3::identity()),
            Marker::on_rigid(0, Vector3::zeros(), Matrix3::identity()),
        ],
        stiffness: [stiffness, turning].map(Vector3::from),
        damping: [stiffness, turning].map(|k| Vector3::from(k) * damping),
    };
    let place = Vector3::new(before, 0.0, 0.0);
    let joint = Joint::revolute(
        "shaft",
        [Marker::on_rigid(0, place, along_x()), Marker::on_rigid(1, Vector3::zeros(), along_x())],
    );
    let elements: Vec<Arc<dyn ForceElement>> = vec![Arc::new(pad)];
    let system = System::new(bodies, vec![driven(joint, speed)]).unwrap().with_elements(elements).unwrap();
    let motion = SystemMotion::new(system.clone(), &[at(0.0), at(before)]).unwrap();
    (system, motion)
}

fn frequencies(motion: &SystemMotion, rotor: &Rotor, speed: f64) -> Vec<SpinMode> {
    motion.rotor_modes(rotor, speed, &[]).unwrap()
}

/// Closed form: a disk at the center of its stand tilts as J φ̈ − i Ω J_p φ̇ + k φ = 0, so ω = √(a² + k/J) ± a, a = Ω J_p / 2J.
#[test]
fn a_disk_on_a_soft_stand_whirls_forwards_and_backwards() {
    let pad = ([4e4, 3e4, 3e4], [90.0, 50.0, 50.0], 0.0);
    let (_, motion) = stand([0.4, 0.25, 0.25], 0.0, pad, 0.0);
    let rotor = motion.rotor(0).unwrap();
    assert_eq!((rotor.body, rotor.axis_body), (1, Vector3::x()));
    // The pad holds the turn of the stand.
    assert_eq!(motion.spins_together(0), Ok(false));
    let (_, loose) = stand([0.4, 0.25, 0.25], 0.0, ([4e4, 3e4, 3e4], [0.0, 50.0, 50.0], 0.0), 0.0);
    assert_eq!(loose.spins_together(0), Ok(true));
    // A spring and a damper between bodies that spin hold no spin.
    let (system, states) = blade(21.0);
    let mut spinning = SystemMotion::new(system, &states).unwrap();
    spinning.assemble().unwrap();
    assert_eq!(spinning.spins_together(0), Ok(true));
    assert_eq!(spinning.spins_together(1), Ok(false));
    for speed in [0.0, 5.0, 40.0, 300.0] {
        let (half, still): (f64, f64) = (0.5 * speed * 0.4 / 0.55, 50.0 / 0.55);
        let root = (half * half + still).sqrt();
        let modes = frequencies(&motion, &rotor, speed);
        assert_eq!(modes.len(), 6);
        for (expected, whirl) in [(root - half, -1.0), (root + half, 1.0)] {
            let off = |mode: &SpinMode| (mode.circular_frequency / expected - 1.0).abs();
            let found = modes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            println!("{speed}: {} instead of {expected}, whirl {}", found.circular_frequency, found.whirl);
            assert!(off(found) < 1e-9);
            assert!(speed == 0.0 || (found.whirl - whirl).abs() < 1e-6);
        }
        let across = (3e4_f64 / 5.0).sqrt();
        assert_eq!(modes.iter().filter(|mode| (mode.circular_frequency / across - 1.0).abs() < 1e-9).count(), 2);
    }
}

/// A soft spring to the ground holds the turn, whatever stiff spring is between the bodies that it turns.
#[test]
fn a_soft_spring_to_the_ground_beside_a_stiff_one_between_bodies_holds_the_spin() {
    let stiff = 500.0;
    let of = |soft: f64| {
        let (system, _) = stand([0.4, 0.25, 0.25], 0.0, ([4e4, 3e4, 3e4], [soft, 50.0, 50.0], 0.0), 0.0);
        let axis = |body: usize| Marker::on_rigid(body, Vector3::zeros(), along_x());
        let spring = JointForce { stiffness: stiff, ..JointForce::default() };
        let shaft = Joint::revolute("shaft", [axis(0), axis(1)]).with_force(Coordinate::Turn, spring);
        let bodies = vec![rigid(3.0, [0.2, 0.3, 0.3]), rigid(2.0, [0.4, 0.25, 0.25])];
        let system = System::new(bodies, vec![shaft]).unwrap().with_elements(system.elements().to_vec()).unwrap();
        SystemMotion::new(system, &[at(0.0), at(0.0)]).unwrap()
    };
    assert_eq!(of(1e-7 * stiff).spins_together(0), Ok(false));
    assert_eq!(of(0.0).spins_together(0), Ok(true));
}

/// Conserved: a run that begins in a mode with a small amplitude, its disk spinning, goes on as exp(λt).
#[test]
fn a_run_of_a_spinning_disk_rings_down_as_its_mode_says() {
    let speed = 60.0;
    let pad = ([4e4, 3e4, 2e4], [90.0, 50.0, 70.0], 2e-4);
    let (system, mut motion) = stand([0.4, 0.25, 0.25], 0.3, pad, speed);
    motion.assemble().unwrap();
    let rotor = motion.rotor(0).unwrap();
    let steady = motion.rotor_state(&rotor, speed, &[]).unwrap();
    let modes = steady.linear.vibrations().unwrap().modes;
    for mode in &modes {
        let amplitude = 1e-5 / mode.motion.iter().map(|x| x.norm()).fold(0.0, f64::max);
        let time = 1.3 * std::f64::consts::TAU / mode.circular_frequency();
        let places = |phase: c64| {
            let of = |sign: f64| {
                let mut start = changed_by(&steady, mode, phase * (sign * amplitude));
                start[rotor.body].omega_body += rotor.axis_body * speed;
                let mut motion = SystemMotion::new(system.clone(), &start).unwrap();
                motion.assemble().unwrap();
                let place = |motion: &SystemMotion| {
                    let state = motion.state(0).unwrap();
                    let x: Vector3<f64> = state.origin_global;
                    let turned = state.attitude.to_global(&Vector3::new(1.0, 1.0, 1.0));
                    (x + turned).dot(&Vector3::new(0.3, 1.0, 0.7))
                };
                let first = place(&motion);
                motion.advance(time, 1e-11, &mut 1e-4).unwrap();
                [first, place(&motion)]
            };
            let [ahead, back] = [1.0, -1.0].map(of);
            [0, 1].map(|k: usize| 0.5 * (ahead[k] - back[k]))
        };
        let [real, imaginary] = [c64::new(1.0, 0.0), c64::new(0.0, -1.0)].map(places);
        let [first, last] = [0, 1].map(|k: usize| c64::new(real[k], imaginary[k]));
        let found = (last / first).ln();
        let expected = mode.eigenvalue * time;
        let turn = std::f64::consts::TAU;
        let off = [found.re - expected.re, (found.im - expected.im + 1e-2).rem_euclid(turn) - 1e-2];
        println!("{}: off by {off:?}", mode.eigenvalue);
        assert!(off.iter().all(|off| off.abs() < 1e-5 * expected.norm()), "{off:?}");
    }
    assert_eq!(modes.len(), 6);
}

/// Closed form: a disk on the end of a light shaft that is clamped (Stodola, Green): with the flexibility of a beam,
/// [L³/3EI + L/κGA, L²/2EI; L²/2EI, L/EI], (k₁₁ − m ω²)(k₂₂ + Ω J_p ω − J_t ω²) = k₁₂², ω > 0 forwards and < 0 backwards.
#[test]
fn a_disk_on_an_overhung_shaft_has_the_frequencies_of_stodola_and_green() {
    let light = Material { young_modulus: 70_000.0, poisson_ratio: 0.33, density: 2.7e-14 };
    let shaft = Jointed::new("half_bar", light, 2, &["left", "right"]);
    let (length, side, mass, [polar, across]) = (200.0_f64, 10.0_f64, 2e-4, [0.5, 0.27]);
    let bodies = vec![shaft.conservative(), rigid(mass, [polar, across, across])];
    let joints = vec![
        Joint::fixed(
            "clamp",
            [Marker::on_ground(Vector3::new(0.0, 0.5 * side, 0.5 * side), Matrix3::identity()), shaft.marker(0, 0)],
        ),
        Joint::revolute(
            "bearing",
            [shaft.turned_marker(0, 1, along_x()), Marker::on_rigid(1, Vector3::zeros(), along_x())],
        ),
    ];
    let system = System::new(bodies, joints).unwrap();
    let ends: Vec<Vector3<f64>> = shaft.patches.iter().map(|(point, _)| point.position_body()).collect();
    let origin = Vector3::new(0.0, 0.5 * side, 0.5 * side) - ends[0];
    let states =
        [shaft.at_rest(origin, Attitude::identity()), MotionState { origin_global: origin + ends[1], ..at(0.0) }];
    let mut motion = SystemMotion::new(system, &states).unwrap();
    motion.assemble().unwrap();
    let rotor = motion.rotor(1).unwrap();
    let (bending, shear) = (70_000.0 * side.powi(4) / 12.0, 70_000.0 / 2.66 * side * side * 13.3 / 15.63);
    let flexibility = nalgebra::Matrix2::new(
        length.powi(3) / (3.0 * bending) + length / shear,
        length.powi(2) / (2.0 * bending),
        length.powi(2) / (2.0 * bending),
        length / bending,
    );
    let k = flexibility.try_inverse().unwrap();
    for speed in [0.0, 200.0, 1000.0] {
        let balance = |omega: f64| {
            (k[(0, 0)] - mass * omega * omega) * (k[(1, 1)] + speed * polar * omega - across * omega * omega)
                - k[(0, 1)] * k[(0, 1)]
        };
        // Of the four roots those between steps of 0.5 rad/s.
        let mut roots = Vec::new();
        let mut omega: f64 = -6000.0;
        while omega < 6000.0 {
            let [mut low, mut high] = [omega, omega + 0.5];
            if (balance(low) > 0.0) != (balance(high) > 0.0) {
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if (balance(low) > 0.0) == (balance(middle) > 0.0) { low = middle } else { high = middle }
                }
                roots.push(low);
            }
            omega += 0.5;
        }
        assert_eq!(roots.len(), 4, "{roots:?}");
        let modes = frequencies(&motion, &rotor, speed);
        for root in roots {
            let off = |mode: &SpinMode| {
                let is_other = speed > 0.0 && mode.whirl * root < 0.0;
                if is_other { f64::INFINITY } else { (mode.circular_frequency / root.abs() - 1.0).abs() }
            };
            let found = modes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            println!("{speed}: {:.4} instead of {root:.4}, whirl {:.4}", found.circular_frequency, found.whirl);
            assert!(off(found) < 1e-3, "{}", off(found));
        }
    }
}

/// Bodies that do not spin alone are named.
#[test]
fn what_is_no_rotor_is_refused() {
    let pad = || ([4e4, 3e4, 3e4], [90.0, 50.0, 50.0], 0.0);
    let (_, motion) = stand([0.4, 0.25, 0.27], 0.0, pad(), 0.0);
    assert!(matches!(motion.rotor(0), Err(RotorError::Asymmetric { .. })), "{:?}", motion.rotor(0));
    let (system, _) = stand([0.4, 0.25, 0.25], 0.0, pad(), 0.0);
    let of = |joints: Vec<Joint>| {
        let bodies = vec![rigid(3.0, [0.2, 0.3, 0.3]), rigid(2.0, [0.4, 0.25, 0.25])];
        let system = System::new(bodies, joints).unwrap().with_elements(system.elements().to_vec()).unwrap();
        let mut motion = SystemMotion::new(system, &[at(0.0), at(0.0)]).unwrap();
        motion.assemble().unwrap();
        motion
    };
    let revolute = |place: Vector3<f64>| {
        Joint::revolute("shaft", [Marker::on_rigid(0, place, along_x()), Marker::on_rigid(1, place, along_x())])
    };
    let beside = of(vec![revolute(Vector3::new(0.0, 0.01, 0.0))]);
    assert!(matches!(beside.rotor(0), Err(RotorError::Unbalanced { .. })), "{:?}", beside.rotor(0));
    let spring = JointForce { stiffness: 3.0, ..JointForce::default() };
    let sprung = of(vec![revolute(Vector3::zeros()).with_force(Coordinate::Turn, spring)]);
    assert_eq!(sprung.rotor(0), Err(RotorError::Sprung));
    let place = Vector3::new(0.0, 0.2, 0.0);
    let held = of(vec![
        revolute(Vector3::zeros()),
        Joint::spherical(
            "strut",
            [Marker::on_ground(place, Matrix3::identity()), Marker::on_rigid(1, place, Matrix3::identity())],
        ),
    ]);
    assert_eq!(held.rotor(0), Err(RotorError::Held { by: "strut".to_owned() }));
    // Two bearings, and a damper along the turn, let it spin.
    let damper = JointForce { damping: 3.0, ..JointForce::default() };
    let two = of(vec![
        revolute(Vector3::zeros()).with_force(Coordinate::Turn, damper),
        revolute(Vector3::new(0.1, 0.0, 0.0)),
    ]);
    assert!(two.rotor(0).is_ok(), "{:?}", two.rotor(0));
    assert!(two.steady_state(&CommonSpin::REST).is_ok());
}

/// Closed form: a free hub that spins at Ω with a wheel that spins at s against it, about one axis of symmetry of both: as the hub sees it, its axis
/// circles with (J Ω + j s)/A − Ω, of both J about and A across the axis, j of the wheel.
#[test]
fn a_wheel_against_a_spinning_hub_has_its_part_in_the_nutation() {
    let bodies = || vec![rigid(3.0, [0.5, 0.3, 0.3]), rigid(2.0, [0.2, 0.15, 0.15])];
    let axis = |body: usize| Marker::on_rigid(body, Vector3::zeros(), along_x());
    for (hub, wheel) in [(0.0, 50.0), (7.0, 50.0), (7.0, -20.0)] {
        let system = System::new(bodies(), vec![Joint::revolute("bearing", [axis(0), axis(1)])]).unwrap();
        let spins = [hub, hub + wheel].map(|spin| MotionState { omega_body: Vector3::x() * spin, ..at(0.0) });
        let mut motion = SystemMotion::new(system, &spins).unwrap();
        motion.assemble().unwrap();
        let turning = motion.turning_joints();
        let [TurningJoint { joint: 0, rate, rotor: Ok((rotor, speed)) }] = &turning[..] else { panic!("{turning:?}") };
        assert!((rate - wheel).abs() < 1e-12 && (speed - wheel).abs() < 1e-12 && rotor.body == 1);
        let spin = CommonSpin { omega_global: Vector3::x() * hub, point_global: Vector3::zeros() };
        let steady = motion.steady_state_with_rotors(&spin, [(rotor, *speed)]).unwrap();
        let modes = steady.linear.vibrations().unwrap().modes;
        let expected = ((0.7 * hub + 0.2 * wheel) / 0.45 - hub).abs();
        let off = |found: f64| (found / expected - 1.0).abs();
        let found: Vec<f64> = modes.iter().map(|mode| mode.circular_frequency()).collect();
        assert!(found.iter().any(|found| off(*found) < 1e-9), "{found:?} {expected}");
    }
}

/// Closed form: a disk at the center of its stand, as above; that it spins, and how fast, is a matter of its motion.
#[test]
fn a_disk_that_spins_in_the_motion_is_found_and_a_crank_is_not() {
    let pad = ([4e4, 3e4, 3e4], [90.0, 50.0, 50.0], 0.0);
    for (disk, is_round) in [([0.4, 0.25, 0.25], true), ([0.4, 0.25, 0.3], false)] {
        let (system, _) = stand(disk, 0.0, pad, 40.0);
        let spins = [0.0, 40.0].map(|spin| MotionState { omega_body: Vector3::x() * spin, ..at(0.0) });
        let mut motion = SystemMotion::new(system, &spins).unwrap();
        motion.assemble().unwrap();
        let turning = motion.turning_joints();
        assert_eq!((turning.len(), turning[0].rotor.is_ok()), (1, is_round), "{turning:?}");
        let Ok((rotor, speed)) = &turning[0].rotor else { continue };
        let half = 0.5 * 40.0 * 0.4 / 0.55;
        let expected = (half * half + 50.0_f64 / 0.55).sqrt() - half;
        let modes = motion.rotor_modes(rotor, *speed, &[]).unwrap();
        assert!(modes.iter().any(|mode| (mode.circular_frequency / expected - 1.0).abs() < 1e-9));
    }
}
