//! Motions of a held body as a whole.

use dynamics::Load;
use model::Model;
use nalgebra::Vector3;

/// A force on the motions of the whole body below this part of the largest of a load is none.
const NONE: f64 = 1e-12;

/// A motion of unit modal mass that the support leaves the body as a whole.
pub(super) struct Rigid {
    /// Its number among the six of [`dynamics::PointShapes::columns`].
    pub number: usize,
    /// Velocity of the origin, or angular velocity.
    direction: Vector3<f64>,
}

impl Rigid {
    /// The force on its coordinate by a load: force and moment about the origin are the first six of its generalised forces.
    pub fn force(&self, unit: &[f64]) -> f64 {
        let first = 3 * (self.number / 3);
        self.direction.iter().zip(&unit[first..]).map(|(direction, force)| direction * force).sum()
    }
}

/// The motions of the whole body that its support leaves.
pub(super) fn rigid_motions(model: &Model) -> Vec<Rigid> {
    let bases = [&model.body.translation_basis, &model.body.rotation_basis];
    let all = (0..6).map(|number| Rigid { number, direction: bases[number / 3].column(number % 3).into() });
    all.filter(|motion| motion.direction.norm() > 0.0).collect()
}

/// True of a load that acts at a time on the motions of the body as a whole.
pub(super) fn acts_on(rigid: &[Rigid], unit: &[f64], load: &dyn Load, time: f64) -> bool {
    let factor = load.history().map_or(1.0, |history| history.at(time, time));
    let parts = |motion: &Rigid| {
        let first = 3 * (motion.number / 3);
        motion.direction.iter().zip(&unit[first..]).map(|(direction, force)| (direction * force).abs()).sum::<f64>()
    };
    let size = unit.iter().map(|x| x.abs()).fold(0.0, f64::max);
    factor != 0.0 && rigid.iter().map(parts).fold(0.0, f64::max) > NONE * size
}
