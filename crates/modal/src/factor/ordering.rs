//! Nested dissection of the graph of the nodes, by METIS.
//!
//! The three degrees of freedom of a node stay together, so the graph to order is a ninth of the matrix. Of that graph METIS
//! orders the part that leads, of second-order tetrahedra the corners: a sixth of the nodes.

use faer::perm::Perm;
use faer::sparse::SymbolicSparseColMatRef;

use crate::error::ModalError;
use crate::factor::dissection::{dissect, idx_t};
use crate::matrix::node_pairs::NodePairs;
use crate::matrix::symmetry::check_symmetric;

/// Most bytes that METIS allocates for a node: its own weights, and the coarser graphs.
const ORDERING_PER_NODE: usize = 128;
const ORDERING_PER_NEIGHBOUR: usize = 24;

/// An order of the nodes of a graph.
#[derive(Debug, PartialEq)]
pub(crate) struct NodeOrder(Vec<idx_t>);

impl NodeOrder {
    /// The order of their degrees of freedom, `alike` of them in each node.
    pub(crate) fn perm(&self, alike: usize) -> Perm<usize> {
        let mut place = vec![0; self.0.len()];
        for (new, old) in self.0.iter().enumerate() {
            place[*old as usize] = new as idx_t;
        }
        let expand = |nodes: &[idx_t]| -> Box<[usize]> {
            nodes.iter().flat_map(|node| (0..alike).map(move |k| alike * *node as usize + k)).collect()
        };
        Perm::new_checked(expand(&self.0), expand(&place), alike * place.len())
    }
}

/// A fill-reducing order of the nodes of a symmetric matrix with 3×3 blocks, by its pattern on and below the diagonal.
pub(crate) fn nested_dissection(pattern: SymbolicSparseColMatRef<'_, usize>) -> Result<NodeOrder, ModalError> {
    let n = pattern.ncols() / 3;
    let mut coupled: Vec<Vec<idx_t>> = vec![Vec::new(); n];
    let mut below = Vec::new();
    for node in 0..n {
        below.clear();
        for column in 3 * node..3 * node + 3 {
            let rows = pattern.row_idx_of_col_raw(column).iter();
            below.extend(rows.map(|row| row / 3).filter(|other| *other > node));
        }
        below.sort_unstable();
        below.dedup();
        for other in &below {
            coupled[node].push(*other as idx_t);
            coupled[*other].push(node as idx_t);
        }
    }
    let mut start: Vec<idx_t> = Vec::with_capacity(n + 1);
    let mut neighbours: Vec<idx_t> = Vec::new();
    start.push(0);
    for of_node in coupled {
        neighbours.extend(of_node);
        start.push(neighbours.len() as idx_t);
    }
    dissection(start, neighbours)
}

/// The same by the pairs of coupled nodes.
pub(crate) fn nested_dissection_of_nodes(pairs: &NodePairs<'_>) -> Result<NodeOrder, ModalError> {
    // METIS takes it for granted; zeros that are stored on one side only would break it.
    let what = "stored pattern of the shifted stiffness";
    check_symmetric(what, 3, pairs.start, |entry| pairs.nodes[entry] as usize, |_| 0.0)?;
    let (mut start, mut neighbours) = (Vec::with_capacity(pairs.count() + 1), Vec::with_capacity(pairs.nodes.len()));
    start.push(0);
    for node in 0..pairs.count() {
        neighbours.extend(pairs.of(node).iter().filter(|other| **other as usize != node).map(|other| *other as idx_t));
        start.push(neighbours.len() as idx_t);
    }
    dissection(start, neighbours)
}

/// An order of the nodes of a graph.
fn dissection(start: Vec<idx_t>, neighbours: Vec<idx_t>) -> Result<NodeOrder, ModalError> {
    let n = start.len() - 1;
    if neighbours.len() > idx_t::MAX as usize {
        let reason = "the graph of the nodes is too large for METIS".to_owned();
        return Err(ModalError::Factorization { size: 3 * n, reason });
    }
    Ok(NodeOrder(order_nodes(&start, &neighbours)?))
}

