//! The errors of the modes and of the model, from the check by the full body.

use model::{ErrorDirection, ErrorPart};

use super::card::{Line, Place, SMALL, percent};
use crate::commands::check::report::{BodyCheck, DEAR, RowCheck};

/// The lines of a body: of its modes and of its model. `better` is the cure of large modes that are worse than others.
pub(super) fn lines(
    is_rigid: bool,
    check: Result<Option<&BodyCheck>, &str>,
    better: Option<&str>,
    file: &str,
) -> [Line; 2] {
    if is_rigid {
        let (why, next) = ("the body is taken as rigid", "give it modes (`[modes] flexible`) and compare");
        let none = ("no error: a rigid body has none", "by the scene");
        return [
            Place::Modes.known(0.0, none.0.to_owned(), none.1.to_owned(), String::new()),
            Place::Model.not_known(why, next.to_owned()),
        ];
    }
    let not_known =
        |why: &str, next: &str| [Place::Modes, Place::Model].map(|place| place.not_known(why, next.to_owned()));
    let command = format!("`flexframe check {file}`");
    match check {
        Err(why) => not_known(why, &command),
        Ok(None) => not_known("the check does not have this body", &command),
        Ok(Some(BodyCheck { rows, not_checked, .. })) => match (rows.is_empty(), not_checked) {
            (false, _) => known(rows, better),
            (true, Some(why)) if why != DEAR => not_known(why, "compare with more modes, and with a mesh of its own"),
            (true, _) => not_known("the full body costs more than the reduction did", &command),
        },
    }
}

/// The size of the parts of the error of a row that modes leave out, or of its other parts, and the mend of the largest of them.
fn parts(row: &RowCheck, of_modes: bool) -> (f64, String) {
    let is_of_modes = |part: &&ErrorPart| part.direction == ErrorDirection::LinearAnswer;
    let parts = row.state.parts.iter().filter(|part| is_of_modes(part) == of_modes);
    let square: f64 = parts.clone().map(|part| part.size * part.size).sum();
    let mend = parts.max_by(|a, b| a.size.total_cmp(&b.size)).and_then(|part| part.mend);
    (square.sqrt(), mend.map_or_else(String::new, |mend| mend.words().to_owned()))
}

/// The error of the model in rows of a run: its displacements, and the vibrations that come out of step by the end.
pub(crate) fn model_error(rows: &[RowCheck]) -> f64 {
    rows.iter().map(|row| parts(row, false).0.max(row.state.drift)).fold(0.0, f64::max)
}

fn known(rows: &[RowCheck], better: Option<&str>) -> [Line; 2] {
    let measured = match rows {
        [row] => format!("measured by the full nonlinear body at time {:.6}", row.state.time),
        _ => format!("measured by the full nonlinear body in {} rows", rows.len()),
    };
    let about = if rows.iter().all(|row| row.state.is_settled) { "" } else { "about " };
    let worst = |of_modes: bool| {
        let each = rows.iter().map(|row| parts(row, of_modes));
        each.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
    };
    let off = |error: f64| format!("displacements off by {about}{} of the largest", percent(error));

    let (of_modes, next) = worst(true);
    let modes = Place::Modes.known(of_modes, off(of_modes), measured.clone(), next);
    let (mut of_model, mut next) = worst(false);
    let mut meaning = off(of_model);
    let worst = rows.iter().map(|row| (row.state.drift, row.state.drift_mend)).max_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((drift, Some(mend))) = worst.filter(|(drift, _)| *drift > of_model) {
        meaning = format!("{meaning}, its vibrations by up to {} at the end", percent(drift));
        of_model = drift;
        mend.words().clone_into(&mut next);
    }
    if let Some(better) = better {
        better.clone_into(&mut next);
    }
    let frequencies = rows.iter().flat_map(|row| &row.state.frequencies).map(|frequency| frequency.error.abs());
    let frequency = frequencies.fold(0.0, f64::max);
    if frequency >= SMALL {
        meaning = format!("{meaning}, frequencies by {}", percent(frequency));
    }
    if rows.iter().any(|row| row.state.growth > 0.0) {
        let next = "look at the state: `flexframe check` has the row; the linear answer means nothing there".to_owned();
        let meaning = format!("{meaning}; the true body is unstable: a vibration grows");
        return [modes, Place::Model.known(of_model.max(1.0), meaning, measured, next)];
    }
    if rows.iter().any(|row| row.state.negative_directions.is_some_and(|count| count > 0)) {
        meaning = format!("{meaning}; the true body has lost stiffness: it buckles, or its spin alone holds it");
    }
    [modes, Place::Model.known(of_model, meaning, measured, next)]
}
