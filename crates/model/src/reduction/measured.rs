//! Frequencies and damping as they were measured, in the place of the model's.

use dynamics::PointShapes;
use reduced_body::{Constants, ReducedBody};
use scene::{Body, Measured, MeasuredMode};

use crate::error::{BuildError, modal};

const KEY: &str = "modes.measured";
/// Least MAC of a measured shape with that of the mode which takes its numbers.
const ALIKE: f64 = 0.6;
/// Least displacement of a mode at the places that are measured, relative to its largest.
const SEEN: f64 = 0.01;
/// A measured frequency that is this many times that of its mode is of another mode, or in other units.
const OFF: f64 = 3.0;
/// Rigid shapes at a point, before the flexible ones.
const RIGID: usize = 6;

/// Shapes of natural modes, by which measured ones are matched.
pub(crate) struct Seen<'a> {
    /// Number of natural modes.
    pub natural: usize,
    /// Names of the points of the output.
    pub points: Vec<&'a str>,
    /// Displacement of a point, by its number, along an axis in a mode.
    pub displacement: &'a dyn Fn(usize, usize, usize) -> f64,
    /// The largest displacement in each mode.
    pub peaks: &'a [f64],
}

/// The modes that take the numbers of the measured ones, by number from 0.
pub(crate) fn matched(body: &Body, measured: &Measured, seen: &Seen<'_>) -> Result<Vec<usize>, BuildError> {
    let natural = seen.natural;
    if measured.places.is_empty() {
        if measured.modes.len() <= natural {
            return Ok((0..measured.modes.len()).collect());
        }
        let found = format!("{} measured modes", measured.modes.len());
        let expected = format!("at most {natural}, the natural modes of the model");
        return Err(body.refuse(KEY, found, expected, "keep more modes, or leave lines out").into());
    }
    // Rows of the shapes at the places: a list of the modes for each.
    let mut rows = Vec::new();
    for (name, axis) in &measured.places {
        let Some(point) = seen.points.iter().position(|point| point == name) else {
            let expected = format!("one of {}", seen.points.join(", "));
            let help = "give the point in [output] `points`";
            return Err(body.refuse(KEY, format!("a shape at the point `{name}`"), expected, help).into());
        };
        rows.push((0..natural).map(|k| (seen.displacement)(point, *axis, k)).collect::<Vec<f64>>());
    }
    let norm = |k: usize| rows.iter().map(|row| row[k].powi(2)).sum::<f64>();
    let mac = |mode: &MeasuredMode, k: usize| {
        let product: f64 = rows.iter().zip(&mode.shape).map(|(row, value)| row[k] * value).sum();
        let norms = norm(k) * mode.shape.iter().map(|value| value * value).sum::<f64>();
        // A mode that hardly moves there is not seen: its shape at the places is little more than rounding.
        let is_seen = norm(k).sqrt() > SEEN * seen.peaks[k];
        if is_seen && norms > 0.0 { product.powi(2) / norms } else { 0.0 }
    };
    let mut taken: Vec<usize> = Vec::new();
    for mode in &measured.modes {
        let best = (0..natural).map(|k| (k, mac(mode, k))).max_by(|a, b| a.1.total_cmp(&b.1));
        let line = mode.line;
        let Some((k, _)) = best.filter(|(_, alike)| *alike >= ALIKE) else {
            let alike = best.map_or(0.0, |(_, alike)| alike);
            let found = format!("the shape of line {line}, whose MAC with the mode most like it is {alike:.2}");
            let expected = format!("{ALIKE} or more");
            return Err(body
                .refuse(KEY, found, expected, "correct the shape, measure at more points, or keep more modes")
                .into());
        };
        if let Some(before) = taken.iter().position(|of| *of == k) {
            let found = format!("lines {} and {line}, both most like mode {}", measured.modes[before].line, k + 1);
            let help = "leave one of them out, or measure at more points";
            return Err(body.refuse(KEY, found, "a mode of its own for each line", help).into());
        }
        taken.push(k);
    }
    Ok(taken)
}

/// The body with the frequencies that the scene has measured, and its damping ratios with the measured ones among them.
pub(crate) fn as_measured(
    body: &Body,
    reduced: ReducedBody,
    (points, peaks): (&[(String, PointShapes)], &[f64]),
    has_large: bool,
    damping_ratios: &mut [f64],
) -> Result<ReducedBody, BuildError> {
    let Some(measured) = &body.modes.measured else { return Ok(reduced) };
    if has_large {
        let found = "measured frequencies of a body with large modes, whose frequencies follow their amplitudes";
        return Err(body
            .refuse(KEY, found, "modes that are small", "set `large_deflection = false` in [effects]")
            .into());
    }
    let displacement = |point: usize, axis: usize, mode: usize| {
        let (_, shapes) = &points[point];
        shapes.columns()[RIGID + mode][axis]
    };
    let names = points.iter().map(|(name, _)| name.as_str()).collect();
    let seen = Seen { natural: reduced.natural_modes, points: names, displacement: &displacement, peaks };
    let modes = matched(body, measured, &seen)?;
    let mut circular_frequencies = reduced.circular_frequencies.clone();
    for (k, mode) in modes.into_iter().zip(&measured.modes) {
        let (of_model, line) = (circular_frequencies[k] / std::f64::consts::TAU, mode.line);
        let ratio = mode.frequency / of_model;
        if !(1.0 / OFF..OFF).contains(&ratio) {
            let (frequency, number) = (mode.frequency, k + 1);
            let found = format!("{frequency} in line {line}, for mode {number} of the model, which has {of_model:.6}");
            let help = "give cycles per time and not rad, let lines follow the order of the modes or have shapes, or mend the model";
            return Err(body
                .refuse(KEY, found, format!("a frequency that is off by less than {OFF} times"), help)
                .into());
        }
        circular_frequencies[k] = std::f64::consts::TAU * mode.frequency;
        if let Some(ratio) = mode.damping_ratio {
            damping_ratios[k] = ratio;
        }
    }
    ReducedBody::from_constants(Constants { circular_frequencies, ..(*reduced).clone() }).map_err(modal(body))
}
