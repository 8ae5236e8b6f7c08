//! A run is the same, bit for bit, whatever rows are read off it, and these cost no evaluation of loads that last.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use dynamics::{
    Applied, Expression, History, Key, Kinematics, Load, LoadFn, PointForce, Reached, Rows, SharedLoad, Signal,
    StepControl, Table,
};
use nalgebra::Vector3;

use crate::common::plate;
use crate::run::{EXPONENTIAL, RKMK4, Run};

const END: f64 = 0.01;

fn run(load: SharedLoad) -> Run<'static> {
    let plate = plate();
    let initial = plate.spinning(Vector3::new(3.0, -2.0, 5.0));
    let points = vec![plate.point([500.0, 0.0, 10.0])];
    Run { damping_ratio: 0.02, loads: vec![load], points, ..Run::free(plate, initial, END) }
}

fn force(history: History) -> PointForce {
    PointForce::dead(plate().point([-500.0, 0.0, 10.0]), Vector3::new(20.0, 10.0, 30.0), history)
}

/// A force by a signal that nobody tells the run of.
fn by_signal(signal: &Signal) -> SharedLoad {
    let (point, signal) = (plate().point([500.0, 0.0, 10.0]), signal.clone());
    Arc::new(LoadFn::new("signal", move |motion, applied| {
        applied.force(&point, &(motion.body_from_global * Vector3::new(0.0, 5.0, 20.0) * signal.at(motion.time)));
    }))
}

/// Conserved: the same bits with and without rows.
#[test]
fn rows_leave_every_bit_of_a_run_as_it_is() {
    // Discontinuities that fall on ends of steps, and between them.
    let table = Table::new(vec![0.0, 0.002, 0.00501, 0.008], vec![0.5, 0.5, -1.0, 0.3]).unwrap();
    let formula = Expression::new("cos(300*t) + sign(t - 0.004)", vec![0.004]).unwrap();
    let signal = Signal::held(0.0);
    let loads: [SharedLoad; 5] = [
        Arc::new(force(History::Step { at: 0.003 })),
        Arc::new(force(History::Ramp { start: 0.002, duration: 0.00301 })),
        Arc::new(force(History::Table(table))),
        Arc::new(force(History::Expression(formula))),
        by_signal(&signal),
    ];
    for load in loads {
        let run = run(load);
        for method in [EXPONENTIAL, RKMK4] {
            for control in [StepControl::Fixed(1e-5), StepControl::Tolerance(1e-7)] {
                let end = |with_rows: bool| {
                    signal.hold(0.0);
                    let mut simulation = run.start(method, control, Rows::EverySteps(1));
                    while simulation.advance(u64::MAX).unwrap() != Reached::End {
                        if with_rows {
                            simulation.observation().unwrap();
                        }
                        if matches!(control, StepControl::Fixed(_)) {
                            signal.hold(100.0 * simulation.time());
                        }
                    }
                    (simulation.states().unwrap(), simulation.stats(), simulation.energies(0).exchanged.to_bits())
                };
                assert_eq!(end(true), end(false), "{:?} {method:?} {control:?}", run.loads);
            }
        }
    }
}

/// Counts how often it acts.
#[derive(Debug)]
struct Counted {
    force: PointForce,
    count: Arc<AtomicU64>,
    lasts: bool,
}

impl Load for Counted {
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.force.apply(motion, applied);
    }

    fn key(&self, key: Key) -> Key {
        self.force.key(key)
    }

    fn is_same(&self, time: f64, branch_times: [f64; 2]) -> bool {
        self.lasts && self.force.is_same(time, branch_times)
    }
}

#[test]
fn a_row_shares_its_evaluation_with_the_next_step_where_loads_last() {
    for (lasts, of_row) in [(true, 0), (false, 1)] {
        let count = Arc::new(AtomicU64::new(0));
        let load = Counted { force: force(History::Constant), count: count.clone(), lasts };
        let mut simulation = run(Arc::new(load)).start(EXPONENTIAL, StepControl::Fixed(1e-5), Rows::EverySteps(1));
        simulation.observation().unwrap();
        let before = count.load(Ordering::Relaxed);
        let mut rows = 0;
        while simulation.advance(u64::MAX).unwrap() == Reached::Row {
            simulation.observation().unwrap();
            rows += 1;
        }
        assert!(rows >= 1000, "{rows}");
        assert_eq!(count.load(Ordering::Relaxed) - before, rows * (4 + of_row));
    }
}
