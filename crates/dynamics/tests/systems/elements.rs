//! Springs, dampers and bushings between bodies.

use std::sync::Arc;

use dynamics::{
    Bushing, ConservativeBody, ForceElement, Joint, LineObservation, Marker, MarkerForce, MarkerLaw, MotionState,
    Physics, PointSpring, RelativeMotion, System, SystemMotion, SystemScheme,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{ReducedBody, RigidMotion};
use rigid_kin::{Attitude, cross_matrix, rotation_vector, transformation_matrix};

fn bodies(count: usize) -> Vec<ConservativeBody> {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.2, 0.3, 0.4));
    let reduced = ReducedBody::rigid(2.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    vec![ConservativeBody::new(&reduced, &[], Vec::new(), &Physics::default()).unwrap(); count]
}

fn at(x: f64, omega: f64) -> MotionState {
    MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: Vector3::new(x, 0.0, 0.0),
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::new(0.0, 0.0, omega),
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    }
}

fn marker(body: Option<usize>, x: f64) -> Marker {
    match body {
        Some(body) => Marker::on_rigid(body, Vector3::new(x, 0.0, 0.0), Matrix3::identity()),
        None => Marker::on_ground(Vector3::new(x, 0.0, 0.0), Matrix3::identity()),
    }
}

fn system(
    count: usize,
    joints: Vec<Joint>,
    element: impl ForceElement + 'static,
    states: &[MotionState],
) -> SystemMotion {
    let system = System::new(bodies(count), joints).unwrap().with_elements(vec![Arc::new(element)]).unwrap();
    SystemMotion::new(system, states).unwrap()
}

/// Energy less all work, relative to the work of the elements.
fn imbalance(motion: &SystemMotion, energy: f64) -> f64 {
    ((motion.energy().unwrap() - energy - motion.element_work()) / motion.element_work().abs().max(energy)).abs()
}

/// Closed form: two masses on a spring swing with √(k/μ), here with damping δ = c/2μ.
#[test]
fn two_masses_on_a_damped_spring_swing_in_closed_form() {
    let (k, c) = (50.0, 1.5);
    let spring = PointSpring {
        markers: [marker(Some(0), 0.0), marker(Some(1), 0.0)],
        stiffness: k,
        damping: c,
        free_length: 1.0,
    };
    let mut motion = system(2, Vec::new(), spring, &[at(0.0, 0.0), at(1.2, 0.0)]);
    let momenta = motion.momenta();
    let end = 1.3;
    motion.advance(end, 1e-9, &mut 1e-3).unwrap();
    let delta = c / 2.0;
    let omega = f64::sqrt(k - delta * delta);
    let expected = 1.0 + 0.2 * (-delta * end).exp() * ((omega * end).cos() + delta / omega * (omega * end).sin());
    let [a, b] = [0, 1].map(|body| motion.state(body).unwrap().origin_global.x);
    assert!((b - a - expected).abs() < 1e-8, "{} {expected}", b - a);
    assert!(motion.momenta().iter().zip(momenta).all(|(now, start)| (now - start).norm() < 1e-14));
    assert!(imbalance(&motion, 0.0) < 1e-6);
}

/// Closed form: a body on a bushing to the ground turns with √(k/J) and slides with √(k/m).
#[test]
fn a_bushing_has_its_frequencies() {
    let bushing = Bushing {
        markers: [marker(None, 0.0), marker(Some(0), 0.0)],
        stiffness: [Vector3::new(80.0, 90.0, 100.0), Vector3::new(5.0, 6.0, 7.0)],
        damping: [Vector3::zeros(); 2],
    };
    let mut motion = system(1, Vec::new(), bushing, &[at(0.1, 0.05)]);
    let end = 0.9;
    motion.advance(end, 1e-9, &mut 1e-3).unwrap();
    let now = motion.state(0).unwrap();
    let omega = f64::sqrt(7.0 / 0.4);
    let expected = [0.1 * (f64::sqrt(40.0) * end).cos(), 0.05 * (omega * end).cos()];
    assert!((now.origin_global.x - expected[0]).abs() < 1e-8, "{now:?}");
    assert!((now.omega_body.z - expected[1]).abs() < 1e-8, "{now:?} {expected:?}");
}

