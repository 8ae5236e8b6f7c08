//! Forces of joints on a body in a row of a results file.

use model::{MarkerForce, Model};
use nalgebra::Vector3;
use results::Results;
use scene::{End, System, Tie};

use super::rows;

/// The reason that the forces on a body are not known from its results file; `None` where they are.
pub(super) fn unknown(system: &System, body: usize) -> Option<&'static str> {
    let is_on = |end: &End| matches!(end, End::Body { body: other, .. } if *other == body);
    let touches = |between: &[End; 2]| between.iter().any(is_on);
    if system.springs.iter().any(|spring| touches(&spring.between)) {
        return Some("a spring acts on it, whose force is not in the results file");
    }
    if system.bushings.iter().any(|bushing| touches(&bushing.between)) {
        return Some("a bushing acts on it, whose force is not in the results file");
    }
    let with_effort = |joint: &&scene::Joint| joint.spring.is_some() || joint.motor.is_some();
    if system.joints.iter().filter(with_effort).any(|joint| touches(&joint.between)) {
        return Some("a joint with a spring or a motor acts on it, whose force is not told apart in the results file");
    }
    let has_several = |end: &End| match end {
        End::Body { body: other, marker } if *other == body => {
            system.bodies[body].markers.get(*marker).is_some_and(|marker| marker.tie != Tie::Mean)
        }
        _ => false,
    };
    if system.joints.iter().flat_map(|joint| &joint.between).any(has_several) {
        return Some("a joint holds it at several places, whose forces are not told apart in the results file");
    }
    None
}

/// The forces of all joints on a body in a row, at its markers.
pub(super) fn forces(
    results: &Results,
    system: &System,
    models: &[Model],
    body: usize,
    row: usize,
) -> Vec<MarkerForce> {
    let mut forces = Vec::new();
    for joint in &system.joints {
        let [force, moment] = ["force", "moment"].map(|name| {
            let of_rows = results.vectors::<3>(&format!("joints/{}/{name}", joint.name));
            of_rows.and_then(|rows| rows.get(row)).map_or_else(Vector3::zeros, |vector| Vector3::from(*vector))
        });
        let place = |end: &End| place(results, system, models, end, row);
        let between = match (place(&joint.between[0]), place(&joint.between[1])) {
            (Some(first), Some(second)) => second - first,
            // The ground takes the place of the other end.
            _ => Vector3::zeros(),
        };
        for (end, sign) in joint.between.iter().zip([-1.0, 1.0]) {
            let End::Body { body: other, marker } = end else { continue };
            if *other == body {
                // What acts on the first end acts at the place of the second.
                let arm = if sign < 0.0 { between } else { Vector3::zeros() };
                let force_global = sign * force;
                let moment_global = sign * moment + arm.cross(&force_global);
                forces.push(MarkerForce { marker: *marker, force_global, moment_global });
            }
        }
    }
    forces
}

/// Where a marker is, global; `None` for a place on the ground that follows from the other end.
fn place(results: &Results, system: &System, models: &[Model], end: &End, row: usize) -> Option<Vector3<f64>> {
    match end {
        End::Ground { marker } => Some(Vector3::from(system.ground.get((*marker)?)?.at)),
        End::Body { body, marker } => {
            let model = models.get(*body)?;
            let motion = rows::motion(results, *body, row)?;
            let marker = model.markers.get(*marker)?;
            let arm = model.arm(&marker.point, &motion.modal_displacement);
            Some(motion.origin_global + motion.attitude.to_global(&arm))
        }
    }
}
