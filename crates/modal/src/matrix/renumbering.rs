//! Nodes in another order, with what they have and the matrices over them.

use faer::reborrow::Reborrow;
use faer::{Mat, MatRef};

use crate::matrix::mass::NodalMass;
use crate::matrix::node_pairs::NodePairs;
use crate::matrix::stiffness::NodalStiffness;

/// An order of nodes.
pub(crate) struct Renumbering {
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
pub(crate) struct NodeValues {
    start: Vec<usize>,
    nodes: Vec<u32>,
    values: Vec<f64>,
}

impl Renumbering {
    /// By the node at each place.
    pub(crate) fn new(nodes: Vec<u32>) -> Self {
        let mut places = vec![0; nodes.len()];
        nodes.iter().zip(0..).for_each(|(node, place)| places[*node as usize] = place);
        Self { nodes, places }
    }

    /// Values of the nodes, in this order.
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

    /// Sorts rows in this order back into that of the nodes.
    pub(crate) fn restore(&self, x: &mut Mat<f64>) {
        let mut column = vec![0.0; x.nrows()];
        for x in x.col_iter_mut() {
            column.iter_mut().zip(x.rb().iter()).for_each(|(kept, x)| *kept = *x);
            for (row, x) in x.iter_mut().enumerate() {
                *x = column[3 * self.places[row / 3] as usize + row % 3];
            }
        }
    }

    /// K and M in this order.
    pub(crate) fn matrices(&self, stiffness: NodalStiffness<'_>, mass: &NodalMass<'_>) -> Reordered {
        Reordered { stiffness: self.values::<3>(stiffness.pairs(), stiffness.blocks().values), mass: self.mass(mass) }
    }

    /// M in this order.
    pub(crate) fn mass(&self, mass: &NodalMass<'_>) -> NodeValues {
        self.values::<1>(mass.pairs(), mass.values())
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
        self.mass.as_mass()
    }
}

impl NodeValues {
    /// A number of each pair as a mass matrix.
    pub(crate) fn as_mass(&self) -> NodalMass<'_> {
        NodalMass::of_checked_nodes(&self.start, &self.nodes, &self.values)
    }
}

/// The rows (3n×k) of these nodes, in their order.
pub(crate) fn rows_at(nodes: &[u32], x: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(3 * nodes.len(), x.ncols(), |row, k| x[(3 * nodes[row / 3] as usize + row % 3, k)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::lanczos::random_block;
    use crate::matrix::mass_matrix::MassMatrix;
    use crate::matrix::stiffness::StiffnessMatrix;
    use crate::multigrid::coarse::tests::Block;
    use crate::multigrid::spatial_order::spatial_order;

    /// Conserved: the products do not depend on the order of the nodes.
    #[test]
    fn matrices_in_another_order_are_the_same() {
        let block = Block::new([3, 4, 2]);
        let order = spatial_order(block.mesh.positions());
        let reordered = order.matrices(block.stiffness(), &block.mass());
        let x = random_block(3 * block.mesh.positions().len(), 3, &mut 5);
        let mut restored = order.rows(x.as_ref());
        assert_ne!(restored, x);
        order.restore(&mut restored);
        assert_eq!(restored, x);
        let products = |k: NodalStiffness<'_>, m: NodalMass<'_>, x: &Mat<f64>| {
            [StiffnessMatrix::Nodal(k).product(x.as_ref()), MassMatrix::Nodal(m).product(x.as_ref())]
        };
        let found = products(reordered.stiffness(), reordered.mass(), &order.rows(x.as_ref()));
        for (mut found, expected) in found.into_iter().zip(products(block.stiffness(), block.mass(), &x)) {
            order.restore(&mut found);
            assert!((found - &expected).norm_max() < 1e-14 * expected.norm_max());
        }
    }
}