/// Closed form: k (l − l₀) + c l̇ along the line, by the places and the velocities of the bodies; on the second of two, towards the first.
#[test]
fn a_spring_shows_its_length_and_its_force() {
    let (stiffness, damping, free_length) = (50.0, 1.5, 1.0);
    let markers = [marker(Some(0), 0.0), marker(Some(1), 0.0)];
    let spring = PointSpring { markers, stiffness, damping, free_length };
    let moving = MotionState { velocity_global: Vector3::new(0.3, 0.8, -0.5), ..at(1.2, 0.4) };
    let mut motion = system(2, Vec::new(), spring, &[at(0.0, 0.0), moving]);
    let mut pulls = Vec::new();
    for end in [0.0, 0.2, 0.7] {
        if end > 0.0 {
            motion.advance(end, 1e-9, &mut 1e-3).unwrap();
        }
        motion.find_reactions().unwrap();
        let seen = motion.observe_element(0);
        let [first, second] = [0, 1].map(|body| motion.state(body).unwrap());
        let line = second.origin_global - first.origin_global;
        let rate = line.normalize().dot(&(second.velocity_global - first.velocity_global));
        let pull = stiffness * (line.norm() - free_length) + damping * rate;
        assert!((seen.line.length - line.norm()).abs() < 1e-14 && (seen.line.rate - rate).abs() < 1e-13, "{seen:?}");
        assert!((seen.line.pull - pull).abs() < 1e-12, "{seen:?} {pull}");
        assert!((seen.reaction_global.force_global + line.normalize() * pull).norm() < 1e-12, "{seen:?}");
        assert!(seen.reaction_global.moment_global == Vector3::zeros() && seen.is_finite());
        let in_axes = first.attitude.to_body(&seen.reaction_global.force_global);
        assert!((seen.force_marker - in_axes).norm() < 1e-12, "{seen:?} {in_axes}");
        pulls.push(pull);
    }
    assert!(pulls[0] > 2.0 * pulls[1], "it moves: {pulls:?}");
}

/// Closed form: −K times the displacement, −c times its rate and −K times the angle about the first marker's axes, which stand on
/// their head; the damper is that along x.
#[test]
fn a_bushing_shows_its_force_and_moment_in_the_axes_of_its_first_marker() {
    let axes = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let bushing = Bushing {
        markers: [Marker::on_ground(Vector3::zeros(), axes), marker(Some(0), 0.0)],
        stiffness: [Vector3::new(80.0, 90.0, 100.0), Vector3::new(5.0, 6.0, 7.0)],
        damping: [Vector3::new(2.0, 0.0, 0.0), Vector3::zeros()],
    };
    let angle: f64 = 0.3;
    // The second marker has turned by the angle about z from the axes of the first.
    let turned = Matrix3::new(angle.cos(), -angle.sin(), 0.0, angle.sin(), angle.cos(), 0.0, 0.0, 0.0, 1.0);
    let state = MotionState {
        attitude: Attitude::from_global_to_body(&(axes * turned).transpose()).unwrap(),
        origin_global: Vector3::new(0.1, 0.2, 0.3),
        velocity_global: Vector3::new(0.5, 0.6, 0.7),
        ..at(0.0, 0.0)
    };
    let mut motion = system(1, Vec::new(), bushing, &[state]);
    motion.find_reactions().unwrap();
    let seen = motion.observe_element(0);
    // x of the marker is y, and its y is −x.
    let expected = Vector3::new(-80.0 * 0.2 - 2.0 * 0.6, 90.0 * 0.1, -100.0 * 0.3);
    assert!((seen.force_marker - expected).norm() < 1e-12, "{seen:?}");
    let expected_global = Vector3::new(-expected.y, expected.x, expected.z);
    assert!((seen.reaction_global.force_global - expected_global).norm() < 1e-12, "{seen:?}");
    assert!((seen.moment_marker - Vector3::new(0.0, 0.0, -7.0 * angle)).norm() < 1e-12, "{seen:?}");
    assert!((seen.reaction_global.moment_global - Vector3::new(0.0, 0.0, -7.0 * angle)).norm() < 1e-12, "{seen:?}");
    assert_eq!(seen.line, LineObservation::default());
}

