//! Diagnosis of an error: its kind, the place of the fault, the value found there, the expected one, and help.
//!
//! Each error tells its own where it is defined ([`Diagnostic`]), so that none is without a kind. An error that only passes another on
//! gives the diagnosis of the other, with the file that it knows besides.

#![forbid(unsafe_code)]

use std::error::Error;
use std::fmt;
use std::io;
use std::path::Path;

/// Failures of commands, in the classes that a script tells apart. Each has an exit code of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The arguments of the command are wrong.
    Usage,
    /// A scene, mesh, table or results file says something that cannot be right.
    Input,
    /// The model is understood, but known to give wrong answers or none.
    Refused,
    /// The computation did not come to its end.
    Run,
    /// The system refused a file, standard output or a thread.
    Io,
    /// A signal stopped the program.
    Stopped,
}

impl Kind {
    /// All of them, by exit code.
    pub const ALL: [Self; 6] = [Self::Usage, Self::Input, Self::Refused, Self::Run, Self::Io, Self::Stopped];

    /// The exit code of the program.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Usage => 2,
            Self::Input => 3,
            Self::Refused => 4,
            Self::Run => 5,
            Self::Io => 6,
            // As shells have it of a program that ctrl-C has ended.
            Self::Stopped => 130,
        }
    }

    /// Its name for scripts.
    pub fn name(self) -> &'static str {
        match self {
            Self::Usage => "usage",
            Self::Input => "input",
            Self::Refused => "refused",
            Self::Run => "run",
            Self::Io => "io",
            Self::Stopped => "stopped",
        }
    }

    /// Meaning in a few words.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Usage => "wrong arguments",
            Self::Input => "bad input: a scene, mesh, table or results file is wrong",
            Self::Refused => "refused model: its answers would be wrong, or it has none",
            Self::Run => "failed run: the computation did not come to its end",
            Self::Io => "input or output: the system refused a file, standard output or a thread",
            Self::Stopped => "stopped by a signal (ctrl-C, SIGTERM, SIGHUP)",
        }
    }

    /// The diagnosis of a fault without a place.
    pub fn alone(self) -> Diagnosis {
        let (file, line, key, found, expected, help) = Default::default();
        Diagnosis { kind: self, file, line, key, found, expected, help }
    }

    /// The diagnosis of a fault in a file. A name that is not UTF-8 is shown as well as that goes.
    pub fn of(self, file: impl AsRef<Path>) -> Diagnosis {
        self.alone().in_file(file)
    }
}

/// Everything that is known of a fault beside its message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnosis {
    /// Its class.
    pub kind: Kind,
    /// The file that is at fault, or could not be read or written.
    pub file: Option<String>,
    /// Line in it, from 1.
    pub line: Option<usize>,
    /// Path of keys in the scene, such as `loads[0].history.duration`, or an option.
    pub key: Option<String>,
    /// The value that stands there.
    pub found: Option<String>,
    /// The value that should stand there.
    pub expected: Option<String>,
    /// Help for the user.
    pub help: Option<String>,
}

impl Diagnosis {
    /// In a file, unless its own is known.
    #[must_use]
    pub fn in_file(mut self, file: impl AsRef<Path>) -> Self {
        self.file = self.file.or_else(|| Some(file.as_ref().display().to_string()));
        self
    }

    /// At a line of the file, from 1.
    #[must_use]
    pub fn line(mut self, line: usize) -> Self {
        self.line = Some(line);
        self
    }

    /// At a key or an option.
    #[must_use]
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.key = Some(key.into());
        self
    }

    /// With the value that stands there.
    #[must_use]
    pub fn found(mut self, found: impl Into<String>) -> Self {
        self.found = Some(found.into());
        self
    }

    /// With the value that should stand there.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// The error with this diagnosis, whose message says its place, these words and the help.
    pub fn says(self, words: impl Into<String>) -> Failure {
        Refusal { diagnosis: self, words: Some(words.into()) }.into()
    }

    /// With help.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// An error that tells its diagnosis.
