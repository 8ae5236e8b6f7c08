//! Dense matrices as serde has them: their size and their entries, column after column, to the last bit.
//!
//! A field says `#[serde(with = "modal::as_data")]`: a matrix, or an array or an option of such.

use faer::Mat;
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A matrix, or several.
pub trait Matrices: Sized {
    /// The same as data.
    type Data: Serialize + DeserializeOwned;

    /// As data.
    fn to_data(&self) -> Self::Data;

    /// From data; `None` where these have too few or too many entries.
    fn of_data(data: Self::Data) -> Option<Self>;
}

impl Matrices for Mat<f64> {
    type Data = (usize, Vec<f64>);

    fn to_data(&self) -> Self::Data {
        (self.nrows(), self.col_iter().flat_map(|column| column.iter().copied()).collect())
    }

    fn of_data((rows, entries): Self::Data) -> Option<Self> {
        let columns = entries.len().checked_div(rows).unwrap_or_default();
        (rows.checked_mul(columns)? == entries.len())
            .then(|| Self::from_fn(rows, columns, |i, j| entries[rows * j + i]))
    }
}

impl<M: Matrices, const N: usize> Matrices for [M; N] {
    type Data = Vec<M::Data>;

    fn to_data(&self) -> Self::Data {
        self.iter().map(M::to_data).collect()
    }

    fn of_data(data: Self::Data) -> Option<Self> {
        data.into_iter().map(M::of_data).collect::<Option<Vec<_>>>()?.try_into().ok()
    }
}

impl<M: Matrices> Matrices for Option<M> {
    type Data = Option<M::Data>;

    fn to_data(&self) -> Self::Data {
        self.as_ref().map(M::to_data)
    }

    fn of_data(data: Self::Data) -> Option<Self> {
        match data {
            Some(data) => M::of_data(data).map(Some),
            None => Some(None),
        }
    }
}

/// Writes it.
///
/// # Errors
/// Errors of the serializer.
pub fn serialize<M: Matrices, S: Serializer>(matrices: &M, serializer: S) -> Result<S::Ok, S::Error> {
    matrices.to_data().serialize(serializer)
}

/// Reads it.
///
/// # Errors
/// Errors of the deserializer, and lists of entries that fill no matrix.
pub fn deserialize<'de, M: Matrices, D: Deserializer<'de>>(deserializer: D) -> Result<M, D::Error> {
    M::of_data(M::Data::deserialize(deserializer)?).ok_or_else(|| D::Error::custom("entries that fill no matrix"))
}
