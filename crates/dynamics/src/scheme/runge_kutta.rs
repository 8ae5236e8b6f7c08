//! Explicit Runge–Kutta schemes, each a table of numbers; attitudes are turned by rotation vectors (Munthe-Kaas).

use crate::equations::{Equations, Evaluation};
use crate::error::StepError;
use crate::scheme::{Scheme, Step};

/// A Butcher table of S stages, the first of which is at the start of the step.
pub trait Tableau<const S: usize>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// Order of convergence.
    const ORDER: u32;
    /// c_i, as fractions of the step.
    const TIMES: [f64; S];
    /// a_ij for j < i.
    const COEFFICIENTS: [[f64; S]; S];
    /// b_i
    const WEIGHTS: [f64; S];
}

/// Classical Runge–Kutta of order 4.
#[derive(Debug, Clone, Copy)]
pub struct Classical;

impl Tableau<4> for Classical {
    const ORDER: u32 = 4;
    const TIMES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];
    const COEFFICIENTS: [[f64; 4]; 4] = [[0.0; 4], [0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
}

/// An explicit Runge–Kutta scheme with the table `T` of `S` stages.
#[derive(Debug, Clone)]
pub struct RungeKutta<E: Equations, T, const S: usize> {
    /// The stages after the first; the last place is not used.
    stages: [E::Evaluation; S],
    table: std::marker::PhantomData<T>,
}

impl<E: Equations, T: Tableau<S>, const S: usize> RungeKutta<E, T, S> {
    /// Room for its stages.
    pub fn new(equations: &E) -> Self {
        Self { stages: std::array::from_fn(|_| equations.evaluation()), table: std::marker::PhantomData }
    }
}

impl<E: Equations, T: Tableau<S>, const S: usize> Scheme<E> for RungeKutta<E, T, S> {
    const ORDER: u32 = T::ORDER;

    fn step(&mut self, step: &mut Step<'_, E>, next: &mut [f64]) -> Result<(), StepError> {
        let (time, h) = (step.from.time, step.length);
        for i in 1..S {
            let (before, now) = self.stages.split_at_mut(i);
            let place = now[0].place_mut();
            combine(step, &T::COEFFICIENTS[i][..i], &before[1..], place);
            step.evaluate(time + T::TIMES[i] * h, &mut now[0])?;
        }
        combine(step, &T::WEIGHTS, &self.stages[1..], next);
        Ok(())
    }
}

/// out = from + h Σ factor_i · rates_i, of the first and `others`.
fn combine<E: Equations>(step: &Step<'_, E>, factors: &[f64], others: &[E::Evaluation], out: &mut [f64]) {
    let rates = std::iter::once(step.first).chain(others).map(Evaluation::rates);
    let mut terms = factors.iter().zip(rates).filter(|(factor, _)| **factor != 0.0);
    let Some((factor, rates)) = terms.next() else { return out.copy_from_slice(&step.from.values) };
    step.add_to(factor * step.length, rates, out);
    for (factor, rates) in terms {
        let factor = factor * step.length;
        out.iter_mut().zip(rates).for_each(|(out, rate)| *out += factor * rate);
    }
}
