//! Nodes in an order in which neighbours in space are near to each other in memory.
//!
//! A mesh generator numbers the corners first and then the middles of the edges, surface by surface. Products over nodes then
//! wait for memory: in this order they take two thirds of the time.

use faer::{Mat, MatRef};

use crate::coarse::rows_at;
use crate::mass::NodalMass;
use crate::node_pairs::NodePairs;
use crate::stiffness::NodalStiffness;

/// Bits of each coordinate.
const BITS: u32 = 21;

/// The order of the places on a Z-shaped curve through space: Morton (1966).
pub(crate) struct SpatialOrder {
    /// The node at each place.
    nodes: Vec<u32>,
    /// The place of each node.
    places: Vec<u32>,
}

/// K and M of nodes in another order.
pub(crate) struct Reordered {
    stiffness: NodeValues,
    mass: NodeValues,
}

/// Values by pairs of nodes, in compressed columns.
struct NodeValues {
    start: Vec<usize>,
    nodes: Vec<u32>,
    values: Vec<f64>,
}

impl SpatialOrder {
    pub(crate) fn new(positions: &[[f64; 3]]) -> Self {
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
        let nodes: Vec<u32> = sorted.into_iter().map(|(_, node)| node).collect();
        let mut places = vec![0; nodes.len()];
        nodes.iter().zip(0..).for_each(|(node, place)| places[*node as usize] = place);
        Self { nodes, places }
    }

    /// What each node has, in this order.
    pub(crate) fn sorted<T: Copy>(&self, of_nodes: &[T]) -> Vec<T> {
        self.nodes.iter().map(|node| of_nodes[*node as usize]).collect()
    }

    /// The place of a node.
    pub(crate) fn place(&self, node: u32) -> u32 {
        self.places[node as usize]
    }

    /// The rows (3n×k) of nodes, in this order.
    pub(crate) fn rows(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        rows_at(&self.nodes, x)
    }

    /// Rows in this order, in that of the nodes.
    pub(crate) fn rows_of_nodes(&self, x: MatRef<'_, f64>) -> Mat<f64> {
        rows_at(&self.places, x)
    }

    /// K and M in this order.
    pub(crate) fn matrices(&self, stiffness: NodalStiffness<'_>, mass: &NodalMass<'_>) -> Reordered {
        let (blocks, masses) = (stiffness.blocks(), mass.values());
        Reordered {
            stiffness: self.values::<3>(stiffness.pairs(), blocks.values),
            mass: self.values::<1>(mass.pairs(), masses),
        }
    }

    /// Values of which a pair has D in each of D columns.
    fn values<const D: usize>(&self, pairs: NodePairs<'_>, values: &[f64]) -> NodeValues {
        let mut sorted = NodeValues {
            start: Vec::with_capacity(pairs.start.len()),
            nodes: Vec::with_capacity(pairs.nodes.len()),
            values: Vec::with_capacity(values.len()),
        };
        sorted.start.push(0);
        let mut row: Vec<(u32, usize)> = Vec::new();
        for node in &self.nodes {
            let first = pairs.start[*node as usize];
            row.clear();
            row.extend(pairs.of(*node as usize).iter().zip(0..).map(|(other, entry)| (self.place(*other), entry)));
            row.sort_unstable();
            sorted.nodes.extend(row.iter().map(|(place, _)| *place));
            sorted.start.push(sorted.nodes.len());
            for column in 0..D {
                let entries = values[D * (D * first + column * row.len())..].as_chunks::<D>().0;
                sorted.values.extend(row.iter().flat_map(|(_, entry)| entries[*entry]));
            }
        }
        sorted
    }
}

impl Reordered {
    /// K.
    pub(crate) fn stiffness(&self) -> NodalStiffness<'_> {
        let NodeValues { start, nodes, values } = &self.stiffness;
        NodalStiffness::of_checked(start, nodes, values)
    }

    /// M.
    pub(crate) fn mass(&self) -> NodalMass<'_> {
        let NodeValues { start, nodes, values } = &self.mass;
        NodalMass::of_checked_nodes(start, nodes, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coarse::tests::Block;
    use crate::lanczos::random_block;
    use crate::mass_matrix::MassMatrix;
    use crate::stiffness::StiffnessMatrix;

    #[test]
    fn matrices_in_this_order_are_the_same() {
        let block = Block::new([3, 4, 2]);
        let order = SpatialOrder::new(block.mesh.positions());
        let reordered = order.matrices(block.stiffness(), &block.mass());
        let x = random_block(3 * block.mesh.positions().len(), 3, &mut 5);
        assert_eq!(order.rows_of_nodes(order.rows(x.as_ref()).as_ref()), x);
        let products = |k: NodalStiffness<'_>, m: NodalMass<'_>, x: &Mat<f64>| {
            [StiffnessMatrix::Nodal(k).product(x.as_ref()), MassMatrix::Nodal(m).product(x.as_ref())]
        };
        let found = products(reordered.stiffness(), reordered.mass(), &order.rows(x.as_ref()));
        for (found, expected) in found.iter().zip(products(block.stiffness(), block.mass(), &x)) {
            let found = order.rows_of_nodes(found.as_ref());
            assert!((found - &expected).norm_max() < 1e-14 * expected.norm_max());
        }
    }

    #[test]
    fn neighbours_in_space_are_near() {
        let block = Block::new([8, 8, 8]);
        let order = SpatialOrder::new(block.mesh.positions());
        let pairs = block.stiffness().pairs();
        let distance = |node: usize, other: u32| order.places[node].abs_diff(order.place(other));
        let distances = (0..pairs.count()).flat_map(|node| pairs.of(node).iter().map(move |other| (node, *other)));
        let mut distances: Vec<u32> = distances.map(|(node, other)| distance(node, other)).collect();
        let [middle, count] = [distances.len() / 2, pairs.count()];
        let median = *distances.select_nth_unstable(middle).1 as usize;
        assert!(median < count / 40, "{median} of {count}");
    }
}
