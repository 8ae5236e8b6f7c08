//! A tree of joints from the ground: Eq. (J31) of `docs/method/systems.md`.

use nalgebra::{DMatrix, Matrix6, Vector3, Vector6};

use crate::system::description::System;
use crate::system::geometry::posture::Posture;
use crate::system::stage::vector;

/// A row of a joint that its other rows leave less than this part of is implied by them.
const IMPLIED: f64 = 1e-7;

/// Joints that hold each body by one way from the ground, or from the first body of those that float.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    /// The joint of each body on its way to the ground; `None` of a body that floats.
    pub links: Vec<Option<Link>>,
    /// Number of links to the root.
    pub depth: Vec<usize>,
    /// True for each row of a joint of the tree that the other rows of it do not imply.
    pub holds: Vec<bool>,
    /// The joint of each row; couplings have the numbers after the joints.
    pub joint_of_row: Vec<usize>,
    first_row: Vec<usize>,
    /// Middle of the bodies, and the size of the system.
    pub middle: Vector3<f64>,
    pub size: f64,
}

/// A joint of the tree, and the body on the side of the root; `None` is the ground.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Link {
    pub joint: usize,
    pub parent: Option<usize>,
}

/// Rows that a link holds where its bodies are, and twists that it leaves free. Wrenches are forces and moments about its point over its length, twists
/// velocities of that point and the length times angular velocities.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    pub point: Vector3<f64>,
    pub length: f64,
    pub rows: Vec<usize>,
    /// Sizes of these rows.
    pub sizes: Vec<f64>,
    /// Twists by which one unit of each row is closed (6 × rows).
    pub closing: DMatrix<f64>,
    /// Twists that it leaves free.
    pub free: Vec<Vector6<f64>>,
}

impl Tree {
    /// The tree where a stage is: joints that hold most come first.
    pub fn new(system: &System, at: &Posture<'_>) -> Self {
        let (joints, bodies) = (&system.connections.joints, system.bodies.len());
        let mut first_row = vec![0];
        joints.iter().for_each(|joint| first_row.push(first_row[first_row.len() - 1] + joint.row_count()));
        let joint_of_row = system.connections.groups().enumerate();
        let joint_of_row = joint_of_row.flat_map(|(joint, rows)| std::iter::repeat_n(joint, rows)).collect();
        let middle = Self::middle_of(at);
        let size = size_of_system(system, at);
        let mut tree = Self {
            links: vec![None; bodies],
            depth: vec![0; bodies],
            holds: vec![false; system.rows()],
            joint_of_row,
            first_row,
            middle,
            size,
        };
        // The ground has the number after those of the bodies.
        let ends = |joint: usize| joints[joint].markers.each_ref().map(|marker| marker.body().unwrap_or(bodies));
        let mut order: Vec<(usize, Vec<usize>)> = (0..joints.len())
            .filter_map(|joint| {
                let [i, j] = ends(joint);
                let on = if j == bodies { i } else { j };
                let all = (tree.first_row[joint]..tree.first_row[joint + 1]).collect();
                (i != j).then(|| tree.held_by(at, (joint, all), on, tree.size).rows).map(|rows| (joint, rows))
            })
            .collect();
        order.sort_by_key(|(_, rows)| std::cmp::Reverse(rows.len()));
        let mut group: Vec<usize> = (0..=bodies).collect();
        let mut neighbours = vec![Vec::new(); bodies + 1];
        for (joint, rows) in order.into_iter().filter(|(_, rows)| !rows.is_empty()) {
            let [i, j] = ends(joint);
            let [a, b] = [group[i], group[j]];
            if a == b {
                continue;
            }
            group.iter_mut().filter(|group| **group == a).for_each(|group| *group = b);
            rows.into_iter().for_each(|row| tree.holds[row] = true);
            neighbours[i].push((joint, j));
            neighbours[j].push((joint, i));
        }
        let mut is_reached = vec![false; bodies + 1];
        for root in std::iter::once(bodies).chain(0..bodies) {
            let mut next = if is_reached[root] { Vec::new() } else { vec![root] };
            is_reached[root] = true;
            while let Some(from) = next.pop() {
                for &(joint, to) in &neighbours[from] {
                    if std::mem::replace(&mut is_reached[to], true) {
                        continue;
                    }
                    tree.links[to] = Some(Link { joint, parent: (from < bodies).then_some(from) });
                    tree.depth[to] = if from < bodies { tree.depth[from] + 1 } else { 1 };
                    next.push(to);
                }
            }
        }
        tree
    }

    /// Mean of the origins of the bodies.
    pub fn middle_of(at: &Posture<'_>) -> Vector3<f64> {
        at.positions.iter().sum::<Vector3<f64>>() / at.positions.len().max(1) as f64
    }

    /// True if its rows are all rows of the system: nothing can be implied.
    pub fn is_all(&self) -> bool {
        self.holds.iter().all(|holds| *holds)
    }

