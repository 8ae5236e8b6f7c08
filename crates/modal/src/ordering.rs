//! Nested dissection of the graph of the nodes, by METIS.
//!
//! The three degrees of freedom of a node stay together, so the graph to order is a ninth of the matrix.

use std::sync::{Mutex, PoisonError};

use faer::perm::Perm;
use faer::sparse::SymbolicSparseColMatRef;

use crate::error::ModalError;
use crate::symmetry::check_symmetric;

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
    if neighbours.len() > metis_sys::idx_t::MAX as usize {
        let reason = "the graph of the nodes is too large for METIS".to_owned();
        return Err(ModalError::Factorization { size: 3 * n, reason });
    }
    // METIS takes it for granted; zeros that are stored on one side only would break it.
    let offsets: Vec<usize> = start.iter().map(|s| *s as usize).collect();
    check_symmetric(
        "stored pattern of the shifted stiffness",
        3,
        &offsets,
        |entry| neighbours[entry] as usize,
        |_| 0.0,
    )?;
    let (mut order, mut place) = (vec![0; n], vec![0; n]);
    dissect(&mut start, &mut neighbours, &mut order, &mut place)?;

    let expand = |nodes: Vec<metis_sys::idx_t>| -> Box<[usize]> {
        nodes.into_iter().flat_map(|node| (0..3).map(move |axis| 3 * node as usize + axis)).collect()
    };
    Ok(Perm::new_checked(expand(order), expand(place), 3 * n))
}

/// METIS has one random number generator for the whole process: two calls at a time would race for it, and the
/// ordering, with it the last digits of the modes, would differ from run to run.
static METIS: Mutex<()> = Mutex::new(());

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
    // A poisoned lock is as good: METIS seeds its generator anew in every call.
    let _one_at_a_time = METIS.lock().unwrap_or_else(PoisonError::into_inner);
    // SAFETY: METIS has no other interface than C. The arrays are a valid compressed graph of n nodes (start has n + 1
    // entries, the last of them neighbours.len(), every neighbour is below n and has the node for a neighbour), the two
    // results have room for n numbers, null pointers stand for "no weights" and "default options" as its manual says,
    // and the lock keeps a second call out.
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
