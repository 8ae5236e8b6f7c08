//! A load from a closure.

use std::fmt;

use keys::Key;

use super::{Applied, Kinematics, Load};

/// A load from a closure that sees the motion and adds what it does.
///
/// ```
/// use dynamics::{LoadFn, PointShapes};
/// use nalgebra::Vector3;
///
/// /// A viscous damper between a point of the body and the ground.
/// fn damper(point: PointShapes, coefficient: f64) -> LoadFn<impl Fn(&dynamics::Kinematics, &mut dynamics::Applied)> {
///     LoadFn::new("damper", move |motion, applied| {
///         let force_global: Vector3<f64> = -coefficient * motion.velocity_global(&point);
///         applied.force(&point, &(motion.body_from_global * force_global));
///     })
/// }
/// ```
pub struct LoadFn<F> {
    name: String,
    discontinuities: Vec<f64>,
    longest_step: f64,
    law: F,
}

impl<F> LoadFn<F>
where
    F: Fn(&Kinematics, &mut Applied) + Send + Sync + 'static,
{
    /// A load with a name for messages, and its law.
    pub fn new(name: impl Into<String>, law: F) -> Self {
        Self { name: name.into(), discontinuities: Vec::new(), longest_step: f64::INFINITY, law }
    }

    /// Names the times at which the law or one of its rates jumps, so that steps end there.
    #[must_use]
    pub fn with_discontinuities(mut self, discontinuities: Vec<f64>) -> Self {
        self.discontinuities = discontinuities;
        self.discontinuities.sort_by(f64::total_cmp);
        self
    }

    /// Names the longest step that sees the law as it is.
    #[must_use]
    pub fn with_longest_step(mut self, longest_step: f64) -> Self {
        self.longest_step = longest_step;
        self
    }
}

impl<F> Load for LoadFn<F>
where
    F: Fn(&Kinematics, &mut Applied) + Send + Sync + 'static,
{
    fn apply(&self, motion: &Kinematics, applied: &mut Applied) {
        (self.law)(motion, applied);
    }

    fn key(&self, key: Key) -> Key {
        let Self { name, discontinuities, longest_step, law: _ } = self;
        let key = key.of("closure", 1).with("name", name.as_str()).with("discontinuities", discontinuities);
        key.with("longest step", longest_step)
    }

    fn discontinuities(&self) -> Vec<f64> {
        self.discontinuities.clone()
    }

    fn longest_step(&self, _branch_time: f64) -> f64 {
        self.longest_step
    }
}

impl<F> fmt::Debug for LoadFn<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, discontinuities, longest_step, .. } = self;
        f.debug_struct("LoadFn")
            .field("name", name)
            .field("discontinuities", discontinuities)
            .field("longest_step", longest_step)
            .finish_non_exhaustive()
    }
}
