//! Labels of units that are known.

use crate::check::Check;
use crate::error::SceneError;
use crate::shared::Units;
use crate::text::suggest::list;

/// A pound in kilograms.
const POUND: f64 = 0.453_592_37;
/// The force that a pound has under standard gravity, N.
pub const POUND_FORCE: f64 = 9.806_65 * POUND;

/// Size of a unit in that of SI: m, kg or s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnitSize {
    /// A power of ten.
    Ten(i32),
    /// Any other number.
    Factor(f64),
}

impl UnitSize {
    /// As a number.
    pub fn factor(self) -> f64 {
        match self {
            Self::Ten(power) => 10_f64.powi(power),
            Self::Factor(factor) => factor,
        }
    }
}

/// Base quantities of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseUnit {
    /// Label `units.length`.
    Length,
    /// Label `units.mass`.
    Mass,
    /// Label `units.time`.
    Time,
}

/// Prefixes of SI, as powers of ten.
const PREFIXES: [(&str, i32); 11] = [
    ("", 0),
    ("m", -3),
    ("c", -2),
    ("k", 3),
    ("M", 6),
    ("d", -1),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("n", -9),
    ("p", -12),
];

impl BaseUnit {
    /// Size of the unit with a label that is known.
    pub fn size(self, label: &str) -> Option<UnitSize> {
        let others = self.others().iter().find(|(other, _)| *other == label).map(|(_, size)| *size);
        others.or_else(|| {
            let prefix = label.strip_suffix(self.of_si())?;
            let (_, ten) = PREFIXES.iter().find(|(known, _)| *known == prefix)?;
            Some(UnitSize::Ten(ten + if self == Self::Mass { -3 } else { 0 }))
        })
    }

    /// The unit that takes prefixes.
    fn of_si(self) -> &'static str {
        match self {
            Self::Length => "m",
            Self::Mass => "g",
            Self::Time => "s",
        }
    }

    /// Units without prefixes; of mass also the masses that a force of one pound accelerates by 1 ft/s² and by 1 in/s².
    fn others(self) -> &'static [(&'static str, UnitSize)] {
        use UnitSize::{Factor, Ten};
        const OF_AN_INCH: UnitSize = Factor(POUND_FORCE / 0.0254);
        match self {
            Self::Length => &[
                ("in", Factor(0.0254)),
                ("inch", Factor(0.0254)),
                ("ft", Factor(0.3048)),
                ("yd", Factor(0.9144)),
                ("mil", Factor(2.54e-5)),
                ("mi", Factor(1609.344)),
            ],
            Self::Mass => &[
                ("t", Ten(3)),
                ("lb", Factor(POUND)),
                ("lbm", Factor(POUND)),
                ("slug", Factor(POUND_FORCE / 0.3048)),
                ("slinch", OF_AN_INCH),
                ("blob", OF_AN_INCH),
                ("lbf s²/in", OF_AN_INCH),
                ("lbf s^2/in", OF_AN_INCH),
                ("lbf·s²/in", OF_AN_INCH),
                ("lbf*s^2/in", OF_AN_INCH),
            ],
            Self::Time => &[("min", Factor(60.0)), ("h", Factor(3600.0))],
        }
    }

    /// Their names in words, each with its label.
    fn in_words(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Length => &[
                ("meter", "m"),
                ("metre", "m"),
                ("millimeter", "mm"),
                ("millimetre", "mm"),
                ("centimeter", "cm"),
                ("centimetre", "cm"),
                ("inches", "in"),
                ("foot", "ft"),
                ("feet", "ft"),
            ],
            Self::Mass => &[("kilogram", "kg"), ("gram", "g"), ("tonne", "t"), ("pound", "lb"), ("megagram", "Mg")],
            Self::Time => &[("second", "s"), ("sec", "s"), ("millisecond", "ms"), ("msec", "ms")],
        }
    }

    /// The label that is meant by one that is not known: it has another case, one letter that is wrong, or is a word for it, perhaps
    /// misspelt. Most labels have two letters, so that one wrong letter is a slip only where the label has two or more.
    fn meant(self, label: &str) -> Option<String> {
        if self.size(label).is_some() {
            return None;
        }
        let found = label.trim().to_lowercase();
        let of_si = PREFIXES.iter().map(|(prefix, _)| format!("{prefix}{}", self.of_si()));
        let known: Vec<String> = of_si.chain(self.others().iter().map(|(other, _)| (*other).to_owned())).collect();
        if let Some(same) = known.iter().find(|known| known.to_lowercase() == found) {
            return Some(same.clone());
        }
        let is_near = |other: &str, most: usize| strsim::damerau_levenshtein(&found, other) <= most;
        let letters = found.chars().count();
        let of_a_word = self.in_words().iter().find(|(word, _)| {
            let singular = found.strip_suffix('s').unwrap_or(&found);
            *word == found || *word == singular || (word.len() > 4 && is_near(word, 1 + letters / 5))
        });
        // A sign, as of the mass of the sun, is no slip of a letter.
        let may_slip = letters > 1 && found.chars().all(|c| c.is_ascii() || c.is_alphabetic());
        let near =
            || known.iter().find(|known| may_slip && known.chars().count() > 1 && is_near(&known.to_lowercase(), 1));
        of_a_word.map(|(_, label)| (*label).to_owned()).or_else(|| near().cloned())
    }
}

