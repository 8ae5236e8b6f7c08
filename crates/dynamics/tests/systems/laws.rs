//! Energy of laws of one's own, kinks, rest and friction.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use dynamics::{
    Bushing, ConservativeBody, Coordinate, ForceElement, Friction, History, Joint, JointForce, JointLawFn, Marker,
    MarkerForce, MarkerLaw, MarkerMotion, MarkerWrench, MotionState, Observation, Physics, PointForce, PointShapes,
    Reached, RelativeMotion, Rows, SharedLoad, Simulation, Start, StepControl, Stops, System, SystemMotion,
    SystemScheme, SystemSetup,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};

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

/// A stiff support of one's own between the ball and the ground, with dampers, that says nothing of its slopes; calls of it are counted.
#[derive(Debug)]
struct Support {
    markers: [Marker; 2],
    calls: Arc<AtomicUsize>,
}

/// Stiffness and damping along each axis, of the support.
const OF_SUPPORT: [f64; 2] = [1e8, 2e4];

impl Support {
    fn pull(&self, position: Vector3<f64>, velocity: Vector3<f64>) -> Vector3<f64> {
        self.calls.fetch_add(1, Ordering::Relaxed);
        -(position * OF_SUPPORT[0] + velocity * OF_SUPPORT[1])
    }
}

impl ForceElement for Support {
    fn markers(&self) -> &[Marker] {
        &self.markers
    }

    fn apply(&self, _: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]) {
        let [i, j] = motions else { unreachable!() };
        let force = self.pull(j.position_global - i.position_global, j.velocity_global - i.velocity_global);
        (wrenches[0].force_global, wrenches[1].force_global) = (-force, force);
    }
}

impl MarkerLaw for Support {
    fn force_and_moment(&self, _: [f64; 2], motion: &RelativeMotion) -> [Vector3<f64>; 2] {
        [self.pull(motion.position, motion.velocity), Vector3::zeros()]
    }
}

