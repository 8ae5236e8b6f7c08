//! Masses on nodes: CONM2, CONM1 and CMASS1 to CMASS4.

use std::collections::{BTreeMap, HashMap};

use crate::beside::DeckMass;
use crate::error::ImportError;
use crate::own::nastran::card::Card;
use crate::own::nastran::systems::Space;
use crate::own::notes::Left;
use crate::own::texts::{Place, Texts};

/// Masses in the three directions of a node that are nearer to each other are one mass.
const SAME: f64 = 1e-6;

/// Masses as they are written.
#[derive(Debug, Default)]
pub(super) struct Masses {
    points: Vec<Point>,
    scalars: Vec<Scalar>,
    /// Numbers of PMASS.
    properties: HashMap<u64, f64>,
}

/// A CONM2 or CONM1.
#[derive(Debug)]
struct Point {
    place: Place,
    kind: &'static str,
    node: u64,
    /// None where the offset is a position.
    system: Option<u64>,
    mass: f64,
    offset: [f64; 3],
    has_inertia: bool,
}

/// A mass that moves in one direction of a node.
#[derive(Debug)]
struct Scalar {
    name: String,
    /// Its node and direction, 0 to 2; none of turns, of scalar points and between two nodes.
    at: Option<(u64, usize)>,
    mass: Number,
}

#[derive(Debug, Clone, Copy)]
enum Number {
    Known(f64),
    /// By a PMASS.
    Of(u64),
}

