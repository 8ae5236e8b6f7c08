//! A motion that begins.

use crate::equations::Equations;
use crate::motion::stepper::Stepper;
use crate::scheme::Scheme;
use crate::simulation::plan::StepControl;
use crate::simulation::setup::{Beginning, Setup};
use crate::state::State;

impl Beginning {
    /// The motion of equations by a scheme, from a state.
    pub fn new<E: Equations, S: Scheme<E>>(setup: &Setup, equations: E, scheme: S, start: State) -> Self {
        let is_needed = setup.may_miss_work(equations.fastest_rate());
        let energy_of_loads = if is_needed { equations.sizes_of_loads(setup.end).energy } else { 0.0 };
        let motion = Stepper::new(equations, scheme, start);
        let motion = match setup.control {
            StepControl::Tolerance(_) => motion.measuring_errors(setup.end),
            StepControl::Fixed(_) => motion,
        };
        Self { motion: Box::new(motion), energy_of_loads }
    }
}
