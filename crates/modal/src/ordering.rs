//! Nested dissection of the graph of the nodes, by METIS.
//!
//! The three degrees of freedom of a node stay together, so the graph to order is a ninth of the matrix.

use faer::perm::Perm;
use faer::sparse::SymbolicSparseColMatRef;

use crate::error::ModalError;

/// A fill-reducing ordering of the degrees of freedom of a matrix with 3×3 blocks.
pub(crate) fn nested_dissection(pattern: SymbolicSparseColMatRef<'_, usize>) -> Result<Perm<usize>, ModalError> {
    let n = pattern.ncols() / 3;
    let mut start: Vec<metis_sys::idx_t> = Vec::with_capacity(n + 1);
    let mut neighbours: Vec<metis_sys::idx_t> = Vec::new();
    start.push(0);
    for node in 0..n {
        let begin = neighbours.len();
        for column in 3 * node..3 * node + 3 {
            neighbours.extend(pattern.row_idx_of_col_raw(column).iter().map(|row| (row / 3) as metis_sys::idx_t));
        }
        let mut of_node = neighbours.split_off(begin);
        of_node.sort_unstable();
        of_node.dedup();
        neighbours.extend(of_node.into_iter().filter(|other| *other as usize != node));
        start.push(neighbours.len() as metis_sys::idx_t);
    }
    let (mut order, mut place) = (vec![0; n], vec![0; n]);
    dissect(&mut start, &mut neighbours, &mut order, &mut place)?;

    let expand = |nodes: Vec<metis_sys::idx_t>| -> Box<[usize]> {
        nodes.into_iter().flat_map(|node| (0..3).map(move |axis| 3 * node as usize + axis)).collect()
    };
    Ok(Perm::new_checked(expand(order), expand(place), 3 * n))
}

/// METIS_NodeND: `order[new] = old`, `place[old] = new`.
fn dissect(
    start: &mut [metis_sys::idx_t],
    neighbours: &mut [metis_sys::idx_t],
    order: &mut [metis_sys::idx_t],
    place: &mut [metis_sys::idx_t],
) -> Result<(), ModalError> {
    if neighbours.is_empty() {
        // METIS wants an edge; without any, every order is as good.
        for (i, (order, place)) in order.iter_mut().zip(place).enumerate() {
            (*order, *place) = (i as metis_sys::idx_t, i as metis_sys::idx_t);
        }
        return Ok(());
    }
    let mut n = order.len() as metis_sys::idx_t;
    // SAFETY: METIS has no other interface than C. The arrays are a valid compressed graph of n nodes
    // (start has n + 1 entries, the last of them neighbours.len(), every neighbour is below n), the two results
    // have room for n numbers, and null pointers stand for "no weights" and "default options" as its manual says.
    #[allow(unsafe_code)]
    let status = unsafe {
        metis_sys::METIS_NodeND(
            &mut n,
            start.as_mut_ptr(),
            neighbours.as_mut_ptr(),
            std::ptr::null_mut(),
            std::ptr::null_mut(),
            order.as_mut_ptr(),
            place.as_mut_ptr(),
        )
    };
    if status == metis_sys::rstatus_et_METIS_OK { Ok(()) } else { Err(ModalError::Ordering { status }) }
}
