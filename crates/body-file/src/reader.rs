//! Reads a body file, without HDF5.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::array::{Array, Kind, Number, bytes};
use crate::error::BodyFileError;
use crate::head::Description;
use keys::Hash;

/// An open body file.
#[derive(Debug)]
pub struct BodyFile {
    path: PathBuf,
    file: File,
    description: Description,
}

impl BodyFile {
    /// Opens a file and reads its head.
    ///
    /// # Errors
    /// [`BodyFileError`]: no body file, of another version or machine, cut short, or damaged in its head.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, BodyFileError> {
        let path = path.into();
        let found = std::fs::metadata(&path).map_err(BodyFileError::system(&path, "open the file"))?;
        // To open a pipe is to wait for who writes into it.
        if !found.is_file() {
            return Err(BodyFileError::NotABody { path });
        }
        let file = File::open(&path).map_err(BodyFileError::system(&path, "open the file"))?;
        let description = Description::read(&file, &path)?;
        Ok(Self { path, file, description })
    }

    /// Its name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A text by its name.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.description.attributes.get(name).map(String::as_str)
    }

    /// The paths of its datasets, in alphabetical order.
    pub fn datasets(&self) -> impl Iterator<Item = &str> {
        self.description.datasets.keys().map(String::as_str)
    }

    /// True if it has a dataset.
    pub fn has(&self, dataset: &str) -> bool {
        self.description.datasets.contains_key(dataset)
    }

    /// The kind, the shape and the hash (in hexadecimal digits) of a dataset, without a look at its numbers.
    pub fn described(&self, dataset: &str) -> Option<(Kind, &[usize], &str)> {
        let place = self.description.datasets.get(dataset)?;
        Some((place.kind, &place.shape, &place.hash))
    }

    /// The texts by name.
    pub fn attributes(&self) -> &BTreeMap<String, String> {
        &self.description.attributes
    }

    /// Reads a dataset, whose content must be what was written.
    ///
    /// # Errors
    /// [`BodyFileError::Missing`], [`BodyFileError::Damaged`] (also where its numbers are of another kind),
    /// [`BodyFileError::System`].
    pub fn read<T: Number>(&self, dataset: &str) -> Result<Array<T>, BodyFileError> {
        let path = || self.path.clone();
        let Some(place) = self.description.datasets.get(dataset) else {
            return Err(BodyFileError::Missing { path: path(), dataset: dataset.to_owned() });
        };
        let damaged = |what: String| BodyFileError::Damaged { path: path(), what };
        let count = match bytes(place.kind, &place.shape) {
            Some(bytes) if place.kind == T::KIND => bytes as usize / size_of::<T>(),
            _ => return Err(damaged(format!("its dataset {dataset} has numbers of another kind"))),
        };
        let mut values = Vec::new();
        let room = values.try_reserve_exact(count);
        room.map_err(|_| BodyFileError::system(&self.path, "read the file")(std::io::ErrorKind::OutOfMemory.into()))?;
        values.resize(count, T::zeroed());
        let mut file = &self.file;
        if count > 0 {
            file.seek(SeekFrom::Start(place.start))
                .and_then(|_| file.read_exact(bytemuck::cast_slice_mut(&mut values)))
                .map_err(BodyFileError::system(&self.path, "read the file"))?;
        }
        if Hash::of(&values).to_string() != place.hash {
            return Err(damaged(format!("its dataset {dataset} has been changed")));
        }
        Ok(Array { shape: place.shape.clone(), values })
    }
}
