//! How the points of the output are turned by the modes, for moments on them.

use dynamics::{Manifold, RotationShapes};
use faer::Mat;
use nalgebra::Vector3;
use scene::Scene;

use crate::error::{BuildError, refuse};
use crate::model::Model;

impl Model {
    /// How the material at each point of the output is turned by the modes, in the order of [`Self::points`]: the mean
    /// rotation of the elements around the nearest node, as of a moment of the scene without a radius.
    ///
    /// # Errors
    /// [`BuildError`] for a point that is not on the body.
    pub fn point_rotations(&self, scene: &Scene) -> Result<Vec<RotationShapes>, BuildError> {
        let body = self.physics.large_deflection.as_ref().map_or(&self.body, Manifold::body);
        let Some(meshed) = &self.meshed else {
            let rigid = || RotationShapes::new(body, Mat::zeros(3, 0).as_ref());
            return Ok(self.points.iter().map(|_| rigid()).collect());
        };
        let natural = meshed.modes.shapes.ncols();
        let shape = |row: usize, k: usize| match k.checked_sub(natural) {
            None => meshed.modes.shapes[(row, k)],
            Some(following) => meshed.following[(row, following)],
        };
        let turning = |(name, at): (&String, &[f64; 3])| {
            let patch = meshed.mesh.mean_rotation(*at, None);
            let patch = patch.map_err(|error| refuse(scene, &format!("output.points.{name}"), error))?;
            let of_shape = |k: usize| -> Vector3<f64> {
                let moved = |node: u32| Vector3::from_fn(|axis, _| shape(3 * node as usize + axis, k));
                patch.nodes.iter().zip(&patch.rotation_per_displacement).map(|(node, r)| r * moved(*node)).sum()
            };
            let turned: Vec<Vector3<f64>> = (0..body.flexible()).map(of_shape).collect();
            Ok(RotationShapes::new(body, Mat::from_fn(3, turned.len(), |axis, k| turned[k][axis]).as_ref()))
        };
        scene.output.points.iter().map(turning).collect()
    }
}
