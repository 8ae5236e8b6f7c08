//! Motions of a held body as a whole.

use dynamics::Load;
use model::Model;
use nalgebra::Vector3;

/// A force on the motions of the whole body below this part of the largest of a load is none.
const NONE: f64 = 1e-12;

/// A motion of unit modal mass that the support leaves the body as a whole.
pub(super) struct Rigid {
    /// First of its coordinates among the six of the frame: 0 of a velocity of the origin, 3 of an angular velocity.
    first: usize,
    direction: Vector3<f64>,
}

impl Rigid {
    /// Its part along one of the six motions of the frame.
    pub fn along(&self, motion: usize) -> f64 {
        motion.checked_sub(self.first).filter(|axis| *axis < 3).map_or(0.0, |axis| self.direction[axis])
    }
}

/// The motions of the whole body that its support leaves.
pub(super) fn rigid_motions(model: &Model) -> Vec<Rigid> {
    let bases = [&model.body.translation_basis, &model.body.rotation_basis];
    let all = (0..6).map(|k| Rigid { first: 3 * (k / 3), direction: bases[k / 3].column(k % 3).into() });
    all.filter(|motion| motion.direction.norm() > 0.0).collect()
}

/// True of a load that acts at a time on the motions of the body as a whole.
pub(super) fn acts_on(rigid: &[Rigid], unit: &[f64], load: &dyn Load, time: f64) -> bool {
    let factor = load.history().map_or(1.0, |history| history.at(time, time));
    let parts = |motion: &Rigid| (0..6).map(|k| (motion.along(k) * unit[k]).abs()).sum::<f64>();
    let size = unit.iter().map(|x| x.abs()).fold(0.0, f64::max);
    factor != 0.0 && rigid.iter().map(parts).fold(0.0, f64::max) > NONE * size
}
