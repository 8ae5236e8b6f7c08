//! Geometry of gmsh (`.geo`), which is a program: copied for gmsh with all that it includes, unless it has commands that run other
//! programs, write files, or read what cannot be told before.
//!
//! gmsh's grammar has no place where such a command could not stand, and its reader can be led astray: a loop jumps to a place in
//! the file, a block is skipped without regard to texts, a text of 1024 letters ends by itself. So the words are looked for wherever
//! they are, in texts, too, and as the end of other words: wherever gmsh begins to read, it cannot read one. Comments are
//! blanked before, so that they may have these words, and gmsh gets what was looked at and no comments.

use std::collections::BTreeMap;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use foreign_program::read_at_most;

use crate::contents::{MAX_FILES, ReadFile, contents};
use crate::error::ImportError;
use crate::format::ending;

/// Bytes that a text may have.
const LARGEST: u64 = 256 << 20;
/// gmsh reads a line in parts of 8192 bytes, and jumps to the beginning of a part. Longer lines are broken.
const LONGEST_LINE: usize = 8000;
/// Bytes after which a line is broken, at the first place.
const LONG_LINE: usize = 4000;

/// Words that are refused, and why.
const REFUSED: [(&str, &str); 15] = [
    ("SystemCall", RUNS),
    ("System", RUNS),
    ("OnelabRun", RUNS),
    ("ExternalProcess", RUNS),
    ("CommandLine", RUNS),
    ("GmshOption", RUNS),
    ("Plugin", WRITES),
    ("Print", WRITES),
    ("Save", WRITES),
    ("CreateDir", WRITES),
    ("SendToServer", WRITES),
    ("MergeFile", READS),
    ("MergeString", READS),
    ("FileExists", READS),
    ("StringToName", NAMES),
];
const RUNS: &str = "which can run other programs";
const WRITES: &str = "which can write files";
const READS: &str = "which reads files";
const NAMES: &str = "which can make the name of any command";

const HELP: &str = "read the file; if you trust whoever wrote it, let gmsh do all that it says: --trust-geometry";

/// Commands that include a file, whose name must be a text.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Includes {
    /// A program, whatever its name.
    Text,
    /// By its ending: a program, or another format.
    ByEnding,
    /// The same, as a function.
    Shapes,
    /// Numbers, as a function.
    Numbers,
}

const INCLUDES: [(&str, Includes); 5] = [
    ("Include", Includes::Text),
    ("Merge", Includes::ByEnding),
    ("MergeWithBoundingBox", Includes::ByEnding),
    ("ShapeFromFile", Includes::Shapes),
    ("ListFromFile", Includes::Numbers),
];

/// Formats, other than programs, that gmsh knows by the ending.
const OTHERS: [&str; 8] = ["step", "stp", "iges", "igs", "brep", "unv", "msh", "stl"];

/// Reads a program with all that it includes, as gmsh may have them.
///
/// # Errors
/// [`ImportError::Refused`] where it has a command that is refused, [`ImportError::Io`].
pub(crate) fn geometry(path: &Path) -> Result<Vec<ReadFile>, ImportError> {
    let mut reader = GeometryReader::default();
    reader.program(path)?;
    Ok(reader.files)
}

#[derive(Default)]
struct GeometryReader {
    files: Vec<ReadFile>,
}

impl GeometryReader {
    /// The name of the copy of a file, if it has been read already.
    fn known(&self, path: &Path, ending: &str) -> Option<String> {
        let same =
            |file: &&ReadFile| file.path == path && Path::new(&file.name).extension().is_some_and(|e| e == ending);
        self.files.iter().find(same).map(|file| file.name.clone())
    }

    /// A file that is to be read. Returns its number, and the name of its copy.
    fn begin(&mut self, path: &Path, ending: &str) -> Result<(usize, String), ImportError> {
        let number = self.files.len();
        if number >= MAX_FILES {
            return Err(refused(path, None, &format!("more than {MAX_FILES} files that include each other")));
        }
        let name = format!("{number}.{ending}");
        let includes = BTreeMap::new();
        self.files.push(ReadFile { path: path.to_owned(), name: name.clone(), bytes: None, includes, is_hidden: true });
        Ok((number, name))
    }

