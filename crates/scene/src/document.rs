//! A TOML document in which every value knows its key path and its place in the text.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use crate::text::place::Place;

/// The table of the bodies of a scene of several.
pub(crate) const BODIES: &str = "bodies";

/// Tables of a scene that belong to its body, beside `body` itself.
pub(crate) const OF_A_BODY: [&str; 6] = ["modes", "effects", "frame", "initial", "constraints", "loads"];

/// Tables of a scene that tie its bodies together.
pub(crate) const TIES: [&str; 6] = ["relaxed", "ground", "joints", "springs", "bushings", "couplings"];

/// A table of a body, and with a word in its place the start of all bodies.
const START: &str = "initial";

/// Keys of `output` that belong to a body.
pub(crate) const OUTPUT_OF_A_BODY: [&str; 3] = ["points", "stress", "peak_stress"];

/// A parsed TOML text.
pub(crate) struct Document<'t> {
    path: &'t Path,
    text: &'t str,
    root: Spanned<DeValue<'t>>,
    /// The body that it is seen from, of a scene of several.
    body: Option<String>,
}

/// A text that is not TOML.
#[derive(Debug)]
pub(crate) struct NotToml {
    /// Where; its key is empty.
    pub at: Box<Place>,
    /// Message of the TOML parser.
    pub message: String,
}

/// A value of a document.
#[derive(Clone)]
pub(crate) struct Node<'d> {
    document: &'d Document<'d>,
    /// Path of keys from the root, e.g. `loads[0].history.start`; empty for the root.
    pub path: String,
    /// The last key; `None` for the root and for entries of a list.
    pub key: Option<&'d Spanned<DeString<'d>>>,
    pub value: &'d Spanned<DeValue<'d>>,
}

impl<'t> Document<'t> {
    /// Parses `text`; `path` serves for messages only.
    pub fn parse(text: &'t str, path: &'t Path) -> Result<Self, NotToml> {
        match DeTable::parse(text) {
            Ok(table) => {
                // What the root lacks is missed at the end of the text.
                let end = text.trim_end().len();
                let root = Spanned::new(end..end, DeValue::Table(table.into_inner()));
                Ok(Self { path, text, root, body: None })
            }
            Err(error) => {
                let at = Place::new(path, text, error.span().unwrap_or(0..0), String::new());
                Err(NotToml { at: Box::new(at), message: error.message().to_owned() })
            }
        }
    }

    /// Takes out what ties bodies together, as a document of its own; `None` where nothing does.
    pub fn take_ties(&mut self) -> Option<Self> {
        let table = match self.root.get_mut() {
            DeValue::Table(table) => table,
            _ => return None,
        };
        let mut ties = DeTable::new();
        for key in TIES {
            if let Some((key, value)) = table.remove_entry(key) {
                ties.insert(key, value);
            }
        }
        if table.get(START).is_some_and(|start| start.get_ref().is_str())
            && let Some((key, value)) = table.remove_entry(START)
        {
            ties.insert(key, value);
        }
        if ties.is_empty() {
            return None;
        }
        let root = Spanned::new(self.root.span(), DeValue::Table(ties));
        Some(Self { path: self.path, text: self.text, root, body: None })
    }

    /// True if an end of a joint, a spring or a bushing of this document is on the body of this name.
    pub fn ties(&self, body: &str) -> bool {
        let lists = self.root().children().filter(|child| child.name() != "ground").collect::<Vec<_>>();
        let between = lists.iter().flat_map(Node::children).flat_map(|tie| tie.children().collect::<Vec<_>>());
        let ends = between.filter(|key| key.name() == "between").flat_map(|key| key.children().collect::<Vec<_>>());
        let of = |end: Node<'_>| end.value.get_ref().as_str().and_then(|end| end.split('.').next().map(str::to_owned));
        ends.filter_map(of).any(|name| name == body)
    }

