//! Stiffness that steps do not see: of springs in joints and between markers, and of bodies.

use std::sync::Arc;

use dynamics::{
    Bushing, ConservativeBody, Coordinate, ForceElement, Friction, History, Joint, JointForce, Marker, MarkerForce,
    MotionState, Physics, PointForce, PointShapes, PointSpring, System, SystemMotion,
};
use fem_tet10::Material;
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::{Attitude, transformation_matrix};

use crate::elements::Like;
use crate::flexible::Jointed;
use crate::mechanism::at_rest;

/// A bar of 1 m and 1 kg along x, with its weight along −y.
fn bar() -> ConservativeBody {
    let inertia = Matrix3::from_diagonal(&Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0));
    let reduced = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, -9.81, 0.0), History::Constant);
    ConservativeBody::new(&reduced, &[], vec![Arc::new(weight)], &Physics::default()).unwrap()
}

fn end(body: usize, x: f64) -> Marker {
    Marker::on_rigid(body, Vector3::new(x, 0.0, 0.0), Matrix3::identity())
}

/// Two bars in a row that fall from the horizontal about a hinge on the ground; the second is held by its joint and an element.
fn falling(second: Option<Joint>, elements: Vec<Arc<dyn ForceElement>>) -> SystemMotion {
    let first = Joint::revolute("first", [Marker::on_ground(Vector3::zeros(), Matrix3::identity()), end(0, -0.5)]);
    let joints = [first].into_iter().chain(second).collect();
    let system = System::new(vec![bar(), bar()], joints).unwrap().with_elements(elements).unwrap();
    let state = |x: f64| at_rest(Vector3::new(x, 0.0, 0.0));
    SystemMotion::new(system, &[state(0.5), state(1.5)]).unwrap()
}

/// Steps to 1 s, the angle there, and what is missing of the energy.
fn fall(mut motion: SystemMotion) -> (u64, f64, f64) {
    let steps = motion.advance(1.0, 1e-5, &mut 1e-3).unwrap();
    let potential: f64 = (0..2).map(|body| 9.81 * motion.state(body).unwrap().origin_global.y).sum();
    let missing = motion.energy().unwrap() + potential - motion.element_work();
    (steps, motion.joint_coordinates(0).turn, missing)
}

/// Independent reference: a hinge that a spring holds moves as a weld does, in as many steps, however stiff the spring is.
#[test]
fn a_stiff_hinge_takes_as_many_steps_as_a_weld() {
    let between = || [end(0, 0.5), end(1, -0.5)];
    let (steps, turn, _) = fall(falling(Some(Joint::fixed("second", between())), Vec::new()));
    for stiffness in [1e5, 1e7, 1e9, 1e11] {
        let spring = JointForce { stiffness, damping: 1e-6 * stiffness, ..JointForce::default() };
        let hinge = Joint::revolute("second", between()).with_force(Coordinate::Turn, spring);
        let (found, angle, missing) = fall(falling(Some(hinge), Vec::new()));
        println!("{stiffness:e}: {found} steps, {steps} of a weld; {:e} rad off, {missing:e} J missing", angle - turn);
        // The tolerance is kept for the vibration of the softest, whose amplitude is above it.
        let most = if stiffness < 1e6 { 10 * steps } else { steps + steps / 2 };
        assert!(found <= most, "{found} {steps}");
        assert!((angle - turn).abs() < 1e-4 && missing.abs() < 1e-3, "{angle} {turn} {missing}");
    }
}

