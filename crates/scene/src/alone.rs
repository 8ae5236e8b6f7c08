//! The text of one body of a scene of several, as a scene of its own.

use toml_edit::{DocumentMut, Item, Table};

use crate::document::{BODIES, OF_A_BODY, OUTPUT_OF_A_BODY};

/// The scene of the body `name` alone; a text without that body stays as it is.
pub(crate) fn alone(text: &str, name: &str) -> String {
    let Ok(mut document) = text.parse::<DocumentMut>() else { return text.to_owned() };
    let root = document.as_table_mut();
    let bodies = root.remove(BODIES).and_then(|bodies| bodies.into_table().ok());
    let Some(own) = bodies.and_then(|mut bodies| bodies.remove(name)?.into_table().ok()) else {
        return text.to_owned();
    };
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
    document.to_string()
}
