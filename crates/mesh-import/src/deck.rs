//! Decks of Abaqus and CalculiX (`.inp`), read with all that they include.

use std::path::{Path, PathBuf};

use foreign_program::open_ordinary;

use crate::contents::{MAX_FILES, ReadFile, contents};
use crate::error::ImportError;

/// The keyword of the copies, which no deck has: the program that reads them takes nothing else in.
const KEYWORD: &str = "*FLEXFRAME INCLUDE";

const HELP: &str =
    "write `*INCLUDE, INPUT=FILE` on one line, with the path of a file relative to the one that includes it";

/// Reads a deck. In the copies each `*INCLUDE` names the copy of a file.
pub(crate) fn deck(path: &Path) -> Result<Vec<ReadFile>, ImportError> {
    let mut reader = DeckReader::default();
    reader.file(path, contents(path)?)?;
    Ok(reader.files)
}

#[derive(Default)]
struct DeckReader {
    files: Vec<ReadFile>,
    /// Files that are being read: each includes the next.
    around: Vec<PathBuf>,
}

impl DeckReader {
    /// Takes a file and reads what it includes. Returns the name of its copy.
    fn file(&mut self, path: &Path, bytes: Vec<u8>) -> Result<String, ImportError> {
        let number = self.files.len();
        let name = format!("{number}.inp");
        self.files.push(ReadFile { path: path.to_owned(), name: name.clone(), bytes: None });
        self.around.push(path.to_owned());
        let mut copy = Vec::with_capacity(bytes.len());
        let mut line = 1;
        // The line ends of all systems.
        for text in bytes.split_inclusive(|byte| matches!(byte, b'\n' | b'\r')) {
            match include(text) {
                Some(included) => {
                    let included = self.included(path, line, included)?;
                    copy.extend_from_slice(format!("{KEYWORD}={included}").as_bytes());
                    copy.extend(text.last().filter(|byte| matches!(byte, b'\n' | b'\r')));
                }
                None => copy.extend_from_slice(text),
            }
            line += usize::from(text.ends_with(b"\n"));
        }
        self.around.pop();
        self.files[number].bytes = Some(copy);
        Ok(name)
    }

    /// Reads a file that the `line` of another includes. Returns the name of its copy.
    fn included(&mut self, of: &Path, line: usize, name: Option<String>) -> Result<String, ImportError> {
        let refused = |found: String, help: &str| ImportError::Refused {
            source_name: of.display().to_string(),
            found: format!("line {line}: {found}"),
            help: help.to_owned(),
        };
        let Some(name) = name else { return Err(refused("*INCLUDE without the name of a file".to_owned(), HELP)) };
        let path = of.parent().unwrap_or(Path::new("")).join(name);
        if self.around.contains(&path) {
            return Err(refused(format!("*INCLUDE of {}, which includes this file", path.display()), HELP));
        }
        if let Some(known) = self.files.iter().find(|file| file.path == path) {
            return Ok(known.name.clone());
        }
        if self.files.len() >= MAX_FILES {
            return Err(refused(format!("more than {MAX_FILES} files that include each other"), HELP));
        }
        let cannot = |cause| refused(format!("*INCLUDE of {}, which cannot be read: {cause}", path.display()), HELP);
        let mut bytes = Vec::new();
        open_ordinary(&path).and_then(|mut file| std::io::Read::read_to_end(&mut file, &mut bytes)).map_err(cannot)?;
        self.file(&path, bytes)
    }
}

/// The file that a line includes, of which the name may be missing; none of another line.
fn include(line: &[u8]) -> Option<Option<String>> {
    let line = line.trim_ascii();
    let rest = line.strip_prefix(b"*")?.trim_ascii_start();
    let (word, rest) = rest.split_at_checked("INCLUDE".len())?;
    let is_end = |byte: &u8| !byte.is_ascii_alphanumeric();
    if !word.eq_ignore_ascii_case(b"INCLUDE") || !rest.first().is_none_or(is_end) {
        return None;
    }
    let rest = String::from_utf8_lossy(rest);
    let named = |part: &str| {
        let (key, value) = part.split_once('=')?;
        let value = value.trim().trim_matches('"');
        (key.trim().eq_ignore_ascii_case("INPUT") && !value.is_empty()).then(|| value.to_owned())
    };
    Some(rest.split(',').find_map(named))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_includes_a_file_is_known_however_it_is_written() {
        for line in [
            "*INCLUDE, INPUT=a b.inp",
            "* INCLUDE, INPUT=a b.inp",
            " *include,input = \"a b.inp\" \r\n",
            "*\tInclude ,Input=a b.inp,\n",
        ] {
            assert_eq!(include(line.as_bytes()), Some(Some("a b.inp".to_owned())), "{line}");
        }
        for line in ["*INCLUDE", "*INCLUDE, a.inp", "*INCLUDE,"] {
            assert_eq!(include(line.as_bytes()), Some(None), "{line}");
        }
        for line in ["** *INCLUDE, INPUT=a", "*INCLUDED, INPUT=a", "*NODE, INPUT=a", "1, 2, 3", "*", ""] {
            assert_eq!(include(line.as_bytes()), None, "{line}");
        }
    }
}
