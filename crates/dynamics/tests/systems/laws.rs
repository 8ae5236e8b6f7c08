//! Energy of laws of one's own, kinks, rest and friction.

use std::sync::Arc;

use dynamics::{
    ConservativeBody, Coordinate, Joint, JointForce, JointLawFn, Marker, MarkerForce, MarkerLaw, MotionState, Physics,
    RelativeMotion, Stops, System, SystemMotion, SystemScheme,
};
use modal::{ReducedBody, RigidMotion};
use nalgebra::{Matrix3, Vector3};

use crate::mechanism::at_rest;
use crate::rigid::weight;

const GRAVITY: f64 = 9.81;
/// Stiffness of the ground, and the height from which a ball of 1 kg falls.
const STIFFNESS: f64 = 1e4;
const HEIGHT: f64 = 0.5;

fn ball() -> ConservativeBody {
    let reduced = ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity() * 0.01, RigidMotion::free()).unwrap();
    ConservativeBody::new(&reduced, &[], vec![weight(1.0)], &Physics::default()).unwrap()
}

/// A ground that pushes back what is below it, and tells so or not.
#[derive(Debug)]
struct Ground {
    tells: bool,
}

impl MarkerLaw for Ground {
    fn force_and_moment(&self, _: [f64; 2], motion: &RelativeMotion) -> [Vector3<f64>; 2] {
        [Vector3::y() * (STIFFNESS * (-motion.position.y).max(0.0)), Vector3::zeros()]
    }

    fn switch(&self, _: [f64; 2], motion: &RelativeMotion) -> Option<f64> {
        self.tells.then_some(motion.position.y)
    }
}

/// A ball above the ground: by a law between two markers.
fn bouncing(tells: bool, scheme: SystemScheme) -> SystemMotion {
    let markers = [
        Marker::on_ground(Vector3::zeros(), Matrix3::identity()),
        Marker::on_rigid(0, Vector3::zeros(), Matrix3::identity()),
    ];
    let law = MarkerForce { markers, law: Arc::new(Ground { tells }) };
    let system = System::new(vec![ball()], Vec::new()).unwrap().with_elements(vec![Arc::new(law)]).unwrap();
    SystemMotion::new(system, &[at_rest(Vector3::y() * HEIGHT)]).unwrap().with_scheme(scheme)
}

/// Energy of the ball with its height and the ground, over that at the start.
fn energy(motion: &SystemMotion) -> f64 {
    let MotionState { origin_global: at, .. } = motion.state(0).unwrap();
    let stored = 0.5 * STIFFNESS * (-at.y).max(0.0).powi(2);
    (motion.energy().unwrap() + GRAVITY * at.y + stored) / (GRAVITY * HEIGHT)
}

/// Conserved: the energy of a ball that falls on a stiff ground, by both schemes, whether the law tells its kink or not; and the work of
/// the law is the change of the energy of the ground.
#[test]
fn a_ball_on_a_law_of_ones_own_keeps_its_energy() {
    for scheme in [SystemScheme::Radau, SystemScheme::Gauss] {
        for tells in [false, true] {
            let mut last = f64::INFINITY;
            for tolerance in [1e-4, 1e-6, 1e-8] {
                let mut motion = bouncing(tells, scheme);
                let steps = motion.advance(3.0, tolerance, &mut 1e-3).unwrap();
                let made = (energy(&motion) - 1.0).abs();
                let at = motion.state(0).unwrap().origin_global.y;
                let stored = 0.5 * STIFFNESS * (-at).max(0.0).powi(2);
                let work = (motion.element_work() + stored).abs() / (GRAVITY * HEIGHT);
                println!("{scheme:?} tells {tells} {tolerance:e}: {made:.1e}, work {work:.1e}, {steps} steps");
                // Radau damps what its steps see; Gauss keeps it.
                let bound = tolerance * if scheme == SystemScheme::Gauss { 0.1 } else { 1.0 };
                assert!(made <= bound && work <= 0.1 * tolerance, "{scheme:?} {tells} {tolerance}: {made:e} {work:e}");
                assert!(made < last, "{made:e} {last:e}");
                last = made;
            }
        }
    }
}

