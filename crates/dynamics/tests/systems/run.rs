//! Runs of bodies with joints: rows, discontinuities, balances, checkpoints.

use std::sync::{Arc, Mutex};

use crate::mechanism::at_rest;
use dynamics::{
    CheckpointError, ConservativeBody, Coordinate, History, Initial, Island, Joint, JointDrive, JointForce, Marker,
    MarkerForce, MarkerLaw, MotionState, Observation, Observer, Physics, PointForce, PointShapes, Reached,
    RelativeMotion, RowTimes, Rows, Run, SetupError, SharedLoad, Simulation, Start, StepControl, StepEnd, StepError,
    System, SystemObservation, SystemScheme, SystemSetup, Table,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};

/// Two rods of 1 m and 1 kg that hang from each other and from the ground in a field of gravity, with a spring between them.
fn pendulum(control: StepControl, drive: Option<JointDrive>) -> SystemSetup {
    let inertia = Matrix3::from_diagonal(&Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0));
    let rod = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&rod, &BodyPoint::rigid(Vector3::zeros()));
    let weight: SharedLoad = Arc::new(PointForce::dead(center, Vector3::new(0.0, -9.81, 0.0), History::Constant));
    let body = ConservativeBody::new(&rod, &[], vec![weight], &Physics::default()).unwrap();
    let axes = Matrix3::identity();
    let end = |body: usize, x: f64| Marker::on_rigid(body, Vector3::x() * x, axes);
    let first = Joint::revolute("first", [Marker::on_ground(Vector3::zeros(), axes), end(0, -0.5)]);
    let first = match drive {
        Some(drive) => first.turned_by(drive),
        None => first,
    };
    let spring = JointForce { stiffness: 2.0, damping: 0.1, free: 0.5, ..JointForce::default() };
    let second = Joint::revolute("second", [end(0, 0.5), end(1, -0.5)]).with_force(Coordinate::Turn, spring);
    let system = System::new(vec![body.clone(), body], vec![first, second]).unwrap();
    let at = |x: f64| at_rest(Vector3::x() * x);
    SystemSetup {
        system,
        states: vec![at(0.5), at(1.5)],
        start: Start::AsPlaced,
        scheme: SystemScheme::Radau,
        control,
        end: 2.0,
        rows: Rows::Interval(0.25),
        points: vec![Vec::new(), vec![PointShapes::new(&rod, &BodyPoint::rigid(Vector3::x() * 0.5))]],
    }
}

fn rows(mut simulation: Simulation) -> Vec<Vec<Observation>> {
    let mut rows = Vec::new();
    loop {
        let mut row: Vec<Observation> = (0..2).map(|body| simulation.room(body)).collect();
        simulation.observe(&mut row).unwrap();
        rows.push(row);
        loop {
            match simulation.advance_watched(10, |_, _| ()).unwrap() {
                Reached::End => return rows,
                Reached::Row => break,
                _ => {}
            }
        }
    }
}

/// Conserved: energy less the work of loads, joints and springs, and momenta less their impulses, of each body.
#[test]
fn the_balances_of_each_body_close_with_what_joints_and_springs_do() {
    let rows = rows(Simulation::of_system(pendulum(StepControl::Tolerance(1e-8), None)).unwrap());
    assert_eq!(
        rows.iter().map(|row| row[0].time).collect::<Vec<_>>(),
        (0..9).map(|k| 0.25 * f64::from(k)).collect::<Vec<_>>()
    );
    let mut exchanged = 0.0_f64;
    for row in &rows {
        for body in row {
            exchanged = exchanged.max(body.work.work.abs());
            assert!(body.energy_balance().abs() < 1e-7, "{}", body.energy_balance());
            assert!(body.linear_balance_global().norm() < 1e-7);
            assert!(body.angular_balance_global().norm() < 1e-7);
        }
    }
    assert!(exchanged > 1.0);
    // The joint holds the tip of the first rod where the second begins.
    let last = &rows[8];
    let tip = last[0].origin_global + last[0].attitude.to_global(&(Vector3::x() * 0.5));
    let start = last[1].origin_global - last[1].attitude.to_global(&(Vector3::x() * 0.5));
    assert!((tip - start).norm() < 1e-12);
}

