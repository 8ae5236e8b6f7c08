//! The rigid plate that the paper compares with: same mass, inertia and load.

use std::any::Any;

use diagnostic::{Failure, Kind};
use dynamics::{LoadFrame, PointForce, SharedLoad};
use model::Model;
use nalgebra::Vector3;
use results::Results;
use rigid_kin::{Attitude, RigidBody, RigidState, Wrench};

/// The point whose accelerations Figs. 10 to 13 show.
pub(super) const WATCHED_POINT: &str = "P1";

/// Histories of the rigid plate at the times of the results.
pub(super) struct RigidHistories {
    /// Angular velocity, body axes.
    pub omega_body: Vec<[f64; 3]>,
    /// Angular acceleration, body axes.
    pub alpha_body: Vec<[f64; 3]>,
    /// Acceleration of the watched point, global.
    pub acceleration_global: Vec<[f64; 3]>,
}

/// The dead force of a load; `None` for other loads.
pub(super) fn dead_force(load: &SharedLoad) -> Option<&PointForce> {
    let force = (&**load as &dyn Any).downcast_ref::<PointForce>();
    force.filter(|force| force.frame == LoadFrame::Global)
}

/// Integrates the rigid plate under the scene's loads, in the steps of the results; `None` where there are other loads
/// than dead forces.
pub(super) fn histories(model: &Model, results: &Results) -> Result<Option<RigidHistories>, Failure> {
    let Some(forces) = model.loads().iter().map(dead_force).collect::<Option<Vec<_>>>() else { return Ok(None) };
    let body = RigidBody::new(model.body.mass, model.body.inertia)
        .map_err(|error| Kind::Refused.alone().says(error.to_string()))?;
    let watched = model.points.iter().find(|(name, _)| name == WATCHED_POINT);
    let arm = watched.map_or_else(Vector3::zeros, |(_, point)| point.position_body());
    let wrench = |time: f64, attitude: &Attitude| {
        forces.iter().fold(Wrench::zero(), |sum, PointForce { point, force, history, .. }| {
            let one = Wrench::dead_force(attitude, &point.position_body(), &(force * history.at(time, time)));
            Wrench { force_global: sum.force_global + one.force_global, moment_body: sum.moment_body + one.moment_body }
        })
    };
    let first = |path| results.vectors(path)?.first().copied().map(Vector3::from);
    let mut histories =
        RigidHistories { omega_body: Vec::new(), alpha_body: Vec::new(), acceleration_global: Vec::new() };
    let mut state = RigidState {
        attitude: Attitude::identity(),
        omega_body: first("angular_velocity").unwrap_or_default(),
        position_global: first("position").unwrap_or_default(),
        velocity_global: first("velocity").unwrap_or_default(),
    };
    let times = results.numbers("time").unwrap_or_default();
    for (i, time) in times.iter().copied().enumerate() {
        if i > 0 {
            let before = times[i - 1];
            let stepped = body.step(&state, before, time - before, wrench);
            state = stepped.map_err(|error| Kind::Run.alone().says(error.to_string()))?;
        }
        let load = wrench(time, &state.attitude);
        let omega = state.omega_body;
        let alpha = body.angular_acceleration_body(&omega, &load.moment_body);
        let of_point = alpha.cross(&arm) + omega.cross(&omega.cross(&arm));
        histories.omega_body.push(omega.into());
        histories.alpha_body.push(alpha.into());
        histories
            .acceleration_global
            .push((load.force_global / body.mass() + state.attitude.to_global(&of_point)).into());
    }
    Ok(Some(histories))
}
