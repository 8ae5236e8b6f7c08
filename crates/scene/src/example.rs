//! The lines of a complete example scene, to show in messages what is missing.

use std::path::Path;

use crate::document::Document;

/// A complete scene that uses every key but those that exclude or extend others.
pub(crate) const EXAMPLE: &str = include_str!("example.toml");

/// The lines of the example that give the value with this key path, in whatever list entry or
/// group it is asked for; `None` if the example has no such key.
pub(crate) fn example(path: &str) -> Option<String> {
    let document = Document::parse(EXAMPLE, Path::new("example.toml")).ok()?;
    let path = generic(path);
    let node = document.nearest(&path);
    let key = node.key.filter(|_| node.path == path)?.span();
    let line = EXAMPLE[..key.start].rfind('\n').map_or(0, |newline| newline + 1);
    if EXAMPLE[line..].starts_with('[') {
        let section = EXAMPLE[line..].split("\n\n").next()?;
        let without_comment = |line: &str| line.split('#').next().unwrap_or("").trim_end().to_owned();
        Some(section.lines().map(without_comment).collect::<Vec<_>>().join("\n"))
    } else {
        Some(document.slice(key.start..node.value.span().end).to_owned())
    }
}

/// The path with every index 0 and the groups of `body.materials` as `body.material`.
fn generic(path: &str) -> String {
    if let (Some(_), Some((_, key))) = (path.strip_prefix("body.materials."), path.rsplit_once('.')) {
        return format!("body.material.{key}");
    }
    let mut generic = String::new();
    for piece in path.split_inclusive(['[', ']']) {
        match piece.strip_suffix(']') {
            Some(_) => generic.push_str("0]"),
            None => generic.push_str(piece),
        }
    }
    generic
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_found_by_key() {
        for (path, lines) in [
            ("time.step", "step = 1e-4"),
            ("loads[7].history.duration", "duration = 0.02"),
            ("body.point_masses[2].mass", "mass = 0.001"),
            ("body.materials.core.density", "density = 2.7e-9"),
            ("time", "[time]\nend = 0.5\nstep = 1e-4\nformulation = \"conservative\"\nscheme = \"exponential\""),
            ("modes", "[modes]\nflexible = 10\ndamping_ratio = 0.05"),
        ] {
            assert_eq!(example(path).as_deref(), Some(lines), "{path}");
        }
        assert!(example("loads").unwrap().starts_with("[[loads]]\nkind = \"force\"\n"));
    }

    #[test]
    fn what_the_example_lacks_is_none() {
        for path in ["", "nothing", "time.nothing", "body.point_masses[0].spread"] {
            assert_eq!(example(path), None, "{path}");
        }
    }
}
