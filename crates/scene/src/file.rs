//! From the scene file to a [`Body`].

use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use crate::alone::{BodyText, BodyTexts};
use crate::body::Body;
use crate::check::Check;
use crate::document::{BODIES, Document, Node};
use crate::error::SceneError;
use crate::section::Sections;
use crate::shared::Shared;
use crate::text::name::ONLY_BODY;
use crate::text::ordinary_file::open_ordinary;
use crate::text::place::Place;

/// The longest scene that is read, in bytes (1 MiB): a text of nothing but tables within tables is 600 times as long in
/// memory. Long tables of numbers have files of their own.
const LONGEST: u64 = 1 << 20;

impl Body {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// [`SceneError`] if the file cannot be read, is longer than 1 MiB, is not TOML in UTF-8, or
    /// breaks a rule of the scene file.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        Self::parse(&text_of(path)?, path)
    }

    /// Checks the text of a scene file of one body. `path` is where the text comes from: it is named in
    /// messages, and the mesh and the tables of histories are relative to its folder. Of the
    /// files that it names, the tables are read, up to 16 MiB in all; the mesh is not. Joints, springs and bushings
    /// are those of a [`Scene`](crate::Scene), and not looked at.
    ///
    /// # Errors
    /// [`SceneError`] if the text is longer than 1 MiB, is not TOML, breaks a rule of the scene file, or has several bodies.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::parse_body(text, path, None)
    }

    /// The same, of the body with a name among several.
    ///
    /// # Errors
    /// As [`Body::parse`]; also if there is no body of that name.
    pub fn parse_body(text: &str, path: impl AsRef<Path>, name: Option<&str>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        refuse_long(text.len(), path)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut document = Document::parse(text, path)?;
        let ties = document.take_ties();
        let bodies = document.bodies();
        let names: Vec<&str> = bodies.iter().flatten().map(Node::name).collect();
        let refuse = |found: String, expected: &str, help: String| {
            let key = if bodies.is_some() { BODIES } else { "body" };
            Err(document.place(key).refuse(found, expected, help))
        };
        match name {
            None if bodies.is_none() => Self::of_document(&document, None, ties.as_ref(), None),
            None => Err(refuse_several(document.place(BODIES), &names)),
            Some(name) if names.contains(&name) => {
                Self::of_document(&document.of_body(name), Some(BodyTexts::new(text).of(name)), ties.as_ref(), None)
            }
            Some(name) if bodies.is_none() => refuse(
                "a single body, which has no name".to_owned(),
                &format!("a body `{name}`"),
                "leave the name out".into(),
            ),
            Some(name) => {
                let help = format!("name one of those that are there: {}", names.join(", "));
                refuse(format!("no body `{name}`"), "the name of a body", help)
            }
        }
    }

    /// Checks a body of a document, which may be one of several. `ties` are the joints and springs of the file; `shared` is the
    /// shared part of the file, if an earlier body has been read with it.
    pub(crate) fn of_document(
        document: &Document<'_>,
        body_text: Option<BodyText<'_>>,
        ties: Option<&Document<'_>>,
        shared: Option<Arc<Shared>>,
    ) -> Result<Self, SceneError> {
        let sections = crate::text::deserialize::from_document(document)?;
        let Sections { title, units, mut body, modes, effects, frame, initial, constraints, mut loads, .. } = sections;
        let Sections { time, output, accuracy, .. } = sections;

        let check = Check::new(document, time.end);
        check.label("title", &title)?;
        check.units(&units)?;
        let markers = std::mem::take(&mut body.markers);
        let source = check.source(body)?;
        let mut markers = check.markers(markers, &source)?;
        let modes = check.modes(modes, &source)?;
        check.frame(frame.as_ref())?;
        let constraint = check.constraints(constraints, &source)?;
        check.initial(&initial, &modes, constraint.as_ref())?;
        check.loads(&mut loads, &source, constraint.as_ref())?;
        check.effects(&effects, &modes, &initial, constraint.as_ref(), &loads, !markers.is_empty())?;
        check.effects_of_elements(&effects, &modes, &source)?;
        let time = check.time(&time, ties.is_some())?;
        check.fixed_effects(&effects, time.method)?;
        check.accuracy(accuracy)?;
        let (rows, output) = check.output(output, &time, &source)?;
        let tied = ties.is_some_and(|ties| ties.ties(body_text.as_ref().map_or(ONLY_BODY, |text| text.name)));
        match &constraint {
            Some(constraint) if tied => check.held_markers(constraint, &mut markers),
            _ if !tied => check.turns(&source)?,
            _ => {}
        }
        let of_file = || Shared {
            title,
            units,
            time,
            rows,
            accuracy,
            path: document.path().to_owned(),
            text: document.text().into(),
            bodies_of_file: body_text.as_ref().map_or(1, |text| text.bodies),
        };
        Ok(Self {
            name: body_text.as_ref().map(|text| text.name.to_owned()),
            shared: shared.unwrap_or_else(|| Arc::new(of_file())),
            source,
            modes,
            effects,
            frame,
            initial,
            constraint,
            tied,
            markers,
            loads,
            output,
            text_alone: body_text.map_or_else(|| document.text().to_owned(), |text| text.alone),
        })
    }

    /// The place in the scene file of the value with a key path such as
    /// `body.point_masses[2].at` or `output.points.P1` (a name with other characters than
    /// letters, digits, `-` and `_` in quotes); where the file lacks the key, the place of what
    /// would be around it.
    pub fn place(&self, key: &str) -> Place {
        self.shared.place_from(self.name.as_deref(), key)
    }

    /// The refusal of the value with the key path `key`, for rules that need more than the file,
    /// e.g. a point too far from the mesh. Its message is
    /// `file:line:column: key: found …, expected …`, the line, and help.
    pub fn refuse(
        &self,
        key: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        self.place(key).refuse(found, expected, help)
    }
}

