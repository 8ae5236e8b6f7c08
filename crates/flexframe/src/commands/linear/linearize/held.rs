//! Small motions of a body that is held, or held in a driven spin.

use dynamics::{DrivenMotion, Load, SteadySpin};
use faer::Mat;
use linear::{Channel, SecondOrder};
use model::{AtRest, Model};
use nalgebra::Vector3;
use scene::Scene;

use super::channels::{input_channels, point_outputs, unit_of_coordinate};
use super::error::LinearizeError;
use super::state::State;

/// A force on the motions of the whole body below this part of the largest of a load is none.
const NONE: f64 = 1e-12;

/// The equations about rest under the loads of time 0, or about the spin of a drive at time 0.
pub(super) fn of_held(scene: &Scene, model: &Model) -> Result<(SecondOrder, State), LinearizeError> {
    let refuse =
        |found: &str, help| Err(LinearizeError::Refused { scene: scene.path.clone(), found: found.to_owned(), help });
    if model.physics.large_deflection.is_some() {
        return refuse("a body with large modes", "give `large_deflection = false` in [effects]");
    }
    let failed = |source| LinearizeError::Rest { scene: scene.path.clone(), source: Box::new(source) };
    let AtRest { unit_forces, mut stiffness } = model.at_rest(scene).map_err(failed)?;
    // Rigid motions that are left: none of a drive, which is given.
    let rigid = if model.physics.drive.is_none() { rigid_motions(model) } else { Vec::new() };
    if unit_forces.iter().zip(model.loads()).any(|(unit, load)| acts_on(&rigid, unit, &**load)) {
        return refuse(
            "loads at time 0 act on a body that can turn or slide, which gives it a stiffness or an acceleration",
            "say the support as a joint to the ground ([[joints]]), whose linear model has it",
        );
    }
    let nf = stiffness.nrows();
    let mut damping = Mat::from_fn(nf, nf, |i, j| {
        if i == j { 2.0 * model.damping_ratios()[i] * model.body.circular_frequencies[i] } else { 0.0 }
    });
    let mut omega_global = Vector3::zeros();
    if let Some(drive) = &model.physics.drive
        && let DrivenMotion::Turn { axis } = drive.motion
    {
        let speed = drive.speed.amplitude * drive.speed.history.at(0.0, 0.0);
        let [of_spin, gyroscopic] = SteadySpin::new(&model.body, &axis, &model.physics.effects).added(speed);
        stiffness += of_spin;
        damping += gyroscopic;
        omega_global = axis * speed;
    }
    let (r, n) = (rigid.len(), rigid.len() + nf);
    let with_rigid =
        |matrix: &Mat<f64>| Mat::from_fn(n, n, |i, j| if i >= r && j >= r { matrix[(i - r, j - r)] } else { 0.0 });
    let forces = Mat::from_fn(n, unit_forces.len(), |i, j| match rigid.get(i) {
        Some(motion) => motion.force(&unit_forces[j]),
        None => unit_forces[j][6 + i - r],
    });
    let names = (1..=r).map(|k| format!("rigid{k}")).chain((1..=nf).map(|k| format!("mode{k}")));
    let unit = unit_of_coordinate(scene);
    let outputs = model.points.iter().flat_map(|(name, point)| {
        let columns = rigid.iter().map(|motion| motion.number).chain(6..6 + nf);
        point_outputs(scene, name, &columns.map(|k| point.columns()[k]).collect::<Vec<_>>())
    });
    let equations = SecondOrder {
        stiffness: with_rigid(&stiffness),
        damping: with_rigid(&damping),
        forces,
        inputs: input_channels(scene, model, ""),
        outputs: outputs.collect(),
        coordinates: names.map(|name| Channel::new(name, unit.clone())).collect(),
    };
    Ok((equations, State { omega_global: omega_global.into(), rigid: r, warnings: Vec::new() }))
}

/// A motion of unit modal mass that the support leaves the body as a whole.
struct Rigid {
    /// Its number among the six of [`dynamics::PointShapes::columns`].
    number: usize,
    /// Velocity of the origin, or angular velocity.
    direction: Vector3<f64>,
}

impl Rigid {
    /// The force on its coordinate by a load: force and moment about the origin are the first six of its generalised forces.
    fn force(&self, unit: &[f64]) -> f64 {
        let first = 3 * (self.number / 3);
        self.direction.iter().zip(&unit[first..]).map(|(direction, force)| direction * force).sum()
    }
}

fn rigid_motions(model: &Model) -> Vec<Rigid> {
    let bases = [&model.body.translation_basis, &model.body.rotation_basis];
    let all = (0..6).map(|number| Rigid { number, direction: bases[number / 3].column(number % 3).into() });
    all.filter(|motion| motion.direction.norm() > 0.0).collect()
}

/// True of a load that acts at time 0 on the motions of the body as a whole.
fn acts_on(rigid: &[Rigid], unit: &[f64], load: &dyn Load) -> bool {
    let factor = load.history().map_or(1.0, |history| history.at(0.0, 0.0));
    let parts = |motion: &Rigid| {
        let first = 3 * (motion.number / 3);
        motion.direction.iter().zip(&unit[first..]).map(|(direction, force)| (direction * force).abs()).sum::<f64>()
    };
    let size = unit.iter().map(|x| x.abs()).fold(0.0, f64::max);
    factor != 0.0 && rigid.iter().map(parts).fold(0.0, f64::max) > NONE * size
}
