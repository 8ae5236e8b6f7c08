//! G Z⁻¹ Gᵀ over the rows of all joints, and its factor L D Lᵀ.
//!
//! The matrix is sparse in blocks of joints: two of them meet where they share a body. Joints are eliminated in an order of
//! least degree, so a chain or a tree costs in proportion to its joints. Rows that others imply are left out, and their
//! multipliers are zero; which they are is a matter of geometry (`geometry/rank.rs`).

use nalgebra::Complex;

use crate::system::constraints::{Constraints, End};
use crate::system::elimination::inverse::Inverse;
use crate::system::elimination::number::Number;

/// A pivot below this part of its diagonal entry is rounding.
const ROUNDING: f64 = 1e-15;

/// Which blocks there are, and in which order they are eliminated: constants of a system.
#[derive(Debug, Clone)]
pub(crate) struct Pattern {
    /// First row of each joint, and the number of rows.
    first: Vec<usize>,
    /// Joints in the order of elimination.
    order: Vec<usize>,
    /// Later joints that meet each joint, in order, and their blocks.
    below: Vec<Vec<(usize, usize)>>,
    /// First entry of each block; the diagonal blocks come first, by joints.
    blocks: Vec<usize>,
    /// For a pair of joints that meet a third one: their block, by the third and the places among those below it.
    updates: Vec<Vec<usize>>,
    /// Rows with an end on each body, and those that they meet there.
    columns: Vec<Vec<Column>>,
    joint_of_row: Vec<usize>,
    entries: usize,
}

/// A row with an end on a body, as a column of the matrix.
#[derive(Debug, Clone)]
struct Column {
    end: RowEnd,
    /// The rows that meet it there, and their entries.
    rows: Vec<(RowEnd, usize)>,
}

/// A row, and the place of a body among its ends.
#[derive(Debug, Clone, Copy)]
struct RowEnd {
    row: usize,
    place: usize,
}

impl RowEnd {
    fn entries(self, constraints: &Constraints) -> &[f64] {
        &constraints.ends[self.row][self.place].entries
    }
}

impl Pattern {
    /// The pattern of joints with these numbers of rows, whose rows have these ends.
    pub fn new(rows: &[usize], ends: &[Vec<End>], bodies: usize) -> Self {
        let mut first = vec![0];
        rows.iter().for_each(|rows| first.push(first[first.len() - 1] + rows));
        let joint_of_row: Vec<usize> =
            rows.iter().enumerate().flat_map(|(joint, rows)| std::iter::repeat_n(joint, *rows)).collect();
        let mut rows_of_body = vec![Vec::new(); bodies];
        for (row, ends) in ends[..joint_of_row.len()].iter().enumerate() {
            ends.iter().enumerate().for_each(|(place, end)| rows_of_body[end.body].push(RowEnd { row, place }));
        }
        let mut meets = vec![std::collections::BTreeSet::new(); rows.len()];
        for rows in &rows_of_body {
            let joints: Vec<usize> = rows.iter().map(|end| joint_of_row[end.row]).collect();
            for a in &joints {
                meets[*a].extend(joints.iter().copied().filter(|b| b != a));
            }
        }
        let (mut order, mut below) = (Vec::new(), vec![Vec::new(); rows.len()]);
        let mut left: std::collections::BTreeSet<usize> = (0..rows.len()).collect();
        while let Some(next) = left.iter().copied().min_by_key(|joint| meets[*joint].len()) {
            left.remove(&next);
            let neighbours: Vec<usize> = std::mem::take(&mut meets[next]).into_iter().collect();
            for joint in &neighbours {
                meets[*joint].remove(&next);
                meets[*joint].extend(neighbours.iter().copied().filter(|other| other != joint));
            }
            order.push(next);
            below[next] = neighbours;
        }
        let mut place = vec![0; rows.len()];
        order.iter().enumerate().for_each(|(at, joint)| place[*joint] = at);
        let (mut blocks, mut entries, mut number) = (Vec::new(), 0, std::collections::BTreeMap::new());
        let mut add = |a: usize, b: usize| {
            number.insert((a, b), blocks.len());
            blocks.push(entries);
            entries += rows[a] * rows[b];
            blocks.len() - 1
        };
        (0..rows.len()).for_each(|joint| {
            add(joint, joint);
        });
        let below: Vec<Vec<(usize, usize)>> = below
            .into_iter()
            .enumerate()
            .map(|(joint, mut others)| {
                others.sort_by_key(|other| place[*other]);
                others.into_iter().map(|other| (other, add(other, joint))).collect()
            })
            .collect();
        let updates = below
            .iter()
            .map(|others| {
                let pairs =
                    others.iter().enumerate().flat_map(|(at, (a, _))| others[..=at].iter().map(move |(b, _)| (*a, *b)));
                pairs.filter_map(|pair| number.get(&pair).copied()).collect()
            })
            .collect();
        let mut pattern = Self { first, order, below, blocks, updates, columns: Vec::new(), joint_of_row, entries };
        let column = |end: RowEnd, ends: &[RowEnd]| {
            let meets = ends.iter().filter_map(|other| Some((*other, pattern.entry(other.row, end.row)?)));
            Column { end, rows: meets.collect() }
        };
        let columns = rows_of_body.iter().map(|ends| ends.iter().map(|end| column(*end, ends)).collect()).collect();
        pattern.columns = columns;
        pattern
    }