impl Check<'_> {
    pub fn units(&self, Units { length, mass, time }: &Units) -> Result<(), SceneError> {
        for (key, unit, label, usual) in [
            ("units.length", BaseUnit::Length, length, ["m", "mm", "cm", "in", "ft"]),
            ("units.mass", BaseUnit::Mass, mass, ["kg", "Mg", "g", "slug", "lbf s²/in"]),
            ("units.time", BaseUnit::Time, time, ["s", "ms", "µs", "min", "h"]),
        ] {
            self.label(key, label)?;
            if let Some(meant) = unit.meant(label) {
                let expected = format!("`{meant}`, or another label such as {}", list(&usual));
                let help =
                    format!("did you mean `{meant}`? A label that resembles none of those known may be any word");
                return Err(self.document.place(key).refuse(format!("{label:?}"), expected, help));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::BaseUnit::{Length, Mass, Time};
    use super::*;

    #[test]
    fn a_misspelt_label_has_a_nearest_one_and_a_strange_one_has_none() {
        for (unit, found, meant) in [
            (Length, "mn", "mm"),
            (Length, "MM", "mm"),
            (Length, "M", "m"),
            (Length, "Meter", "m"),
            (Length, "milimeters", "mm"),
            (Length, "inchs", "in"),
            (Length, "kg", "km"),
            (Mass, "Kg", "kg"),
            (Mass, "kgs", "kg"),
            (Mass, "tonnes", "t"),
            (Mass, "sulg", "slug"),
            (Mass, "lbf s2/in", "lbf s²/in"),
            (Time, "sec", "s"),
            (Time, "secnds", "s"),
            (Time, "S", "s"),
        ] {
            assert_eq!(unit.meant(found).as_deref(), Some(meant), "{found}");
        }
        for (unit, found) in [
            (Length, "furlong"),
            (Length, "R"),
            (Length, ""),
            (Mass, "M☉"),
            (Mass, "electron"),
            (Time, "day"),
            (Time, "T"),
        ] {
            assert_eq!(unit.meant(found), None, "{found}");
        }
        for (unit, label, factor) in
            [(Length, "µm", 1e-6), (Mass, "Mg", 1e3), (Mass, "kg", 1.0), (Time, "ms", 1e-3), (Time, "h", 3600.0)]
        {
            assert_eq!((unit.meant(label), unit.size(label).map(UnitSize::factor)), (None, Some(factor)), "{label}");
        }
    }
}
