//! Values that are kept in files, as arrays by name.

use faer::{Mat, MatRef};
use keys::Hash;
use sealed::{Array, SealedError, SealedFile};

/// A value that is kept in a file.
pub(crate) trait Keep: Sized {
    /// Description that is read before it, such as its size.
    type Known<'k>: Copy;

    fn write(&self, to: &mut Arrays);

    /// # Errors
    /// [`SealedError::Damaged`] where the arrays are not those of such a value.
    fn read(from: &Kept<'_>, known: Self::Known<'_>) -> Result<Self, SealedError>;
}

/// Arrays that are to be written, with their names and shapes.
#[derive(Debug, Default)]
pub(crate) struct Arrays(pub Vec<(&'static str, Array<f64>)>);

impl Arrays {
    pub fn list(&mut self, name: &'static str, values: &[f64]) {
        self.0.push((name, Array { shape: vec![values.len()], values: values.to_vec() }));
    }

    /// A matrix (r×c), column by column (c×r).
    pub fn matrix(&mut self, name: &'static str, matrix: MatRef<'_, f64>) {
        self.0.push((name, Array { shape: vec![matrix.ncols(), matrix.nrows()], values: by_columns(matrix) }));
    }

    /// Matrices of one size, one after the other.
    pub fn matrices<'m>(&mut self, name: &'static str, matrices: impl IntoIterator<Item = &'m Mat<f64>>) {
        let values: Vec<f64> = matrices.into_iter().flat_map(|matrix| by_columns(matrix.as_ref())).collect();
        self.list(name, &values);
    }
}

pub(crate) fn by_columns(matrix: MatRef<'_, f64>) -> Vec<f64> {
    let mut values = Vec::with_capacity(matrix.nrows() * matrix.ncols());
    for column in matrix.col_iter() {
        match column.try_as_col_major() {
            Some(column) => values.extend_from_slice(column.as_slice()),
            None => values.extend(column.iter()),
        }
    }
    values
}

/// The path of the arrays of a value.
pub(crate) fn group(key: &Hash) -> String {
    format!("answers/{key}")
}

/// A value in a file.
pub(crate) struct Kept<'a> {
    pub file: &'a SealedFile,
    pub group: String,
}

impl Kept<'_> {
    /// As many numbers, or any where `None`; all are finite.
    pub fn list(&self, name: &str, length: Option<usize>) -> Result<Vec<f64>, SealedError> {
        let dataset = format!("{}/{name}", self.group);
        let values = self.file.read::<f64>(&dataset)?.values;
        if length.is_some_and(|length| length != values.len()) {
            return Err(self.damaged(format!("its dataset {dataset} has {} numbers", values.len())));
        }
        match values.iter().find(|value| !value.is_finite()) {
            Some(value) => Err(self.damaged(format!("its dataset {dataset} has a {value}"))),
            None => Ok(values),
        }
    }

    pub fn array<const N: usize>(&self, name: &str) -> Result<[f64; N], SealedError> {
        self.list(name, Some(N))?.try_into().map_err(|_| self.damaged(format!("its array {name} has another length")))
    }

    /// A matrix with as many rows and columns; any number of columns where `None`.
    pub fn matrix(&self, name: &str, rows: usize, columns: Option<usize>) -> Result<Mat<f64>, SealedError> {
        let values = self.list(name, columns.map(|columns| rows * columns))?;
        let columns = columns.unwrap_or_else(|| values.len().checked_div(rows).unwrap_or_default());
        if values.len() != rows * columns {
            return Err(self.damaged(format!("its array {name} has columns of another length")));
        }
        Ok(MatRef::from_column_major_slice(&values, rows, columns).to_owned())
    }

    /// As many square matrices of one size.
    pub fn matrices(&self, name: &str, count: usize, size: usize) -> Result<Vec<Mat<f64>>, SealedError> {
        let all = self.matrix(name, size, Some(count * size))?;
        Ok((0..count).map(|k| all.subcols(k * size, size).to_owned()).collect())
    }

    pub fn damaged(&self, what: String) -> SealedError {
        self.file.damaged(what)
    }
}

/// Fields and stresses, by their rows and columns.
impl Keep for Mat<f64> {
    type Known<'k> = [usize; 2];

    fn write(&self, to: &mut Arrays) {
        to.matrix("columns", self.as_ref());
    }

    fn read(from: &Kept<'_>, [rows, columns]: [usize; 2]) -> Result<Self, SealedError> {
        from.matrix("columns", rows, Some(columns))
    }
}

/// Lists, by their length.
impl Keep for Vec<f64> {
    type Known<'k> = usize;

    fn write(&self, to: &mut Arrays) {
        to.list("values", self);
    }

    fn read(from: &Kept<'_>, length: usize) -> Result<Self, SealedError> {
        from.list("values", Some(length))
    }
}

/// Square matrices, by their number and size.
impl Keep for Vec<Mat<f64>> {
    type Known<'k> = [usize; 2];

    fn write(&self, to: &mut Arrays) {
        to.matrices("matrices", self);
    }

    fn read(from: &Kept<'_>, [count, size]: [usize; 2]) -> Result<Self, SealedError> {
        from.matrices("matrices", count, size)
    }
}
