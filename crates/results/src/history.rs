//! Histories: the columns of a table as a file has them, for the system and for each of its bodies.

use crate::column::{Column, Components, Scope, SystemRow, Values};
use crate::metadata::{BodyMetadata, JointMetadata, Metadata};

/// Group of what is of all bodies together.
const SYSTEM: &str = "system";

/// A history in a file: a column, of the system, or of one of its bodies or joints.
#[derive(Debug)]
pub struct History<R: SystemRow + 'static> {
    /// The column.
    pub column: &'static Column<R>,
    /// Number of the body in [`Metadata::bodies`]; none for the system and for joints.
    pub body: Option<usize>,
    /// Number of the joint in [`Metadata::joints`]; none for the system and for bodies.
    pub joint: Option<usize>,
}

impl<R: SystemRow> Clone for History<R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R: SystemRow> Copy for History<R> {}

/// The histories of a file with this metadata, in their order: body after body, joint after joint, and then the
/// system.
pub fn histories<R: SystemRow>(
    columns: &'static [Column<R>],
    metadata: &Metadata,
) -> impl Iterator<Item = History<R>> + Clone {
    let of_system = columns.iter().filter(|column| column.scope() == Scope::System);
    let of_system = of_system.map(|column| History { column, body: None, joint: None });
    let of_joints = metadata.joints.iter().enumerate().flat_map(move |(i, joint)| {
        let of_joint = columns.iter().filter(move |column| column.is_of_joint(joint));
        of_joint.map(move |column| History { column, body: None, joint: Some(i) })
    });
    let of_bodies = metadata.bodies.iter().enumerate().flat_map(move |(i, body)| {
        let of_body = columns.iter().filter(move |column| column.is_of(body));
        of_body.map(move |column| History { column, body: Some(i), joint: None })
    });
    of_bodies.chain(of_joints).chain(of_system)
}

impl<R: SystemRow> History<R> {
    /// Its body, if it is of one.
    pub fn body<'m>(&self, metadata: &'m Metadata) -> Option<&'m BodyMetadata> {
        metadata.bodies.get(self.body?)
    }

    /// Its joint, if it is of one.
    pub fn joint<'m>(&self, metadata: &'m Metadata) -> Option<&'m JointMetadata> {
        metadata.joints.get(self.joint?)
    }

    /// Path of its dataset, such as "bodies/ring/energy/work".
    pub fn path(&self, metadata: &Metadata) -> String {
        self.path_of(metadata, None)
    }

    /// The same of one place, such as "bodies/ring/points/P1/velocity". This is no dataset of its own.
    pub fn path_of(&self, metadata: &Metadata, place: Option<&str>) -> String {
        let path = self.column.path_of(place);
        match (self.body(metadata), self.joint(metadata)) {
            (Some(body), _) => body.path(&path),
            (None, Some(joint)) => joint.path(&path),
            (None, None) => format!("{SYSTEM}/{path}"),
        }
    }

    /// Its path for people, or that of one of its places: without the body in a file of a single one.
    pub fn short_path_of(&self, metadata: &Metadata, place: Option<&str>) -> String {
        match self.body {
            Some(_) if metadata.only_body().is_some() => self.column.path_of(place),
            _ => self.path_of(metadata, place),
        }
    }

    /// The names of the points or supports that it has values of; none of one that is of a whole.
    pub fn places<'m>(&self, metadata: &'m Metadata) -> &'m [String] {
        let Some(body) = self.body(metadata) else { return &[] };
        match self.column.scope() {
            Scope::Point => &body.point_names,
            Scope::Support => &body.support_names,
            Scope::System | Scope::Body | Scope::Joint => &[],
        }
    }

    /// True if it has values of places.
    pub fn is_of_places(&self) -> bool {
        matches!(self.column.scope(), Scope::Point | Scope::Support)
    }

    /// Values of each place, or of the whole.
    pub fn values_of_each(&self, metadata: &Metadata) -> usize {
        match self.column.components() {
            Components::Number => 1,
            Components::Modes => self.body(metadata).map_or(0, |body| body.model.frequencies.len()),
            other => other.names().len(),
        }
    }

    /// Shape of a row's values: that of the dataset is T, the number of rows, and then this.
    pub fn row_shape(&self, metadata: &Metadata) -> Vec<usize> {
        let mut shape = Vec::new();
        if self.is_of_places() {
            shape.push(self.places(metadata).len());
        }
        if self.column.components() != Components::Number {
            shape.push(self.values_of_each(metadata));
        }
        shape
    }

    /// Values per row.
    pub fn width(&self, metadata: &Metadata) -> usize {
        self.row_shape(metadata).iter().product()
    }

    /// Appends the values that a row has.
    #[inline]
    pub fn append(&self, row: &R, metadata: &Metadata, out: &mut Vec<f64>) {
        let body = self.body.and_then(|i| row.bodies().get(i));
        match (&self.column.values, body) {
            (Values::OfSystem(quantity), _) => quantity.append(row, out),
            (Values::OfBody(quantity), Some(body)) => quantity.append(body, out),
            (Values::OfModes(values), Some(body)) => out.extend_from_slice(values(body)),
            (Values::OfPoints(quantities) | Values::OfSupports(quantities), Some(body)) => {
                quantities.append(body, self.places(metadata).len(), out);
            }
            (Values::OfJoint(quantity), _) => {
                if let Some(joint) = self.joint.and_then(|i| row.joints().get(i)) {
                    quantity.append(joint, out);
                }
            }
            (_, None) => {}
        }
    }

    /// Name of the value at `index` of a row, for messages.
    pub(crate) fn quantity(&self, metadata: &Metadata, index: usize) -> String {
        let place = index.checked_div(self.values_of_each(metadata)).and_then(|i| self.places(metadata).get(i));
        self.short_path_of(metadata, place.map(String::as_str))
    }

    /// True if a row has values of more points or supports than there are.
    pub(crate) fn has_more(&self, row: &R, metadata: &Metadata) -> bool {
        let places = self.places(metadata).len();
        match (&self.column.values, self.body.and_then(|i| row.bodies().get(i))) {
            (Values::OfPoints(quantities) | Values::OfSupports(quantities), Some(body)) => quantities.has(body, places),
            _ => false,
        }
    }
}
