//! The lines of a complete example scene, to show in messages what is missing.

use std::path::Path;

use crate::document::Document;

/// A complete scene that uses every key but those that exclude or extend others, and these others.
const EXAMPLES: [&str; 2] = [include_str!("example.toml"), include_str!("example_parts.toml")];

/// The lines of an example that give the value with this key path, in whatever list entry, group or history it is
/// asked for; `None` if the examples have no such key.
pub(crate) fn example(path: &str) -> Option<String> {
    let path = generic(path);
    EXAMPLES.into_iter().find_map(|text| lines(text, &path))
}

fn lines(text: &str, path: &str) -> Option<String> {
    let document = Document::parse(text, Path::new("example.toml")).ok()?;
    let node = document.nearest(path);
    let key = node.key.filter(|_| node.path == path)?.span();
    let line = text[..key.start].rfind('\n').map_or(0, |newline| newline + 1);
    if text[line..].starts_with('[') {
        let section = text[line..].split("\n\n").next()?;
        let without_comment = |line: &str| line.split('#').next().unwrap_or("").trim_end().to_owned();
        Some(section.lines().map(without_comment).collect::<Vec<_>>().join("\n"))
    } else {
        Some(document.slice(key.start..node.value.span().end).to_owned())
    }
}

/// The path with every index 0, the groups of `body.materials` as `body.material`, and every history as that of a load.
fn generic(path: &str) -> String {
    if let Some((_, within)) = path.split_once(".history") {
        // The factors of a product are histories themselves.
        return match within.rsplit_once('.') {
            Some((_, key)) => format!("loads[0].history.{key}"),
            None => "loads[0].history".to_owned(),
        };
    }
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
            ("loads[1].history.factors[2].frequency", "frequency = 50.0"),
            ("constraints[0].motion.history.duration", "duration = 0.02"),
            ("constraints[3].box", "box = [[-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]]"),
            ("modes.rayleigh.beta", "beta = 1e-5"),
            ("effects.coriolis", "coriolis = \"auto\""),
            ("constraints", "[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]"),
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
