//! Files that can be read to their end.

use std::fs::File;
use std::io;
use std::path::Path;

/// A device or a pipe might never end, or never begin.
pub(crate) fn open_ordinary(path: &Path) -> io::Result<File> {
    let found = std::fs::metadata(path)?;
    if found.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !found.is_file() {
        return Err(io::Error::other("this is not an ordinary file but a device or a pipe"));
    }
    File::open(path)
}