    /// Reads a program. Returns the name of its copy.
    fn program(&mut self, path: &Path) -> Result<String, ImportError> {
        if let Some(name) = self.known(path, "geo") {
            return Ok(name);
        }
        let io = |cause| ImportError::Io { source_name: path.display().to_string(), cause };
        let bytes = read_at_most(path, LARGEST).map_err(io)?;
        let (number, name) = self.begin(path, "geo")?;
        let text = without_comments(&bytes).map_err(|(at, found)| refused(path, Some(line(&bytes, at)), found))?;
        if let Some((at, found)) = forbidden(&text) {
            return Err(refused(path, Some(line(&text, at)), &found));
        }
        let mut edits = Vec::new();
        for (word, kind) in INCLUDES {
            for at in places(&text, word) {
                let Some((start, end)) = name_after(&text, at + word.len(), kind) else {
                    let found = format!("`{word}` of a file whose name is not simply a text in quotes");
                    return Err(refused(path, Some(line(&text, at)), &found));
                };
                let included = Path::new(std::ffi::OsStr::from_bytes(&text[start..end]));
                let included = path.parent().unwrap_or(Path::new("")).join(included);
                edits.push((start, end, self.included(&included, kind)?));
            }
        }
        edits.sort();
        if let Some(pair) = edits.windows(2).find(|pair| pair[0].1 > pair[1].0) {
            return Err(refused(path, Some(line(&text, pair[1].0)), "the name of a file in that of another"));
        }
        let mut edited = Vec::with_capacity(text.len() + 1);
        let mut from = 0;
        for (start, end, name) in edits {
            edited.extend_from_slice(&text[from..start]);
            edited.extend_from_slice(name.as_bytes());
            from = end;
        }
        edited.extend_from_slice(&text[from..]);
        edited.push(b'\n');
        let Some(broken) = with_short_lines(&edited) else {
            return Err(refused(path, None, &format!("a line of more than {LONGEST_LINE} bytes without a comma")));
        };
        self.files[number].bytes = Some(broken);
        Ok(name)
    }

    /// Reads what is included. Returns the name of its copy.
    fn included(&mut self, path: &Path, kind: Includes) -> Result<String, ImportError> {
        let ending = ending(path);
        let ending = match kind {
            Includes::Numbers => "txt",
            Includes::ByEnding | Includes::Shapes if OTHERS.contains(&ending.as_str()) => ending.as_str(),
            _ => "geo",
        };
        if let Some(name) = self.known(path, ending) {
            return Ok(name);
        }
        if !path.try_exists().unwrap_or(true) {
            // gmsh says so, if it comes to it.
            return self.begin(path, ending).map(|(_, name)| name);
        }
        if ending == "geo" {
            return self.program(path);
        }
        let (number, name) = self.begin(path, ending)?;
        let io = |cause| ImportError::Io { source_name: path.display().to_string(), cause };
        let bytes = if ending == "txt" { read_at_most(path, LARGEST).map_err(io)? } else { contents(path)? };
        self.files[number].bytes = Some(bytes);
        Ok(name)
    }
}

fn refused(path: &Path, line: Option<usize>, found: &str) -> ImportError {
    let at = line.map_or_else(String::new, |line| format!("line {line}: "));
    ImportError::Refused {
        source_name: path.display().to_string(),
        found: format!("{at}found {found}; expected geometry alone, since a .geo file is a program"),
        help: HELP.to_owned(),
    }
}

/// The number of the line of a place, from 1.
fn line(text: &[u8], at: usize) -> usize {
    1 + text[..at.min(text.len())].iter().filter(|byte| **byte == b'\n').count()
}

/// The text with spaces in place of its comments. Where it has none, or not only text, the place and what is there.
fn without_comments(bytes: &[u8]) -> Result<Vec<u8>, (usize, &'static str)> {
    if let Some(at) = bytes.iter().position(|byte| *byte == 0) {
        return Err((at, "a byte that is zero"));
    }
    let mut text = bytes.to_vec();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let end = match byte {
            b'"' | b'\'' => {
                let inside = &bytes[at + 1..];
                let length = inside.iter().position(|other| *other == byte).ok_or((at, "a text that does not end"))?;
                at += length + 2;
                continue;
            }
            b'/' if bytes.get(at + 1) == Some(&b'/') => {
                bytes[at..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |length| at + length)
            }
            b'/' if bytes.get(at + 1) == Some(&b'*') => {
                let inside = &bytes[at + 2..];
                let length = inside.windows(2).position(|pair| pair == b"*/");
                at + length.ok_or((at, "a comment that does not end"))? + 4
            }
            _ => {
                at += 1;
                continue;
            }
        };
        for byte in &mut text[at..end] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
        at = end;
    }
    Ok(text)
}

