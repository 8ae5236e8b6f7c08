//! How the points of the output are turned by the modes, for moments on them.

use dynamics::{Manifold, RotationShapes};
use faer::Mat;
use nalgebra::Vector3;
use scene::Body;

use crate::error::BuildError;
use crate::load::rotation::Rotation;
use crate::model::{Meshed, Model};

impl Model {
    /// True if the nodes tell how the material at a point is turned: not of matrices whose nodes only have translations.
    pub fn has_point_rotations(&self) -> bool {
        self.meshed.as_ref().is_none_or(|meshed| meshed.mesh.has_elements() || dofs_of(meshed) == 6)
    }

    /// How the material at each point of the output is turned by the modes, in the order of [`Self::points`]: the mean
    /// rotation of the elements around the nearest node, as of a moment of the scene without a radius; of a body of matrices the
    /// rotation of its node.
    ///
    /// # Errors
    /// [`BuildError`] for a point that is not on the body, and without [`Self::has_point_rotations`].
    pub fn point_rotations(&self, given: &Body) -> Result<Vec<RotationShapes>, BuildError> {
        let body = self.physics.large_deflection.as_ref().map_or(&self.body, Manifold::body);
        let Some(meshed) = &self.meshed else {
            let rigid = || RotationShapes::new(body, Mat::zeros(3, 0).as_ref());
            return Ok(self.points.iter().map(|_| rigid()).collect());
        };
        let dofs = dofs_of(meshed);
        let natural = meshed.modes.shapes.ncols();
        let shape = |row: usize, k: usize| match k.checked_sub(natural) {
            None => meshed.modes.shapes[(row, k)],
            Some(following) => meshed.following[(row, following)],
        };
        let turning = |(name, at): (&String, &[f64; 3])| {
            let rotation = Rotation::at(given, &meshed.mesh, dofs, &format!("output.points.{name}"), *at)?;
            let moved = |first: usize, k: usize| Vector3::from_fn(|axis, _| shape(first + axis, k));
            let of_shape = |k: usize| -> Vector3<f64> {
                match &rotation {
                    Rotation::OfNode(node) => moved(dofs * *node as usize + 3, k),
                    Rotation::Mean(patch) => {
                        let of = patch.nodes.iter().zip(&patch.rotation_per_displacement);
                        of.map(|(node, r)| r * moved(dofs * *node as usize, k)).sum()
                    }
                }
            };
            let turned: Vec<Vector3<f64>> = (0..body.flexible()).map(of_shape).collect();
            Ok(RotationShapes::new(body, Mat::from_fn(3, turned.len(), |axis, k| turned[k][axis]).as_ref()))
        };
        given.output.points.iter().map(turning).collect()
    }
}

/// Degrees of freedom of a node.
fn dofs_of(meshed: &Meshed) -> usize {
    meshed.modes.shapes.nrows() / meshed.mesh.positions().len().max(1)
}
