//! The columns of a results file: data, from which the writer, the reader and the documentation are made.

use crate::dimension::Dimension;
use crate::metadata::{BodyMetadata, JointMetadata, Units};
use std::fmt::Debug;

/// A row of a results file, as far as its columns look at it.
pub trait SystemRow: Debug {
    /// The part of a row that is of one body.
    type Body: Debug;
    /// The time.
    fn time(&self) -> f64;
    /// The bodies, in the order of [`Metadata::bodies`](crate::Metadata::bodies).
    fn bodies(&self) -> &[Self::Body];
    /// The part of a row that is of one joint.
    type Joint: Debug;
    /// The joints, in the order of [`Metadata::joints`](crate::Metadata::joints).
    fn joints(&self) -> &[Self::Joint];
}

/// A column of a results file: time histories of a quantity, of the system or of each body. Rows are of type `R`.
///
/// The histories of a file are in the order of their table. The time is no column: every file has it.
#[derive(Debug)]
pub struct Column<R: SystemRow> {
    /// Group of the dataset, such as "energy"; empty for none.
    pub group: &'static str,
    /// Name of the dataset in it, such as "work".
    pub name: &'static str,
    /// Dimension of its numbers.
    pub dimension: Dimension,
    /// Frame of the components, such as "global"; "none" for scalars.
    pub frame: &'static str,
    /// A sentence for people.
    pub description: &'static str,
    /// Numbers of a row.
    pub values: Values<R>,
    /// Part that a body or a joint must have for its histories, one of [`BodyMetadata::parts`] or [`JointMetadata::parts`]; all
    /// have it if `None`.
    pub part: Option<&'static str>,
    /// Part that it must not have.
    pub other_part: Option<&'static str>,
    /// Use of the numbers where the body is a part of a larger model.
    pub role: Role,
}

/// The objects that a column has numbers of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// All bodies together.
    System,
    /// Each body.
    Body,
    /// Each point of each body.
    Point,
    /// Each support of each body.
    Support,
    /// Each joint.
    Joint,
}

/// Use of numbers where the body is a part of a larger model, as in an FMU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// An output that follows from the state.
    Output,
    /// An output that follows the forces of the instant, too, as accelerations and reactions do.
    Direct,
    /// For looking at, such as coordinates of modes and balances.
    Internal,
}

/// Functions that take the numbers of a column from a row, by what the numbers belong to.
#[derive(Debug)]
pub enum Values<R: SystemRow> {
    /// Values of the system.
    OfSystem(Quantity<R>),
    /// Values of a body.
    OfBody(Quantity<R::Body>),
    /// One number for each flexible mode of a body: the dataset has the shape T×nf.
    OfModes(fn(&R::Body) -> &[f64]),
    /// Values of each point of a body: T×P×….
    OfPoints(Quantities<R::Body>),
    /// Values of each support of a body: T×S×….
    OfSupports(Quantities<R::Body>),
    /// Values of a joint.
    OfJoint(Quantity<R::Joint>),
}

/// Numbers of one thing.
#[derive(Debug)]
pub enum Quantity<T> {
    /// One number; the dataset has the shape T, with T rows.
    Number(fn(&T) -> f64),
    /// T×3.
    Vector(fn(&T) -> [f64; 3]),
    /// T×4.
    Quaternion(fn(&T) -> [f64; 4]),
}

/// Numbers of each of several places, by their index; `None` beyond the last.
#[derive(Debug)]
pub enum Quantities<T> {
    /// A vector of each.
    Vectors(fn(&T, usize) -> Option<[f64; 3]>),
    /// A number of each.
    Number(fn(&T, usize) -> Option<f64>),
    /// As many numbers of each as there are names.
    Named(&'static [&'static str], fn(&T, usize) -> Option<&[f64]>),
}

/// Components of a quantity: of the whole, or of one place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Components {
    /// One number.
    Number,
    /// x, y, z.
    Vector,
    /// w, x, y, z.
    Quaternion,
    /// One for each flexible mode.
    Modes,
    /// These.
    Named(&'static [&'static str]),
}

impl Components {
    /// Their names; none of one number, nor of modes, which have numbers from 1.
    pub const fn names(self) -> &'static [&'static str] {
        match self {
            Self::Number | Self::Modes => &[],
            Self::Vector => &["x", "y", "z"],
            Self::Quaternion => &["w", "x", "y", "z"],
            Self::Named(names) => names,
        }
    }
}

impl<T> Quantity<T> {
    pub(crate) fn append(&self, of: &T, out: &mut Vec<f64>) {
        match self {
            Self::Number(value) => out.push(value(of)),
            Self::Vector(values) => out.extend(values(of)),
            Self::Quaternion(values) => out.extend(values(of)),
        }
    }

    const fn components(&self) -> Components {
        match self {
            Self::Number(_) => Components::Number,
            Self::Vector(_) => Components::Vector,
            Self::Quaternion(_) => Components::Quaternion,
        }
    }
}

impl<T> Quantities<T> {
    pub(crate) fn append(&self, of: &T, places: usize, out: &mut Vec<f64>) {
        match self {
            Self::Vectors(values) => (0..places).map_while(|i| values(of, i)).for_each(|v| out.extend(v)),
            Self::Number(value) => out.extend((0..places).map_while(|i| value(of, i))),
            Self::Named(_, values) => (0..places).map_while(|i| values(of, i)).for_each(|v| out.extend(v)),
        }
    }

