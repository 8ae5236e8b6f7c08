//! Checks of the positions of nodes.

use crate::error::ModalError;

/// Refuses positions that are not finite.
pub(crate) fn check_finite(positions: &[[f64; 3]]) -> Result<(), ModalError> {
    match positions.iter().enumerate().find_map(|(i, x)| x.iter().find(|c| !c.is_finite()).map(|c| (i, *c))) {
        Some((index, value)) => Err(ModalError::NotFinite { what: "positions", place: "node", index, value }),
        None => Ok(()),
    }
}

/// Refuses positions of more or fewer nodes than a mass matrix has, and of none.
pub(crate) fn check_count(positions: &[[f64; 3]], nodes: usize) -> Result<(), ModalError> {
    if positions.len() == nodes && nodes > 0 {
        return Ok(());
    }
    let what = "the list of positions";
    Err(ModalError::Length { what, found: positions.len(), expected: nodes.max(1) })
}