    /// Bodies on the way from a body to the root, itself first.
    pub fn path(&self, body: usize) -> impl Iterator<Item = usize> + '_ {
        let up = |body: &usize| self.links[*body].and_then(|link| link.parent);
        std::iter::successors(Some(body), up).filter(|body| self.links[*body].is_some())
    }

    /// The hold of a joint of the tree on the body `on`, with this length: by the same rows wherever the system is, since which of rows that
    /// hold the same come first is a matter of rounding.
    pub fn held(&self, at: &Posture<'_>, joint: usize, on: usize, length: f64) -> Held {
        let rows = (self.first_row[joint]..self.first_row[joint + 1]).filter(|row| self.holds[*row]);
        self.held_by(at, (joint, rows.collect()), on, length)
    }

    /// The hold of the independent ones of some rows of a joint.
    fn held_by(&self, at: &Posture<'_>, (joint, all): (usize, Vec<usize>), on: usize, length: f64) -> Held {
        let point = at.points[joint];
        let of_row = |row: usize| {
            let end = at.ends[row].iter().find(|end| end.body == on);
            let wrench = end.map_or_else(Vector6::zeros, |end| wrench_about(at, on, &end.entries, &point));
            scaled(&wrench, length)
        };
        let wrenches: Vec<Vector6<f64>> = all.iter().map(|row| of_row(*row)).collect();
        let sizes: Vec<f64> = wrenches.iter().map(size_of).collect();
        let columns = DMatrix::from_fn(6, all.len(), |i, k| wrenches[k][i] / sizes[k]);
        let kept = independent(&columns, IMPLIED);
        let w = DMatrix::from_fn(kept.len(), 6, |i, k| columns[(k, kept[i])]);
        // A joint may hold nothing.
        let inverse = (!kept.is_empty()).then(|| w.clone().pseudo_inverse(1e-12).ok()).flatten();
        let closing = inverse.unwrap_or_else(|| DMatrix::zeros(6, kept.len()));
        let projector = Matrix6::identity() - Matrix6::from_fn(|i, k| (closing.row(i) * w.column(k))[0]);
        let basis = projector.col_piv_qr().q();
        let free = (0..6 - kept.len()).map(|k| basis.column(k).into()).collect();
        Held {
            point,
            length,
            rows: kept.iter().map(|k| all[*k]).collect(),
            sizes: kept.iter().map(|k| sizes[*k]).collect(),
            closing,
            free,
        }
    }
}

/// Largest distance of a joint or the origin of a body from their middle; the largest radius of gyration where all are at one place.
pub(crate) fn size_of_system(system: &System, at: &Posture<'_>) -> f64 {
    let middle = Tree::middle_of(at);
    let places = at.points.iter().chain(&at.positions).map(|place| (place - middle).norm());
    let size = places.fold(0.0, f64::max);
    // One body whose joints are at its origin.
    let size = if size > 0.0 { size } else { system.radii.iter().copied().fold(0.0, f64::max) };
    if size > 0.0 { size } else { system.spread_of_points(at.positions.iter().copied()) }
}

/// Columns that are independent of each other, in their order: the rest is below `limit` beside them.
pub(crate) fn independent(columns: &DMatrix<f64>, limit: f64) -> Vec<usize> {
    if columns.is_empty() {
        return Vec::new();
    }
    let qr = columns.clone().col_piv_qr();
    let r = qr.r();
    let mut order = nalgebra::RowDVector::from_iterator(columns.ncols(), 0..columns.ncols());
    qr.p().permute_columns(&mut order);
    let rank = (0..r.nrows().min(r.ncols())).take_while(|i| r[(*i, *i)].abs() > limit).count();
    let mut kept: Vec<usize> = order.iter().copied().take(rank).collect();
    kept.sort_unstable();
    kept
}

/// Force and moment about a place (global) of the first entries of an end, which are about the origin of its body in its axes.
pub(crate) fn wrench_about(at: &Posture<'_>, body: usize, entries: &[f64], about: &Vector3<f64>) -> Vector6<f64> {
    let attitude = &at.attitudes[body];
    let [force, moment] = [0, 3].map(|first| attitude.tr_mul(&vector(entries, first)));
    let moment = moment + (at.positions[body] - about).cross(&force);
    join(&force, &moment)
}

/// The wrench about another place, which is `by` away.
pub(crate) fn moved(wrench: &Vector6<f64>, by: &Vector3<f64>) -> Vector6<f64> {
    let (force, moment) = (wrench.fixed_rows::<3>(0).into_owned(), wrench.fixed_rows::<3>(3).into_owned());
    join(&force, &(moment - by.cross(&force)))
}

/// Moments over a length.
pub(crate) fn scaled(wrench: &Vector6<f64>, length: f64) -> Vector6<f64> {
    Vector6::from_fn(|i, _| if i < 3 { wrench[i] } else { wrench[i] / length })
}

/// The larger of the force and the moment; 1 of nothing.
pub(crate) fn size_of(wrench: &Vector6<f64>) -> f64 {
    let size = wrench.fixed_rows::<3>(0).norm().max(wrench.fixed_rows::<3>(3).norm());
    if size > 0.0 { size } else { 1.0 }
}

fn join(force: &Vector3<f64>, moment: &Vector3<f64>) -> Vector6<f64> {
    Vector6::from_fn(|i, _| if i < 3 { force[i] } else { moment[i - 3] })
}
