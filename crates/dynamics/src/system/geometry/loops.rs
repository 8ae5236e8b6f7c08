//! Rows that close loops over the joints of a tree: Eq. (J31) of `docs/method/systems.md`.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, Vector3, Vector6};

use crate::system::description::System;
use crate::system::geometry::posture::Posture;
use crate::system::geometry::tree::{Held, Tree, moved, scaled, size_of, wrench_about};
use crate::system::stage::put;

/// Part of a wrench that is rounding, where both ways to the root meet.
const ROUNDING: f64 = 1e-14;
/// A mode whose part at joints is below this part of the largest of its body moves none of them.
const STILL: f64 = 1e-6;

/// The rows that close loops where a stage is.
#[derive(Debug, Clone)]
pub(crate) struct Loops {
    /// Their numbers.
    pub rows: Vec<usize>,
    /// The rate of each, over its size, by each free motion of the tree: a column for each row.
    pub matrix: DMatrix<f64>,
    /// Tree rows, and their multipliers, which balance one unit of each of them on all that the tree holds.
    pub balance: Vec<Vec<(usize, f64)>>,
    /// Size of each row of the system: its residual over it is a length.
    pub sizes: Vec<f64>,
    /// Length of the loops that each row is in.
    pub lengths: Vec<f64>,
    links: BTreeMap<usize, Held>,
    /// First column of the free twists of each body's link, and columns of modes.
    columns: BTreeMap<usize, usize>,
    modes: Vec<(usize, f64)>,
    twists: usize,
}

impl Loops {
    /// The loops of bodies with their modes, or as if they were rigid.
    pub fn new(system: &System, at: &Posture<'_>, tree: &Tree, with_modes: bool) -> Self {
        let count = system.rows();
        let rows: Vec<usize> = (0..count).filter(|row| !tree.holds[*row]).collect();
        let joints = &system.connections.joints;
        // Ways of the ends of each row, and joints of it.
        let joints_of = |row: usize| -> Vec<usize> {
            let number = tree.joint_of_row[row];
            match system.connections.couplings.get(number.wrapping_sub(joints.len())) {
                Some(coupling) if number >= joints.len() => coupling.terms.iter().map(|term| term.joint).collect(),
                _ => vec![number],
            }
        };
        let way_of = |row: usize| -> Vec<usize> {
            let paths: Vec<Vec<usize>> = at.ends[row].iter().map(|end| tree.path(end.body).collect()).collect();
            let mut way: Vec<usize> = paths.iter().flatten().copied().collect();
            way.sort_unstable();
            way.dedup();
            if let [a, b] = &paths[..] {
                way.retain(|body| !(a.contains(body) && b.contains(body)));
            }
            way
        };
        let ways: Vec<Vec<usize>> = rows.iter().map(|row| way_of(*row)).collect();
        let mut lengths = vec![0.0_f64; count];
        let mut of_link: BTreeMap<usize, f64> = BTreeMap::new();
        for (row, way) in rows.iter().zip(&ways) {
            let on_way = way.iter().filter_map(|body| Some(tree.links[*body]?.joint));
            let numbers: Vec<usize> = on_way.chain(joints_of(*row)).collect();
            let points: Vec<Vector3<f64>> = numbers.iter().map(|joint| at.points[*joint]).collect();
            let mean = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
            let radius = points.iter().map(|point| (point - mean).norm()).fold(0.0, f64::max);
            // Joints at one place, but for rounding, have no radius.
            lengths[*row] = if radius > 1e-9 * tree.size { radius } else { 0.0 };
            for body in way {
                let length = of_link.entry(*body).or_default();
                *length = length.max(lengths[*row]);
            }
        }
        let or_size = |length: f64| if length > 0.0 { length } else { tree.size };
        for (body, link) in tree.links.iter().enumerate().filter_map(|(body, link)| Some((body, (*link)?))) {
            let length = or_size(of_link.get(&body).copied().unwrap_or_default());
            (0..count).filter(|row| tree.holds[*row] && tree.joint_of_row[*row] == link.joint).for_each(|row| {
                lengths[row] = length;
            });
        }
        rows.iter().for_each(|row| lengths[*row] = or_size(lengths[*row]));
        let sizes: Vec<f64> = (0..count)
            .map(|row| {
                let mut size = 0.0_f64;
                for joint in joints_of(row) {
                    let point = at.points[joint];
                    let of_joint = joints[joint].markers.iter().filter_map(|marker| marker.body());
                    for end in of_joint.filter_map(|b| at.ends[row].iter().find(|end| end.body == b)) {
                        let wrench = wrench_about(at, end.body, &end.entries, &point);
                        size = size.max(size_of(&scaled(&wrench, lengths[row])));
                    }
                }
                if size > 0.0 { size } else { 1.0 }
            })
            .collect();
        let mut loops = Self {
            matrix: DMatrix::zeros(0, 0),
            balance: vec![Vec::new(); rows.len()],
            sizes,
            lengths,
            links: BTreeMap::new(),
            columns: BTreeMap::new(),
            modes: Vec::new(),
            twists: 0,
            rows,
        };
        for body in ways.iter().flatten() {
            let Some(link) = tree.links[*body] else { continue };
            if !loops.links.contains_key(body) {
                let length = or_size(of_link[body]);
                let held = tree.held(at, link.joint, *body, length);
                loops.columns.insert(*body, loops.twists);
                loops.twists += held.free.len();
                loops.links.insert(*body, held);
            }
        }
        if with_modes {
            loops.find_modes(system, at, &ways);
        }
        loops.fill(at, tree);
        loops
    }