/// Conserved: momenta of a pair with a bushing that is turned and stretched at once; energy by the work of the bushing.
#[test]
fn a_bushing_between_free_bodies_keeps_their_momenta() {
    let bushing = Bushing {
        markers: [marker(Some(0), 0.5), marker(Some(1), -0.5)],
        stiffness: [Vector3::new(80.0, 90.0, 100.0), Vector3::new(5.0, 6.0, 7.0)],
        damping: [Vector3::repeat(0.5), Vector3::repeat(0.1)],
    };
    let tumbling = MotionState {
        omega_body: Vector3::new(0.5, -0.4, 1.0),
        velocity_global: Vector3::new(0.1, 0.2, 0.3),
        ..at(1.3, 0.0)
    };
    let mut motion = system(2, Vec::new(), bushing, &[at(0.0, 0.7), tumbling]);
    let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
    motion.advance(2.0, 1e-7, &mut 1e-3).unwrap();
    let drift: Vec<f64> = motion.momenta().iter().zip(momenta).map(|(now, start)| (now - start).norm()).collect();
    assert!(drift.iter().all(|drift| *drift < 1e-13), "{drift:?}");
    assert!(motion.element_work().abs() > 0.1);
    assert!(imbalance(&motion, energy) < 2e-6, "{}", imbalance(&motion, energy));
}

/// Conserved: the energy of two bodies that whirl about each other on a stiff spring, and of a pair on a bushing, both without dampers, at rough
/// tolerances. What the steps lose is open in the balance: energy less all work is what the energy with the springs' closed form has changed
/// by. So it is of a law from outside, whose energy nobody tells.
#[test]
fn balances_see_what_steps_lose_in_springs() {
    let whirling = [
        MotionState { velocity_global: Vector3::new(0.0, -3.0, 0.0), ..at(0.0, 0.0) },
        MotionState { velocity_global: Vector3::new(0.0, 3.0, 0.0), ..at(1.2, 0.0) },
    ];
    let markers = [marker(Some(0), 0.0), marker(Some(1), 0.0)];
    let spring = PointSpring { markers: markers.clone(), stiffness: 4e3, damping: 0.0, free_length: 1.0 };
    let bushing = Bushing {
        markers,
        stiffness: [Vector3::new(4e3, 3e3, 2e3), Vector3::new(5.0, 6.0, 7.0)],
        damping: [Vector3::zeros(); 2],
    };
    for scheme in SystemScheme::ALL {
        for (is_bushing, tolerance) in [(false, 1e-2), (true, 1e-2), (false, 1e-4), (true, 1e-4)] {
            let motion = match is_bushing {
                false => system(2, Vec::new(), spring.clone(), &whirling),
                true => system(2, Vec::new(), bushing.clone(), &whirling),
            };
            let mut motion = motion.with_scheme(scheme);
            let held = |motion: &SystemMotion| {
                let [a, b] = [0, 1].map(|body| motion.state(body).unwrap());
                let line = b.origin_global - a.origin_global;
                if !is_bushing {
                    return 0.5 * spring.stiffness * (line.norm() - spring.free_length).powi(2);
                }
                let turned = [&a, &b].map(|state| state.attitude.global_to_body().clone_owned());
                let phi = rotation_vector(&(turned[1] * turned[0].transpose())).unwrap();
                let moved = turned[0] * line;
                0.5 * (bushing.stiffness[0].component_mul(&moved).dot(&moved)
                    + bushing.stiffness[1].component_mul(&phi).dot(&phi))
            };
            let total = |motion: &SystemMotion| motion.energy().unwrap() + held(motion);
            let (start, kinetic) = (total(&motion), motion.energy().unwrap());
            let steps = motion.advance(3.0, tolerance, &mut 1e-2).unwrap();
            let drift = total(&motion) - start;
            let open = motion.energy().unwrap() - kinetic - motion.element_work();
            println!(
                "{scheme:?} {is_bushing} {tolerance:e}: {:.1e} in {steps} steps, open by {open:.3e} of {drift:.3e}",
                drift / start
            );
            assert!((open - drift).abs() < 1e-10 * start, "{scheme:?}: {open:e} {drift:e}");
            assert_eq!(motion.work_of_element(0).loss, 0.0);
            if scheme == SystemScheme::Gauss && !is_bushing && tolerance > 1e-3 {
                let law = MarkerForce { markers: spring.markers.clone(), law: Arc::new(Like::Spring(spring.clone())) };
                let mut of_law = system(2, Vec::new(), law, &whirling).with_scheme(scheme);
                of_law.advance(3.0, tolerance, &mut 1e-2).unwrap();
                let summed = of_law.energy().unwrap() - kinetic - of_law.element_work();
                println!("a law: open by {summed:.1e} of {:.1e}", total(&of_law) - start);
                let drift = total(&of_law) - start;
                assert!((summed - drift).abs() < 0.02 * drift.abs(), "{summed:e} {drift:e}");
                assert!(of_law.work_of_element(0).drive == of_law.element_work(), "{:?}", of_law.work_of_element(0));
            }
        }
    }
}

