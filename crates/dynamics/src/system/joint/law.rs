//! Forces along the coordinates of joints by laws from outside: controllers, motors, nonlinear springs.

use std::fmt;

/// A law for the force along the slide of a joint, or the moment about its turn; positive on the second marker along the
/// coordinate. What it does is the work of the joint's drive.
pub trait JointLaw: fmt::Debug + Send + Sync {
    /// The force at a coordinate and its rate, at the time `times[0]`; laws with branches are taken as they are at `times[1]`.
    fn force(&self, times: [f64; 2], coordinate_and_rate: [f64; 2]) -> f64;

    /// How much the force falls with the coordinate and with its rate, neither negative. It need not be exact: it is for Newton's
    /// method. By default from differences of the force.
    fn stiffness_and_damping(&self, times: [f64; 2], [x, rate]: [f64; 2]) -> [f64; 2] {
        let slope = |at: &dyn Fn(f64) -> [f64; 2], around: f64| {
            let small = DIFFERENCE * around.abs().max(1.0);
            let [below, above] = [-small, small].map(|by| self.force(times, at(around + by)));
            ((below - above) / (2.0 * small)).max(0.0)
        };
        [slope(&|x| [x, rate], x), slope(&|rate| [x, rate], rate)]
    }

    /// A continuous function that changes its sign where the law has a kink or a jump: a gap that closes, a limit that is reached. Under
    /// step control steps end there. Without one, the work of the law shows that there is something, and steps grow short.
    fn switch(&self, times: [f64; 2], coordinate_and_rate: [f64; 2]) -> Option<f64> {
        let _ = (times, coordinate_and_rate);
        None
    }

    /// Times at which the law or one of its rates jumps, rising. Steps end there.
    fn discontinuities(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// Differences of coordinates and rates, relative to these or to 1.
const DIFFERENCE: f64 = 1e-6;

/// A law from a closure of the time, the coordinate and its rate.
///
/// ```
/// use dynamics::JointLawFn;
///
/// // A controller that holds an angle.
/// let law = JointLawFn::new("PD", |_time, angle, rate| 40.0 * (0.5 - angle) - 3.0 * rate);
/// ```
pub struct JointLawFn<F> {
    name: String,
    discontinuities: Vec<f64>,
    switch: Option<Box<Switch>>,
    law: F,
}

/// A function of the time, the coordinate and its rate.
type Switch = dyn Fn(f64, f64, f64) -> f64 + Send + Sync;

impl<F: Fn(f64, f64, f64) -> f64 + Send + Sync> JointLawFn<F> {
    /// A law with a name for messages.
    pub fn new(name: impl Into<String>, law: F) -> Self {
        Self { name: name.into(), discontinuities: Vec::new(), switch: None, law }
    }

    /// Names the times at which the law or one of its rates jumps, so that steps end there.
    #[must_use]
    pub fn with_discontinuities(mut self, discontinuities: Vec<f64>) -> Self {
        self.discontinuities = discontinuities;
        self
    }

    /// Names a function that changes its sign where the law has a kink: see [`JointLaw::switch`].
    #[must_use]
    pub fn with_switch(mut self, switch: impl Fn(f64, f64, f64) -> f64 + Send + Sync + 'static) -> Self {
        self.switch = Some(Box::new(switch));
        self
    }
}

impl<F: Fn(f64, f64, f64) -> f64 + Send + Sync> JointLaw for JointLawFn<F> {
    fn force(&self, [time, _]: [f64; 2], [x, rate]: [f64; 2]) -> f64 {
        (self.law)(time, x, rate)
    }

    fn switch(&self, [time, _]: [f64; 2], [x, rate]: [f64; 2]) -> Option<f64> {
        self.switch.as_ref().map(|switch| switch(time, x, rate))
    }

    fn discontinuities(&self) -> Vec<f64> {
        self.discontinuities.clone()
    }
}

impl<F> fmt::Debug for JointLawFn<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JointLawFn").field("name", &self.name).finish_non_exhaustive()
    }
}
