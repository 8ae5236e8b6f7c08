//! Random responses of outputs, and von Mises stresses where all six components are among them.

use linear::{Channel, FrequencyResponse, LinearError, RandomInput, RandomResponse, SecondOrder};

use crate::commands::linear::names::STRESS;

/// Random responses by output.
#[derive(Debug, Clone)]
pub(super) struct Responses {
    pub frequencies: Vec<f64>,
    pub outputs: Vec<(Channel, RandomResponse)>,
    /// The number of the first von Mises stress; they come after the outputs.
    pub first_von_mises: usize,
}

impl Responses {
    pub fn new(
        equations: &SecondOrder,
        response: &FrequencyResponse,
        input: &RandomInput,
        weights: &[f64],
    ) -> Result<Self, LinearError> {
        let channels: Vec<&Channel> = equations.outputs.iter().map(|output| &output.channel).collect();
        let of_outputs = response.random(input, weights)?;
        let mut outputs: Vec<(Channel, RandomResponse)> =
            channels.iter().map(|channel| (*channel).clone()).zip(of_outputs).collect();
        let first_von_mises = outputs.len();
        for (place, channel) in channels.iter().enumerate() {
            let Some(name) = channel.name.strip_suffix(".xx").filter(|name| name.contains(".stress")) else { continue };
            let component = |letters: &str| {
                let wanted = format!("{name}.{letters}");
                channels.iter().position(|channel| channel.name == wanted)
            };
            let found: Vec<usize> = STRESS.into_iter().filter_map(component).collect();
            let Ok(stress) = <[usize; 6]>::try_from(found) else { continue };
            let name = name.replacen(".stress", ".von_mises", 1);
            let found = response.random_von_mises(stress, input, weights)?;
            outputs.push((Channel::new(name, channels[place].unit.clone()), found));
        }
        Ok(Self { frequencies: response.frequencies.clone(), outputs, first_von_mises })
    }
}