/// Conserved: the energy that an observer sees at every step, less work, with losses. Its error ends the run between two
/// steps: what follows is what would have followed.
#[test]
fn an_observer_sees_every_step_and_every_row_and_leaves_the_motion_alone() {
    #[derive(Default)]
    struct Watcher {
        steps: Vec<f64>,
        rows: usize,
        largest_excess: f64,
        fails_after: Option<f64>,
    }

    impl Observer for Watcher {
        fn step(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
            let time = now.motion().time();
            self.steps.push(time);
            let bodies = &now.observation()?.bodies;
            let excess: f64 = bodies.iter().map(|of| of.energy() - of.work.work + of.work.dissipation).sum();
            self.largest_excess = self.largest_excess.max(excess.abs());
            match self.fails_after.take_if(|at| time > *at) {
                Some(_) => Err(StepError::NotFinite { time, what: "what is watched" }),
                None => Ok(()),
            }
        }

        fn observed(&mut self, now: &mut StepEnd<'_>) -> Result<(), StepError> {
            self.rows += 1;
            assert_eq!(now.motion().time(), now.observation()?.time);
            Ok(())
        }
    }

    let alone = rows(Simulation::of_system(pendulum(StepControl::Tolerance(1e-9), None)).unwrap());
    let mut simulation = Simulation::of_system(pendulum(StepControl::Tolerance(1e-9), None)).unwrap();
    let watcher = Arc::new(Mutex::new(Watcher { fails_after: Some(1.1), ..Watcher::default() }));
    let count = Arc::new(Mutex::new(0));
    let counted = count.clone();
    simulation.watch(watcher.clone());
    simulation.watch(Arc::new(Mutex::new(move |now: &SystemObservation| {
        assert_eq!((now.bodies.len(), now.joints.len()), (2, 2));
        *counted.lock().unwrap() += 1;
    })));
    let (mut found, mut failures) = (Vec::new(), 0);
    let mut row = |simulation: &mut Simulation| {
        let mut row: Vec<Observation> = (0..2).map(|body| simulation.room(body)).collect();
        simulation.observe(&mut row).unwrap();
        found.push(row);
    };
    row(&mut simulation);
    loop {
        match simulation.advance(u64::MAX) {
            Ok(Reached::End) => break,
            Ok(_) => row(&mut simulation),
            Err(_) => failures += 1,
        }
    }
    assert_eq!((found, failures), (alone.clone(), 1));
    let watcher = watcher.lock().unwrap();
    assert_eq!(watcher.steps.len() as u64, simulation.stats().accepted);
    assert!(watcher.steps.windows(2).all(|pair| pair[0] < pair[1]) && watcher.rows == alone.len());
    assert!(watcher.largest_excess < 1e-7, "{:e}", watcher.largest_excess);
    // The step at whose end the first one fails is not shown to the second.
    assert_eq!(*count.lock().unwrap() + 1, simulation.stats().accepted);
}

/// A law that gives no number ends the run with an error, whatever steps are taken, and what was before stays.
#[test]
fn a_law_that_gives_no_number_ends_the_run() {
    #[derive(Debug)]
    struct Breaks;

    impl MarkerLaw for Breaks {
        fn force_and_moment(&self, [time, _]: [f64; 2], _: &RelativeMotion) -> [Vector3<f64>; 2] {
            [Vector3::repeat(if time < 0.6 { 0.0 } else { f64::NAN }), Vector3::zeros()]
        }
    }

    let axes = Matrix3::identity();
    for scheme in [SystemScheme::Radau, SystemScheme::Gauss, SystemScheme::Rkmk4] {
        for control in [StepControl::Fixed(0.01), StepControl::Tolerance(1e-6)] {
            let mut setup = pendulum(control, None);
            let markers = [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(1, Vector3::zeros(), axes)];
            let breaks = MarkerForce { markers, law: Arc::new(Breaks) };
            setup.system = setup.system.with_elements(vec![Arc::new(breaks)]).unwrap();
            setup.scheme = scheme;
            let mut simulation = Simulation::of_system(setup).unwrap();
            let error = loop {
                match simulation.advance(10_000) {
                    Ok(Reached::Row) => {}
                    Ok(reached) => panic!("{scheme:?} {control:?}: {reached:?}"),
                    Err(error) => break error,
                }
            };
            println!("{scheme:?} {control:?}: {error}");
            assert!(
                (0.5..0.61).contains(&simulation.system_motion().unwrap().time()),
                "{scheme:?} {control:?}: {error}"
            );
            assert!(simulation.system_motion().unwrap().state(1).unwrap().origin_global.iter().all(|x| x.is_finite()));
        }
    }
}

