//! Decks of Abaqus, CalculiX (`.inp`) and Nastran, read with all that they include.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use foreign_program::open_ordinary;

use crate::contents::{MAX_FILES, ReadFile, contents};
use crate::error::ImportError;
use crate::format::ending;
use crate::own::nastran::is_include;

/// Who writes decks.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Syntax {
    Abaqus,
    Nastran,
}

impl Syntax {
    fn help(self) -> &'static str {
        match self {
            Self::Abaqus => {
                "write `*INCLUDE, INPUT=FILE` on one line, with the path of a file relative to the one that includes it"
            }
            Self::Nastran => "write `INCLUDE 'FILE'`, with the path of a file relative to the one that includes it",
        }
    }
}

/// Keywords that take the lines under them from the file of their parameter INPUT.
const WITH_DATA_ELSEWHERE: [&[u8]; 4] = [b"NODE", b"ELEMENT", b"NSET", b"ELSET"];

/// Reads a deck and what it includes.
pub(crate) fn deck(path: &Path) -> Result<Vec<ReadFile>, ImportError> {
    let syntax = if ending(path) == "inp" { Syntax::Abaqus } else { Syntax::Nastran };
    let mut reader = DeckReader { syntax, files: Vec::new(), around: Vec::new() };
    reader.file(path, contents(path)?)?;
    Ok(reader.files)
}

struct DeckReader {
    syntax: Syntax,
    files: Vec<ReadFile>,
    /// Files that are being read: each includes the next.
    around: Vec<PathBuf>,
}

impl DeckReader {
    /// Takes a file and reads what it includes. Returns its number.
    fn file(&mut self, path: &Path, bytes: Vec<u8>) -> Result<usize, ImportError> {
        let number = self.files.len();
        let (name, includes) = (format!("{number}.inp"), BTreeMap::new());
        self.files.push(ReadFile {
            path: path.to_owned(),
            name,
            bytes: None,
            includes,
            is_hidden: !self.files.is_empty(),
        });
        self.around.push(path.to_owned());
        let mut line = 1;
        let mut includes = BTreeMap::new();
        let mut parts = bytes.split_inclusive(is_end).enumerate().peekable();
        while let Some((part, text)) = parts.next() {
            if self.syntax == Syntax::Nastran {
                if let Some(mut name) = included_by_nastran(text) {
                    let (mut place, mut of, mut ends) = (part, 0, 0);
                    // A long name goes on in the next lines, up to the second quote.
                    while name.is_open
                        && let Some((next, more)) = parts.next_if(|_| of < LINES_OF_A_NAME)
                    {
                        name.goes_on(more);
                        (place, of, ends) = (next, of + 1, ends + usize::from(more.ends_with(b"\n")));
                    }
                    includes.insert(place, self.included(path, line, name.path())?);
                    line += ends;
                }
            } else if let Some(mut name) = included_in(text) {
                let mut place = part;
                if name.is_none()
                    && text.trim_ascii().ends_with(b",")
                    && let Some((next, more)) = parts.peek()
                {
                    (place, name) = (*next, input(more));
                }
                includes.insert(place, self.included(path, line, name)?);
            }
            line += usize::from(text.ends_with(b"\n"));
        }
        self.around.pop();
        self.files[number].includes = includes;
        self.files[number].bytes = Some(bytes);
        Ok(number)
    }

    /// Reads a file that the `line` of another includes. Returns its number.
    fn included(&mut self, of: &Path, line: usize, name: Option<String>) -> Result<usize, ImportError> {
        let refused = |found: String, help: &str| ImportError::Refused {
            source_name: of.display().to_string(),
            found: format!("line {line}: {found}"),
            help: help.to_owned(),
        };
        let help = self.syntax.help();
        let Some(name) = name else { return Err(refused("INCLUDE without the name of a file".to_owned(), help)) };
        let path = of.parent().unwrap_or(Path::new("")).join(name);
        if self.around.contains(&path) {
            return Err(refused(format!("INCLUDE of {}, which includes this file", path.display()), help));
        }
        if let Some(known) = self.files.iter().position(|file| file.path == path) {
            return Ok(known);
        }
        if self.files.len() >= MAX_FILES {
            return Err(refused(format!("more than {MAX_FILES} files that include each other"), help));
        }
        let cannot = |cause| refused(format!("INCLUDE of {}, which cannot be read: {cause}", path.display()), help);
        let mut bytes = Vec::new();
        open_ordinary(&path).and_then(|mut file| std::io::Read::read_to_end(&mut file, &mut bytes)).map_err(cannot)?;
        self.file(&path, bytes)
    }
}

