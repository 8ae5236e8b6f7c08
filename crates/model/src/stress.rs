//! Stress of loads and of a drive, and the stiffness by it.

pub(crate) mod about;
pub(crate) mod left_out;
mod mesh_error;
pub(crate) mod products;
pub(crate) mod shapes;
pub(crate) mod site;

use advice::{Row, StressField, StressSource, stress, stress_row};
use dynamics::Effect;
use faer::{Mat, MatRef, Scale};
use modal::Modes;
use scene::Choice;

use crate::error::BuildError;
use crate::load::directed::Directed;
use crate::reduction::mesh_model::MeshModel;
use crate::reduction::modal_model::ModalModel;
use crate::reduction::physics;
use crate::structure::statics::Statics;

/// Stiffness in the modes (nf × nf) by the stress of what acts on a body, where it matters.
#[derive(Default)]
pub(crate) struct Stress {
    /// Stiffness of each load, in the direction of each of its static responses; empty where it is left out.
    pub of_loads: Vec<Vec<Directed>>,
    /// Stiffness of a unit acceleration of the drive.
    pub of_drive: Option<Mat<f64>>,
    /// The advice on the one that matters most.
    pub row: Option<Row>,
}

impl Stress {
    /// By the static responses `stressing` to the loads and to the drive, which do not move with the modes `bent`:
    /// between two of these there is no stiffness, since the manifold has it.
    pub fn new(
        model: &MeshModel<'_, '_>,
        stressing: &Statics,
        modes: &Modes,
        body: &ModalModel,
        bent: &[usize],
    ) -> Result<Self, BuildError> {
        if !physics::may_stress(model.scene) || modes.shapes.ncols() == 0 {
            return Ok(Self::default());
        }
        let mut found = Self::default();
        let (mut names, mut shown) = (Vec::new(), Vec::new());
        let stiffness = |responses: MatRef<'_, f64>| -> Result<Vec<Mat<f64>>, BuildError> {
            let found = model.structure.stress_stiffness(responses, modes, &[])?;
            Ok(found.into_iter().map(|k| beside(k, bent)).collect())
        };
        if let Some(of_loads) = &stressing.of_loads {
            for (i, load) in model.loads.iter().enumerate() {
                let (response, size) = (of_loads.of_unit(i), load.size());
                // Gravity stresses no body that falls.
                if response.norm_max() == 0.0 {
                    found.of_loads.push(Vec::new());
                    continue;
                }
                let of_unit = stiffness(response)?;
                let mut directed = Vec::new();
                for (unit, of_unit) in of_loads.vectors(i, load).into_iter().zip(of_unit) {
                    let (vector, stiffness) = (unit * size, of_unit * Scale(size));
                    names.push((StressSource::Load(i), load.name_along(&vector)));
                    // A pressure that follows its surface has a stiffness of its own.
                    shown.push(match load.follower_change(model.scene, model.mesh, &body.body, modes)? {
                        Some(change) => &stiffness - change.load_stiffness,
                        None => stiffness.clone(),
                    });
                    directed.push(Directed { vector, stiffness });
                }
                found.of_loads.push(directed);
            }
        }
        if let Some(response) = &stressing.of_drive {
            names.push((StressSource::Drive, "the acceleration of the drive".to_owned()));
            found.of_drive = stiffness(response.as_ref())?.pop();
            shown.extend(found.of_drive.clone());
        }
        found.decided(model, body, &names, &shown)
    }

    /// Without what the scene leaves open and does not call for.
    fn decided(
        mut self,
        model: &MeshModel<'_, '_>,
        body: &ModalModel,
        names: &[(StressSource, String)],
        stiffness: &[Mat<f64>],
    ) -> Result<Self, BuildError> {
        let effects = &model.scene.effects;
        let fields: Vec<StressField<'_>> = names
            .iter()
            .zip(stiffness)
            .map(|((source, name), stiffness)| StressField { name, source: *source, stiffness: stiffness.as_ref() })
            .collect();
        let influences = stress(&body.case(model), &fields, effects.tolerance)?;
        self.row = stress_row(&fields, &influences, effects.tolerance);
        let matters = |source: StressSource| {
            let of_source = names.iter().zip(&influences).filter(|((s, _), _)| *s == source);
            effects.choices[Effect::GeometricStiffening] == Choice::On
                || of_source.into_iter().any(|(_, found)| found.influence >= effects.tolerance)
        };
        let kept: Vec<bool> = (0..self.of_loads.len()).map(|i| matters(StressSource::Load(i))).collect();
        let drive_is_kept = matters(StressSource::Drive);
        for (directed, _) in self.of_loads.iter_mut().zip(kept).filter(|(_, kept)| !kept) {
            directed.clear();
        }
        self.of_drive = self.of_drive.filter(|_| drive_is_kept);
        Ok(self)
    }

    /// True if there is any.
    pub fn any(&self) -> bool {
        self.of_drive.is_some() || self.of_loads.iter().any(|directed| !directed.is_empty())
    }
}

/// A stiffness without what it has between two of the modes `bent`.
pub(crate) fn beside(mut stiffness: Mat<f64>, bent: &[usize]) -> Mat<f64> {
    for (a, b) in bent.iter().flat_map(|a| bent.iter().map(move |b| (*a, *b))) {
        stiffness[(a, b)] = 0.0;
    }
    stiffness
}

/// A stiffness on the first of all shapes.
pub(crate) fn in_shapes(stiffness: &Mat<f64>, shapes: usize) -> Mat<f64> {
    let count = stiffness.ncols();
    Mat::from_fn(shapes, shapes, |a, b| if a < count && b < count { stiffness[(a, b)] } else { 0.0 })
}
