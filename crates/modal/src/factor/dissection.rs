//! Nested dissection by METIS.

use std::sync::{Mutex, PoisonError};

pub(crate) use metis_sys::idx_t;

use crate::error::ModalError;

/// METIS has one random number generator for the whole process: two calls at a time would race for it, and the
/// ordering, with it the last digits of the modes, would differ from run to run.
static METIS: Mutex<()> = Mutex::new(());

/// Nested dissection: `order[new] = old`, `place[old] = new`.
///
/// By METIS_NodeNDP for one processor, which orders as METIS_NodeND does. That one catches SIGTERM and SIGABRT while it
/// works: a request to stop would end as an error of METIS, and the handlers of the program would be put back without
/// their flags. What METIS_NodeND catches them for is memory that runs out, so room is made sure of before.
pub(crate) fn dissect(
    start: &mut [idx_t],
    neighbours: &mut [idx_t],
    order: &mut [idx_t],
    place: &mut [idx_t],
) -> Result<(), ModalError> {
    if neighbours.is_empty() {
        // METIS wants an edge; without any, every order is as good.
        for (i, (order, place)) in order.iter_mut().zip(place).enumerate() {
            (*order, *place) = (i as idx_t, i as idx_t);
        }
        return Ok(());
    }
    let n = order.len() as idx_t;
    // METIS gives the sizes of the top separators, 2 processors − 1 of them.
    let mut sizes = [0];
    // A poisoned lock is as good: METIS seeds its generator anew in every call.
    let _one_at_a_time = METIS.lock().unwrap_or_else(PoisonError::into_inner);
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
