//! The rules on markers of bodies and of the ground.

use nalgebra::Vector3;

use super::Check;
use super::constraint::RegionKeys;
use crate::body::BodySource;
use crate::body::constraint::Constraint;
use crate::document::join;
use crate::error::SceneError;
use crate::loads::unit_vector::unit;
use crate::text::name::check_key;
use crate::tie::joint::JointKind;
use crate::tie::marker::{GroundMarker, Marker, MarkerAxes, MarkerPlace, Tie};
use crate::tie::section::{GroundMarkerSection, InOrder, MarkerSection, TieName};

/// Sine of the angle between z and x below which they have one direction.
const PARALLEL: f64 = 1e-6;
/// Most patches of a marker.
const MAX_PATCHES: u32 = 32;

impl Check<'_> {
    pub fn markers(
        &self,
        InOrder(sections): InOrder<MarkerSection>,
        body: &BodySource,
    ) -> Result<Vec<Marker>, SceneError> {
        let help = "each marker adds static shapes to the body: keep those that joints need";
        self.not_too_many("body.markers", sections.len(), help)?;
        let marker = |(name, section)| self.marker(name, section, body);
        sections.into_iter().map(marker).collect()
    }

    /// The markers at what constraints of a body in joints hold: ends of joints to the ground.
    pub fn held_markers(&self, constraint: &Constraint, markers: &mut Vec<Marker>) {
        let each: Vec<Constraint> = match constraint {
            Constraint::Support { parts } => {
                parts.iter().map(|part| Constraint::Support { parts: vec![part.clone()] }).collect()
            }
            one => vec![one.clone()],
        };
        for (number, constraint) in each.into_iter().enumerate() {
            let is_taken = |name: &String| markers.iter().any(|marker| marker.name == *name);
            let first = format!("constraint{}", number + 1);
            let name = std::iter::successors(Some(first), |name| Some(format!("{name}_"))).find(|name| !is_taken(name));
            let tie = match &constraint {
                Constraint::Support { .. } => Tie::Nodes,
                Constraint::Hinge { shaft, .. } if shaft.is_empty() => Tie::Nodes,
                Constraint::Pin { radius: None, .. } => Tie::Mean,
                _ => Tie::Rigid,
            };
            let x = matches!(constraint, Constraint::Support { .. }).then_some([1.0, 0.0, 0.0]);
            let axes = JointKind::of_constraint(&constraint).1.map(|z| MarkerAxes { z, x });
            let place = MarkerPlace::Held { constraint, number };
            markers.push(Marker { name: name.unwrap_or_default(), place, tie, axes });
        }
    }

    pub fn ground_markers(
        &self,
        InOrder(sections): InOrder<GroundMarkerSection>,
    ) -> Result<Vec<GroundMarker>, SceneError> {
        let marker = |(name, section): (String, GroundMarkerSection)| {
            let GroundMarkerSection { at, z, x } = section;
            let key = self.marker_key("ground.markers", &name)?;
            Ok(GroundMarker { axes: self.axes(&key, z, x)?, name, at })
        };
        sections.into_iter().map(marker).collect()
    }

    fn marker(&self, name: String, section: MarkerSection, body: &BodySource) -> Result<Marker, SceneError> {
        let MarkerSection { at, radius, r#box, group, tie, patches, along, z, x } = section;
        let key = self.marker_key("body.markers", &name)?;
        let help = "keep one way to say where the marker is";
        self.at_most_one(&key, &["at", "box", "group"], help)?;
        let place = match (self.region(&key, RegionKeys { at, radius, r#box, group }, body)?, at) {
            (Some(region), _) => MarkerPlace::Region(region),
            (None, Some(at)) => MarkerPlace::Point(at),
            (None, None) => {
                return Err(self.document.place(&key).refuse(
                    "none of `at`, `box` and `group`",
                    "the part of the body that carries the marker",
                    "add `at` for a point, `at` and `radius` for the faces within a ball, \
                     `box = [[x, y, z], [x, y, z]]` for those within a box, or `group` for a physical surface of the mesh",
                ));
            }
        };
        let tie = self.tie(&key, &place, tie, patches, along)?;
        Ok(Marker { axes: self.axes(&key, z, x)?, name, place, tie })
    }

    /// How a region carries a marker.
    fn tie(
        &self,
        key: &str,
        place: &MarkerPlace,
        tie: Option<TieName>,
        patches: Option<u32>,
        along: Option<[f64; 3]>,
    ) -> Result<Tie, SceneError> {
        let refuse = |name: &str, found: &str, expected: &str, help: &str| {
            Err(self.document.place(&join(key, name)).refuse(found, expected, help))
        };
        let given = if patches.is_some() { "patches" } else { "tie" };
        if matches!(place, MarkerPlace::Point(_)) && (patches.is_some() || tie.is_some_and(|tie| tie != TieName::Mean))
        {
            let help = "add `radius`, or give a `box` or a `group` in the place of `at`";
            return refuse(given, "a marker at a point", "a marker on a part of the mesh", help);
        }
        let Some(count) = patches else {
            if along.is_some() {
                let help = "add `patches`, or remove `along`: it says how patches follow each other";
                return refuse("along", "`along` without `patches`", "both or none", help);
            }
            return Ok(match tie {
                Some(TieName::Nodes) => Tie::Nodes,
                Some(TieName::Rigid) => Tie::Rigid,
                Some(TieName::Mean) | None => Tie::Mean,
            });
        };
        if tie == Some(TieName::Nodes) {
            let help = "keep `patches`, or `tie = \"nodes\"`, which ties each node by itself";
            return refuse("tie", "`tie = \"nodes\"` beside `patches`", "one of them", help);
        }
        if tie == Some(TieName::Rigid) {
            let help = "keep `patches`, which let the faces warp from one to the next, or `tie = \"rigid\"`, which lets nothing warp";
            return refuse("tie", "`tie = \"rigid\"` beside `patches`", "one of them", help);
        }
        let help = "a patch adds six static shapes; remove `patches` for one, or tie `\"nodes\"`";
        let key_of = join(key, "patches");
        self.require((2..=MAX_PATCHES).contains(&count), &key_of, &format!("from 2 to {MAX_PATCHES}"), help)?;
        let along = along.map(|mut along| {
            let help = "give the direction from patch to patch; its length does not matter";
            self.normalise(&join(key, "along"), &mut along, help).map(|()| along)
        });
        Ok(Tie::Patches { count: count as usize, along: along.transpose()? })
    }

    /// The key path of a marker, whose name it checks.
    fn marker_key(&self, table: &str, name: &str) -> Result<String, SceneError> {
        let key = join(table, name);
        check_key(&self.document.nearest(&key), "rename the marker, e.g. `tip`: joints name it by `BODY.MARKER`")?;
        Ok(key)
    }

    fn axes(&self, key: &str, z: Option<[f64; 3]>, x: Option<[f64; 3]>) -> Result<Option<MarkerAxes>, SceneError> {
        let Some(mut z) = z else {
            return match x {
                Some(_) => Err(self.missing(key, "z")),
                None => Ok(None),
            };
        };
        let help = "give the direction of the axis; its length does not matter";
        self.normalise(&join(key, "z"), &mut z, help)?;
        let Some(mut x) = x else { return Ok(Some(MarkerAxes { z, x: None })) };
        self.normalise(&join(key, "x"), &mut x, help)?;
        let (along, given) = (Vector3::from(z), Vector3::from(x));
        let across = given - along * along.dot(&given);
        let right = unit(&across).filter(|_| across.norm() > PARALLEL);
        self.require(
            right.is_some(),
            &join(key, "x"),
            "a direction other than that of `z`",
            "give an axis at right angles to `z`, or remove it",
        )?;
        Ok(Some(MarkerAxes { z, x: right.map(Into::into) }))
    }
}