impl Masses {
    /// Takes a card, if it is one of a mass.
    pub(super) fn take(&mut self, texts: &Texts<'_>, card: &Card<'_>, left: &mut Left) -> Result<bool, ImportError> {
        let number = |field: usize| card.number_or_nought(texts, field);
        let place = card.place;
        match card.name.as_str() {
            "CONM2" => {
                let system = if card.field(3) == "-1" { None } else { Some(card.whole(texts, 3)?.unwrap_or(0)) };
                let mut has_inertia = false;
                for field in 9..=14 {
                    has_inertia |= number(field)? != 0.0;
                }
                let (node, mass, offset) = (card.label(texts, 2)?, number(4)?, [number(5)?, number(6)?, number(7)?]);
                self.points.push(Point { place, kind: "CONM2", node, system, mass, offset, has_inertia });
            }
            "CONM1" => {
                // The lower half of the matrix, row by row.
                let mut rows = Vec::with_capacity(21);
                for field in 4..=24 {
                    rows.push(number(field)?);
                }
                let at = |i: usize, j: usize| rows[i * (i + 1) / 2 + j];
                let mass = at(0, 0);
                let is_point = (0..3).all(|i| at(i, i) == mass && (0..i).all(|j| at(i, j) == 0.0))
                    && (3..6).all(|i| (0..3).all(|j| at(i, j) == 0.0));
                if is_point {
                    let has_inertia = (3..6).any(|i| (3..=i).any(|j| at(i, j) != 0.0));
                    let (node, offset) = (card.label(texts, 2)?, [0.0; 3]);
                    self.points.push(Point { place, kind: "CONM1", node, system: Some(0), mass, offset, has_inertia });
                } else {
                    left.count("CONM1 that is no mass at a point");
                }
            }
            "PMASS" => {
                for field in [1, 3, 5, 7].into_iter().filter(|field| !card.field(*field).is_empty()) {
                    self.properties.insert(card.label(texts, field)?, number(field + 1)?);
                }
            }
            name @ ("CMASS1" | "CMASS2" | "CMASS3" | "CMASS4") => {
                let is_by_number = matches!(name, "CMASS2" | "CMASS4");
                let mass = match is_by_number {
                    true => Number::Known(number(2)?),
                    // It is its own property where it names none.
                    false => Number::Of(card.whole(texts, 2)?.map_or_else(|| card.label(texts, 1), Ok)?),
                };
                let is_of_nodes = matches!(name, "CMASS1" | "CMASS2");
                let mut ends = Vec::new();
                for field in [3, 5].into_iter().filter(|_| is_of_nodes) {
                    if let Some(node) = card.whole(texts, field)?.filter(|node| *node > 0) {
                        ends.push((node, card.whole(texts, field + 1)?.unwrap_or(0)));
                    }
                }
                let at = match ends[..] {
                    [(node, direction @ 1..=3)] => Some((node, direction as usize - 1)),
                    _ => None,
                };
                self.scalars.push(Scalar { name: name.to_owned(), at, mass });
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Masses at their places; what has none is left.
    pub(super) fn found(
        &self,
        texts: &Texts<'_>,
        space: &mut Space,
        position_of: &dyn Fn(u64) -> Option<[f64; 3]>,
        mass_of_weight: f64,
        left: &mut Left,
    ) -> Result<Vec<DeckMass>, ImportError> {
        let mut found = Vec::new();
        let mut with_inertia = 0;
        for Point { place, kind, node, system, mass, offset, has_inertia } in &self.points {
            with_inertia += usize::from(*has_inertia);
            let Some(at) = position_of(*node) else {
                let found = format!("{kind} at node {node}, which is not there");
                return Err(texts.refuse(
                    *place,
                    found,
                    "check the nodes of the deck, and that all its files are there",
                ));
            };
            let mass = mass * mass_of_weight;
            let node = at;
            let place = match system {
                None => Some(*offset),
                Some(_) if *offset == [0.0; 3] => Some(at),
                Some(system) => {
                    let offset = space.vector(texts, *place, *system, *offset)?;
                    offset.map(|offset| std::array::from_fn(|i| at[i] + offset[i]))
                }
            };
            match place {
                Some(_) if mass == 0.0 => {}
                Some(at) => found.push(DeckMass { kind: (*kind).to_owned(), node, at, mass }),
                None => left.heavy("CONM2 with offsets in systems of angles", Some(mass)),
            }
        }
        if with_inertia > 0 {
            left.say(format!("moments of inertia of {with_inertia} CONM1 or CONM2"));
        }
        found.extend(self.of_scalars(position_of, mass_of_weight, left));
        Ok(found)
    }

    /// The same mass in all three directions of a node is a mass there.
    fn of_scalars(
        &self,
        position_of: &dyn Fn(u64) -> Option<[f64; 3]>,
        mass_of_weight: f64,
        left: &mut Left,
    ) -> Vec<DeckMass> {
        let mass_of = |scalar: &Scalar| match scalar.mass {
            Number::Known(mass) => Some(mass * mass_of_weight),
            Number::Of(label) => self.properties.get(&label).map(|mass| mass * mass_of_weight),
        };
        let mut nodes: BTreeMap<u64, Vec<&Scalar>> = BTreeMap::new();
        for scalar in &self.scalars {
            match scalar.at {
                Some((node, _)) => nodes.entry(node).or_default().push(scalar),
                None => left.heavy(&format!("{} of turns, scalar points or two nodes", scalar.name), mass_of(scalar)),
            }
        }
        let mut found = Vec::new();
        for (node, scalars) in nodes {
            let mut sums = [Some(0.0); 3];
            for scalar in &scalars {
                if let Some((_, direction)) = scalar.at {
                    sums[direction] = sums[direction].zip(mass_of(scalar)).map(|(sum, mass)| sum + mass);
                }
            }
            match (sums, position_of(node)) {
                ([Some(x), Some(y), Some(z)], Some(at))
                    if x > 0.0 && (y - x).abs() <= SAME * x && (z - x).abs() <= SAME * x =>
                {
                    found.push(DeckMass { kind: scalars[0].name.clone(), node: at, at, mass: x });
                }
                _ => {
                    for scalar in scalars {
                        left.heavy(&format!("{} in single directions", scalar.name), mass_of(scalar));
                    }
                }
            }
        }
        found
    }
}
