//! The reduced body: every constant that the motion needs, none of them of the mesh's size.
//!
//! Eqs. (M7)–(M10) of `docs/method/modes.md`.
//!
//! With `X` the node positions from the origin (the centre of mass of a free body), `Ψ = [Ψ_R, Ψ_f]` the rigid and
//! flexible shapes, and `(I⊗A)` a 3×3 matrix A acting on each node's vector, for a mass that is a scalar for each pair of nodes
//! (`modal::Modes::reduced` has the definitions for any other):
//!
//! | here | theory | definition |
//! |---|---|---|
//! | [`rotation_products`](Constants::rotation_products) | E_ab | `Ψᵀ M (I⊗e_a e_bᵀ) Ψ`, so `Ψᵀ M (I⊗R) Ψ = Σ R_ab E_ab` |
//! | [`inertia_first`](Constants::inertia_first) | c_ij | `Ψ_fᵀ M (I⊗[e_i×]ᵀ[e_j×]) X`, symmetrised in ij |
//! | [`inertia_second`](Constants::inertia_second) | N_ij | `Ψ_fᵀ M (I⊗[e_i×]ᵀ[e_j×]) Ψ_f`, symmetrised in ij |
//! | [`gyroscopic`](Constants::gyroscopic) | G_i | `Ψ_fᵀ M (I⊗[e_i×]) Ψ_f`, skew |
//! | [`translation_first`](Constants::translation_first) | t_i | `Ψ_fᵀ M (1⊗e_i)`, zero for a free body |
//! | [`rotation_first`](Constants::rotation_first) | b_i | `Ψ_fᵀ M (I⊗[e_i×]) X`, zero for a free or pinned body |
//! | [`stress_stiffness`](Constants::stress_stiffness) | Ψ_fᵀ K_ij Ψ_f | of the stress that spinning causes |

use faer::Mat;
use keys::{Key, Keyed};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use crate::as_data;
use crate::error::{BodyError, check_finite, check_size};
use crate::rigid_motion::RigidMotion;

/// An elastic body in modal coordinates: [`Constants`] whose sizes fit together and which are finite. They can be read as
/// its fields. Serde has it as these, which it checks.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(into = "Constants", try_from = "Constants")]
pub struct ReducedBody(Constants);

impl From<ReducedBody> for Constants {
    fn from(body: ReducedBody) -> Self {
        body.0
    }
}

impl TryFrom<Constants> for ReducedBody {
    type Error = BodyError;

    fn try_from(constants: Constants) -> Result<Self, BodyError> {
        Self::from_constants(constants)
    }
}

impl std::ops::Deref for ReducedBody {
    type Target = Constants;

    fn deref(&self) -> &Constants {
        &self.0
    }
}

/// The constants of a body in modal coordinates. Axes are those of the mesh. X is measured from the origin: the centre
/// of mass of a free body, a fixed point of one that is held.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Constants {
    /// Total mass m.
    pub mass: f64,
    /// Centre of mass in the mesh's frame.
    pub center_of_mass: Vector3<f64>,
    /// The rigid motions that it has.
    pub motion: RigidMotion,
    /// The origin, in the mesh's frame.
    pub origin: Vector3<f64>,
    /// Inertia J₀ of the undeformed body about the origin.
    pub inertia: Matrix3<f64>,
    /// T (3×3): the velocity of the origin of rigid modal velocities y is `T y[..3]`. Columns of motions that the body
    /// does not have are zero; I/√m of a free body.
    pub translation_basis: Matrix3<f64>,
    /// B (3×3): the angular velocity of rigid modal velocities y is `B y[3..6]`. Columns of motions that the body has
    /// not got are zero.
    pub rotation_basis: Matrix3<f64>,
    /// Circular natural frequencies of the flexible modes, rad per time (nf).
    pub circular_frequencies: Vec<f64>,
    /// Number of natural modes among the flexible ones: they come first, static shapes after them.
    pub natural_modes: usize,
    /// E_ab (3×3 matrices of 6+nf × 6+nf).
    #[serde(with = "as_data")]
    pub rotation_products: [[Mat<f64>; 3]; 3],
    /// E^X_ab = `Ψᵀ M (e_a e_bᵀ) X` (3×3 vectors of 6+nf).
    pub position_products: [[Vec<f64>; 3]; 3],
    /// c_ij for ij = 11, 22, 33, 23, 13, 12 (6 vectors of nf).
    pub inertia_first: [Vec<f64>; 6],
    /// N_ij in the same order (6 matrices of nf×nf).
    #[serde(with = "as_data")]
    pub inertia_second: [Mat<f64>; 6],
    /// G_i (3 matrices of nf×nf).
    #[serde(with = "as_data")]
    pub gyroscopic: [Mat<f64>; 3],
    /// t_i (3 vectors of nf).
    pub translation_first: [Vec<f64>; 3],
    /// b_i (3 vectors of nf).
    pub rotation_first: [Vec<f64>; 3],
    /// Ψ_fᵀ K_ij Ψ_f for ij = 11, 22, 33, 23, 13, 12 (6 matrices of nf×nf): K_ij is the stress stiffness matrix of the
    /// static response to the centrifugal field of ω_iω_j, Eq. (G1) of `docs/method/stiffening.md`. `None` if it was not asked for.
    #[serde(with = "as_data")]
    pub stress_stiffness: Option<[Mat<f64>; 6]>,
}

