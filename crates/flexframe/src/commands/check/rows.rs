//! Rows of a results file, and the states in them.

use std::path::Path;

use diagnostic::{Failure, Kind};
use dynamics::MotionState;
use model::{Course, Model};
use results::{BodyResults, Results};
use rigid_kin::Attitude;

use super::cost::affordable;

/// Intervals between rows that are spread over a run.
const SPREAD: usize = 7;
/// The reason of such a row.
const ON_THE_WAY: &str = "on the way";

/// Which rows are checked.
#[derive(Debug, Clone, PartialEq)]
pub enum CheckRows {
    /// The rows at which a model is most likely to be wrong: the largest strain energy, the largest stress, the largest spin, the last.
    Worst,
    /// Rows that are spread over the run, but for these.
    OnTheWay,
    /// As many of the worst, in this order, as cost no more than the reduction of the body did.
    Cheap,
    /// Rows by their numbers, from 0.
    Given(Vec<usize>),
}

/// The rows of a body that are checked, each with the reasons.
pub(super) fn chosen(
    file: &Path,
    results: &Results,
    body: usize,
    model: &Model,
    rows: &CheckRows,
) -> Result<Vec<(usize, Vec<&'static str>)>, Failure> {
    let count = results.rows();
    if let CheckRows::Given(asked) = rows {
        return asked
            .iter()
            .map(|asked| match *asked < count {
                true => Ok((*asked, vec!["asked for"])),
                false => {
                    let expected = format!("a number from 0 to {}", count - 1);
                    let wrong = Kind::Usage.of(file).key("--rows").found(asked.to_string()).expected(&expected);
                    Err(wrong.says(format!("there is no row {asked}, expected {expected}")))
                }
            })
            .collect();
    }
    let Some(of) = results.bodies().nth(body) else { return Ok(Vec::new()) };
    let mut chosen: Vec<(usize, Vec<&'static str>)> = Vec::new();
    let mut add = |row: Option<usize>, why| {
        let Some(row) = row else { return };
        match chosen.iter_mut().find(|(other, _)| *other == row) {
            Some((_, reasons)) => reasons.push(why),
            None => chosen.push((row, vec![why])),
        }
    };
    add(largest(count, |row| bending(of, model, row)), "largest strain energy");
    add(largest(count, |row| stress(of, row)), "largest stress");
    add(largest(count, |row| spin(of, row)), "largest spin");
    add(count.checked_sub(1), "last");
    if *rows == CheckRows::OnTheWay {
        (1..SPREAD).for_each(|k| add(Some(k * count / SPREAD), ON_THE_WAY));
        chosen.retain(|(_, why)| why == &[ON_THE_WAY]);
    }
    if *rows == CheckRows::Cheap {
        chosen.truncate(affordable(model));
    }
    Ok(chosen)
}

/// The row where a size is the largest; none where it is nothing everywhere. The last of equal ones.
fn largest(count: usize, size: impl Fn(usize) -> f64) -> Option<usize> {
    let sizes = (0..count).map(|row| (row, size(row))).filter(|(_, size)| *size > 0.0 && size.is_finite());
    sizes.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
}

/// The strain energy beyond the linear one where there are large modes, else all of it.
fn bending(of: BodyResults<'_>, model: &Model, row: usize) -> f64 {
    let q = of.table("modal/displacement").and_then(|table| table.row(row));
    match (&model.physics.large_deflection, q) {
        (Some(manifold), Some(q)) => manifold.energy(q).abs(),
        _ => of.numbers("energy/strain").map_or(0.0, |energies| energies[row]),
    }
}

fn stress(of: BodyResults<'_>, row: usize) -> f64 {
    let points = of.metadata.point_names.iter();
    let at = |name: &String| Some(of.numbers(&format!("points/{name}/von_mises_stress"))?[row]);
    points.filter_map(at).fold(0.0, f64::max)
}

fn spin(of: BodyResults<'_>, row: usize) -> f64 {
    let spins = of.vectors::<3>("angular_velocity");
    spins.map_or(0.0, |spins| spins[row].iter().map(|omega| omega * omega).sum::<f64>().sqrt())
}

/// The modal displacements of a body in a run.
pub(crate) fn course(results: &Results, body: usize) -> Course {
    let of = results.bodies().nth(body).and_then(|of| of.table("modal/displacement"));
    let Some(of) = of else { return Course::default() };
    let mut largest = 0.0_f64;
    let mut reach: Vec<[f64; 2]> = Vec::new();
    for q in (0..results.rows()).filter_map(|row| of.row(row)).filter(|q| q.iter().all(|q| q.is_finite())) {
        // Modes are orthonormal in the mass.
        largest = largest.max(q.iter().map(|q| q * q).sum::<f64>().sqrt());
        reach.resize(q.len(), [f64::INFINITY, f64::NEG_INFINITY]);
        reach.iter_mut().zip(q).for_each(|(reach, q)| *reach = [reach[0].min(*q), reach[1].max(*q)]);
    }
    Course { largest, swings: reach.iter().map(|[least, most]| 0.5 * (most - least)).collect() }
}

/// The state of a body in a row.
pub(super) fn motion(results: &Results, body: usize, row: usize) -> Option<MotionState> {
    let of = results.bodies().nth(body)?;
    let vector = |path: &str| Some(of.vectors::<3>(path)?.get(row)?.to_owned().into());
    let list = |path: &str| Some(of.table(path)?.row(row)?.to_vec());
    Some(MotionState {
        time: *results.numbers("time")?.get(row)?,
        attitude: Attitude::from_wxyz(*of.vectors::<4>("attitude")?.get(row)?).ok()?,
        origin_global: vector("origin")?,
        velocity_global: vector("velocity")?,
        omega_body: vector("angular_velocity")?,
        modal_displacement: list("modal/displacement")?,
        modal_velocity: list("modal/velocity")?,
    })
}

/// The refusal of a file that has nothing to check.
pub(super) fn no_rows(file: &Path) -> Failure {
    Kind::Input.of(file).help("let the run come to its first row").says("it has no rows")
}
