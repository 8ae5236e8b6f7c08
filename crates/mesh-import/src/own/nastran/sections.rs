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
            "PSHELL" | "PCOMP" | "PROD" | "PTUBE" | "PBAR" | "PBEAM" | "PBARL" | "PBEAML" => {
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
        "PROD" => one(number(3)?, number(6)?),
        "PTUBE" => {
            let (outer, wall) = (number(3)?, number(4)?);
            let inner = if wall == 0.0 { 0.0 } else { outer - 2.0 * wall };
            one(PI / 4.0 * (outer * outer - inner * inner), number(5)?)
        }
        "PBAR" => one(number(3)?, number(7)?),
        // Stations along it begin in field 17.
        "PBEAM" if card.field(17).is_empty() => one(number(3)?, number(8)?),
        "PBARL" | "PBEAML" => {
            let [a, b] = [number(9)?, number(10)?];
            match &*card.field(4).to_uppercase() {
                "ROD" => one(PI * a * a, b),
                "BAR" => one(a * b, number(11)?),
                "TUBE" => one(PI * (a * a - b * b), number(11)?),
                _ => Ok(None),
            }
        }
        _ => Ok(None),
    }
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
