//! Shells and bars beside the tetrahedra: their masses, by the areas and lengths between their nodes.

use std::collections::HashMap;
use std::f64::consts::PI;

use crate::error::ImportError;
use crate::own::nastran::card::Card;
use crate::own::systems::size;
use crate::own::texts::Texts;

/// Properties of shells.
pub(super) const SHELLS: &[&str] = &["PSHELL", "PCOMP", "PCOMPG", "PCOMPP"];
/// Bars with the fields of their property and nodes.
const BARS: &[&str] = &["CBAR", "CBEAM", "CROD", "CTUBE"];
/// Shells of four sides.
const QUADRILATERALS: &[&str] = &["CQUAD4", "CQUAD8", "CQUADR", "CQUAD"];
/// Elements with a mass that is not known here.
const OTHERS: &[&str] =
    &["CBEAM3", "CBEND", "CSHEAR", "CTRIAX", "CTRIAX6", "CQUADX", "CCONEAX", "CWELD", "CSEAM", "CFAST"];

/// Mass of an area or a length: of layers of a material, with a thickness or a section each, and beside them.
#[derive(Debug, Default, Clone)]
struct Section {
    /// Materials, and thickness or area.
    layers: Vec<(u64, f64)>,
    beside: f64,
}

/// An element with a mass.
#[derive(Debug)]
struct Heavy {
    name: String,
    corners: Vec<u64>,
    section: Sectional,
}

#[derive(Debug)]
enum Sectional {
    Own(Section),
    Property(u64),
    Unknown,
}

/// Shells and bars as they are written.
#[derive(Debug, Default)]
pub(super) struct Sections {
    /// None where a section is not understood.
    properties: HashMap<u64, Option<Section>>,
    elements: Vec<Heavy>,
}

impl Sections {
    /// Takes a triangle that a property makes a shell.
    pub(super) fn triangle(&mut self, name: &str, property: u64, corners: [u64; 3]) {
        let section = Sectional::Property(property);
        self.elements.push(Heavy { name: name.to_owned(), corners: corners.to_vec(), section });
    }

