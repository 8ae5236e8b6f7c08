//! Step control, and where steps end.

use dynamics::{Expression, History, Initial, Method, Observation, Reached, Rows, StepControl};
use nalgebra::Vector3;

use crate::common::{METHODS, Specimen, dead_force, plate};
use crate::run::{EXPONENTIAL, Error, RKMK4, Run, relative_3};

/// Tumbling at 10 rad/s with vibration, under a pulse that begins and ends between the rows.
fn tumbling(plate: &Specimen) -> Run<'_> {
    let mut initial = Initial::at_rest(10);
    initial.omega = Vector3::new(3.0, 8.0, 5.0);
    initial.modal_velocity[..4].copy_from_slice(&[77.0, -54.0, 117.0, 37.0]);
    let load = plate.pulse([-500.0, 0.0, 10.0], [20.0, 10.0, 30.0], 0.031_41, 0.073_217);
    Run { damping_ratio: 0.02, loads: vec![load], ..Run::free(plate, initial, 0.5) }
}

/// Conserved: the error falls with the tolerance, against steps of 1.25e-5 s.
#[test]
fn the_error_falls_with_the_tolerance() {
    let run = tumbling(plate());
    let reference: Observation = run.end(EXPONENTIAL, 1.25e-5);
    for (method, tolerances) in
        [(EXPONENTIAL, vec![1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]), (RKMK4, vec![1e-4, 1e-5, 1e-6, 1e-7, 1e-8])]
    {
        let mut before = f64::INFINITY;
        for tolerance in tolerances {
            let mut simulation = run.start(method, StepControl::Tolerance(tolerance), Rows::Interval(0.1));
            let last = simulation.by_ref().last().unwrap().unwrap();
            let error = Error::between(&last, &reference);
            let error = error.attitude.max(error.modal);
            let stats = simulation.stats();
            // The reference itself is no closer than its rounding, some 2e-12.
            assert!(error < (0.5 * before).max(4e-12), "{method:?} {tolerance:e}: {error:e} after {before:e}");
            assert!(error < tolerance, "{method:?} {tolerance:e}: {error:e}");
            // Few tries in vain.
            assert!(stats.rejected > 0 && 10 * stats.rejected < stats.accepted, "{stats:?}");
            before = error;
        }
    }
}

/// Closed form: the impulse 2FT/π.
#[test]
fn a_short_pulse_in_a_long_quiet_run_is_not_missed() {
    let plate = plate();
    let force = Vector3::new(20.0, 10.0, 30.0);
    let (start, duration) = (5.000_3, 1e-3);
    let load = plate.pulse([-500.0, 0.0, 10.0], force.into(), start, duration);
    let run = Run { damping_ratio: 0.05, loads: vec![load], ..Run::free(plate, Initial::at_rest(10), 10.0) };
    let impulse = force * (2.0 * duration / std::f64::consts::PI);
    let run_to = |tolerance: f64| {
        let mut simulation = run.start(EXPONENTIAL, StepControl::Tolerance(tolerance), Rows::Interval(10.0));
        (simulation.by_ref().last().unwrap().unwrap(), simulation.stats())
    };
    let ((coarse, stats), (fine, _)) = (run_to(1e-6), run_to(1e-10));
    // Momentum 7.8e-12 and 5e-14, spin 7.8e-12, in 836 steps: the tolerance is shared out over the ten seconds, and the
    // pulse has a ten-thousandth of them.
    let momentum = [&coarse, &fine].map(|row| relative_3(&row.linear_momentum_global, &impulse));
    let spin = relative_3(&coarse.omega_body, &fine.omega_body);
    assert!(momentum[0] < 1e-6 && momentum[1] < 1e-10, "{momentum:?}");
    assert!(spin < 1e-6 && fine.omega_body.norm() > 1e-3, "{spin:e}");
    assert!(stats.accepted < 2000 && stats.longest == 0.5 * start, "{stats:?}");
}

/// Closed form: ∫F dt and ∫∫F dt².
#[test]
fn a_load_that_swings_in_time_with_the_steps_is_not_missed() {
    let rigid = plate().truncated(0);
    let (end, frequency) = (0.1, 1000.0);
    let omega = std::f64::consts::TAU * frequency;
    let formula = |text: &str| History::Expression(Expression::new(text, Vec::new()).unwrap());
    let sine = History::Sine { frequency, phase: 0.0, start: 0.0, duration: None };
    let bell = formula("exp(-((t - 0.0437)/1e-5)^2)");
    let bell_impulse = 1e-5 * std::f64::consts::PI.sqrt();
    // ∫F dt and ∫∫F dt² of each. Without modes, nothing but the load sees that whole periods fall into a step.
    for (history, [impulse, path], bound) in [
        (sine, [0.0, end / omega], 1e-6),                            // 7.9e-8
        (formula("sin(2000*pi*t)"), [0.0, end / omega], 1e-5),       // 3.3e-7
        (bell, [bell_impulse, bell_impulse * (end - 0.0437)], 1e-8), // 8.2e-11
    ] {
        let load = dead_force(rigid.point([-500.0, 0.0, 10.0]), Vector3::new(0.0, 0.0, 40.0), history);
        let run = Run { loads: vec![load], ..Run::free(&rigid, Initial::at_rest(0), end) };
        let mut simulation = run.start(EXPONENTIAL, StepControl::Tolerance(1e-6), Rows::Interval(0.01));
        let last = simulation.by_ref().last().unwrap().unwrap();
        let expected = [impulse, path].map(|integral| 40.0 * integral);
        let start = rigid.body.center_of_mass.z;
        let found = [last.linear_momentum_global.z, rigid.body.mass * (last.position_global.z - start)];
        let scale = [40.0 * (path / end), 40.0 * path];
        for k in 0..2 {
            assert!((found[k] - expected[k]).abs() < bound * scale[k], "{found:?} {expected:?}");
        }
    }
}

