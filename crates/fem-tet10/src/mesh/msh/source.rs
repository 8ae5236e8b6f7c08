//! The numbers of a MSH file, whether they are written as text or as bytes.

use std::str::FromStr;

use crate::error::{FilePosition, MeshError, MeshFault};

/// Most bytes of a file that a message quotes; no name of a section is longer.
const LONGEST_QUOTE: usize = 40;

/// The mark that some editors put in front of a text in UTF-8.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// The totals that the head of a section gives for its blocks.
pub(super) struct Total {
    /// "nodes" or "elements".
    what: &'static str,
    claimed: u64,
    /// Where it says so.
    place: FilePosition,
}

/// A cursor over a MSH file.
pub(super) struct Source<'a> {
    bytes: &'a [u8],
    at: usize,
    binary: bool,
    section: String,
    name: &'a str,
}

impl<'a> Source<'a> {
    /// Reads the `$MeshFormat` section.
    pub(super) fn open(bytes: &'a [u8], name: &'a str) -> Result<Self, MeshError> {
        // A byte order mark is no part of the text.
        let at = if bytes.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        let mut source = Self { bytes, at, binary: false, section: String::new(), name };
        let version_error = |found: String| MeshFault::Version { found }.of(name);
        match source.next_section() {
            Ok(Some(section)) if section == "$MeshFormat" => {}
            // What is no mesh may be any file, such as one with passwords that a scene from elsewhere names.
            _ => return Err(version_error("a file that does not begin with $MeshFormat".to_owned())),
        }
        let version = source.peek_word();
        if version != b"4.1" {
            return Err(version_error(format!("version {}", readable(version))));
        }
        source.at += version.len();
        let binary = match source.text_number::<u8>("0 (ASCII) or 1 (binary)")? {
            0 => false,
            1 => true,
            other => return Err(source.error("0 (ASCII) or 1 (binary)", &other.to_string())),
        };
        let size: usize = source.text_number("the size of a number, 8")?;
        if size != 8 {
            return Err(source.error("numbers of 8 bytes", &size.to_string()));
        }
        if binary {
            source.at = bytes.len().min(source.at + 1); // the newline after the header
            source.binary = true;
            if source.int("the integer 1, which tells the order of bytes")? != 1 {
                return Err(source.error("little-endian bytes", "the other order of bytes"));
            }
        }
        source.end_section()?;
        Ok(source)
    }

    /// Goes to the next section; `None` at the end of the file.
    pub(super) fn next_section(&mut self) -> Result<Option<String>, MeshError> {
        let word = self.peek_word();
        if word.is_empty() {
            return Ok(None);
        }
        let is_section = word.starts_with(b"$") && !word.starts_with(b"$End");
        if !is_section || word.len() > LONGEST_QUOTE || !word.iter().all(u8::is_ascii_graphic) {
            self.section = "the file".to_owned();
            return Err(self.error("a section that begins with $", &readable(word)));
        }
        self.at += word.len();
        self.section = readable(word);
        // A section of a binary file begins right after the newline.
        if self.bytes.get(self.at) == Some(&b'\r') {
            self.at += 1;
        }
        if self.bytes.get(self.at) == Some(&b'\n') {
            self.at += 1;
        }
        Ok(Some(self.section.clone()))
    }

    /// The word that closes the section must come next.
    pub(super) fn end_section(&mut self) -> Result<(), MeshError> {
        let expected = self.section.replacen('$', "$End", 1);
        let word = self.peek_word();
        if word != expected.as_bytes() {
            return Err(self.error(&expected, &readable(word)));
        }
        self.at += word.len();
        Ok(())
    }

    /// Passes over a section that is not needed, to behind its closing word.
    pub(super) fn skip_section(&mut self) -> Result<(), MeshError> {
        let end = self.section.replacen('$', "$End", 1);
        let rest = &self.bytes[self.at..];
        match rest.windows(end.len()).position(|window| window == end.as_bytes()) {
            Some(offset) => {
                self.at += offset + end.len();
                Ok(())
            }
            None => {
                self.at = self.bytes.len();
                Err(self.error(&end, ""))
            }
        }
    }