/// Closed form: of two masses on a damped spring, what the damper takes is what the energies of the bodies and the spring have lost, and half
/// of each is in the works of a body.
#[test]
fn a_damper_has_a_loss_of_its_own() {
    let markers = [marker(Some(0), 0.0), marker(Some(1), 0.0)];
    let (stiffness, damping) = (50.0, 1.5);
    let spring = PointSpring { markers: markers.clone(), stiffness, damping, free_length: 1.0 };
    let damper = [Vector3::new(damping, 0.0, 0.0), Vector3::zeros()];
    let bushing =
        Bushing { markers, stiffness: [Vector3::new(stiffness, 0.0, 0.0), Vector3::zeros()], damping: damper };
    for (is_bushing, free) in [(false, 1.0), (true, 0.0)] {
        let states = [at(0.0, 0.0), at(free + 0.2, 0.0)];
        let mut motion = match is_bushing {
            false => system(2, Vec::new(), spring.clone(), &states),
            true => system(2, Vec::new(), bushing.clone(), &states),
        };
        motion.advance(1.3, 1e-8, &mut 1e-3).unwrap();
        let [a, b] = [0, 1].map(|body| motion.state(body).unwrap().origin_global.x);
        let held = |stretch: f64| 0.5 * stiffness * stretch * stretch;
        let lost = held(0.2) - held(b - a - free) - motion.energy().unwrap();
        let work = motion.work_of_element(0);
        assert!((work.loss - lost).abs() < 1e-7 && lost > 0.3, "{work:?} {lost}");
        assert!((work.spring - held(0.2) + held(b - a - free)).abs() < 1e-13 && work.drive == 0.0, "{work:?}");
    }
}

/// Conserved: the energy of a lopsided body on a bushing that holds its tilts and lets it turn about z, with the energy of the bushing, through
/// three turns. Against a hinge: its center of mass goes where that of a body on a hinge does, the farther the stiffer the bushing.
#[test]
fn a_bushing_with_a_free_axis_is_a_soft_hinge() {
    let inertia = Matrix3::new(0.2, 0.0, 0.03, 0.0, 0.3, 0.0, 0.03, 0.0, 0.4);
    let lopsided = ReducedBody::rigid(2.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let body = ConservativeBody::new(&lopsided, &[], Vec::new(), &Physics::default()).unwrap();
    let axes = Matrix3::identity();
    let (arm, stiff) = (Vector3::new(-0.3, 0.1, 0.2), 2e4);
    let bushing = Bushing {
        markers: [Marker::on_ground(arm, axes), Marker::on_rigid(0, arm, axes)],
        stiffness: [Vector3::repeat(stiff), Vector3::new(stiff, stiff, 0.0)],
        damping: [Vector3::zeros(); 2],
    };
    let omega = 6.0;
    let start = MotionState {
        omega_body: Vector3::new(0.0, 0.0, omega),
        velocity_global: Vector3::z().cross(&-arm) * omega,
        ..at(0.0, 0.0)
    };
    let system = System::new(vec![body], Vec::new()).unwrap().with_elements(vec![Arc::new(bushing)]).unwrap();
    let mut motion = SystemMotion::new(system, &[start]).unwrap();
    let energy = motion.energy().unwrap();
    let mut h = 1e-3;
    for time in [0.2, 0.4, 0.5, 0.6, 0.9, 1.3, 2.0, 3.1] {
        motion.advance(time, 1e-9, &mut h).unwrap();
        let now = motion.state(0).unwrap();
        let to_global = now.attitude.global_to_body().transpose();
        let moved = now.origin_global + to_global * arm - arm;
        let turned = rotation_vector(&to_global.transpose()).unwrap();
        let held = 0.5 * stiff * (moved.norm_squared() + turned.x.powi(2) + turned.y.powi(2));
        let open = (motion.energy().unwrap() + held) / energy - 1.0;
        let expected = arm - nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), omega * time) * arm;
        let off = (now.origin_global - expected).norm();
        println!("{time}: open by {open:.1e}, off by {off:.1e}");
        assert!(open.abs() < 1e-6 && off < 2e-2, "{time}: {open:e} {off}");
    }
}

