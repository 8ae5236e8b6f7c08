//! One place of a marker on a mesh: nodes that carry it together.

use dynamics::{PointShapes, RotationShapes, SecondOrder};
use faer::{ColMut, Mat};
use fem_tet10::{MeanRotation, Mesh, Patch};
use modal::Modes;
use nalgebra::{Matrix3, Vector3};
use reduced_body::ReducedBody;
use scene::Body;

use crate::error::{BuildError, modal};
use crate::load::rotation::Rotation;
use crate::tie::body_marker::{UnknownTurns, perpendicular};

/// A moment of inertia below this fraction of the largest is zero: the nodes are on a line.
const LINE: f64 = 1e-10;
/// Nodes are apart from this part of the size of the mesh on.
const ON: f64 = 1e-6;

/// A body with the modes that move its markers: with large ones, in the extended shapes.
pub(crate) struct ShapedBody<'a> {
    pub body: &'a ReducedBody,
    pub modes: &'a Modes,
    /// True with large modes.
    pub is_bent: bool,
}

/// Nodes that carry a place together.
pub(crate) struct Place {
    pub nodes: Vec<u32>,
    /// The part of each node in the mean; the sum is 1.
    pub weights: Vec<f64>,
    /// How the material there is turned, where the mesh tells.
    pub rotation: Option<Rotation>,
    pub unknown_turns: UnknownTurns,
    /// Mesh axes.
    pub position: Vector3<f64>,
    /// `Σ w (|d|² 1 − d dᵀ)` of its nodes.
    pub inertia: Matrix3<f64>,
}

impl Place {
    /// A patch.
    pub fn of_patch(patch: Patch, mesh: &Mesh) -> Self {
        let unknown_turns = match line(&patch, mesh) {
            _ if !patch.is_line => UnknownTurns::None,
            Some(line) => UnknownTurns::About(line),
            None => UnknownTurns::All,
        };
        let Patch { nodes, weights, rotation_per_displacement, .. } = patch;
        let mean = MeanRotation { nodes: nodes.clone(), rotation_per_displacement };
        let rotation = (unknown_turns != UnknownTurns::All).then_some(Rotation::Mean(mean));
        Self::new(nodes, weights, rotation, unknown_turns, mesh)
    }

    /// Nodes with weights, and how the material there is turned, where the mesh tells.
    pub fn of_point(nodes: Vec<u32>, weights: Vec<f64>, rotation: Option<Rotation>, mesh: &Mesh) -> Self {
        let unknown_turns = if rotation.is_some() { UnknownTurns::None } else { UnknownTurns::All };
        Self::new(nodes, weights, rotation, unknown_turns, mesh)
    }

    fn new(
        nodes: Vec<u32>,
        weights: Vec<f64>,
        rotation: Option<Rotation>,
        unknown_turns: UnknownTurns,
        mesh: &Mesh,
    ) -> Self {
        let at = |node: &u32| Vector3::from(mesh.positions()[*node as usize]);
        let position: Vector3<f64> = nodes.iter().zip(&weights).map(|(node, w)| at(node) * *w).sum();
        let of_node = |(node, w): (&u32, &f64)| {
            let d = at(node) - position;
            (Matrix3::from_diagonal_element(d.norm_squared()) - d * d.transpose()) * *w
        };
        let inertia = nodes.iter().zip(&weights).map(of_node).sum();
        Self { nodes, weights, rotation, unknown_turns, position, inertia }
    }

    /// The inverse of its inertia, without what its nodes do not tell.
    pub fn inverse_inertia(&self) -> Matrix3<f64> {
        self.inertia.pseudo_inverse(LINE * self.inertia.norm()).unwrap_or_default()
    }

