//! Nodal forces of what is spread over physical surfaces.
//!
//! ```text
//! w_i = ∫ N_i dA        f_i = −∫ N_i n dA        n dA = ∂x/∂s × ∂x/∂t ds dt
//! ∂f_i/∂u = −∫ N_i (∂u/∂s × ∂x/∂t + ∂x/∂s × ∂u/∂t) ds dt
//! ```

use std::collections::BTreeMap;
use std::ops::{AddAssign, Mul};

use faer::ColRef;
use nalgebra::Vector3;

use crate::element::quadrature;
use crate::error::{MeshError, MeshFault};
use crate::mesh::checked::Mesh;
use crate::mesh::faces::{Face, Surface};

/// Corner pairs of the mid-edge nodes of a face.
const EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

impl Mesh {
    /// Names of the surface physical groups.
    pub fn surface_groups(&self) -> impl Iterator<Item = &str> {
        self.surfaces().iter().map(|surface| surface.name.as_str())
    }

    /// `∫ N_i dA` over a physical surface, an area for each of its nodes: nodes, ascending, and weights.
    ///
    /// A traction (force per area) puts the force weight × traction on a node. The weights sum to the area; those of
    /// the corners of flat faces are zero but for rounding. A face between two tetrahedra counts once.
    ///
    /// # Errors
    /// [`MeshFault::NoGroup`] with the names of the surfaces there are.
    pub fn surface_weights(&self, group: &str) -> Result<(Vec<u32>, Vec<f64>), MeshError> {
        Ok(self.areas(self.surface(group)?))
    }

    fn areas(&self, surface: &Surface) -> (Vec<u32>, Vec<f64>) {
        self.integrate(surface, |x, slopes| tangent(x, slopes, 0).cross(&tangent(x, slopes, 1)).norm())
    }

    /// `∫ N_i dA` over some faces of the body, as [`surface_weights`](Self::surface_weights).
    pub(crate) fn weights_of_faces(&self, faces: impl Iterator<Item = [u32; 6]>) -> (Vec<u32>, Vec<f64>) {
        let faces = faces.map(|nodes| Face { tag: 0, nodes, inner: false }).collect();
        self.areas(&Surface { name: String::new(), faces })
    }

    /// `−∫ N_i n dA` over a physical surface, the forces of a unit pressure: nodes, ascending, and forces (area, global
    /// axes, on the undeformed body). n points out of the body, whichever way round the file has the triangles.
    ///
    /// Exact on curved faces too, so that resultant and moment of a pressure all round a body vanish.
    ///
    /// # Errors
    /// [`MeshFault::NoGroup`] with the names of the surfaces there are; [`MeshFault::InnerFace`] for a face that has
    /// the body on both sides.
    pub fn surface_pressure(&self, group: &str) -> Result<(Vec<u32>, Vec<Vector3<f64>>), MeshError> {
        let surface = self.outer_surface(group)?;
        Ok(self.integrate(surface, |x, slopes| -tangent(x, slopes, 0).cross(&tangent(x, slopes, 1))))
    }

    /// Forces that the displacements `displacement` (3n, length, row `3·node + axis`) add to those of
    /// [`surface_pressure`](Self::surface_pressure), to first order, because the pressure turns and grows with the surface:
    /// nodes, ascending, and forces (area). It is linear in the displacements.
    ///
    /// Exact on curved faces too: the forces that a pressure all round a body adds have neither a resultant nor, with the forces that
    /// the displacements move, a moment.
    ///
    /// # Errors
    /// As [`surface_pressure`](Self::surface_pressure).
    ///
    /// # Panics
    /// Where `displacement` has fewer than 3n rows.
    pub fn surface_pressure_change(
        &self,
        group: &str,
        displacement: ColRef<'_, f64>,
    ) -> Result<(Vec<u32>, Vec<Vector3<f64>>), MeshError> {
        let surface = self.outer_surface(group)?;
        Ok(self.integrate_with(surface, of_nodes(displacement), |x, u, slopes| {
            let (xs, xt) = (tangent(x, slopes, 0), tangent(x, slopes, 1));
            -(tangent(u, slopes, 0).cross(&xt) + xs.cross(&tangent(u, slopes, 1)))
        }))
    }

    /// The forces of [`surface_pressure`](Self::surface_pressure) on the surface displaced by `displacement` (3n, length, row
    /// `3·node + axis`): those of the undeformed one, [what they change to first order](Self::surface_pressure_change), and
    /// the rest, of second order.
    ///
    /// # Errors
    /// As [`surface_pressure`](Self::surface_pressure).
    ///
    /// # Panics
    /// Where `displacement` has fewer than 3n rows.
    pub fn surface_pressure_on(
        &self,
        group: &str,
        displacement: ColRef<'_, f64>,
    ) -> Result<(Vec<u32>, Vec<Vector3<f64>>), MeshError> {
        let surface = self.outer_surface(group)?;
        Ok(self.integrate_with(surface, of_nodes(displacement), |x, u, slopes| {
            let along = |direction: usize| tangent(x, slopes, direction) + tangent(u, slopes, direction);
            -along(0).cross(&along(1))
        }))
    }