/// Counted: a law that tells its kink takes fewer steps, at the same tolerance; and a stop takes as many as it.
#[test]
fn steps_end_at_kinks_that_are_told() {
    let steps = |mut motion: SystemMotion| motion.advance(3.0, 1e-6, &mut 1e-3).unwrap();
    let [silent, told] = [false, true].map(|tells| steps(bouncing(tells, SystemScheme::Gauss)));
    let on_joint = |force: JointForce| {
        let slide = Joint::prismatic("slide", [up(None), up(Some(0))]).with_force(Coordinate::Slide, force);
        let system = System::new(vec![ball()], vec![slide]).unwrap();
        SystemMotion::new(system, &[at_rest(Vector3::y() * HEIGHT)]).unwrap().with_scheme(SystemScheme::Gauss)
    };
    let stops = Some(Stops { limits: [0.0, 10.0], stiffness: STIFFNESS, damping: 0.0 });
    let law = JointLawFn::new("ground", |_, x, _| STIFFNESS * f64::max(-x, 0.0)).with_switch(|_, x, _| x);
    let stop = on_joint(JointForce { stops, ..JointForce::default() });
    let law = on_joint(JointForce { laws: vec![Arc::new(law)], ..JointForce::default() });
    let [stop, law] = [stop, law].map(|mut motion| {
        let steps = motion.advance(3.0, 1e-6, &mut 1e-3).unwrap();
        let made = (energy(&motion) - 1.0).abs();
        assert!(made < 1e-7, "{made:e}");
        steps
    });
    println!("silent {silent}, told {told}, stop {stop}, law of a joint {law}");
    assert!(4 * told < 3 * silent && 4 * stop.abs_diff(law) < law, "{silent} {told} {stop} {law}");
}

/// A marker whose z axis is up, on the ball or on the ground.
fn up(body: Option<usize>) -> Marker {
    let axes = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    match body {
        Some(body) => Marker::on_rigid(body, Vector3::zeros(), axes),
        None => Marker::on_ground(Vector3::zeros(), axes),
    }
}

/// Closed form: a ball falls by 0.2 m and then against a force of one size that a law sets in with, which tells nothing; its work is force
/// times path.
#[test]
fn a_jump_that_nobody_tells_costs_no_energy() {
    let force = 20.0;
    let brake = JointLawFn::new("brake", move |_, x, _| if x < 0.3 { force } else { 0.0 });
    let force_of_slide = JointForce { laws: vec![Arc::new(brake)], ..JointForce::default() };
    let slide = Joint::prismatic("slide", [up(None), up(Some(0))]).with_force(Coordinate::Slide, force_of_slide);
    for scheme in SystemScheme::ALL {
        let system = System::new(vec![ball()], vec![slide.clone()]).unwrap();
        let mut motion = SystemMotion::new(system, &[at_rest(Vector3::y() * HEIGHT)]).unwrap().with_scheme(scheme);
        let (end, fallen) = (0.3, (2.0 * 0.2 / GRAVITY).sqrt());
        let steps = motion.advance(end, 1e-5, &mut 1e-3).unwrap();
        let (since, up) = (end - fallen, force - GRAVITY);
        let [expected, speed] =
            [0.3 - GRAVITY * fallen * since + 0.5 * up * since * since, up * since - GRAVITY * fallen];
        let MotionState { origin_global, velocity_global, .. } = motion.state(0).unwrap();
        let off = [
            origin_global.y - expected,
            velocity_global.y - speed,
            motion.joint_work(0).drive + force * (0.3 - expected),
        ];
        println!("{scheme:?} {steps} steps, {} evaluations: {off:?}", motion.evaluations());
        assert!(off.iter().all(|off| off.abs() < 1e-5), "{off:?}");
    }
}
