//! A scene of several bodies.

use std::path::Path;

use crate::alone::BodyTexts;
use crate::document::{BODIES, Document, Node, OF_A_BODY, OUTPUT_OF_A_BODY};
use crate::error::SceneError;
use crate::file::{refuse_long, text_of};
use crate::scene::Scene;

/// Bodies of a scene at the most.
const MAX_BODIES: usize = 1000;

/// Keys at the root of a scene of several bodies.
const SHARED: [&str; 5] = ["title", "units", BODIES, "time", "output"];

/// A scene of one body or several, each as a scene of its own with the units, the times and the rows of all.
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    /// One scene for each body, in the order of the file. A single `[body]` has no name.
    pub bodies: Vec<Scene>,
}

impl System {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        Self::parse(&text_of(path)?, path)
    }

    /// Checks the text of a scene file, as [`Scene::parse`].
    ///
    /// # Errors
    /// As [`Scene::parse`]; also for a table that belongs to a body and is not in one, and for names that cannot be parts of a
    /// path.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        refuse_long(text.len(), path)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let document = Document::parse(text, path)?;
        let Some(bodies) = document.bodies() else {
            return Ok(Self { bodies: vec![Scene::of_document(&document, None)?] });
        };
        document.root().children().try_for_each(|child| check_shared(&child))?;
        if bodies.is_empty() {
            let help = "give each body a table, e.g. `[bodies.left]` with `mesh` and `material`";
            return Err(document.place(BODIES).refuse("no body", "one table for each body", help));
        }
        if bodies.len() > MAX_BODIES {
            let found = format!("{} bodies", bodies.len());
            let help = "make several scenes of them: nothing acts between the bodies";
            return Err(document.place(BODIES).refuse(found, format!("at most {MAX_BODIES}"), help));
        }
        let texts = BodyTexts::new(text);
        let scene = |body: &Node<'_>| {
            check_name(body)?;
            Scene::of_document(&document.of_body(body.name()), Some(texts.of(body.name())))
        };
        Ok(Self { bodies: bodies.iter().map(scene).collect::<Result<_, _>>()? })
    }

    /// True of a scene with named bodies.
    pub fn is_of_several(&self) -> bool {
        self.bodies.iter().any(|scene| scene.name.is_some())
    }
}

/// Refuses what belongs to a body beside the bodies.
fn check_shared(child: &Node<'_>) -> Result<(), SceneError> {
    let name = child.name();
    if name == "body" || OF_A_BODY.contains(&name) {
        let help = match name {
            "body" => "give the body a name among the others, e.g. `[bodies.hub]`".to_owned(),
            _ => format!("write it into the table of a body, e.g. `[bodies.hub.{name}]`"),
        };
        return Err(child.place_of_key().refuse(
            format!("both `{name}` and `{BODIES}`"),
            "what belongs to a body in its table",
            help,
        ));
    }
    let of_a_body = |output: &Node<'_>| OUTPUT_OF_A_BODY.contains(&output.name());
    if name == "output"
        && let Some(output) = child.children().find(of_a_body)
    {
        return Err(output.place_of_key().refuse(
            format!("`{}` for all bodies together", output.name()),
            "it in the table of a body",
            format!("write it there, e.g. `[bodies.hub]` with `{} = …`", output.name()),
        ));
    }
    if SHARED.contains(&name) {
        return Ok(());
    }
    Err(SceneError::UnknownKey { at: child.place_of_key().into(), key: name.to_owned(), known: SHARED.to_vec() })
}

/// Refuses the name of a body that cannot be a part of a path.
fn check_name(body: &Node<'_>) -> Result<(), SceneError> {
    let name = body.name();
    if !name.is_empty() && !name.contains(|c: char| c == '.' || c == '/' || c.is_control()) {
        return Ok(());
    }
    Err(body.place_of_key().refuse(
        format!("the name {name:?}"),
        "a name that is not empty, without `.`, `/` and control characters",
        "rename the body, e.g. `hub`: it names a group in the results file, and `hub.tip` a point of it",
    ))
}