impl Shared {
    /// The place in the scene file of the value with a key path such as `joints[2].between`, or of what is around it.
    pub fn place(&self, key: &str) -> Place {
        self.place_from(None, key)
    }

    /// The same with a key path in a body.
    fn place_from(&self, body: Option<&str>, key: &str) -> Place {
        match (Document::parse(&self.text, &self.path), body) {
            (Ok(document), Some(name)) => document.of_body(name).place(key),
            (Ok(document), None) => document.place(key),
            (Err(_), _) => Place::new(&self.path, &self.text, 0..0, key.to_owned()),
        }
    }
}

/// The text of a scene file, not checked yet.
///
/// # Errors
/// [`SceneError`] if the file cannot be read, is longer than 1 MiB, or is not UTF-8.
pub fn text_of(path: &Path) -> Result<String, SceneError> {
    let file = open_ordinary(path).map_err(|cause| unreadable(path, cause))?;
    text_from(file, path)
}

/// The text of a scene from elsewhere, such as standard input; `path` is its name in messages.
///
/// # Errors
/// As [`text_of`].
pub fn text_from(reader: impl Read, path: &Path) -> Result<String, SceneError> {
    let mut bytes = Vec::new();
    reader.take(LONGEST + 1).read_to_end(&mut bytes).map_err(|cause| unreadable(path, cause))?;
    refuse_long(bytes.len(), path)?;
    String::from_utf8(bytes).map_err(|error| {
        let (good, bad) = error.as_bytes().split_at(error.utf8_error().valid_up_to());
        SceneError::NotUtf8 {
            path: path.to_owned(),
            line: 1 + good.iter().filter(|&&byte| byte == b'\n').count(),
            byte: bad.first().copied().unwrap_or_default(),
        }
    })
}

/// The refusal of several bodies where one is wanted.
pub(crate) fn refuse_several(place: Place, names: &[&str]) -> SceneError {
    let help = format!("name one of them: {}", names.join(", "));
    place.refuse(format!("a scene of {} bodies", names.len()), "one body", help)
}

pub(crate) fn refuse_long(bytes: usize, path: &Path) -> Result<(), SceneError> {
    if bytes as u64 <= LONGEST {
        return Ok(());
    }
    Err(SceneError::TooLarge { path: path.to_owned(), limit: LONGEST })
}

fn unreadable(path: &Path, cause: io::Error) -> SceneError {
    let help = match cause.kind() {
        io::ErrorKind::NotFound => "check its name; it is relative to the folder you are in",
        io::ErrorKind::PermissionDenied => "get permission to read it",
        io::ErrorKind::IsADirectory => "this is a folder; name the scene file in it",
        _ => "check that it is an ordinary file",
    };
    SceneError::Unreadable { path: path.to_owned(), cause, help }
}
