//! Loads and drives that a program sets between steps.

use std::sync::Arc;

use dynamics::{
    Drive, DrivenMotion, DrivenSpeed, History, Observation, Reached, Rows, ScaledLoad, SharedLoad, Signal, Simulation,
    StepControl, Table,
};
use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::sample::{EXPONENTIAL, RKMK4, Run, body, dead_force, point};

const END: f64 = 2.0;
const JUMP: f64 = 0.7;

/// Goes to the jump, sets what is to be set there, and goes on to the end.
fn with_jump(mut simulation: Simulation, set: impl FnOnce()) -> Observation {
    simulation.set_stop_time(Some(JUMP));
    assert_eq!(simulation.advance(u64::MAX).unwrap(), Reached::Stop);
    set();
    simulation.loads_have_changed();
    while simulation.advance(u64::MAX).unwrap() != Reached::End {}
    simulation.observation().unwrap()
}

fn off(a: &Observation, b: &Observation) -> f64 {
    let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    apart(&a.modal_displacement, &b.modal_displacement)
        .max(apart(&a.modal_velocity, &b.modal_velocity))
        .max((a.position_global - b.position_global).norm())
        .max(a.attitude.angle_to(&b.attitude))
}

/// Conserved: a factor that is set at a time is a history with a step then, in fixed steps and under control, whose
/// steps begin with the rates of the last.
#[test]
fn a_factor_that_is_set_between_steps_is_a_step_of_its_history() {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0]);
    let mut run = Run::new(&body, END);
    let force = |factor: f64, history| {
        dead_force(point(&body, [0.3, -0.2, 0.4]), Vector3::new(1.0, -2.0, 0.5) * factor, history)
    };
    for method in [EXPONENTIAL, RKMK4] {
        for (control, allowed) in [(StepControl::Fixed(0.01), 1e-12), (StepControl::Tolerance(1e-6), 1e-5)] {
            run.loads = vec![force(0.5, History::Constant), force(2.5, History::Step { at: JUMP })];
            let expected = run.start(method, control, Rows::Interval(END)).last().unwrap().unwrap();
            let factor = Signal::held(0.5);
            let load: SharedLoad = Arc::new(ScaledLoad { load: force(1.0, History::Constant), factor: factor.clone() });
            run.loads = vec![load];
            let found = with_jump(run.start(method, control, Rows::EverySteps(u64::MAX)), || factor.hold(3.0));
            // Measured under control: 4e-7 at most.
            assert!(off(&found, &expected) < allowed, "{method:?} {control:?}: {:e}", off(&found, &expected));
        }
    }
}

/// Conserved: the same motion by a table.
#[test]
fn a_drive_with_an_added_speed_is_one_by_a_table() {
    let body = body(RigidMotion::clamp(Vector3::zeros()), &[5.0, 8.0, 13.0]);
    let mut run = Run::new(&body, END);
    let unit = Vector3::new(2.0, -1.0, 2.0) / 3.0;
    for motion in [DrivenMotion::Turn { axis: unit }, DrivenMotion::Slide { direction: unit }] {
        let control = StepControl::Fixed(0.01);
        let at = |time: f64| 0.5 + 0.8 * JUMP - 1.1 * (time - JUMP);
        let (later, beyond) = (at(END), END + 1.0);
        let table = Table::new(vec![0.0, JUMP, beyond], vec![0.5, at(JUMP), at(beyond)]).unwrap();
        let speed = DrivenSpeed { amplitude: 1.0, history: History::Table(table) };
        run.physics.drive = Some(Drive { motion, speed, added: None });
        let expected = run.start(EXPONENTIAL, control, Rows::Interval(END)).last().unwrap().unwrap();
        let added = Signal::held(0.0);
        added.ramp(0.0, 0.0, 0.8);
        let speed = DrivenSpeed { amplitude: 0.5, history: History::Constant };
        run.physics.drive = Some(Drive { motion, speed, added: Some(added.clone()) });
        let simulation = run.start(EXPONENTIAL, control, Rows::EverySteps(u64::MAX));
        let found = with_jump(simulation, || added.ramp(JUMP, added.at(JUMP), -1.1));
        assert!(off(&found, &expected) < 1e-12, "{motion:?}: {:e}", off(&found, &expected));
        assert!((found.reaction.drive - expected.reaction.drive).abs() < 1e-10);
        assert!((found.reaction.drive_power / found.reaction.drive - later).abs() < 1e-10);
    }
}

/// The account of the energy, which a checkpoint keeps, is without a scale of the loads where steps resolve the modes. A
/// signal that was set does not give it one.
#[test]
fn a_signal_raises_the_energy_scale_only_where_steps_may_miss_work() {
    let body = body(RigidMotion::free(), &[5.0, 8.0, 13.0]);
    let mut run = Run::new(&body, END);
    let factor = Signal::held(0.0);
    let unit = dead_force(point(&body, [0.3, -0.2, 0.4]), Vector3::new(1.0, -2.0, 0.5), History::Constant);
    let load: SharedLoad = Arc::new(ScaledLoad { load: unit, factor: factor.clone() });
    run.loads = vec![load];
    let controls =
        [(StepControl::Fixed(0.01), false), (StepControl::Fixed(0.1), true), (StepControl::Tolerance(1e-6), true)];
    for (control, is_raised) in controls {
        factor.hold(0.0);
        let mut simulation = run.start(EXPONENTIAL, control, Rows::EverySteps(u64::MAX));
        let before = simulation.checkpoint().unwrap();
        factor.hold(100.0);
        simulation.loads_have_changed();
        assert_eq!(simulation.checkpoint().unwrap() != before, is_raised, "{control:?}");
    }
}
