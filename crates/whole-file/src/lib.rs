//! Files that are written whole or not at all.
//!
//! A file that is written in place is broken if the program is killed or the disk is full half-way. Here the bytes go to
//! a temporary file in the same folder, which takes the place of the file in one step once it is complete and safe on
//! the disk. Whatever happens, the old file or the new one is there.
//!
//! * The file keeps the permissions and the owner of the one before; a new one gets the permissions that the user's mask leaves.
//! * A file that may not be written is not replaced.
//! * A symbolic link stays: the file that it points to is replaced. A link that points to nothing is an error.
//! * A device or a pipe, such as /dev/stdout, cannot be replaced and is written in place.
//! * A program that is killed (SIGKILL) while it writes leaves its temporary file, `.flexframe-` and six letters. One that a
//!   signal is to end removes its temporary files by [`remove_temporaries`].

#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::unreachable))]

mod lock;
mod outputs;
mod same;
mod temporary;
mod written;

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

pub use lock::FileLock;
pub use outputs::{OutputError, Outputs};
pub use temporary::{
    NoTemporaryFolder, TemporaryFile, TemporaryFolder, cure_of_temporaries, is_of_temporaries, make_folder,
    remove_temporaries,
};
pub use written::{OtherEnding, Written};

/// Writes `bytes` to `path`, whole or not at all.
///
/// # Errors
/// Errors of the system. The file that was there before is then still there.
pub fn write_whole(path: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    file.write_all(bytes.as_ref())?;
    file.finish()
}

/// A file to be written piece by piece. What was there before stays until [`WholeFile::finish`]; if it is dropped
/// before, nothing has happened.
#[derive(Debug)]
pub struct WholeFile {
    file: BufWriter<File>,
    /// The temporary file, and whose place it takes; none for what is written in place.
    place: Option<(TemporaryFile, PathBuf)>,
}

impl WholeFile {
    /// Begins to write the file at `path`.
    ///
    /// # Errors
    /// Errors of the system, also where the file that is there may not be written.
    pub fn create(path: impl AsRef<Path>) -> io::Result<Self> {
        let path = path.as_ref();
        match OpenOptions::new().write(true).open(path) {
            Ok(old) if !old.metadata()?.is_file() => return Ok(Self { file: BufWriter::new(old), place: None }),
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::NotFound && !path.is_symlink() => {}
            Err(error) => return Err(error),
        }
        let (file, temporary) = TemporaryFile::beside(path, "")?;
        Ok(Self { file: BufWriter::new(file), place: Some((temporary, path.to_owned())) })
    }

    /// Brings all that was written to the disk. The file is not in its place yet.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn make_safe(&mut self) -> io::Result<()> {
        self.file.flush()?;
        if self.place.is_some() { self.file.get_ref().sync_all() } else { Ok(()) }
    }

    /// Moves the file into its place, once it is safe on the disk.
    ///
    /// # Errors
    /// Errors of the system. The file that was there before is then still there.
    pub fn finish(mut self) -> io::Result<()> {
        self.make_safe()?;
        self.place.map_or(Ok(()), |(temporary, path)| temporary.put(&path, true))
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn files(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_write_that_ends_half_way_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("page.md");
        write_whole(&path, "old").unwrap();
        let mut file = WholeFile::create(&path).unwrap();
        file.write_all(&[b'n'; 100_000]).unwrap();
        file.flush().unwrap();
        assert_eq!((fs::read(&path).unwrap().as_slice(), files(folder.path()).len()), (b"old".as_slice(), 2));
        drop(file);
        assert_eq!(
            (fs::read(&path).unwrap().as_slice(), files(folder.path())),
            (b"old".as_slice(), vec!["page.md".into()])
        );
        write_whole(&path, "new").unwrap();
        assert_eq!(
            (fs::read(&path).unwrap().as_slice(), files(folder.path())),
            (b"new".as_slice(), vec!["page.md".into()])
        );
    }

    #[test]
    fn what_cannot_be_written_is_an_error_without_the_temporary_name() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_whole(folder.path().join("nowhere").join("page.md"), "new").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
        assert!(!error.to_string().contains("flexframe"), "{error}");
        assert_eq!(write_whole(folder.path(), "new").unwrap_err().kind(), io::ErrorKind::IsADirectory);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn permissions_links_and_devices_are_kept() {
        use std::os::fd::AsRawFd;
        use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let mode = |path: &Path| fs::metadata(path).unwrap().mode() & 0o777;
        // A new file is as any other of the user's.
        fs::write(place("other"), "").unwrap();
        write_whole(place("page"), "old").unwrap();
        assert_eq!(mode(&place("page")), mode(&place("other")));
        fs::set_permissions(place("page"), PermissionsExt::from_mode(0o640)).unwrap();
        symlink("page", place("link")).unwrap();
        write_whole(place("link"), "new").unwrap();
        assert!(place("link").is_symlink() && fs::read(place("page")).unwrap() == b"new");
        assert_eq!(mode(&place("page")), 0o640);
        // A file that is put into its place otherwise, such as one of HDF5.
        TemporaryFile::beside(&place("link"), "").unwrap().1.put(&place("link"), true).unwrap();
        assert!(place("link").is_symlink() && fs::read(place("page")).unwrap() == b"");
        assert_eq!(mode(&place("page")), 0o640);
        // The superuser can give a file away, and it keeps its owner.
        if std::os::unix::fs::chown(place("page"), Some(12345), Some(54321)).is_ok() {
            TemporaryFile::beside(&place("page"), ".h5").unwrap().1.put(&place("page"), true).unwrap();
            let page = fs::metadata(place("page")).unwrap();
            assert_eq!((page.uid(), page.gid(), page.mode() & 0o777), (12345, 54321, 0o640));
            std::os::unix::fs::chown(place("page"), Some(0), Some(0)).unwrap();
        }
        assert!(TemporaryFile::beside(Path::new("/dev/null"), "").is_err());
        fs::set_permissions(place("page"), PermissionsExt::from_mode(0o640)).unwrap();
        symlink("nothing", place("dangling")).unwrap();
        assert_eq!(write_whole(place("dangling"), "new").unwrap_err().kind(), io::ErrorKind::NotFound);
        write_whole("/dev/null", "new").unwrap();
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
        assert_eq!(write_whole("/dev/full", "new").unwrap_err().kind(), io::ErrorKind::StorageFull);
        // As `/dev/stdout` is in a pipeline: a link to a pipe that has no name.
        let (reader, writer) = io::pipe().unwrap();
        write_whole(format!("/proc/self/fd/{}", writer.as_raw_fd()), "new").unwrap();
        drop(writer);
        assert_eq!(io::read_to_string(reader).unwrap(), "new");
        // The superuser writes everywhere.
        fs::set_permissions(place("page"), PermissionsExt::from_mode(0o440)).unwrap();
        if OpenOptions::new().write(true).open(place("page")).is_err() {
            assert_eq!(write_whole(place("page"), "newer").unwrap_err().kind(), io::ErrorKind::PermissionDenied);
            let other = TemporaryFile::beside(&place("page"), ".h5").unwrap_err();
            assert_eq!(other.kind(), io::ErrorKind::PermissionDenied);
        }
    }
}
