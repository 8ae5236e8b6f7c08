//! The columns of a results file: data, from which the writer, the reader and the documentation are made.

use crate::{Metadata, Units};

/// A column of a results file: a time history. Rows are of type `R`.
///
/// A file has its columns in the order of their table. The first column must be the time.
#[derive(Debug)]
pub struct Column<R> {
    /// Path of the dataset, such as "energy/work".
    pub path: &'static str,
    /// Unit, such as "mass length/time": the three words stand for the labels of the run's units.
    pub unit: &'static str,
    /// Frame of the components, such as "global"; "none" for scalars.
    pub frame: &'static str,
    /// A sentence for people.
    pub description: &'static str,
    /// How a row gives its values.
    pub values: Values<R>,
    /// Part that a run must have for its file to have the column, one of [`Metadata::parts`]; all files have it if `None`.
    pub part: Option<&'static str>,
}

/// How a row gives the values of a column, which says also how many there are.
#[derive(Debug)]
pub enum Values<R> {
    /// One number; the dataset has the shape T, with T rows.
    Number(fn(&R) -> f64),
    /// T×3.
    Vector(fn(&R) -> [f64; 3]),
    /// T×4.
    Quaternion(fn(&R) -> [f64; 4]),
    /// T×nf: one number for each flexible mode.
    Modal(fn(&R) -> &[f64]),
    /// T×P×3: a vector of each of P points; `None` for a number beyond the last point.
    Points(fn(&R, usize) -> Option<[f64; 3]>),
    /// T×S×3: a vector of each of S supports; `None` for a number beyond the last.
    Supports(fn(&R, usize) -> Option<[f64; 3]>),
    /// T×P×n: n numbers of each point; one has the shape T×P.
    PointNumbers(usize, fn(&R, usize) -> Option<&[f64]>),
}

impl<R> Column<R> {
    /// A column.
    pub const fn new(
        path: &'static str,
        unit: &'static str,
        frame: &'static str,
        description: &'static str,
        values: Values<R>,
    ) -> Self {
        Self { path, unit, frame, description, values, part: None }
    }

    /// The same in the files of runs with this part only.
    #[must_use]
    pub const fn only_with(self, part: &'static str) -> Self {
        Self { part: Some(part), ..self }
    }

    /// The unit in the labels of a run.
    pub fn unit(&self, units: &Units) -> String {
        units.in_labels(self.unit)
    }

    /// Shape of a row's values: that of the dataset is T, the number of rows, and then this.
    pub fn row_shape(&self, metadata: &Metadata) -> Vec<usize> {
        match self.values {
            Values::Number(_) => Vec::new(),
            Values::Vector(_) => vec![3],
            Values::Quaternion(_) => vec![4],
            Values::Modal(_) => vec![metadata.body.frequencies.len()],
            Values::Points(_) | Values::Supports(_) => vec![self.places(metadata).len(), 3],
            Values::PointNumbers(1, _) => vec![metadata.point_names.len()],
            Values::PointNumbers(count, _) => vec![metadata.point_names.len(), count],
        }
    }

    /// True if the files of a run with this metadata have it.
    pub fn is_in(&self, metadata: &Metadata) -> bool {
        self.part.is_none_or(|part| metadata.parts.iter().any(|has| has == part))
    }

    /// Values per row.
    pub(crate) fn width(&self, metadata: &Metadata) -> usize {
        match self.values {
            Values::Number(_) => 1,
            Values::Vector(_) => 3,
            Values::Quaternion(_) => 4,
            Values::Modal(_) => metadata.body.frequencies.len(),
            Values::Points(_) | Values::Supports(_) | Values::PointNumbers(..) => {
                self.per_point() * self.places(metadata).len()
            }
        }
    }

    /// The names of the points or supports that it has values of; none of one that is of the whole body.
    pub fn places<'m>(&self, metadata: &'m Metadata) -> &'m [String] {
        match self.values {
            Values::Points(_) | Values::PointNumbers(..) => &metadata.point_names,
            Values::Supports(_) => &metadata.support_names,
            _ => &[],
        }
    }

    /// Appends the values that a row has.
    #[inline]
    pub fn append(&self, row: &R, metadata: &Metadata, out: &mut Vec<f64>) {
        let points = self.places(metadata).len();
        match self.values {
            Values::Number(value) => out.push(value(row)),
            Values::Vector(values) => out.extend(values(row)),
            Values::Quaternion(values) => out.extend(values(row)),
            Values::Modal(values) => out.extend_from_slice(values(row)),
            Values::Points(values) | Values::Supports(values) => {
                (0..points).map_while(|point| values(row, point)).for_each(|v| out.extend(v))
            }
            Values::PointNumbers(_, values) => {
                (0..points).map_while(|point| values(row, point)).for_each(|v| out.extend(v));
            }
        }
    }

    /// Name of the value at `index` of a row, for messages and readers.
    pub(crate) fn quantity(&self, metadata: &Metadata, index: usize) -> String {
        let point = index.checked_div(self.per_point()).and_then(|point| self.places(metadata).get(point));
        point.map_or_else(|| self.path.to_owned(), |name| of_point(self.path, name))
    }

    /// Values of each point or support; 0 of a column that is of the whole body.
    pub(crate) fn per_point(&self) -> usize {
        match self.values {
            Values::Points(_) | Values::Supports(_) => 3,
            Values::PointNumbers(count, _) => count,
            _ => 0,
        }
    }

    /// True if a row has values of more points or supports than there are.
    pub(crate) fn has_more(&self, row: &R, metadata: &Metadata) -> bool {
        let point = self.places(metadata).len();
        match self.values {
            Values::Points(values) | Values::Supports(values) => values(row, point).is_some(),
            Values::PointNumbers(_, values) => values(row, point).is_some(),
            _ => false,
        }
    }
}

/// Name of the history of one point: "points/P1/velocity" in the dataset "points/velocity".
pub(crate) fn of_point(path: &str, name: &str) -> String {
    match path.rsplit_once('/') {
        Some((group, quantity)) => format!("{group}/{name}/{quantity}"),
        None => format!("{name}/{path}"),
    }
}

/// The columns of a table that a file with this metadata has.
pub fn present<R>(
    columns: &'static [Column<R>],
    metadata: &Metadata,
) -> impl Iterator<Item = &'static Column<R>> + Clone {
    columns.iter().filter(|column| column.is_in(metadata))
}
