//! Which bodies joints connect.

use crate::system::joint::Joint;

/// Groups of bodies that joints connect with each other and not with the ground.
pub(crate) fn free_groups(bodies: usize, joints: &[Joint]) -> Vec<Vec<usize>> {
    // The ground has the number after those of the bodies.
    let mut group: Vec<usize> = (0..=bodies).collect();
    for joint in joints {
        let [a, b] = joint.markers.each_ref().map(|marker| group[marker.body().unwrap_or(bodies)]);
        group.iter_mut().filter(|group| **group == a).for_each(|group| *group = b);
    }
    let of = |number: usize| (0..bodies).filter(|body| group[*body] == number).collect::<Vec<usize>>();
    (0..=bodies).filter(|number| *number != group[bodies]).map(of).filter(|members| !members.is_empty()).collect()
}
