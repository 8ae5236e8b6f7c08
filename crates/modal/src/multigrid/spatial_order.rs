//! Nodes in an order in which neighbours in space are near to each other in memory.
//!
//! A mesh generator numbers the corners first and then the middles of the edges, surface by surface. Products over nodes then
//! wait for memory: in this order they take two thirds of the time.

use crate::matrix::renumbering::Renumbering;

/// Bits of each coordinate.
const BITS: u32 = 21;

/// The order of the places on a Z-shaped curve through space: Morton (1966).
pub(crate) fn spatial_order(positions: &[[f64; 3]]) -> Renumbering {
    let least = |axis: usize| positions.iter().map(|at| at[axis]).fold(f64::INFINITY, f64::min);
    let corner = [0, 1, 2].map(least);
    let length = positions.iter().flat_map(|at| [0, 1, 2].map(|axis| at[axis] - corner[axis])).fold(0.0, f64::max);
    let steps = f64::from((1_u32 << BITS) - 1) / length.max(f64::MIN_POSITIVE);
    let on_curve = |at: &[f64; 3]| {
        let cell: [u64; 3] = std::array::from_fn(|axis| ((at[axis] - corner[axis]) * steps) as u64);
        (0..BITS)
            .flat_map(|bit| (0..3).map(move |axis| (bit, axis)))
            .fold(0, |place: u64, (bit, axis)| place | (cell[axis] >> bit & 1) << (3 * bit + axis as u32))
    };
    let mut sorted: Vec<(u64, u32)> = positions.iter().zip(0..).map(|(at, node)| (on_curve(at), node)).collect();
    sorted.sort_unstable();
    Renumbering::new(sorted.into_iter().map(|(_, node)| node).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multigrid::coarse::tests::Block;

    #[test]
    fn neighbours_in_space_are_near() {
        let block = Block::new([8, 8, 8]);
        let order = spatial_order(block.mesh.positions());
        let pairs = block.stiffness().pairs();
        let distance = |node: usize, other: u32| order.place(node as u32).abs_diff(order.place(other));
        let distances = (0..pairs.count()).flat_map(|node| pairs.of(node).iter().map(move |other| (node, *other)));
        let mut distances: Vec<u32> = distances.map(|(node, other)| distance(node, other)).collect();
        let [middle, count] = [distances.len() / 2, pairs.count()];
        let median = *distances.select_nth_unstable(middle).1 as usize;
        assert!(median < count / 40, "{median} of {count}");
    }
}
