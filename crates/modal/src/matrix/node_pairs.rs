//! Which nodes are coupled: a symmetric pattern over nodes, in compressed columns.

use faer::sparse::SymbolicSparseColMat;

use crate::error::ModalError;

/// The pairs of coupled nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodePairs<'a> {
    pub start: &'a [usize],
    pub nodes: &'a [u32],
}

impl<'a> NodePairs<'a> {
    /// Refuses lists that are no pattern.
    pub fn new(start: &'a [usize], nodes: &'a [u32]) -> Result<Self, ModalError> {
        let count = start.len().saturating_sub(1);
        let what = "the list of coupled nodes";
        let fits = start.first() == Some(&0) && start.is_sorted() && start.last() == Some(&nodes.len());
        if !fits {
            let found = start.last().copied().unwrap_or(0);
            return Err(ModalError::Length { what, found, expected: nodes.len() });
        }
        for (node, range) in start.windows(2).enumerate() {
            let column = &nodes[range[0]..range[1]];
            if !column.is_sorted_by(|a, b| a < b) {
                return Err(ModalError::Unsorted { node });
            }
            if let Some(node) = column.last().filter(|node| **node as usize >= count) {
                return Err(ModalError::NoNode { node: *node, count });
            }
        }
        Ok(Self { start, nodes })
    }

    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.start.len() - 1
    }

    /// The nodes that a node is coupled to.
    #[inline(always)]
    pub fn of(&self, node: usize) -> &'a [u32] {
        &self.nodes[self.start[node]..self.start[node + 1]]
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> usize {
        4 * self.nodes.len() + 8 * self.start.len()
    }

    /// The pairs that are here or in another pattern of as many nodes: where each column begins, and its nodes.
    pub fn union(&self, other: &NodePairs<'_>) -> (Vec<usize>, Vec<u32>) {
        let (mut start, mut nodes) = (vec![0], Vec::with_capacity(self.nodes.len()));
        let mut of_node = Vec::new();
        for node in 0..self.count() {
            of_node.clear();
            of_node.extend(self.of(node).iter().chain(other.of(node)));
            of_node.sort_unstable();
            of_node.dedup();
            nodes.extend_from_slice(&of_node);
            start.push(nodes.len());
        }
        (start, nodes)
    }

    /// The diagonal and what is below it of the same over degrees of freedom, `alike` of them in each node.
    pub fn lower(&self, alike: usize) -> SymbolicSparseColMat<usize> {
        let size = alike * self.count();
        let entries = alike * alike * (self.nodes.len() + self.count()) / 2;
        let (mut start, mut rows) = (Vec::with_capacity(size + 1), Vec::with_capacity(entries));
        start.push(0);
        for node in 0..self.count() {
            let nodes = self.of(node);
            let below = &nodes[nodes.partition_point(|other| *other as usize <= node)..];
            let of_node = |node: usize| alike * node..alike * (node + 1);
            for column in of_node(node) {
                rows.extend(column..of_node(node).end);
                rows.extend(below.iter().flat_map(|other| of_node(*other as usize)));
                start.push(rows.len());
            }
        }
        SymbolicSparseColMat::new_checked(size, size, start, None, rows)
    }
}
