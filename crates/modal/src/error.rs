//! Errors of the search for modes.

use diagnostic::{Diagnosis, Diagnostic, Failure, Kind};
/// Failure of an engine, in its own words.
pub type EngineError = Failure;

/// Faults of the matrices, or of a request.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum ModalError {
    /// Matrices and positions of different sizes.
    #[error(
        "{what} has {found} rows or columns; expected {expected}, three for each of the nodes (or six, with rotations)"
    )]
    Size { what: &'static str, expected: usize, found: usize },
    /// An entry or a position that is NaN or infinite.
    #[error("{what}: {value} in {place} {index} (counted from 0); every number must be finite")]
    NotFinite { what: &'static str, place: &'static str, index: usize, value: f64 },
    /// A matrix that is not its own transpose. `mirrored`: the entry at (column, row), zero where none is stored.
    #[error(
        "the {what} matrix is not symmetric: entry ({row}, {column}) is {value:.3e}, its mirror image {mirrored:.3e}; store both triangles"
    )]
    NotSymmetric { what: &'static str, row: usize, column: usize, value: f64, mirrored: f64 },
    /// The mass matrix does not act alike on the three axes.
    #[error(
        "the mass matrix couples degrees of freedom {row} and {column} ({value:.3e}) unlike those of the other axes; expected a mass for each pair of nodes times the 3x3 identity, as solid elements have it"
    )]
    AnisotropicMass { row: usize, column: usize, value: f64 },
    /// The mass matrix is that of no rigid body. `relative`: to m, or to m times the size of the body; `limit`: the
    /// most that rounding explains.
    #[error(
        "the mass matrix does not give a translation of the whole body the mass of a rigid one: {what} is off by {relative:.3e} (expected below {limit:.0e}); a body that moves needs the same mass m along every axis, m times the 3x3 identity, and the momentum m ω×c of a rotation. Is mass of a surrounding fluid in the matrix, or is mass missing along an axis? Put it on all three axes, or clamp the body"
    )]
    NoRigidBodyMass { what: &'static str, relative: f64, limit: f64 },
    /// A motion would have a negative kinetic energy. `place`: node and degree of freedom whose diagonal entry shows
    /// it, `None` where only the whole matrix does.
    #[error(
        "the mass matrix is not positive semi-definite{}: some motion would have a negative kinetic energy; is a sign or an element wrong?",
        place.map(|[node, dof]| format!(", as degree of freedom {dof} of node {node} (both counted from 0) shows: its diagonal entry is not positive though others of its row are there")).unwrap_or_default()
    )]
    IndefiniteMass { place: Option<[usize; 2]> },
    /// K lets some motion set energy free. `eigenvalue`: (rad/time)².
    #[error(
        "the stiffness matrix is not positive semi-definite: its lowest eigenvalue against the mass is {eigenvalue:.3e} (shift {shift:.3e}); a material constant or an element is wrong: check Young's moduli and Poisson's ratios, or the matrices"
    )]
    NegativeStiffness { eigenvalue: f64, shift: f64 },
    /// A degree of freedom that nothing resists.
    #[error(
        "degree of freedom {dof} of node {node} (both counted from 0) has neither stiffness nor mass; hold it, or give it some"
    )]
    Loose { node: usize, dof: usize },
    /// Lists or matrices whose sizes do not fit together.
    #[error("the size of {what} is {found}; expected {expected}")]
    Length { what: &'static str, found: usize, expected: usize },
    /// A number that has to be positive.
    #[error("{what} is {value}; expected a positive number")]
    NotPositive { what: &'static str, value: f64 },
    /// A list of coupled nodes that does not rise.
    #[error("the nodes that node {node} (counted from 0) is coupled to are not in rising order")]
    Unsorted { node: usize },
    /// A node that is not there.
    #[error("node {node} (counted from 0) is not there; the mesh has {count} nodes")]
    NoNode { node: u32, count: usize },
    /// A node at the end of an edge that is in the middle of another one.
    #[error(
        "node {node} (counted from 0) has node {end} at an end of its edge, which is no corner: a corner has itself twice"
    )]
    NoCorner { node: usize, end: u32 },
    /// Numbers of large or following modes that do not rise, that are twice there, or of modes that there are not.
    #[error(
        "the large modes, and those that follow, are {found:?}; expected rising numbers of each below {count}, the number of shapes"
    )]
    LargeModes { found: Vec<usize>, count: usize },
    /// Weights of a point that do not sum to one.
    #[error("the weights of a point sum to {sum}; expected 1, as of shape functions")]
    Weights { sum: f64 },
    /// A held node that is not there.
    #[error("the support holds node {node} (counted from 0); the mesh has {count} nodes")]
    HeldNode { node: u32, count: usize },
    /// A held degree of freedom that a node has not got.
    #[error(
        "the support holds degree of freedom {dof} of node {node} (both counted from 0); a node has {count}: translations along x, y and z{}",
        if *count == 6 { ", then rotations about them" } else { "" }
    )]
    HeldFreedom { node: u32, dof: usize, count: usize },
    /// Held nodes that leave more rigid motions than the support has.
    #[error(
        "the {held} held node(s) leave the body {left} rigid motions, the support only {expected}: hold more nodes (three that are not in line for a clamp or slider, two for a hinge, one for a pin), the only node of a pin at its point, two of a hinge on its axis"
    )]
    Underheld { held: usize, left: usize, expected: usize },
    /// A rigid motion that K resists. `relative`: ‖K r‖ against ‖D r‖, D the diagonal of K; `limit`: the most that
    /// rounding explains.
    #[error(
        "the body is not free: rigid {motion} meets a stiffness of {relative:.3e} of K's diagonal (expected below {limit:.3e}); remove the supports from K"
    )]
    NotFree { motion: &'static str, relative: f64, limit: f64 },
    /// More modes asked for than there are.
    #[error(
        "{requested} flexible modes asked for; the mesh has only {available} (three for each node that is free and has mass, less the rigid ones)"
    )]
    TooManyModes { requested: usize, available: usize },
    /// Modes without energy beside the rigid ones. `shift`: the scale of the others; `node`: the one that moves most.
    #[error(
        "the body is a mechanism: besides the {rigid} rigid mode(s) {count} mode(s) have no stiffness (the first has {eigenvalue:.3e} of the shift {shift:.3e}); the node with index {node} at {position:?} moves most. Are parts joined at a single node or edge only? Join them by faces. Is the body too thin for its length, so that rounding hides its bending stiffness? Take elements that are less flat, or a thicker body"
    )]
    Mechanism { rigid: usize, count: usize, eigenvalue: f64, shift: f64, node: usize, position: [f64; 3] },
    /// A lowest mode whose stiffness is not above the rounding in K. `eigenvalue`: (rad/time)²; `rounding`: ε
    /// |φ|ᵀ|K||φ| of the mode.
    #[error(
        "rounding hides the stiffness of the body: the rounding of the entries of K may come to {rounding:.3e} where its lowest flexible mode has the eigenvalue {eigenvalue:.3e} (it may be up to {limit:.3e}). Is the body too thin for its length? Take elements that are less flat, or a thicker body"
    )]
    HiddenByRounding { eigenvalue: f64, rounding: f64, limit: f64 },
    /// A lowest mode whose mass is not known well for rounding in M. `rounding`: ε |φ|ᵀ|M||φ| of the mode, whose mass
    /// is 1.
    #[error(
        "rounding hides the mass of the body's motion: the rounding of the entries of M may come to {rounding:.1e} of the mass of its lowest flexible mode (it may be up to {limit:.1e}). Is a point mass or a density many powers of ten larger than the rest? Make it smaller, or hold the body there by a support"
    )]
    MassHiddenByRounding { rounding: f64, limit: f64 },
    /// K + sM is not positive definite.
    #[error(
        "the stiffness matrix is not positive semi-definite (pivot {pivot} of K + {shift:.3e} M): a material constant or an element is wrong: check Young's moduli and Poisson's ratios, or the matrices"
    )]
    Indefinite { pivot: usize, shift: f64 },
    /// METIS failed.
    #[error(
        "the unknowns cannot be ordered for the factorization (METIS status {status}); use a coarser mesh, and please report this"
    )]
    Ordering { status: i32 },
    /// Constants, or a rigid motion, that no body can have.
    #[error(transparent)]
    Body(#[from] reduced_body::BodyError),
    /// Not enough memory.
    #[error("{0}")]
    Memory(#[from] memory::OutOfMemory),
    /// A factorisation or its ordering that the libraries refuse, as where an index would be too large.
    #[error("the factorisation of {size} unknowns failed: {reason}; use a coarser mesh")]
    Factorization { size: usize, reason: String },
    /// The search did not end. `residual`: the worst of the modes asked for.
    #[error(
        "only {converged} of {requested} modes converged within {steps} block steps (residual {residual:.3e}, wanted {tolerance:.1e}): do masses or stiffnesses within the body differ by many powers of ten?"
    )]
    NotConverged { converged: usize, requested: usize, steps: usize, residual: f64, tolerance: f64 },
    /// A static response that is not one. `residual`: in the norm of (K + sM)⁻¹, relative to that of the force.
    #[error(
        "the static response to force {column} has a residual of {residual:.3e} after {iterations} iterations (wanted {tolerance:e}): is a part of the body all but loose?"
    )]
    StaticNotConverged { column: usize, iterations: usize, residual: f64, tolerance: f64 },
    /// An engine failed.
    #[error("{0}")]
    Engine(#[source] EngineError),
    /// The answers of an engine do not fit the request.
    #[error(
        "the answers of the engine are not those of this body: found {found}, expected {expected}; have it compute them again"
    )]
    WrongAnswers { found: String, expected: String },
    /// A projected mass or stiffness matrix without a Cholesky factor.
    #[error(
        "the {matrix} matrix on {size} vectors is not positive definite in rounded numbers: the vectors depend on each other, or masses or stiffnesses of the body are many powers of ten apart"
    )]
    NotPositiveDefinite { matrix: &'static str, size: usize },
    /// A dense eigenvalue problem failed.
    #[error(
        "a dense eigenvalue problem of size {size} did not converge: are masses or stiffnesses of the body many powers of ten too small or too large in the units of the scene?"
    )]
    DenseEigen { size: usize },
}

impl Diagnostic for ModalError {
    fn diagnosis(&self) -> Diagnosis {
        match self {
            Self::Memory(error) => return error.diagnosis(),
            Self::Engine(error) => return error.diagnosis(),
            Self::TooManyModes { .. }
            | Self::HeldNode { .. }
            | Self::HeldFreedom { .. }
            | Self::Body(reduced_body::BodyError::NotUnit { .. }) => Kind::Input,
            Self::WrongAnswers { .. }
            | Self::Ordering { .. }
            | Self::Factorization { .. }
            | Self::NotConverged { .. }
            | Self::StaticNotConverged { .. }
            | Self::NotPositiveDefinite { .. }
            | Self::DenseEigen { .. } => Kind::Run,
            _ => Kind::Refused,
        }
        .alone()
    }
}
