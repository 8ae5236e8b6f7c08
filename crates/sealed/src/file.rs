//! An open sealed file, read and written in place without HDF5.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use keys::{Hash, HashedReader};

use crate::array::{Array, Kind, Number, little_endian};
use crate::error::SealedError;
use crate::format::Format;
use crate::head::{Description, StoredArray};

/// An open sealed file.
#[derive(Debug)]
pub struct SealedFile {
    path: PathBuf,
    format: &'static Format,
    file: File,
    description: Description,
}

impl SealedFile {
    /// Opens a file and reads its head.
    ///
    /// # Errors
    /// [`SealedError`]: no file of this format, of another version, cut short, or damaged in its head or structure.
    pub fn open(path: impl Into<PathBuf>, format: &'static Format) -> Result<Self, SealedError> {
        let path = path.into();
        let failed = |error| SealedError::system(&path, "open the file")(error);
        // To open a pipe is to wait for who writes into it.
        if !std::fs::metadata(&path).map_err(failed)?.is_file() {
            return Err(SealedError::NoSeal { path, format });
        }
        let file = File::open(&path).map_err(failed)?;
        Self::of(file, path, format)
    }

    /// The same of an open file, called `path` in messages.
    ///
    /// # Errors
    /// As [`SealedFile::open`].
    pub fn of(file: File, path: impl Into<PathBuf>, format: &'static Format) -> Result<Self, SealedError> {
        let path = path.into();
        let description = Description::read(&file, &path, format)?;
        Ok(Self { path, format, file, description })
    }

    /// One that has just been made.
    pub(crate) fn made(file: File, path: &Path, format: &'static Format, description: Description) -> Self {
        Self { path: path.to_owned(), format, file, description }
    }

    /// Its name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file itself.
    pub fn file(&self) -> &File {
        &self.file
    }

