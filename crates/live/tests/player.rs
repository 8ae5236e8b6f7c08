//! A run that is led on is the recorded one until something is changed, and keeps its balances after that.

use std::sync::Arc;

use dynamics::faer::Mat;
use dynamics::nalgebra::{Matrix3, Vector3};
use dynamics::reduced_body::BodyPoint;
use dynamics::reduced_body::{Constants, ReducedBody, RigidMotion};
use dynamics::{
    Coordinate, DescribedBody, History, Initial, Joint, JointForce, Marker, Method, MotionState, Physics, PointForce,
    PointShapes, ReferenceForces, Rows, RunDescription, StepControl, SystemScheme,
};
use live::{BODY_NUMBERS, Change, LiveError, LiveMotion, LiveRun, Player};

const END: f64 = 2.0;

/// A free body with three made-up modes: of an unlike inertia in all axes, as its deformation changes it.
fn body() -> ReducedBody {
    let nf = 3;
    let inertia = Matrix3::from_diagonal(&Vector3::new(2.0, 3.0, 4.0));
    let some = |seed: usize| 0.3 * (12.9898 * seed as f64).sin();
    let symmetric = |seed: usize| Mat::from_fn(nf, nf, |i, j| some(seed + 7 * i.max(j) + 3 * i.min(j)));
    let skew = |seed: usize| Mat::from_fn(nf, nf, |i, j| some(seed + 5 * i + 11 * j) - some(seed + 5 * j + 11 * i));
    ReducedBody::from_constants(Constants {
        mass: 1.5,
        center_of_mass: Vector3::zeros(),
        motion: RigidMotion::free(),
        origin: Vector3::zeros(),
        inertia,
        translation_basis: Matrix3::identity() / 1.5_f64.sqrt(),
        rotation_basis: Matrix3::from_diagonal(&inertia.diagonal().map(|moment| 1.0 / moment.sqrt())),
        circular_frequencies: vec![5.0, 8.0, 13.0],
        natural_modes: nf,
        rotation_products: std::array::from_fn(|_| std::array::from_fn(|_| Mat::zeros(6 + nf, 6 + nf))),
        position_products: std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; 6 + nf])),
        inertia_first: std::array::from_fn(|pair| (0..nf).map(|k| some(100 + 13 * pair + k)).collect()),
        inertia_second: std::array::from_fn(|pair| symmetric(200 + 17 * pair)),
        gyroscopic: std::array::from_fn(|i| skew(300 + 19 * i)),
        translation_first: std::array::from_fn(|_| vec![0.0; nf]),
        rotation_first: std::array::from_fn(|_| vec![0.0; nf]),
        stress_stiffness: None,
    })
    .unwrap()
}

const SHAPES: [f64; 9] = [0.3, -0.1, 0.2, 0.5, 0.1, -0.4, -0.2, 0.6, 0.1];

fn alone(control: StepControl, loads: usize) -> RunDescription {
    let body = body();
    let at =
        BodyPoint { position_body: Vector3::new(0.5, -0.2, 0.4), shapes: Mat::from_fn(3, 3, |i, k| SHAPES[3 * k + i]) };
    let force = PointForce::dead(PointShapes::new(&body, &at), Vector3::new(0.5, 1.0, -0.7), History::Constant);
    let initial = Initial {
        omega: Vector3::new(1.0, -0.6, 0.8),
        modal_displacement: vec![0.1, -0.2, 0.05],
        ..Initial::at_rest(3)
    };
    RunDescription {
        states: vec![initial.state(&body)],
        bodies: vec![DescribedBody {
            damping_ratios: vec![0.0; 3],
            loads: vec![Arc::new(force) as _; loads],
            physics: Physics::default(),
            points: Vec::new(),
            name: None,
            body,
        }],
        joints: Vec::new(),
        couplings: Vec::new(),
        elements: Vec::new(),
        start: dynamics::Start::AsPlaced,
        method: Method::EXPONENTIAL,
        control,
        end: END,
        rows: Rows::Interval(0.1),
    }
}

