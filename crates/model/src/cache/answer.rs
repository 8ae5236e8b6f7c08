//! Answers of the finite-element model as arrays, as they are kept in files.

use body_file::{Array, BodyFile, BodyFileError};
use faer::{Mat, MatRef};

/// Arrays by name.
#[derive(Debug, Default)]
pub(crate) struct Answer {
    pub numbers: Vec<(String, Array<f64>)>,
    pub counts: Vec<(String, Array<u64>)>,
}

impl Answer {
    pub fn with_numbers(mut self, name: impl Into<String>, shape: &[usize], values: Vec<f64>) -> Self {
        self.numbers.push((name.into(), Array { shape: shape.to_vec(), values }));
        self
    }

    pub fn with_list(self, name: impl Into<String>, values: &[f64]) -> Self {
        self.with_numbers(name, &[values.len()], values.to_vec())
    }

    pub fn with_counts(mut self, name: impl Into<String>, values: &[u64]) -> Self {
        self.counts.push((name.into(), Array { shape: vec![values.len()], values: values.to_vec() }));
        self
    }

    /// Displacements or forces (3n×k), one after the other (k×n×3).
    pub fn with_fields(self, name: impl Into<String>, fields: MatRef<'_, f64>) -> Self {
        let shape = [fields.ncols(), fields.nrows() / 3, 3];
        self.with_numbers(name, &shape, by_columns(fields))
    }

    /// A matrix (r×c), column by column (c×r).
    pub fn with_matrix(self, name: impl Into<String>, matrix: MatRef<'_, f64>) -> Self {
        let shape = [matrix.ncols(), matrix.nrows()];
        self.with_numbers(name, &shape, by_columns(matrix))
    }

    /// Matrices of one size (each r×c), each column by column (k×c×r).
    pub fn with_matrices<'m>(self, name: impl Into<String>, matrices: impl IntoIterator<Item = &'m Mat<f64>>) -> Self {
        let (mut count, mut size, mut values) = (0, (0, 0), Vec::new());
        for matrix in matrices {
            count += 1;
            size = (matrix.ncols(), matrix.nrows());
            values.extend(by_columns(matrix.as_ref()));
        }
        self.with_numbers(name, &[count, size.0, size.1], values)
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

/// The path of the arrays of an answer.
pub(crate) fn group(question: &keys::Hash) -> String {
    format!("answers/{question}")
}

/// An answer in a file.
pub(crate) struct Kept<'a> {
    pub file: &'a BodyFile,
    pub group: String,
}

impl Kept<'_> {
    /// The numbers of an array whose shape is this one, where `None` is any length.
    pub fn numbers(&self, name: &str, shape: &[Option<usize>]) -> Result<Array<f64>, BodyFileError> {
        let dataset = format!("{}/{name}", self.group);
        let array: Array<f64> = self.file.read(&dataset)?;
        let fits = |(found, expected): (&usize, &Option<usize>)| expected.is_none_or(|expected| expected == *found);
        if array.shape.len() != shape.len() || !array.shape.iter().zip(shape).all(fits) {
            return Err(self.damaged(format!("its dataset {dataset} has the shape {:?}", array.shape)));
        }
        if let Some(value) = array.values.iter().find(|value| !value.is_finite()) {
            return Err(self.damaged(format!("its dataset {dataset} has a {value}")));
        }
        Ok(array)
    }

    pub fn list(&self, name: &str, length: Option<usize>) -> Result<Vec<f64>, BodyFileError> {
        Ok(self.numbers(name, &[length])?.values)
    }

    pub fn array<const N: usize>(&self, name: &str) -> Result<[f64; N], BodyFileError> {
        let values = self.list(name, Some(N))?;
        values.try_into().map_err(|_| self.damaged(format!("its dataset {}/{name} has another length", self.group)))
    }

    pub fn counts<const N: usize>(&self, name: &str) -> Result<[u64; N], BodyFileError> {
        let array: Array<u64> = self.file.read(&format!("{}/{name}", self.group))?;
        let values = array.values.try_into();
        values.map_err(|_| self.damaged(format!("its dataset {}/{name} has another length", self.group)))
    }

    /// See [`Answer::with_fields`]; `rows` is 3n.
    pub fn fields(&self, name: &str, rows: usize, columns: Option<usize>) -> Result<Mat<f64>, BodyFileError> {
        let Array { shape, values } = self.numbers(name, &[columns, Some(rows / 3), Some(3)])?;
        Ok(MatRef::from_column_major_slice(&values, rows, shape[0]).to_owned())
    }

    /// See [`Answer::with_matrix`].
    pub fn matrix(&self, name: &str, rows: Option<usize>, columns: Option<usize>) -> Result<Mat<f64>, BodyFileError> {
        let Array { shape, values } = self.numbers(name, &[columns, rows])?;
        Ok(MatRef::from_column_major_slice(&values, shape[1], shape[0]).to_owned())
    }

    /// See [`Answer::with_matrices`]; square ones.
    pub fn matrices(&self, name: &str, count: usize, size: usize) -> Result<Vec<Mat<f64>>, BodyFileError> {
        let values = self.numbers(name, &[Some(count), None, None])?.values;
        if values.len() != count * size * size {
            return Err(self.damaged(format!("its dataset {}/{name} has matrices of another size", self.group)));
        }
        let each = size * size;
        let matrix =
            |k: usize| MatRef::from_column_major_slice(&values[k * each..(k + 1) * each], size, size).to_owned();
        Ok((0..count).map(matrix).collect())
    }

    pub fn damaged(&self, what: String) -> BodyFileError {
        BodyFileError::Damaged { path: self.file.path().to_owned(), what }
    }
}
