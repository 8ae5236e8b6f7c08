//! An own scheme: the explicit midpoint rule.

use dynamics::{Abilities, Beginning, Equations, Evaluation, Method, Scheme, Step, StepError, StepLimit};

/// The rule, with room for its second stage.
#[derive(Debug, Clone)]
pub struct Midpoint<E: Equations>(E::Evaluation);

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

/// The conservative form by the midpoint rule.
pub const MIDPOINT: Method = Method {
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

#[cfg(test)]
mod tests {
    use dynamics::nalgebra::{Matrix3, Vector3};
    use dynamics::{Initial, Simulation, StepControl};
    use reduced_body::{ReducedBody, RigidMotion};

    use super::*;

    /// Independent reference: the exponential scheme; the error of a tumbling body falls with the square of the step.
    #[test]
    fn it_is_of_second_order() {
        let inertia = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 3.0));
        let top = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
        let spinning = Initial { omega: Vector3::new(0.3, 2.0, 0.1), ..Initial::at_rest(0) };
        let end = |method: Method, step: f64| {
            let run = Simulation::builder(&top, StepControl::Fixed(step), 2.0).initial(spinning.clone());
            run.method(method).build().unwrap().last().unwrap().unwrap().attitude
        };
        let exact = end(Method::EXPONENTIAL, 1e-3);
        let [coarse, fine] = [0.02, 0.01].map(|step| end(MIDPOINT, step).angle_to(&exact));
        let order = (coarse / fine).log2();
        assert!((1.9..2.1).contains(&order), "{order}");
    }
}