fn of_body(run: RunDescription) -> LiveRun {
    LiveRun { motions: vec![LiveMotion { run, bodies: vec![0] }] }
}

/// A rod that hangs from the ground by a hinge with a spring, and the flexible body on its end.
fn of_system() -> (LiveRun, RunDescription) {
    let flexible = body();
    let inertia = Matrix3::from_diagonal(&Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0));
    let rod = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&rod, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, -9.81, 0.0), History::Constant);
    let axes = Matrix3::identity();
    let spring = JointForce { stiffness: 2.0, free: 0.5, ..JointForce::default() };
    let hinge = [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(0, Vector3::x() * -0.5, axes)];
    let ball = [Marker::on_rigid(0, Vector3::x() * 0.5, axes), Marker::on_rigid(1, Vector3::x() * -0.5, axes)];
    let described = |body: ReducedBody, loads| DescribedBody {
        damping_ratios: vec![0.0; body.flexible()],
        loads,
        physics: Physics::default(),
        points: Vec::new(),
        name: None,
        body,
    };
    let state = |x: f64, flexible: usize| MotionState {
        time: 0.0,
        attitude: dynamics::rigid_kin::Attitude::identity(),
        origin_global: Vector3::x() * x,
        velocity_global: Vector3::zeros(),
        omega_body: Vector3::zeros(),
        modal_displacement: vec![0.0; flexible],
        modal_velocity: vec![0.0; flexible],
    };
    let run = RunDescription {
        bodies: vec![described(rod, vec![Arc::new(weight)]), described(flexible, Vec::new())],
        joints: vec![
            Joint::revolute("hinge", hinge).with_force(Coordinate::Turn, spring),
            Joint::spherical("ball", ball),
        ],
        couplings: Vec::new(),
        elements: Vec::new(),
        states: vec![state(0.5, 0), state(1.5, 3)],
        start: dynamics::Start::AsPlaced,
        method: Method::of_joints(SystemScheme::Radau),
        control: StepControl::Tolerance(1e-8),
        end: END,
        rows: Rows::Interval(0.1),
    };
    // On the page the bodies are the other way round.
    let motion = LiveMotion { run: run.clone(), bodies: vec![1, 0] };
    (LiveRun { motions: vec![motion] }, run)
}

/// Numbers of a body of the page.
fn of(player: &Player, body: usize) -> &[f64] {
    let before: usize = 1 + (0..body).map(|body| BODY_NUMBERS + player.coordinates(body)).sum::<usize>();
    &player.numbers()[before..before + BODY_NUMBERS + player.coordinates(body)]
}

fn energy_balance(of_body: &[f64]) -> f64 {
    of_body[20]
}

/// Conserved: every row of the recorded run, to the last bit, whatever frames lie between.
#[test]
fn until_something_is_changed_it_is_the_recorded_run() {
    for control in [StepControl::Fixed(0.01), StepControl::Tolerance(1e-6)] {
        let run = alone(control, 1);
        let mut player = Player::new(of_body(run.clone()), 1.0 / 60.0).unwrap();
        let simulation = run.begin().unwrap();
        for row in simulation {
            let row = row.unwrap();
            for frame in 1..4 {
                player.lead_to(row.time - 0.1 + 0.025 * f64::from(frame)).unwrap();
            }
            player.lead_to(row.time).unwrap();
            let numbers = of(&player, 0);
            assert_eq!(
                (numbers[0], numbers[7], numbers[10]),
                (row.origin_global.x, row.omega_body.x, row.kinetic_energy)
            );
            assert_eq!(&numbers[27..], row.modal_displacement);
        }
        assert!(player.is_recorded() && player.time() == END);
    }
    let (live, run) = of_system();
    let mut player = Player::new(live, 0.017).unwrap();
    let mut simulation = run.begin().unwrap();
    let mut rows = 0;
    while !simulation.is_over() {
        if simulation.advance(1).unwrap() != dynamics::Reached::Row {
            continue;
        }
        rows += 1;
        let row = simulation.system_observation().unwrap();
        player.lead_to(row.time - 0.03).unwrap();
        player.lead_to(row.time).unwrap();
        for (body, seen) in [1, 0].into_iter().zip(&row.bodies) {
            let numbers = of(&player, body);
            // Rows in between are found by polynomials: their time may differ by rounding.
            assert!((numbers[0] - seen.origin_global.x).abs() < 1e-12, "{} {}", numbers[0], seen.origin_global.x);
            assert!((numbers[9] - seen.omega_body.z).abs() < 1e-11);
            assert_eq!(numbers.len(), BODY_NUMBERS + seen.modal_displacement.len());
        }
    }
    assert_eq!(rows, 20);
}

