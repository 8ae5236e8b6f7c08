//! Stress at the nodes: the mean, weighted with the volumes, of the stresses that the elements of one material around a node
//! have there.
//!
//! The stress of a straight tet10 is linear, so that its own value at a node is what its four integration points
//! extrapolate to. It converges with the square of the element length, at the surface too. Superconvergent patch recovery
//! (a full quadratic by least squares around each corner) was measured beside it: closer in the inside of a body
//! (spinning disc: 0.1 % against 0.4 % in the mean), but it extrapolates at the surface, where stress is largest (at the
//! edge of a hole 12 % off against 1.9 %), so that it is not used.
//!
//! Components are in the order xx, yy, zz, xy, yz, zx, in the axes of the mesh: see [`COMPONENTS`].

mod error_estimate;
mod invariants;
mod sites;

use faer::{Mat, MatRef};
use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::assembly::coupling::Incidence;
use crate::element::deformation::{
    check_field, displacement_gradients, relative_displacements, second_strain, strain, stress,
};
use crate::element::integration::{IntegrationPoint, Rules};
use crate::element::shape::{NODES, shape_gradients};
use crate::error::AssemblyError;
use crate::material::{Material, Materials};
use crate::mesh::checked::Mesh;

pub use error_estimate::StressError;
pub use invariants::{principal_stresses, von_mises};
pub use sites::StressSites;

/// The axes of the six components of a stress, in their order.
pub const COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// Displacement fields, or pairs of them, that are recovered at once.
const BLOCK: usize = 8;

/// Recovery of nodal stress from displacements on a mesh.
#[derive(Debug)]
pub struct StressRecovery<'a> {
    mesh: &'a Mesh,
    /// The material of each element.
    materials: Vec<Material>,
    sites: StressSites,
    /// The sites that have rows in the stresses.
    recovered: Vec<u32>,
    incidence: Incidence,
    rules: Rules,
}

impl<'a> StressRecovery<'a> {
    /// The recovery for a body.
    ///
    /// # Errors
    /// Materials that do not fit the mesh.
    pub fn new(mesh: &'a Mesh, materials: &Materials) -> Result<Self, AssemblyError> {
        let materials = materials.of_elements(mesh)?;
        let incidence = Incidence::new(mesh);
        let sites = StressSites::new(mesh, &materials, &incidence);
        let recovered = (0..sites.len() as u32).collect();
        Ok(Self { mesh, materials, sites, recovered, incidence, rules: Rules::new() })
    }

    /// The same recovery at the sites of some nodes alone, in the order of the nodes: its stresses have rows for these, with
    /// the same numbers.
    ///
    /// # Panics
    /// Where there is no such node.
    #[must_use]
    pub fn at_nodes(mut self, nodes: &[u32]) -> Self {
        self.recovered = nodes.iter().flat_map(|node| self.sites.of_node(*node)).map(|site| site as u32).collect();
        self
    }

