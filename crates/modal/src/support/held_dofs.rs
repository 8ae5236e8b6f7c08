//! The rigid motions that single degrees of freedom leave, from the geometry.
//!
//! A rigid motion is a velocity v of a point and an angular velocity ω. Each held degree of freedom is one equation on
//! them: `e·(v + ω×r) = 0` of a translation, `e·ω = 0` of a rotation. What solves all of them is left. Where it is what a
//! pin, a hinge, a slider or a clamp leaves, it is called that.

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::error::ModalError;
use crate::input::{check_finite_positions, check_held};
use crate::support::constraints::{NEGLIGIBLE, extent};
use crate::support::held::Support;
use reduced_body::{RigidMotion, Twist};

/// A component of a unit vector below this is rounding.
const ROUNDING: f64 = 1e-12;

impl Support {
    /// Support of a body with nodes at `positions` that is held in single degrees of freedom, `(node, 0..6)`: translations along
    /// the axes of the mesh, then rotations about them. The rigid motions that are left come from the geometry.
    ///
    /// ```
    /// use modal::Support;
    ///
    /// // A beam along x, held at both ends as on a pin and a roller.
    /// let positions = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    /// let support = Support::of_dofs(&positions, &[(0, 0), (0, 1), (0, 2), (0, 3), (2, 1), (2, 2)])?;
    /// assert_eq!(support.motion.count(), 0);
    /// # Ok::<(), modal::ModalError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModalError::HeldNode`], [`ModalError::HeldFreedom`], [`ModalError::NotFinite`].
    pub fn of_dofs(positions: &[[f64; 3]], dofs: &[(u32, usize)]) -> Result<Self, ModalError> {
        Ok(Self { motion: motion_left(positions, dofs)?, nodes: Vec::new(), dofs: dofs.to_vec() })
    }
}

/// The motion that holding `dofs` (pairs of a node and a degree of freedom, 0 to 5) leaves a body.
///
/// # Errors
/// [`ModalError::HeldNode`], [`ModalError::HeldFreedom`], [`ModalError::NotFinite`].
fn motion_left(positions: &[[f64; 3]], dofs: &[(u32, usize)]) -> Result<RigidMotion, ModalError> {
    check_held(&[], dofs, positions.len(), 6)?;
    check_finite_positions(positions)?;
    let at = |node: u32| Vector3::from(positions[node as usize]);
    let (_, length) = extent(positions);
    let origin = dofs.iter().map(|(node, _)| at(*node)).sum::<Vector3<f64>>() / dofs.len().max(1) as f64;

    // Rows of at least six equations for v and length·ω.
    let mut equations = DMatrix::zeros(dofs.len().max(6), 6);
    for (row, (node, dof)) in dofs.iter().enumerate() {
        let direction = Vector3::ith(dof % 3, 1.0);
        if *dof < 3 {
            let turned = (at(*node) - origin).cross(&direction) / length;
            equations.fixed_view_mut::<1, 3>(row, 0).tr_copy_from(&direction);
            equations.fixed_view_mut::<1, 3>(row, 3).tr_copy_from(&turned);
        } else {
            equations.fixed_view_mut::<1, 3>(row, 3).tr_copy_from(&direction);
        }
    }
    let limit = NEGLIGIBLE * (dofs.len().max(1) as f64).sqrt();
    let motions = null_space(&equations, limit);
    let velocities = motions.rows(0, 3).into_owned();
    let turns = motions.rows(3, 3).into_owned();

    // Combinations without rotation, and those across them.
    let unturned = null_space(&turns, NEGLIGIBLE);
    let translations: Vec<Vector3<f64>> = columns(&(&velocities * &unturned));
    let turning = null_space(&padded(&unturned.transpose()), NEGLIGIBLE);
    let turning = Twists { velocities: columns(&(&velocities * &turning)), turns: columns(&(&turns * &turning)) };
    Ok(named(&translations, &turning, origin, length))
}

/// Motions that turn the body: velocities of the origin, and angular velocities times the length of the body.
struct Twists {
    velocities: Vec<Vector3<f64>>,
    turns: Vec<Vector3<f64>>,
}

/// The motion as a pin, a hinge, a slider, a clamp or none of these leave it.
fn named(translations: &[Vector3<f64>], turning: &Twists, origin: Vector3<f64>, length: f64) -> RigidMotion {
    match (translations, &turning.turns[..]) {
        ([], []) => return RigidMotion::clamp(origin),
        ([_, _, _], [_, _, _]) => return RigidMotion::free(),
        ([direction], []) => return RigidMotion::slider(toward_positive(direction.normalize())),
        ([], [turn]) => {
            let (velocity, axis) = (turning.velocities[0] / turn.norm(), turn.normalize());
            if velocity.dot(&axis).abs() < NEGLIGIBLE {
                return RigidMotion::hinge(origin + axis.cross(&velocity) * length, toward_positive(axis));
            }
        }
        ([], [a, b, c]) => {
            // v = S ω, and S is [p×] where all of them leave the point p where it is: p×ω = −ω×p.
            let of = |columns: &[Vector3<f64>]| Matrix3::from_columns(columns);
            if let Some(inverse) = of(&[*a, *b, *c]).try_inverse() {
                let velocity = of(&turning.velocities) * inverse;
                let skew = 0.5 * (velocity - velocity.transpose());
                if (velocity - skew).norm() < NEGLIGIBLE {
                    let point = Vector3::new(skew[(2, 1)], skew[(0, 2)], skew[(1, 0)]);
                    return RigidMotion::pin(origin + point * length);
                }
            }
        }
        _ => {}
    }
    let unturned = translations.iter().map(|velocity| Twist { velocity: *velocity, rotation: Vector3::zeros() });
    let turning = turning.velocities.iter().zip(&turning.turns);
    let turning = turning.map(|(velocity, turn)| Twist { velocity: *velocity, rotation: turn / length });
    RigidMotion::other(origin, unturned.chain(turning))
}

/// The unit vector or its opposite: the first component that is not small is positive.
fn toward_positive(direction: Vector3<f64>) -> Vector3<f64> {
    let leading = direction.iter().copied().find(|c| c.abs() > NEGLIGIBLE).unwrap_or(1.0);
    let turned = if leading < 0.0 { -direction } else { direction };
    // Rounding beside a unit vector along an axis.
    turned.map(|c| if c.abs() < ROUNDING { 0.0 } else { c })
}

fn columns(matrix: &DMatrix<f64>) -> Vec<Vector3<f64>> {
    matrix.column_iter().map(|column| Vector3::new(column[0], column[1], column[2])).collect()
}

/// With rows of zeros, where there are fewer rows than columns.
fn padded(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let rows = matrix.nrows().max(matrix.ncols());
    matrix.clone().resize_vertically(rows, 0.0)
}

/// An orthonormal basis of what the matrix takes to less than `limit` of itself.
fn null_space(matrix: &DMatrix<f64>, limit: f64) -> DMatrix<f64> {
    let size = matrix.ncols();
    let Some(factors) = (size > 0).then(|| padded(matrix).svd(false, true)) else { return DMatrix::zeros(0, 0) };
    let Some(right) = factors.v_t else { return DMatrix::zeros(size, 0) };
    let kept: Vec<usize> = (0..size).filter(|k| factors.singular_values[*k] <= limit).collect();
    DMatrix::from_fn(size, kept.len(), |i, j| right[(kept[j], i)])
}