/// Regression only: the same bits with and without an interruption.
#[test]
fn a_run_goes_on_from_a_checkpoint_bit_for_bit() {
    for control in [StepControl::Tolerance(1e-6), StepControl::Fixed(0.01)] {
        let whole = rows(Simulation::of_system(pendulum(control, None)).unwrap());
        let mut cut = Simulation::of_system(pendulum(control, None)).unwrap();
        while cut.time() < 0.9 {
            cut.advance_watched(1, |_, _| ()).unwrap();
        }
        let checkpoint = cut.checkpoint().unwrap();
        let resumed = Simulation::of_system(pendulum(control, None)).unwrap().restored(&checkpoint).unwrap();
        assert_eq!(checkpoint.len(), resumed.checkpoint().unwrap().len());
        let mut resumed = resumed;
        while resumed.advance_watched(100, |_, _| ()).unwrap() != Reached::Row {}
        let rest = rows(resumed);
        assert_eq!(rest[..], whole[whole.len() - rest.len()..]);
    }
}

/// A checkpoint is refused by a run of something else, which is named, and where its data are of another version.
#[test]
fn a_checkpoint_of_other_bodies_in_joints_is_refused_with_what_has_changed() {
    let control = StepControl::Tolerance(1e-6);
    let begin = |setup: SystemSetup| Simulation::of_system(setup).unwrap();
    let checkpoint = begin(pendulum(control, None)).checkpoint().unwrap();
    let refusal = |setup: SystemSetup| begin(setup).restored(&checkpoint).unwrap_err().to_string();
    let mut setup = pendulum(control, None);
    let spring = JointForce { stiffness: 1e-9, ..JointForce::default() };
    let joints: Vec<Joint> = setup.system.joints().to_vec();
    let name = joints[1].name.clone();
    let joints = [joints[0].clone(), joints[1].clone().with_force(Coordinate::Turn, spring)].to_vec();
    setup.system = System::new(setup.system.bodies().to_vec(), joints).unwrap();
    assert!(refusal(setup).contains(&format!("the joint \"{name}\" has changed")));
    assert!(refusal(pendulum(StepControl::Tolerance(1e-7), None)).contains("the scheme or its steps has changed"));
    let mut setup = pendulum(control, None);
    setup.states[0].omega_body.z += 1e-3;
    assert!(refusal(setup).contains("the start has changed"));
    let mut of_before = checkpoint.clone();
    of_before[0] = of_before[0] & !0xff | 1;
    let refused = begin(pendulum(control, None)).restored(&of_before).unwrap_err();
    assert!(matches!(refused, CheckpointError::Version { found: 1, .. }), "{refused}");
}

/// Closed form: the angle of a drive that starts and stops at a jump of its rate.
#[test]
fn a_drive_whose_rate_jumps_takes_the_bodies_with_it() {
    let history = History::Table(Table::new(vec![0.0, 0.55, 1.3, 3.0], vec![0.0, 0.0, 1.0, 1.0]).unwrap());
    let drive = JointDrive { amplitude: 0.6, history };
    let rows = rows(Simulation::of_system(pendulum(StepControl::Tolerance(1e-6), Some(drive))).unwrap());
    for row in rows {
        let angle = 0.6 * ((row[0].time - 0.55) / 0.75).clamp(0.0, 1.0);
        let [w, _, _, z] = row[0].attitude.wxyz();
        assert!((2.0 * z.atan2(w) - angle).abs() < 1e-10, "{} {} {angle}", row[0].time, 2.0 * z.atan2(w));
        let open = row.iter().map(Observation::energy_balance).sum::<f64>();
        println!("{} open {open:e} angle {angle}", row[0].time);
        assert!(open.abs() < 1e-5, "{open:e}");
    }
}

