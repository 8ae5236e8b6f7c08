//! Stress of displacements, and the stiffness that it gives.

use faer::{Mat, MatRef};
use fem_tet10::{StressSites, extended_geometric_stiffness};
use modal::Modes;

use crate::error::BuildError;
use crate::reduction::reference::Reference;
use crate::stress::about::stress_about;
use crate::structure::Structure;

impl Structure<'_> {
    /// Stiffness in the modes (nf×nf) by the stress of each displacement field (3n×k). `known` are those in the first of the
    /// modes, one for each field, or none.
    pub fn stress_stiffness(
        &self,
        displacements: MatRef<'_, f64>,
        modes: &Modes,
        known: &[Mat<f64>],
    ) -> Result<Vec<Mat<f64>>, BuildError> {
        let shapes = modes.shapes.as_ref();
        let asked = self.of_body("initial stress").with("displacements", &displacements).with("shapes", &shapes);
        self.ask(asked.with("known", known), [displacements.ncols(), shapes.ncols()], || {
            self.pass_elements();
            let (mesh, materials) = (&self.assembled.mesh, self.assembled.materials()?);
            let reference = self.reference().map(|reference| reference.displacement.as_ref());
            Ok(extended_geometric_stiffness(mesh, materials, displacements, shapes, known, reference)?)
        })
    }

    /// Where nodal stress is known.
    pub fn stress_sites(&self) -> Result<&StressSites, BuildError> {
        Ok(self.recovery()?.sites())
    }

    /// The stress (6m×k) of displacement fields (3n×k), and of second order of pairs of others (3n×l).
    pub fn nodal_stress(
        &self,
        displacements: MatRef<'_, f64>,
        others: MatRef<'_, f64>,
        pairs: &[[usize; 2]],
    ) -> Result<Mat<f64>, BuildError> {
        let recovery = self.recovery()?;
        let asked = self.of_body("nodal stress").with("displacements", &displacements);
        let size = [6 * recovery.sites().len(), displacements.ncols() + pairs.len()];
        self.ask(asked.with("others", &others).with("pairs", pairs), size, || {
            let linear = match self.reference() {
                Some(Reference { displacement, .. }) => stress_about(recovery, displacement.as_ref(), displacements)?,
                None => recovery.nodal_stress(displacements)?,
            };
            let linear = linear.get(.., ..displacements.ncols()).to_owned();
            if pairs.is_empty() {
                return Ok(linear);
            }
            let second = recovery.second_order_nodal_stress(others, pairs)?;
            let first = linear.ncols();
            let entry = |i: usize, j: usize| if j < first { linear[(i, j)] } else { second[(i, j - first)] };
            Ok(Mat::from_fn(size[0], size[1], entry))
        })
    }

    /// The stress (6m×1) of the bent body that the modes are about; none of the undeformed one.
    pub fn reference_stress(&self) -> Result<Option<Mat<f64>>, BuildError> {
        let Some(Reference { displacement, .. }) = self.reference() else { return Ok(None) };
        let recovery = self.recovery()?;
        let asked = self.of_body("stress of the reference");
        let found = self.ask(asked, [6 * recovery.sites().len(), 1], || {
            Ok(stress_about(recovery, displacement.as_ref(), displacement.get(.., ..0))?)
        });
        Ok(Some(found?))
    }

    /// The stiffness in the modes (nf×nf) by the stress of a reference that K is without; none where it has it.
    pub fn reference_stiffness(&self, modes: &Modes) -> Result<Option<Mat<f64>>, BuildError> {
        let Some(tangent) = self.assembled.stress_tangent()? else { return Ok(None) };
        Ok(Some(modes.shapes.transpose() * (tangent.stiffness() * &modes.shapes)))
    }

    /// The stress (6m×k) of static responses (3n×k) that modes and static shapes leave out.
    pub fn stress_beside(&self, modes: &Modes, responses: MatRef<'_, f64>) -> Result<Mat<f64>, BuildError> {
        let recovery = self.recovery()?;
        // The coupling of the shapes follows from them.
        let asked = self.of_body("stress beside modes").with_modes(modes).with("responses", &responses);
        self.ask(asked, [6 * recovery.sites().len(), responses.ncols()], || {
            let mut parts = modes.shapes.transpose() * (self.matrices()?.stiffness() * responses);
            modes.answer(&mut parts).map_err(|error| self.modal(error))?;
            let rest = responses - &modes.shapes * parts;
            Ok(recovery.nodal_stress(rest.as_ref())?)
        })
    }
}
