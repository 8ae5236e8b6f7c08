//! The bodies of the tests of `dynamics`, and the paper's scheme on them.

#[allow(dead_code)] // the list of all schemes is for the tests there
#[path = "../../../dynamics/tests/common/mod.rs"]
mod specimen;

use dynamics::{Initial, Motion, SharedLoad, StepError};
use frames_rk4::{ModalModel, PaperScheme, State};

pub use specimen::*;

/// The paper's scheme on a body of the tests.
pub trait Synthesis {
    fn scheme(&self, damping_ratio: f64, loads: Vec<SharedLoad>, initial: &Initial, step: f64) -> Stepped;
}

impl Synthesis for Specimen {
    fn scheme(&self, damping_ratio: f64, loads: Vec<SharedLoad>, initial: &Initial, step: f64) -> Stepped {
        let ratios = vec![damping_ratio; self.body.flexible()];
        let model = ModalModel::new(&self.body, &ratios, loads).unwrap();
        let scheme = PaperScheme::new(&self.body, model, self.reference_points_body(), initial).unwrap();
        Stepped { scheme, step, done: 0 }
    }
}

/// The paper's scheme in equal steps.
#[derive(Debug, Clone)]
pub struct Stepped {
    pub scheme: PaperScheme,
    pub step: f64,
    pub done: u64,
}

impl Stepped {
    pub fn step(&mut self) -> Result<&State, StepError> {
        self.scheme.step(self.step, (self.done + 1) as f64 * self.step)?;
        self.done += 1;
        Ok(self.scheme.state())
    }

    pub fn state(&self) -> &State {
        self.scheme.state()
    }
}

/// Makes `steps` steps.
pub fn advance(scheme: &mut Stepped, steps: usize) {
    for _ in 0..steps {
        scheme.step().unwrap();
    }
}
