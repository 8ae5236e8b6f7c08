//! Errors of a scene, and their display.

use std::io;
use std::path::{Path, PathBuf};

use diagnostic::{Diagnosis, Diagnostic, Kind};

use crate::document::{Document, NotToml, OF_A_BODY};
use crate::text::example::example;
use crate::text::place::Place;
use crate::text::shorten::shorten;
use crate::text::suggest::{list, nearest};

const TOO_LARGE_CURE: &str = "name a scene file; the mesh goes into a file of its own, named by `body.mesh`, and so does a \
                              long table of a history, named by `file`";
const NOT_UTF8_CURE: &str = "save it with encoding UTF-8";

/// Refusal of a scene. The message gives the place, what was found, what was expected and
/// help, with the line and a caret under it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the message of a variant says what its fields are
pub enum SceneError {
    /// The file is not there or cannot be read.
    #[error("{}: the file cannot be read: {cause}\n = {help}", .path.display())]
    Unreadable { path: PathBuf, cause: io::Error, help: &'static str },
    /// The file is longer than a scene can be. `limit`: in bytes.
    #[error("{}: the scene file is longer than {limit} bytes\n = {TOO_LARGE_CURE}", .path.display())]
    TooLarge { path: PathBuf, limit: u64 },
    /// The file is not text in UTF-8. `line`: that of the first such byte, from 1.
    #[error(
        "{}:{line}: the scene file is not text in UTF-8: found byte 0x{byte:02x} here\n = {NOT_UTF8_CURE}",
        .path.display()
    )]
    NotUtf8 { path: PathBuf, line: usize, byte: u8 },
    /// The text is not TOML. The key of its place is empty.
    #[error("{}", .at.show(&format!("this is not TOML: {message}"), syntax_help(.message)))]
    Syntax { at: Box<Place>, message: String },
    /// A key that does not exist, most often misspelt.
    #[error("{}", show_unknown(.at, "key", .key, .known))]
    UnknownKey { at: Box<Place>, key: String, known: Vec<&'static str> },
    /// A kind, scheme or frame that does not exist, most often misspelt.
    #[error("{}", show_unknown(.at, "value", .found, .known))]
    UnknownName { at: Box<Place>, found: String, known: Vec<&'static str> },
    /// A required key or section is absent. The path of the key is that of the absent one.
    #[error("{}", show_missing(.at, .key))]
    MissingKey { at: Box<Place>, key: String },
    /// A value of the wrong type or out of range, or values that contradict each other.
    #[error("{}", .at.show(&format!("found {found}, expected {expected}"), help))]
    Invalid { at: Box<Place>, found: String, expected: String, help: String },
}

impl SceneError {
    /// The error of a scene that another file names, in which nothing of its text is shown: the other file may come from elsewhere and
    /// name any file of the user's.
    #[must_use]
    pub fn without_text(self) -> Self {
        const HELP: &str = "`flexframe modes` of that file shows its line";
        match self {
            Self::Unreadable { .. } | Self::TooLarge { .. } | Self::NotUtf8 { .. } => self,
            Self::Syntax { at, .. } => at.hidden().refuse("no TOML", "a scene", HELP),
            Self::UnknownKey { at, known, .. } => {
                at.hidden().refuse("a key that is not known", format!("one of {}", list(&known)), HELP)
            }
            Self::UnknownName { at, known, .. } => {
                at.hidden().refuse("a value that is not known", format!("one of {}", list(&known)), HELP)
            }
            Self::MissingKey { at, key } => Self::MissingKey { at: at.hidden().into(), key },
            Self::Invalid { at, expected, .. } => at.hidden().refuse("another value", expected, HELP),
        }
    }

    /// The same fault at the line that its key has in another text of the scene, which lacks some keys of this one. `None` where it
    /// has no place.
    pub fn at_line_of(&self, text: &str) -> Option<Self> {
        let moved = |at: &Place| {
            let document = Document::parse(text, &at.file).ok();
            let mut place = at.clone();
            place.line = document.map_or(at.line, |document| document.place(&at.key).line);
            Box::new(place)
        };
        match self {
            Self::Unreadable { .. } | Self::TooLarge { .. } | Self::NotUtf8 { .. } | Self::Syntax { .. } => None,
            Self::UnknownKey { at, key, known } => {
                Some(Self::UnknownKey { at: moved(at), key: key.clone(), known: known.clone() })
            }
            Self::UnknownName { at, found, known } => {
                Some(Self::UnknownName { at: moved(at), found: found.clone(), known: known.clone() })
            }
            Self::MissingKey { at, key } => Some(Self::MissingKey { at: moved(at), key: key.clone() }),
            Self::Invalid { at, found, expected, help } => Some(Self::Invalid {
                at: moved(at),
                found: found.clone(),
                expected: expected.clone(),
                help: help.clone(),
            }),
        }
    }

    /// Where in the scene file; `None` if it could not be read as text, or is too long.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Unreadable { .. } | Self::TooLarge { .. } | Self::NotUtf8 { .. } => None,
            Self::Syntax { at, .. }
            | Self::UnknownKey { at, .. }
            | Self::UnknownName { at, .. }
            | Self::MissingKey { at, .. }
            | Self::Invalid { at, .. } => Some(at),
        }
    }

    /// The scene file.
    pub fn file(&self) -> &Path {
        match self {
            Self::Unreadable { path, .. } | Self::TooLarge { path, .. } | Self::NotUtf8 { path, .. } => path,
            Self::Syntax { at, .. }
            | Self::UnknownKey { at, .. }
            | Self::UnknownName { at, .. }
            | Self::MissingKey { at, .. }
            | Self::Invalid { at, .. } => &at.file,
        }
    }

    /// Line in the scene file, from 1, where the fault is in one.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::NotUtf8 { line, .. } => Some(*line),
            _ => self.place().map(|place| place.line),
        }
    }

    /// The value that stands there, if any.
    pub fn found(&self) -> Option<String> {
        match self {
            Self::Unreadable { .. } | Self::TooLarge { .. } | Self::Syntax { .. } | Self::MissingKey { .. } => None,
            Self::NotUtf8 { byte, .. } => Some(format!("byte 0x{byte:02x}")),
            Self::UnknownKey { key: found, .. } | Self::UnknownName { found, .. } => Some(shorten(found)),
            Self::Invalid { found, .. } => Some(found.clone()),
        }
    }

    /// The value that should stand there, where it is known.
    pub fn expected(&self) -> Option<String> {
        match self {
            Self::Unreadable { .. } => None,
            Self::TooLarge { limit, .. } => Some(format!("at most {limit} bytes")),
            Self::NotUtf8 { .. } => Some("text in UTF-8".to_owned()),
            Self::Syntax { .. } => Some("TOML".to_owned()),
            Self::UnknownKey { known, .. } | Self::UnknownName { known, .. } => {
                Some(format!("one of {}", list(known))).filter(|_| !known.is_empty())
            }
            Self::MissingKey { key, .. } => Some(format!("`{key}`")),
            Self::Invalid { expected, .. } => Some(expected.clone()),
        }
    }

    /// Help for the user.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Unreadable { help, .. } => Some((*help).to_owned()),
            Self::TooLarge { .. } => Some(TOO_LARGE_CURE.to_owned()),
            Self::NotUtf8 { .. } => Some(NOT_UTF8_CURE.to_owned()),
            Self::Syntax { message, .. } => Some(syntax_help(message).to_owned()),
            Self::UnknownKey { at, key: found, known } | Self::UnknownName { at, found, known } => {
                Some(unknown_help(at, found, known))
            }
            Self::MissingKey { at, .. } => Some(missing_help(at)),
            Self::Invalid { help, .. } => Some(help.clone()),
        }
    }
}