/// Ends of all steps, and whether each is a row.
fn ends(run: &Run, method: Method, control: StepControl, rows: Rows) -> Vec<(f64, bool)> {
    let mut simulation = run.start(method, control, rows);
    let mut ends = Vec::new();
    loop {
        let reached = simulation.advance(1).unwrap();
        if reached == Reached::End {
            return ends;
        }
        // A step in vain leaves the time where it was.
        let time = simulation.time();
        if ends.last().is_none_or(|last: &(f64, bool)| last.0 < time) {
            ends.push((time, reached == Reached::Row));
        }
    }
}

#[test]
fn steps_end_at_rows_and_at_discontinuities_and_at_nothing_beyond_them() {
    let run = tumbling(plate());
    let multiples: Vec<f64> = (1..=7).map(|n| f64::from(n) * 0.07).chain([0.5]).collect();
    let discontinuities = [0.031_41, 0.031_41 + 0.073_217];
    for (method, control) in [
        (EXPONENTIAL, StepControl::Tolerance(1e-6)),
        (RKMK4, StepControl::Tolerance(1e-5)),
        (EXPONENTIAL, StepControl::Fixed(3e-3)),
        (RKMK4, StepControl::Fixed(1.1e-4)),
        (frames_rk4::LIMIT, StepControl::Fixed(1.1e-4)),
        (frames_rk4::PAPER, StepControl::Fixed(1.1e-4)),
    ] {
        let ends = ends(&run, method, control, Rows::Interval(0.07));
        let rows: Vec<f64> = ends.iter().filter(|end| end.1).map(|end| end.0).collect();
        assert_eq!(rows, multiples, "{method:?}");
        for discontinuity in discontinuities {
            assert!(ends.iter().any(|end| end.0 == discontinuity), "{method:?} {discontinuity}");
        }
        let lengths = ends.windows(2).map(|pair| pair[1].0 - pair[0].0);
        if let StepControl::Fixed(step) = control {
            assert!(lengths.fold(0.0, f64::max) < step * (1.0 + 1e-9), "{method:?}");
            // As few as can be: none is shorter than half of what is allowed.
            let least = (0.5 / step).ceil() as usize;
            assert!((least..least + 10).contains(&ends.len()), "{method:?}: {}", ends.len());
        }
        // With a row after a number of steps, the discontinuities are met all the same.
        let free: Vec<f64> =
            self::ends(&run, method, control, Rows::EverySteps(1000)).iter().map(|end| end.0).collect();
        assert!(
            discontinuities.iter().all(|discontinuity| free.contains(discontinuity)) && free.last() == Some(&0.5),
            "{method:?}"
        );
    }
}

#[test]
fn after_a_discontinuity_the_steps_grow_back_to_the_interval() {
    let plate = plate();
    let load = plate.pulse([-500.0, 0.0, 10.0], [1.0, 0.0, 1.0], 0.005_3, 1e-3);
    let run = Run { damping_ratio: 0.05, loads: vec![load], ..Run::free(plate, Initial::at_rest(10), 0.2) };
    let mut simulation = run.start(EXPONENTIAL, StepControl::Tolerance(1e-5), Rows::Interval(0.01));
    let mut before = 0;
    let mut steps_of_rows = Vec::new();
    while let Some(row) = simulation.next() {
        row.unwrap();
        let accepted = simulation.stats().accepted;
        steps_of_rows.push(accepted - before);
        before = accepted;
    }
    // Measured after the start: 82, 6, then two each, which is the least: a try is two steps.
    assert!(steps_of_rows[1] > 10 && steps_of_rows[3..].iter().all(|steps| *steps == 2), "{steps_of_rows:?}");
}

#[test]
fn fixed_steps_cost_four_evaluations_each() {
    let run = tumbling(plate());
    for method in METHODS {
        let mut simulation = run.start(method, StepControl::Fixed(1e-4), Rows::Interval(0.1));
        assert_eq!(simulation.by_ref().count(), 6);
        let stats = simulation.stats();
        assert_eq!(stats.evaluations, u64::from(method.evaluations_per_step) * stats.accepted);
        // The two discontinuities cost a step each.
        assert_eq!((stats.accepted, stats.rejected), (5002, 0));
        assert!(stats.longest <= 1e-4 * (1.0 + 1e-9) && stats.shortest > 0.9e-4, "{stats:?}");
    }
}

/// Conserved: the same bits with and without rows.
#[test]
fn rows_change_no_bit_of_the_motion() {
    let mut run = tumbling(plate());
    run.end = 0.1;
    for (method, control) in [
        (EXPONENTIAL, StepControl::Fixed(1e-4)),
        (RKMK4, StepControl::Fixed(1e-5)),
        (EXPONENTIAL, StepControl::Tolerance(1e-6)),
    ] {
        let end = |look: bool| {
            let mut simulation = run.start(method, control, Rows::EverySteps(1));
            let mut seen = simulation.observation().unwrap();
            while simulation.advance(u64::MAX).unwrap() != Reached::End {
                if look {
                    simulation.observe([&mut seen]).unwrap();
                }
            }
            (simulation.observation().unwrap(), simulation.stats())
        };
        assert_eq!(end(true), end(false), "{method:?}");
    }
}
