//! A scene: bodies, and what ties them together.

use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;

use dynamics::{Method, Start};

use crate::alone::BodyTexts;
use crate::body::Body;
use crate::check::Check;
use crate::check::tie::Ties;
use crate::document::{BODIES, Document, Node, OF_A_BODY, OUTPUT_OF_A_BODY};
use crate::error::SceneError;
use crate::file::{refuse_long, refuse_several, text_of};
use crate::shared::Shared;
use crate::text::deserialize::from_document;
use crate::text::name::{GROUND, ONLY_BODY, check_key};
use crate::tie::joint::{Bushing, Coupling, End, Joint, Spring};
use crate::tie::marker::GroundMarker;

/// Bodies of a scene at the most.
const MAX_BODIES: usize = 1000;

/// Keys at the root of a scene of several bodies.
const SHARED: [&str; 13] = [
    "title",
    "units",
    "initial",
    "relaxed",
    BODIES,
    GROUND,
    "joints",
    "springs",
    "bushings",
    "couplings",
    "time",
    "output",
    "accuracy",
];

/// A scene of one body or several, which obeys every rule that needs no mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The part that all bodies share.
    pub shared: Arc<Shared>,
    /// The bodies, in the order of the file. A single `[body]` has no name.
    pub bodies: Vec<Body>,
    /// Places on the ground, in the order of the file.
    pub ground: Vec<GroundMarker>,
    /// Joints between the bodies, in the order of the file.
    pub joints: Vec<Joint>,
    /// Springs between markers, in the order of the file.
    pub springs: Vec<Spring>,
    /// Bushings between markers, in the order of the file.
    pub bushings: Vec<Bushing>,
    /// Joints whose coordinates go together, in the order of the file.
    pub couplings: Vec<Coupling>,
    /// Where tied bodies begin.
    pub start: Start,
}

/// A body alone.
impl From<Body> for Scene {
    fn from(body: Body) -> Self {
        let Ties { ground, joints, springs, bushings, couplings, start } = Ties::default();
        Self { shared: body.shared.clone(), bodies: vec![body], ground, joints, springs, bushings, couplings, start }
    }
}

impl Deref for Scene {
    type Target = Shared;

    fn deref(&self) -> &Shared {
        &self.shared
    }
}

impl Scene {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// As [`Body::read`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        Self::parse(&text_of(path)?, path)
    }

    /// Checks the text of a scene file, as [`Body::parse`].
    ///
    /// # Errors
    /// As [`Body::parse`]; also for a table that belongs to a body and is not in one, and for names that cannot be parts of a
    /// path.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        refuse_long(text.len(), path)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut document = Document::parse(text, path)?;
        let ties = document.take_ties();
        let (shared, bodies) = bodies(&document, text, ties.as_ref())?;
        let Ties { ground, joints, springs, bushings, couplings, start } = match &ties {
            Some(ties) => Check::new(ties, shared.time.end).ties(from_document(ties)?, &bodies)?,
            None => Ties::default(),
        };
        Ok(Self { shared, bodies, ground, joints, springs, bushings, couplings, start })
    }

    /// The only body.
    ///
    /// # Errors
    /// The refusal of several.
    pub fn only_body(&self) -> Result<&Body, SceneError> {
        match &self.bodies[..] {
            [body] => Ok(body),
            several => {
                let names: Vec<&str> = several.iter().filter_map(|body| body.name.as_deref()).collect();
                Err(refuse_several(self.place(BODIES), &names))
            }
        }
    }

    /// The same with other things that all bodies share.
    #[must_use]
    pub fn with_shared(mut self, change: impl FnOnce(Shared) -> Shared) -> Self {
        self.shared = Arc::new(change(Shared::clone(&self.shared)));
        self.bodies.iter_mut().for_each(|body| body.shared = self.shared.clone());
        self
    }

    /// The method by which bodies in joints, springs or bushings move, or without any the method of all.
    pub fn method(&self) -> &Method {
        if self.has_ties() { &self.time.method } else { self.time.method.without_joints() }
    }

    /// True if joints, springs or bushings tie bodies together or to the ground.
    pub fn has_ties(&self) -> bool {
        self.bodies.iter().any(|body| body.tied)
    }

    /// True if joints, springs or bushings connect something.
    pub fn has_connections(&self) -> bool {
        !(self.joints.is_empty() && self.springs.is_empty() && self.bushings.is_empty())
    }

    /// The name of an end as `between` has it, such as `arm.root`, `ground.wall` or `ground`.
    pub fn name_of(&self, end: End) -> String {
        let name = match end {
            End::Body { body, marker } => self.bodies.get(body).and_then(|body| {
                let marker = body.markers.get(marker)?;
                Some(format!("{}.{}", body.name.as_deref().unwrap_or(ONLY_BODY), marker.name))
            }),
            End::Ground { marker } => {
                marker.and_then(|marker| self.ground.get(marker)).map(|marker| format!("{GROUND}.{}", marker.name))
            }
        };
        name.unwrap_or_else(|| GROUND.to_owned())
    }

    /// All ends that `between` can name.
    pub fn ends(&self) -> Vec<End> {
        let of_bodies = self.bodies.iter().enumerate();
        let of_bodies =
            of_bodies.flat_map(|(i, body)| (0..body.markers.len()).map(move |marker| End::Body { body: i, marker }));
        let of_ground = (0..self.ground.len()).map(Some).chain([None]);
        of_bodies.chain(of_ground.map(|marker| End::Ground { marker })).collect()
    }
}

/// The bodies of a document, without its `ties`, and what they share.
fn bodies(
    document: &Document<'_>,
    text: &str,
    ties: Option<&Document<'_>>,
) -> Result<(Arc<Shared>, Vec<Body>), SceneError> {
    let Some(bodies) = document.bodies() else {
        let body = Body::of_document(document, None, ties, None)?;
        return Ok((body.shared.clone(), vec![body]));
    };
    document.root().children().try_for_each(|child| check_shared(&child))?;
    if bodies.len() > MAX_BODIES {
        let found = format!("{} bodies", bodies.len());
        let help = "make several scenes of them";
        return Err(document.place(BODIES).refuse(found, format!("at most {MAX_BODIES}"), help));
    }
    let texts = BodyTexts::new(text);
    let (mut shared, mut read) = (None, Vec::with_capacity(bodies.len()));
    for node in &bodies {
        check_key(
            node,
            "rename the body, e.g. `hub`: it names a group in the results file, and `hub.tip` a point of it",
        )?;
        if ties.is_some() && node.name() == GROUND {
            let help = "rename the body: in `between`, this is the name of the ground";
            return Err(node.place_of_key().refuse("the name \"ground\"", "another one", help));
        }
        let body = Body::of_document(&document.of_body(node.name()), Some(texts.of(node.name())), ties, shared)?;
        shared = Some(body.shared.clone());
        read.push(body);
    }
    let help = "give each body a table, e.g. `[bodies.left]` with `mesh` and `material`";
    let none = || document.place(BODIES).refuse("no body", "one table for each body", help);
    Ok((shared.ok_or_else(none)?, read))
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
