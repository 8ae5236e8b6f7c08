//! Checks of what is given: sizes, and numbers that are not finite.

use faer::MatRef;
use faer::sparse::SparseColMatRef;

use crate::error::ModalError;

/// Refuses numbers that are not finite, in groups that are counted as `place`s.
pub(crate) fn check_finite<I: IntoIterator<Item = f64>>(
    what: &'static str,
    place: &'static str,
    groups: impl IntoIterator<Item = I>,
) -> Result<(), ModalError> {
    for (index, group) in groups.into_iter().enumerate() {
        if let Some(value) = group.into_iter().find(|value| !value.is_finite()) {
            return Err(ModalError::NotFinite { what, place, index, value });
        }
    }
    Ok(())
}

/// The same of numbers that are counted one by one.
pub(crate) fn check_finite_entries(
    what: &'static str,
    values: impl IntoIterator<Item = f64>,
) -> Result<(), ModalError> {
    check_finite(what, "entry", values.into_iter().map(|value| [value]))
}

/// The same of vectors (N×k).
pub(crate) fn check_finite_columns(what: &'static str, vectors: MatRef<'_, f64>) -> Result<(), ModalError> {
    check_finite(what, "column", vectors.col_iter().map(|vector| vector.iter().copied()))
}

/// The same of the positions of nodes.
pub(crate) fn check_finite_positions(positions: &[[f64; 3]]) -> Result<(), ModalError> {
    check_finite("positions", "node", positions.iter().copied())
}

/// Refuses held nodes, and degrees of freedom (pairs of a node and its degree of freedom), that are not there: of `count`
/// nodes with `dofs_of_node` each.
pub(crate) fn check_held(
    nodes: &[u32],
    dofs: &[(u32, usize)],
    count: usize,
    dofs_of_node: usize,
) -> Result<(), ModalError> {
    let mut held = nodes.iter().copied().chain(dofs.iter().map(|(node, _)| *node));
    if let Some(node) = held.find(|node| *node as usize >= count) {
        return Err(ModalError::HeldNode { node, count });
    }
    if let Some(&(node, dof)) = dofs.iter().find(|(_, dof)| *dof >= dofs_of_node) {
        return Err(ModalError::HeldFreedom { node, dof, count: dofs_of_node });
    }
    Ok(())
}

/// Refuses ends of edges for another number of nodes, and ends that are no corners.
pub(crate) fn check_edge_ends(edge_ends: &[[u32; 2]], nodes: usize) -> Result<(), ModalError> {
    if edge_ends.len() != nodes {
        let what = "the ends of the edges of nodes";
        return Err(ModalError::Length { what, found: edge_ends.len(), expected: nodes });
    }
    for (node, ends) in edge_ends.iter().enumerate() {
        for end in ends {
            match edge_ends.get(*end as usize) {
                None => return Err(ModalError::NoNode { node: *end, count: nodes }),
                Some(of_end) if *of_end != [*end; 2] => return Err(ModalError::NoCorner { node, end: *end }),
                Some(_) => {}
            }
        }
    }
    Ok(())
}

/// Refuses another number of rows than expected, and none.
pub(crate) fn check_rows(what: &'static str, found: usize, expected: usize) -> Result<(), ModalError> {
    if found == expected && found > 0 { Ok(()) } else { Err(ModalError::Size { what, expected, found }) }
}

/// Refuses a matrix (N×N, with N = `expected`) of another size, and entries that are not finite.
pub(crate) fn check_matrix(
    what: &'static str,
    matrix: SparseColMatRef<'_, usize, f64>,
    expected: usize,
) -> Result<(), ModalError> {
    check_rows(what, matrix.nrows(), expected)?;
    check_rows(what, matrix.ncols(), expected)?;
    check_finite(what, "column", (0..expected).map(|column| matrix.val_of_col(column).iter().copied()))
}
