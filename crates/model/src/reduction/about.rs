//! Parts of a motion about a bent reference that follow from what it carries already.

use faer::Mat;
use modal::Modes;
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use scene::About;

use crate::load::directed::Directed;
use crate::load::mesh_load::MeshLoad;
use crate::reduction::mesh_model::MeshModel;
use crate::reduction::modal_model::ModalModel;
use crate::reduction::physics;
use crate::reduction::reference::Reference;
use crate::reduction::reference::found::{fits, steady};

/// Linear answer of a mode over the length from which modes about the bent body are proposed.
const CALLS_FOR: f64 = 0.1;

impl Reference {
    /// True if the reference is under this load.
    pub fn carries(&self, model: &MeshModel<'_, '_>, load: &MeshLoad) -> bool {
        let MeshModel { scene, support, drive, .. } = model;
        self.steady.loads && load.size() > 0.0 && physics::is_steady(scene, support.motion, drive.as_ref(), load)
    }

    /// The stiffness by the stress of the spin and the loads that the reference has already (nf×nf), of those that the motion adds.
    pub fn stress_stiffness(
        &self,
        model: &MeshModel<'_, '_>,
        of_spin: Option<&[Mat<f64>; 6]>,
        of_loads: &[Vec<Directed>],
        nf: usize,
    ) -> Mat<f64> {
        let mut sum = Mat::zeros(nf, nf);
        let mut add = |stiffness: &Mat<f64>, factor: f64| {
            for (i, j) in (0..nf).flat_map(|j| (0..nf).map(move |i| (i, j))) {
                sum[(i, j)] += factor * stiffness[(i, j)];
            }
        };
        let omega = &self.steady.omega_body;
        for (stiffness, weight) in of_spin.into_iter().flatten().zip(ReducedBody::pair_weights([omega, omega])) {
            add(stiffness, weight);
        }
        for (load, directed) in model.loads.iter().zip(of_loads) {
            if self.carries(model, load) {
                let vectors: Vec<Vector3<f64>> =
                    directed.iter().map(|directed| directed.vector / load.size()).collect();
                let parts = if directed.len() > 1 { load.parts(&vectors) } else { vec![1.0] };
                directed.iter().zip(parts).for_each(|(directed, part)| add(&directed.stiffness, part));
            }
        }
        sum
    }
}

/// A sentence that proposes modes about a bent rest, where a steady spin or steady loads bend the body far and the scene takes its modes
/// about the undeformed body.
pub(crate) fn proposed(model: &MeshModel<'_, '_>, modes: &Modes, on: &ModalModel) -> Option<String> {
    if model.scene.modes.about.is_some() || !model.scene.source.bends_far() || fits(model.scene, model.support).is_err()
    {
        return None;
    }
    let steady = steady(model.scene, model.support, model.drive.as_ref(), About::Auto).ok()??;
    let (omega, count) = (&steady.omega_body, modes.natural());
    let mut forces = vec![0.0; modes.shapes.nrows()];
    for load in &model.loads {
        if physics::is_steady(model.scene, model.support.motion, model.drive.as_ref(), load) {
            load.add_nodal_forces(&mut forces);
        }
    }
    let weights = ReducedBody::pair_weights([omega, omega]);
    let answer = |k: usize| {
        let of_spin: f64 = weights.iter().zip(&on.body.inertia_first).map(|(weight, c)| weight * c[k]).sum();
        let of_loads: f64 = modes.shapes.col(k).iter().zip(&forces).map(|(shape, force)| shape * force).sum();
        (of_spin + of_loads) / modes.eigenvalues[k] * on.size.peaks[k]
    };
    let part = (0..count).map(|k| answer(k).abs()).fold(0.0, f64::max) / on.size.length;
    (part >= CALLS_FOR).then(|| {
        let from = if *omega == Vector3::zeros() { "The steady loads bend" } else { "The steady spin and loads bend" };
        format!(
            "{from} the body by {:.0} % of its length, by the linear answer of one mode: modes about that rest (`about = \"auto\"` in \
             [modes]) have what this does exactly.",
            100.0 * part
        )
    })
}
