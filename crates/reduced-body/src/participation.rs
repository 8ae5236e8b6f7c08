//! The part of the mass that each mode carries in a motion of the base, Eqs. (M13) and (M14) of `docs/method/modes.md`.

use nalgebra::{DMatrix, Matrix3, SMatrix, SVector, Vector3};

use crate::body::ReducedBody;

/// Six numbers of the motions of a base: translations along the axes of the mesh, then rotations about them.
pub type OfBase = [f64; 6];

/// The parts of a body's mass that move with its base.
#[derive(Debug, Clone, PartialEq)]
pub struct Participation {
    /// The point that the base turns about, in the mesh's frame.
    pub about: Vector3<f64>,
    /// Mass of the whole body, three times, and its moments of inertia about the point: what all motions carry together.
    pub whole: OfBase,
    /// Effective mass of the rigid motions that the support leaves: it is apart from the modes.
    pub rigid: OfBase,
    /// Participation factors Γ of the flexible modes (nf), whose modal masses are 1: √mass, and √mass·length.
    pub factors: Vec<OfBase>,
}

impl Participation {
    /// Effective masses Γ² of the flexible modes (nf).
    pub fn effective_masses(&self) -> Vec<OfBase> {
        self.factors.iter().map(|factors| factors.map(|factor| factor * factor)).collect()
    }

    /// The part of the whole that neither the rigid motions nor the modes carry, 0 to 1; of a motion without inertia, 0.
    pub fn missed(&self) -> OfBase {
        std::array::from_fn(|i| {
            let carried = self.rigid[i] + self.factors.iter().map(|factors| factors[i].powi(2)).sum::<f64>();
            if self.whole[i] > 0.0 { (1.0 - carried / self.whole[i]).max(0.0) } else { 0.0 }
        })
    }
}

impl ReducedBody {
    /// The participation of the modes in a motion of the base that turns about a point, given in the mesh's frame.
    pub fn participation(&self, about: &Vector3<f64>) -> Participation {
        let arm = about - self.origin;
        let base: [SVector<f64, 6>; 6] = std::array::from_fn(|i| {
            let axis = Vector3::ith(i % 3, 1.0);
            if i < 3 { join(&axis, &Vector3::zeros()) } else { join(&-axis.cross(&arm), &axis) }
        });
        let mass = self.rigid_mass();
        let factors = |k: usize| {
            let (t, b) =
                (self.translation_first.each_ref().map(|t| t[k]), self.rotation_first.each_ref().map(|b| b[k]));
            let of_mode = join(&Vector3::from(t), &Vector3::from(b));
            base.map(|motion| motion.dot(&of_mode))
        };
        let rigid = self.rigid_velocities();
        // ‖P r‖² of the projection on the motions that are left, in the norm of the mass.
        let of_rigid = |motion: &SVector<f64, 6>| {
            if rigid.is_empty() {
                return 0.0;
            }
            let left = DMatrix::from_fn(6, rigid.len(), |i, k| rigid[k][i]);
            let momenta = left.transpose() * (mass * motion);
            let gram = left.transpose() * mass * &left;
            gram.cholesky().map_or(0.0, |gram| momenta.dot(&gram.solve(&momenta)))
        };
        Participation {
            about: *about,
            whole: base.map(|motion| motion.dot(&(mass * motion))),
            rigid: base.map(|motion| of_rigid(&motion)),
            factors: (0..self.flexible()).map(factors).collect(),
        }
    }

    /// The mass matrix of the undeformed body (6×6), of the velocity of its origin and its angular velocity.
    pub fn rigid_mass(&self) -> SMatrix<f64, 6, 6> {
        let moment = (self.mass * (self.center_of_mass - self.origin)).cross_matrix();
        let mut mass = SMatrix::<f64, 6, 6>::zeros();
        mass.fixed_view_mut::<3, 3>(0, 0).copy_from(&(Matrix3::identity() * self.mass));
        mass.fixed_view_mut::<3, 3>(0, 3).copy_from(&-moment);
        mass.fixed_view_mut::<3, 3>(3, 0).copy_from(&moment);
        mass.fixed_view_mut::<3, 3>(3, 3).copy_from(&self.inertia);
        mass
    }

    /// The rigid motions that the support leaves: velocity of the origin and angular velocity of each.
    fn rigid_velocities(&self) -> Vec<SVector<f64, 6>> {
        let others = self.motion.others().iter().map(|other| join(&other.velocity, &other.rotation));
        let translations = self.translation_basis.column_iter().map(|t| join(&t.into(), &Vector3::zeros()));
        let rotations = self.rotation_basis.column_iter().map(|b| join(&Vector3::zeros(), &b.into()));
        others.chain(translations).chain(rotations).filter(|motion| motion.norm() > 0.0).collect()
    }
}

fn join(velocity: &Vector3<f64>, rotation: &Vector3<f64>) -> SVector<f64, 6> {
    SVector::from_iterator(velocity.iter().chain(rotation.iter()).copied())
}
