//! A place of the body with what the modes do there.

use faer::MatRef;
use keys::{Key, Keyed};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody};
use rigid_kin::transformation_matrix;

use crate::body::components::{Components, ComponentsFrom};
use crate::body::patch_turn::PatchTurn;
use crate::body::second_order::SecondOrder;
use crate::error::SetupError;

/// A point with its rows of all mode shapes, rigid and flexible.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(into = "Columns", try_from = "Columns")]
pub struct PointShapes {
    position_body: Vector3<f64>,
    /// Displacement that the position has already: of a bent reference.
    of_reference: Vector3<f64>,
    /// Column k is the displacement of the point in mode k (6+nf columns).
    columns: Vec<Vector3<f64>>,
    /// The same by components, a list of all modes each.
    components: Components,
    second_order: Option<SecondOrder>,
}

impl PointShapes {
    /// The rows of a point's shapes in the modes of `body`.
    pub fn new(body: &ReducedBody, point: &BodyPoint) -> Self {
        let rigid = body.rigid_shapes(&point.position_body);
        let columns = (0..6)
            .map(|k| rigid.column(k).into())
            .chain(point.shapes.col_iter().map(|c| Vector3::new(c[0], c[1], c[2])))
            .collect();
        Self::of_columns(point.position_body, columns)
    }

    fn of_columns(position_body: Vector3<f64>, columns: Vec<Vector3<f64>>) -> Self {
        let of_reference = Vector3::zeros();
        Self { position_body, of_reference, components: Components::new(&columns), columns, second_order: None }
    }

    /// The point of a bent reference, which has moved it by a displacement already: what is seen is counted from the
    /// undeformed body.
    #[must_use]
    pub fn moved_by(self, of_reference: Vector3<f64>) -> Self {
        Self { of_reference, ..self }
    }

    /// Displacement that its position has already: zero but about a bent reference.
    pub fn of_reference(&self) -> Vector3<f64> {
        self.of_reference
    }

    /// The point with its displacement to second order: a load on it then stiffens the body.
    #[must_use]
    pub fn with_second_order(self, second_order: SecondOrder) -> Self {
        Self { second_order: Some(second_order), ..self }
    }

    /// The displacement of second order, if it is known.
    pub(crate) fn second_order(&self) -> Option<&SecondOrder> {
        self.second_order.as_ref()
    }

    /// X: position from the body's origin without deformation, or in the bent reference that the modes are about, body axes.
    pub fn position_body(&self) -> Vector3<f64> {
        self.position_body
    }

    /// Number of flexible modes.
    pub(crate) fn flexible(&self) -> usize {
        self.columns.len() - 6
    }

    /// The point with the rows of the first `flexible` flexible modes only.
    pub fn truncated(&self, flexible: usize) -> Self {
        let kept = self.columns.len().min(6 + flexible);
        let second_order = self.second_order.as_ref().map(|second_order| second_order.truncated(flexible));
        let of_reference = self.of_reference;
        Self { second_order, of_reference, ..Self::of_columns(self.position_body, self.columns[..kept].to_vec()) }
    }

    /// Modal expansion at the point, (28): Σ_k Ψ_k c_k.
    pub fn expand(&self, coordinates: &[f64]) -> Vector3<f64> {
        self.components.from(0).sum(coordinates)
    }

    /// Φ q of the flexible modes: displacement of the point in the body frame.
    pub fn deformation(&self, flexible: &[f64]) -> Vector3<f64> {
        self.components.from(6).sum(flexible)
    }

    /// [`Self::deformation`] of three lists at once: each shape is read once.
    pub(crate) fn deformations(&self, flexible: [&[f64]; 3]) -> [Vector3<f64>; 3] {
        self.components.from(6).sums(flexible)
    }

    /// The components of all shapes from mode `first` on, the rigid ones counted.
    pub(crate) fn components(&self, first: usize) -> ComponentsFrom<'_> {
        self.components.from(first)
    }

    /// Columns of all modes, rigid and flexible (6+nf).
    pub fn columns(&self) -> &[Vector3<f64>] {
        &self.columns
    }
}

/// A point as serde has it.
#[derive(serde::Serialize, serde::Deserialize)]
struct Columns(Vector3<f64>, Vec<Vector3<f64>>, Option<SecondOrder>);

impl From<PointShapes> for Columns {
    fn from(PointShapes { position_body, columns, second_order, .. }: PointShapes) -> Self {
        Self(position_body, columns, second_order)
    }
}

impl TryFrom<Columns> for PointShapes {
    type Error = SetupError;

    fn try_from(Columns(position_body, columns, second_order): Columns) -> Result<Self, SetupError> {
        check_rigid(&columns)?;
        Ok(Self { second_order, ..Self::of_columns(position_body, columns) })
    }
}

