//! The full body: its elements, its mass, its support.

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use faer::{Mat, MatRef};
use fem_tet10::{FiniteStrain, Materials, Matrices, Mesh};
use modal::{Constraints, IndefiniteOrder, MassMatrix, NodalMass, RigidModes, Support};
use nalgebra::{Matrix3, Vector3};

use crate::error::NonlinearError;
use crate::vectors::{column, list};

/// A St. Venant–Kirchhoff body with its support.
pub struct FullBody<'a> {
    strain: FiniteStrain,
    matrices: Cow<'a, Matrices>,
    pub(crate) held: Vec<bool>,
    /// The displacements of held rows that the support allows (3n × 0 to 6).
    pub(crate) motions: Mat<f64>,
    /// The rigid modes that the support leaves, M-orthonormal (3n × 0 to 6), and M times them.
    pub(crate) rigid: Mat<f64>,
    pub(crate) momenta: Mat<f64>,
    /// The point that positions are measured from, in the mesh's frame.
    origin: Vector3<f64>,
    order: OnceLock<IndefiniteOrder>,
}

impl<'a> FullBody<'a> {
    /// The body of a mesh, whose `matrices` have its mass and its point masses.
    ///
    /// # Errors
    /// Materials or a support that do not fit the mesh.
    pub fn new(
        mesh: Arc<Mesh>,
        materials: &Materials,
        matrices: Cow<'a, Matrices>,
        support: &Support,
    ) -> Result<Self, NonlinearError> {
        let constraints = Constraints::new(support, mesh.positions(), 3)?;
        let mass = NodalMass::of_nodes(matrices.start(), matrices.nodes(), matrices.mass_by_nodes())?;
        let mass = MassMatrix::Nodal(mass);
        let modes = RigidModes::new(&mass, mesh.positions(), support.motion)?;
        let moves = |column: &usize| modes.shapes.col(*column).iter().any(|u| *u != 0.0);
        let moving: Vec<usize> = (0..modes.shapes.ncols()).filter(moves).collect();
        let rigid = Mat::from_fn(modes.shapes.nrows(), moving.len(), |i, j| modes.shapes[(i, moving[j])]);
        let momenta = mass.product(rigid.as_ref());
        Ok(Self {
            held: (0..3 * mesh.positions().len()).map(|row| constraints.holds(row)).collect(),
            motions: constraints.motions(),
            strain: FiniteStrain::new(mesh, materials)?,
            origin: modes.origin,
            rigid,
            momenta,
            matrices,
            order: OnceLock::new(),
        })
    }

    /// Its elements.
    pub fn strain(&self) -> &FiniteStrain {
        &self.strain
    }

    /// Its mesh.
    pub fn mesh(&self) -> &Mesh {
        self.strain.mesh()
    }

    /// Mass and stiffness at rest.
    pub fn matrices(&self) -> &Matrices {
        &self.matrices
    }

    /// Number of degrees of freedom, those that are held among them.
    pub fn dofs(&self) -> usize {
        self.held.len()
    }

    /// True for each degree of freedom that is held.
    pub fn held(&self) -> &[bool] {
        &self.held
    }

    /// Number of rigid motions that the support leaves.
    pub fn rigid_motions(&self) -> usize {
        self.rigid.ncols()
    }

    /// The point that positions are measured from, in the mesh's frame.
    pub fn origin(&self) -> Vector3<f64> {
        self.origin
    }

    /// M v.
    pub fn momentum(&self, v: &[f64]) -> Vec<f64> {
        list(&self.momenta_of(column(v)), 0)
    }

    /// M V (3n×k).
    pub fn momenta_of(&self, v: MatRef<'_, f64>) -> Mat<f64> {
        match NodalMass::of_nodes(self.matrices.start(), self.matrices.nodes(), self.matrices.mass_by_nodes()) {
            Ok(mass) => mass.product(v),
            // They have been a mass when the body was made.
            Err(_) => Mat::zeros(v.nrows(), v.ncols()),
        }
    }

    /// M W (X + u): the centrifugal force of a spin `omega_body` about the origin, W = −[ω×]².
    pub fn centrifugal(&self, u: &[f64], omega_body: &Vector3<f64>) -> Vec<f64> {
        let w = spin(omega_body);
        let outwards: Vec<f64> = self
            .mesh()
            .positions()
            .iter()
            .zip(u.chunks_exact(3))
            .flat_map(|(x, u)| {
                let arm = Vector3::from(*x) - self.origin + Vector3::from_column_slice(u);
                <[f64; 3]>::from(w * arm)
            })
            .collect();
        self.momentum(&outwards)
    }

    /// The order of its unknowns, made at the first call.
    pub(crate) fn order(&self) -> Result<&IndefiniteOrder, NonlinearError> {
        if let Some(order) = self.order.get() {
            return Ok(order);
        }
        let order = IndefiniteOrder::new(self.matrices.start(), self.matrices.nodes())?;
        Ok(self.order.get_or_init(|| order))
    }

    /// Entries of the factor of a tangent.
    ///
    /// # Errors
    /// An order that is not found.
    pub fn factor_entries(&self) -> Result<usize, NonlinearError> {
        Ok(self.order()?.entries())
    }

    /// Takes out of displacements their parts along the rigid modes that the support leaves.
    pub fn without_rigid(&self, u: &mut [f64]) {
        for k in 0..self.rigid.ncols() {
            let part: f64 = self.momenta.col(k).iter().zip(&*u).map(|(m, u)| m * u).sum();
            u.iter_mut().zip(self.rigid.col(k).iter()).for_each(|(u, r)| *u -= part * r);
        }
    }
}

/// W = −[ω×]² = |ω|² 1 − ω ωᵀ.
pub(crate) fn spin(omega: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(omega.norm_squared()) - omega * omega.transpose()
}