impl Place {
    /// The refusal of the value at this place.
    pub fn refuse(self, found: impl Into<String>, expected: impl Into<String>, help: impl Into<String>) -> SceneError {
        let (found, expected, help) = (found.into(), expected.into(), help.into());
        SceneError::Invalid { at: self.into(), found, expected, help }
    }
}

impl From<NotToml> for SceneError {
    fn from(NotToml { at, message }: NotToml) -> Self {
        Self::Syntax { at, message }
    }
}

fn show_unknown(at: &Place, what: &str, found: &str, known: &[&str]) -> String {
    let shown = shorten(found);
    let near = nearest(found, known).filter(|_| !stands_beside_the_body(at, found));
    let question = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    at.show(&format!("unknown {what} `{shown}`{question}"), &unknown_help(at, found, known))
}

/// True for a table in `[body]` that is one of the scene.
fn stands_beside_the_body(at: &Place, found: &str) -> bool {
    OF_A_BODY.contains(&found) && at.key.strip_prefix("body.") == Some(found)
}

fn unknown_help(at: &Place, found: &str, known: &[&str]) -> String {
    if stands_beside_the_body(at, found) {
        let is_list = ["constraints", "loads"].contains(&found);
        let table = if is_list { format!("[[{found}]]") } else { format!("[{found}]") };
        return format!(
            "write it beside [body], as {table}; only bodies of several, [bodies.NAME], have it themselves"
        );
    }
    match nearest(found, known) {
        Some(near) => format!("rename it to `{near}` (possible here: {})", list(known)),
        None if known.contains(&"expression") => format!(
            "possible here: {}; a formula in the time t is {{ kind = \"expression\", formula = \"t^2\" }}",
            list(known)
        ),
        None => format!("possible here: {}", list(known)),
    }
}

fn show_missing(at: &Place, key: &str) -> String {
    at.show(&format!("`{key}` is missing"), &missing_help(at))
}

fn missing_help(at: &Place) -> String {
    match example(&at.key) {
        Some(example) => format!("add it, for example:\n{example}"),
        None => "add it".to_owned(),
    }
}

fn syntax_help(message: &str) -> &'static str {
    match message {
        "duplicate key" => "keep one of the two",
        _ => "correct it; a line is `key = value` or `[section]`, and text stands in quotes",
    }
}

impl Diagnostic for SceneError {
    fn diagnosis(&self) -> Diagnosis {
        let kind = if matches!(self, Self::Unreadable { .. }) { Kind::Io } else { Kind::Input };
        Diagnosis {
            line: self.line(),
            key: self.place().map(|place| place.key.clone()).filter(|key| !key.is_empty()),
            found: self.found(),
            expected: self.expected(),
            help: self.help(),
            ..kind.of(self.file())
        }
    }
}
