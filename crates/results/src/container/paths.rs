//! Where a results file and its unfinished forerunner are, and how they get there in one go.

use crate::FileError;
use crate::container::lock::Locked;
use sealed::{Format, SealedError};
use std::ffi::OsStr;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use whole_file::TemporaryFile;

/// The ending of an unfinished file.
const PART: &str = ".part.h5";

/// A results file and its unfinished forerunner.
#[derive(Debug, Clone)]
pub(crate) struct ResultsPaths {
    pub path: PathBuf,
    pub part: PathBuf,
}

impl ResultsPaths {
    /// By the name of either.
    pub(crate) fn of(path: &Path) -> Self {
        let with = |stem: &OsStr, ending: &str| {
            let mut name = stem.to_owned();
            name.push(ending);
            path.with_file_name(name)
        };
        let is_h5 = path.extension() == Some(OsStr::new("h5"));
        let stem = if is_h5 { path.file_stem() } else { path.file_name() }.unwrap_or_default();
        match (is_h5, Path::new(stem).extension(), Path::new(stem).file_stem()) {
            (true, Some(part), Some(stem)) if part == "part" => Self { path: with(stem, ".h5"), part: path.to_owned() },
            _ => Self { path: path.to_owned(), part: with(stem, PART) },
        }
    }

    fn folder(&self) -> &Path {
        self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
    }

    /// Refuses names that lead to other files.
    pub(crate) fn refuse_links(&self) -> Result<(), FileError> {
        refuse_link(&self.part)?;
        refuse_link(&self.path)
    }

    /// Refuses to begin where something would be lost.
    pub(crate) fn check(&self, overwrite: bool) -> Result<(), FileError> {
        self.refuse_links()?;
        if self.part.exists() {
            if is_busy(&self.part) {
                return Err(FileError::Busy { path: self.part.clone() });
            }
            if self.part.is_dir() || !overwrite && !is_ours(&self.part) {
                return Err(FileError::NotResults { path: self.part.clone() });
            }
            if !overwrite {
                return Err(FileError::Unfinished { path: self.part.clone() });
            }
        }
        self.check_results(overwrite)
    }

    /// Refuses to make a results file where another file would be lost.
    fn check_results(&self, overwrite: bool) -> Result<(), FileError> {
        let path = self.path.clone();
        match self.path.exists() {
            true if self.path.is_dir() || !overwrite && !is_ours(&self.path) => Err(FileError::NotResults { path }),
            true if !overwrite => Err(FileError::Exists { path }),
            _ => Ok(()),
        }
    }

    /// Refuses to go on where there is nothing to go on from, or no results file could be made in the end.
    pub(crate) fn check_resumable(&self, overwrite: bool) -> Result<(), FileError> {
        refuse_link(&self.part)?;
        if self.part.is_file() {
            refuse_link(&self.path)?;
            if is_busy(&self.part) {
                return Err(FileError::Busy { path: self.part.clone() });
            }
            self.check_results(overwrite)?;
            return self.temporary().map(drop);
        }
        if is_ours(&self.path) {
            return Err(FileError::Complete { path: self.path.clone() });
        }
        Err(FileError::NothingToResume { path: self.path.clone(), part: self.part.clone() })
    }

    /// A file of another name in the same folder, which is removed if it gets no other name.
    pub(crate) fn temporary(&self) -> Result<TemporaryFile, FileError> {
        // HDF5 is given names as text.
        if self.folder().to_str().is_none() {
            return Err(SealedError::NameNotUtf8 { path: self.folder().to_owned() }.into());
        }
        let made = TemporaryFile::beside(&self.path, ".h5");
        Ok(made.map_err(SealedError::system(&self.path, "create the file"))?.1)
    }

    /// Makes a file the unfinished one; an older one is in the way unless it is to be replaced.
    pub(crate) fn put_part(&self, file: TemporaryFile, replace: bool) -> Result<(), FileError> {
        let _alone = lock(self.folder());
        // Another run may have begun since it was looked at first.
        if is_busy(&self.part) {
            return Err(FileError::Busy { path: self.part.clone() });
        }
        file.put(&self.part, replace).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => FileError::Unfinished { path: self.part.clone() },
            _ => SealedError::system(&self.part, "create the file")(error).into(),
        })
    }

    /// Moves a file into the place of the unfinished one, which is the caller's own.
    pub(crate) fn exchange_part(&self, file: TemporaryFile) -> Result<(), FileError> {
        Ok(file.put(&self.part, true).map_err(SealedError::system(&self.part, "create the file"))?)
    }

    /// Makes a file the results file, once it is safe on the disk; another one is in the way unless it is to be replaced.
    pub(crate) fn put_results(&self, file: TemporaryFile, replace: bool) -> Result<(), FileError> {
        let failed = |error| FileError::from(SealedError::system(&self.path, "write the file")(error));
        File::open(&file).and_then(|file| file.sync_all()).map_err(failed)?;
        file.put(&self.path, replace).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => FileError::Exists { path: self.path.clone() },
            _ => failed(error),
        })
    }

    pub(crate) fn remove_part(&self) -> Result<(), FileError> {
        Ok(std::fs::remove_file(&self.part).map_err(SealedError::system(&self.part, "remove the file"))?)
    }
}

/// Keeps other runs from putting a file into the folder until it is dropped. Where folders cannot be locked, nothing does.
fn lock(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    folder.lock().ok()?;
    Some(folder)
}

/// A link may lead anywhere, or nowhere: nothing is written through it, nor in its place.
fn refuse_link(path: &Path) -> Result<(), FileError> {
    match std::fs::read_link(path) {
        Ok(target) => Err(FileError::Link { path: path.to_owned(), target }),
        Err(_) => Ok(()),
    }
}

/// True if another process writes the file: it has it locked.
pub(crate) fn is_busy(path: &Path) -> bool {
    path.is_file() && File::open(path).is_ok_and(|file| Locked::new(file, File::try_lock).is_none())
}

/// True if something claims to be a file of ours. A pipe is not opened, which might never end.
fn is_ours(path: &Path) -> bool {
    path.is_file() && Format::RESULTS.is_claimed(path)
}
