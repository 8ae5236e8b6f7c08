//! Forces and moments of joints, couplings and elements at each marker: for those who know the bodies by more than their modes.

use crate::system::marker::motion::MarkerWrench;
use crate::system::marker::{Marker, MarkerPlace};
use crate::system::radau::SystemMotion;

impl SystemMotion {
    /// The same motion with the turn of each joint counted on from one that is less than half a turn away. Springs of joints have
    /// the force of all turns; bodies in a state tell only part of one.
    #[must_use]
    pub fn with_turns(mut self, turns: &[f64]) -> Self {
        for (joint, turn) in turns.iter().enumerate() {
            if joint < self.start.joints.len() {
                self.start.joints[joint].turn = *turn;
                self.start.joints[joint].turn = self.first.joint_coordinates(&self.system, &self.start, joint).turn;
            }
        }
        self
    }

    /// Calls `take` with each marker on a body, and what a joint, its spring or motor, a coupling or an element puts on it, after
    /// [`Self::find_reactions`]. A marker comes as often as something acts on it.
    pub fn each_wrench(&self, mut take: impl FnMut(&Marker, MarkerWrench)) {
        let connections = &self.system.connections;
        let mut multipliers = self.reactions.iter();
        for joint in &connections.joints {
            let driven = joint.driven_at([self.time; 2]);
            for (markers, rows) in joint.groups() {
                let places = markers.each_ref().map(|marker| self.place_of(marker));
                for row in rows {
                    let multiplier = multipliers.next().copied().unwrap_or_default();
                    let wrench = row.wrench(places.each_ref(), driven);
                    put(markers, wrench.on_both(), multiplier, &mut take);
                }
            }
        }
        for coupling in &connections.couplings {
            let multiplier = multipliers.next().copied().unwrap_or_default();
            for term in &coupling.terms {
                let markers = &connections.joints[term.joint].markers;
                let places = markers.each_ref().map(|marker| self.place_of(marker));
                let wrench = term.coordinate.wrench(places.each_ref(), self.start.joints[term.joint].turn);
                put(markers, wrench.on_both(), multiplier * term.factor, &mut take);
            }
        }
        for (number, coordinate, force) in connections.joint_forces() {
            let markers = &connections.joints[number].markers;
            let places = markers.each_ref().map(|marker| self.place_of(marker));
            let wrench = coordinate.wrench(places.each_ref(), self.start.joints[number].turn);
            let motions = [0, 1].map(|k| self.first.motion_of(&self.system, &markers[k], &places[k]));
            let effort = force.at([wrench.residual, wrench.rate(motions.each_ref())], [self.time; 2]).sum();
            put(markers, wrench.on_both(), effort, &mut take);
        }
        for (number, (element, markers)) in connections.elements.iter().zip(&connections.element_markers).enumerate() {
            let motion = |marker: &Marker| {
                let motion = self.first.motion_of(&self.system, marker, &self.place_of(marker));
                self.system.motion_for(number, marker, motion, self.time)
            };
            let motions: Vec<_> = markers.iter().map(motion).collect();
            let mut wrenches = vec![MarkerWrench::default(); markers.len()];
            element.apply([self.time; 2], &motions, &mut wrenches);
            for (marker, wrench) in markers.iter().zip(wrenches).filter(|(marker, _)| marker.body().is_some()) {
                take(marker, wrench);
            }
        }
    }

    fn place_of(&self, marker: &Marker) -> MarkerPlace {
        marker.place(marker.body().map(|b| self.first.body_place(&self.system, b)).as_ref())
    }
}

/// Hands on what a scalar of two markers puts on those that are on bodies, times a factor.
fn put(
    markers: &[Marker; 2],
    on_both: [[nalgebra::Vector3<f64>; 2]; 2],
    factor: f64,
    take: &mut impl FnMut(&Marker, MarkerWrench),
) {
    for (marker, [force, moment]) in markers.iter().zip(on_both).filter(|(marker, _)| marker.body().is_some()) {
        take(marker, MarkerWrench { force_global: force * factor, moment_global: moment * factor });
    }
}