/// The laws of a bushing and of a spring.
#[derive(Debug)]
pub enum Like {
    Bushing(Bushing),
    Spring(PointSpring),
}

impl MarkerLaw for Like {
    fn force_and_moment(&self, _: [f64; 2], motion: &RelativeMotion) -> [Vector3<f64>; 2] {
        match self {
            Self::Bushing(Bushing { stiffness, damping, .. }) => {
                let turned = rotation_vector(&motion.axes.transpose()).unwrap();
                let law = |which: usize, by: Vector3<f64>, rate: Vector3<f64>| {
                    -stiffness[which].component_mul(&by) - damping[which].component_mul(&rate)
                };
                // The rotation of the second marker turns by T(φ) δφ, so that the energy ½ φᵀKφ has the moment T(φ)⁻ᵀ K φ.
                let (t, cross) = (turned.norm().max(1e-9), cross_matrix(&turned));
                let tangent = Matrix3::identity()
                    + cross * ((1.0 - t.cos()) / (t * t))
                    + cross * cross * ((t - t.sin()) / (t * t * t));
                let torque = tangent.transpose().try_inverse().unwrap() * stiffness[1].component_mul(&turned);
                [law(0, motion.position, motion.velocity), -torque - damping[1].component_mul(&motion.omega)]
            }
            Self::Spring(PointSpring { stiffness, damping, free_length, .. }) => {
                let along = motion.position.normalize();
                let stretch = motion.position.norm() - free_length;
                let force = stiffness * stretch + damping * along.dot(&motion.velocity);
                [-along * force, Vector3::zeros()]
            }
        }
    }
}

/// Independent reference: a bushing and a spring between the same markers. Conserved: momenta, and energy by the work of the law.
#[test]
fn a_law_between_markers_does_what_an_element_does() {
    let askew = |body: usize, x: f64| {
        Marker::on_rigid(body, Vector3::new(x, 0.0, 0.0), transformation_matrix(&Vector3::new(0.3, -0.5, 0.7)))
    };
    let markers = [askew(0, 0.5), askew(1, -0.5)];
    let bushing = Bushing {
        markers: markers.clone(),
        stiffness: [Vector3::new(80.0, 90.0, 100.0), Vector3::new(5.0, 6.0, 7.0)],
        damping: [Vector3::repeat(0.5), Vector3::repeat(0.1)],
    };
    let spring = PointSpring { markers: markers.clone(), stiffness: 50.0, damping: 1.5, free_length: 0.1 };
    let tumbling = MotionState {
        omega_body: Vector3::new(0.5, -0.4, 1.0),
        velocity_global: Vector3::new(0.1, 0.2, 0.3),
        ..at(1.3, 0.0)
    };
    let states = [at(0.0, 0.7), tumbling];
    let element = |law: Like| MarkerForce { markers: markers.clone(), law: Arc::new(law) };
    let cases = [
        [
            system(2, Vec::new(), bushing.clone(), &states),
            system(2, Vec::new(), element(Like::Bushing(bushing)), &states),
        ],
        [system(2, Vec::new(), spring.clone(), &states), system(2, Vec::new(), element(Like::Spring(spring)), &states)],
    ];
    for [mut expected, mut found] in cases {
        let (momenta, energy) = (found.momenta(), found.energy().unwrap());
        let steps = [&mut expected, &mut found].map(|motion| motion.advance(2.0, 1e-8, &mut 1e-3).unwrap());
        for body in 0..2 {
            let [found, expected] = [&found, &expected].map(|motion| motion.state(body).unwrap());
            let off = (found.origin_global - expected.origin_global).norm();
            assert!(off < 1e-6 && (found.omega_body - expected.omega_body).norm() < 1e-5, "{off:e}");
        }
        assert!(found.momenta().iter().zip(momenta).all(|(now, start)| (now - start).norm() < 1e-13));
        let (work, missing) = (found.element_work(), imbalance(&found, energy));
        println!("{steps:?} steps, work {work}, {missing:e} missing");
        assert!(work != 0.0 && missing < 1e-6, "{work} {missing:e}");
    }
}