/// A material point of the body: where it is, and how the modes move it.
#[derive(Debug, Clone)]
pub struct BodyPoint {
    /// Undeformed position X from the origin, body axes.
    pub position_body: Vector3<f64>,
    /// Rows of the flexible shapes at the point (3×nf): `u = Φ q`.
    pub shapes: Mat<f64>,
}

impl ReducedBody {
    /// ij = 11, 22, 33, 23, 13, 12, counted from zero: the order of [`Constants::inertia_first`] and [`Constants::inertia_second`], and of any symmetric 3×3 matrix.
    pub const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

    /// Weights of the constants of [`Self::PAIRS`] in those of a pair of vectors: a_i b_j, and of two different axes a_i b_j + a_j b_i.
    pub fn pair_weights([a, b]: [&Vector3<f64>; 2]) -> [f64; 6] {
        Self::PAIRS.map(|(k, l)| {
            let product = a[k] * b[l];
            if k == l { product } else { product + a[l] * b[k] }
        })
    }

    /// The body with these constants.
    ///
    /// # Errors
    /// [`BodyError::Length`] where sizes do not fit together, [`BodyError::NotFinite`], [`BodyError::NotPositive`].
    pub fn from_constants(constants: Constants) -> Result<Self, BodyError> {
        constants.check()?;
        Ok(Self(constants))
    }

    /// The same body, stiffened by the stress of a spin: [`Constants::stress_stiffness`].
    ///
    /// # Errors
    /// As [`Self::from_constants`].
    pub fn with_stress_stiffness(self, stress_stiffness: Option<[Mat<f64>; 6]>) -> Result<Self, BodyError> {
        Self::from_constants(Constants { stress_stiffness, ..self.0 })
    }

    /// Inertia of the undeformed body about its centre of mass, mesh axes.
    pub fn inertia_about_center(&self) -> Matrix3<f64> {
        let arm = self.center_of_mass - self.origin;
        self.inertia - (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * self.mass
    }

    /// Number of flexible modes nf.
    pub fn flexible(&self) -> usize {
        self.circular_frequencies.len()
    }

    /// The same body with its first `flexible` modes only: every constant is a leading part of the one here.
    pub fn truncated(&self, flexible: usize) -> Self {
        let nf = flexible.min(self.flexible());
        let leading = |matrix: &Mat<f64>, size: usize| matrix.get(..size, ..size).to_owned();
        Self(Constants {
            circular_frequencies: self.circular_frequencies[..nf].to_vec(),
            natural_modes: self.natural_modes.min(nf),
            rotation_products: self.rotation_products.each_ref().map(|r| r.each_ref().map(|m| leading(m, 6 + nf))),
            position_products: self.position_products.each_ref().map(|r| r.each_ref().map(|v| v[..6 + nf].to_vec())),
            inertia_first: self.inertia_first.each_ref().map(|v| v[..nf].to_vec()),
            inertia_second: self.inertia_second.each_ref().map(|m| leading(m, nf)),
            gyroscopic: self.gyroscopic.each_ref().map(|m| leading(m, nf)),
            translation_first: self.translation_first.each_ref().map(|v| v[..nf].to_vec()),
            rotation_first: self.rotation_first.each_ref().map(|v| v[..nf].to_vec()),
            stress_stiffness: self.stress_stiffness.as_ref().map(|k| k.each_ref().map(|m| leading(m, nf))),
            ..self.0
        })
    }

    /// Rows of the rigid shapes at a point X from the origin (3×6): `[T, −[X×] B]`.
    pub fn rigid_shapes(&self, position_body: &Vector3<f64>) -> nalgebra::Matrix3x6<f64> {
        let mut shapes = nalgebra::Matrix3x6::zeros();
        shapes.fixed_view_mut::<3, 3>(0, 0).copy_from(&self.translation_basis);
        shapes.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-position_body.cross_matrix() * self.rotation_basis));
        shapes
    }
}

