//! Frequency responses of points by sums of modes, with their rates: Eq. (D11) of `docs/method/gradients.md`.

use std::f64::consts::TAU;

use faer::c64;
use model::{BodyRates, ParameterRates, Residues};
use nalgebra::Vector3;
use scene::Damping;

use super::damping::Damped;

/// Names of the axes.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// The response of a displacement of a point to the factor on a load, by the modes that are kept.
#[derive(Debug, Clone)]
pub(crate) struct ResponseReport {
    /// The load.
    pub input: String,
    /// The displacement, such as tip.displacement.y.
    pub output: String,
    /// Real and imaginary part at each frequency.
    pub values: Vec<[f64; 2]>,
}

/// The responses of a body, by load, then point, then axis.
pub(super) fn responses(
    found: &BodyRates,
    [loads, points]: [&[String]; 2],
    damping: &Damping,
    frequencies: &[f64],
) -> Vec<ResponseReport> {
    let modes = Damped::modes(&found.frequencies, damping);
    let mut reports = Vec::new();
    for (load, forces) in loads.iter().zip(&found.modal_forces) {
        for (p, point) in points.iter().enumerate() {
            for (axis, name) in AXES.iter().enumerate() {
                let at = |frequency: &f64| -> c64 {
                    let terms = modes.iter().enumerate().map(|(k, mode)| {
                        c64::new(found.shapes[k][p][axis] * forces[k], 0.0) / mode.stiffness(*frequency)
                    });
                    terms.sum()
                };
                reports.push(ResponseReport {
                    input: load.clone(),
                    output: format!("{point}.displacement.{name}"),
                    values: frequencies.iter().map(at).map(|value| [value.re, value.im]).collect(),
                });
            }
        }
    }
    reports
}

/// Rates of the same; none of a load whose forces have no known rates.
pub(super) fn rates(
    found: &BodyRates,
    of: &ParameterRates,
    points: usize,
    damping: &Damping,
    frequencies: &[f64],
) -> Vec<Option<Vec<[f64; 2]>>> {
    let modes = Damped::modes(&found.frequencies, damping);
    let of_output = |residues: &Residues, p: usize, axis: usize| {
        let at = |frequency: &f64| -> c64 {
            let terms = modes.iter().enumerate().map(|(k, mode)| {
                let of_point = |list: &[Vec<Vector3<f64>>]| c64::new(list[k][p][axis], 0.0);
                let stiffness = mode.stiffness(*frequency);
                let rate = mode.stiffness_rate(*frequency, of.eigenvalues[k]);
                of_point(&residues.rates) / stiffness - of_point(&residues.values) * rate / (stiffness * stiffness)
            });
            terms.sum()
        };
        frequencies.iter().map(at).map(|value| [value.re, value.im]).collect()
    };
    let outputs = || (0..points).flat_map(|p| (0..AXES.len()).map(move |axis| (p, axis)));
    let of_load = |residues: &Option<Residues>| -> Vec<Option<Vec<[f64; 2]>>> {
        outputs().map(|(p, axis)| residues.as_ref().map(|residues| of_output(residues, p, axis))).collect()
    };
    of.residues.iter().flat_map(of_load).collect()
}

impl Damped {
    /// λ − ω² + iω·2ζ√λ.
    fn stiffness(&self, frequency: f64) -> c64 {
        let omega = TAU * frequency;
        c64::new(self.omega * self.omega - omega * omega, omega * self.damping)
    }

    /// Its rate, by that of λ.
    fn stiffness_rate(&self, frequency: f64, rate: f64) -> c64 {
        c64::new(rate, TAU * frequency * self.slope * rate / (2.0 * self.omega))
    }
}