    /// A text by its name.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.description.texts.get(name).map(String::as_str)
    }

    /// The texts by name.
    pub fn texts(&self) -> &BTreeMap<String, String> {
        &self.description.texts
    }

    /// The paths of its datasets, in alphabetical order.
    pub fn datasets(&self) -> impl Iterator<Item = &str> {
        self.description.datasets.keys().map(String::as_str)
    }

    /// True if it has a dataset.
    pub fn has(&self, dataset: &str) -> bool {
        self.description.datasets.contains_key(dataset)
    }

    /// The kind, the shape and the hash (in hexadecimal digits; none while its numbers change) of a dataset, without a look at its
    /// numbers.
    pub fn described(&self, dataset: &str) -> Option<(Kind, &[usize], Option<&str>)> {
        let place = self.description.datasets.get(dataset)?;
        Some((place.kind, &place.shape, place.hash.as_deref()))
    }

    /// Reads a dataset, whose content must be what was sealed.
    ///
    /// # Errors
    /// [`SealedError::Damaged`] (also without the dataset, and where its numbers are of another kind),
    /// [`SealedError::System`].
    pub fn read<T: Number>(&self, dataset: &str) -> Result<Array<T>, SealedError> {
        let place = self.place::<T>(dataset)?;
        let values = self.read_first(dataset, usize::MAX)?;
        if place.hash.as_ref().is_some_and(|hash| *hash != Hash::of(&little_endian(&values)).to_string()) {
            return Err(self.changed(dataset));
        }
        Ok(Array { shape: place.shape.clone(), values })
    }

    /// Reads the first numbers of a dataset, without a look at its seal; all of them, where there are no more.
    ///
    /// # Errors
    /// As [`SealedFile::read`].
    pub fn read_first<T: Number>(&self, dataset: &str, count: usize) -> Result<Vec<T>, SealedError> {
        let place = self.place::<T>(dataset)?;
        let failed = |error| SealedError::system(&self.path, format!("read {dataset}"))(error);
        let count = place.shape.iter().product::<usize>().min(count);
        let mut values = Vec::new();
        values.try_reserve_exact(count).map_err(|_| failed(io::ErrorKind::OutOfMemory.into()))?;
        values.resize(count, T::zeroed());
        if count > 0 {
            let mut file = &self.file;
            file.seek(SeekFrom::Start(place.start))
                .and_then(|_| file.read_exact(bytemuck::cast_slice_mut(&mut values)))
                .map_err(failed)?;
        }
        if cfg!(target_endian = "big") {
            values.iter_mut().for_each(|value| *value = value.swapped());
        }
        Ok(values)
    }

    /// Writes numbers of a dataset from its number `first` on.
    ///
    /// # Errors
    /// [`SealedError::Declared`] where there are more than it has room for, [`SealedError::Damaged`], [`SealedError::System`].
    pub fn write_at<T: Number>(&self, dataset: &str, first: usize, values: &[T]) -> Result<(), SealedError> {
        let place = self.place::<T>(dataset)?;
        if place.shape.iter().product::<usize>() < first + values.len() {
            return Err(self.no_room(dataset));
        }
        let mut file = &self.file;
        file.seek(SeekFrom::Start(place.start + (first * size_of::<T>()) as u64))
            .and_then(|_| file.write_all(&little_endian(values)))
            .map_err(SealedError::system(&self.path, format!("write {dataset}")))
    }

    /// Copies the first numbers of a dataset of the same name in another file, of `bytes` bytes: all of them, where they are
    /// sealed. Gives their hash.
    ///
    /// # Errors
    /// As [`SealedFile::write_at`].
    pub fn copy_from(&self, other: &Self, dataset: &str, bytes: u64) -> Result<Hash, SealedError> {
        let [to, from] = [self, other].map(|file| file.description.datasets.get(dataset));
        let (Some(to), Some(from)) = (to, from) else { return Err(self.missing(dataset)) };
        if [to, from].iter().any(|place| place.range().is_none_or(|range| range.end - range.start < bytes)) {
            return Err(self.no_room(dataset));
        }
        let failed = |error| SealedError::system(&self.path, format!("copy {dataset}"))(error);
        let (mut to_file, mut from_file) = (&self.file, &other.file);
        from_file.seek(SeekFrom::Start(from.start)).map_err(failed)?;
        to_file.seek(SeekFrom::Start(to.start)).map_err(failed)?;
        let mut reader = HashedReader::new(from_file.take(bytes));
        if io::copy(&mut reader, &mut to_file).map_err(failed)? != bytes {
            return Err(failed(io::ErrorKind::UnexpectedEof.into()));
        }
        let hash = reader.so_far();
        match &from.hash {
            Some(expected) if *expected != hash.to_string() => Err(other.changed(dataset)),
            _ => Ok(hash),
        }
    }

    /// Seals the numbers of a dataset: from now on they must have this hash. The head has to be written.
    pub fn seal(&mut self, dataset: &str, hash: &Hash) {
        if let Some(place) = self.description.datasets.get_mut(dataset) {
            place.hash = Some(hash.to_string());
            if place.shape.contains(&0) {
                place.start = 0;
            }
        }
    }

    /// A second name of a dataset.
    pub(crate) fn name_again(&mut self, name: String, dataset: &str) {
        if let Some(place) = self.description.datasets.get(dataset).cloned() {
            self.description.datasets.insert(name, place);
        }
    }

    /// Writes the head: the seal of the file as it is now.
    ///
    /// # Errors
    /// [`SealedError::System`].
    pub fn write_head(&self) -> Result<(), SealedError> {
        let written = self.description.write(&self.file, self.format);
        written.map_err(SealedError::system(&self.path, "write the seal of the file"))
    }

    /// The error of a content that is not what it should be.
    pub fn damaged(&self, what: impl Into<String>) -> SealedError {
        SealedError::Damaged { path: self.path.clone(), format: self.format, what: what.into() }
    }

    fn changed(&self, dataset: &str) -> SealedError {
        self.damaged(format!("its dataset {dataset} has been changed"))
    }

    fn missing(&self, dataset: &str) -> SealedError {
        self.damaged(format!("it has no dataset {dataset}"))
    }

    fn no_room(&self, dataset: &str) -> SealedError {
        let (path, dataset) = (self.path.clone(), dataset.to_owned());
        SealedError::Declared { path, dataset, what: "there is no room for all its numbers" }
    }

    fn place<T: Number>(&self, dataset: &str) -> Result<&StoredArray, SealedError> {
        match self.description.datasets.get(dataset) {
            Some(place) if place.kind == T::KIND => Ok(place),
            Some(_) => Err(self.damaged(format!("its dataset {dataset} has numbers of another kind"))),
            None => Err(self.missing(dataset)),
        }
    }
}
