//! Sizes and numbers of a report, checked before anything is written.

use crate::ReportError;
use crate::run_page::{Compared, Component, Control, PageBody, PageMotion, PageSurface, RunPage};

/// Shapes that a page can draw: layers of a texture that every graphics processor has.
const MAX_SHAPES: usize = 256;

/// How far the norm of an attitude may be from 1.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Checks sizes, indices and numbers.
///
/// # Errors
/// The first thing that is wrong.
pub(crate) fn check(report: &RunPage) -> Result<(), ReportError> {
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
        let (what, found, expected) =
            ("list of bodies that are led on".to_owned(), live.bodies.len(), report.bodies.len());
        if found != expected {
            return Err(ReportError::WrongLength { what, found, expected });
        }
        for Control { group, name, range, recorded, .. } in &live.controls {
            finite(&format!("control \"{group}: {name}\""), range.iter().chain([recorded]).copied())?;
        }
    }
    Ok(())
}

fn check_bodies(times: &[f64], bodies: &[PageBody]) -> Result<(), ReportError> {
    check_times(times)?;
    if bodies.is_empty() {
        return Err(ReportError::Empty { what: "body".to_owned() });
    }
    for body in bodies {
        check_motion(&body.motion, times.len(), body.shapes.len())?;
        if body.shapes.len() > MAX_SHAPES {
            return Err(ReportError::TooManyShapes { found: body.shapes.len(), most: MAX_SHAPES });
        }
        body.surface.as_ref().map_or(Ok(()), check_surface)?;
        check_shapes(body)?;
    }
    Ok(())
}

fn check_times(times: &[f64]) -> Result<(), ReportError> {
    if times.is_empty() {
        return Err(ReportError::Empty { what: "rows".to_owned() });
    }
    finite("times", times.iter().copied())?;
    match times.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(row) => Err(ReportError::TimesNotIncreasing { row: row + 1, time: times[row + 1], before: times[row] }),
        None => Ok(()),
    }
}

fn check_motion(motion: &PageMotion, rows: usize, shapes: usize) -> Result<(), ReportError> {
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
            return Err(ReportError::NotUnit { row, norm });
        }
    }
    Ok(())
}

fn check_surface(surface: &PageSurface) -> Result<(), ReportError> {
    let count = surface.vertices.len();
    if surface.vertices.is_empty() {
        return Err(ReportError::Empty { what: "vertices".to_owned() });
    }
    finite("vertices", surface.vertices.as_flattened().iter().map(|x| f64::from(*x)))?;
    let outside = |indices: &[u32]| indices.iter().copied().find(|index| *index as usize >= count);
    for (what, indices) in [("triangle", surface.triangles.as_flattened()), ("edge", surface.edges.as_flattened())] {
        if let Some(index) = outside(indices) {
            return Err(ReportError::NoSuchVertex { what, index, count });
        }
    }
    Ok(())
}

fn check_shapes(body: &PageBody) -> Result<(), ReportError> {
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
        if stress.shapes.len() > MAX_SHAPES {
            return Err(ReportError::TooManyShapes { found: stress.shapes.len(), most: MAX_SHAPES });
        }
        if let Some(coordinate) = stress.products.iter().flatten().find(|k| **k >= body.shapes.len()) {
            return Err(ReportError::NoSuchShape { coordinate: *coordinate, count: body.shapes.len() });
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

fn check_components(what: &str, components: &[Component], rows: usize) -> Result<(), ReportError> {
    if components.is_empty() {
        return Err(ReportError::Empty { what: format!("component in its {what}") });
    }
    for component in components {
        let what = format!("{what}, component \"{}\"", component.name);
        length(&what, component.values.len(), rows)?;
        finite(&what, component.values.iter().copied())?;
    }
    Ok(())
}

fn length(what: &str, found: usize, expected: usize) -> Result<(), ReportError> {
    if found == expected {
        return Ok(());
    }
    Err(ReportError::WrongLength { what: what.to_owned(), found, expected })
}

fn least_range(what: &str, least: f64) -> Result<(), ReportError> {
    finite(&format!("{what}, least range"), [least].into_iter())
}

/// Numbers are written in single precision, where those beyond 3e38 are infinite.
pub(crate) fn finite(what: &str, values: impl Iterator<Item = f64>) -> Result<(), ReportError> {
    match values.enumerate().find(|(_, value)| !(*value as f32).is_finite()) {
        None => Ok(()),
        Some((index, value)) => Err(ReportError::NotFinite { what: what.to_owned(), index, value }),
    }
}