    fn rows(&self, joint: usize) -> usize {
        self.first[joint + 1] - self.first[joint]
    }

    /// Number of rows of all joints.
    pub fn len(&self) -> usize {
        self.joint_of_row.len()
    }

    /// The entry of a row and a column of the lower triangle: the row's joint is eliminated last, or both are of one joint.
    fn entry(&self, row: usize, column: usize) -> Option<usize> {
        let [of_row, of_column] = [row, column].map(|row| self.joint_of_row[row]);
        let block = if of_row == of_column {
            if row < column {
                return None;
            }
            of_row
        } else {
            self.below[of_column].iter().find(|(other, _)| *other == of_row)?.1
        };
        let [i, j] = [row - self.first[of_row], column - self.first[of_column]];
        Some(self.blocks[block] + i * self.rows(of_column) + j)
    }
}

/// The factor.
#[derive(Debug, Clone)]
pub(crate) struct JointMatrix<T> {
    entries: Vec<T>,
    /// 1/D; zero for rows that are left out.
    inverse_pivots: Vec<T>,
    diagonal: Vec<f64>,
    /// A column of Z⁻¹ Gᵀ.
    column: Vec<T>,
    /// A block before it is divided by the pivots.
    scratch: Vec<T>,
}

impl<T: Number> JointMatrix<T> {
    pub fn new(pattern: &Pattern, coordinates: usize) -> Self {
        let zero = T::from_real(0.0);
        let widest = (0..pattern.order.len()).map(|joint| pattern.rows(joint)).max().unwrap_or(0);
        let max_below = pattern.below.iter().map(Vec::len).max().unwrap_or(0);
        Self {
            entries: vec![zero; pattern.entries],
            inverse_pivots: vec![zero; pattern.len()],
            diagonal: vec![0.0; pattern.len()],
            column: vec![zero; coordinates],
            scratch: vec![zero; max_below * widest * widest],
        }
    }

    /// Assembles G Z⁻¹ Gᵀ.
    pub fn assemble(&mut self, pattern: &Pattern, constraints: &Constraints, inverses: &[Inverse<T>]) {
        self.entries.fill(T::from_real(0.0));
        for (columns, inverse) in pattern.columns.iter().zip(inverses) {
            for Column { end, rows } in columns {
                let g = end.entries(constraints);
                let z_g = &mut self.column[..g.len()];
                z_g.iter_mut().zip(g).for_each(|(z, g)| *z = T::from_real(*g));
                inverse.apply(z_g);
                for (row, entry) in rows {
                    let mut sum = T::from_real(0.0);
                    row.entries(constraints).iter().zip(&*z_g).for_each(|(g, z)| sum += z.scale(*g));
                    self.entries[*entry] += sum;
                }
            }
        }
    }

    /// Adds a compliance to the diagonal entry of a row.
    pub fn add_compliance(&mut self, pattern: &Pattern, row: usize, compliance: T) {
        if let Some(entry) = pattern.entry(row, row) {
            self.entries[entry] += compliance;
        }
    }

