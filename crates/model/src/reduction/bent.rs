//! The modes by which a body bends far.

use modal::Modes;

use crate::error::BuildError;
use crate::reduction::mesh_model::MeshModel;
use crate::structure::statics::Statics;

/// The modes that bend the body far, numbered from 0, and those that follow them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Bent {
    pub large: Vec<usize>,
    pub following: Vec<usize>,
}

impl Bent {
    /// All of them: the large ones first.
    pub fn all(&self) -> Vec<usize> {
        [&self.large[..], &self.following].concat()
    }

    /// With the static shape of the moment that acts most, where there are static shapes and no list of large modes is given: it
    /// turns its place by an angle that modes hold slowly, and the angle is what the moment works on.
    pub fn with_moment(
        mut self,
        model: &MeshModel<'_, '_>,
        statics: &Statics,
        modes: &Modes,
    ) -> Result<Self, BuildError> {
        let natural = modes.natural();
        let Some(of_loads) = statics.of_loads.as_ref().filter(|_| natural < modes.shapes.ncols()) else {
            return Ok(self);
        };
        if self.large.is_empty() || model.scene.modes.large.is_some() {
            return Ok(self);
        }
        let mut most: Option<(f64, usize)> = None;
        for (i, load) in model.loads.iter().enumerate().filter(|(_, load)| load.is_moment() && load.size() > 0.0) {
            let parts = model.structure.parts(modes, of_loads.at_start(i, load).as_ref())?;
            let furthest = (natural..modes.shapes.ncols()).map(|k| (load.size() * parts[(k, 0)].abs(), k));
            most = furthest.chain(most).max_by(|a, b| a.0.total_cmp(&b.0));
        }
        // Static shapes come after the modes.
        self.large.extend(most.filter(|(part, _)| *part > 0.0).map(|(_, k)| k));
        Ok(self)
    }
}
