//! Frequency responses with their rates: Eqs. (D11) and (D21) of `docs/method/gradients.md`.

use std::f64::consts::TAU;

use diagnostic::Failure;
use faer::{Mat, c64};

/// Names of the axes.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// Real and imaginary parts at each frequency.
pub(crate) type Values = Vec<[f64; 2]>;

/// The response of an output, such as tip.displacement.y, to an input, such as the factor on a load.
#[derive(Debug, Clone)]
pub(crate) struct ResponseReport {
    pub input: String,
    pub output: String,
    pub values: Values,
}

/// Responses, by input, then output, with their rates by number; none of a load that follows the number in a way that is not known.
pub(crate) struct Responses {
    pub responses: Vec<ResponseReport>,
    pub rates: Vec<Vec<Option<Values>>>,
}

/// Inputs and outputs over coordinates of unit mass.
pub(super) struct Ports {
    /// Names of inputs and of outputs.
    pub names: [Vec<String>; 2],
    /// Forces of inputs, then displacements that outputs see, a column each.
    pub rows: Mat<f64>,
}

/// Motions at a frequency by the forces of each port.
pub(super) struct Moved {
    pub coordinates: Vec<Vec<c64>>,
    /// The same over the coordinates of all bodies.
    pub motions: Vec<Vec<c64>>,
}

/// The rate of a response with a number: by circular frequency, input and output, and the motions there.
pub(super) type Change<'a> = Box<dyn Fn(f64, [usize; 2], &Moved) -> Option<c64> + 'a>;

impl Responses {
    /// No responses, of some numbers.
    pub fn none(numbers: usize) -> Self {
        Self { responses: Vec::new(), rates: vec![Vec::new(); numbers] }
    }

    /// The responses at some frequencies, cycles per time, with the change by each number; `moved` is by circular frequency.
    pub fn new(
        ports: &Ports,
        frequencies: &[f64],
        changes: &[Change<'_>],
        moved: impl Fn(f64) -> Result<Moved, Failure>,
    ) -> Result<Self, Failure> {
        let [inputs, outputs] = &ports.names;
        let pairs = (0..inputs.len()).flat_map(|i| (0..outputs.len()).map(move |o| [i, inputs.len() + o]));
        let pairs: Vec<[usize; 2]> = pairs.collect();
        let mut values = vec![Values::new(); pairs.len()];
        let mut rates = vec![vec![Some(Values::new()); pairs.len()]; changes.len()];
        for frequency in frequencies {
            let omega = TAU * frequency;
            let moved = moved(omega)?;
            for (k, [i, o]) in pairs.iter().enumerate() {
                let motion = moved.coordinates[*i].iter().enumerate();
                let value: c64 = motion.map(|(j, x)| ports.rows[(j, *o)] * x).sum();
                values[k].push([value.re, value.im]);
                for (change, rates) in changes.iter().zip(&mut rates) {
                    match (change(omega, [*i, *o], &moved), &mut rates[k]) {
                        (Some(rate), Some(values)) => values.push([rate.re, rate.im]),
                        (_, rates) => *rates = None,
                    }
                }
            }
        }
        let report = |([i, o], values): (&[usize; 2], Values)| ResponseReport {
            input: inputs[*i].clone(),
            output: outputs[o - inputs.len()].clone(),
            values,
        };
        Ok(Self { responses: pairs.iter().zip(values).map(report).collect(), rates })
    }
}