pub trait Diagnostic: Error + Send + Sync + 'static {
    /// Kind, place and cure. An error that only passes another on gives the diagnosis of the other.
    fn diagnosis(&self) -> Diagnosis;

    /// The same in a file that only the caller knows, which its message begins with.
    fn in_file(self, file: impl AsRef<Path>) -> Failure
    where
        Self: Sized,
    {
        InFile { file: file.as_ref().display().to_string(), source: self.into() }.into()
    }
}

/// Any error that tells its diagnosis.
pub type Failure = Box<dyn Diagnostic>;

impl<E: Diagnostic> From<E> for Failure {
    fn from(error: E) -> Self {
        Box::new(error)
    }
}

impl Error for Failure {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&**self)
    }
}

/// An error with the file that it is in.
#[derive(Debug)]
struct InFile {
    file: String,
    source: Failure,
}

impl fmt::Display for InFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.source)
    }
}

impl Error for InFile {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&*self.source)
    }
}

impl Diagnostic for InFile {
    fn diagnosis(&self) -> Diagnosis {
        self.source.diagnosis().in_file(&self.file)
    }
}

impl Diagnostic for io::Error {
    fn diagnosis(&self) -> Diagnosis {
        Kind::Io.alone()
    }
}

/// The beginning of the line of a message that says what to do.
pub const CURE: &str = "\n = ";

/// Wrong input, or a model that is refused. Its message is made of its diagnosis: place, found and expected, or its own words, and help.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    diagnosis: Diagnosis,
    words: Option<String>,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Diagnosis { file, line, key, found, expected, help, .. } = &self.diagnosis;
        if let Some(file) = file {
            write!(f, "{file}")?;
            line.map_or(Ok(()), |line| write!(f, ":{line}"))?;
            f.write_str(": ")?;
        }
        key.as_ref().map_or(Ok(()), |key| write!(f, "{key}: "))?;
        match (found, expected) {
            _ if self.words.is_some() => f.write_str(self.words.as_deref().unwrap_or_default())?,
            (Some(found), Some(expected)) => write!(f, "found {found}, expected {expected}")?,
            (Some(found), None) => write!(f, "found {found}")?,
            (None, expected) => write!(f, "expected {}", expected.as_deref().unwrap_or_default())?,
        }
        help.as_ref().map_or(Ok(()), |help| write!(f, "{CURE}{help}"))
    }
}

impl Error for Refusal {}

impl Diagnostic for Refusal {
    fn diagnosis(&self) -> Diagnosis {
        self.diagnosis.clone()
    }
}

impl From<Diagnosis> for Refusal {
    fn from(diagnosis: Diagnosis) -> Self {
        Self { diagnosis, words: None }
    }
}

impl From<Diagnosis> for Failure {
    fn from(diagnosis: Diagnosis) -> Self {
        Refusal::from(diagnosis).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_of_a_refusal_has_all_that_is_known() {
        let whole = Kind::Usage.of("a.toml").line(3).key("--rows").found("9").expected("0 to 4").help("ask for less");
        assert_eq!(Refusal::from(whole).to_string(), "a.toml:3: --rows: found 9, expected 0 to 4\n = ask for less");
        let of = |diagnosis: Diagnosis| Failure::from(diagnosis).to_string();
        let own = Kind::Io.of("a.csv").found("3").help("put it back").says("it is gone");
        assert_eq!(
            (own.to_string(), own.diagnosis().found),
            ("a.csv: it is gone\n = put it back".into(), Some("3".into()))
        );
        assert_eq!(own.diagnosis().kind, Kind::Io);
        assert_eq!(of(Kind::Usage.alone().expected("2")), "expected 2");
        assert_eq!(of(Kind::Input.of("a.csv").in_file("b.csv").found("1")), "a.csv: found 1");
    }
}
