//! The stress that the modes leave out: of the static response to what acts on the body, less what the modes and static
//! shapes of the motion have of it. Eq. (S4) of `docs/method/stress.md`:
//!
//! ```text
//! u_j = K⁻¹ f_j (inertia relief)        r_j = u_j − Σ_k φ_k (φ_kᵀ K u_j)/λ_k        σ_left = Σ_j a_j σ(r_j)
//! ```
//!
//! The forces f_j are the loads, in every direction that they may come to have in the body, the centrifugal force of the spin,
//! the Euler force of its change and the inertia of a slide that is driven. The inertia of the modes' own motion and the Coriolis force are not among them.

use dynamics::{DrivenMotion, History, Observation};
use faer::Mat;
use modal::Modes;
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::error::BuildError;
use crate::reduction::mesh_model::MeshModel;
use crate::stress::site::SiteStress;
use crate::structure::StaticForces;
use crate::structure::statics::{Asked, Statics};

/// The stress that the modes leave out of each static response, and how much of each there is at a time.
#[derive(Debug)]
pub(crate) struct LeftOut {
    pub stress: SiteStress,
    /// Parts of the first columns of `stress`; those of the spin and of its change follow.
    loads: Vec<LoadPart>,
    /// The spin of a bent reference, whose stress is known to the end.
    carried: Vector3<f64>,
    /// The slide that is driven, to whose inertia the last column belongs.
    slide: Option<DrivenMotion>,
}

/// A load, or one of its directions in the body.
#[derive(Debug)]
struct LoadPart {
    history: History,
    /// Size of the amplitude.
    size: f64,
    /// The load of an amplitude of 1 or −1 in global axes, and what stands for it in the body; none of a load whose direction
    /// there stays.
    turning: Option<[Vector3<f64>; 2]>,
}

impl LeftOut {
    pub fn new(
        model: &MeshModel<'_, '_>,
        modes: &Modes,
        origin: &Vector3<f64>,
        has_gravity: bool,
    ) -> Result<Self, BuildError> {
        let structure = model.structure;
        let asked = Asked { loads: true, spin: true, drive: false };
        let statics = Statics::new(model, modes, origin, asked)?;
        let mut columns: Vec<Mat<f64>> = Vec::new();
        let mut loads = Vec::new();
        if let Some(of_loads) = &statics.of_loads {
            for (i, load) in model.loads.iter().enumerate() {
                if load.is_gravity() && !has_gravity || model.reference.is_some_and(|r| r.carries(model, load)) {
                    continue;
                }
                columns.push(of_loads.of_unit(i).to_owned());
                let part = |turning| LoadPart { history: load.history.clone(), size: load.size(), turning };
                let turned = of_loads.turned(i);
                match load.dead_unit().filter(|_| !turned.is_empty()) {
                    Some(unit) => loads.extend(turned.iter().map(|turned| part(Some([unit, *turned])))),
                    None => loads.push(part(None)),
                }
            }
        }
        columns.extend(statics.of_spin);
        let turns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| DrivenMotion::Turn { axis });
        let slide = model.drive.as_ref().map(|drive| drive.motion);
        let slide = slide.filter(|motion| matches!(motion, DrivenMotion::Slide { .. }));
        for motion in turns.into_iter().chain(slide) {
            let forces =
                StaticForces { of_loads: modes.shapes.get(.., ..0), spin: false, drive: Some(motion), origin: *origin };
            columns.push(structure.static_responses(modes, &forces)?.fields);
        }
        let mut stress = Mat::zeros(6 * structure.stress_sites()?.len(), columns.iter().map(Mat::ncols).sum());
        let mut first = 0;
        for responses in columns {
            let beside = structure.stress_beside(modes, responses.as_ref())?;
            stress.subcols_mut(first, beside.ncols()).copy_from(&beside);
            first += beside.ncols();
        }
        let carried = model.reference.map(|reference| reference.steady.omega_body).unwrap_or_default();
        Ok(Self { stress: SiteStress::new(&stress), loads, carried, slide })
    }

    /// How much there is of each now.
    pub fn amplitudes(&self, now: &Observation) -> Vec<f64> {
        let of_load = |part: &LoadPart| {
            let factor = part.history.at(now.time, now.time);
            let direction = part
                .turning
                .map_or(1.0, |[unit, turned]| turned.dot(&now.attitude.to_body(&unit)) / turned.norm_squared());
            part.size * factor * direction
        };
        let [spin, carried] = [&now.omega_body, &self.carried].map(|omega| ReducedBody::pair_weights([omega, omega]));
        let spin = spin.into_iter().zip(carried).map(|(now, carried)| now - carried);
        let euler = now.alpha_body.iter().map(|alpha| -alpha);
        let slide = self.slide.iter().map(|motion| -now.acceleration_of(motion));
        self.loads.iter().map(of_load).chain(spin).chain(euler).chain(slide).collect()
    }
}