/// Conserved: what a drive whose rate jumps has done is told at its joint, with the jumps: here those of two wheels at once. Closed form: ½ J ω²
/// of a wheel that has been brought to ω at once, and nothing once it has been stopped.
#[test]
fn the_work_of_a_jump_is_told_at_the_joint_of_its_drive() {
    let wheel = |inertia: f64| {
        let wheel =
            ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity() * inertia, RigidMotion::free()).unwrap();
        ConservativeBody::new(&wheel, &[], Vec::new(), &Physics::default()).unwrap()
    };
    let ramp = |rate: f64| JointDrive { amplitude: rate, history: History::Ramp { start: 0.5, duration: 1.0 } };
    let axes = Matrix3::identity();
    let hinge = |body: usize, rate: f64| {
        let ends = [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(body, Vector3::zeros(), axes)];
        Joint::revolute(&format!("hinge {body}"), ends).turned_by(ramp(rate))
    };
    let system = System::new(vec![wheel(0.2), wheel(0.4)], vec![hinge(0, 3.0), hinge(1, -2.0)]).unwrap();
    let states = vec![at_rest(Vector3::zeros()); 2];
    let setup = SystemSetup { system, states, ..pendulum(StepControl::Tolerance(1e-6), None) };
    let setup = SystemSetup { points: vec![Vec::new(); 2], ..setup };
    let mut simulation = Simulation::of_system(setup).unwrap();
    let mut works = Vec::new();
    while simulation.system_motion().unwrap().time() < 2.0 {
        if simulation.advance_watched(10, |_, _| ()).unwrap() == Reached::Row {
            works.push([0, 1].map(|joint| simulation.system_motion().unwrap().joint_work(joint).drive));
        }
    }
    let [first, second] = works[3];
    assert!((first - 0.5 * 0.2 * 9.0).abs() < 1e-12 && (second - 0.5 * 0.4 * 4.0).abs() < 1e-12, "{first} {second}");
    assert!(works.last().unwrap().iter().all(|work| work.abs() < 1e-12), "{works:?}");
}

#[test]
fn what_does_not_fit_is_moved_or_refused_with_the_name_of_the_joint() {
    let mut setup = pendulum(StepControl::Tolerance(1e-6), None);
    setup.states[1].origin_global.x = 1.6;
    let simulation = Simulation::of_system(setup).unwrap();
    let moved: Vec<f64> = simulation.system().unwrap().assembled().iter().map(|body| body.moved).collect();
    assert!(moved[1] > 1e-3 && moved.iter().sum::<f64>() < 0.2, "{moved:?}");

    let SystemSetup { system, .. } = pendulum(StepControl::Tolerance(1e-6), None);
    let axes = Matrix3::identity();
    let far = Joint::spherical(
        "too far",
        [Marker::on_ground(Vector3::x() * 5.0, axes), Marker::on_rigid(1, Vector3::x() * 0.5, axes)],
    );
    let joints = system.joints().iter().cloned().chain([far]).collect();
    let system = System::new(system.bodies().to_vec(), joints).unwrap();
    let refused = Simulation::of_system(SystemSetup { system, ..pendulum(StepControl::Tolerance(1e-6), None) });
    assert!(matches!(refused, Err(SetupError::NotAssembled { .. })), "{refused:?}");
}

/// Conserved: the joints: a body that begins far from where it belongs, turned and at rest beside one that moves.
#[test]
fn bodies_far_from_where_they_belong_are_put_together() {
    let mut setup = pendulum(StepControl::Tolerance(1e-6), None);
    setup.states[0].omega_body = Vector3::new(0.0, 0.0, 3.0);
    setup.states[0].velocity_global = Vector3::new(0.0, 1.5, 0.0);
    setup.states[1].origin_global = Vector3::new(2.5, 1.0, 0.2);
    let simulation = Simulation::of_system(setup).unwrap();
    let mut motion = simulation.system_motion().unwrap().clone();
    let open = motion.residuals().unwrap().map(|list| list.iter().fold(0.0_f64, |most, g| most.max(g.abs())));
    assert!(open[0] < 1e-12 && open[1] < 1e-11, "{open:?}");
}

