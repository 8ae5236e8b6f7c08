//! Locks of files that are written again and again, each time as another file.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};

use rustix::fs::OFlags;

use crate::same::are_of_one;
use crate::temporary::{PREFIX, list, unlist};

/// Keeps other programs from writing a file until it is dropped, by a file beside it: `.flexframe-NAME.lock`. The system
/// unlocks it when the program ends, however that comes. Where files cannot be locked, nothing is.
#[derive(Debug)]
pub struct FileLock {
    file: File,
    path: PathBuf,
}

impl FileLock {
    /// Locks the file at `path`, which need not be there; `None` where another program has it locked.
    ///
    /// # Errors
    /// Errors of the system, and a link, a pipe or a device in the place of the lock.
    pub fn of(path: &Path) -> io::Result<Option<Self>> {
        let mut name = std::ffi::OsString::from(PREFIX);
        name.push(path.file_name().unwrap_or_default());
        name.push(".lock");
        let path = path.with_file_name(name);
        // Without waiting for somebody to read a pipe, and without following a link, which another may have put there.
        let flags = i32::try_from((OFlags::NONBLOCK | OFlags::NOFOLLOW).bits()).unwrap_or_default();
        let open = || OpenOptions::new().create(true).truncate(false).write(true).custom_flags(flags).open(&path);
        loop {
            let file = match open() {
                Ok(file) if file.metadata()?.is_file() => file,
                Err(error) if path.symlink_metadata().is_ok_and(|found| found.is_file()) => return Err(error),
                Err(error) if path.symlink_metadata().is_err() => return Err(error),
                Ok(_) | Err(_) => {
                    let name = path.file_name().unwrap_or_default().display();
                    let found = "is a link, a pipe, a device or a folder, and no lock: remove it";
                    return Err(io::Error::other(format!("{name} beside it {found}")));
                }
            };
            if let Err(TryLockError::WouldBlock) = file.try_lock() {
                return Ok(None);
            }
            // Who had it before may have removed it meanwhile.
            let (ours, there) = (file.metadata()?, path.symlink_metadata());
            if there.is_ok_and(|there| are_of_one(&ours, &there)) {
                list(&path);
                return Ok(Some(Self { file, path }));
            }
        }
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
        unlist(&self.path);
        // A process that was just started has the file open, too, until it has become another program.
        let _ = self.file.unlock();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn only_one_has_it_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let table = folder.path().join("table.h5");
        let lock = FileLock::of(&table).unwrap().unwrap();
        assert!(FileLock::of(&table).unwrap().is_none());
        assert!(FileLock::of(&folder.path().join("other.h5")).unwrap().is_some());
        drop(lock);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        assert!(FileLock::of(&table).unwrap().is_some());
    }

    #[test]
    fn a_pipe_or_a_link_in_its_place_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (table, lock) = (folder.path().join("table.h5"), folder.path().join(".flexframe-table.h5.lock"));
        let is_refused = || FileLock::of(&table).unwrap_err().to_string().contains("no lock: remove it");
        rustix::fs::mknodat(
            rustix::fs::CWD,
            &lock,
            rustix::fs::FileType::Fifo,
            rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR,
            0,
        )
        .unwrap();
        assert!(is_refused());
        fs::remove_file(&lock).unwrap();
        let other = folder.path().join("other");
        for _ in 0..2 {
            std::os::unix::fs::symlink(&other, &lock).unwrap();
            assert!(is_refused());
            fs::remove_file(&lock).unwrap();
            fs::write(&other, "mine").unwrap();
        }
        assert_eq!(fs::read(&other).unwrap(), b"mine");
    }

    #[test]
    fn many_that_want_it_have_it_one_after_the_other() {
        let folder = tempfile::tempdir().unwrap();
        let table = folder.path().join("table.h5");
        let (inside, had) = (AtomicUsize::new(0), AtomicUsize::new(0));
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    while had.load(Ordering::SeqCst) < 200 {
                        if let Some(_lock) = FileLock::of(&table).unwrap() {
                            assert_eq!(inside.fetch_add(1, Ordering::SeqCst), 0);
                            had.fetch_add(1, Ordering::SeqCst);
                            inside.fetch_sub(1, Ordering::SeqCst);
                        }
                    }
                });
            }
        });
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
