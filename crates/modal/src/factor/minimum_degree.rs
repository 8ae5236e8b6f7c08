//! The order of the nodes on WebAssembly, which no C compiler of ours builds METIS for: approximate minimum degree, of faer.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::error::ModalError;

/// Numbers of nodes, as METIS has them.
#[allow(non_camel_case_types)]
pub(crate) type idx_t = i32;

/// `order[new] = old`, `place[old] = new`: the same as nested dissection gives, with more fill on large meshes.
pub(crate) fn dissect(
    start: &mut [idx_t],
    neighbours: &mut [idx_t],
    order: &mut [idx_t],
    place: &mut [idx_t],
) -> Result<(), ModalError> {
    let n = order.len();
    let list = |numbers: &[idx_t]| numbers.iter().map(|number| *number as usize).collect::<Vec<_>>();
    let (start, neighbours) = (list(start), list(neighbours));
    let graph = SymbolicSparseColMatRef::new_unsorted_checked(n, n, &start, None, &neighbours);
    let (mut new, mut old) = (vec![0; n], vec![0; n]);
    let mut memory = MemBuffer::new(amd::order_maybe_unsorted_scratch::<usize>(n, neighbours.len()));
    amd::order_maybe_unsorted(&mut new, &mut old, graph, amd::Control::default(), MemStack::new(&mut memory))
        .map_err(|error| ModalError::Factorization { size: 3 * n, reason: format!("{error:?}") })?;
    for (to, from) in [(order, new), (place, old)] {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = from as idx_t);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_star_comes_last_and_both_lists_are_inverse() {
        // Node 0 is coupled to all others, which are coupled to nothing else.
        let (mut start, mut neighbours) = (vec![0, 5, 6, 7, 8, 9, 10], vec![1, 2, 3, 4, 5, 0, 0, 0, 0, 0]);
        let (mut order, mut place) = (vec![0; 6], vec![0; 6]);
        dissect(&mut start, &mut neighbours, &mut order, &mut place).unwrap();
        assert!(place[0] >= 4, "{place:?}");
        assert!((0..6).all(|node| order[place[node] as usize] == node as idx_t), "{order:?} {place:?}");
    }
}
