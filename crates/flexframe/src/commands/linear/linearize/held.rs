//! Small motions of a body that is held, or held in a driven spin.

use dynamics::{ConservativeBody, DrivenMotion, SteadySpin};
use faer::Mat;
use linear::{Channel, SecondOrder};
use model::Model;
use scene::Scene;

use super::channels::{input_channels, point_outputs, unit_of_coordinate};
use super::error::LinearizeError;

/// A factor of a load below this part of its largest is none.
const NONE: f64 = 1e-12;

/// The equations about rest under the loads of time 0, or about the spin of a drive at time 0.
pub(super) fn of_held(scene: &Scene, model: &Model) -> Result<(SecondOrder, f64), LinearizeError> {
    let refuse =
        |found: &str, help| Err(LinearizeError::Refused { scene: scene.path.clone(), found: found.to_owned(), help });
    if model.physics.large_deflection.is_some() {
        return refuse("a body with large modes", "give `large_deflection = false` in [effects]");
    }
    let free = model.body.motion.count();
    let (state, mut stiffness) = model
        .stiffness_at_rest(scene)
        .map_err(|source| LinearizeError::Rest { scene: scene.path.clone(), source: Box::new(source) })?;
    let nf = stiffness.nrows();
    let body = ConservativeBody::new(&model.body, model.damping_ratios(), model.loads().to_vec(), &model.physics);
    let body = body
        .map_err(|source| LinearizeError::Rest { scene: scene.path.clone(), source: Box::new(source.into()) })?
        .beginning_at(&model.initial(scene));
    let unit_forces = body.unit_forces(&state);
    let turning = model.physics.drive.is_none() && free > 0;
    if turning && unit_forces.iter().zip(model.loads()).any(|(unit, load)| acts_on_rigid(model, unit, &**load)) {
        return refuse(
            "loads at time 0 act on a body that can turn or slide, which gives it a stiffness or an acceleration",
            "say the support as a joint to the ground ([[joints]]), whose linear model has it",
        );
    }
    let mut damping = Mat::from_fn(nf, nf, |i, j| {
        if i == j { 2.0 * model.damping_ratios()[i] * model.body.circular_frequencies[i] } else { 0.0 }
    });
    let mut speed = 0.0;
    if let Some(drive) = &model.physics.drive {
        match drive.motion {
            DrivenMotion::Turn { axis } => {
                speed = drive.speed.amplitude * drive.speed.history.at(0.0, 0.0);
                let spin = SteadySpin::new(&model.body, &axis, &model.physics.effects);
                let [of_spin, gyroscopic] = spin.matrices(speed);
                for k in 0..nf {
                    stiffness[(k, k)] -= model.body.circular_frequencies[k].powi(2);
                }
                stiffness += of_spin;
                damping += gyroscopic;
            }
            DrivenMotion::Slide { .. } => {}
        }
    }
    // Rigid motions that are left: none of a drive, which is given.
    let bases = [&model.body.translation_basis, &model.body.rotation_basis];
    let rigid: Vec<usize> = match turning {
        true => (0..6).filter(|k| bases[k / 3].column(k % 3).norm() > 0.0).collect(),
        false => Vec::new(),
    };
    let (r, n) = (rigid.len(), rigid.len() + nf);
    let with_rigid =
        |matrix: &Mat<f64>| Mat::from_fn(n, n, |i, j| if i >= r && j >= r { matrix[(i - r, j - r)] } else { 0.0 });
    let on_rigid =
        |k: usize, unit: &[f64]| (0..3).map(|i| bases[k / 3][(i, k % 3)] * unit[3 * (k / 3) + i]).sum::<f64>();
    let forces = Mat::from_fn(n, unit_forces.len(), |i, j| match i < r {
        true => on_rigid(rigid[i], &unit_forces[j]),
        false => unit_forces[j][6 + i - r],
    });
    let names = (1..=r).map(|k| format!("rigid{k}")).chain((1..=nf).map(|k| format!("mode{k}")));
    let unit = unit_of_coordinate(scene);
    let outputs = model.points.iter().flat_map(|(name, point)| {
        let columns: Vec<_> = rigid.iter().copied().chain(6..6 + nf).map(|k| point.columns()[k]).collect();
        point_outputs(scene, name, &columns)
    });
    let equations = SecondOrder {
        stiffness: with_rigid(&stiffness),
        damping: with_rigid(&damping),
        forces,
        inputs: input_channels(scene, model, ""),
        outputs: outputs.collect(),
        coordinates: names.map(|name| Channel::new(name, unit.clone())).collect(),
    };
    Ok((equations, speed))
}

/// True of a load that acts at time 0 on the motions of the body as a whole.
fn acts_on_rigid(model: &Model, unit: &[f64], load: &dyn dynamics::Load) -> bool {
    let factor = load.history().map_or(1.0, |history| history.at(0.0, 0.0));
    let bases = [&model.body.translation_basis, &model.body.rotation_basis];
    let parts = (0..6).map(|k| (0..3).map(|i| (bases[k / 3][(i, k % 3)] * unit[3 * (k / 3) + i]).abs()).sum::<f64>());
    let size = unit.iter().map(|x| x.abs()).fold(0.0, f64::max);
    factor != 0.0 && parts.fold(0.0, f64::max) > NONE * size
}
