//! Makes sealed files: a structure with room for datasets.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

use hdf5::dataset::Layout;
use hdf5::plist::dataset_create::{AllocTime, FillTime};
use hdf5::types::VarLenUnicode;

use crate::array::{Kind, bytes};
use crate::error::SealedError;
use crate::file::SealedFile;
use crate::format::Format;
use crate::head::{Description, StoredArray};

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

impl Declared {
    /// One with numbers of its own, with its unit, its frame and what it is.
    pub fn new(path: impl Into<String>, kind: Kind, shape: &[usize], [unit, frame, what]: [&str; 3]) -> Self {
        let attributes = vec![("unit", unit.to_owned()), ("frame", frame.to_owned()), ("description", what.to_owned())];
        Self { path: path.into(), kind, shape: shape.to_vec(), attributes, same_as: None }
    }
}

/// The first byte of each dataset that has numbers of its own, 0 where it is empty.
type Starts = Vec<(String, u64)>;

/// A place for a file, its name in messages, and what it is.
#[derive(Debug, Clone, Copy)]
pub struct Made<'a> {
    /// Where it is made.
    pub place: &'a Path,
    /// Its name in messages.
    pub path: &'a Path,
    /// Its format.
    pub format: &'static Format,
    /// Texts by name.
    pub texts: &'a BTreeMap<String, String>,
    /// Its datasets.
    pub datasets: &'a [Declared],
}

impl Made<'_> {
    /// Makes the file by HDF5, with what else it is to have for other programs, without a seal.
    ///
    /// # Errors
    /// [`SealedError::System`], [`SealedError::Hdf5`], [`SealedError::NameNotUtf8`].
    pub fn by_hdf5<E: From<SealedError>>(
        self,
        more: impl FnOnce(&hdf5::File) -> Result<(), E>,
    ) -> Result<SealedFile, E> {
        let Self { place, path, .. } = self;
        // HDF5 is given names as text.
        if place.to_str().is_none() {
            return Err(SealedError::NameNotUtf8 { path: place.parent().unwrap_or(place).to_owned() }.into());
        }
        self.laid_out(|description| {
            let failed = |error: SealedError| error.with_reason_from_system(place);
            let (file, starts) = self.hdf5(description).map_err(failed)?;
            more(&file)?;
            // HDF5 gives back what room it has left over when it closes the file: from then on its structure stays.
            file.close().map_err(SealedError::hdf5(path, "write the file")).map_err(failed)?;
            Ok(starts)
        })
    }

    /// Makes the file without HDF5, for flexframe alone, without a seal.
    ///
    /// # Errors
    /// [`SealedError::System`].
    pub fn plain(self) -> Result<SealedFile, SealedError> {
        self.laid_out(|description| {
            let mut end = description.user_block();
            let own = self.datasets.iter().filter(|declared| declared.same_as.is_none());
            let starts = own.map(|Declared { path, kind, shape, .. }| {
                let start = end.next_multiple_of(8);
                end = start + bytes(*kind, shape).unwrap_or_default();
                (path.clone(), start)
            });
            let starts = starts.collect();
            let made = File::create(self.place).and_then(|file| file.set_len(end));
            made.map_err(SealedError::system(self.path, "create the file")).map(|()| starts)
        })
    }

    fn laid_out<E: From<SealedError>>(
        self,
        lay_out: impl FnOnce(&Description) -> Result<Starts, E>,
    ) -> Result<SealedFile, E> {
        // No other places and hashes take more digits.
        let (start, hash) = (u64::MAX, Some("0".repeat(64)));
        let longest = |declared: &Declared| {
            let (kind, shape) = (declared.kind, declared.shape.clone());
            (declared.path.clone(), StoredArray { kind, shape, start, hash: hash.clone() })
        };
        let datasets = self.datasets.iter().map(longest).collect();
        let mut description = Description { texts: self.texts.clone(), datasets };
        let starts = lay_out(&description)?;
        description.datasets.values_mut().for_each(|place| (place.start, place.hash) = (0, None));
        for (name, start) in starts {
            if let Some(place) = description.datasets.get_mut(&name) {
                place.start = start;
            }
        }
        let file = OpenOptions::new().read(true).write(true).open(self.place);
        let file = file.map_err(SealedError::system(self.path, "open the file for writing"))?;
        Ok(SealedFile::made(file, self.path, self.format, description))
    }

    /// The open file with its datasets, and their first bytes.
    fn hdf5(self, description: &Description) -> Result<(hdf5::File, Starts), SealedError> {
        let mut builder = hdf5::File::with_options();
        // Without times of creation, so that equal contents give equal files.
        builder.with_fcpl(|plist| plist.obj_track_times(false).userblock(description.user_block()));
        // Numbers do not straddle the pages of the file, which may be written one by one. HDF5 would lock the file, and a
        // process that is started meanwhile would keep the lock to its end.
        builder.with_fapl(|plist| plist.alignment(1, 8).file_locking(false));
        let file = builder.create(self.place).map_err(SealedError::hdf5(self.path, "create the file"))?;
        let mut starts = Vec::with_capacity(self.datasets.len());
        for declared in self.datasets {
            let made = make_dataset(&file, declared);
            let made = made.map_err(SealedError::hdf5(self.path, format!("make room for {}", declared.path)))?;
            // An empty dataset has no place.
            starts.extend(made.map(|dataset| (declared.path.clone(), dataset.offset().unwrap_or(0))));
        }
        Ok((file, starts))
    }
}

