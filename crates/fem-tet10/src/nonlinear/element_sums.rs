//! Forces on the nodes, summed over the elements.

use faer::Mat;
use rayon::prelude::*;

use crate::element::deformation::OTHERS;
use crate::element::lanes::{Group, Lanes};
use crate::mesh::checked::Mesh;

/// Groups of elements whose forces are held at once, before they are added in the order of the groups: the sums are the same
/// for any number of threads.
const BLOCK: usize = 256;

/// The sums (N × columns) of the forces of each group, by column, then node but the first, which balances the others, then
/// axis.
pub(crate) fn sum_of_forces(
    mesh: &Mesh,
    groups: &[Group],
    columns: usize,
    of_group: impl Fn(&Group) -> Vec<[[Lanes; 3]; OTHERS]> + Sync,
) -> Mat<f64> {
    let rows = 3 * mesh.positions().len();
    let mut result = vec![0.0; rows * columns];
    let mut add = |node: u32, axis: usize, column: usize, force: f64| {
        result[columns * (3 * node as usize + axis) + column] += force;
    };
    for block in groups.chunks(BLOCK) {
        let parts: Vec<Vec<[[Lanes; 3]; OTHERS]>> = block.par_iter().map(&of_group).collect();
        for (group, sums) in block.iter().zip(parts) {
            for (lane, element) in group.elements[..group.count].iter().enumerate() {
                let nodes = &mesh.elements()[*element];
                for (place, node) in nodes[1..].iter().enumerate() {
                    for axis in 0..3 {
                        for (column, sums) in sums.iter().enumerate() {
                            add(*node, axis, column, sums[place][axis][lane]);
                            add(nodes[0], axis, column, -sums[place][axis][lane]);
                        }
                    }
                }
            }
        }
    }
    Mat::from_fn(rows, columns, |row, column| result[row * columns + column])
}
