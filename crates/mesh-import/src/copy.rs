//! The copy of a mesh file that another program is given: the file alone, and only if it begins as its name says.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use foreign_program::open_ordinary;

use crate::error::ImportError;
use crate::format::{HEAD, ending, format_of};

/// Copies a file to `stem.ENDING` in a private folder.
pub(crate) fn copied(path: &Path, folder: &Path, stem: &str) -> Result<PathBuf, ImportError> {
    let io = |cause| ImportError::Io { source_name: path.display().to_string(), cause };
    let (head, mut rest) = opened(path)?;
    let copy = folder.join(format!("{stem}.{}", ending(path)));
    let mut target = File::create_new(&copy).map_err(io)?;
    io::copy(&mut head.as_slice().chain(&mut rest), &mut target).map_err(io)?;
    Ok(copy)
}

/// Opens a file. Returns its beginning and the rest.
///
/// # Errors
/// [`ImportError::Io`]; [`ImportError::Refused`] where it does not begin as its name says.
pub(crate) fn opened(path: &Path) -> Result<(Vec<u8>, File), ImportError> {
    let source_name = path.display().to_string();
    let io = |cause| ImportError::Io { source_name: source_name.clone(), cause };
    let mut file = open_ordinary(path).map_err(io)?;
    let mut head = Vec::new();
    file.by_ref().take(HEAD as u64).read_to_end(&mut head).map_err(io)?;
    let ending = ending(path);
    match format_of(&ending).filter(|format| !format.may_be(&head)) {
        // What is in it is not shown: it may be any file, such as one with passwords that a scene from elsewhere names.
        Some(format) => Err(ImportError::Refused {
            source_name,
            found: format!("found a file that does not begin as .{ending} files do, expected {}", format.expected),
            cure: "check the file, and the ending of its name".to_owned(),
        }),
        None => Ok((head, file)),
    }
}