    /// Takes a card, if it is an element with a mass. Properties are only looked at.
    pub(super) fn take(&mut self, texts: &Texts<'_>, card: &Card<'_>) -> Result<bool, ImportError> {
        let label = |field: usize| card.label(texts, field);
        let name = card.name.clone();
        match card.name.as_str() {
            bar if BARS.contains(&bar) => {
                let property = card.whole(texts, 2)?.map_or_else(|| label(1), Ok)?;
                // Without nodes its orientation is by a scalar point or another part.
                let corners = [3, 4].into_iter().filter_map(|field| card.whole(texts, field).ok().flatten()).collect();
                self.elements.push(Heavy { name, corners, section: Sectional::Property(property) });
            }
            "CONROD" => {
                let section = Section {
                    layers: vec![(label(4)?, card.number_or_nought(texts, 5)?)],
                    beside: card.number_or_nought(texts, 8)?,
                };
                self.elements.push(Heavy {
                    name,
                    corners: vec![label(2)?, label(3)?],
                    section: Sectional::Own(section),
                });
            }
            shell if QUADRILATERALS.contains(&shell) => {
                let property = card.whole(texts, 2)?.map_or_else(|| label(1), Ok)?;
                let corners = vec![label(3)?, label(4)?, label(5)?, label(6)?];
                self.elements.push(Heavy { name, corners, section: Sectional::Property(property) });
            }
            other if OTHERS.contains(&other) => {
                self.elements.push(Heavy { name, corners: Vec::new(), section: Sectional::Unknown });
            }
            "PSHELL" | "PCOMP" | "PCOMPG" | "PROD" | "PTUBE" | "PBAR" | "PBEAM" | "PBARL" | "PBEAML" => {
                // A property that cannot be read is that of a mass that is not known.
                self.properties.insert(label(1)?, section(texts, card).ok().flatten());
                return Ok(false);
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// The names of elements and their masses, where these are known.
    pub(super) fn masses<'s>(
        &'s self,
        position_of: &'s dyn Fn(u64) -> Option<[f64; 3]>,
        density_of: &'s dyn Fn(u64) -> Option<f64>,
        mass_of_weight: f64,
    ) -> impl Iterator<Item = (&'s str, Option<f64>)> {
        let mass = move |element: &Heavy| {
            let section = match &element.section {
                Sectional::Own(section) => section,
                Sectional::Property(label) => self.properties.get(label)?.as_ref()?,
                Sectional::Unknown => return None,
            };
            let corners: Vec<[f64; 3]> =
                element.corners.iter().map(|node| position_of(*node)).collect::<Option<_>>()?;
            let mut each = section.beside * mass_of_weight;
            for (material, thickness) in &section.layers {
                each += density_of(*material)? * thickness;
            }
            Some(each * size(&corners)?)
        };
        self.elements.iter().map(move |element| (&*element.name, mass(element)))
    }
}

/// The section of a property; none of one that is not known here.
fn section(texts: &Texts<'_>, card: &Card<'_>) -> Result<Option<Section>, ImportError> {
    let number = |field: usize| card.number_or_nought(texts, field);
    let one = |area: f64, beside: f64| Ok(Some(Section { layers: vec![(card.label(texts, 2)?, area)], beside }));
    match card.name.as_str() {
        // Without a thickness it is that of the elements; without a material it has no mass of its own.
        "PSHELL" => match (card.whole(texts, 2)?, card.number(texts, 3)?) {
            (_, None) => Ok(None),
            (None, Some(_)) => Ok(Some(Section { layers: Vec::new(), beside: number(8)? })),
            (Some(_), Some(thickness)) => one(thickness, number(8)?),
        },
        "PCOMP" => plies(texts, card),
        // A number of its own stands before each layer, which are eight fields each.
        "PCOMPG" => global_plies(texts, card),
        "PROD" => one(number(3)?, number(6)?),
        "PTUBE" => {
            let (outer, wall) = (number(3)?, number(4)?);
            let inner = if wall == 0.0 { 0.0 } else { outer - 2.0 * wall };
            one(PI / 4.0 * (outer * outer - inner * inner), number(5)?)
        }
        "PBAR" => one(number(3)?, number(7)?),
        "PBEAM" => along(texts, card),
        "PBARL" => {
            let kind = card.field(4).to_uppercase();
            let Some(count) = dimensions(&kind) else { return Ok(None) };
            let values = (9..9 + count).map(number).collect::<Result<Vec<_>, _>>()?;
            one(area(&kind, &values), number(9 + count)?)
        }
        "PBEAML" => along_of_kind(texts, card),
        _ => Ok(None),
    }
}

/// A station of a beam: its place from 0 to 1, area and mass beside it, none where they follow from other stations.
type Station = (f64, Option<f64>, Option<f64>);

/// The section of a PBEAM, whose area and mass are linear between its stations.
fn along(texts: &Texts<'_>, card: &Card<'_>) -> Result<Option<Section>, ImportError> {
    let is_station = |field: usize| matches!(&*card.field(field).to_uppercase(), "YES" | "YESA" | "NO");
    let mut stations = vec![(0.0, Some(card.number_or_nought(texts, 3)?), Some(card.number_or_nought(texts, 8)?))];
    // The places of stresses at the first end may be left out.
    let mut first = if is_station(9) { 9 } else { 17 };
    while is_station(first) {
        let Some(at) = card.number(texts, first + 1)? else { return Ok(None) };
        stations.push((at, card.number(texts, first + 2)?, card.number(texts, first + 7)?));
        first += if card.field(first).eq_ignore_ascii_case("YES") { 16 } else { 8 };
    }
    Ok(mean(card.label(texts, 2)?, stations))
}

/// The same of a PBEAML.
fn along_of_kind(texts: &Texts<'_>, card: &Card<'_>) -> Result<Option<Section>, ImportError> {
    let kind = card.field(4).to_uppercase();
    let Some(count) = dimensions(&kind) else { return Ok(None) };
    let dimensions = |first: usize| -> Result<Vec<Option<f64>>, ImportError> {
        (first..first + count).map(|field| card.number(texts, field)).collect()
    };
    let at_first: Vec<f64> = dimensions(9)?.into_iter().map(Option::unwrap_or_default).collect();
    let mut stations = vec![(0.0, Some(area(&kind, &at_first)), Some(card.number_or_nought(texts, 9 + count)?))];
    let mut first = 10 + count;
    while first <= card.len() {
        let at = card.number(texts, first + 1)?.unwrap_or(1.0);
        let given = dimensions(first + 2)?;
        // Dimensions that are left out are those of the first end; between the ends what they are is not known here.
        let values: Option<Vec<f64>> = match at < 1.0 {
            true => given.into_iter().collect(),
            false => Some(given.iter().zip(&at_first).map(|(given, first)| given.unwrap_or(*first)).collect()),
        };
        let Some(values) = values else { return Ok(None) };
        stations.push((at, Some(area(&kind, &values)), card.number(texts, first + 2 + count)?));
        first += 3 + count;
    }
    Ok(mean(card.label(texts, 2)?, stations))
}

/// The mean along a beam of its area and of the mass beside it. What the second end lacks is as at the first, what others lack is between the ends.
fn mean(material: u64, mut stations: Vec<Station>) -> Option<Section> {
    stations.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (*stations.first()?, *stations.last()?);
    if stations.len() == 1 {
        return Some(Section { layers: vec![(material, first.1?)], beside: first.2? });
    }
    if first.0 != 0.0 || last.0 != 1.0 {
        return None;
    }
    let of = |value: &dyn Fn(&Station) -> Option<f64>| -> Option<f64> {
        let start = value(&first)?;
        let end = value(&last).unwrap_or(start);
        let at = |station: &Station| match value(station) {
            Some(value) => value,
            None => start + (end - start) * station.0,
        };
        Some(stations.windows(2).map(|pair| 0.5 * (at(&pair[0]) + at(&pair[1])) * (pair[1].0 - pair[0].0)).sum())
    };
    Some(Section { layers: vec![(material, of(&|station| station.1)?)], beside: of(&|station| station.2)? })
}

/// Number of dimensions of a kind of section.
fn dimensions(kind: &str) -> Option<usize> {
    Some(match kind {
        "ROD" => 1,
        "TUBE" | "TUBE2" | "BAR" => 2,
        "HEXA" => 3,
        "CHAN" | "T" | "BOX" | "CROSS" | "H" | "T1" | "I1" | "CHAN1" | "Z" | "CHAN2" | "T2" | "HAT" | "L" => 4,
        "HAT1" => 5,
        "I" | "BOX1" => 6,
        _ => return None,
    })
}

/// The area of a section by its dimensions.
fn area(kind: &str, values: &[f64]) -> f64 {
    let d = |number: usize| values.get(number - 1).copied().unwrap_or_default();
    match kind {
        "ROD" => PI * d(1) * d(1),
        "TUBE" => PI * (d(1) * d(1) - d(2) * d(2)),
        "TUBE2" => PI * d(2) * (2.0 * d(1) - d(2)),
        "BAR" => d(1) * d(2),
        "HEXA" => d(3) * (d(2) - d(1)),
        "CHAN" => 2.0 * d(4) * d(1) + (d(2) - 2.0 * d(4)) * d(3),
        "T" | "T2" | "L" => d(1) * d(3) + (d(2) - d(3)) * d(4),
        "BOX" => d(1) * d(2) - (d(1) - 2.0 * d(4)) * (d(2) - 2.0 * d(3)),
        "CROSS" | "H" => d(2) * d(3) + d(1) * d(4),
        "T1" => d(1) * d(3) + d(2) * d(4),
        "I1" => (d(1) + d(2)) * (d(4) - d(3)) + d(2) * d(3),
        "CHAN1" | "Z" => d(1) * (d(4) - d(3)) + d(2) * d(4),
        "CHAN2" => 2.0 * d(1) * d(3) + (d(4) - 2.0 * d(1)) * d(2),
        "HAT" => d(2) * (d(3) + 2.0 * (d(4) + d(2)) + 2.0 * (d(1) - 2.0 * d(2))),
        "HAT1" => d(1) * (d(4) + d(5)) + 2.0 * d(4) * (d(2) - d(4) - d(5)),
        "I" => d(2) * d(5) + d(3) * d(6) + (d(1) - d(5) - d(6)) * d(4),
        // BOX1
        _ => d(1) * d(2) - (d(1) - d(5) - d(6)) * (d(2) - d(3) - d(4)),
    }
}

/// Layers of a PCOMPG.
fn global_plies(texts: &Texts<'_>, card: &Card<'_>) -> Result<Option<Section>, ImportError> {
    let mut section = Section { layers: Vec::new(), beside: card.number_or_nought(texts, 3)? };
    for first in (9..=card.len()).step_by(8) {
        match (card.whole(texts, first + 1)?, card.number(texts, first + 2)?) {
            (Some(material), Some(thickness)) => section.layers.push((material, thickness)),
            (None, None) => {}
            _ => return Ok(None),
        }
    }
    Ok(Some(section))
}

/// Layers of a PCOMP; material and thickness are those of the layer before where they are empty.
fn plies(texts: &Texts<'_>, card: &Card<'_>) -> Result<Option<Section>, ImportError> {
    let is_symmetric = match &*card.field(8).to_uppercase() {
        "" | "MEM" | "BEND" => false,
        "SYM" => true,
        _ => return Ok(None),
    };
    let mut section = Section { layers: Vec::new(), beside: card.number_or_nought(texts, 3)? };
    let mut last = None;
    for first in (9..=card.len()).step_by(4) {
        if (first..first + 4).all(|field| card.field(field).is_empty()) {
            continue;
        }
        let (material, thickness) = (card.whole(texts, first)?, card.number(texts, first + 1)?);
        last = match (material, thickness, last) {
            (Some(material), Some(thickness), _) => Some((material, thickness)),
            (Some(material), None, Some((_, thickness))) => Some((material, thickness)),
            (None, Some(thickness), Some((material, _))) => Some((material, thickness)),
            (None, None, last) => last,
            _ => return Ok(None),
        };
        section.layers.extend(last);
    }
    if is_symmetric {
        section.layers.extend(section.layers.clone());
    }
    Ok(Some(section))
}
