//! Matrices of a body in the coordinates of Craig and Bampton, as Nastran names them.
//!
//! Coordinates are the six motions of the base (translations along and rotations about the axes of the mesh, through the origin), then the
//! modes: the interface of a body that one rigid support holds, and its internal coordinates. Of a free body whose markers could hold it the
//! interface are their displacements and rotations. `TREC` takes the coordinates to the displacements and rotations of the nodes, six
//! rows for each.

use faer::Mat;

use super::interface::{self, NoInterface};
use super::reduced::Reduced;

/// Motions of the base.
const BASE: usize = 6;

/// A matrix with its name and Nastran's number of its form.
pub struct Named {
    pub name: &'static str,
    pub matrix: Mat<f64>,
    pub form: i32,
}

/// Forms of a matrix.
const SYMMETRIC: i32 = 6;
const OTHER: i32 = 2;
/// Type of a matrix of real numbers in double precision.
pub const DOUBLE: i32 = 2;

/// Mass, stiffness, damping and recovery; those without rows are left out. With them a note where markers are no interface.
pub fn matrices(body: &Reduced<'_>) -> (Vec<Named>, Option<String>) {
    let size = BASE + body.count();
    let [mut mass, mut stiffness, mut damping] = [(); 3].map(|()| Mat::<f64>::zeros(size, size));
    for (i, j) in (0..BASE).flat_map(|i| (0..BASE).map(move |j| (i, j))) {
        mass[(i, j)] = body.rigid_mass[(i, j)];
    }
    for k in 0..body.count() {
        let row = BASE + k;
        for i in 0..3 {
            for (column, value) in [(i, body.momenta[k][i]), (3 + i, body.angular_momenta[k][i])] {
                mass[(row, column)] = value;
                mass[(column, row)] = value;
            }
        }
        mass[(row, row)] = 1.0;
        stiffness[(row, row)] = body.omegas[k].powi(2);
        damping[(row, row)] = body.damping(k);
    }
    let mut recovery = Mat::<f64>::zeros(6 * body.nodes.len(), size);
    for (n, node) in body.nodes.iter().enumerate() {
        let arm = node.position.cross_matrix();
        for i in 0..3 {
            recovery[(6 * n + i, i)] = 1.0;
            recovery[(6 * n + 3 + i, 3 + i)] = 1.0;
            for j in 0..3 {
                recovery[(6 * n + i, 3 + j)] = -arm[(i, j)];
            }
            for k in 0..body.count() {
                recovery[(6 * n + i, BASE + k)] = node.shapes[k][i];
                recovery[(6 * n + 3 + i, BASE + k)] = node.turns[k][i];
            }
        }
    }
    let change = interface::coordinates(&interface::rows(&body.interface), &mass, &stiffness);
    let note = change.as_ref().err().and_then(|reason| no_interface(body, *reason));
    if let Ok(change) = change {
        for matrix in [&mut mass, &mut stiffness, &mut damping] {
            let changed = change.transpose() * (&*matrix * &change);
            *matrix = Mat::from_fn(size, size, |i, j| 0.5 * (changed[(i, j)] + changed[(j, i)]));
        }
        recovery = recovery * change;
    }
    let all = [
        ("MXX", mass, SYMMETRIC),
        ("KXX", stiffness, SYMMETRIC),
        ("BXX", damping, SYMMETRIC),
        ("TREC", recovery, OTHER),
    ];
    let all = all.into_iter().filter(|(_, matrix, _)| matrix.nrows() > 0);
    (all.map(|(name, matrix, form)| Named { name, matrix, form }).collect(), note)
}

/// A sentence about the markers of a free body that are no interface, with the coordinates that are there; none of a body without markers.
fn no_interface(body: &Reduced<'_>, reason: NoInterface) -> Option<String> {
    let Reduced { markers, without_turns, .. } = body;
    let why = match (markers.is_empty(), without_turns.is_empty(), reason) {
        (true, ..) => return None,
        (_, false, _) => format!(
            "the nodes of {} do not tell its turns (give it a region with faces, or `tie = \"nodes\"`)",
            without_turns.join(", ")
        ),
        (.., NoInterface::NoPlaces) => format!("{} have no places", markers.join(", ")),
        (.., NoInterface::Many { rows, coordinates }) => format!(
            "{} have {rows} displacements and rotations, more than the {coordinates} coordinates of the body (ask for more \
             modes, or tie fewer nodes)",
            markers.join(", ")
        ),
        (.., NoInterface::Free) => {
            format!("{} do not hold the body, which could move as a whole (hold it in more places)", markers.join(", "))
        }
        (.., NoInterface::Together) => {
            format!("places of {} move only together in these modes (ask for more, or tie fewer)", markers.join(", "))
        }
        (.., NoInterface::Numbers) => format!("the modes with {} held were not found", markers.join(", ")),
    };
    Some(format!(
        "the markers are no interface: {why}; the coordinates are the six rigid motions about the center of mass and the modes of the free body"
    ))
}

impl Named {
    /// A column: its first row that is not zero, from 0, with the numbers from there to the last that is not; none of a column of zeros.
    pub fn filled(&self, column: usize) -> Option<(usize, Vec<f64>)> {
        let column = self.matrix.col(column);
        let filled = |value: &f64| *value != 0.0;
        let (first, last) = (column.iter().position(filled)?, column.iter().rposition(filled)?);
        Some((first, (first..=last).map(|i| column[i]).collect()))
    }
}
