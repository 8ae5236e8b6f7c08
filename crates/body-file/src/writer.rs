//! Writes a body file, which HDF5 makes, or a plain one.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use hdf5::dataset::Layout;
use hdf5::plist::dataset_create::{AllocTime, FillTime};
use hdf5::types::VarLenUnicode;
use whole_file::TemporaryFile;

use crate::array::{Kind, Number, bytes};
use crate::error::BodyFileError;
use crate::head::{Description, StoredArray};
use keys::Hash;

/// A dataset that is going to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Declared {
    /// Its path, with `/` between the names of groups.
    pub path: String,
    /// The kind of its numbers.
    pub kind: Kind,
    /// Its length along each index; empty for a single number.
    pub shape: Vec<usize>,
    /// HDF5 attributes: names and texts, such as the unit.
    pub attributes: Vec<(&'static str, String)>,
    /// Another dataset, declared before, which this one is a second name of: it has no numbers of its own.
    pub same_as: Option<String>,
}

/// A file that is being written, beside its place: what was there before stays until [`Writer::finish`].
#[derive(Debug)]
pub struct Writer {
    path: PathBuf,
    place: TemporaryFile,
    file: File,
    description: Description,
    /// Datasets that have not been written, and second names.
    open: BTreeSet<String>,
    same: Vec<(String, String)>,
}

/// The first byte of each dataset that is not empty.
type Starts = Vec<(String, u64)>;

impl Writer {
    /// Makes a file with these texts and room for these datasets.
    ///
    /// # Errors
    /// [`BodyFileError::System`], [`BodyFileError::Hdf5`], [`BodyFileError::NameNotUtf8`].
    pub fn create(
        path: impl Into<PathBuf>,
        attributes: BTreeMap<String, String>,
        datasets: &[Declared],
    ) -> Result<Self, BodyFileError> {
        let path = path.into();
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // HDF5 is given names as text.
        if folder.to_str().is_none() {
            return Err(BodyFileError::NameNotUtf8 { path: folder.to_owned() });
        }
        Self::made_by(make, path, attributes, datasets)
    }

    /// The same without HDF5, for [`BodyFile`](crate::BodyFile) alone.
    ///
    /// # Errors
    /// [`BodyFileError::System`].
    pub fn plain(
        path: impl Into<PathBuf>,
        attributes: BTreeMap<String, String>,
        datasets: &[Declared],
    ) -> Result<Self, BodyFileError> {
        Self::made_by(lay_out, path.into(), attributes, datasets)
    }

    fn made_by(
        make: fn(&Path, &Path, &Description, &[Declared]) -> Result<Starts, BodyFileError>,
        path: PathBuf,
        attributes: BTreeMap<String, String>,
        datasets: &[Declared],
    ) -> Result<Self, BodyFileError> {
        let made = TemporaryFile::beside(&path, ".h5");
        let (_, place) = made.map_err(BodyFileError::system(&path, "create the file"))?;

        let longest = |declared: &Declared| StoredArray {
            kind: declared.kind,
            shape: declared.shape.clone(),
            start: u64::MAX,
            hash: "0".repeat(64),
        };
        let mut description = Description {
            attributes,
            datasets: datasets.iter().map(|declared| (declared.path.clone(), longest(declared))).collect(),
        };
        let starts = make(&place, &path, &description, datasets)?;
        for (name, start) in starts {
            if let Some(place) = description.datasets.get_mut(&name) {
                place.start = start;
            }
        }
        let file = OpenOptions::new().read(true).write(true).open(&place);
        let file = file.map_err(BodyFileError::system(&path, "open the file for writing"))?;
        let (same, own): (Vec<_>, Vec<_>) = datasets.iter().partition(|declared| declared.same_as.is_some());
        Ok(Self {
            path,
            place,
            file,
            description,
            open: own.into_iter().map(|declared| declared.path.clone()).collect(),
            same: same.into_iter().filter_map(|d| Some((d.path.clone(), d.same_as.clone()?))).collect(),
        })
    }

    /// Writes the numbers of a dataset.
    ///
    /// # Errors
    /// [`BodyFileError::Declared`] where that is not as declared, [`BodyFileError::System`].
    pub fn write<T: Number>(&mut self, dataset: &str, values: &[T]) -> Result<(), BodyFileError> {
        let otherwise =
            |path: &Path, what| BodyFileError::Declared { path: path.to_owned(), dataset: dataset.to_owned(), what };
        let Some(place) = self.description.datasets.get_mut(dataset).filter(|_| self.open.contains(dataset)) else {
            return Err(otherwise(&self.path, "it has no place, or has been written"));
        };
        if place.kind != T::KIND || place.shape.iter().product::<usize>() != values.len() {
            return Err(otherwise(&self.path, "there are more or fewer numbers, or of another kind"));
        }
        place.hash = Hash::of(values).to_string();
        if values.is_empty() {
            place.start = 0;
        } else {
            let mut file = &self.file;
            file.seek(SeekFrom::Start(place.start))
                .and_then(|_| file.write_all(bytemuck::cast_slice(values)))
                .map_err(BodyFileError::system(&self.path, "write the file"))?;
        }
        self.open.remove(dataset);
        Ok(())
    }