/// An order of the nodes of a graph that keeps the fill low: `order[new] = old`.
///
/// METIS orders the leading nodes alone, with the edges between them. A node follows another one where its neighbours
/// are all neighbours of the other, as those of a mid-edge node are of both corners of its edge: then no separator parts
/// it from what it is coupled to, if it comes just before the first of the nodes that it follows.
fn order_nodes(start: &[idx_t], neighbours: &[idx_t]) -> Result<Vec<idx_t>, ModalError> {
    let n = start.len() - 1;
    let graph = Graph { start, neighbours };
    let pairs = graph.pairs();
    let mut leads = vec![true; n];
    pairs.iter().for_each(|[follower, _]| leads[*follower] = false);
    let leading: Vec<usize> = (0..n).filter(|node| leads[*node]).collect();
    let mut number = vec![None; n];
    leading.iter().enumerate().for_each(|(i, node)| number[*node] = Some(i));

    let (mut start, mut neighbours) = (vec![0], Vec::new());
    for node in &leading {
        neighbours.extend(graph.of(*node).iter().filter_map(|other| number[*other as usize]).map(|i| i as idx_t));
        start.push(neighbours.len() as idx_t);
    }
    let (mut order, mut place) = (vec![0; leading.len()], vec![0; leading.len()]);
    memory::check("the ordering", ordering_bytes(order.len(), neighbours.len()))?;
    dissect(&mut start, &mut neighbours, &mut order, &mut place)?;

    // What follows a node that follows another follows that one, too: so each has a leading one among its own.
    let mut first = vec![usize::MAX; n];
    for [follower, other] in pairs {
        if let Some(i) = number[other] {
            first[follower] = first[follower].min(place[i] as usize);
        }
    }
    let mut followers = vec![Vec::new(); leading.len()];
    (0..n).filter(|node| !leads[*node]).for_each(|node| followers[first[node]].push(node));
    let mut nodes = Vec::with_capacity(n);
    for (followers, leader) in followers.iter_mut().zip(order) {
        followers.sort_by_key(|node| graph.of(*node).len());
        nodes.extend(followers.iter().map(|node| *node as idx_t));
        nodes.push(leading[leader as usize] as idx_t);
    }
    Ok(graph.postorder(&nodes))
}

/// A graph in compressed rows, no node its own neighbour.
struct Graph<'a> {
    start: &'a [idx_t],
    neighbours: &'a [idx_t],
}

impl Graph<'_> {
    /// The neighbours of a node.
    fn of(&self, node: usize) -> &[idx_t] {
        &self.neighbours[self.start[node] as usize..self.start[node + 1] as usize]
    }

    /// Pairs of a node and one that it follows: all neighbours of the first are the second or neighbours of it. Of two that
    /// have the same neighbours the later follows.
    fn pairs(&self) -> Vec<[usize; 2]> {
        let n = self.start.len() - 1;
        let mut marked_by = vec![usize::MAX; n];
        let mut pairs = Vec::new();
        for node in 0..n {
            let own = self.of(node);
            marked_by[node] = node;
            own.iter().for_each(|other| marked_by[*other as usize] = node);
            for other in own.iter().map(|other| *other as usize) {
                let of_other = self.of(other);
                let may = of_other.len() < own.len() || of_other.len() == own.len() && node < other;
                if may && of_other.iter().all(|third| marked_by[*third as usize] == node) {
                    pairs.push([other, node]);
                }
            }
        }
        pairs
    }

    /// An order with the same fill in which each subtree of the elimination tree is a run: METIS leaves those of its smallest
    /// parts mixed, and a factor has more and smaller supernodes by that.
    fn postorder(&self, order: &[idx_t]) -> Vec<idx_t> {
        let n = order.len();
        let mut place = vec![0; n];
        order.iter().enumerate().for_each(|(i, node)| place[*node as usize] = i);
        // Elimination tree, with n as the root of all: Liu (1990), algorithm 4.2.
        let (mut parent, mut ancestor) = (vec![n; n], vec![n; n]);
        for (i, node) in order.iter().enumerate() {
            for other in self.of(*node as usize) {
                let mut j = place[*other as usize];
                while j < i {
                    let next = std::mem::replace(&mut ancestor[j], i);
                    if next == n {
                        parent[j] = i;
                    }
                    j = next;
                }
            }
        }
        let mut size = vec![1; n + 1];
        (0..n).for_each(|j| size[parent[j]] += size[j]);
        // From the last down, each subtree takes the end of what its parent has left before itself.
        let mut end = vec![n; n + 1];
        let mut sorted = vec![0; n];
        for j in (0..n).rev() {
            let last = end[parent[j]] - 1;
            end[parent[j]] -= size[j];
            end[j] = last;
            sorted[last] = order[j];
        }
        sorted
    }
}

