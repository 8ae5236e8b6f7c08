//! Where the nodes are that CalculiX makes of the nodes of shells and beams.
//!
//! CalculiX computes with solid elements in their place, and says of each row of the matrices only the label of the node of
//! the shell. A corner of a quadratic shell becomes three nodes across the thickness, a mid-edge two; their mean is the node
//! itself. The rest is in the stiffness matrix: its null space has the six rigid motions, so with an orthonormal basis of it
//! each node j has six known vectors
//!
//! ```text
//! n_kj = a_k + ω_k × x_j,   k = 1 … 6
//! ```
//!
//! a_k and ω_k follow by least squares from the nodes of the shell, whose positions are known, and then every x_j.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use crate::error::MatrixError;
use crate::source::Source;

/// Shift of K, relative to the mean of its diagonal, so that it can be factored.
const SHIFT: f64 = 1e-11;
/// Iterations at the most. Each shrinks what does not belong to the null space by the shift over the lowest eigenvalue of K.
const MOST: usize = 60;
/// ‖K n‖ relative to ‖D n‖, D the diagonal of K, of a basis that is good.
const NULL: f64 = 1e-12;
/// Rigid motions that fit the nodes of the shell worse than this, relative to its size, are none.
const FIT: f64 = 1e-6;
/// Nodes whose smallest extent is below this fraction of the largest are on a line.
const LINE: f64 = 1e-6;

/// The positions of all nodes of the body: `nodes` are those of the shell that they belong to, at `positions`.
pub(crate) fn positions(
    source: &Source<'_>,
    stiffness: &SparseColMat<usize, f64>,
    nodes: &[u32],
    positions: &[[f64; 3]],
) -> Result<Vec<[f64; 3]>, MatrixError> {
    let count = nodes.iter().map(|node| 1 + *node as usize).max().unwrap_or_default();
    let mut copies: Vec<Vec<usize>> = vec![Vec::new(); count];
    nodes.iter().enumerate().for_each(|(copy, node)| copies[*node as usize].push(copy));
    let used: Vec<usize> = (0..count).filter(|node| !copies[*node].is_empty()).collect();
    // Measured from their mean in units of their size.
    let mean = used.iter().map(|node| Vector3::from(positions[*node])).sum::<Vector3<f64>>() / used.len() as f64;
    let size = used.iter().map(|node| (Vector3::from(positions[*node]) - mean).norm()).fold(0.0, f64::max);
    let refuse = |found: String, help: &str| {
        let expected = "the six rigid motions of a shell whose nodes these are";
        source.refuse(None, found, expected, help)
    };
    let at = |node: usize| (Vector3::from(positions[node]) - mean) / size;
    let second: Matrix3<f64> = used.iter().map(|node| at(*node) * at(*node).transpose()).sum();
    if !second.iter().all(|entry| entry.is_finite()) {
        return Err(refuse(
            format!("nodes whose distance is {size:e}"),
            "give each node its position, in a usual unit of length",
        ));
    }
    let mut extents: [f64; 3] = second.symmetric_eigenvalues().into();
    extents.sort_by(f64::total_cmp);
    if extents[1] <= LINE * LINE * extents[2] {
        return Err(refuse(
            "nodes on a line, which several nodes of the matrices stand for: where these are cannot be found"
                .to_owned(),
            "model a straight beam with solid elements; curved ones and shells can be read",
        ));
    }

    let first = Mat::from_fn(3 * nodes.len(), 6, |i, k| {
        let (x, axis) = (at(nodes[i / 3] as usize), i % 3);
        match k.checked_sub(3) {
            None => f64::from(u8::from(axis == k)),
            Some(about) => Vector3::ith(about, 1.0).cross(&x)[axis],
        }
    });
    let basis = null_space(stiffness, first)
        .ok_or_else(|| refuse("a stiffness matrix that cannot be factored".to_owned(), "write the matrices again"))?;
    let vector = |copy: usize, k: usize| Vector3::from_fn(|axis, _| basis[(3 * copy + axis, k)]);
    let of_node = |node: usize, k: usize| {
        let copies = &copies[node];
        copies.iter().map(|copy| vector(*copy, k)).sum::<Vector3<f64>>() / copies.len() as f64
    };

    // a_k and ω_k: rows [I, −[x×]] of all nodes of the shell.
    let rows = DMatrix::from_fn(3 * used.len(), 6, |i, j| {
        let (x, axis) = (at(used[i / 3]), i % 3);
        if j < 3 { f64::from(u8::from(axis == j)) } else { -x.cross_matrix()[(axis, j - 3)] }
    });
    let decomposed = rows.clone().svd(true, true);
    let (mut motions, mut misfit, mut largest) = (Vec::new(), 0.0_f64, 0.0_f64);
    for k in 0..6 {
        let known = DVector::from_fn(3 * used.len(), |i, _| of_node(used[i / 3], k)[i % 3]);
        let Ok(fitted) = decomposed.solve(&known, 1e-12) else {
            return Err(refuse("rigid motions that cannot be found".to_owned(), "write the matrices again"));
        };
        misfit = misfit.max((&rows * &fitted - &known).amax());
        largest = largest.max(known.amax());
        motions.push((Vector3::new(fitted[0], fitted[1], fitted[2]), Vector3::new(fitted[3], fitted[4], fitted[5])));
    }
    if misfit > FIT * largest {
        return Err(refuse(
            format!("motions without stiffness that are off those of the nodes by {:.1e}", misfit / largest),
            "name the nodes that the matrices were written with, without *BOUNDARY; shells that meet at an angle, in threes, or with \
             other thicknesses have degrees of freedom that are no translations: model them with solid elements",
        ));
    }
    let normal: Matrix3<f64> =
        motions.iter().map(|(_, turned)| turned.cross_matrix().tr_mul(&turned.cross_matrix())).sum();
    let Some(inverse) = normal.try_inverse() else {
        return Err(refuse("a null space without rotations".to_owned(), "write the matrices without *BOUNDARY"));
    };
    let found = |copy: usize| {
        let moved = |(k, (shift, turned)): (usize, &(Vector3<f64>, Vector3<f64>))| {
            turned.cross_matrix().tr_mul(&(vector(copy, k) - shift))
        };
        let x: Vector3<f64> = inverse * motions.iter().enumerate().map(moved).sum::<Vector3<f64>>();
        (mean + x * size).into()
    };
    Ok((0..nodes.len()).map(found).collect())
}

