//! Nested dissection of the graph of the nodes, by METIS.
//!
//! The three degrees of freedom of a node stay together, so the graph to order is a ninth of the matrix.

use std::sync::{Mutex, PoisonError};

use faer::perm::Perm;
use faer::sparse::SymbolicSparseColMatRef;

use crate::error::ModalError;
use crate::symmetry::check_symmetric;

/// What METIS allocates at most, bytes: its own weights, and the coarser graphs.
const ORDERING_PER_NODE: usize = 128;
const ORDERING_PER_NEIGHBOUR: usize = 24;

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

/// Nested dissection: `order[new] = old`, `place[old] = new`.
///
/// By METIS_NodeNDP for one processor, which orders as METIS_NodeND does. That one catches SIGTERM and SIGABRT while it
/// works: a request to stop would end as an error of METIS, and the handlers of the program would be put back without
/// their flags. What METIS_NodeND catches them for is memory that runs out, so room is made sure of before.
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
    let n = order.len() as metis_sys::idx_t;
    // METIS gives the sizes of the top separators, 2 processors − 1 of them.
    let mut sizes = [0];
    // A poisoned lock is as good: METIS seeds its generator anew in every call.
    let _one_at_a_time = METIS.lock().unwrap_or_else(PoisonError::into_inner);
    memory::check("the ordering", ordering_bytes(order.len(), neighbours.len()))?;
    // SAFETY: METIS has no other interface than C. The arrays are a valid compressed graph of n nodes (start has n + 1
    // entries, the last of them neighbours.len(), every neighbour is below n and has the node for a neighbour), the two
    // results have room for n numbers and `sizes` for one, null pointers stand for "no weights" and "default options" as
    // its manual says, and the lock keeps a second call out.
    #[allow(unsafe_code)]
    let status = unsafe {
        metis_sys::METIS_NodeNDP(
            n,
            start.as_mut_ptr(),
            neighbours.as_mut_ptr(),
            std::ptr::null_mut(),
            1,
            std::ptr::null_mut(),
            order.as_mut_ptr(),
            place.as_mut_ptr(),
            sizes.as_mut_ptr(),
        )
    };
    if status == metis_sys::rstatus_et_METIS_OK { Ok(()) } else { Err(ModalError::Ordering { status }) }
}

/// What METIS allocates at most for a graph, bytes.
pub(crate) fn ordering_bytes(nodes: usize, neighbours: usize) -> usize {
    ORDERING_PER_NODE * nodes + ORDERING_PER_NEIGHBOUR * neighbours
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    use faer::sparse::SymbolicSparseColMat;
    use signal_hook::consts::SIGTERM;
    use signal_hook::low_level::raise;

    use super::*;

    /// The pattern of a body whose nodes are a cube of `side`³, each coupled to those around it.
    fn cube(side: usize) -> SymbolicSparseColMat<usize> {
        let near = |x: usize| x.saturating_sub(1)..(x + 2).min(side);
        let (mut start, mut rows) = (vec![0], Vec::new());
        for node in 0..side.pow(3) {
            for _axis in 0..3 {
                for z in near(node / side.pow(2)) {
                    for y in near(node / side % side) {
                        for x in near(node % side) {
                            rows.extend((0..3).map(|axis| 3 * ((z * side + y) * side + x) + axis));
                        }
                    }
                }
                start.push(rows.len());
            }
        }
        SymbolicSparseColMat::new_checked(3 * side.pow(3), 3 * side.pow(3), start, None, rows)
    }

    #[test]
    fn a_request_to_stop_reaches_the_program_while_metis_works() {
        let heard: &AtomicUsize = Box::leak(Box::default());
        // SAFETY: the action only adds to a counter.
        #[allow(unsafe_code)]
        let registered =
            unsafe { signal_hook::low_level::register(SIGTERM, || _ = heard.fetch_add(1, Ordering::SeqCst)) };
        registered.unwrap();
        let pattern = cube(16);
        let expected = nested_dissection(pattern.as_ref()).unwrap();
        let done = Arc::new(AtomicBool::new(false));
        let ordering = {
            let done = done.clone();
            std::thread::spawn(move || {
                let orderings: Vec<_> = (0..5).map(|_| nested_dissection(pattern.as_ref())).collect();
                done.store(true, Ordering::SeqCst);
                orderings
            })
        };
        let mut raised = 0;
        while !done.load(Ordering::SeqCst) {
            raise(SIGTERM).unwrap();
            raised += 1;
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        for found in ordering.join().unwrap() {
            assert_eq!(found.unwrap().arrays(), expected.arrays());
        }
        raise(SIGTERM).unwrap();
        assert!(raised > 5 && heard.load(Ordering::SeqCst) == raised + 1);
    }
}
