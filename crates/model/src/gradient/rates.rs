//! Numbers of a body with their rates, as plain data.

use std::ops::Range;

use nalgebra::Vector3;

/// Translations of a base along the axes of the mesh.
pub(crate) const TRANSLATIONS: usize = 3;

/// Frequencies and answers of a body, with their rates with each of some parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyRates {
    /// Natural frequencies, cycles per time.
    pub frequencies: Vec<f64>,
    /// Groups of modes of one frequency.
    pub repeated: Vec<Range<usize>>,
    /// Displacements of the points of the output in each natural mode, by mode, then point.
    pub shapes: Vec<Vec<Vector3<f64>>>,
    /// The largest displacement of a node in each mode.
    pub peaks: Vec<f64>,
    /// Effective masses of each mode in translations of the base along the axes of the mesh; of modes of one frequency, their mean. None
    /// where they were not asked for.
    pub effective_masses: Option<Vec<[f64; TRANSLATIONS]>>,
    /// Static displacements of the points of the output, by load, then point; none of a body that a rigid motion is left to.
    pub statics: Option<Vec<Vec<Vector3<f64>>>>,
    /// Forces φᵀf of each load where its history is 1, by load, then mode; where all was asked for and the scene has points of the output.
    pub modal_forces: Vec<Vec<f64>>,
    /// The rates, by parameter.
    pub rates: Vec<ParameterRates>,
}

/// Displacements of the points in each mode times its modal force of one load, by mode, then point, and their rates. Modes of one frequency
/// are those that the parameter parts; sums over them do not depend on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Residues {
    /// φ (φᵀf).
    pub values: Vec<Vec<Vector3<f64>>>,
    /// Their rates.
    pub rates: Vec<Vec<Vector3<f64>>>,
}

/// Rates with one parameter: the derivatives of the numbers of [`BodyRates`].
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterRates {
    /// Rates of the frequencies. Modes of one frequency that the parameter parts are in rising order of their rates.
    pub frequencies: Vec<f64>,
    /// Rates of the eigenvalues ω².
    pub eigenvalues: Vec<f64>,
    /// Rates of the effective masses.
    pub effective_masses: Option<Vec<[f64; TRANSLATIONS]>>,
    /// Rates of the static displacements; none of a load whose forces on the nodes the parameter changes otherwise than by their mass.
    pub statics: Option<Vec<Option<Vec<Vector3<f64>>>>>,
    /// Residues of each load, none as of the static displacements; empty where they were not asked for.
    pub residues: Vec<Option<Residues>>,
}

/// Extent of the rates that are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RatesOf {
    /// Frequencies.
    Frequencies,
    /// Frequencies, effective masses, static answers and residues.
    All,
}
