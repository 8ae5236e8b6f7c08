//! Files that a program of others has left, or is to be given: ordinary ones only. A pipe or a device might never end, or never
//! begin.

use std::fs::{File, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;

use rustix::fs::OFlags;

/// Opens an ordinary file for reading.
///
/// # Errors
/// Errors of the system, and anything else than a file: a folder, a pipe, a device.
pub fn open_ordinary(path: &Path) -> io::Result<File> {
    // Without waiting for somebody to write into a pipe, which another may have put there since it was looked at.
    let flags = i32::try_from(OFlags::NONBLOCK.bits()).unwrap_or_default();
    let file = OpenOptions::new().read(true).custom_flags(flags).open(path)?;
    match file.metadata()? {
        found if found.is_file() => Ok(file),
        found if found.is_dir() => Err(io::Error::other("this is a folder; name the file in it")),
        _ => Err(io::Error::other("this is not an ordinary file but a device or a pipe")),
    }
}

/// All bytes of an ordinary file, which has `most` of them at most.
///
/// # Errors
/// As [`open_ordinary`], and a larger file.
pub fn read_at_most(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_ordinary(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    match bytes.len() as u64 > most {
        true => Err(io::Error::other(format!("it has more than {most} bytes, which is the most that is read of it"))),
        false => Ok(bytes),
    }
}
