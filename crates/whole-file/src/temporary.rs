//! Temporary files and folders that do not outlive the program, also where a signal ends it.
//!
//! A temporary file is removed when it is dropped. A signal ends a program without dropping anything, so all that are there are
//! listed here, and [`remove_temporaries`] removes them.

use std::error::Error;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::iter::successors;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::sleep;
use std::time::Duration;

use tempfile::{Builder, PathPersistError, TempDir, TempPath};

/// The start of the names of temporary files.
pub(crate) const PREFIX: &str = ".flexframe-";
/// The start of the names of temporary folders.
const FOLDER_PREFIX: &str = "flexframe-";
/// The cure where temporary files find no room.
const TMPDIR_CURE: &str =
    "let the environment variable TMPDIR name a folder that is there, in which you may write, and which has room";
/// Tries of a removal, and to wait for a thread that makes a file.
const TRIES: usize = 200;
/// The wait before each further try.
const PAUSE: Duration = Duration::from_millis(5);

/// Files and folders that are there now.
static THERE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn there() -> MutexGuard<'static, Vec<PathBuf>> {
    THERE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lists what was made while the list is held, so that it is never there unlisted.
fn listed<T>(made: io::Result<T>, path: impl Fn(&T) -> &Path, there: &mut Vec<PathBuf>) -> io::Result<T> {
    let made = made?;
    there.push(path(&made).to_owned());
    Ok(made)
}

/// Lists a file that is to be removed when the program ends.
pub(crate) fn list(path: &Path) {
    there().push(path.to_owned());
}

/// Takes it from the list.
pub(crate) fn unlist(path: &Path) {
    strike(path, &mut there());
}

fn strike(path: &Path, there: &mut Vec<PathBuf>) {
    if let Some(place) = there.iter().position(|other| other == path) {
        there.swap_remove(place);
    }
}

/// Removes all temporary files and folders of this program. None is made, or put into its place, until what is returned is
/// dropped: for a program that is about to end. A thread that is making one is waited for, but not for ever.
#[must_use = "temporary files may be made again once it is dropped"]
pub fn remove_temporaries() -> NoTemporaries {
    let mut tries = 0;
    let mut there = loop {
        match THERE.try_lock() {
            Ok(there) => break there,
            Err(TryLockError::Poisoned(poisoned)) => break poisoned.into_inner(),
            Err(TryLockError::WouldBlock) if tries == TRIES => return NoTemporaries { _alone: None },
            Err(TryLockError::WouldBlock) => sleep(PAUSE),
        }
        tries += 1;
    };
    there.drain(..).for_each(|path| remove(&path));
    NoTemporaries { _alone: Some(there) }
}

/// Removes a file, or a folder with all that is in it. A thread may put something into a folder, or make it again, meanwhile:
/// tries are counted, not time, since a folder may take long to remove.
fn remove(path: &Path) {
    for _ in 0..TRIES {
        let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
        if path.symlink_metadata().is_err() {
            return;
        }
        sleep(PAUSE);
    }
}

/// Makes a folder, with those that it is in, unless the program is about to end: one in a temporary folder would bring that back.
///
/// # Errors
/// Errors of the system.
pub fn make_folder(path: &Path) -> io::Result<()> {
    let _not_at_the_end = there();
    fs::create_dir_all(path)
}

/// While this is there, no temporary file is made.
#[derive(Debug)]
pub struct NoTemporaries {
    _alone: Option<MutexGuard<'static, Vec<PathBuf>>>,
}

/// The folder of temporary files takes none.
#[derive(Debug, thiserror::Error)]
#[error("no temporary folder can be made in {}: {source}\n = {TMPDIR_CURE}", .place.display())]
pub struct NoTemporaryFolder {
    place: PathBuf,
    source: io::Error,
}

/// True of an error by which no temporary folder can be made, or one is full.
pub fn is_of_temporaries(error: &io::Error) -> bool {
    let is_none = error.get_ref().is_some_and(|inner| inner.is::<NoTemporaryFolder>());
    is_none || cure_of_temporaries(error, &error.to_string()).is_some()
}

