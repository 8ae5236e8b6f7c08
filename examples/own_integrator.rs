//! The rates of the conservative form in an integrator outside the library: Störmer–Verlet is not at hand for a turning body, so
//! here is the plain midpoint rule, against the library's exponential scheme.
//!
//! The midpoint rule is of second order: with half the step the difference falls to a quarter.

use std::error::Error;

use flexframe::dynamics::{
    ConservativeBody, ConservativeRates, ConservativeState, Initial, Method, Physics, Rows, Setup, Simulation,
    StepControl,
};
use flexframe::nalgebra::Vector3;
use flexframe::scene::{Model, Scene};

/// Differences of the attitude in rad after the run, with steps of 4e-5 s and of 2e-5 s.
pub fn run() -> Result<[f64; 2], Box<dyn Error>> {
    let scene = Scene::read(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/plate.toml"))?;
    let model = Model::build(&scene, |_| ())?;
    let reduced = &model.body.truncated(4);
    let (ratios, physics) = (vec![0.01; 4], Physics::default());
    let mut initial = Initial::at_rest(4);
    initial.omega = Vector3::new(3.0, 8.0, 5.0);
    initial.modal_velocity = vec![77.0, -54.0, 117.0, 37.0];
    let end = 0.02;

    let body = ConservativeBody::new(reduced, &ratios, Vec::new(), &physics)?;
    let by_midpoint = |steps: u32| -> Result<ConservativeState, Box<dyn Error>> {
        let h = end / f64::from(steps);
        let mut state = body.start(&initial)?;
        for _ in 0..steps {
            let half = moved(&state, &body.rates(&state, state.time)?, 0.5 * h);
            state = moved(&state, &body.rates(&half, half.time)?, h);
        }
        Ok(state)
    };
    let last = Simulation::new(&Setup {
        body: reduced,
        damping_ratios: &ratios,
        loads: &[],
        physics: &physics,
        reference_points: model.reference_points,
        initial: &initial,
        method: Method::EXPONENTIAL,
        control: StepControl::Fixed(1e-5),
        end,
        rows: Rows::Interval(end),
        points: &[],
    })?
    .last()
    .ok_or("the run has no rows")??;
    let difference =
        |steps: u32| -> Result<f64, Box<dyn Error>> { Ok(by_midpoint(steps)?.attitude.angle_to(&last.attitude)) };
    Ok([difference(500)?, difference(1000)?])
}

/// A state after a time at constant rates.
fn moved(state: &ConservativeState, rates: &ConservativeRates, time: f64) -> ConservativeState {
    let mut to = state.clone();
    to.time += time;
    to.attitude = state.attitude.advanced_by(&(rates.omega_body * time));
    to.set_origin_global(&(state.origin_global() + rates.velocity_global * time));
    to.set_linear_momentum_global(&(state.linear_momentum_global() + rates.force_global * time));
    to.set_angular_momentum_body(&(state.angular_momentum_body() + rates.moment_body * time));
    for (x, rate) in to.modal_displacement.iter_mut().zip(&rates.modal_velocity) {
        *x += rate * time;
    }
    for (x, rate) in to.modal_momentum.iter_mut().zip(&rates.modal_force) {
        *x += rate * time;
    }
    to
}

#[allow(dead_code)] // a test runs the example as a module
fn main() -> Result<(), Box<dyn Error>> {
    let [coarse, fine] = run()?;
    println!("attitude off by {coarse:.2e} rad with steps of 4e-5 s, by {fine:.2e} rad with half of them");
    println!("ratio {:.3}: second order", coarse / fine);
    Ok(())
}