    /// Finds the factor without the rows whose `is_left_out` is true.
    pub fn factor(&mut self, pattern: &Pattern, is_left_out: &[bool]) {
        for joint in 0..pattern.order.len() {
            let n = pattern.rows(joint);
            for i in 0..n {
                self.diagonal[pattern.first[joint] + i] = self.entries[pattern.blocks[joint] + i * n + i].modulus();
            }
        }
        for &joint in &pattern.order {
            let (n, first, block) = (pattern.rows(joint), pattern.first[joint], pattern.blocks[joint]);
            for k in 0..n {
                let mut pivot = self.entries[block + k * n + k];
                for c in 0..k {
                    let l = self.entries[block + k * n + c];
                    let d = self.entries[block + c * n + c];
                    pivot -= l * l * d;
                }
                let row = first + k;
                self.entries[block + k * n + k] = pivot;
                let is_rounding = pivot.modulus() <= ROUNDING * self.diagonal[row];
                let inverse = if is_left_out[row] || is_rounding { T::from_real(0.0) } else { pivot.recip() };
                self.inverse_pivots[row] = inverse;
                for i in k + 1..n {
                    let mut sum = self.entries[block + i * n + k];
                    for c in 0..k {
                        let d = self.entries[block + c * n + c];
                        sum -= self.entries[block + i * n + c] * d * self.entries[block + k * n + c];
                    }
                    self.entries[block + i * n + k] = sum * inverse;
                }
            }
            self.eliminate(pattern, joint);
        }
    }

    /// Divides the blocks below a joint by its factor, and takes their products from those that they meet.
    fn eliminate(&mut self, pattern: &Pattern, joint: usize) {
        let (n, first, diagonal) = (pattern.rows(joint), pattern.first[joint], pattern.blocks[joint]);
        let below = &pattern.below[joint];
        let mut kept = 0;
        for (other, block) in below {
            let at = pattern.blocks[*block];
            for i in 0..pattern.rows(*other) {
                for k in 0..n {
                    let mut sum = self.entries[at + i * n + k];
                    for c in 0..k {
                        sum -= self.entries[at + i * n + c] * self.entries[diagonal + k * n + c];
                    }
                    self.entries[at + i * n + k] = sum;
                }
                for k in 0..n {
                    self.scratch[kept + i * n + k] = self.entries[at + i * n + k];
                    self.entries[at + i * n + k] *= self.inverse_pivots[first + k];
                }
            }
            kept += pattern.rows(*other) * n;
        }
        let mut updates = pattern.updates[joint].iter();
        for (at, (a, block_a)) in below.iter().enumerate() {
            let mut kept = 0;
            for (b, _) in &below[..=at] {
                let Some(target) = updates.next() else { return };
                let (target, of_a, n_b) = (pattern.blocks[*target], pattern.blocks[*block_a], pattern.rows(*b));
                for i in 0..pattern.rows(*a) {
                    for j in 0..n_b {
                        let mut sum = T::from_real(0.0);
                        for k in 0..n {
                            sum += self.entries[of_a + i * n + k] * self.scratch[kept + j * n + k];
                        }
                        self.entries[target + i * n_b + j] -= sum;
                    }
                }
                kept += n_b * n;
            }
        }
    }

    /// Turns a right-hand side, which may be complex where the matrix is real, into the solution.
    pub fn solve<U: Number>(&self, pattern: &Pattern, x: &mut [U])
    where
        T: Times<U>,
    {
        for &joint in &pattern.order {
            let (n, first, block) = (pattern.rows(joint), pattern.first[joint], pattern.blocks[joint]);
            for i in 0..n {
                for c in 0..i {
                    let known = x[first + c];
                    x[first + i] -= self.entries[block + i * n + c].times(known);
                }
            }
            for (other, block) in &pattern.below[joint] {
                let (at, to) = (pattern.blocks[*block], pattern.first[*other]);
                for i in 0..pattern.rows(*other) {
                    for c in 0..n {
                        let known = x[first + c];
                        x[to + i] -= self.entries[at + i * n + c].times(known);
                    }
                }
            }
        }
        x.iter_mut().zip(&self.inverse_pivots).for_each(|(x, inverse)| *x = inverse.times(*x));
        for &joint in pattern.order.iter().rev() {
            let (n, first, block) = (pattern.rows(joint), pattern.first[joint], pattern.blocks[joint]);
            for (other, block) in &pattern.below[joint] {
                let (at, from) = (pattern.blocks[*block], pattern.first[*other]);
                for i in 0..pattern.rows(*other) {
                    for c in 0..n {
                        let known = x[from + i];
                        x[first + c] -= self.entries[at + i * n + c].times(known);
                    }
                }
            }
            for i in (0..n).rev() {
                for c in 0..i {
                    let known = x[first + i];
                    x[first + c] -= self.entries[block + i * n + c].times(known);
                }
            }
        }
    }
}

