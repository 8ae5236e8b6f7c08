//! Files that are read once: their contents are what other programs get, and what a mesh is known by.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use fem_tet10::MeshFault;
use foreign_program::open_ordinary;

use crate::error::ImportError;
use crate::format::{HEAD, ending, format_of};

/// Files that one may include, together.
pub(crate) const MAX_FILES: usize = 1000;

/// A file as it was read.
#[derive(Debug)]
pub(crate) struct ReadFile {
    /// Where it was.
    pub(crate) path: PathBuf,
    /// The name of its copy in a private folder.
    pub(crate) name: String,
    /// Content of the copy; none where there is no file.
    pub(crate) bytes: Option<Vec<u8>>,
    /// By the number of a line, from 0, the number of the file that a deck includes there.
    pub(crate) includes: BTreeMap<usize, usize>,
    /// True if another file has named it: no line of it is shown.
    pub(crate) is_hidden: bool,
}

/// Files and their copies, the first one first.
#[derive(Debug)]
pub(crate) struct Copies(pub(crate) Vec<(PathBuf, PathBuf)>);

impl Copies {
    /// Writes files into a private folder.
    pub(crate) fn of(files: &[ReadFile], folder: &Path) -> io::Result<Self> {
        let copied = |file: &ReadFile| {
            let copy = folder.join(&file.name);
            file.bytes.as_ref().map_or(Ok(()), |bytes| std::fs::write(&copy, bytes))?;
            Ok((file.path.clone(), copy))
        };
        files.iter().map(copied).collect::<io::Result<_>>().map(Self)
    }

    /// The file that a program is given.
    pub(crate) fn first(&self) -> &Path {
        self.0.first().map_or(Path::new(""), |(_, copy)| copy)
    }

    /// The words of a program about the copies, as if they were about the files.
    pub(crate) fn translated(&self, said: &str) -> String {
        // The last first: their names are the longest.
        self.0.iter().rev().fold(said.to_owned(), |said, (file, copy)| {
            said.replace(&copy.display().to_string(), &file.display().to_string())
        })
    }
}

/// Reads a file that begins as its name says.
pub(crate) fn contents(path: &Path) -> Result<Vec<u8>, ImportError> {
    let io = |cause| ImportError::Io { source_name: path.display().to_string(), cause };
    let (mut bytes, mut rest) = opened(path)?;
    let size = rest.metadata().map_err(io)?.len();
    memory::check("the mesh file", usize::try_from(size).unwrap_or(usize::MAX))
        .map_err(|error| MeshFault::from(error).of(path.display().to_string()))?;
    rest.read_to_end(&mut bytes).map_err(io)?;
    Ok(bytes)
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
            help: "check the file, and the ending of its name".to_owned(),
        }),
        None => Ok((head, file)),
    }
}
