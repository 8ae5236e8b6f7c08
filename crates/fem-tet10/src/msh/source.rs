//! The numbers of a MSH file, whether they are written as text or as bytes.

use std::str::FromStr;

use crate::error::{MeshError, Place};

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
        let mut source = Self { bytes, at: 0, binary: false, section: String::new(), name };
        let version_error = |found: String| MeshError::Version { source_name: name.to_owned(), found };
        let beginning = || String::from_utf8_lossy(&bytes[..bytes.len().min(24)]).into_owned();
        match source.next_section()? {
            Some(section) if section == "$MeshFormat" => {}
            _ => return Err(version_error(format!("a file that begins with {:?}", beginning()))),
        }
        let version = source.word().to_owned();
        if version != "4.1" {
            return Err(version_error(format!("version {version}")));
        }
        let binary = source.text_number::<u8>("0 (ASCII) or 1 (binary)")? == 1;
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

    /// Goes to the next line that begins with `$`; `None` at the end of the file.
    pub(super) fn next_section(&mut self) -> Result<Option<String>, MeshError> {
        let word = self.word();
        if word.is_empty() {
            return Ok(None);
        }
        if !word.starts_with('$') {
            let found = word.to_owned();
            return Err(self.error("a section that begins with $", &found));
        }
        let word = word.to_owned();
        self.section = word.clone();
        // A section of a binary file begins right after the newline.
        if self.bytes.get(self.at) == Some(&b'\r') {
            self.at += 1;
        }
        if self.bytes.get(self.at) == Some(&b'\n') {
            self.at += 1;
        }
        Ok(Some(word))
    }

    /// The word that closes the section must come next.
    pub(super) fn end_section(&mut self) -> Result<(), MeshError> {
        let expected = self.section.replacen('$', "$End", 1);
        let word = self.word();
        if word == expected {
            return Ok(());
        }
        let found = word.to_owned();
        Err(self.error(&expected, &found))
    }

    /// Passes over a section that is not needed, to behind its closing word (or the end of the file).
    pub(super) fn skip_section(&mut self) {
        let end = self.section.replacen('$', "$End", 1);
        let rest = &self.bytes[self.at..];
        let found = rest.windows(end.len()).position(|window| window == end.as_bytes());
        self.at += found.map_or(rest.len(), |offset| offset + end.len());
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
        let start = self.at;
        let word = self.word();
        if let Ok(number) = word.parse() {
            return Ok(number);
        }
        let found = word.to_owned();
        // Point at the word itself, not behind it.
        self.at = start + self.bytes[start..].iter().take_while(|b| b.is_ascii_whitespace()).count();
        Err(self.error(what, &found))
    }

    /// A text in double quotes.
    pub(super) fn quoted(&mut self) -> Result<String, MeshError> {
        self.skip_whitespace();
        let rest = &self.bytes[self.at..];
        let text = rest
            .strip_prefix(b"\"")
            .and_then(|inner| inner.iter().position(|b| *b == b'"').map(|end| &inner[..end]));
        match text {
            Some(text) => {
                self.at += text.len() + 2;
                Ok(String::from_utf8_lossy(text).into_owned())
            }
            None => Err(self.error("a name in double quotes", &String::from_utf8_lossy(&rest[..rest.len().min(24)]))),
        }
    }

    /// An error at the place that has been reached.
    pub(super) fn error(&self, expected: &str, found: &str) -> MeshError {
        let place = if self.binary {
            Place::Byte(self.at)
        } else {
            Place::Line(1 + self.bytes[..self.at.min(self.bytes.len())].iter().filter(|b| **b == b'\n').count())
        };
        let found = if found.is_empty() { "the end of the file".to_owned() } else { format!("\"{found}\"") };
        MeshError::Syntax {
            source_name: self.name.to_owned(),
            place,
            section: self.section.clone(),
            expected: expected.to_owned(),
            found,
        }
    }

    fn skip_whitespace(&mut self) {
        self.at += self.bytes[self.at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
    }

    /// The next word of the text; empty at the end of the file. At most 64 bytes, so that a message stays readable.
    fn word(&mut self) -> &'a str {
        self.skip_whitespace();
        let rest = &self.bytes[self.at..];
        let length = rest.iter().take(64).take_while(|b| !b.is_ascii_whitespace()).count();
        self.at += length;
        std::str::from_utf8(&rest[..length]).unwrap_or("(bytes that are no text)")
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