/// Independent reference: the same with a strut across the hinge, and with a bushing in place of the joint, which takes up to twice
/// as many: it has forces where a joint has rows.
#[test]
fn stiff_elements_take_steps_of_a_weld() {
    let between = || [end(0, 0.5), end(1, -0.5)];
    let (steps, turn, _) = fall(falling(Some(Joint::fixed("second", between())), Vec::new()));
    for stiffness in [1e6, 1e8] {
        let bushing = Bushing {
            markers: between(),
            stiffness: [Vector3::repeat(stiffness); 2],
            damping: [Vector3::repeat(1e-6 * stiffness); 2],
        };
        // A strut across the hinge.
        // Axes askew, so that a law along the strut is stiff along none of them.
        let axes = transformation_matrix(&Vector3::new(0.4, 0.3, -0.6));
        let strut = |body: usize, x: f64, y: f64| Marker::on_rigid(body, Vector3::new(x, y, 0.0), axes);
        let spring = PointSpring {
            markers: [strut(0, 0.3, 0.2), strut(1, -0.3, 0.2)],
            stiffness: 10.0 * stiffness,
            damping: 1e-5 * stiffness,
            free_length: 0.4,
        };
        let hinge = || Some(Joint::revolute("second", between()));
        let law = |markers: &[Marker; 2], law: Like| {
            Arc::new(MarkerForce { markers: markers.clone(), law: Arc::new(law) }) as Arc<dyn ForceElement>
        };
        let laws =
            [law(&bushing.markers, Like::Bushing(bushing.clone())), law(&spring.markers, Like::Spring(spring.clone()))];
        let [like_bushing, like_strut] = laws;
        let cases: [(&str, Option<Joint>, Arc<dyn ForceElement>); 4] = [
            ("bushing", None, Arc::new(bushing)),
            ("strut", hinge(), Arc::new(spring)),
            ("law of a bushing", None, like_bushing),
            ("law of a strut", hinge(), like_strut),
        ];
        for (name, joint, element) in cases {
            let (found, angle, missing) = fall(falling(joint, vec![element]));
            println!("{name} {stiffness:e}: {found} steps, {steps} of a weld; {:e} off, {missing:e} J", angle - turn);
            // The soft strut vibrates with more than the tolerance, which is kept for that; of laws whose energy nobody tells, what rings at
            // first is the whole motion.
            let most = match name {
                "strut" if stiffness < 1e7 => 18,
                "bushing" | "strut" => 10,
                _ => 40,
            };
            assert!(found <= steps * most / 4, "{found} {steps}");
            assert!((angle - turn).abs() < 1e-4 && missing.abs() < 1e-3, "{angle} {turn} {missing}");
        }
    }
}

/// Closed form: friction that is much larger than what drives a bar holds it.
#[test]
fn steep_friction_holds() {
    let mut counts = Vec::new();
    for rate_scale in [1e-2, 1e-3, 1e-4] {
        let friction = Some(Friction { force: 100.0, rate_scale });
        let grip = JointForce { friction, ..JointForce::default() };
        let hinge = Joint::revolute("second", [end(0, 0.5), end(1, -0.5)]).with_force(Coordinate::Turn, grip);
        let mut motion = falling(Some(hinge), Vec::new());
        counts.push(motion.advance(1.0, 1e-5, &mut 1e-3).unwrap());
        let turned = motion.joint_coordinates(1).turn;
        println!("{rate_scale:e}: {} steps, turned by {turned:e}", counts[counts.len() - 1]);
        assert!(turned.abs() < 0.2 * rate_scale, "{turned:e}");
    }
    assert!(counts[2] <= 3 * counts[0], "{counts:?}");
}

/// Conserved and counted: a double pendulum of solid rods in crossed hinges, thrown, from a relaxed start: at most four times the steps with
/// bodies 100 and 10 000 times as stiff, whose frequencies are 10 and 100 times as high.
#[test]
fn stiff_bodies_take_no_more_steps() {
    let mut counts = Vec::new();
    for factor in [1.0, 100.0, 1e4] {
        let material = Material { young_modulus: factor * 70e9, poisson_ratio: 0.3, density: 2700.0 };
        let rod = Jointed::new("crank_rod", material, 6, &["crank", "slider"]);
        let highest = *rod.body.circular_frequencies.last().unwrap();
        let crossed = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
        let joints = vec![
            Joint::revolute("first", [Marker::on_ground(Vector3::zeros(), Matrix3::identity()), rod.marker(0, 0)]),
            Joint::revolute("second", [rod.turned_marker(0, 1, crossed), rod.turned_marker(1, 0, crossed)]),
        ];
        let still = Attitude::identity();
        let across = Vector3::z() * 10.0;
        let first = MotionState {
            velocity_global: across.cross(&(Vector3::x() * 0.15)),
            omega_body: across,
            ..rod.at_rest(Vector3::new(0.15, 0.0, 0.0), still)
        };
        let spin = across + crossed.column(2) * 20.0;
        let second = MotionState {
            velocity_global: across.cross(&(Vector3::x() * 0.3)) + spin.cross(&(Vector3::x() * 0.15)),
            omega_body: spin,
            ..rod.at_rest(Vector3::new(0.45, 0.0, 0.0), still)
        };
        let system = System::new(vec![rod.conservative(), rod.conservative()], joints).unwrap();
        let mut motion = SystemMotion::new(system, &[first, second]).unwrap();
        motion.relax().unwrap();
        let energy = motion.energy().unwrap();
        let steps = motion.advance(0.1, 1e-5, &mut 1e-4).unwrap();
        let drift = motion.energy().unwrap() / energy - 1.0;
        println!("E × {factor:e}, to {highest:e} rad/s: {steps} steps, energy {drift:e}");
        assert!(drift.abs() < 1e-3, "{drift:e}");
        counts.push(steps);
    }
    assert!(counts[1] <= 4 * counts[0] && counts[2] <= 4 * counts[0], "{counts:?}");
}
