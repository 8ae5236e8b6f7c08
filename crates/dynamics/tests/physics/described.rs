//! A run that goes through its data and comes back is the same run.

use std::sync::Arc;

use dynamics::{
    DescribedBody, DescriptionError, Drive, DrivenMotion, DrivenSpeed, Expression, History, Initial, LoadFn, Method,
    Observation, Physics, ReferenceForces, Rows, RunDescription, ScaledLoad, SharedLoad, Signal, Start, StepControl,
    Table,
};
use faer::Mat;
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::loads::every_kind;
use crate::sample::{body, dead_force, point, start};

const FREQUENCIES: [f64; 3] = [5.0, 8.0, 13.0];

/// A history of every kind.
fn histories() -> Vec<History> {
    vec![
        History::Constant,
        History::Step { at: 0.3 },
        History::Ramp { start: 0.1, duration: 0.4 },
        History::HalfSine { start: 0.2, duration: 0.5 },
        History::Sine { frequency: 0.7, phase: 0.2, start: 0.1, duration: Some(0.9) },
        History::Sweep { from: 0.3, to: 1.2, start: 0.0, duration: 1.0 },
        History::Table(Table::new(vec![0.0, 0.4, 1.0], vec![0.2, 1.0, -0.5]).unwrap()),
        History::Expression(Expression::new("0.3 + sin(3 t) exp(-t)", vec![0.6]).unwrap()),
        History::Product { factors: vec![History::Step { at: 0.2 }, History::Ramp { start: 0.0, duration: 1.0 }] },
    ]
}

fn run(motion: RigidMotion, loads: Vec<SharedLoad>, physics: Physics) -> RunDescription {
    let body = body(motion, &FREQUENCIES);
    let points = vec![point(&body, [0.3, 0.1, -0.2])];
    let states = vec![start(body.flexible()).state(&body)];
    let body = DescribedBody { body, damping_ratios: vec![0.01, 0.02, 0.03], loads, physics, points, name: None };
    RunDescription {
        bodies: vec![body],
        joints: Vec::new(),
        couplings: Vec::new(),
        elements: Vec::new(),
        states,
        start: Start::AsPlaced,
        method: Method::EXPONENTIAL,
        control: StepControl::Fixed(0.01),
        end: 1.0,
        rows: Rows::Interval(0.1),
    }
}

fn rows(run: &RunDescription) -> Vec<Observation> {
    let simulation = run.begin().unwrap();
    simulation.collect::<Result<_, _>>().unwrap()
}

fn through_data(run: RunDescription) -> RunDescription {
    RunDescription::from_bytes(&run.to_bytes().unwrap()).unwrap()
}

/// Conserved: every number of every row, to the last bit.
#[test]
fn a_run_through_its_data_is_the_same_with_every_load_and_history() {
    let free = body(RigidMotion::free(), &FREQUENCIES);
    let at = |history| dead_force(point(&free, [0.5, -0.2, 0.4]), Vector3::new(0.5, 1.0, -0.7), history);
    let loads = every_kind().into_iter().chain(histories().into_iter().map(at)).collect();
    let free = run(RigidMotion::free(), loads, Physics::default());
    let adaptive = RunDescription { control: StepControl::Tolerance(1e-6), method: Method::RKMK4, ..free.clone() };
    let speed = DrivenSpeed { amplitude: 1.2, history: History::Ramp { start: 0.0, duration: 0.5 } };
    let drive = Drive { motion: DrivenMotion::Turn { axis: Vector3::z() }, speed, added: None };
    let drive_stiffness = Some(Mat::from_fn(3, 3, |i, j| 0.1 * (i + j) as f64));
    let physics = Physics { drive: Some(drive), drive_stiffness, ..Physics::default() };
    let mut driven = run(RigidMotion::clamp(Vector3::zeros()), Vec::new(), physics);
    let bent_start = Initial { modal_displacement: vec![0.1, -0.2, 0.05], ..Initial::at_rest(3) };
    driven.states = vec![bent_start.state(&driven.bodies[0].body)];
    let reference = ReferenceForces {
        force: vec![0.3, -0.2, 0.1],
        stiffness: Mat::from_fn(3, 3, |i, j| 0.5 * (1 + i.max(j)) as f64 - 0.2 * i.min(j) as f64),
    };
    let physics = Physics { reference: Some(reference), ..Physics::default() };
    let mut bent = run(RigidMotion::clamp(Vector3::zeros()), Vec::new(), physics);
    bent.states = driven.states.clone();
    for run in [free, adaptive, driven, bent] {
        let rows_before = rows(&run);
        assert!(rows_before[5].modal_velocity.iter().all(|v| *v != 0.0));
        assert_eq!(rows_before, rows(&through_data(run)));
    }
}

#[test]
fn what_is_code_is_refused_by_name() {
    let refused = |run: RunDescription| run.to_bytes().unwrap_err();
    let own: SharedLoad = Arc::new(LoadFn::new("my damper", |_, _| ()));
    let with = |load| run(RigidMotion::free(), vec![load], Physics::default());
    assert!(refused(with(own)).to_string().contains("my damper"));
    let scaled = ScaledLoad { load: every_kind().swap_remove(0), factor: Signal::held(1.0) };
    assert!(matches!(refused(with(Arc::new(scaled))), DescriptionError::Load { .. }));
    let of_paper =
        RunDescription { method: frames_rk4::PAPER, ..run(RigidMotion::free(), Vec::new(), Physics::default()) };
    assert!(refused(of_paper).to_string().contains("formulation paper"));
    let drive = Drive {
        motion: DrivenMotion::Turn { axis: Vector3::z() },
        speed: DrivenSpeed { amplitude: 1.0, history: History::Constant },
        added: Some(Signal::held(0.0)),
    };
    let physics = Physics { drive: Some(drive), ..Physics::default() };
    assert_eq!(refused(run(RigidMotion::clamp(Vector3::zeros()), Vec::new(), physics)), DescriptionError::AddedSpeed);
}

#[test]
fn bytes_that_are_no_run_are_refused_and_every_cut_one_too() {
    let of = |bytes: &[u8]| RunDescription::from_bytes(bytes).map(|_| ());
    let run = run(RigidMotion::free(), every_kind(), Physics::default());
    let bytes = run.to_bytes().unwrap();
    assert_eq!(of(b"something else"), Err(DescriptionError::Other));
    assert_eq!(of(&[]), Err(DescriptionError::Other));
    let mut other = bytes.clone();
    // The version follows the name and its length.
    other[1 + "flexframe run".len()] = 99;
    assert!(matches!(of(&other), Err(DescriptionError::Version { found: 99, .. })));
    for cut in (20..bytes.len()).step_by(7) {
        assert!(of(&bytes[..cut]).is_err(), "{cut}");
    }
    assert!(of(&[&bytes[..], &[0]].concat()).is_err());
    // Whatever is damaged, it is read or refused.
    for at in (0..bytes.len()).step_by(3) {
        for to in [0, 1, 6, 0x7f, 0xff] {
            let mut damaged = bytes.clone();
            damaged[at] = to;
            let _ = of(&damaged);
        }
    }
}
