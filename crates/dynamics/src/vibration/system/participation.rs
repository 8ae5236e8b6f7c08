//! The part of a system's mass that each vibration carries in a motion of the ground: Eq. (L14) of `docs/method/systems.md`.

use faer::Mat;
use nalgebra::Vector3;
use reduced_body::Participation;

use crate::matrix::lists::dot;
use crate::system::radau::SystemMotion;
use crate::vibration::system::configuration::{BodyConfiguration, CommonSpin};
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::graded::graded_modes;
use crate::vibration::system::steady::SteadyState;

/// The parts of a system's mass that move in a motion of the ground, by its vibrations without damping.
#[derive(Debug, Clone, PartialEq)]
pub struct SystemParticipation {
    /// Circular frequencies of the vibrations, rad per time.
    pub circular_frequencies: Vec<f64>,
    /// The mass that they carry. Lists of six are translations of the ground along the global axes, then its turns about them through a
    /// point; what moves with the ground is neither rigid nor a vibration.
    pub participation: Participation,
}

impl SteadyState {
    /// The participation of the vibrations in a motion of the ground, which turns about a point [default: the first place that it holds];
    /// none of a system that the ground does not hold. The state is to be at rest.
    ///
    /// # Errors
    /// [`SteadyError::Numbers`] where the eigenvalue problem has no answer.
    pub fn participation(
        &self,
        motion: &SystemMotion,
        about_global: Option<Vector3<f64>>,
    ) -> Result<Option<SystemParticipation>, SteadyError> {
        let mut markers = motion.system().connections.markers();
        let Some(ground) = markers.find(|marker| marker.body().is_none()) else { return Ok(None) };
        let about = about_global.unwrap_or_else(|| ground.position());
        let linear = &self.linear;
        let (rest, loose) = linear.without_rigid()?;
        let size = rest.ncols();
        let stiffness = rest.transpose() * (&linear.stiffness * &rest);
        let symmetric = Mat::from_fn(size, size, |i, j| 0.5 * (stiffness[(i, j)] + stiffness[(j, i)]));
        let modes = graded_modes(&symmetric)?;
        // What falls over, or only a damper resists, has no frequency: it goes with the motions that nothing resists.
        let rounding = linear.rounding_of_stiffness();
        let vibrates = |mode: &&(f64, Vec<f64>)| mode.0 > rounding;
        // Γ = (N y)ᵀ M r for each motion r of the ground.
        let mut whole = [0.0; 6];
        let mut rigid = [0.0; 6];
        let mut factors = vec![[0.0; 6]; modes.iter().filter(vibrates).count()];
        for (i, motion) in self.motions_of_ground(&about).iter().enumerate() {
            let momenta = self.momenta(motion);
            whole[i] = dot(&momenta, motion);
            let along = linear.project(&momenta);
            let parts = |basis: &Mat<f64>| -> Vec<f64> {
                let part =
                    |column: usize| along.iter().enumerate().map(|(row, along)| basis[(row, column)] * along).sum();
                (0..basis.ncols()).map(part).collect()
            };
            let (of_loose, of_rest) = (parts(&loose), parts(&rest));
            let stays = modes.iter().filter(|mode| !vibrates(mode)).map(|(_, shape)| dot(shape, &of_rest));
            rigid[i] = of_loose.into_iter().chain(stays).map(|part| part * part).sum();
            for ((_, shape), factors) in modes.iter().filter(vibrates).zip(&mut factors) {
                factors[i] = dot(shape, &of_rest);
            }
        }
        let circular_frequencies = modes.iter().filter(vibrates).map(|(square, _)| square.sqrt()).collect();
        let participation = Participation { about, whole, rigid, factors };
        Ok(Some(SystemParticipation { circular_frequencies, participation }))
    }

    /// Velocities of all coordinates where all bodies go along with the ground: three translations, three turns about a point.
    fn motions_of_ground(&self, about: &Vector3<f64>) -> [Vec<f64>; 6] {
        std::array::from_fn(|i| {
            let axis = Vector3::ith(i % 3, 1.0);
            let turn = CommonSpin { omega_global: axis, point_global: *about };
            let of_body = |body: &BodyConfiguration| {
                let [velocity, omega] = if i < 3 {
                    [axis, Vector3::zeros()]
                } else {
                    [turn.velocity_at(body, self.configuration.time), axis]
                };
                let [velocity, omega] = [velocity, omega].map(|vector| body.body_from_global * vector);
                velocity.iter().chain(&omega).copied().chain(body.q.iter().map(|_| 0.0)).collect::<Vec<f64>>()
            };
            self.configuration.bodies.iter().flat_map(of_body).collect()
        })
    }

    /// M v
    fn momenta(&self, velocities: &[f64]) -> Vec<f64> {
        let bodies = self.linear.masses.iter().zip(&self.linear.first);
        let of_body = |(mass, first): (&Mat<f64>, &usize)| {
            let own = &velocities[*first..first + mass.nrows()];
            let row = |i: usize| own.iter().enumerate().map(|(j, v)| mass[(i, j)] * v).sum::<f64>();
            (0..mass.nrows()).map(row).collect::<Vec<f64>>()
        };
        bodies.flat_map(of_body).collect()
    }
}