/// An orthonormal basis of what K does not resist, six fields, by inverse iteration from `first`.
fn null_space(stiffness: &SparseColMat<usize, f64>, first: Mat<f64>) -> Option<Mat<f64>> {
    let n = stiffness.ncols();
    let diagonal: Vec<f64> = (0..n).map(|i| stiffness.get(i, i).copied().unwrap_or_default()).collect();
    let shift = SHIFT * diagonal.iter().sum::<f64>() / n as f64;
    let entries = stiffness.triplet_iter().map(|entry| Triplet::new(entry.row, entry.col, *entry.val));
    let entries: Vec<_> = entries.chain((0..n).map(|i| Triplet::new(i, i, shift))).collect();
    let factor =
        SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &entries).ok()?.sp_cholesky(Side::Lower).ok()?;
    let mut basis = first.qr().compute_thin_Q();
    let mut best = f64::INFINITY;
    for _ in 0..MOST {
        let next = factor.solve(&basis).qr().compute_thin_Q();
        let forces = stiffness.as_ref() * next.as_ref();
        let scaled = Mat::from_fn(n, 6, |i, k| diagonal[i] * next[(i, k)]);
        let residual = forces.norm_l2() / scaled.norm_l2();
        // Where it does not shrink any more, it is rounding, or there is no such space: the caller looks at it.
        let has_stopped = residual > 0.5 * best;
        basis = next;
        best = best.min(residual);
        if residual < NULL || has_stopped {
            break;
        }
    }
    Some(basis)
}
