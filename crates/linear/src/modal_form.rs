//! Coordinates that are coupled, as sums over their complex modes.
//!
//! ```text
//! x' = A x + B u,  A V = V Λ:    y = Σ_k c_k g_k / (iω − λ_k) + D u       c_k = C v_k,  g_k = row k of V⁻¹ B
//! ```

use faer::linalg::solvers::Solve;
use faer::{Mat, c64};

use crate::rows::Rows;
use crate::second_order::{Damping, SecondOrder};
use crate::values::Values;

/// Parts of A, relative to the fastest rate, by which V Λ V⁻¹ may miss it.
const MISSED: f64 = 1e-12;

/// Coordinates that are coupled.
pub(crate) enum Coupled {
    /// Their complex modes.
    Modes(Modes),
    /// Their numbers: the dynamic stiffness is factored at each frequency.
    Factored(Vec<usize>, Damping),
}

/// Complex modes.
pub(crate) struct Modes {
    poles: Vec<c64>,
    /// Outputs of a unit of each mode: real and imaginary parts, outputs of a mode one after another.
    seen: [Vec<f64>; 2],
    /// Force on each mode of a unit input, inputs of a mode one after another.
    forced: Vec<c64>,
    /// R₂ B of the coordinates, outputs of an input one after another.
    direct: Vec<f64>,
}

impl Coupled {
    /// Some coordinates of these equations.
    pub fn new(equations: &SecondOrder, rows: &Rows, together: Vec<usize>, damping: Damping) -> Self {
        let modes = (damping == Damping::OfEquations).then(|| Modes::new(equations, rows, &together)).flatten();
        modes.map_or(Self::Factored(together, damping), Self::Modes)
    }

    /// Adds the responses at a circular frequency.
    pub fn add_to(&self, equations: &SecondOrder, rows: &Rows, omega: f64, values: &mut Values) {
        let m = equations.inputs.len();
        match self {
            Self::Modes(modes) => {
                let p = rows.outputs;
                for (k, pole) in modes.poles.iter().enumerate() {
                    let (own, rate) = (k * p..(k + 1) * p, c64::new(0.0, omega) - pole);
                    let seen = modes.seen.each_ref().map(|part| &part[own.clone()]);
                    values.add_mode(seen, |j| modes.forced[k * m + j] / rate);
                }
                values.add_direct(&modes.direct);
            }
            Self::Factored(together, damping) if !together.is_empty() => {
                let c = together.len();
                let at = |i: usize, j: usize| equations.dynamic_stiffness([together[i], together[j]], omega, *damping);
                let forces = Mat::from_fn(c, m, |i, j| c64::new(equations.forces[(together[i], j)], 0.0));
                let motion = Mat::from_fn(c, c, at).partial_piv_lu().solve(forces);
                for (i, k) in together.iter().enumerate() {
                    values.add_coordinate(rows, *k, omega, |j| motion[(i, j)]);
                }
            }
            Self::Factored(..) => {}
        }
    }
}

impl Modes {
    /// None where there is no coordinate, or where the modes do not make up A.
    fn new(equations: &SecondOrder, rows: &Rows, together: &[usize]) -> Option<Self> {
        let n = together.len();
        if n == 0 {
            return None;
        }
        // With x = s η and y = η̇ all entries are rates.
        let scale = |k: &usize| equations.stiffness[(*k, *k)].abs().sqrt().max(equations.damping[(*k, *k)].abs());
        let scales: Vec<f64> = together.iter().map(scale).collect();
        let largest = scales.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return None;
        }
        let scales: Vec<f64> = scales.into_iter().map(|s| if s > 0.0 { s } else { largest }).collect();
        let a = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, false) if i == j - n => scales[i],
            (true, _) => 0.0,
            (false, true) => -equations.stiffness[(together[i - n], together[j])] / scales[j],
            (false, false) => -equations.damping[(together[i - n], together[j - n])],
        });
        let eigen = a.eigen().ok()?;
        let poles: Vec<c64> = eigen.S().column_vector().iter().copied().collect();
        let vectors = eigen.U().to_owned();
        let lu = vectors.partial_piv_lu();
        let m = equations.inputs.len();
        let of_inputs = |i: usize, j: usize| if i < n { 0.0 } else { equations.forces[(together[i - n], j)] };
        let forced = lu.solve(Mat::from_fn(2 * n, m, |i, j| c64::new(of_inputs(i, j), 0.0)));
        let made = &vectors
            * Mat::from_fn(2 * n, 2 * n, |i, j| if i == j { poles[i] } else { c64::new(0.0, 0.0) })
            * lu.solve(Mat::<c64>::identity(2 * n, 2 * n));
        let fastest = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
        let missed = |i: usize, j: usize| (made[(i, j)] - a[(i, j)]).norm();
        let is_whole = (0..2 * n).all(|i| (0..2 * n).all(|j| missed(i, j) <= MISSED * (2 * n) as f64 * fastest));
        if !is_whole {
            return None;
        }
        let p = rows.outputs;
        let mut seen = [Vec::with_capacity(2 * n * p), Vec::with_capacity(2 * n * p)];
        for (k, pole) in poles.iter().enumerate() {
            let mut of_mode = vec![c64::new(0.0, 0.0); p];
            for (c, coordinate) in together.iter().enumerate() {
                let [place, velocity, acceleration] = rows.of_coordinate(*coordinate);
                // η̇ as the state has it: that of η times the pole is the same but for rounding.
                let (eta, rate) = (vectors[(c, k)] / scales[c], vectors[(n + c, k)]);
                for (i, sum) in of_mode.iter_mut().enumerate() {
                    *sum += eta * place[i] + rate * velocity[i] + rate * *pole * acceleration[i];
                }
            }
            seen[0].extend(of_mode.iter().map(|x| x.re));
            seen[1].extend(of_mode.iter().map(|x| x.im));
        }
        let direct = |j: usize, i: usize| -> f64 {
            together.iter().map(|k| rows.of_coordinate(*k)[2][i] * equations.forces[(*k, j)]).sum()
        };
        let direct: Vec<f64> = (0..m).flat_map(|j| (0..p).map(move |i| (j, i))).map(|(j, i)| direct(j, i)).collect();
        let forced = (0..2 * n).flat_map(|k| (0..m).map(move |j| (k, j))).map(|(k, j)| forced[(k, j)]).collect();
        Some(Self { poles, seen, forced, direct })
    }
}
