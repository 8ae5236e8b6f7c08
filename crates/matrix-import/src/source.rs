//! A text file that is read line by line.

use std::cell::OnceCell;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use keys::{Digest, Hash, HashedReader};

use crate::error::{MatrixError, Which};

/// The longest part of a line that a message shows, in characters.
const SHOWN: usize = 60;
/// Bytes of a line that no such file has.
const LONGEST_LINE: u64 = 1 << 20;

/// One of the files of a body.
pub(crate) struct Source<'a> {
    pub which: Which,
    pub path: &'a Path,
    /// Hash of the bytes that were read.
    hash: OnceCell<Hash>,
}

impl<'a> Source<'a> {
    pub fn new(which: Which, path: &'a Path) -> Self {
        Self { which, path, hash: OnceCell::new() }
    }

    /// With what was read of the file, and how: the ending says how nodes are read.
    pub fn identify(&self, digest: Digest) -> Digest {
        let ending = self.path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let digest = digest.text(self.which.name()).text(&ending);
        self.hash.get().into_iter().fold(digest, Digest::hash)
    }

    /// The refusal of the file, or of a line of it.
    pub fn refuse(
        &self,
        line: Option<usize>,
        found: impl Into<String>,
        expected: impl Into<String>,
        help: impl Into<String>,
    ) -> MatrixError {
        let (which, path) = (self.which, self.path.to_owned());
        MatrixError::Refused { which, path, line, found: found.into(), expected: expected.into(), help: help.into() }
    }

    /// Bytes of the file.
    pub fn length(&self) -> Result<usize, MatrixError> {
        let found = std::fs::metadata(self.path).map_err(|cause| self.unreadable(&cause))?;
        if !found.is_file() {
            return Err(self.refuse(
                None,
                "a folder, a device or a pipe",
                "an ordinary file",
                "check its name; it is relative to the folder of the scene file",
            ));
        }
        Ok(usize::try_from(found.len()).unwrap_or(usize::MAX))
    }

    /// Calls `read` with the number (from 1) and the text of each line that is not blank, until it says that this was
    /// the last. What is known of the file ([`Source::identify`]) is of the same bytes.
    pub fn each_line(&self, mut read: impl FnMut(usize, &str) -> Result<Next, MatrixError>) -> Result<(), MatrixError> {
        if self.length()? == 0 {
            return Err(self.refuse(None, "an empty file", "a text with numbers", "write it again"));
        }
        let file = File::open(self.path).map_err(|cause| self.unreadable(&cause))?;
        let mut file = BufReader::new(HashedReader::new(file));
        let mut bytes = Vec::new();
        for number in 1.. {
            bytes.clear();
            let length = (&mut file).take(LONGEST_LINE).read_until(b'\n', &mut bytes);
            let length = length.map_err(|cause| self.unreadable(&cause))? as u64;
            if length == 0 {
                break;
            }
            if length == LONGEST_LINE {
                let found = format!("a line of {LONGEST_LINE} bytes and more");
                return Err(self.refuse(
                    Some(number),
                    found,
                    "a text with a few numbers in each line",
                    "export it as text",
                ));
            }
            let Ok(line) = std::str::from_utf8(&bytes) else {
                let help = "export it as text; a binary file (.sim, .npz, .mat) is not read";
                return Err(self.refuse(Some(number), "bytes that are no text", "a text with numbers", help));
            };
            let line = line.trim();
            if !line.is_empty() && read(number, line)? == Next::Stop {
                break;
            }
        }
        let hash = file.into_inner().finish().map_err(|cause| self.unreadable(&cause))?;
        self.hash.get_or_init(|| hash);
        Ok(())
    }

    /// Reads it to be known, and for nothing else.
    pub fn skim(&self) -> Result<(), MatrixError> {
        self.length()?;
        let hash = File::open(self.path).and_then(|file| HashedReader::new(file).finish());
        let hash = hash.map_err(|cause| self.unreadable(&cause))?;
        self.hash.get_or_init(|| hash);
        Ok(())
    }

    fn unreadable(&self, cause: &io::Error) -> MatrixError {
        self.refuse(
            None,
            format!("a file that cannot be read: {cause}"),
            "a file that is there, its path relative to the folder of the scene file",
            "correct the path, or write the file: docs/reference/matrices.md says how, from CalculiX, Abaqus and Python",
        )
    }
}

/// The wish for further lines.
#[derive(PartialEq, Eq)]
pub(crate) enum Next {
    Go,
    Stop,
}

/// The fields of a line: between commas where it has some, otherwise between blanks.
pub(crate) fn fields(line: &str) -> Vec<&str> {
    if line.contains(',') { line.split(',').map(str::trim).collect() } else { line.split_whitespace().collect() }
}

/// A number as any program writes it, also with Fortran's `D` for the power of ten.
pub(crate) fn number(text: &str) -> Option<f64> {
    text.parse().ok().or_else(|| text.replace(['d', 'D'], "e").parse().ok())
}

/// The beginning of a line of numbers, in quotes. Other words are not shown, since a scene from elsewhere may name any file of the user's.
pub(crate) fn shown(line: &str) -> String {
    let is_of_number = |letter: char| letter.is_ascii_digit() || " \t,;+-.eEdD*".contains(letter);
    if !line.chars().all(is_of_number) {
        return "a line with other words than numbers".to_owned();
    }
    let short: String = line.chars().take(SHOWN).collect();
    if short.len() < line.len() { format!("`{short}…`") } else { format!("`{short}`") }
}
