//! Writes a file that appears when it is whole.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use keys::Hash;
use whole_file::TemporaryFile;

use crate::array::{Number, little_endian};
use crate::error::SealedError;
use crate::file::SealedFile;
use crate::format::Format;
use crate::make::{Declared, Made, write_text};

/// A file of the format [`Format::BODY`] that is being written, beside its place: what was there before stays until
/// [`Writer::finish`].
#[derive(Debug)]
pub struct Writer {
    place: TemporaryFile,
    file: SealedFile,
    /// Datasets that have not been written, and second names.
    open: BTreeSet<String>,
    same: Vec<(String, String)>,
}

impl Writer {
    /// Makes a file with these texts and room for these datasets.
    ///
    /// # Errors
    /// [`SealedError::System`], [`SealedError::Hdf5`], [`SealedError::NameNotUtf8`].
    pub fn create(
        path: impl Into<PathBuf>,
        texts: BTreeMap<String, String>,
        datasets: &[Declared],
    ) -> Result<Self, SealedError> {
        Self::made(path.into(), &texts, datasets, |made| {
            made.by_hdf5(|file| {
                let written = texts.iter().try_for_each(|(name, text)| write_text(file, name, text));
                written.map_err(SealedError::hdf5(made.path, "write the texts of the file"))
            })
        })
    }

    /// The same without HDF5, for [`SealedFile`] alone.
    ///
    /// # Errors
    /// [`SealedError::System`].
    pub fn plain(
        path: impl Into<PathBuf>,
        texts: BTreeMap<String, String>,
        datasets: &[Declared],
    ) -> Result<Self, SealedError> {
        Self::made(path.into(), &texts, datasets, |made| made.plain())
    }

    fn made(
        path: PathBuf,
        texts: &BTreeMap<String, String>,
        datasets: &[Declared],
        make: impl FnOnce(Made<'_>) -> Result<SealedFile, SealedError>,
    ) -> Result<Self, SealedError> {
        let made = TemporaryFile::beside(&path, ".h5").map_err(SealedError::system(&path, "create the file"));
        let (_, place) = made?;
        let file = make(Made { place: &place, path: &path, format: Format::BODY, texts, datasets })?;
        let (same, own): (Vec<_>, Vec<_>) = datasets.iter().partition(|declared| declared.same_as.is_some());
        Ok(Self {
            place,
            file,
            open: own.into_iter().map(|declared| declared.path.clone()).collect(),
            same: same.into_iter().filter_map(|d| Some((d.path.clone(), d.same_as.clone()?))).collect(),
        })
    }

    /// Writes the numbers of a dataset.
    ///
    /// # Errors
    /// [`SealedError::Declared`] where that is not as declared, [`SealedError::System`].
    pub fn write<T: Number>(&mut self, dataset: &str, values: &[T]) -> Result<(), SealedError> {
        let path = self.file.path().to_owned();
        let otherwise = |what| SealedError::Declared { path, dataset: dataset.to_owned(), what };
        let Some((kind, shape, _)) = self.file.described(dataset).filter(|_| self.open.contains(dataset)) else {
            return Err(otherwise("it has no place, or has been written"));
        };
        if kind != T::KIND || shape.iter().product::<usize>() != values.len() {
            return Err(otherwise("there are more or fewer numbers, or of another kind"));
        }
        self.file.write_at(dataset, 0, values)?;
        self.file.seal(dataset, &Hash::of(&little_endian(values)));
        self.open.remove(dataset);
        Ok(())
    }

    /// Moves the file into its place, where an older one is replaced; `durable` waits until it is safe on the disk.
    ///
    /// # Errors
    /// [`SealedError::Declared`] where a dataset has not been written, [`SealedError::System`].
    pub fn finish(mut self, durable: bool) -> Result<(), SealedError> {
        let path = self.file.path().to_owned();
        if let Some(dataset) = self.open.pop_first() {
            return Err(SealedError::Declared { path, dataset, what: "it has not been written" });
        }
        self.same.into_iter().for_each(|(name, other)| self.file.name_again(name, &other));
        self.file.write_head()?;
        let synced = if durable { self.file.file().sync_all() } else { Ok(()) };
        synced.map_err(SealedError::system(&path, "write the file"))?;
        drop(self.file);
        self.place.put(&path, true).map_err(SealedError::system(&path, "put the file into its place"))
    }
}