/// Conserved: energy less the work of the loads, and of the spring of a pull; momenta less the impulses.
#[test]
fn a_pulled_body_keeps_its_balances_and_comes_to_the_hand() {
    let mut player = Player::new(of_body(alone(StepControl::Tolerance(1e-7), 0)), 0.02).unwrap();
    player.lead_to(0.333).unwrap();
    let target = Vector3::new(2.0, 1.0, -0.5);
    player.pull(0, Vector3::new(0.5, -0.2, 0.4), &SHAPES, [40.0, 12.0], target).unwrap();
    let [start, momentum] = [energy_balance(of(&player, 0)), of(&player, 0)[21]];
    let distance = |player: &Player| {
        let point = &player.numbers()[player.numbers().len() - 6..];
        (Vector3::new(point[0], point[1], point[2]) - target).norm()
    };
    let first = distance(&player);
    for frame in 1..400 {
        player.lead_to(0.333 + 0.02 * f64::from(frame)).unwrap();
        if frame == 100 {
            player.move_pull(target).unwrap();
        }
    }
    let [energy, impulse] = [energy_balance(of(&player, 0)) - start, of(&player, 0)[21] - momentum];
    assert!(energy.abs() < 1e-5 && impulse.abs() < 1e-6, "{energy:e} {impulse:e}");
    assert!(first > 1.5 && distance(&player) < 0.3, "{first} {}", distance(&player));
    let work = of(&player, 0)[12];
    assert!(work.abs() > 0.1, "{work}");
    player.let_go().unwrap();
    assert_eq!(player.numbers()[player.numbers().len() - 6..], [0.0; 6]);
    assert!(!player.is_recorded());
}

/// Closed form: the coordinate of a bent rest is 1, and a place that is pulled at has its displacement.
#[test]
fn a_body_about_a_bent_rest_has_the_rest_as_a_shape() {
    let mut run = alone(StepControl::Fixed(0.01), 0);
    run.bodies[0].physics.reference = Some(ReferenceForces {
        force: vec![0.1, -0.2, 0.3],
        stiffness: Mat::from_fn(3, 3, |i, j| 0.1 * (i + j) as f64),
    });
    let bytes = of_body(run.clone()).to_bytes().unwrap();
    let mut player = Player::new(LiveRun::from_bytes(&bytes).unwrap(), 0.02).unwrap();
    let simulation = run.begin().unwrap();
    for row in simulation {
        let row = row.unwrap();
        player.lead_to(row.time).unwrap();
        assert_eq!(of(&player, 0)[27..], [&row.modal_displacement[..], &[1.0]].concat());
    }
    let rest = [0.0, 0.0, 0.7];
    let shapes = [&[0.0; 9][..], &rest].concat();
    player.pull(0, Vector3::zeros(), &shapes, [1.0, 0.0], Vector3::zeros()).unwrap();
    let point = &player.numbers()[player.numbers().len() - 6..];
    let from_origin = Vector3::new(point[0], point[1], point[2]) - Vector3::from_column_slice(&of(&player, 0)[..3]);
    assert!((from_origin.norm() - 0.7).abs() < 1e-12, "{from_origin}");
    assert!(player.pull(0, Vector3::zeros(), &shapes[..9], [1.0, 0.0], Vector3::zeros()).is_err());
}