/// The line ends of all systems.
fn is_end(byte: &u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// The file that a line takes in, of which the name may be missing; none of another line.
fn included_in(line: &[u8]) -> Option<Option<String>> {
    let line = line.trim_ascii();
    let rest = line.strip_prefix(b"*")?.trim_ascii_start();
    let end = rest.iter().position(|byte| !byte.is_ascii_alphanumeric()).unwrap_or(rest.len());
    let (word, rest) = rest.split_at(end);
    if word.eq_ignore_ascii_case(b"INCLUDE") {
        return Some(input(rest));
    }
    // Other keywords have two words, such as *NODE FILE.
    let is_alone = rest.trim_ascii_start().first().is_none_or(|byte| *byte == b',');
    let is_known = is_alone && WITH_DATA_ELSEWHERE.iter().any(|keyword| word.eq_ignore_ascii_case(keyword));
    if is_known { input(rest).map(Some) } else { None }
}

/// Lines of the name of a file at most.
const LINES_OF_A_NAME: usize = 20;

/// The name of a file in a line of Nastran, and in the lines after it.
struct NamedByNastran {
    text: String,
    quote: char,
    /// True if the second quote is missing.
    is_open: bool,
}

impl NamedByNastran {
    fn goes_on(&mut self, line: &[u8]) {
        let line = String::from_utf8_lossy(line);
        let (part, rest) = line.split_once(self.quote).map_or((&*line, None), |(part, rest)| (part, Some(rest)));
        self.text += part.trim();
        self.is_open = rest.is_none();
    }

    /// As this system has it.
    fn path(self) -> Option<String> {
        (!self.is_open && !self.text.is_empty()).then(|| self.text.replace('\\', "/"))
    }
}

/// The file that a line of Nastran takes in.
fn included_by_nastran(line: &[u8]) -> Option<NamedByNastran> {
    let line = String::from_utf8_lossy(line.trim_ascii());
    if !is_include(&line) {
        return None;
    }
    let rest = line[7..].trim_start_matches(['=', ' ', '\t']);
    match rest.chars().next().filter(|first| matches!(first, '\'' | '"')) {
        Some(quote) => {
            let mut name = NamedByNastran { text: String::new(), quote, is_open: true };
            name.goes_on(&rest.as_bytes()[1..]);
            Some(name)
        }
        None => {
            let text = rest.split('$').next().unwrap_or_default().trim().to_owned();
            Some(NamedByNastran { text, quote: '\'', is_open: false })
        }
    }
}

/// The file that the parameter INPUT names.
fn input(rest: &[u8]) -> Option<String> {
    let rest = String::from_utf8_lossy(rest);
    let named = |part: &str| {
        let (key, value) = part.split_once('=')?;
        let value = value.trim().trim_matches('"');
        (key.trim().eq_ignore_ascii_case("INPUT") && !value.is_empty()).then(|| value.to_owned())
    };
    rest.split(',').find_map(named)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_nastran_that_includes_a_file_is_known_however_it_is_written() {
        for (lines, wanted) in [
            (vec!["INCLUDE 'a b.bdf'"], Some("a b.bdf")),
            (vec![" include a.bdf $ more\r\n"], Some("a.bdf")),
            (vec!["Include\"x\\a.bdf\""], Some("x/a.bdf")),
            (vec!["INCLUDE '/x/y/", "  z/", "a.bdf'"], Some("/x/y/z/a.bdf")),
            (vec!["INCLUDE 'a"], None),
            (vec!["INCLUDE ''"], None),
        ] {
            let mut name = included_by_nastran(lines[0].as_bytes()).unwrap();
            lines[1..].iter().for_each(|line| name.goes_on(line.as_bytes()));
            assert_eq!(name.path().as_deref(), wanted, "{lines:?}");
        }
        for line in ["$ INCLUDE 'a'", "INCLUDED 'a'", "GRID,1", ""] {
            assert!(included_by_nastran(line.as_bytes()).is_none(), "{line}");
        }
    }

    #[test]
    fn a_line_that_includes_a_file_is_known_however_it_is_written() {
        for line in [
            "*INCLUDE, INPUT=a b.inp",
            "* INCLUDE, INPUT=a b.inp",
            " *include,input = \"a b.inp\" \r\n",
            "*\tInclude ,Input=a b.inp,\n",
            "*Node, nset=all, input=a b.inp",
        ] {
            assert_eq!(included_in(line.as_bytes()), Some(Some("a b.inp".to_owned())), "{line}");
        }
        for line in ["*INCLUDE", "*INCLUDE, a.inp", "*INCLUDE,"] {
            assert_eq!(included_in(line.as_bytes()), Some(None), "{line}");
        }
        for line in
            ["** *INCLUDE, INPUT=a", "*INCLUDED, INPUT=a", "*NODE FILE, INPUT=a", "*NODE, NSET=a", "1, 2, 3", "*", ""]
        {
            assert_eq!(included_in(line.as_bytes()), None, "{line}");
        }
    }
}