impl Constants {
    /// Refuses sizes that do not fit together, numbers that are not finite, and frequencies that are not positive.
    fn check(&self) -> Result<(), BodyError> {
        let nf = self.circular_frequencies.len();
        let square = |what, matrix: &Mat<f64>, size: usize| -> Result<(), BodyError> {
            check_size(what, matrix.nrows(), size)?;
            check_size(what, matrix.ncols(), size)?;
            check_finite(what, matrix.col_iter().flat_map(|column| column.iter()).copied())
        };
        let list = |what, values: &[f64], size: usize| -> Result<(), BodyError> {
            check_size(what, values.len(), size)?;
            check_finite(what, values.iter().copied())
        };
        self.motion.check()?;
        check_finite("mass", [self.mass])?;
        check_finite("center of mass", self.center_of_mass.iter().copied())?;
        check_finite("origin", self.origin.iter().copied())?;
        check_finite("inertia", self.inertia.iter().copied())?;
        check_finite("translation basis", self.translation_basis.iter().copied())?;
        check_finite("rotation basis", self.rotation_basis.iter().copied())?;
        if let Some(value) =
            self.circular_frequencies.iter().copied().find(|omega| !(*omega > 0.0 && omega.is_finite()))
        {
            return Err(BodyError::NotPositive { what: "circular frequency", value });
        }
        if self.natural_modes > nf {
            return Err(BodyError::Length { what: "the natural modes", found: self.natural_modes, expected: nf });
        }
        self.rotation_products.iter().flatten().try_for_each(|m| square("rotation products", m, 6 + nf))?;
        self.position_products.iter().flatten().try_for_each(|v| list("position products", v, 6 + nf))?;
        self.inertia_first.iter().try_for_each(|v| list("first moments of the modes", v, nf))?;
        self.inertia_second.iter().try_for_each(|m| square("second moments of the modes", m, nf))?;
        self.gyroscopic.iter().try_for_each(|m| square("gyroscopic matrix", m, nf))?;
        self.translation_first.iter().try_for_each(|v| list("momenta of the modes in a translation", v, nf))?;
        self.rotation_first.iter().try_for_each(|v| list("momenta of the modes in a rotation", v, nf))?;
        self.stress_stiffness.iter().flatten().try_for_each(|m| square("stress stiffness", m, nf))
    }
}

impl BodyPoint {
    /// A point of a rigid body, at a position from its origin.
    pub fn rigid(position_body: Vector3<f64>) -> Self {
        Self { position_body, shapes: Mat::zeros(3, 0) }
    }
}

/// By the names that its fields have in a body file.
impl Keyed for ReducedBody {
    fn key(&self, key: Key) -> Key {
        let Constants {
            mass,
            center_of_mass,
            motion,
            origin,
            inertia,
            translation_basis,
            rotation_basis,
            circular_frequencies,
            natural_modes,
            rotation_products,
            position_products,
            inertia_first,
            inertia_second,
            gyroscopic,
            translation_first,
            rotation_first,
            stress_stiffness,
        } = &self.0;
        key.of("reduced body", 1)
            .with("mass", mass)
            .with("center_of_mass", center_of_mass)
            .with("motion", motion)
            .with("origin", origin)
            .with("inertia", inertia)
            .with("translation_basis", translation_basis)
            .with("rotation_basis", rotation_basis)
            .with("circular_frequencies", circular_frequencies)
            .with("natural_modes", natural_modes)
            .with("rotation_products", rotation_products.as_flattened())
            .with("position_products", position_products.as_flattened())
            .with("inertia_first", inertia_first.as_slice())
            .with("inertia_second", inertia_second.as_slice())
            .with("gyroscopic", gyroscopic.as_slice())
            .with("translation_first", translation_first.as_slice())
            .with("rotation_first", rotation_first.as_slice())
            .with("stress_stiffness", &stress_stiffness.as_ref().map(|matrices| matrices.as_slice()))
    }
}
