//! The right names for a misspelt one.

use crate::text::shorten::shorten;

/// Names that other programs and textbooks have for ours.
const SYNONYMS: [(&str, &str); 45] = [
    ("e", "young_modulus"),
    ("youngs", "young_modulus"),
    ("elastic_modulus", "young_modulus"),
    ("nu", "poisson_ratio"),
    ("rho", "density"),
    ("fixed", "clamp"),
    ("fix", "clamp"),
    ("encastre", "clamp"),
    ("built-in", "clamp"),
    ("ball", "pin"),
    ("spherical", "pin"),
    ("revolute", "hinge"),
    ("prismatic", "slider"),
    ("roller", "support"),
    ("hinge", "revolute"),
    ("pin", "spherical"),
    ("ball", "spherical"),
    ("weld", "fixed"),
    ("clamp", "fixed"),
    ("slider", "prismatic"),
    ("cardan", "universal"),
    ("hooke", "universal"),
    ("bodies", "between"),
    ("torque", "motor"),
    ("free", "free_length"),
    ("torque", "moment"),
    ("couple", "moment"),
    ("weight", "gravity"),
    ("position", "at"),
    ("point", "at"),
    ("location", "at"),
    ("where", "at"),
    ("value", "amplitude"),
    ("force", "amplitude"),
    ("function", "expression"),
    ("formula", "expression"),
    ("expression", "formula"),
    ("equation", "formula"),
    ("dt", "step"),
    ("time_step", "step"),
    ("duration", "end"),
    ("rk4", "rkmk4"),
    ("n_modes", "flexible"),
    ("modes", "flexible"),
    ("omega", "angular_velocity"),
];

/// The name in `known` that `found` most likely means: that of the same thing, one a few letters away, or one the beginning
/// of the other.
pub(crate) fn nearest<'a>(found: &str, known: &[&'a str]) -> Option<&'a str> {
    const LONGEST_NAME: usize = 64;
    if found.len() > LONGEST_NAME {
        return None;
    }
    let found = found.to_lowercase();
    let mut same = SYNONYMS.iter().filter(|(other, _)| *other == found).map(|(_, ours)| *ours);
    if let Some(same) = same.find_map(|ours| known.iter().copied().find(|name| *name == ours)) {
        return Some(same);
    }
    let distance = |name: &str| strsim::damerau_levenshtein(&found, &name.to_lowercase());
    let near = known.iter().copied().min_by_key(|name| distance(name))?;
    if distance(near) <= 1 + found.chars().count() / 4 && distance(near) < near.len() {
        return Some(near);
    }
    let begins = |name: &&str| found.len() >= 3 && (name.starts_with(&found) || found.starts_with(*name));
    known.iter().copied().find(begins)
}

/// The names in backquotes, separated by commas.
pub(crate) fn list(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// "one of" the names in quotes; of very many, the first.
pub fn one_of(names: &[String]) -> String {
    const SHOWN: usize = 20;
    let first: Vec<String> = names.iter().take(SHOWN).map(|name| shorten(name)).collect();
    match names.len().checked_sub(SHOWN) {
        None | Some(0) => format!("one of {first:?}"),
        Some(more) => format!("one of {first:?} and {more} others"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_name_finds_the_right_one() {
        let known = ["end", "step", "scheme", "damping_ratio", "half-sine", "R", "P"];
        for (found, meant) in [
            ("stpe", "step"),
            ("Step", "step"),
            ("schema", "scheme"),
            ("damping", "damping_ratio"),
            ("dampingratio", "damping_ratio"),
            ("half_sine", "half-sine"),
            ("r", "R"),
        ] {
            assert_eq!(nearest(found, &known), Some(meant), "{found}");
        }
    }

    #[test]
    fn what_others_call_it_finds_our_name_where_that_can_stand() {
        for (found, ours) in SYNONYMS {
            assert_eq!(nearest(&found.to_uppercase(), &["center_of_mass", ours]), Some(ours), "{found}");
        }
        assert_eq!(nearest("fixed", &["center_of_mass"]), None);
    }

    #[test]
    fn an_unrelated_name_finds_none() {
        let known = ["end", "step", "scheme", "R"];
        for found in ["gravity", "x", "", "quadrature", &"step".repeat(1000)] {
            assert_eq!(nearest(found, &known), None, "{found}");
        }
        assert_eq!(nearest("step", &[]), None);
    }

    #[test]
    fn of_many_names_the_first_are_shown_and_of_a_long_one_its_beginning() {
        let names = |count: usize| (0..count).map(|i| format!("g{i}")).collect::<Vec<_>>();
        assert_eq!(one_of(&names(2)), "one of [\"g0\", \"g1\"]");
        assert!(one_of(&names(20)).ends_with("\"g19\"]"));
        assert!(one_of(&names(10_000)).ends_with("\"g19\"] and 9980 others"));
        assert!(one_of(&["x".repeat(10_000)]).chars().count() < 120);
    }
}
