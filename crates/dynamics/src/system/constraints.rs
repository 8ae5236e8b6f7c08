//! The rows of all joints of a system, and what they do to its bodies.

use crate::system::elimination::inverse::Number;
use crate::system::joint::Joint;
use crate::system::marker::{BodyPlace, MarkerPlace};

/// One end of a row: the entries of G for the coordinates of one body.
#[derive(Debug, Clone)]
pub(crate) struct End {
    pub body: usize,
    /// First coordinate of the body.
    first: usize,
    /// Entries: force and moment about the origin, both in body axes, and modal forces.
    pub entries: Vec<f64>,
}

/// G and the residuals g where the bodies are, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Constraints {
    /// g (m).
    pub residuals: Vec<f64>,
    /// g_t: rates of the residuals by drives alone (m).
    pub own_rates: Vec<f64>,
    /// The ends of each row that are on bodies.
    pub ends: Vec<Vec<End>>,
}

impl Constraints {
    /// Room for the rows of these joints; `first` are the first coordinates of the bodies, and their number.
    pub fn new(joints: &[Joint], first: &[usize]) -> Self {
        let ends: Vec<Vec<End>> = joints
            .iter()
            .flat_map(|joint| joint.rows.iter().map(|_| &joint.markers))
            .map(|markers| {
                let of_bodies = markers.iter().filter_map(|marker| marker.body());
                of_bodies
                    .map(|body| End { body, first: first[body], entries: vec![0.0; first[body + 1] - first[body]] })
                    .collect()
            })
            .collect();
        Self { residuals: vec![0.0; ends.len()], own_rates: vec![0.0; ends.len()], ends }
    }

    /// Finds g, its own rate and G at a time, by the branch of another.
    pub fn find<'a>(&mut self, joints: &[Joint], times: [f64; 2], place: impl Fn(usize) -> BodyPlace<'a>) {
        let mut row = 0;
        for joint in joints {
            let places: [MarkerPlace; 2] =
                joint.markers.each_ref().map(|marker| marker.place(marker.body().map(&place).as_ref()));
            joint.wrenches(places.each_ref(), times, |wrench| {
                (self.residuals[row], self.own_rates[row]) = (wrench.residual, wrench.own_rate);
                let forces = [-wrench.force, wrench.force];
                let on_bodies = (0..2).filter(|end| joint.markers[*end].body().is_some());
                for (end, k) in self.ends[row].iter_mut().zip(on_bodies) {
                    end.entries.fill(0.0);
                    joint.markers[k].add_wrench(&places[k], [&forces[k], &wrench.moments[k]], &mut end.entries);
                }
                row += 1;
            });
        }
    }

    /// out = G v + g_t (m)
    pub fn rates(&self, velocities: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&self.own_rates);
        self.add_rates(1.0, velocities, out);
    }

    /// out += factor G v
    pub fn add_rates<T: Number>(&self, factor: f64, velocities: &[T], out: &mut [T]) {
        for (out, ends) in out.iter_mut().zip(&self.ends) {
            for End { first, entries, .. } in ends {
                let velocities = &velocities[*first..];
                entries.iter().zip(velocities).for_each(|(entry, velocity)| *out += velocity.scale(factor * entry));
            }
        }
    }

    /// forces += Gᵀ λ
    pub fn add_forces<T: Number>(&self, multipliers: &[T], forces: &mut [T]) {
        for (multiplier, ends) in multipliers.iter().zip(&self.ends) {
            for End { first, entries, .. } in ends {
                let forces = forces[*first..].iter_mut();
                forces.zip(entries).for_each(|(force, entry)| *force += multiplier.scale(*entry));
            }
        }
    }
}