    /// True if there is a place of this index.
    pub(crate) fn has(&self, of: &T, place: usize) -> bool {
        match self {
            Self::Vectors(values) => values(of, place).is_some(),
            Self::Number(value) => value(of, place).is_some(),
            Self::Named(_, values) => values(of, place).is_some(),
        }
    }

    const fn components(&self) -> Components {
        match self {
            Self::Vectors(_) => Components::Vector,
            Self::Number(_) => Components::Number,
            Self::Named(names, _) => Components::Named(names),
        }
    }
}

impl<R: SystemRow> Column<R> {
    const fn new(
        [group, name]: [&'static str; 2],
        (dimension, frame): (Dimension, &'static str),
        description: &'static str,
        values: Values<R>,
    ) -> Self {
        Self { group, name, dimension, frame, description, values, part: None, other_part: None, role: Role::Output }
    }

    /// A column of the system, from its group and name, and its dimension and frame.
    pub const fn of_system(
        path: [&'static str; 2],
        kind: (Dimension, &'static str),
        description: &'static str,
        values: Quantity<R>,
    ) -> Self {
        Self::new(path, kind, description, Values::OfSystem(values))
    }

    /// A column of each body.
    pub const fn of_body(
        path: [&'static str; 2],
        kind: (Dimension, &'static str),
        description: &'static str,
        values: Quantity<R::Body>,
    ) -> Self {
        Self::new(path, kind, description, Values::OfBody(values))
    }

    /// A column of the modes of each body.
    pub const fn of_modes(
        name: &'static str,
        dimension: Dimension,
        description: &'static str,
        values: fn(&R::Body) -> &[f64],
    ) -> Self {
        Self::new(["modal", name], (dimension, "none"), description, Values::OfModes(values))
    }

    /// A column of the points of each body.
    pub const fn of_points(
        name: &'static str,
        kind: (Dimension, &'static str),
        description: &'static str,
        values: Quantities<R::Body>,
    ) -> Self {
        Self::new(["points", name], kind, description, Values::OfPoints(values))
    }

    /// A column of the supports of each body.
    pub const fn of_supports(
        name: &'static str,
        kind: (Dimension, &'static str),
        description: &'static str,
        values: Quantities<R::Body>,
    ) -> Self {
        Self::new(["supports", name], kind, description, Values::OfSupports(values))
    }

    /// A column of each joint.
    pub const fn of_joint(
        path: [&'static str; 2],
        kind: (Dimension, &'static str),
        description: &'static str,
        values: Quantity<R::Joint>,
    ) -> Self {
        Self::new(path, kind, description, Values::OfJoint(values))
    }

    /// The same of bodies or joints with this part only.
    #[must_use]
    pub const fn only_with(self, part: &'static str) -> Self {
        Self { part: Some(part), ..self }
    }

    /// The same of bodies or joints without this part only.
    #[must_use]
    pub const fn only_without(self, part: &'static str) -> Self {
        Self { other_part: Some(part), ..self }
    }

    /// The same in another role.
    #[must_use]
    pub const fn in_role(self, role: Role) -> Self {
        Self { role, ..self }
    }

    /// The objects that it has numbers of.
    pub const fn scope(&self) -> Scope {
        match self.values {
            Values::OfSystem(_) => Scope::System,
            Values::OfBody(_) | Values::OfModes(_) => Scope::Body,
            Values::OfPoints(_) => Scope::Point,
            Values::OfSupports(_) => Scope::Support,
            Values::OfJoint(_) => Scope::Joint,
        }
    }

    /// Components of its quantity.
    pub const fn components(&self) -> Components {
        match &self.values {
            Values::OfSystem(quantity) => quantity.components(),
            Values::OfBody(quantity) => quantity.components(),
            Values::OfModes(_) => Components::Modes,
            Values::OfPoints(quantities) | Values::OfSupports(quantities) => quantities.components(),
            Values::OfJoint(quantity) => quantity.components(),
        }
    }

    /// The unit in the labels of a run.
    pub fn unit(&self, units: &Units) -> String {
        units.in_labels(self.dimension.unit())
    }

    /// Its path without the body, such as "energy/work".
    pub fn path(&self) -> String {
        self.path_of(None)
    }

    /// The same of one place, such as "points/P1/velocity".
    pub fn path_of(&self, place: Option<&str>) -> String {
        let parts = [self.group, place.unwrap_or_default(), self.name];
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("/")
    }

    /// True if a body has histories of it.
    pub fn is_of(&self, body: &BodyMetadata) -> bool {
        !matches!(self.scope(), Scope::System | Scope::Joint) && self.is_of_parts(&body.parts)
    }

    /// True if a joint has histories of it.
    pub fn is_of_joint(&self, joint: &JointMetadata) -> bool {
        self.scope() == Scope::Joint && self.is_of_parts(&joint.parts)
    }

    fn is_of_parts(&self, parts: &[String]) -> bool {
        let has = |part| parts.iter().any(|has| has == part);
        self.part.is_none_or(has) && !self.other_part.is_some_and(has)
    }
}