/// Conserved: the energy of a wheel on a spring. After a hundred periods the balance over what has come and gone is the part that is lost,
/// however often the spring has given and taken it.
#[test]
fn the_balance_of_a_long_vibration_is_the_part_that_it_has_lost() {
    let wheel = ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity() * 0.2, RigidMotion::free()).unwrap();
    let body = ConservativeBody::new(&wheel, &[], Vec::new(), &Physics::default()).unwrap();
    let axes = Matrix3::identity();
    let ends = [Marker::on_ground(Vector3::zeros(), axes), Marker::on_rigid(0, Vector3::zeros(), axes)];
    let stiffness = 0.2 * std::f64::consts::TAU.powi(2);
    let spring = JointForce { stiffness, ..JointForce::default() };
    let joint = Joint::revolute("hinge", ends).with_force(Coordinate::Turn, spring);
    let start = MotionState { omega_body: Vector3::z(), ..at_rest(Vector3::zeros()) };
    let setup = SystemSetup {
        system: System::new(vec![body], vec![joint]).unwrap(),
        states: vec![start],
        end: 100.0,
        points: vec![Vec::new()],
        ..pendulum(StepControl::Tolerance(1e-3), None)
    };
    let mut simulation = Simulation::of_system(setup).unwrap();
    while simulation.advance_watched(100, |_, _| ()).unwrap() != Reached::End {}
    let mut row = vec![simulation.room(0)];
    simulation.observe(&mut row).unwrap();
    let turn = simulation.system_motion().unwrap().joint_coordinates(0).turn;
    let energy = row[0].energy() + 0.5 * stiffness * turn.powi(2);
    let (lost, open) = (1.0 - energy / 0.1, row[0].energy_balance() - 0.1);
    println!("lost {lost:e}, open {:e}", open.abs() / simulation.energies(0).exchanged);
    assert!(lost > 1e-3, "{lost}");
    assert!((open.abs() / simulation.energies(0).exchanged / lost - 1.0).abs() < 0.1);
}

/// Second implementation: the islands of a run move as each does by itself; a run from a checkpoint gives the same bits; a stop is between rows.
#[test]
fn islands_of_a_run_meet_at_rows_and_stops_and_move_as_each_by_itself() {
    let control = StepControl::Tolerance(1e-6);
    let reduced = ReducedBody::rigid(
        2.0,
        Vector3::zeros(),
        Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.5)),
        RigidMotion::free(),
    )
    .unwrap();
    let initial = Initial { omega: Vector3::new(0.1, 3.0, 0.2), ..Initial::at_rest(0) };
    let alone =
        Simulation::builder(&reduced, control, 2.0).initial(initial).rows(Rows::Interval(0.25)).build().unwrap();
    let tied = Simulation::of_system(pendulum(control, None)).unwrap();
    let island = |motion, bodies| Island { motion, bodies, joints: Vec::new(), elements: Vec::new() };
    let islands = vec![island(alone.clone(), vec![1]), island(tied.clone(), vec![0, 2])];
    let begun = Run::new(islands, RowTimes::new(Rows::Interval(0.25), control, 2.0));
    let lead = |mut run: Run| -> Vec<Vec<Observation>> {
        let (mut out, mut row) = (Vec::new(), run.room());
        loop {
            assert_eq!(run.observe(&mut row, &mut []).unwrap(), 0.25 * out.len() as f64);
            out.push(row.clone());
            while match run.advance(5, |_, _| ()).unwrap() {
                Reached::End => return out,
                reached => reached == Reached::Between,
            } {}
        }
    };
    let together = lead(begun.clone());
    assert_eq!(together.len(), 9);
    for (row, now) in together.iter().zip(alone) {
        assert_eq!(row[1], now.unwrap());
    }
    for (row, now) in together.iter().zip(rows(tied)) {
        assert_eq!([&row[0], &row[2]], [&now[0], &now[1]]);
    }
    let mut part = begun.clone();
    while part.advance(100, |_, _| ()).unwrap() != Reached::Row {}
    let words = part.checkpoint().unwrap();
    assert_eq!(words.len(), begun.checkpoint().unwrap().len());
    let mut again = begun.clone().restored(&words).unwrap();
    let (mut row, mut same) = (again.room(), again.room());
    for run in [&mut part, &mut again] {
        run.set_stop_time(Some(0.3));
        while run.advance(100, |_, _| ()).unwrap() != Reached::Stop {}
        assert_eq!(run.time(), 0.3);
        while run.advance(100, |_, _| ()).unwrap() != Reached::Row {}
    }
    assert_eq!(part.observe(&mut row, &mut []).unwrap(), 0.5);
    again.observe(&mut same, &mut []).unwrap();
    assert_eq!(row, same);
    assert!(begun.restored(&words[..words.len() - 1]).is_err());
}
