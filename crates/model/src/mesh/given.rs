//! A body of mass and stiffness matrices from another program.

use fem_tet10::{Mesh, NodeGroup};
use keys::Hash;
use matrix_import::{BodyMatrices, MatrixError, MatrixFiles, Which};
use modal::{MassMatrix, ModalError, RigidModes};
use reduced_body::{BodyError, RigidMotion};
use scene::Body;

use crate::error::{BuildError, modal};
use crate::mesh::fe_matrices::FeMatrices;

/// The nodes and the matrices of a body, and what was found when they were checked.
pub(crate) struct Given {
    pub nodes: Mesh,
    /// Hash of the bytes that were read of the files.
    pub hash: Hash,
    pub notes: Vec<String>,
    pub matrices: FeMatrices,
    pub checks: MatrixChecks,
}

/// Findings about the matrices of another program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MatrixChecks {
    /// Degrees of freedom of a node: 3, or 6 with its rotations.
    pub dofs: usize,
    /// Largest difference of the triangles of K or M, relative to the diagonal; `None` where the files have one triangle.
    pub asymmetry: Option<f64>,
    /// How much K resists the rigid motion that it resists most: ‖K r‖/‖D r‖, D its diagonal.
    pub rigid_stiffness: f64,
    /// True if M is a scalar for each pair of nodes, as that of solid elements and point masses.
    pub is_scalar_mass: bool,
    /// The part of M that the large rotation leaves out, relative to the modal mass ([`modal::mass_left_out`]).
    pub left_out: f64,
}

impl Given {
    /// Reads the files and checks what a free body must have, whatever holds it in the scene.
    pub fn read(body: &Body, files: &MatrixFiles) -> Result<Self, BuildError> {
        let BodyMatrices { labels, positions, groups, dofs, stiffness, mass, asymmetry, hash, notes } =
            files.read().map_err(|error| refuse_file(body, error))?;
        let of_group = |(name, nodes): (String, Vec<u32>)| NodeGroup {
            name,
            dimension: 0,
            nodes: nodes.into_iter().map(|node| labels[node as usize]).collect(),
        };
        let groups = groups.into_iter().map(of_group).collect();
        let nodes = Mesh::of_nodes(files.nodes.display().to_string(), labels, positions, groups)?;

        let refuse = |error| refuse_matrix(body, files, &nodes, error);
        let as_mass = MassMatrix::new(mass.as_ref(), nodes.positions().len()).map_err(refuse)?;
        let is_scalar_mass = matches!(as_mass, MassMatrix::Nodal(_));
        as_mass.check_semidefinite().map_err(refuse)?;
        let rigid = RigidModes::new(&as_mass, nodes.positions(), RigidMotion::free()).map_err(refuse)?;
        let rigid_stiffness = rigid.check_free(stiffness.as_ref()).map_err(refuse)?;
        let checks = MatrixChecks { dofs, asymmetry, rigid_stiffness, is_scalar_mass, left_out: 0.0 };
        Ok(Self { nodes, hash, notes, matrices: FeMatrices::Given { stiffness, mass }, checks })
    }
}

/// A file that cannot be used, at its key.
fn refuse_file(body: &Body, error: MatrixError) -> BuildError {
    match error {
        MatrixError::Refused { which, path, line, found, expected, help } => {
            let line = line.map_or_else(String::new, |line| format!(":{line}"));
            let found = format!("{found} in {}{line}", path.display());
            body.refuse(&format!("body.matrices.{}", which.name()), found, expected, help).into()
        }
        MatrixError::Memory(error) => modal(body)(error),
        other => refused(body, Which::Stiffness, other.to_string(), "matrices that can be read", "write them again"),
    }
}

/// Error for matrices that could be read, at the key of the one at fault.
pub(crate) fn refuse_matrix(body: &Body, files: &MatrixFiles, nodes: &Mesh, error: ModalError) -> BuildError {
    let name = |index: usize| nodes.node_tags().get(index).copied().unwrap_or_default();
    let (mass, stiffness) = (files.mass.display(), files.stiffness.display());
    match error {
        ModalError::NotFree { motion, relative, limit } => refused(
            body,
            Which::Stiffness,
            format!("a body that is not free in {stiffness}: a rigid {motion} meets {relative:.1e} of the diagonal"),
            &format!("no stiffness against the six rigid motions (below {limit:.0e})"),
            "write the matrices without *BOUNDARY, springs to the ground and preload, and hold the body by [[constraints]] in the \
             scene; or the nodes are not where the matrices have them: give all digits, in the axes and the order of the matrices",
        ),
        ModalError::IndefiniteMass { place } => {
            let place = place.map_or_else(String::new, |[node, dof]| {
                format!(", as degree of freedom {} of node {} shows", dof + 1, name(node))
            });
            let found = format!(
                "a mass that is not positive definite in {mass}: some motion has a negative kinetic energy{place}"
            );
            let help = "look for a negative density, an element that is turned inside out, or the stiffness in place of the mass";
            refused(body, Which::Mass, found, "a mass that gives every motion a positive kinetic energy", help)
        }
        ModalError::Body(BodyError::NoInertia { mass: total, inertia }) => {
            let found = format!(
                "a body with mass {total:.3e} and moments of inertia {:.3e}, {:.3e}, {:.3e} in {mass}",
                inertia[0], inertia[1], inertia[2]
            );
            let help =
                "look for a density that is missing, or nodes in another unit of length or order than the matrices";
            refused(body, Which::Mass, found, "a mass and moments of inertia that are positive", help)
        }
        ModalError::NoRigidBodyMass { what, relative, limit } => refused(
            body,
            Which::Mass,
            format!("a mass that is none of a rigid body in {mass}: {what} is off by {relative:.1e}"),
            &format!("the same mass along every axis (to {limit:.0e})"),
            "write the mass of the whole model without *BOUNDARY and surrounding fluid; a mass along one axis only cannot move freely",
        ),
        ModalError::Loose { node, dof } => refused(
            body,
            Which::Stiffness,
            format!("neither stiffness nor mass at degree of freedom {} of node {}", dof + 1, name(node)),
            "stiffness or mass at every degree of freedom",
            "leave the node out of the model, or give the element a stiffness against this motion (the drilling of shells)",
        ),
        ModalError::NegativeStiffness { eigenvalue, .. } => refused(
            body,
            Which::Stiffness,
            format!(
                "a stiffness that is not positive semi-definite in {stiffness}: its lowest eigenvalue is {eigenvalue:.3e}"
            ),
            "a stiffness that resists every deformation",
            "write K of the model without preload, contact and negative springs",
        ),
        ModalError::Mechanism { count, node, .. } => refused(
            body,
            Which::Stiffness,
            format!(
                "{count} motion(s) besides the rigid ones without stiffness in {stiffness}, the first of them largest at node {}",
                name(node)
            ),
            "a stiffness that resists every deformation",
            "join the parts of the model, or give its elements a stiffness against this motion (the drilling of shells, hinges of beams)",
        ),
        ModalError::Indefinite { .. } => refused(
            body,
            Which::Stiffness,
            format!("a stiffness that is not positive semi-definite in {stiffness}"),
            "a stiffness that resists every deformation",
            "write K of the model without preload, contact and negative springs",
        ),
        other => modal(body)(other),
    }
}

fn refused(body: &Body, which: Which, found: String, expected: &str, help: &str) -> BuildError {
    body.refuse(&format!("body.matrices.{}", which.name()), found, expected, help).into()
}