    /// Names of the bodies of a scene of several, in the order of the text; `None` of a scene of one.
    pub fn bodies(&self) -> Option<Vec<Node<'_>>> {
        let bodies = self.root().children().find(|child| child.name() == BODIES)?;
        Some(bodies.children().collect())
    }

    /// The document as the scene of one of several bodies: `bodies.NAME` in place of `body`, and what else belongs to a body
    /// where it is in a scene of one. Places stay those of the text.
    pub fn of_body(&self, name: &str) -> Self {
        let (mut root, mut body, mut output) = (DeTable::new(), DeTable::new(), DeTable::new());
        // Only its own part is copied: there may be many bodies.
        let shared = self.root.get_ref().as_table();
        let bodies = shared.and_then(|shared| shared.get(BODIES)?.get_ref().as_table());
        let own = bodies.and_then(|bodies| bodies.get(name));
        let at = own.map_or_else(|| self.root.span(), Spanned::span);
        for (key, value) in shared.into_iter().flatten() {
            match &**key.get_ref() {
                BODIES => {}
                "output" => output.extend(entries(Some(value))),
                _ => _ = root.insert(key.clone(), value.clone()),
            }
        }
        for (key, value) in entries(own) {
            let to = match &**key.get_ref() {
                name if OF_A_BODY.contains(&name) => &mut root,
                name if OUTPUT_OF_A_BODY.contains(&name) => &mut output,
                _ => &mut body,
            };
            to.insert(key, value);
        }
        for (key, table) in [("body", body), ("output", output)] {
            root.insert(Spanned::new(at.clone(), key.into()), Spanned::new(at.clone(), DeValue::Table(table)));
        }
        let root = Spanned::new(self.root.span(), DeValue::Table(root));
        Self { path: self.path, text: self.text, root, body: Some(name.to_owned()) }
    }

    /// A key path as it is in the file.
    fn in_file(&self, path: String) -> String {
        let Some(name) = &self.body else { return path };
        let body = join(BODIES, name);
        let first = |path: &str| path.split(['.', '[']).next().unwrap_or_default().to_owned();
        if let Some(rest) = path.strip_prefix("body").filter(|_| first(&path) == "body") {
            return format!("{body}{rest}");
        }
        if let Some(rest) = path.strip_prefix("output.").filter(|rest| OUTPUT_OF_A_BODY.contains(&&*first(rest))) {
            return format!("{body}.{rest}");
        }
        if OF_A_BODY.contains(&&*first(&path)) { format!("{body}.{path}") } else { path }
    }

    /// The scene file.
    pub fn path(&self) -> &'t Path {
        self.path
    }

    /// The text.
    pub fn text(&self) -> &'t str {
        self.text
    }

    /// The folder of the scene file, which the paths in it are relative to.
    pub fn folder(&self) -> &'t Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    pub fn root(&self) -> Node<'_> {
        Node { document: self, path: String::new(), key: None, value: &self.root }
    }

    /// The value with the given key path, or where it is absent the innermost table or list
    /// around it.
    pub fn nearest(&self, path: &str) -> Node<'_> {
        let mut node = self.root();
        while let Some(child) = node.child_towards(path) {
            node = child;
        }
        node
    }

    /// The place of the value with the given key path, or of what is around it.
    pub fn place(&self, path: &str) -> Place {
        Place::new(self.path, self.text, self.nearest(path).value.span(), self.in_file(path.to_owned()))
    }

    /// The text in `range`; empty if it is not a range of this text.
    pub fn slice(&self, range: Range<usize>) -> &'t str {
        self.text.get(range).unwrap_or_default()
    }
}

impl<'d> Node<'d> {
    /// The entries of a table or a list, in the order of the text; nothing for other values.
    pub fn children(&self) -> Box<dyn Iterator<Item = Node<'d>> + 'd> {
        let (document, path) = (self.document, self.path.clone());
        match self.value.get_ref() {
            DeValue::Table(table) => {
                let mut entries: Vec<_> = table.iter().collect();
                entries.sort_by_key(|(key, _)| key.span().start);
                Box::new(entries.into_iter().map(move |(key, value)| Node {
                    document,
                    path: join(&path, key.get_ref()),
                    key: Some(key),
                    value,
                }))
            }
            DeValue::Array(list) => {
                Box::new(list.iter().enumerate().map(move |(i, value)| entry(document, &path, i, value)))
            }
            _ => Box::new(std::iter::empty()),
        }
    }

    /// The child that is, or has within it, the value with the given key path.
    fn child_towards(&self, path: &str) -> Option<Node<'d>> {
        // A list may be long, and is not searched.
        if let DeValue::Array(list) = self.value.get_ref() {
            let (index, _) = path.strip_prefix(&self.path)?.strip_prefix('[')?.split_once(']')?;
            let index = index.parse().ok()?;
            return list.get(index).map(|value| entry(self.document, &self.path, index, value));
        }
        let leads_there = |child: &Node| {
            path.strip_prefix(&child.path).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        self.children().find(leads_there)
    }

    /// Keys that a table of `bodies` has in the text, and that belong to other tables in a scene of one body.
    pub fn keys_of_others(&self) -> impl Iterator<Item = &'static str> {
        let is_of_several = self.document.body.is_some() && self.path == "body";
        OF_A_BODY.into_iter().chain(OUTPUT_OF_A_BODY).filter(move |_| is_of_several)
    }

    /// The last key without quotes; empty for the root and for entries of a list.
    pub fn name(&self) -> &'d str {
        self.key.map_or("", |key| key.get_ref())
    }

    /// The value as it is written in the text.
    pub fn written(&self) -> &'d str {
        self.document.slice(self.value.span())
    }

    pub fn place(&self) -> Place {
        self.place_of(self.value.span(), self.path.clone())
    }

    pub fn place_of_key(&self) -> Place {
        let span = self.key.map_or_else(|| self.value.span(), Spanned::span);
        self.place_of(span, self.path.clone())
    }

    /// The place of a key that this table lacks.
    pub fn place_of_missing(&self, key: &str) -> Place {
        self.place_of(self.value.span(), join(&self.path, key))
    }

    fn place_of(&self, span: Range<usize>, path: String) -> Place {
        Place::new(self.document.path, self.document.text, span, self.document.in_file(path))
    }
}

/// Copies of the entries of a table; none of another value.
fn entries<'t>(
    table: Option<&Spanned<DeValue<'t>>>,
) -> impl Iterator<Item = (Spanned<DeString<'t>>, Spanned<DeValue<'t>>)> {
    let table = table.and_then(|table| table.get_ref().as_table());
    table.into_iter().flatten().map(|(key, value)| (key.clone(), value.clone()))
}

/// An entry of the list at `path`.
fn entry<'d>(document: &'d Document<'d>, path: &str, index: usize, value: &'d Spanned<DeValue<'d>>) -> Node<'d> {
    Node { document, path: format!("{path}[{index}]"), key: None, value }
}

/// The path of `key` in the table at `path`; a key that TOML wants in quotes gets them.
pub fn join(path: &str, key: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let is_bare = !key.is_empty() && key.chars().all(bare);
    let key = if is_bare { key.to_owned() } else { format!("{key:?}") };
    if path.is_empty() { key } else { format!("{path}.{key}") }
}
