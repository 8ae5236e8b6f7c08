//! Frequencies and answers of a body or a system with their rates.

use std::ops::Range;

use super::responses::{ResponseReport, Values};

/// Frequencies and answers.
pub(crate) struct Found {
    /// Cycles per time.
    pub frequencies: Vec<f64>,
    /// Groups of modes of one frequency.
    pub repeated: Vec<Range<usize>>,
    /// For each mode, in translations of the base along the axes of the mesh; the mean of modes of one frequency.
    pub effective_masses: Vec<[f64; 3]>,
    /// Empty of a body that is not held, and without loads or points of the output.
    pub statics: Vec<Static>,
    pub responses: Vec<ResponseReport>,
    /// By number.
    pub rates: Vec<RatesOfNumber>,
}

/// The static displacement of a point under a load where its history is 1.
pub(crate) struct Static {
    pub load: String,
    pub point: String,
    /// Axes of the mesh.
    pub displacement: [f64; 3],
}

/// Rates with a number: by its unit.
#[derive(Default)]
pub(crate) struct RatesOfNumber {
    /// For each mode; where modes have one frequency, for the modes that the number parts, in rising order.
    pub frequencies: Vec<f64>,
    pub effective_masses: Vec<[f64; 3]>,
    /// None of a load whose forces change with the shape.
    pub statics: Vec<Option<[f64; 3]>>,
    /// None as of static displacements.
    pub responses: Vec<Option<Values>>,
}