fn make_dataset(file: &hdf5::File, declared: &Declared) -> hdf5::Result<Option<hdf5::Dataset>> {
    if let Some(other) = &declared.same_as {
        if let Some((group, _)) = declared.path.rsplit_once('/')
            && !file.link_exists(group)
        {
            file.create_group(group)?;
        }
        return file.link_hard(other, &declared.path).map(|()| None);
    }
    let dataset = match declared.kind {
        Kind::F64 => room::<f64>(file, declared),
        Kind::F32 => room::<f32>(file, declared),
        Kind::U64 => room::<u64>(file, declared),
        Kind::U32 => room::<u32>(file, declared),
    }?;
    for (name, text) in &declared.attributes {
        write_text(&dataset, name, text)?;
    }
    Ok(Some(dataset))
}

/// It is left as the operating system makes a longer file, zeros that nobody has to write.
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

/// Writes a variable-length UTF-8 string, which h5py reads as `str`; it ends where it has a NUL.
///
/// # Errors
/// Errors of HDF5.
pub fn write_text(owner: &hdf5::Location, name: &str, text: &str) -> hdf5::Result<()> {
    let text = text.split('\0').next().unwrap_or_default();
    let value: VarLenUnicode = text.parse().map_err(|error| hdf5::Error::from(format!("{error}")))?;
    owner.new_attr::<VarLenUnicode>().create(name).and_then(|attribute| attribute.write_scalar(&value))
}

impl SealedError {
    /// Conversion for [`Result::map_err`]. Where the operating system has refused something, it says so in the library's message.
    pub fn hdf5<A: Into<String>>(path: &Path, action: A) -> impl FnOnce(hdf5::Error) -> Self + use<A> {
        let path = path.to_owned();
        move |error| {
            let errno = error.stack().and_then(|stack| {
                stack.iter().find_map(|frame| {
                    let (_, rest) = frame.desc().split_once("errno = ")?;
                    rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
                })
            });
            match errno {
                Some(errno) => Self::system(&path, action)(io::Error::from_raw_os_error(errno)),
                None => Self::Hdf5 { path, action: action.into(), words: error.to_string() },
            }
        }
    }

    /// The library may lose the system's reason on its way. Where it could not write the file at `place`, the system says it again
    /// to who tries the same.
    fn with_reason_from_system(self, place: &Path) -> Self {
        let Self::Hdf5 { path, action, words } = self else { return self };
        let again = OpenOptions::new().append(true).open(place).and_then(|mut file| {
            file.write_all(&[0; 1 << 16])?;
            file.sync_data()
        });
        match again {
            Err(error) => Self::system(&path, action)(error),
            Ok(()) => Self::Hdf5 { path, action, words },
        }
    }
}
