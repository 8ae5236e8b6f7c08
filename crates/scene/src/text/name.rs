//! Names of bodies, markers and joints.

use crate::document::Node;
use crate::error::SceneError;

/// The name of the ground in `between`.
pub(crate) const GROUND: &str = "ground";

/// The name of a body that has none.
pub(crate) const ONLY_BODY: &str = "body";

/// True of a name that can be a part of a path: not empty, without `.`, `/` and control characters.
pub(crate) fn is_part_of_path(name: &str) -> bool {
    !name.is_empty() && !name.contains(|c: char| c == '.' || c == '/' || c.is_control())
}

/// Refuses the key of a table as a name.
pub(crate) fn check_key(table: &Node<'_>, help: &str) -> Result<(), SceneError> {
    let name = table.name();
    if is_part_of_path(name) {
        return Ok(());
    }
    let expected = "a name that is not empty, without `.`, `/` and control characters";
    Err(table.place_of_key().refuse(format!("the name {name:?}"), expected, help))
}