/// The command that is refused in a text, and its place.
fn forbidden(text: &[u8]) -> Option<(usize, String)> {
    let word = |(word, why): &(&str, &str)| {
        let at = places(text, word).next()?;
        Some((at, format!("the word `{word}`, {why}")))
    };
    // Two letters only: as a word of its own, not as the end of another.
    let short = || {
        let is_own = |at: &usize| at.checked_sub(1).is_none_or(|before| !text[before].is_ascii_alphanumeric());
        Some((places(text, "S2N").find(is_own)?, format!("the word `S2N`, {NAMES}")))
    };
    let followed = |word: &str, by: u8| places(text, word).find(|at| after(text, at + word.len()) == Some(by));
    let option = || {
        [("Solver", b'.', RUNS), ("Command", b'=', RUNS), ("FileName", b'=', WRITES)]
            .into_iter()
            .find_map(|(word, by, why)| Some((followed(word, by)?, format!("the word `{word}` of an option, {why}"))))
    };
    let printed = || {
        places(text, "Printf").next()?;
        let into = |at: &usize| text[*at] == b')' && after(text, at + 1) == Some(b'>');
        let found = "`Printf`, and `) >`, by which it writes into a file (a comparison may be turned round: `2 < (x)`)";
        Some(((0..text.len()).find(into)?, found.to_owned()))
    };
    REFUSED.iter().find_map(word).or_else(short).or_else(option).or_else(printed)
}

/// Where a word is, also as the end of another.
fn places<'a>(text: &'a [u8], word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let first = word.as_bytes()[0];
    text.iter().enumerate().filter(move |(_, byte)| **byte == first).map(|(at, _)| at).filter(move |at| {
        let rest = &text[*at..];
        let is_whole = |byte: &u8| !byte.is_ascii_alphanumeric() && *byte != b'_';
        rest.starts_with(word.as_bytes()) && rest.get(word.len()).is_none_or(is_whole)
    })
}

/// The first byte from a place on that is no space.
fn after(text: &[u8], at: usize) -> Option<u8> {
    text.get(at..)?.iter().copied().find(|byte| !byte.is_ascii_whitespace())
}

/// Where the name of a file is that follows a command, or the name of a function: a text and nothing else.
fn name_after(text: &[u8], at: usize, kind: Includes) -> Option<(usize, usize)> {
    let past = |at: usize| Some(at + text.get(at..)?.iter().position(|byte| !byte.is_ascii_whitespace())?);
    let is_function = matches!(kind, Includes::Shapes | Includes::Numbers);
    let mut start = past(at)?;
    if is_function {
        start = Some(start).filter(|at| matches!(text[*at], b'(' | b'[')).and_then(|at| past(at + 1))?;
    }
    let quote = Some(text[start]).filter(|byte| matches!(byte, b'"' | b'\''))?;
    start += 1;
    let end = start + text[start..].iter().position(|byte| *byte == quote)?;
    let next = text[past(end + 1)?];
    let is_closed = if is_function { matches!(next, b')' | b']') } else { next == b';' };
    let is_plain = end > start && !text[start..end].iter().any(u8::is_ascii_control);
    (is_closed && is_plain).then_some((start, end))
}

/// The text with its long lines broken between numbers and names; none where a line cannot be broken.
fn with_short_lines(text: &[u8]) -> Option<Vec<u8>> {
    let mut broken = Vec::with_capacity(text.len());
    let (mut quote, mut column) = (None, 0);
    for &byte in text {
        broken.push(byte);
        column += 1;
        match quote {
            _ if byte == b'\n' => column = 0,
            Some(open) if byte == open => quote = None,
            Some(_) => {}
            None if matches!(byte, b'"' | b'\'') => quote = Some(byte),
            None if column > LONG_LINE && (byte == b',' || byte == b' ' || byte == b'\t') => {
                broken.push(b'\n');
                column = 0;
            }
            None => {}
        }
        if column > LONGEST_LINE {
            return None;
        }
    }
    Some(broken)
}
