//! The columns of a results file: data, from which the writer, the reader and the documentation are made.

use crate::Units;
use crate::points::Points;

/// What stands for the name of a point in the path of a column.
const NAME: &str = "<name>";

/// A column of a results file: a time history, or one of each point. Rows are of type `R`.
///
/// A file has its columns in the order of their table, those of the points after the others, point by point. The first
/// column must be the time.
#[derive(Debug)]
pub struct Column<R> {
    /// Path of the dataset, such as "energy/work". In the column of a point, `<name>` stands for the point's name.
    pub path: &'static str,
    /// Unit, such as "mass length/time": the three words stand for the labels of the run's units.
    pub unit: &'static str,
    /// Frame of the components, such as "global"; "none" for scalars.
    pub frame: &'static str,
    /// A sentence for people.
    pub description: &'static str,
    /// How a row gives its values.
    pub values: Values<R>,
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
    /// T×3 for each point; `None` for a number beyond the last point.
    Point(fn(&R, usize) -> Option<[f64; 3]>),
    /// So many numbers for each point, only in files with the stress of points. One number has the shape T.
    Stress(usize, fn(&R, usize) -> Option<&[f64]>),
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
        Self { path, unit, frame, description, values }
    }

    /// The unit in the labels of a run.
    pub fn unit(&self, units: &Units) -> String {
        let is_no_letter = |c: char| !c.is_ascii_lowercase();
        let replaced = self.unit.split_inclusive(is_no_letter).map(|piece| {
            let word = piece.trim_end_matches(is_no_letter);
            let label = match word {
                "length" => &units.length,
                "mass" => &units.mass,
                "time" => &units.time,
                other => other,
            };
            label.to_owned() + &piece[word.len()..]
        });
        replaced.collect()
    }

    /// Values per row; `None` for one number (shape T instead of T×width).
    pub fn width(&self, modes: usize) -> Option<usize> {
        match self.values {
            Values::Number(_) => None,
            Values::Vector(_) | Values::Point(_) => Some(3),
            Values::Quaternion(_) => Some(4),
            Values::Modal(_) => Some(modes),
            Values::Stress(width, _) => Some(width).filter(|width| *width > 1),
        }
    }

    fn is_of_points(&self) -> bool {
        matches!(self.values, Values::Point(_) | Values::Stress(..))
    }
}

/// A dataset of a file: a column, of one of the points where it is a column of points.
#[derive(Debug)]
pub(crate) struct History<R: 'static> {
    pub column: &'static Column<R>,
    point: usize,
}

/// All histories of a file with these points, in their order.
pub(crate) fn histories<R>(columns: &'static [Column<R>], points: Points) -> impl Iterator<Item = History<R>> + Clone {
    let of_body = columns.iter().filter(|column| !column.is_of_points());
    let is_there = move |column: &&Column<R>| match column.values {
        Values::Stress(..) => points.stress,
        _ => column.is_of_points(),
    };
    let of_point = move || columns.iter().filter(is_there);
    let of_points = (0..points.count).flat_map(move |point| of_point().map(move |column| History { column, point }));
    of_body.map(|column| History { column, point: 0 }).chain(of_points)
}

/// Values per row of all histories.
pub(crate) fn widths<R>(
    columns: &'static [Column<R>],
    modes: usize,
    points: Points,
) -> impl Iterator<Item = usize> + Clone {
    histories(columns, points).map(move |history| history.width(modes))
}

impl<R> History<R> {
    /// Path of the dataset.
    pub(crate) fn path(&self, point_names: &[String]) -> String {
        match point_names.get(self.point) {
            Some(name) => self.column.path.replace(NAME, name),
            None => self.column.path.to_owned(),
        }
    }

    /// Values per row.
    pub(crate) fn width(&self, modes: usize) -> usize {
        self.column.width(modes).unwrap_or(1)
    }

    /// Appends the values that a row has.
    pub(crate) fn append(&self, row: &R, out: &mut Vec<f64>) {
        match self.column.values {
            Values::Number(value) => out.push(value(row)),
            Values::Vector(values) => out.extend(values(row)),
            Values::Quaternion(values) => out.extend(values(row)),
            Values::Modal(values) => out.extend(values(row)),
            Values::Point(values) => out.extend(values(row, self.point).into_iter().flatten()),
            Values::Stress(_, values) => out.extend(values(row, self.point).into_iter().flatten()),
        }
    }
}
