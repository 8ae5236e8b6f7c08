//! A rigid body without a mesh.

use advice::{Case, advise};
use dynamics::{Effect, Physics, PointShapes};
use faer::Mat;
use frames_rk4::Paper;
use modal::Support;
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody};
use scene::{Frame, RigidBody};

use crate::building::progress::BuildTimes;
use crate::error::{BuildError, modal};
use crate::load::mesh_load::{self, BaseAcceleration};
use crate::model::initial::initial;
use crate::model::points::output_points;
use crate::model::{Model, Size};
use crate::needs::Needed;
use crate::reduction::physics;
use crate::structure::remainders::Remainders;
use crate::support::support;
use crate::tie::body_marker;

pub(crate) fn build(scene: &Needed<'_>, rigid: &RigidBody) -> Result<Model, BuildError> {
    let (Support { motion, .. }, drive) = support(scene, None)?;
    let center = Vector3::from(rigid.center_of_mass);
    let about_center = Matrix3::from_fn(|i, j| rigid.inertia[i][j]);
    let arm = center - motion.fixed_point().unwrap_or(center);
    let inertia = about_center + (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * rigid.mass;
    let body = match rigid.is_point() {
        true => ReducedBody::point(rigid.mass, center),
        false => ReducedBody::rigid(rigid.mass, center, inertia, motion),
    };
    let body = body.map_err(modal(scene))?;
    let point = |_: String, at: [f64; 3]| -> Result<PointShapes, BuildError> {
        let position_body = Vector3::from(at) - body.origin;
        Ok(PointShapes::new(&body, &BodyPoint { position_body, shapes: Mat::zeros(3, 0) }))
    };
    let points = output_points(scene, point)?;
    let reference_points = match scene.frame {
        Some(Frame { r, p, q }) => [r, p, q].map(|x| Vector3::from(x) - body.origin),
        None => [Vector3::zeros(), Vector3::x(), Vector3::y()],
    };
    let loads = mesh_load::on_rigid(scene, &body)?;
    // The radius of gyration stands for the size. A point mass has none: nothing depends on the length that it is given.
    let inertia_trace: f64 = (0..3).map(|i| rigid.inertia[i][i]).sum();
    let length = if rigid.is_point() { 1.0 } else { (inertia_trace / rigid.mass).sqrt() };
    let size = Size { length, peaks: Vec::new() };
    let initial = initial(scene, &body);
    let advice = advise(
        &Case {
            body: &body,
            damping_ratios: &[],
            loads: &loads.loads,
            is_gravity: &loads.is_gravity,
            drive: drive.as_ref(),
            initial: &initial,
            end: scene.time.end,
            length: size.length,
            length_unit: &scene.units.length,
            peaks: &[],
            static_compliances: &[],
            centrifugal_remainders: &[],
            drive_remainder: None,
            backbones: &[],
            manifold: None,
            coupling: None,
        },
        scene.effects.tolerance,
    )?;
    let advice = physics::in_joints(scene, advice);
    let effects = physics::effects(scene, &advice, &body, 0);
    Ok(Model {
        meshed: None,
        base: BaseAcceleration::of(scene, effects[Effect::Gravity])?,
        all_loads: loads.loads.clone(),
        loads: loads.acting(effects[Effect::Gravity]),
        physics: Physics { effects, drive, ..Physics::default() },
        points,
        markers: body_marker::on_rigid(scene, &body)?,
        paper: Paper { reference_points },
        advice,
        refusal: None,
        choices: scene.effects.choices,
        times: BuildTimes::default(),
        damping_ratios: Vec::new(),
        all_damping_ratios: Vec::new(),
        size,
        body,
        left_out: Remainders::default(),
        backbones: Vec::new(),
        stress: None,
        supports: None,
    })
}
