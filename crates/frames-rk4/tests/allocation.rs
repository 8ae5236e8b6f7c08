//! A step allocates nothing.

#[allow(dead_code)] // shared with the other test program, which uses all of it
mod common;

use allocation_counter::measure;
use common::Synthesis as _;
use dynamics::Initial;
use nalgebra::Vector3;

#[test]
fn a_step_of_the_paper_s_scheme_allocates_nothing() {
    let ring = common::ring();
    let load = ring.half_sine([-100.0, 0.0, 0.0], [1.0, 2.0, 3.0], 1.0);
    let initial = Initial { omega: Vector3::new(4.0, -6.0, 7.0), ..Initial::at_rest(10) };
    let mut scheme = ring.scheme(0.05, vec![load], &initial, 5e-5);
    assert_eq!(measure(|| common::advance(&mut scheme, 1000)).count_total, 0);
    // The counter counts: a copy of the state has lists.
    assert!(measure(|| drop(scheme.state().clone())).count_total > 0);
}
