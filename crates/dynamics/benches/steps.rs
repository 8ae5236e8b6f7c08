//! Steps a second of every scheme on one core, for the paper's plate with no, ten and forty flexible modes.
//!
//! `cargo bench -p dynamics --bench steps`. The plate tumbles at 10 rad/s and vibrates, as in the table of
//! `docs/evidence/accuracy.md`; the time is that of the loop alone, the shortest of several runs.

#[allow(dead_code)]
#[path = "../tests/common/mod.rs"]
mod common;

use std::time::{Duration, Instant};

use dynamics::{Initial, Method, Physics, Reached, Rows, Setup, Simulation, StepControl};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

const MODES: [usize; 3] = [0, 10, 40];
const STEP: f64 = 1e-4;
const STEPS: u64 = 10_000;
const RUNS: usize = 7;

fn main() {
    let plate = common::plate_of("plate", 40);
    let bodies = MODES.map(|flexible| plate.body.truncated(flexible));
    println!("steps per second on one core, best of {RUNS} runs of {STEPS} steps; in brackets evaluations a step\n");
    print!("{:<28}", "flexible modes");
    MODES.iter().for_each(|flexible| print!("{flexible:>17}"));
    println!();
    for method in common::METHODS {
        let control = StepControl::Fixed(STEP);
        print!("{:<28}", format!("{}, {}", method.formulation, method.scheme));
        for body in &bodies {
            let (rate, evaluations) = measure(body, method, control);
            print!("{:>17}", format!("{rate:.0} ({evaluations:.1})"));
        }
        println!();
    }
    println!("\nunder step control (tolerance 1e-6)");
    for method in common::METHODS.into_iter().filter(|method| method.estimates_error) {
        print!("{:<28}", format!("{}, {}", method.formulation, method.scheme));
        for body in &bodies {
            let (rate, evaluations) = measure(body, method, StepControl::Tolerance(1e-6));
            print!("{:>17}", format!("{rate:.0} ({evaluations:.1})"));
        }
        println!();
    }
}

/// Steps a second, and evaluations a step.
fn measure(body: &ReducedBody, method: Method, control: StepControl) -> (f64, f64) {
    let mut initial = Initial::at_rest(body.flexible());
    initial.omega = Vector3::new(3.0, 8.0, 5.0);
    initial.velocity = Vector3::new(100.0, 0.0, 0.0);
    for (rate, value) in initial.modal_velocity.iter_mut().zip([77.0, -54.0, 117.0, 37.0]) {
        *rate = value;
    }
    let reference_points = [[-500.0, -25.0, -5.0], [500.0, -25.0, -5.0], [500.0, 25.0, -5.0]].map(Vector3::from);
    let paper = frames_rk4::Paper { reference_points };
    let simulation = Simulation::new(&Setup {
        physics: &Physics::default(),
        body,
        damping_ratios: &vec![0.0; body.flexible()],
        loads: &[],
        initial: &initial,
        method: paper.or(&method),
        control,
        end: STEPS as f64 * STEP,
        rows: Rows::EverySteps(u64::MAX),
        points: &[],
    })
    .expect("the motion starts");
    let mut shortest = Duration::MAX;
    let mut stats = simulation.stats();
    for _ in 0..RUNS {
        let mut simulation = simulation.clone();
        let started = Instant::now();
        while simulation.advance(u64::MAX).expect("every step succeeds") != Reached::End {}
        shortest = shortest.min(started.elapsed());
        stats = simulation.stats();
    }
    let steps = stats.accepted as f64;
    (steps / shortest.as_secs_f64(), stats.evaluations as f64 / steps)
}
