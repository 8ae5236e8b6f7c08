//! Sentences on what of a deck is not used.

use std::collections::BTreeMap;

/// Masses that are written out.
const SHOWN: usize = 5;

/// Masses on nodes with their sum, as a scene has them.
pub(crate) fn masses(kind: &str, masses: &[([f64; 3], f64)]) -> Option<String> {
    let sum: f64 = masses.iter().map(|(_, mass)| mass).sum();
    let shown = masses.iter().take(SHOWN);
    let shown = shown.map(|([x, y, z], mass)| format!("{{ at = [{x:?}, {y:?}, {z:?}], mass = {mass:?} }}"));
    let shown = shown.collect::<Vec<_>>().join(", ");
    let more = if masses.len() > SHOWN { ", …" } else { "" };
    (!masses.is_empty())
        .then(|| format!("{} {kind} ({sum:.4e}; in a scene: point_masses = [{shown}{more}])", masses.len()))
}

/// Cards, elements and keywords that are left out, with their mass where they have one.
#[derive(Debug, Default)]
pub(crate) struct Left {
    kinds: BTreeMap<String, Kind>,
    /// Sentences at the end.
    others: Vec<String>,
}

#[derive(Debug, Default)]
struct Kind {
    count: usize,
    mass: f64,
    /// Number of those with a mass, and of those whose mass is not known.
    with_mass: [usize; 2],
}

impl Left {
    /// Counts one without a mass.
    pub(crate) fn count(&mut self, name: &str) {
        self.kind(name).count += 1;
    }

    /// Counts one with a mass, which may not be known.
    pub(crate) fn heavy(&mut self, name: &str, mass: Option<f64>) {
        let kind = self.kind(name);
        kind.count += 1;
        kind.mass += mass.unwrap_or(0.0);
        kind.with_mass[usize::from(mass.is_none())] += 1;
    }

    /// Adds a sentence.
    pub(crate) fn say(&mut self, text: String) {
        self.others.push(text);
    }

    fn kind(&mut self, name: &str) -> &mut Kind {
        self.kinds.entry(name.to_owned()).or_default()
    }

    /// All that is left of a deck beside its tetrahedra, with the mass of it all.
    pub(crate) fn sentence(&self, tetrahedra: usize) -> Option<String> {
        let each = self.kinds.iter().map(|(name, Kind { count, mass, with_mass })| match with_mass {
            [0, 0] => format!("{count} {name}"),
            [0, _] => format!("{count} {name} (mass not known)"),
            [_, 0] => format!("{count} {name} ({mass:.4e})"),
            [_, unknown] => format!("{count} {name} ({mass:.4e} and the mass of {unknown} not known)"),
        });
        let left: Vec<String> = each.chain(self.others.iter().cloned()).collect();
        let heavy = || self.kinds.values().filter(|kind| kind.with_mass != [0, 0]);
        let known: f64 = heavy().map(|kind| kind.mass).sum();
        let is_known = heavy().all(|kind| kind.with_mass[1] == 0);
        let sum = match heavy().count() {
            0 => String::new(),
            _ if is_known => format!("; the mass of these is {known:.4e}"),
            _ if known == 0.0 => String::new(),
            _ => format!("; the mass of these is {known:.4e} where it is known"),
        };
        (!left.is_empty()).then(|| format!("read: {tetrahedra} tetrahedra; not used: {}{sum}", left.join(", ")))
    }
}
