//! Least squares by steps of Gauss and Newton, damped as Levenberg and Marquardt do where a step fails: Eqs. (D12)–(D14) of
//! `docs/method/gradients.md`. The steps come from the singular values of the Jacobian (faer).

use faer::Mat;

/// Most steps.
const MAX_STEPS: usize = 100;
/// Largest change of a coordinate in a step.
const STRIDE: f64 = 1.0;
/// A step below this changes nothing that counts.
const STILL: f64 = 1e-10;
/// A step below this that does not lower the sum of squares has met its rounding.
const ROUNDING: f64 = 1e-6;
/// A singular value below this part of the largest is rounding.
const SINGULAR: f64 = 1e-8;
/// A parameter that changes no frequency by more, relative to the parameter, has no influence.
const INFLUENCE: f64 = 1e-9;
/// A part of a direction from which a parameter belongs to it.
const BELONGS: f64 = 0.05;

/// Differences from measured frequencies in units of their deviations, and their rates.
pub(super) struct Residuals {
    /// The differences.
    pub values: Vec<f64>,
    /// Rates with the coordinates (m×n).
    pub jacobian: Mat<f64>,
    /// Deviations relative to the frequencies.
    pub relative: Vec<f64>,
    /// The frequencies.
    pub frequencies: Vec<f64>,
    /// The modes that were measured, from 0.
    pub modes: Vec<usize>,
}

/// The least sum of squares.
pub(super) struct Solution {
    pub x: Vec<f64>,
    /// Frequencies at the start.
    pub first: Vec<f64>,
    /// Residuals at the end.
    pub last: Residuals,
    pub iterations: usize,
    /// Singular values of the Jacobian at the end, largest first, and their right vectors (n×n).
    pub singular: Vec<f64>,
    pub right: Mat<f64>,
}

/// No solution; E is the error of residuals that cannot be found.
pub(super) enum Fault<E> {
    /// The residuals cannot be found.
    Residuals(E),
    /// The coordinates cannot be found.
    Coordinates(Unseen),
}

/// Coordinates that cannot be found.
pub(super) enum Unseen {
    /// One without influence.
    NoInfluence(usize),
    /// One that has lost its influence on the way.
    Gone(usize),
    /// Coordinates that go together without a change of the residuals, with their parts.
    Apart(Vec<(usize, f64)>),
    /// No end of the search.
    Steps(usize),
}

impl<E> From<Unseen> for Fault<E> {
    fn from(unseen: Unseen) -> Self {
        Self::Coordinates(unseen)
    }
}

/// Finds the least sum of squares from a start; coordinates stay within limits.
pub(super) fn solve<E>(
    start: &[f64],
    mut residuals: impl FnMut(&[f64]) -> Result<Residuals, E>,
    is_within: impl Fn(&[f64]) -> bool,
) -> Result<Solution, Fault<E>> {
    let mut residuals = |x: &[f64]| residuals(x).map_err(Fault::Residuals);
    let mut x = start.to_vec();
    let mut here = residuals(&x)?;
    let first = here.frequencies.clone();
    let mut damping = 0.0;
    for iterations in 0..MAX_STEPS {
        let Directions { singular, right, along } = directions(&here).map_err(|unseen| match unseen {
            Unseen::NoInfluence(j) if iterations > 0 => Unseen::Gone(j),
            unseen => unseen,
        })?;
        let mut step = vec![0.0; x.len()];
        for (k, s) in singular.iter().enumerate() {
            let part = -along[k] * s / (s * s + damping * singular[0] * singular[0]);
            step.iter_mut().enumerate().for_each(|(i, step)| *step += part * right[(i, k)]);
        }
        let size = |step: &[f64]| step.iter().map(|step| step.abs()).fold(0.0, f64::max);
        let stride = (STRIDE / size(&step)).min(1.0);
        let moved = |part: f64| -> Vec<f64> { x.iter().zip(&step).map(|(x, step)| x + part * step).collect() };
        let mut part = stride;
        while !is_within(&moved(part)) && part > ROUNDING {
            part *= 0.5;
        }
        let next_x = moved(part);
        let next = residuals(&next_x)?;
        let is_lower = square(&next) < square(&here);
        let is_still = part * size(&step) < STILL;
        if is_still || (!is_lower && part * size(&step) < ROUNDING) {
            return Ok(Solution { x, first, last: here, iterations: iterations + 1, singular, right });
        }
        if is_lower {
            (x, here) = (next_x, next);
            damping = if damping < 1e-8 { 0.0 } else { 0.1 * damping };
        } else {
            damping = (10.0 * damping).max(1e-4);
        }
    }
    Err(Unseen::Steps(MAX_STEPS).into())
}

fn square(residuals: &Residuals) -> f64 {
    residuals.values.iter().map(|r| r * r).sum()
}

/// Singular values of the Jacobian with their right vectors, and the parts of the residuals along the left ones.
struct Directions {
    singular: Vec<f64>,
    right: Mat<f64>,
    along: Vec<f64>,
}

fn directions(here: &Residuals) -> Result<Directions, Unseen> {
    let (rows, columns) = (here.jacobian.nrows(), here.jacobian.ncols());
    let influence = |j: usize| (0..rows).map(|i| (here.jacobian[(i, j)] * here.relative[i]).abs()).fold(0.0, f64::max);
    if let Some(j) = (0..columns).find(|j| influence(*j) <= INFLUENCE) {
        return Err(Unseen::NoInfluence(j));
    }
    let svd = here.jacobian.thin_svd().map_err(|_| Unseen::Steps(0))?;
    let singular: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let right = svd.V().to_owned();
    if let Some(k) = singular.iter().position(|s| *s <= SINGULAR * singular[0]) {
        let of = |j: usize| right[(j, k)];
        let most = (0..columns).map(of).fold(0.0, |most: f64, part| if part.abs() > most.abs() { part } else { most });
        let parts = (0..columns).map(|j| (j, of(j) / most)).filter(|(_, part)| part.abs() > BELONGS);
        return Err(Unseen::Apart(parts.collect()));
    }
    let along = (0..columns).map(|k| (0..rows).map(|i| svd.U()[(i, k)] * here.values[i]).sum()).collect();
    Ok(Directions { singular, right, along })
}
