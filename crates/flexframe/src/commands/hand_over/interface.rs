//! An interface that deforms: displacements and rotations of markers, and inner modes with these held, Eq. (M18) of `docs/method/modes.md`.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::{Matrix3, Vector3};

/// Singular values of the motions of an interface, in parts of the largest, that are none.
const DEPENDENT: f64 = 1e-9;
/// Motions of the base.
const BASE: usize = 6;

/// A reason why markers are no interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoInterface {
    /// They have no places.
    NoPlaces,
    /// More displacements and rotations than the body has coordinates.
    Many { rows: usize, coordinates: usize },
    /// They leave the body motions as a whole.
    Free,
    /// They move only together.
    Together,
    /// A matrix that has no factors, or no eigenvalues.
    Numbers,
}

/// A place of the interface: its three displacements, and its rotations where it knows them.
pub struct Place {
    pub position: Vector3<f64>,
    /// Its displacement in each mode.
    pub shapes: Vec<Vector3<f64>>,
    /// Its rotation in each mode; none of a node.
    pub turns: Option<Vec<Vector3<f64>>>,
}

/// Displacements and rotations of the interface (k × 6+n) in the motions of the base and the modes.
pub fn rows(places: &[Place]) -> Mat<f64> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for Place { position, shapes, turns } in places {
        let arm = -position.cross_matrix();
        let mut add = |rigid: [Matrix3<f64>; 2], modes: &[Vector3<f64>]| {
            rows.extend((0..3).map(|i| {
                let base = rigid.iter().flat_map(|part| (0..3).map(move |j| part[(i, j)]));
                base.chain(modes.iter().map(|mode| mode[i])).collect::<Vec<f64>>()
            }));
        };
        add([Matrix3::identity(), arm], shapes);
        if let Some(turns) = turns {
            add([Matrix3::zeros(), Matrix3::identity()], turns);
        }
    }
    Mat::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
}

/// The motions of the base and the modes (n×n) in the displacements of the interface, whose `rows` these are, and the amplitudes of inner
/// modes of mass 1, which rise.
///
/// # Errors
/// [`NoInterface`].
pub fn coordinates(rows: &Mat<f64>, mass: &Mat<f64>, stiffness: &Mat<f64>) -> Result<Mat<f64>, NoInterface> {
    let (count, size) = (rows.nrows(), mass.nrows());
    if count == 0 {
        return Err(NoInterface::NoPlaces);
    }
    if count > size {
        return Err(NoInterface::Many { rows: count, coordinates: size });
    }
    // In coordinates of unit mass, and rows of unit length.
    let unit: Vec<f64> = (0..size).map(|i| 1.0 / mass[(i, i)].sqrt()).collect();
    let of_unit = Mat::from_fn(count, size, |i, j| rows[(i, j)] * unit[j]);
    let lengths: Vec<f64> = (0..count).map(|i| of_unit.row(i).norm_l2()).collect();
    let alike = Mat::from_fn(count, size, |i, j| of_unit[(i, j)] / lengths[i]);
    let scaled = |matrix: &Mat<f64>| Mat::from_fn(size, size, |i, j| matrix[(i, j)] * unit[i] * unit[j]);
    let (mass, stiffness) = (scaled(mass), scaled(stiffness));
    // A motion that holds all places strains the body unless it is one of the base alone.
    let of_base = alike.get(.., ..BASE).singular_values().map_err(|_| NoInterface::Numbers)?;
    if rank(&of_base) < BASE {
        return Err(NoInterface::Free);
    }
    let svd = alike.svd().map_err(|_| NoInterface::Numbers)?;
    let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    if rank(&values) < count {
        return Err(NoInterface::Together);
    }
    let along = |i: usize, j: usize| -> f64 { (0..count).map(|k| svd.V()[(i, k)] * svd.U()[(j, k)] / values[k]).sum() };
    let moved = Mat::from_fn(size, count, |i, j| along(i, j) / lengths[j]);
    let held = svd.V().get(.., count..).to_owned();
    let within = |matrix: &Mat<f64>| held.transpose() * (matrix * &held);
    let (inner_mass, inner) = (within(&mass), within(&stiffness));
    if held.ncols() == 0 {
        return Ok(Mat::from_fn(size, count, |i, j| unit[i] * moved[(i, j)]));
    }
    let factor = inner_mass.llt(Side::Lower).map_err(|_| NoInterface::Numbers)?.L().to_owned();
    let mut of_unit_mass = inner.clone();
    let lower = |matrix: &mut Mat<f64>| {
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(
            factor.as_ref(),
            matrix.as_mut(),
            faer::Par::Seq,
        );
    };
    lower(&mut of_unit_mass);
    let mut of_unit_mass = of_unit_mass.transpose().to_owned();
    lower(&mut of_unit_mass);
    let symmetric =
        Mat::from_fn(held.ncols(), held.ncols(), |i, j| 0.5 * (of_unit_mass[(i, j)] + of_unit_mass[(j, i)]));
    let eigen = symmetric.self_adjoint_eigen(Side::Lower).map_err(|_| NoInterface::Numbers)?;
    let mut modes = eigen.U().to_owned();
    faer::linalg::triangular_solve::solve_upper_triangular_in_place(factor.transpose(), modes.as_mut(), faer::Par::Seq);
    let modes = &held * modes;
    // What the interface moves strains the body least.
    let strained = inner.llt(Side::Lower).map_err(|_| NoInterface::Numbers)?;
    let relaxed = &held * strained.solve(held.transpose() * (&stiffness * &moved));
    let constrained = moved - relaxed;
    Ok(Mat::from_fn(size, size, |i, j| unit[i] * if j < count { constrained[(i, j)] } else { modes[(i, j - count)] }))
}

/// Number of singular values that are more than rounding.
fn rank(values: &[f64]) -> usize {
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().filter(|value| **value > DEPENDENT * largest).count()
}
