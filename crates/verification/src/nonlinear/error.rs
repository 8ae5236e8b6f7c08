//! Errors of the nonlinear body.

/// Errors of a body that is not found or does not move.
#[derive(Debug)]
pub enum SolidError {
    /// A mesh, a material or a group that is refused.
    Mesh(String),
    /// A tangent stiffness that is not positive definite.
    Factor,
    /// Newton's iteration does not come to rest.
    Iterations {
        /// Time, or the part of the load.
        at: f64,
        /// Rest of the forces, relative.
        residual: f64,
    },
    /// A scene that flexframe refuses.
    Scene(String),
}

impl std::fmt::Display for SolidError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Mesh(error) | Self::Scene(error) => f.write_str(error),
            Self::Factor => f.write_str("the tangent stiffness is not positive definite: take shorter steps"),
            Self::Iterations { at, residual } => {
                write!(f, "no equilibrium at {at}: {residual:e} of the forces are left; take shorter steps")
            }
        }
    }
}

impl std::error::Error for SolidError {}

impl From<fem_tet10::AssemblyError> for SolidError {
    fn from(error: fem_tet10::AssemblyError) -> Self {
        Self::Mesh(error.to_string())
    }
}

impl From<fem_tet10::MeshError> for SolidError {
    fn from(error: fem_tet10::MeshError) -> Self {
        Self::Mesh(error.to_string())
    }
}
