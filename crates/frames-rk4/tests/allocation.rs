//! A step allocates nothing.

#[allow(dead_code)] // shared with the other tests, which use all of it
mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use frames_rk4::Initial;
use nalgebra::Vector3;

thread_local! {
    /// Allocations on this thread; the test harness has others.
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_step_allocates_nothing() {
    let ring = common::ring();
    let load = ring.half_sine([-100.0, 0.0, 0.0], [1.0, 2.0, 3.0], 1.0);
    let initial = Initial { omega: Vector3::new(4.0, -6.0, 7.0), ..Initial::at_rest(10) };
    let mut scheme = ring.scheme(0.05, vec![load], &initial, 5e-5);
    let before = COUNT.get();
    common::advance(&mut scheme, 1000);
    assert_eq!(COUNT.get(), before);
    // The counter counts: a copy of the state has lists.
    let copy = scheme.state().clone();
    assert!(COUNT.get() > before, "{}", copy.time);
}