    /// Moves the file into its place, where an older one is replaced; `durable` waits until it is safe on the disk.
    ///
    /// # Errors
    /// [`BodyFileError::Declared`] where a dataset has not been written, [`BodyFileError::System`].
    pub fn finish(mut self, durable: bool) -> Result<(), BodyFileError> {
        if let Some(dataset) = self.open.pop_first() {
            return Err(BodyFileError::Declared { path: self.path, dataset, what: "it has not been written" });
        }
        for (name, other) in self.same {
            if let Some(place) = self.description.datasets.get(&other).cloned() {
                self.description.datasets.insert(name, place);
            }
        }
        let written = self.description.write(&self.file);
        let written = if durable { written.and_then(|()| self.file.sync_all()) } else { written };
        written.map_err(BodyFileError::system(&self.path, "write the file"))?;
        drop(self.file);
        let put = self.place.put(&self.path, true);
        put.map_err(BodyFileError::system(&self.path, "put the file into its place"))
    }
}

/// Makes room in the file at `place` for the head and the datasets, one after the other; gives what [`make`] does.
fn lay_out(
    place: &Path,
    path: &Path,
    description: &Description,
    datasets: &[Declared],
) -> Result<Starts, BodyFileError> {
    let mut end = description.user_block();
    let own = datasets.iter().filter(|declared| declared.same_as.is_none());
    let starts = own
        .map(|Declared { path, kind, shape, .. }| {
            let start = end.next_multiple_of(8);
            end = start + bytes(*kind, shape).unwrap_or_default();
            (path.clone(), start)
        })
        .collect();
    let made = File::create(place).and_then(|file| file.set_len(end));
    made.map_err(BodyFileError::system(path, "create the file"))?;
    Ok(starts)
}

/// Makes the file at `place` (called `path` in messages) and closes it. Gives the first byte of each dataset that is not
/// empty.
fn make(place: &Path, path: &Path, description: &Description, datasets: &[Declared]) -> Result<Starts, BodyFileError> {
    let mut builder = hdf5::File::with_options();
    // Without times of creation, so that equal bodies give equal files.
    builder.with_fcpl(|plist| plist.obj_track_times(false).userblock(description.user_block()));
    // HDF5 would lock the file, and a process that is started meanwhile would keep the lock to its end.
    builder.with_fapl(|plist| plist.alignment(1, 8).file_locking(false));
    let file = builder.create(place).map_err(BodyFileError::hdf5(path, "create the file"))?;
    for (name, text) in &description.attributes {
        write_text(&file, name, text).map_err(BodyFileError::hdf5(path, format!("write the attribute {name}")))?;
    }
    let mut starts = Vec::with_capacity(datasets.len());
    for declared in datasets {
        let start = make_dataset(&file, declared)
            .map_err(BodyFileError::hdf5(path, format!("make the dataset {}", declared.path)))?;
        starts.push((declared.path.clone(), start));
    }
    file.close().map_err(BodyFileError::hdf5(path, "write the file"))?;
    Ok(starts)
}

fn make_dataset(file: &hdf5::File, declared: &Declared) -> hdf5::Result<u64> {
    if let Some(other) = &declared.same_as {
        if let Some((group, _)) = declared.path.rsplit_once('/')
            && !file.link_exists(group)
        {
            file.create_group(group)?;
        }
        file.link_hard(other, &declared.path)?;
        return Ok(0);
    }
    let dataset = match declared.kind {
        Kind::F64 => room::<f64>(file, declared),
        Kind::U64 => room::<u64>(file, declared),
        Kind::U32 => room::<u32>(file, declared),
    }?;
    for (name, text) in &declared.attributes {
        write_text(&dataset, name, text)?;
    }
    Ok(dataset.offset().unwrap_or(0))
}

fn room<T: hdf5::H5Type>(file: &hdf5::File, declared: &Declared) -> hdf5::Result<hdf5::Dataset> {
    let builder = file
        .new_dataset::<T>()
        .layout(Layout::Contiguous)
        .alloc_time(Some(AllocTime::Early))
        .fill_time(FillTime::Never)
        .obj_track_times(false);
    match &declared.shape[..] {
        [] => builder.create(declared.path.as_str()),
        shape => builder.shape(shape).create(declared.path.as_str()),
    }
}

/// A variable-length UTF-8 string, which h5py reads as `str`; it ends where it has a NUL.
fn write_text(owner: &hdf5::Location, name: &str, text: &str) -> hdf5::Result<()> {
    let text = text.split('\0').next().unwrap_or_default();
    let value: VarLenUnicode = text.parse().map_err(|error| hdf5::Error::from(format!("{error}")))?;
    owner.new_attr::<VarLenUnicode>().create(name).and_then(|attribute| attribute.write_scalar(&value))
}
