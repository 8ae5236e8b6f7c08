//! Failure of a command: its kind, its exit code, and the details of the fault.

mod kinds;

use std::fmt;
use std::path::Path;

use serde::Serialize;

pub use kinds::known;

/// Failures of commands, in the classes that a script tells apart. Each has an exit code of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
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
}

/// Details of a fault beside its message. Those that are not known are left out of the JSON.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Details {
    /// The file that is at fault, or could not be read or written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line in it, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Path of keys in the scene, such as `loads[0].history.duration`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// The value that stands there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found: Option<String>,
    /// The value that should stand there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expected: Option<String>,
    /// Help for the user.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
}

impl Details {
    /// A file, of which nothing more is known. A name that is not UTF-8 is shown as well as that goes.
    pub fn of_file(file: impl AsRef<Path>) -> Self {
        Self { file: Some(file.as_ref().display().to_string()), ..Self::default() }
    }

    /// Its own, and what others know besides.
    fn or(self, others: Self) -> Self {
        Self {
            file: self.file.or(others.file),
            line: self.line.or(others.line),
            key: self.key.or(others.key),
            found: self.found.or(others.found),
            expected: self.expected.or(others.expected),
            help: self.help.or(others.help),
        }
    }
}

/// The beginning of the line of a message that says what to do.
const CURE: &str = "\n = ";

/// The object that stands for a failure under `--json`.
#[derive(Debug, Serialize)]
pub struct FailureReport {
    kind: Kind,
    exit_code: u8,
    message: String,
    #[serde(flatten)]
    details: Details,
}

impl FailureReport {
    /// A failure of a kind, with a message. A cure that only the message has, in its last line after ` = `, is help, too.
    pub fn new(kind: Kind, message: impl Into<String>, mut details: Details) -> Self {
        let message = message.into();
        details.help = details.help.or_else(|| Some(message.rsplit_once(CURE)?.1.to_owned()));
        Self { kind, exit_code: kind.exit_code(), message, details }
    }

    /// The same with another message and another line.
    pub fn with_message(self, message: impl FnOnce(&str) -> String, line: Option<usize>) -> Self {
        Self { message: message(&self.message), details: Details { line, ..self.details }, ..self }
    }

    /// The exit code of the program.
    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }
}

/// The message for people.
impl fmt::Display for FailureReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error: {}", self.message)
    }
}
