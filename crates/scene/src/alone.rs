//! The texts of the bodies of a scene of several, each as a scene of its own.

use toml_edit::{DocumentMut, Item, Table};

use crate::document::{BODIES, OF_A_BODY, OUTPUT_OF_A_BODY, TIES};
use crate::methods::is_without_joints;

/// The text of a scene of several bodies, in parts.
pub(crate) struct BodyTexts {
    /// All but the bodies and what ties them together.
    shared: DocumentMut,
    bodies: Table,
}

/// The text of a body.
pub(crate) struct BodyText<'a> {
    /// Its name.
    pub name: &'a str,
    /// Number of all bodies.
    pub bodies: usize,
    /// The scene of it alone.
    pub alone: String,
}

impl BodyTexts {
    /// The parts of a text; one that is no TOML has none.
    pub fn new(text: &str) -> Self {
        let mut shared = text.parse::<DocumentMut>().unwrap_or_default();
        let bodies = shared.as_table_mut().remove(BODIES).and_then(|bodies| bodies.into_table().ok());
        TIES.iter().for_each(|key| _ = shared.as_table_mut().remove(key));
        if let Some(time) = shared.get_mut("time").and_then(Item::as_table_like_mut)
            && time.get("scheme").and_then(Item::as_str).is_some_and(|name| !is_without_joints(name))
        {
            time.remove("scheme");
        }
        Self { shared, bodies: bodies.unwrap_or_default() }
    }

    /// The text of one of them.
    pub fn of<'a>(&self, name: &'a str) -> BodyText<'a> {
        let mut document = self.shared.clone();
        let root = document.as_table_mut();
        let own = self.bodies.get(name).cloned().and_then(|own| own.into_table().ok()).unwrap_or_default();
        let output = root.remove("output").and_then(|output| output.into_table().ok());
        let (mut body, mut output) = (Table::new(), output.unwrap_or_default());
        for (key, item) in own {
            let to = match &*key {
                key if OF_A_BODY.contains(&key) => &mut *root,
                key if OUTPUT_OF_A_BODY.contains(&key) => &mut output,
                _ => &mut body,
            };
            to.insert(&key, item);
        }
        root.insert("body", Item::Table(body));
        if !output.is_empty() {
            root.insert("output", Item::Table(output));
        }
        BodyText { name, bodies: self.bodies.len(), alone: document.to_string() }
    }
}