/// Closed form: a load of twice the size is the same as two of it; a run whose end is passed goes on as one that ends later.
#[test]
fn changes_are_those_of_a_run_that_has_them_from_its_beginning() {
    let control = StepControl::Fixed(0.01);
    let mut twice = Player::new(of_body(alone(control, 1)), 0.02).unwrap();
    twice.set(Change::Load { body: 0, load: 0 }, 2.0).unwrap();
    let two = RunDescription { end: 3.0, ..alone(control, 2) };
    let mut two = Player::new(of_body(two), 0.02).unwrap();
    for time in [0.5, 1.0, 1.99, 2.5, 2.9] {
        twice.lead_to(time).unwrap();
        two.lead_to(time).unwrap();
        for (a, b) in of(&twice, 0)[..10].iter().zip(&of(&two, 0)[..10]) {
            // Where the shorter run ends, it has been begun anew from its state.
            assert!((a - b).abs() < 1e-7, "{time}: {a} {b}");
        }
    }
    assert_eq!(twice.value(Change::Load { body: 0, load: 0 }), 2.0);

    // A spin and its damping.
    twice.set_spin(0, 5.0).unwrap();
    let omega = Vector3::new(of(&twice, 0)[7], of(&twice, 0)[8], of(&twice, 0)[9]);
    assert!((omega.norm() - 5.0).abs() < 1e-12);
    twice.set(Change::Damping { body: 0 }, 0.05).unwrap();
    twice.lead_to(4.0).unwrap();
    assert!(of(&twice, 0)[13] > 0.0, "damping takes energy");

    let mut longer = Player::new(of_body(alone(control, 1)), 0.02).unwrap();
    longer.lead_to(3.0).unwrap();
    assert!(longer.is_recorded() && !twice.is_recorded(), "to go on beyond the end changes nothing");

    twice.restart().unwrap();
    assert!(twice.is_recorded() && twice.time() == 0.0);
    assert_eq!(twice.value(Change::Damping { body: 0 }), 0.0);
}

#[test]
fn joints_can_be_stiffened_and_what_is_not_there_is_refused() {
    let (run, _) = of_system();
    let mut player = Player::new(LiveRun::from_bytes(&run.to_bytes().unwrap()).unwrap(), 0.02).unwrap();
    let mut soft = Player::new(run, 0.02).unwrap();
    player.lead_to(0.5).unwrap();
    player.set(Change::JointStiffness { motion: 0, joint: 0 }, 20.0).unwrap();
    player.pull(1, Vector3::new(0.2, 0.0, 0.0), &[], [5.0, 0.1], Vector3::new(0.0, 3.0, 0.0)).unwrap();
    player.lead_to(1.5).unwrap();
    soft.lead_to(1.5).unwrap();
    let z = |player: &Player| of(player, 1)[1];
    assert!((z(&player) - z(&soft)).abs() > 0.01, "{} {}", z(&player), z(&soft));
    let before = player.numbers().to_vec();
    let refused = |error: LiveError| error.to_string();
    assert!(
        refused(player.set(Change::JointStiffness { motion: 0, joint: 7 }, 2.0).unwrap_err()).contains("no such joint")
    );
    assert!(refused(player.set(Change::Load { body: 0, load: 0 }, 2.0).unwrap_err()).contains("no such load"));
    assert!(refused(player.set(Change::Damping { body: 0 }, -1.0).unwrap_err()).contains("zero or more"));
    assert!(refused(player.set(Change::Damping { body: 9 }, 1.0).unwrap_err()).contains("no such body"));
    assert!(refused(player.set_spin(0, f64::NAN).unwrap_err()).contains("finite"));
    let short = player.pull(0, Vector3::zeros(), &[1.0], [1.0, 0.0], Vector3::zeros());
    assert!(refused(short.unwrap_err()).contains("expected 9"));
    assert!(matches!(LiveRun::from_bytes(b"no run"), Err(LiveError::Description(_))));
    // What was refused has changed nothing.
    player.lead_to(1.5).unwrap();
    assert_eq!(before, player.numbers());
}