/// A product that is a number of the second kind.
pub(crate) trait Times<U> {
    fn times(self, other: U) -> U;
}

impl<U: Number> Times<U> for f64 {
    fn times(self, other: U) -> U {
        other.scale(self)
    }
}

impl Times<Self> for Complex<f64> {
    fn times(self, other: Self) -> Self {
        self * other
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;
    use crate::system::connections::Connections;
    use crate::system::constraints::near;
    use crate::system::elimination::inverse::Inertia;
    use crate::system::joint::Joint;
    use crate::system::marker::{BodyPlace, Marker};

    /// Rods of 1 m in a row, each with two modes of its own mass; `closes` joins the last with the ground.
    fn chain(bodies: usize, closes: bool) -> (Pattern, Constraints, Vec<Inverse<f64>>) {
        let axes = Matrix3::identity();
        let end = |body: usize, x: f64| Marker::on_rigid(body, Vector3::new(x, 0.1 * x, 0.0), axes);
        let mut joints: Vec<Joint> =
            (1..bodies).map(|body| Joint::revolute("hinge", [end(body - 1, 0.5), end(body, -0.5)])).collect();
        joints.push(Joint::spherical("start", [Marker::on_ground(Vector3::zeros(), axes), end(0, -0.5)]));
        if closes {
            joints.push(Joint::spherical("end", [end(bodies - 1, 0.5), Marker::on_ground(Vector3::x(), axes)]));
        }
        let first: Vec<usize> = (0..=bodies).map(|body| 8 * body).collect();
        let connections = Connections { joints, ..Connections::default() };
        let mut constraints = Constraints::new(&connections, &first);
        constraints.find(
            &connections,
            near,
            |_, _| 0.0,
            [0.0; 2],
            |body| BodyPlace {
                origin: Vector3::new(body as f64, 0.3, -0.1 * body as f64),
                body_from_global: rigid_kin::transformation_matrix(&Vector3::new(0.1, 0.2 * body as f64, 0.3)),
                q: &[0.0; 2],
                bent: None,
            },
        );
        // The modes of each body move its markers, too.
        for (row, end) in constraints.ends.iter_mut().flatten().enumerate() {
            end.entries[6..].copy_from_slice(&[0.3 + 0.01 * row as f64, -0.2]);
        }
        let mut inertia = Inertia::new(2);
        inertia.coupling = std::array::from_fn(|axis| vec![0.02 * axis as f64, 0.01]);
        let mut inverse = Inverse::new(2);
        let oscillators = [[5.0, 0.1], [700.0, 0.0]];
        assert!(inverse.find(3.0, &inertia, |k| oscillators[k]));
        let rows: Vec<usize> = connections.groups().collect();
        (Pattern::new(&rows, &constraints.ends, bodies), constraints, vec![inverse; bodies])
    }

    /// Conserved: A A⁻¹ x = x.
    #[test]
    fn the_solution_solves() {
        for (bodies, closes) in [(1, false), (5, false), (6, true)] {
            let (pattern, constraints, inverses) = chain(bodies, closes);
            let x: Vec<f64> = (0..pattern.len()).map(|row| (row as f64 * 0.7).sin()).collect();
            let mut forces = vec![0.0; 8 * bodies];
            constraints.add_forces(&x, &mut forces);
            forces.chunks_mut(8).zip(&inverses).for_each(|(force, inverse)| inverse.apply(force));
            let mut y = vec![0.0; pattern.len()];
            constraints.add_rates(1.0, &forces, &mut y);
            let mut matrix = JointMatrix::new(&pattern, 8 * bodies);
            matrix.assemble(&pattern, &constraints, &inverses);
            matrix.factor(&pattern, &vec![false; pattern.len()]);
            matrix.solve(&pattern, &mut y);
            x.iter().zip(&y).for_each(|(x, y)| assert!((x - y).abs() < 1e-10, "{bodies} {closes}: {x} {y}"));
        }
    }

    /// Entries of the factor go with the number of joints, in a chain and in a loop.
    #[test]
    fn a_chain_costs_in_proportion_to_its_joints() {
        let entries = |bodies, closes| chain(bodies, closes).0.entries as f64 / bodies as f64;
        for closes in [false, true] {
            assert!(entries(300, closes) < 1.1 * entries(30, closes));
        }
    }
}