    /// Modes of the bodies on the ways, each with the largest part that it has in the rows there.
    fn find_modes(&mut self, system: &System, at: &Posture<'_>, ways: &[Vec<usize>]) {
        let mut largest: BTreeMap<usize, f64> = BTreeMap::new();
        let on_links = ways.iter().flatten().filter_map(|body| self.links.get(body)).flat_map(|held| &held.rows);
        for row in on_links.chain(&self.rows) {
            for end in &at.ends[*row] {
                for (k, entry) in end.entries.iter().enumerate().skip(6) {
                    let part = largest.entry(end.first + k).or_default();
                    *part = part.max(entry.abs() / self.sizes[*row]);
                }
            }
        }
        for first in system.first.windows(2) {
            let of_body = first[0] + 6..first[1];
            let most = largest.range(of_body.clone()).map(|(_, part)| *part).fold(0.0, f64::max);
            let moving = largest.range(of_body).filter(|(_, part)| **part > 0.0);
            self.modes.extend(moving.map(|(k, part)| (*k, part.max(STILL * most))));
        }
    }

    fn fill(&mut self, at: &Posture<'_>, tree: &Tree) {
        let twists = self.twists;
        let column_of: BTreeMap<usize, (usize, f64)> =
            self.modes.iter().enumerate().map(|(k, (mode, part))| (*mode, (twists + k, *part))).collect();
        let mut matrix = DMatrix::zeros(twists + self.modes.len(), self.rows.len());
        let ends = &at.ends;
        for (a, row) in self.rows.iter().enumerate() {
            let size = self.sizes[*row];
            let mut add_modes = |row: usize, factor: f64| {
                for end in ends[row].iter().filter(|end| end.entries.len() > 6 && !column_of.is_empty()) {
                    for (k, entry) in end.entries.iter().enumerate().skip(6) {
                        if let Some((column, part)) = column_of.get(&(end.first + k)) {
                            matrix[(*column, a)] += factor * entry / part;
                        }
                    }
                }
            };
            add_modes(*row, 1.0 / size);
            let mut pending: BTreeMap<(usize, usize), Vector6<f64>> = BTreeMap::new();
            let (mut largest, mut entries) = (0.0_f64, Vec::new());
            for end in &ends[*row] {
                let wrench = wrench_about(at, end.body, &end.entries, &tree.middle) / size;
                largest = largest.max(scaled(&wrench, tree.size).norm());
                pending.insert((tree.depth[end.body], end.body), wrench);
            }
            while let Some(((_, body), wrench)) = pending.pop_last() {
                if scaled(&wrench, tree.size).norm() <= ROUNDING * largest {
                    continue;
                }
                let (Some(link), Some(held)) = (tree.links[body], self.links.get(&body)) else { continue };
                let here = scaled(&moved(&wrench, &(held.point - tree.middle)), held.length);
                let first = self.columns[&body];
                entries.extend(held.free.iter().enumerate().map(|(k, free)| (first + k, free.dot(&here))));
                for (k, of_tree) in held.rows.iter().enumerate() {
                    let multiplier = -(0..6).map(|i| held.closing[(i, k)] * here[i]).sum::<f64>() / held.sizes[k];
                    self.balance[a].push((*of_tree, multiplier * size));
                    add_modes(*of_tree, multiplier);
                }
                if let Some(parent) = link.parent {
                    *pending.entry((tree.depth[parent], parent)).or_default() += wrench;
                }
            }
            entries.into_iter().for_each(|(column, entry)| matrix[(column, a)] += entry);
        }
        self.matrix = matrix;
    }