    /// Unit forces and moments that it can bear: those about turns that are not known are left out.
    pub fn wrenches(&self) -> Vec<[Vector3<f64>; 2]> {
        let moments = match (&self.rotation, self.unknown_turns) {
            (None, _) | (_, UnknownTurns::All) => Vec::new(),
            (_, UnknownTurns::None) => [0, 1, 2].map(|axis| Vector3::ith(axis, 1.0)).to_vec(),
            (_, UnknownTurns::About(line)) => {
                let across = perpendicular(&line);
                vec![across, line.cross(&across)]
            }
        };
        let forces = [0, 1, 2].map(|axis| [Vector3::ith(axis, 1.0), Vector3::zeros()]);
        forces.into_iter().chain(moments.into_iter().map(|moment| [Vector3::zeros(), moment])).collect()
    }

    /// Adds the forces on nodes (N) of a force and a moment, times a factor.
    pub fn add_forces(
        &self,
        dofs: usize,
        [force, moment]: &[Vector3<f64>; 2],
        factor: f64,
        mut forces: ColMut<'_, f64>,
    ) {
        for (node, weight) in self.nodes.iter().zip(&self.weights) {
            for axis in 0..3 {
                forces[dofs * *node as usize + axis] += factor * force[axis] * weight;
            }
        }
        if let Some(rotation) = self.rotation.as_ref().filter(|_| *moment != Vector3::zeros()) {
            rotation.add_unit_nodal_forces(dofs, &(moment * factor), forces);
        }
    }

    /// How the modes move and turn it, however far with large ones. `stiffness` is that by the stress of each of the
    /// [`Self::wrenches`]; none where it is left out. `arm` goes from it to the place that is meant, which moves with it as a rigid
    /// body, mesh axes.
    pub fn shapes(
        &self,
        given: &Body,
        mesh: &Mesh,
        dofs: usize,
        &ShapedBody { body, modes, is_bent }: &ShapedBody<'_>,
        stiffness: Vec<Mat<f64>>,
        arm: &Vector3<f64>,
    ) -> Result<(PointShapes, RotationShapes), BuildError> {
        let mut point = modes.point(mesh.positions(), &self.nodes, &self.weights).map_err(modal(given))?;
        if let Some(rotation) = self.rotation.as_ref().filter(|_| *arm != Vector3::zeros()) {
            point.position_body += arm;
            for (mut shape, turned) in point.shapes.col_iter_mut().zip(rotation.by_mode(dofs, body, modes)) {
                let moved = turned.cross(arm);
                (0..3).for_each(|axis| shape[axis] += moved[axis]);
            }
        }
        let mut point = PointShapes::new(body, &point);
        let mut turning = match &self.rotation {
            Some(rotation) if is_bent => {
                let patch = rotation.patch_turn(mesh, dofs, modes, Some((&self.nodes, &self.weights)));
                rotation.shapes(dofs, body, modes).with_patch(patch)
            }
            Some(rotation) => rotation.shapes(dofs, body, modes),
            None => RotationShapes::new(body, Mat::zeros(3, body.flexible()).as_ref()),
        };
        let (mut by_forces, mut by_moments) = (Vec::new(), Vec::new());
        for ([force, moment], stiffness) in self.wrenches().into_iter().zip(stiffness) {
            match force.norm() > 0.0 {
                true => by_forces.push((force, stiffness)),
                false => by_moments.push((moment, stiffness)),
            }
        }
        if !by_forces.is_empty() {
            point = point.with_second_order(SecondOrder::new(by_forces)?);
        }
        if !by_moments.is_empty() {
            turning = turning.with_second_order(SecondOrder::new(by_moments)?);
        }
        Ok((point, turning))
    }
}

/// The direction of the line that the nodes of a patch are on; `None` of one point.
fn line(patch: &Patch, mesh: &Mesh) -> Option<Vector3<f64>> {
    let arm = |node: &u32| Vector3::from(mesh.positions()[*node as usize]) - patch.position;
    let farthest = patch.nodes.iter().map(arm).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    farthest.try_normalize(ON * mesh.diagonal())
}