    /// An integer of 4 bytes.
    pub(super) fn int(&mut self, what: &str) -> Result<i32, MeshError> {
        if self.binary { self.raw(what).map(i32::from_le_bytes) } else { self.text_number(what) }
    }

    /// A count or a tag, of 8 bytes.
    pub(super) fn size(&mut self, what: &str) -> Result<u64, MeshError> {
        if self.binary { self.raw(what).map(u64::from_le_bytes) } else { self.text_number(what) }
    }

    /// A real number of 8 bytes.
    pub(super) fn real(&mut self, what: &str) -> Result<f64, MeshError> {
        if self.binary { self.raw(what).map(f64::from_le_bytes) } else { self.text_number(what) }
    }

    /// A number written as text, also in a binary file.
    pub(super) fn text_number<T: FromStr>(&mut self, what: &str) -> Result<T, MeshError> {
        let word = self.peek_word();
        match std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()) {
            Some(number) => {
                self.at += word.len();
                Ok(number)
            }
            None => Err(self.error(what, &readable(word))),
        }
    }

    /// A text in double quotes.
    pub(super) fn quoted(&mut self) -> Result<String, MeshError> {
        self.skip_whitespace();
        let rest = &self.bytes[self.at..];
        let text =
            rest.strip_prefix(b"\"").and_then(|inner| inner.iter().position(|b| *b == b'"').map(|end| &inner[..end]));
        match text {
            Some(text) => {
                self.at += text.len() + 2;
                Ok(String::from_utf8_lossy(text).into_owned())
            }
            None => Err(self.error("a name in double quotes", &readable(rest))),
        }
    }

    /// The place that has been reached.
    fn place(&self) -> FilePosition {
        if self.binary {
            FilePosition::Byte(self.at)
        } else {
            FilePosition::Line(1 + self.bytes[..self.at.min(self.bytes.len())].iter().filter(|b| **b == b'\n').count())
        }
    }

    /// The head of `$Nodes` or `$Elements`: how many blocks there are, and how many of `what` in all of them.
    pub(super) fn totals(&mut self, what: &'static str) -> Result<(u64, Total), MeshError> {
        let blocks = self.size("the number of blocks")?;
        let claimed = self.size("the number of nodes or elements in all blocks")?;
        let total = Total { what, claimed, place: self.place() };
        for _ in 0..2 {
            self.size("the smallest and the largest tag")?;
        }
        Ok((blocks, total))
    }

    /// Refuses blocks that hold more or fewer than the head says.
    pub(super) fn hold_to(&self, Total { what, claimed, place }: Total, found: usize) -> Result<(), MeshError> {
        if claimed == found as u64 {
            return Ok(());
        }
        Err(MeshFault::Total { section: self.section.clone(), what, claimed, found }.at(self.name, place))
    }

    /// An error at the place that has been reached.
    pub(super) fn error(&self, expected: &str, found: &str) -> MeshError {
        let found = if found.is_empty() { "the end of the file".to_owned() } else { format!("{found:?}") };
        MeshFault::Syntax { section: self.section.clone(), expected: expected.to_owned(), found }
            .at(self.name, self.place())
    }

    fn skip_whitespace(&mut self) {
        self.at += self.bytes[self.at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
    }

    /// The word at the cursor, which comes to stand in front of it; empty at the end of the file.
    fn peek_word(&mut self) -> &'a [u8] {
        self.skip_whitespace();
        let rest = &self.bytes[self.at..];
        let length = rest.iter().take_while(|b| !b.is_ascii_whitespace()).count();
        &rest[..length]
    }

    fn raw<const N: usize>(&mut self, what: &str) -> Result<[u8; N], MeshError> {
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(bytes) => {
                self.at += N;
                Ok(*bytes)
            }
            None => Err(self.error(what, "")),
        }
    }
}

/// The beginning of some bytes, short enough for a message.
fn readable(bytes: &[u8]) -> String {
    String::from_utf8_lossy(&bytes[..bytes.len().min(LONGEST_QUOTE)]).into_owned()
}