    /// The motion of all bodies by free motions of the tree, V and ω in body axes and q̇.
    pub fn motion(&self, system: &System, at: &Posture<'_>, tree: &Tree, free: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; system.coordinates()];
        for (k, (mode, part)) in self.modes.iter().enumerate() {
            out[*mode] = free[self.twists + k] / part;
        }
        let mut order: Vec<usize> = (0..system.bodies.len()).collect();
        order.sort_by_key(|body| tree.depth[*body]);
        // Twists about the middle: velocity of the material there, and angular velocity.
        let mut twists = vec![Vector6::zeros(); system.bodies.len()];
        for body in order {
            let Some(link) = tree.links[body] else { continue };
            let mut twist = link.parent.map_or_else(Vector6::zeros, |parent| twists[parent]);
            if let Some(held) = self.links.get(&body) {
                let first = self.columns[&body];
                let mut own = Vector6::zeros();
                held.free.iter().enumerate().for_each(|(k, twist)| own += twist * free[first + k]);
                for (k, row) in held.rows.iter().enumerate() {
                    let mut rate = 0.0;
                    for end in &at.ends[*row] {
                        rate += (6..end.entries.len()).map(|k| end.entries[k] * out[end.first + k]).sum::<f64>();
                    }
                    own -= Vector6::from_fn(|i, _| held.closing[(i, k)] * rate / held.sizes[k]);
                }
                let velocity: Vector3<f64> = own.fixed_rows::<3>(0).into();
                let omega = Vector3::from(own.fixed_rows::<3>(3)) / held.length;
                let at_middle = velocity + omega.cross(&(tree.middle - held.point));
                twist += Vector6::from_fn(|i, _| if i < 3 { at_middle[i] } else { omega[i - 3] });
            }
            twists[body] = twist;
            let omega: Vector3<f64> = twist.fixed_rows::<3>(3).into();
            let velocity = Vector3::from(twist.fixed_rows::<3>(0)) + omega.cross(&(at.positions[body] - tree.middle));
            put(&mut out, system.first[body], &(at.attitudes[body] * velocity));
            put(&mut out, system.first[body] + 3, &(at.attitudes[body] * omega));
        }
        out
    }

    /// Multipliers of all rows for these of rows that close loops over their sizes, of length one: Eq. (J32).
    pub fn idle_row(&self, parts: &[(usize, f64)]) -> Vec<f64> {
        let mut out = vec![0.0; self.sizes.len()];
        for (a, part) in parts {
            let row = self.rows[*a];
            out[row] += part / self.sizes[row];
            for (of_tree, multiplier) in &self.balance[*a] {
                out[*of_tree] += part / self.sizes[row] * multiplier;
            }
        }
        let length = out.iter().zip(&self.sizes).map(|(u, size)| (u * size).powi(2)).sum::<f64>().sqrt();
        if length > 0.0 {
            out.iter_mut().for_each(|u| *u /= length);
        }
        out
    }
}
