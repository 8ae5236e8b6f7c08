//! Islands of bodies: those that joints or elements connect, not by way of the ground.

use crate::system::marker::Marker;

/// Bodies that joints or elements connect with each other.
#[derive(Debug, Clone)]
pub(crate) struct Island {
    pub bodies: Vec<usize>,
    /// True if one of them is tied to the ground.
    pub is_on_ground: bool,
}

/// The islands of bodies with these connections.
pub(crate) fn islands<'m>(bodies: usize, groups: impl Iterator<Item = Vec<&'m Marker>>) -> Vec<Island> {
    let mut island: Vec<usize> = (0..bodies).collect();
    let mut is_on_ground = vec![false; bodies];
    for markers in groups {
        let held: Vec<usize> =
            markers.iter().filter_map(|marker| marker.body()).filter(|body| *body < bodies).collect();
        let Some(first) = held.first() else { continue };
        is_on_ground[*first] |= held.len() < markers.len();
        for body in &held {
            let (from, to) = (island[*body], island[*first]);
            island.iter_mut().filter(|island| **island == from).for_each(|island| *island = to);
        }
    }
    let of = |number: usize| {
        let bodies: Vec<usize> = (0..bodies).filter(|body| island[*body] == number).collect();
        let is_on_ground = bodies.iter().any(|body| is_on_ground[*body]);
        (!bodies.is_empty()).then_some(Island { bodies, is_on_ground })
    };
    (0..bodies).filter_map(of).collect()
}