/// Closed form: a body at rest on a support, by its weight. Counted: Newton's method knows the slopes of a law of one's own by differences, which it asks for once a step: a support of 1e8 N/m takes
/// as many steps as a spring of the program, as a law between markers and as an element; its calls are counted.
#[test]
fn a_stiff_element_of_ones_own_takes_no_shorter_steps() {
    let axes = Matrix3::identity();
    let markers = || [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(0, Vector3::zeros(), axes)];
    let [stiffness, damping] = OF_SUPPORT.map(|of| [Vector3::repeat(of), Vector3::zeros()]);
    let calls = Arc::new(AtomicUsize::new(0));
    let support = || Support { markers: markers(), calls: Arc::clone(&calls) };
    let elements: [(&str, Arc<dyn ForceElement>); 3] = [
        ("bushing", Arc::new(Bushing { markers: markers(), stiffness, damping })),
        ("law between markers", Arc::new(MarkerForce { markers: markers(), law: Arc::new(support()) })),
        ("element", Arc::new(support())),
    ];
    let mut counted = Vec::new();
    for (name, element) in elements {
        calls.store(0, Ordering::Relaxed);
        let system = System::new(vec![ball()], Vec::new()).unwrap().with_elements(vec![element]).unwrap();
        let mut motion = SystemMotion::new(system, &[at_rest(Vector3::y() * 1e-4)]).unwrap();
        let steps = motion.advance(1.0, 1e-4, &mut 1e-3).unwrap();
        let at = motion.state(0).unwrap().origin_global.y;
        counted.push((steps, motion.evaluations(), calls.load(Ordering::Relaxed) as u64));
        println!("{name}: {:?}, at {at:e}", counted.last());
        // The weight over the stiffness, once the swing has died.
        assert!((at + GRAVITY / OF_SUPPORT[0]).abs() < 1e-12, "{at:e}");
    }
    let [(spring, ..), (law, _, of_law), (element, _, of_element)] = counted[..] else { panic!("{counted:?}") };
    assert!(law <= 2 * spring && element <= 2 * spring, "{counted:?}");
    // Each of the three stages costs thirteen calls a step, and some more.
    assert!(of_law <= 80 * law && of_element <= 80 * element, "{counted:?}");
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

/// Closed form: an arm that friction holds at 95 % of its limit creeps by v₀ artanh 0.95, in as many steps whatever v₀ is, and this is told.
#[test]
fn friction_holds_near_its_limit_in_few_steps() {
    let (mass, arm) = (2.0, 0.5);
    let inertia = Matrix3::identity() / 6.0;
    let reduced = ReducedBody::rigid(mass, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let body = ConservativeBody::new(&reduced, &[], vec![weight(mass)], &Physics::default()).unwrap();
    for rate_scale in [1e-3, 1e-4, 1e-5, 1e-6] {
        let force = mass * GRAVITY * arm / 0.95;
        let friction = JointForce { friction: Some(Friction { force, rate_scale }), ..JointForce::default() };
        let axes = Matrix3::identity();
        let markers = [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(0, Vector3::x() * -arm, axes)];
        let hinge = Joint::revolute("hinge", markers).with_force(Coordinate::Turn, friction);
        let system = System::new(vec![body.clone()], vec![hinge]).unwrap();
        let mut motion = SystemMotion::new(system, &[at_rest(Vector3::x() * arm)]).unwrap();
        let steps = motion.advance(1.0, 1e-4, &mut 1e-3).unwrap();
        let turn = motion.joint_coordinates(0).turn;
        let creep = -rate_scale * 0.95_f64.atanh();
        let held: Vec<_> = motion.held().collect();
        println!(
            "{rate_scale:e}: {steps} steps, {} evaluations, {:.1e} off, {held:?}",
            motion.evaluations(),
            turn / creep - 1.0
        );
        assert!((turn / creep - 1.0).abs() < 0.05, "{turn:e} {creep:e}");
        assert!(steps < 150, "{steps}");
        let [(0, [time, path])] = held[..] else { panic!("{held:?}") };
        assert!(time > 0.9 && (path - turn.abs()).abs() < 0.1 * path, "{time} {path} {turn}");
    }
}

/// Conserved: three stiff and damped arms that a force bends come to rest, and the account of their energy closes until the end.
#[test]
fn stiff_arms_come_to_rest_and_live() {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.1, 1.1, 1.1));
    let reduced = ReducedBody::rigid(20.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let tip = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::x() * 0.4));
    let load: SharedLoad = Arc::new(PointForce::dead(tip, Vector3::y() * -1000.0, History::Constant));
    let body = |loads: Vec<SharedLoad>| ConservativeBody::new(&reduced, &[], loads, &Physics::default()).unwrap();
    let spring = || JointForce { stiffness: 1e8, damping: 123_935.0, ..JointForce::default() };
    let axes = Matrix3::identity();
    let on = |body: usize, x: f64| Marker::on_rigid(body, Vector3::x() * x, axes);
    let hinge =
        |name: &str, markers: [Marker; 2]| Joint::revolute(name, markers).with_force(Coordinate::Turn, spring());
    for (tolerance, bound) in [(1e-2, 0.05), (1e-4, 0.01), (1e-6, 1e-3)] {
        let joints = vec![
            hinge("first", [Marker::on_ground(Vector3::zeros(), axes), on(0, -0.4)]),
            hinge("second", [on(0, 0.4), on(1, -0.4)]),
            hinge("third", [on(1, 0.4), on(2, -0.4)]),
        ];
        let bodies = vec![body(vec![]), body(vec![]), body(vec![Arc::clone(&load)])];
        let mut simulation = Simulation::of_system(SystemSetup {
            system: System::new(bodies, joints).unwrap(),
            states: [0.4, 1.2, 2.0].map(|x| at_rest(Vector3::x() * x)).to_vec(),
            start: Start::AsPlaced,
            scheme: SystemScheme::Radau,
            control: StepControl::Tolerance(tolerance),
            end: 2.0,
            rows: Rows::Interval(0.1),
            points: vec![Vec::new(); 3],
        })
        .unwrap();
        let (mut rows, mut open) = (0, 0.0_f64);
        while simulation.advance(u64::MAX).unwrap() != Reached::End {
            let mut row: Vec<Observation> = (0..3).map(|body| simulation.room(body)).collect();
            simulation.observe(&mut row).unwrap();
            rows += 1;
            open = row.iter().map(Observation::energy_balance).sum::<f64>().abs().max(open);
        }
        // Each joint bends by its moment over its stiffness.
        let turn = simulation.system_motion().unwrap().joint_coordinates(0).turn;
        let work = 1000.0 * 1000.0 * (2.4 * 2.4 + 1.6 * 1.6 + 0.8 * 0.8) / 1e8;
        println!("{tolerance:e}: open by {:.1e} in {} steps", open / work, simulation.stats().accepted);
        assert!(rows == 20 && (turn / (-2400.0 / 1e8) - 1.0).abs() < 1e-4, "{rows} {turn}");
        assert!(open < bound * work, "{tolerance}: {open:e} {work:e}");
    }
}
