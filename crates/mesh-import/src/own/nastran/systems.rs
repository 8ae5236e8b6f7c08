//! Nodes at their places: coordinate systems of points, of nodes and of each other.

use std::collections::{BTreeMap, HashMap};

use crate::error::ImportError;
use crate::own::nastran::card::Card;
use crate::own::systems::{Placement, cylindrical, spherical};
use crate::own::texts::{Place, Texts};

/// Systems that are defined in each other.
const DEEPEST: usize = 200;

/// Meaning of the three coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Rectangular,
    Cylindrical,
    Spherical,
}

/// The three points of a system: its origin, one on its z axis, one in its xz plane.
#[derive(Debug)]
enum Points {
    /// In another system.
    At(u64, [[f64; 3]; 3]),
    Nodes([u64; 3]),
}

#[derive(Debug)]
struct System {
    place: Place,
    kind: Kind,
    points: Points,
}

/// A node as it is written.
#[derive(Debug)]
struct Grid {
    place: Place,
    system: Option<u64>,
    coordinates: [f64; 3],
}

/// Nodes and coordinate systems of a deck.
#[derive(Debug, Default)]
pub(super) struct Space {
    grids: BTreeMap<u64, Grid>,
    systems: HashMap<u64, System>,
    /// The system of nodes that name none.
    pub(super) default: u64,
    found: HashMap<u64, (Kind, Placement)>,
    /// Systems that are being found.
    around: Vec<u64>,
}

impl Space {
    /// Takes a GRID.
    pub(super) fn grid(&mut self, texts: &Texts<'_>, card: &Card<'_>) -> Result<(), ImportError> {
        let label = card.label(texts, 1)?;
        let mut coordinates = [0.0; 3];
        for (i, coordinate) in coordinates.iter_mut().enumerate() {
            *coordinate = card.number_or_nought(texts, 3 + i)?;
        }
        let grid = Grid { place: card.place, system: card.whole(texts, 2)?, coordinates };
        match self.grids.get(&label) {
            Some(known) if (known.system, known.coordinates) != (grid.system, grid.coordinates) => {
                let found = format!("node {label} is there twice, at different places");
                Err(texts.refuse(card.place, found, "number the nodes anew"))
            }
            _ => {
                self.grids.insert(label, grid);
                Ok(())
            }
        }
    }

    /// Takes a CORD1x or CORD2x; the last letter of its name is the kind.
    pub(super) fn system(&mut self, texts: &Texts<'_>, card: &Card<'_>) -> Result<(), ImportError> {
        let kind = match card.name.as_bytes().last() {
            Some(b'C') => Kind::Cylindrical,
            Some(b'S') => Kind::Spherical,
            _ => Kind::Rectangular,
        };
        let place = card.place;
        if card.name.starts_with("CORD2") {
            let mut points = [[0.0; 3]; 3];
            for (i, coordinate) in points.iter_mut().flatten().enumerate() {
                *coordinate = card.number_or_nought(texts, 3 + i)?;
            }
            let points = Points::At(card.whole(texts, 2)?.unwrap_or(0), points);
            return self.define(texts, card.label(texts, 1)?, System { place, kind, points });
        }
        // Two systems may be on one card.
        for first in [1, 5] {
            if first == 1 || !card.field(first).is_empty() {
                let label = |field: usize| card.label(texts, first + field);
                let points = Points::Nodes([label(1)?, label(2)?, label(3)?]);
                self.define(texts, label(0)?, System { place, kind, points })?;
            }
        }
        Ok(())
    }

    fn define(&mut self, texts: &Texts<'_>, label: u64, system: System) -> Result<(), ImportError> {
        let place = system.place;
        match self.systems.insert(label, system) {
            None => Ok(()),
            Some(_) => {
                let found = format!("the coordinate system {label} a second time");
                Err(texts.refuse(place, found, "give each coordinate system a number of its own"))
            }
        }
    }

    /// All nodes at their places, by their numbers.
    pub(super) fn positions(&mut self, texts: &Texts<'_>) -> Result<Vec<(u64, [f64; 3])>, ImportError> {
        let labels: Vec<u64> = self.grids.keys().copied().collect();
        let mut positions = Vec::with_capacity(labels.len());
        for label in labels {
            let Some(grid) = self.grids.get(&label) else { continue };
            let (place, system, coordinates) = (grid.place, grid.system, grid.coordinates);
            positions.push((label, self.at(texts, place, system.unwrap_or(self.default), coordinates)?));
        }
        Ok(positions)
    }

    /// A point of a system in the basic one.
    fn at(&mut self, texts: &Texts<'_>, place: Place, system: u64, point: [f64; 3]) -> Result<[f64; 3], ImportError> {
        let (kind, placement) = self.placement(texts, place, system)?;
        Ok(placement.of(match kind {
            Kind::Rectangular => point,
            Kind::Cylindrical => cylindrical(point),
            Kind::Spherical => spherical(point),
        }))
    }

    /// A vector of a rectangular system in the basic one; none in one whose axes turn.
    pub(super) fn vector(
        &mut self,
        texts: &Texts<'_>,
        place: Place,
        system: u64,
        vector: [f64; 3],
    ) -> Result<Option<[f64; 3]>, ImportError> {
        let (kind, placement) = self.placement(texts, place, system)?;
        Ok((kind == Kind::Rectangular).then(|| placement.turned(vector)))
    }

    /// The place of a system that a card names.
    fn placement(&mut self, texts: &Texts<'_>, place: Place, label: u64) -> Result<(Kind, Placement), ImportError> {
        if label == 0 {
            return Ok((Kind::Rectangular, Placement::NONE));
        }
        if let Some(found) = self.found.get(&label) {
            return Ok(*found);
        }
        let Some(system) = self.systems.get(&label) else {
            let found = format!(
                "the coordinate system {label} is named, and there is no CORD1R, CORD1C, CORD1S, CORD2R, CORD2C or CORD2S of it"
            );
            return Err(texts.refuse(
                place,
                found,
                "check the numbers of coordinate systems, and that all files of the deck are there",
            ));
        };
        let (own, kind) = (system.place, system.kind);
        if self.around.contains(&label) || self.around.len() > DEEPEST {
            let found = format!("the coordinate system {label} is defined in itself, or in too many others");
            return Err(texts.refuse(own, found, "define it in the basic system"));
        }
        let mut written = Vec::with_capacity(3);
        match &system.points {
            Points::At(other, points) => written.extend(points.iter().map(|point| (*other, *point))),
            Points::Nodes(nodes) => {
                for node in nodes {
                    let Some(grid) = self.grids.get(node) else {
                        let found = format!("the coordinate system {label} has node {node}, which is not there");
                        return Err(texts.refuse(own, found, "check its nodes"));
                    };
                    written.push((grid.system.unwrap_or(self.default), grid.coordinates));
                }
            }
        }
        self.around.push(label);
        let mut points = [[0.0; 3]; 3];
        for (point, (other, coordinates)) in points.iter_mut().zip(written) {
            *point = self.at(texts, own, other, coordinates)?;
        }
        self.around.pop();
        let [a, b, c] = points;
        let Some(placement) = Placement::of_z_axis(a, b, c) else {
            let found = format!("the three points of the coordinate system {label} are on a line");
            return Err(texts.refuse(own, found, "give a point on its z axis, and one in its xz plane"));
        };
        self.found.insert(label, (kind, placement));
        Ok((kind, placement))
    }
}