/// Most bytes that METIS allocates for a graph.
pub(crate) fn ordering_bytes(nodes: usize, neighbours: usize) -> usize {
    ORDERING_PER_NODE * nodes + ORDERING_PER_NEIGHBOUR * neighbours
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
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
    fn what_is_coupled_to_neighbours_of_another_alone_comes_just_before_it() {
        // A chain of corners 0 to 4 with a node between each two of them, 5 to 8.
        let edges = [[0, 1], [1, 2], [2, 3], [3, 4], [0, 5], [1, 5], [1, 6], [2, 6], [2, 7], [3, 7], [3, 8], [4, 8]];
        let of = |node: idx_t| edges.iter().filter(move |e| e.contains(&node)).map(move |e| e[0] + e[1] - node);
        let (mut start, mut neighbours) = (vec![0], Vec::new());
        for node in 0..9 {
            neighbours.extend(of(node));
            start.push(neighbours.len() as idx_t);
        }
        let order = order_nodes(&start, &neighbours).unwrap();
        let place = |node: idx_t| order.iter().position(|other| *other == node).unwrap();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..9).collect::<Vec<_>>());
        for node in 5..9 {
            let mut leading = of(node).filter(|corner| (1..4).contains(corner));
            assert!(leading.all(|corner| place(node) < place(corner)), "{order:?}");
        }
        // The ends of the chain follow their neighbours, too: three corners lead.
        let pairs = Graph { start: &start, neighbours: &neighbours }.pairs();
        let leads = |node: usize| pairs.iter().all(|[follower, _]| *follower != node);
        assert_eq!((0..9).filter(|node| leads(*node)).collect::<Vec<_>>(), [1, 2, 3]);
    }

    #[test]
    fn subtrees_become_runs_and_the_fill_stays() {
        // Cells of a square, each coupled to the four beside it, in an order that mixes them.
        let side = 13_usize;
        let n = side * side;
        let (mut start, mut neighbours) = (vec![0], Vec::new());
        for node in 0..n {
            let beside =
                |other: &usize| (node % side).abs_diff(other % side) + (node / side).abs_diff(other / side) == 1;
            neighbours.extend((0..n).filter(beside).map(|other| other as idx_t));
            start.push(neighbours.len() as idx_t);
        }
        let graph = Graph { start: &start, neighbours: &neighbours };
        // The rows below the diagonal of each column of the factor, by elimination.
        let columns = |order: &[idx_t]| {
            let mut place = vec![0; n];
            order.iter().enumerate().for_each(|(i, node)| place[*node as usize] = i);
            let mut columns: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); n];
            for i in 0..n {
                columns[i].extend(graph.of(order[i] as usize).iter().map(|other| place[*other as usize]));
                columns[i].retain(|row| *row > i);
            }
            for i in 0..n {
                let column = columns[i].clone();
                if let Some(parent) = column.first() {
                    columns[*parent].extend(column.iter().filter(|row| *row > parent));
                }
            }
            columns
        };
        let order: Vec<idx_t> = (0..n).map(|i| (i * 50 % n) as idx_t).collect();
        let sorted = graph.postorder(&order);
        let [before, after] = [&order, &sorted].map(|order| columns(order));
        let fill = |columns: &[BTreeSet<usize>]| columns.iter().map(BTreeSet::len).sum::<usize>();
        assert_eq!(fill(&before), fill(&after));
        // Those below a node in the tree stand just before it.
        let are_runs = |columns: &[BTreeSet<usize>]| {
            let mut first: Vec<usize> = (0..n).collect();
            let mut size = vec![1; n];
            for i in 0..n {
                if let Some(parent) = columns[i].first() {
                    first[*parent] = first[*parent].min(first[i]);
                    size[*parent] += size[i];
                }
            }
            (0..n).all(|i| size[i] == i + 1 - first[i])
        };
        assert!(!are_runs(&before) && are_runs(&after));
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
            assert_eq!(found.unwrap(), expected);
        }
        raise(SIGTERM).unwrap();
        assert!(raised > 5 && heard.load(Ordering::SeqCst) == raised + 1);
    }
}
