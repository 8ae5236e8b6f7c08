//! Frequencies of bodies in welds, at rest: those of the bodies with the rows of their joints taken out.

use faer::{Mat, Side};
use model::BodyMarker;
use nalgebra::Vector3;

use crate::nonlinear::SolidError;
use crate::systems::run::Built;

/// Circular frequencies of two bodies whose marker `0` is welded to that of the other at each of its places, ascending, without
/// rigid motions. The bodies lie as they are meshed, with these places of their origins.
///
/// ```text
/// M = diag(m, J, 1)      K = diag(0, Ω²)      G x = 0: equal displacements and rotations of the places
/// ```
///
/// # Errors
/// An eigenproblem that fails.
pub fn frequencies(built: &Built, origins: [Vector3<f64>; 2]) -> Result<Vec<f64>, SolidError> {
    let [one, other] = [0, 1].map(|k| &built.models[k].body);
    let first = [0, 6 + one.flexible()];
    let count = first[1] + 6 + other.flexible();
    // In coordinates whose mass is one: translations and rotations over roots of mass and inertia.
    let mut root = Mat::<f64>::zeros(count, count);
    let mut stiffness = Mat::<f64>::zeros(count, count);
    for (body, at) in [one, other].iter().zip(first) {
        let mass = nalgebra::SymmetricEigen::new(body.inertia);
        let inverse = mass.eigenvectors * nalgebra::Matrix3::from_diagonal(&mass.eigenvalues.map(|j| j.sqrt().recip()));
        for i in 0..3 {
            root[(at + i, at + i)] = body.mass.sqrt().recip();
            (0..3).for_each(|j| root[(at + 3 + i, at + 3 + j)] = inverse[(i, j)]);
        }
        for (k, omega) in body.circular_frequencies.iter().enumerate() {
            root[(at + 6 + k, at + 6 + k)] = 1.0;
            stiffness[(at + 6 + k, at + 6 + k)] = omega * omega;
        }
    }
    let markers = [0, 1].map(|k| &built.models[k].markers[0]);
    let [one, other] = [0, 1].map(|k| places(markers[k]));
    let turns = if markers[0].by_nodes { 0 } else { 3 };
    let size = 3 + turns;
    let mut rows = Mat::<f64>::zeros(one.len() * size, count);
    for (number, (x, shapes)) in one.iter().enumerate() {
        let gap = |place: &(Vector3<f64>, Mat<f64>)| (place.0 + origins[1] - origins[0] - x).norm();
        let nearest = other.iter().min_by(|a, b| gap(a).total_cmp(&gap(b)));
        let (y, of_other) = nearest.ok_or(SolidError::Mesh("no place to weld".to_owned()))?;
        for (sign, at, x, shapes) in [(1.0, first[0], x, shapes), (-1.0, first[1], y, of_other)] {
            let cross = x.cross_matrix();
            for i in 0..size {
                let row = number * size + i;
                rows[(row, at + i)] = sign;
                if i < 3 {
                    (0..3).for_each(|j| rows[(row, at + 3 + j)] = -sign * cross[(i, j)]);
                }
                (0..shapes.ncols()).for_each(|k| rows[(row, at + 6 + k)] = sign * shapes[(i, k)]);
            }
        }
    }
    let failed = |_| SolidError::Factor;
    let scaled = &rows * &root;
    // Motions that the rows leave free: eigenvectors of RᵀR without stiffness.
    let length = |row: usize| (0..count).map(|k| scaled[(row, k)].powi(2)).sum::<f64>().sqrt();
    let unit = Mat::from_fn(scaled.nrows(), count, |i, k| scaled[(i, k)] / length(i));
    let svd = unit.svd().map_err(|_| SolidError::Factor)?;
    let values = svd.S().column_vector();
    let rank = values.iter().filter(|value| **value > 1e-9 * values[0]).count();
    let free = svd.V().subcols(rank, count - rank);
    let reduced = free.transpose() * &stiffness * free;
    let squares = reduced.self_adjoint_eigenvalues(Side::Lower).map_err(failed)?;
    Ok(squares.into_iter().skip(6).map(|square| square.max(0.0).sqrt()).collect())
}

/// Positions of the places of a marker, from the origin of its body, and how modes move and turn them (6×nf).
fn places(marker: &BodyMarker) -> Vec<(Vector3<f64>, Mat<f64>)> {
    let place = |point: &dynamics::PointShapes, turning: &dynamics::RotationShapes| {
        let (moves, turns) = (&point.columns()[6..], &turning.columns()[6..]);
        (point.position_body(), Mat::from_fn(6, moves.len(), |i, k| if i < 3 { moves[k][i] } else { turns[k][i - 3] }))
    };
    match marker.parts.is_empty() {
        true => vec![place(&marker.point, &marker.turning)],
        false => marker.parts.iter().map(|part| place(&part.point, &part.turning)).collect(),
    }
}
