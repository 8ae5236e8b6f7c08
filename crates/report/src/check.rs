//! Sizes and numbers of a report, checked before anything is written.

use diagnostic::Failure;

use crate::error::{empty, unfit};
use crate::run_page::{Compared, Component, Control, PageBody, PageMotion, PageSurface, RunPage};

/// Shapes that a page can draw: layers of a texture that every graphics processor has.
const MAX_SHAPES: usize = 256;

/// How far the norm of an attitude may be from 1.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Checks sizes, indices and numbers.
///
/// # Errors
/// The first thing that is wrong.
pub(crate) fn check(report: &RunPage) -> Result<(), Failure> {
    check_bodies(&report.times, &report.bodies)?;
    if let Some(Compared { times, bodies, .. }) = &report.compared {
        check_bodies(times, bodies)?;
    }
    let rows = report.times.len();
    for history in &report.histories {
        let what = format!("history \"{}: {}\"", history.group, history.name);
        least_range(&what, history.least_range)?;
        check_components(&what, &history.components, rows)?;
    }
    for balance in &report.balances {
        least_range(&format!("balance \"{}\"", balance.name), balance.least_range)?;
        check_components(&format!("balance \"{}\", terms", balance.name), &balance.terms, rows)?;
        check_components(&format!("balance \"{}\", errors", balance.name), &balance.errors, rows)?;
    }
    if let Some(live) = &report.live {
        length("list of bodies that are led on", live.bodies.len(), report.bodies.len())?;
        for Control { group, name, range, recorded, .. } in &live.controls {
            finite(&format!("control \"{group}: {name}\""), range.iter().chain([recorded]).copied())?;
        }
    }
    Ok(())
}

fn check_bodies(times: &[f64], bodies: &[PageBody]) -> Result<(), Failure> {
    check_times(times)?;
    if bodies.is_empty() {
        return Err(empty("body"));
    }
    for body in bodies {
        check_motion(&body.motion, times.len(), body.shapes.len())?;
        at_most(body.shapes.len())?;
        body.surface.as_ref().map_or(Ok(()), check_surface)?;
        check_shapes(body)?;
    }
    Ok(())
}

fn check_times(times: &[f64]) -> Result<(), Failure> {
    if times.is_empty() {
        return Err(empty("rows"));
    }
    finite("times", times.iter().copied())?;
    match times.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(row) => Err(unfit(format!(
            "the report's times do not increase: row {} (from 0) is at {}, and the row before it at {}",
            row + 1,
            times[row + 1],
            times[row]
        ))),
        None => Ok(()),
    }
}

fn check_motion(motion: &PageMotion, rows: usize, shapes: usize) -> Result<(), Failure> {
    let PageMotion { origins, attitudes, coordinates } = motion;
    length("positions", origins.len(), rows)?;
    length("attitudes", attitudes.len(), rows)?;
    length("coordinates", coordinates.len(), rows * shapes)?;
    finite("positions", origins.as_flattened().iter().copied())?;
    finite("attitudes", attitudes.as_flattened().iter().copied())?;
    finite("coordinates", coordinates.iter().copied())?;
    for (row, attitude) in attitudes.iter().enumerate() {
        let norm = attitude.iter().map(|x| x * x).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > UNIT_TOLERANCE {
            let words =
                format!("the report's attitude in row {row} (from 0) has the norm {norm}; expected a unit quaternion");
            return Err(unfit(words));
        }
    }
    Ok(())
}

fn check_surface(surface: &PageSurface) -> Result<(), Failure> {
    let count = surface.vertices.len();
    if surface.vertices.is_empty() {
        return Err(empty("vertices"));
    }
    finite("vertices", surface.vertices.as_flattened().iter().map(|x| f64::from(*x)))?;
    let outside = |indices: &[u32]| indices.iter().copied().find(|index| *index as usize >= count);
    for (what, indices) in [("triangle", surface.triangles.as_flattened()), ("edge", surface.edges.as_flattened())] {
        if let Some(index) = outside(indices) {
            let words = format!(
                "a {what} of the report's surface names vertex {index} (from 0), but there are {count} vertices"
            );
            return Err(unfit(words));
        }
    }
    Ok(())
}

fn check_shapes(body: &PageBody) -> Result<(), Failure> {
    let vertices = body.surface.as_ref().map_or(0, |surface| surface.vertices.len());
    for shape in &body.shapes {
        let what = format!("shape \"{}\"", shape.name);
        length(&what, shape.displacement.len(), vertices)?;
        finite(&what, shape.displacement.as_flattened().iter().map(|x| f64::from(*x)))?;
        if let crate::ShapeKind::Natural { frequency, damping_ratio } = shape.kind {
            finite(&format!("{what}, frequency and damping ratio"), [frequency, damping_ratio].into_iter())?;
        }
    }
    if let Some(stress) = &body.stress {
        length("stresses of shapes and products", stress.shapes.len(), body.shapes.len() + stress.products.len())?;
        at_most(stress.shapes.len())?;
        if let Some(coordinate) = stress.products.iter().flatten().find(|k| **k >= body.shapes.len()) {
            let count = body.shapes.len();
            let words = format!(
                "a product of the report's stress names coordinate {coordinate} (from 0), but there are {count}"
            );
            return Err(unfit(words));
        }
        let names = body.shapes.iter().map(|shape| format!("shape \"{}\"", shape.name));
        let products = stress.products.iter().map(|factors| format!("the product of the shapes {factors:?}"));
        for (name, stresses) in names.chain(products).zip(&stress.shapes) {
            let what = format!("stress of {name}");
            length(&what, stresses.len(), vertices)?;
            finite(&what, stresses.as_flattened().iter().map(|x| f64::from(*x)))?;
        }
    }
    Ok(())
}

fn check_components(what: &str, components: &[Component], rows: usize) -> Result<(), Failure> {
    if components.is_empty() {
        return Err(empty(&format!("component in its {what}")));
    }
    for component in components {
        let what = format!("{what}, component \"{}\"", component.name);
        length(&what, component.values.len(), rows)?;
        finite(&what, component.values.iter().copied())?;
    }
    Ok(())
}

pub(crate) fn length(what: &str, found: usize, expected: usize) -> Result<(), Failure> {
    if found == expected {
        return Ok(());
    }
    Err(unfit(format!("the report's {what} has {found} entries where {expected} are expected")))
}

/// Refuses more shapes than the page can draw.
fn at_most(found: usize) -> Result<(), Failure> {
    if found <= MAX_SHAPES {
        return Ok(());
    }
    let help = "leave out the highest modes";
    Err(unfit(format!("the report has {found} shapes, and the page draws {MAX_SHAPES} at the most; {help}")))
}

fn least_range(what: &str, least: f64) -> Result<(), Failure> {
    finite(&format!("{what}, least range"), [least].into_iter())
}

/// Numbers are written in single precision, where those beyond 3e38 are infinite.
pub(crate) fn finite(what: &str, values: impl Iterator<Item = f64>) -> Result<(), Failure> {
    match values.enumerate().find(|(_, value)| !(*value as f32).is_finite()) {
        None => Ok(()),
        Some((index, value)) => Err(unfit(format!(
            "the report's {what} holds {value} in entry {index} (from 0); expected a finite number below 3e38"
        ))),
    }
}