    /// A surface with the body on one side only.
    fn outer_surface(&self, group: &str) -> Result<&Surface, MeshError> {
        let surface = self.surface(group)?;
        match surface.faces.iter().find(|face| face.inner) {
            None => Ok(surface),
            Some(face) => Err(MeshFault::InnerFace { group: group.to_owned(), element: face.tag }.of(self.source())),
        }
    }

    pub(crate) fn surface(&self, name: &str) -> Result<&Surface, MeshError> {
        self.surfaces().iter().find(|surface| surface.name == name).ok_or_else(|| {
            MeshFault::NoGroup {
                kind: "surface",
                group: name.to_owned(),
                present: self.surface_groups().map(str::to_owned).collect(),
            }
            .of(self.source())
        })
    }

    /// `∫ N_i value ds dt` for each node, where `value` is made of the positions of a face's nodes and the slopes of their
    /// shape functions.
    fn integrate<T: Summand>(
        &self,
        surface: &Surface,
        value: impl Fn(&[Vector3<f64>; 6], &Slopes) -> T,
    ) -> (Vec<u32>, Vec<T>) {
        self.integrate_with(surface, |_| (), |x, (), slopes| value(x, slopes))
    }

    /// As [`integrate`](Self::integrate), with something else that is known of each face.
    fn integrate_with<T: Summand, K>(
        &self,
        surface: &Surface,
        known: impl Fn(&Face) -> K,
        value: impl Fn(&[Vector3<f64>; 6], &K, &Slopes) -> T,
    ) -> (Vec<u32>, Vec<T>) {
        // n dA is of degree 2 and N of degree 2; what is above that is for |n dA| on curved faces.
        let rule: Vec<_> = quadrature::triangle_degree_6().into_iter().map(|(l, w)| (shapes(l), w)).collect();
        let mut sums: BTreeMap<u32, T> = BTreeMap::new();
        for face in &surface.faces {
            // Against the first node, so that rounding is that of the face and not of its distance from the origin.
            let position = face.nodes.map(|node| Vector3::from(self.positions()[node as usize]));
            let relative = position.map(|x| x - position[0]);
            let known = known(face);
            for ((n, slopes), weight) in &rule {
                let value = value(&relative, &known, slopes) * *weight;
                for (node, n) in face.nodes.iter().zip(n) {
                    *sums.entry(*node).or_default() += value * *n;
                }
            }
        }
        sums.into_iter().unzip()
    }
}

/// A quantity that can be integrated.
trait Summand: Default + AddAssign + Mul<f64, Output = Self> + Copy {}

impl<T: Default + AddAssign + Mul<f64, Output = T> + Copy> Summand for T {}

/// Slopes of the six shape functions along L₁ and L₂.
pub(crate) type Slopes = [[f64; 2]; 6];

/// The displacements (row `3·node + axis`) of the nodes of a face.
fn of_nodes(displacement: ColRef<'_, f64>) -> impl Fn(&Face) -> [Vector3<f64>; 6] + '_ {
    move |face| face.nodes.map(|node| Vector3::from_fn(|axis, _| displacement[3 * node as usize + axis]))
}

/// ∂x/∂s or ∂x/∂t of a field with these values at the nodes of a face.
pub(crate) fn tangent(values: &[Vector3<f64>; 6], slopes: &Slopes, direction: usize) -> Vector3<f64> {
    values.iter().zip(slopes).map(|(x, d)| x * d[direction]).sum()
}

/// Shape functions of the six-node triangle at barycentric coordinates, and their slopes along L₁ and L₂.
pub(crate) fn shapes(l: [f64; 3]) -> ([f64; 6], Slopes) {
    const SLOPES: [[f64; 2]; 3] = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    let (mut n, mut dn) = ([0.0; 6], [[0.0; 2]; 6]);
    for a in 0..3 {
        n[a] = l[a] * (2.0 * l[a] - 1.0);
        dn[a] = SLOPES[a].map(|d| (4.0 * l[a] - 1.0) * d);
    }
    for (edge, [a, b]) in EDGES.into_iter().enumerate() {
        n[3 + edge] = 4.0 * l[a] * l[b];
        dn[3 + edge] = [0, 1].map(|k| 4.0 * (l[a] * SLOPES[b][k] + l[b] * SLOPES[a][k]));
    }
    (n, dn)
}