/// Refuses columns without those of the six rigid modes.
fn check_rigid(columns: &[Vector3<f64>]) -> Result<(), SetupError> {
    let (what, found) = ("the list of the shapes of a place", columns.len());
    if found < 6 { Err(SetupError::Entries { what, found, expected: "6 or more".to_owned() }) } else { Ok(()) }
}

/// A place of the body with the small rotations that all modes, rigid and flexible, give it.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(into = "Rotations", try_from = "Rotations")]
pub struct RotationShapes {
    /// Column k is the rotation vector of the place in mode k (6+nf columns).
    columns: Vec<Vector3<f64>>,
    second_order: Option<SecondOrder>,
    /// How far it turns, where large modes turn it.
    patch: Option<PatchTurn>,
}

/// Σ columns_k c_k
pub(crate) fn sum(columns: &[Vector3<f64>], coordinates: &[f64]) -> Vector3<f64> {
    columns.iter().zip(coordinates).map(|(column, c)| column * *c).sum()
}

/// A place as serde has it.
#[derive(serde::Serialize, serde::Deserialize)]
struct Rotations(Vec<Vector3<f64>>, Option<SecondOrder>, Option<PatchTurn>);

impl From<RotationShapes> for Rotations {
    fn from(RotationShapes { columns, second_order, patch }: RotationShapes) -> Self {
        Self(columns, second_order, patch)
    }
}

impl TryFrom<Rotations> for RotationShapes {
    type Error = SetupError;

    fn try_from(Rotations(columns, second_order, patch): Rotations) -> Result<Self, SetupError> {
        check_rigid(&columns)?;
        Ok(Self { columns, second_order, patch: None }.with_patch(patch))
    }
}

impl RotationShapes {
    /// `flexible` has the rotation vectors of the flexible modes (3×nf).
    pub fn new(body: &ReducedBody, flexible: MatRef<'_, f64>) -> Self {
        let rigid = (0..3).map(|_| Vector3::zeros()).chain((0..3).map(|i| body.rotation_basis.column(i).into()));
        let columns = rigid.chain(flexible.col_iter().map(|c| Vector3::new(c[0], c[1], c[2]))).collect();
        Self { columns, second_order: None, patch: None }
    }

    /// The place with its rotation to second order: a moment on it then stiffens the body.
    #[must_use]
    pub fn with_second_order(self, second_order: SecondOrder) -> Self {
        Self { second_order: Some(second_order), ..self }
    }

    /// The place with the turn of its nodes: on large modes a moment then does its work on their best rotation.
    #[must_use]
    pub fn with_patch(self, patch: Option<PatchTurn>) -> Self {
        let fits = |patch: &PatchTurn| patch.flexible() == self.flexible();
        Self { patch: patch.filter(fits), ..self }
    }

    /// The rotation of the place where the flexible modes have the displacements `xi`: that which fits its nodes best, or the one whose
    /// rotation vector the modes give.
    pub fn rotation(&self, xi: &[f64]) -> Matrix3<f64> {
        match self.patch.as_ref().and_then(|patch| patch.rotation(xi)) {
            Some(rotation) => rotation,
            None => transformation_matrix(&-sum(&self.columns[6..], xi)),
        }
    }

    /// The turn of its nodes, if it is known.
    pub(crate) fn patch(&self) -> Option<&PatchTurn> {
        self.patch.as_ref()
    }

    /// The rotation of second order, if it is known.
    pub(crate) fn second_order(&self) -> Option<&SecondOrder> {
        self.second_order.as_ref()
    }

    /// Number of flexible modes.
    pub(crate) fn flexible(&self) -> usize {
        self.columns.len() - 6
    }

    /// The place with the first `flexible` flexible modes only.
    pub fn truncated(&self, flexible: usize) -> Self {
        let kept = self.columns.len().min(6 + flexible);
        let second_order = self.second_order.as_ref().map(|second_order| second_order.truncated(flexible));
        let patch = self.patch.as_ref().map(|patch| patch.truncated(flexible));
        Self { columns: self.columns[..kept].to_vec(), second_order, patch }
    }

    /// Columns of all modes, rigid and flexible (6+nf).
    pub fn columns(&self) -> &[Vector3<f64>] {
        &self.columns
    }
}

impl Keyed for PointShapes {
    fn key(&self, key: Key) -> Key {
        let Self { position_body, of_reference, columns, second_order, components: _ } = self;
        let key = key.of("point", 1).with("position", position_body).with("columns", columns.as_slice());
        let key = key.with("second order", second_order);
        // Points of bodies without a reference keep the keys that they had before there was any.
        if *of_reference == Vector3::zeros() { key } else { key.with("of reference", of_reference) }
    }
}

impl Keyed for RotationShapes {
    fn key(&self, key: Key) -> Key {
        let Self { columns, second_order, patch } = self;
        let key = key.of("rotation", 2).with("columns", columns.as_slice()).with("second order", second_order);
        key.with("patch", patch)
    }
}
