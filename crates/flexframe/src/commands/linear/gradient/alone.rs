//! Rates of a body alone, whose responses are sums over the modes that are kept: Eq. (D11) of `docs/method/gradients.md`.

use diagnostic::Failure;
use faer::{Mat, c64};
use model::{BodyRates, Parameter, ParameterRates, RatesOf, VariedBody};
use nalgebra::Vector3;

use super::damping::Damped;
use super::found::{Found, RatesOfNumber, Static};
use super::number::Number;
use super::responses::{AXES, Change, Moved, Ports, Responses};

/// Frequencies, effective masses, static answers and responses at some frequencies, with their rates.
pub(super) fn rates(body: &VariedBody, numbers: &[Number], frequencies: &[f64]) -> Result<Found, Failure> {
    let parameters: Vec<Parameter> = numbers.iter().filter_map(Number::parameter).cloned().collect();
    let found = body.rates(body.body(), &parameters, RatesOf::All)?;
    let loads = body.load_names();
    let points: Vec<String> = body.scene().output.points.keys().cloned().collect();
    let Responses { responses, rates: of_responses } = responses(body, &found, [&loads, &points], frequencies)?;
    let of_number = |(rates, responses): (&ParameterRates, _)| RatesOfNumber {
        frequencies: rates.frequencies.clone(),
        effective_masses: rates.effective_masses.clone().unwrap_or_default(),
        statics: (rates.statics.iter().flatten())
            .flat_map(|of_load| match of_load {
                Some(of_points) => of_points.iter().map(|rate| Some((*rate).into())).collect(),
                None => vec![None; points.len()],
            })
            .collect(),
        responses,
    };
    let of_load = |(load, of_points): (&String, &Vec<Vector3<f64>>)| {
        let of_point = |(point, u): (&String, &Vector3<f64>)| Static {
            load: load.clone(),
            point: point.clone(),
            displacement: (*u).into(),
        };
        points.iter().zip(of_points).map(of_point).collect::<Vec<_>>()
    };
    Ok(Found {
        statics: loads.iter().zip(found.statics.iter().flatten()).flat_map(of_load).collect(),
        rates: found.rates.iter().zip(of_responses).map(of_number).collect(),
        frequencies: found.frequencies,
        repeated: found.repeated,
        effective_masses: found.effective_masses.unwrap_or_default(),
        responses,
    })
}

/// Responses of the points to the loads.
fn responses(
    body: &VariedBody,
    found: &BodyRates,
    [loads, points]: [&[String]; 2],
    frequencies: &[f64],
) -> Result<Responses, Failure> {
    if frequencies.is_empty() {
        return Ok(Responses::none(found.rates.len()));
    }
    let modes = Damped::modes(&found.frequencies, &body.scene().modes.damping);
    let inputs = found.modal_forces.len();
    let of_point = |name: &String| AXES.map(|axis| format!("{name}.displacement.{axis}"));
    let rows = Mat::from_fn(modes.len(), inputs + 3 * points.len(), |k, port| match port.checked_sub(inputs) {
        None => found.modal_forces[port][k],
        Some(output) => found.shapes[k][output / 3][output % 3],
    });
    let ports = Ports { names: [loads[..inputs].to_vec(), points.iter().flat_map(of_point).collect()], rows };
    let rows = &ports.rows;
    let moved = |omega: f64| {
        let of_port = |port: usize| -> Vec<c64> {
            modes.iter().enumerate().map(|(k, mode)| c64::new(rows[(k, port)], 0.0) / mode.stiffness(omega)).collect()
        };
        Ok(Moved { coordinates: (0..rows.ncols()).map(of_port).collect(), motions: Vec::new() })
    };
    // Of residues φ(φᵀf) in the modes that the number parts, where some have one frequency.
    let change = &|rates: &ParameterRates, omega: f64, [input, output]: [usize; 2]| -> Option<c64> {
        let residues = rates.residues.get(input)?.as_ref()?;
        let (point, axis) = ((output - inputs) / 3, (output - inputs) % 3);
        let terms = modes.iter().enumerate().map(|(k, mode)| {
            let [rate, value] = [&residues.rates, &residues.values].map(|list| c64::new(list[k][point][axis], 0.0));
            let stiffness = mode.stiffness(omega);
            let stiffness_rate = mode.stiffness_rate(omega, rates.eigenvalues[k]);
            rate / stiffness - value * stiffness_rate / (stiffness * stiffness)
        });
        Some(terms.sum())
    };
    let changes =
        found.rates.iter().map(|rates| -> Change<'_> { Box::new(move |omega, ports, _| change(rates, omega, ports)) });
    Responses::new(&ports, frequencies, &changes.collect::<Vec<_>>(), moved)
}