/// The cure for an error of the system, or one that comes from it, by which a disk is full, where the message names a temporary folder of this program.
pub fn cure_of_temporaries(error: &(dyn Error + 'static), message: &str) -> Option<&'static str> {
    let sources =
        successors(Some(error), |&error| error.source()).filter_map(|error| error.downcast_ref::<io::Error>());
    let mut kinds = sources.map(io::Error::kind);
    let is_full = kinds.any(|kind| matches!(kind, io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded));
    let folders = std::path::absolute(std::env::temp_dir()).ok()?.join(FOLDER_PREFIX);
    (is_full && message.contains(&*folders.to_string_lossy())).then_some(TMPDIR_CURE)
}

/// The path of a temporary file, which is removed when this is dropped.
#[derive(Debug)]
pub struct TemporaryFile(Option<TempPath>);

impl TemporaryFile {
    /// Makes a file in the folder of `path`, whose place it is to take, with the permissions and the owner of the file there, or the
    /// permissions of any new file. Its name is `.flexframe-`, six letters and `suffix`. Where `path` is a symbolic link, the
    /// folder is that of the file it leads to.
    ///
    /// # Errors
    /// Errors of the system, also where the file there may not be written, or belongs to another user, who would lose it; a folder,
    /// a device or a pipe that has this name.
    pub fn beside(path: &Path, suffix: &str) -> io::Result<(File, Self)> {
        let path = followed(path)?;
        if path.exists() && !path.is_file() {
            return Err(io::Error::other("this is no file, and nothing is put in its place"));
        }
        let old = match OpenOptions::new().write(true).open(&path) {
            Ok(old) => Some(old.metadata()?),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = Builder::new();
        builder.prefix(PREFIX).suffix(suffix);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the user's mask
        let mut there = there();
        let made = builder.tempfile_in(folder).map_err(without_a_path);
        let (file, path) = listed(made, |made| made.path(), &mut there)?.into_parts();
        drop(there);
        let temporary = Self(Some(path));
        if let Some(old) = old {
            keep_owner(&file, &old)?;
            file.set_permissions(old.permissions())?;
        }
        Ok((file, temporary))
    }

    /// Moves the file into a place, where it stays. A file that was there is replaced, or else, unless `replace`, in the way; a
    /// symbolic link stays, and the file that it leads to is replaced.
    ///
    /// # Errors
    /// Errors of the system; the file is removed then.
    pub fn put(mut self, place: &Path, replace: bool) -> io::Result<()> {
        let place = if replace { followed(place)? } else { place.to_owned() };
        let mut there = there();
        let Some(path) = self.0.take() else { return Ok(()) };
        strike(&path, &mut there);
        let put = if replace { path.persist(place) } else { path.persist_noclobber(place) };
        put.map_err(|PathPersistError { error, .. }| error)
    }
}

impl Deref for TemporaryFile {
    type Target = Path;

    fn deref(&self) -> &Path {
        self.0.as_deref().unwrap_or(Path::new(""))
    }
}

impl AsRef<Path> for TemporaryFile {
    fn as_ref(&self) -> &Path {
        self
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        if let Some(path) = self.0.take() {
            let mut there = there();
            strike(&path, &mut there);
            drop(path);
        }
    }
}

/// A temporary folder that only its owner may enter. It is removed, with all that is in it, when this is dropped.
#[derive(Debug)]
pub struct TemporaryFolder(Option<TempDir>);

impl TemporaryFolder {
    /// Makes a folder in that of temporary files (`TMPDIR`). Its name is `flexframe-`, six letters.
    ///
    /// # Errors
    /// Errors of the system, with a [`NoTemporaryFolder`] inside.
    pub fn new() -> io::Result<Self> {
        let place = std::env::temp_dir();
        Self::inside(&place).map_err(|source| io::Error::new(source.kind(), NoTemporaryFolder { place, source }))
    }

    /// Makes a folder in another one.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn inside(folder: &Path) -> io::Result<Self> {
        // Programs that work in another folder are told of it, too.
        let folder = std::path::absolute(folder)?;
        let mut there = there();
        let made = Builder::new().prefix(FOLDER_PREFIX).tempdir_in(folder).map_err(without_a_path);
        Ok(Self(Some(listed(made, |made| made.path(), &mut there)?)))
    }

    /// Its path, from the root.
    pub fn path(&self) -> &Path {
        self.0.as_ref().map_or(Path::new(""), |folder| folder.path())
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        if let Some(folder) = self.0.take() {
            let path = folder.path().to_owned();
            // It may be large: others are not kept waiting while it is removed.
            drop(folder);
            unlist(&path);
        }
    }
}

/// Gives a file the owner and the group of another.
#[cfg(unix)]
fn keep_owner(file: &File, old: &fs::Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    let new = file.metadata()?;
    if (new.uid(), new.gid()) == (old.uid(), old.gid()) {
        return Ok(());
    }
    fchown(file, Some(old.uid()), Some(old.gid())).map_err(|error| match error.kind() {
        io::ErrorKind::PermissionDenied => {
            io::Error::new(error.kind(), "it belongs to another user or group, who would lose it; name another file")
        }
        _ => error,
    })
}

#[cfg(not(unix))]
fn keep_owner(_: &File, _: &fs::Metadata) -> io::Result<()> {
    Ok(())
}

/// The file that a symbolic link leads to; any other path as it is.
fn followed(path: &Path) -> io::Result<PathBuf> {
    if path.is_symlink() { fs::canonicalize(path) } else { Ok(path.to_owned()) }
}

/// An error without the path of the temporary file, which tells the reader nothing.
fn without_a_path(error: io::Error) -> io::Error {
    let reason = error.to_string();
    match reason.split_once(" at path ") {
        Some((reason, _)) => io::Error::new(error.kind(), reason),
        None => error,
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    #[test]
    fn what_is_there_is_listed_and_what_has_its_place_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("page");
        let (_, put) = TemporaryFile::beside(&place, "").unwrap();
        put.put(&place, true).unwrap();
        let (_, in_the_way) = TemporaryFile::beside(&place, ".h5").unwrap();
        assert_eq!(in_the_way.put(&place, false).unwrap_err().kind(), io::ErrorKind::AlreadyExists);
        let (_, file) = TemporaryFile::beside(&place, ".h5").unwrap();
        let inner = TemporaryFolder::inside(folder.path()).unwrap();
        fs::write(inner.path().join("mesh"), "some").unwrap();
        let [file_path, inner_path] = [file.to_path_buf(), inner.path().to_owned()];
        assert!(file_path.is_file() && inner_path.is_dir());
        let names: Vec<_> = there().clone();
        assert!(names.contains(&file_path) && names.contains(&inner_path) && !names.contains(&place));
        drop((file, inner));
        assert!(!file_path.exists() && !inner_path.exists() && place.is_file());
        assert!(there().iter().all(|path| !path.starts_with(folder.path())));
    }

    #[test]
    fn a_want_of_room_for_temporary_files_is_told_from_others() {
        let folder = TemporaryFolder::new().unwrap();
        let full = || io::Error::from(io::ErrorKind::StorageFull);
        let here = format!("{}: cannot be written", folder.path().join("mesh").display());
        assert!(cure_of_temporaries(&full(), &here).unwrap().contains("TMPDIR"));
        assert_eq!(cure_of_temporaries(&full(), "/results/a.h5: cannot be written"), None);
        assert_eq!(cure_of_temporaries(&io::Error::from(io::ErrorKind::NotFound), &here), None);
        // Also where it is the source of another error.
        let wrapped = NoTemporaryFolder { place: folder.path().to_owned(), source: full() };
        assert!(cure_of_temporaries(&wrapped, &here).is_some());
        let none = TemporaryFolder::inside(&folder.path().join("none")).unwrap_err();
        assert!(!is_of_temporaries(&none) && is_of_temporaries(&io::Error::new(full().kind(), here)));
    }

    #[test]
    fn a_thread_brings_no_removed_folder_back() {
        let outer = tempfile::tempdir().unwrap();
        let inner = outer.path().join("folder/cache");
        let ended = remove_temporaries();
        std::thread::scope(|scope| {
            let maker = scope.spawn(|| make_folder(&inner));
            sleep(Duration::from_millis(50));
            assert!(!inner.exists());
            drop(ended);
            maker.join().unwrap().unwrap();
        });
        assert!(inner.exists());
    }

    #[test]
    fn a_folder_is_removed_that_a_thread_still_writes_to() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("folder");
        fs::create_dir(&folder).unwrap();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let started = Instant::now();
                for i in 0.. {
                    let is_made = fs::create_dir(folder.join(i.to_string())).is_ok();
                    if !is_made || started.elapsed() > Duration::from_millis(50) {
                        break;
                    }
                }
            });
            while fs::read_dir(&folder).unwrap().count() == 0 {}
            remove(&folder);
        });
        assert!(!folder.exists());
    }
}