    /// The node of each site that has rows in the stresses.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.recovered.iter().map(|site| self.sites.nodes()[*site as usize])
    }

    /// Where the stresses are: each node, once for each material around it.
    pub fn sites(&self) -> &StressSites {
        &self.sites
    }

    /// The stress (6m×k, force per area, row `6·site + component`) at the m sites for each of the displacement fields
    /// (N×k, length, row `3·node + axis`): linear in them, Eq. (S1) of `docs/method/stress.md`.
    ///
    /// Exact for stresses that are linear in space, on straight elements.
    ///
    /// # Errors
    /// Fields whose rows are not the degrees of freedom, or with an entry that is not finite; not enough memory.
    pub fn nodal_stress(&self, displacements: MatRef<'_, f64>) -> Result<Mat<f64>, AssemblyError> {
        check_field(self.mesh, "displacements", displacements)?;
        self.in_blocks(displacements.ncols(), |first, count| {
            self.recover(displacements.subcols(first, count), count, |gradients, material, out| {
                out.extend(gradients.iter().map(|gradient| stress(material, &strain(gradient))));
            })
        })
    }

    /// The stress C:½ε₂(a,b), ε₂(a,b) = sym(∇aᵀ∇b), of each pair (a, b) of columns of `fields`, as
    /// [`nodal_stress`](Self::nodal_stress). With it, the second Piola–Kirchhoff stress of a St. Venant–Kirchhoff body that
    /// is displaced by u is that of u plus that of the pair (u, u).
    ///
    /// # Errors
    /// As [`nodal_stress`](Self::nodal_stress).
    ///
    /// # Panics
    /// Where a pair names a column that `fields` does not have.
    pub fn second_order_nodal_stress(
        &self,
        fields: MatRef<'_, f64>,
        pairs: &[[usize; 2]],
    ) -> Result<Mat<f64>, AssemblyError> {
        check_field(self.mesh, "fields", fields)?;
        self.in_blocks(pairs.len(), |first, count| {
            self.recover(fields, count, |gradients, material, out| {
                let of_pair =
                    |[a, b]: &[usize; 2]| stress(material, &(0.5 * second_strain(&gradients[*a], &gradients[*b])));
                out.extend(pairs[first..first + count].iter().map(of_pair));
            })
        })
    }

    fn in_blocks(
        &self,
        columns: usize,
        block: impl Fn(usize, usize) -> Result<Vec<f64>, AssemblyError>,
    ) -> Result<Mat<f64>, AssemblyError> {
        let rows = 6 * self.recovered.len();
        memory::check("the stress at the nodes", (8 * rows).saturating_mul(columns + BLOCK))?;
        let mut nodal = Mat::zeros(rows, columns);
        for first in (0..columns).step_by(BLOCK) {
            let count = BLOCK.min(columns - first);
            let found = block(first, count)?;
            for (site, stresses) in found.chunks_exact(6 * count).enumerate() {
                for (k, stress) in stresses.chunks_exact(6).enumerate() {
                    stress.iter().enumerate().for_each(|(c, value)| nodal[(6 * site + c, first + k)] = *value);
                }
            }
        }
        Ok(nodal)
    }

    /// The nodal means of `count` stresses, which `stresses` makes of the displacement gradients of all fields at a place;
    /// by site, then stress, then component.
    fn recover(
        &self,
        fields: MatRef<'_, f64>,
        count: usize,
        stresses: impl Fn(&[Matrix3<f64>], &Material, &mut Vec<Matrix3<f64>>) + Sync,
    ) -> Result<Vec<f64>, AssemblyError> {
        let at_nodes = NODES.map(shape_gradients);
        let mut nodal = memory::zeros("the stress at the nodes", 6 * count * self.recovered.len())?;
        nodal.par_chunks_mut(6 * count).zip(&self.recovered).for_each(|(mean, site)| {
            let (mut gradients, mut tensors) = (Vec::with_capacity(fields.ncols()), Vec::with_capacity(count));
            let mut volume = 0.0;
            for (e, place) in self.elements_at(*site as usize) {
                let relative = relative_displacements(fields, &self.mesh.elements()[e]);
                // A point of integration with the volume that the element would have if it were as there throughout.
                let point = IntegrationPoint::new(&self.mesh.element_positions(e), &at_nodes[place], 1.0);
                displacement_gradients(&relative, &point, fields.ncols(), &mut gradients);
                tensors.clear();
                stresses(&gradients, &self.materials[e], &mut tensors);
                for (tensor, mean) in tensors.iter().zip(mean.chunks_exact_mut(6)) {
                    mean.iter_mut().zip(COMPONENTS).for_each(|(sum, at)| *sum += point.volume * tensor[at]);
                }
                volume += point.volume;
            }
            mean.iter_mut().for_each(|sum| *sum /= volume);
        });
        Ok(nodal)
    }

    /// The elements around a site, with the node's number in them.
    fn elements_at(&self, site: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let node = self.sites.nodes()[site] as usize;
        let around = self.incidence.of(node).iter().map(|(e, a)| (*e as usize, *a as usize));
        around.filter(move |(e, a)| self.sites.of_element(*e)[*a] as usize == site)
    }
}
