//! An own scheme: the explicit midpoint rule, against the library's exponential scheme.
//!
//! `y₁ = y₀ + h f(t + h/2, y₀ + h/2 f(t, y₀))` on the list of a state; the attitude turns by the rotation vector of the step. The
//! rule is of second order: with half the step the difference falls to a quarter. A run takes it like any other method, with
//! step control, events and checkpoints.

use std::error::Error;

use flexframe::dynamics::{
    Abilities, Beginning, Equations, Evaluation, Initial, Method, Observation, Scheme, Simulation, Step, StepControl,
    StepError, StepLimit,
};
use flexframe::model::Model;
use flexframe::nalgebra::Vector3;
use flexframe::scene::Body;

/// The midpoint rule, with room for its second stage.
#[derive(Debug, Clone)]
struct Midpoint<E: Equations>(E::Evaluation);

impl<E: Equations> Scheme<E> for Midpoint<E> {
    const ORDER: u32 = 2;

    fn step(&mut self, step: &mut Step<'_, E>, next: &mut [f64]) -> Result<(), StepError> {
        let h = step.length;
        step.add_to(0.5 * h, step.first.rates(), self.0.place_mut());
        step.evaluate(step.from.time + 0.5 * h, &mut self.0)?;
        step.add_to(h, self.0.rates(), next);
        Ok(())
    }
}

/// The conservative form by the midpoint rule. Undamped, it needs shorter steps than the limit of Runge–Kutta 4.
const MIDPOINT: Method = Method {
    formulation: "conservative",
    scheme: "midpoint",
    order: 2,
    evaluations_per_step: 2,
    limit: StepLimit::Modes,
    estimates_error: true,
    abilities: Abilities::ALL,
    joints: None,
    begin: |setup| Beginning::conservative(setup, |body| Midpoint(body.evaluation())),
};

/// Differences of the attitude in rad after the run: with steps of 4e-5 s and of 2e-5 s, and under step control at 1e-6.
pub fn run() -> Result<[f64; 3], Box<dyn Error>> {
    let scene = Body::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/plate.toml"))?;
    let model = Model::build(&scene, |_| ())?;
    let body = model.body.truncated(4);
    let mut initial = Initial::at_rest(4);
    initial.omega = Vector3::new(3.0, 8.0, 5.0);
    initial.modal_velocity = vec![77.0, -54.0, 117.0, 37.0];
    let last = |method: Method, control: StepControl| -> Result<Observation, Box<dyn Error>> {
        let builder = Simulation::builder(&body, control, 0.02).damping_ratio(0.01).initial(initial.clone());
        Ok(builder.method(method).build()?.last().ok_or("the run has no rows")??)
    };
    let exact = last(Method::EXPONENTIAL, StepControl::Fixed(1e-5))?.attitude;
    let difference =
        |control| -> Result<f64, Box<dyn Error>> { Ok(last(MIDPOINT, control)?.attitude.angle_to(&exact)) };
    Ok([
        difference(StepControl::Fixed(4e-5))?,
        difference(StepControl::Fixed(2e-5))?,
        difference(StepControl::Tolerance(1e-6))?,
    ])
}

#[allow(dead_code)] // a test runs the example as a module
fn main() -> Result<(), Box<dyn Error>> {
    let [coarse, fine, controlled] = run()?;
    println!("attitude off by {coarse:.2e} rad with steps of 4e-5 s, by {fine:.2e} rad with half of them");
    println!("ratio {:.3}: second order; {controlled:.2e} rad at a tolerance of 1e-6", coarse / fine);
    Ok(())
}
