//! Sentences on what of a deck is not used.

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

/// All that is left of a deck beside its tetrahedra.
pub(crate) fn not_used(tetrahedra: usize, left: &[String]) -> Option<String> {
    (!left.is_empty()).then(|| format!("read: {tetrahedra} tetrahedra; not used: {}", left.join(", ")))
}
