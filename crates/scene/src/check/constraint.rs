//! The rules on `[[constraints]]`.

use super::Check;
use crate::body::BodySource;
use crate::body::constraint::{Constraint, HeldDirections, HingeLine, Region};
use crate::document::join;
use crate::error::SceneError;
use crate::loads::history::DrivenSpeed;
use crate::section::ConstraintSection;

/// The keys of a region, as the file gives them.
pub(super) struct RegionKeys {
    pub at: Option<[f64; 3]>,
    pub radius: Option<f64>,
    pub r#box: Option<[[f64; 3]; 2]>,
    pub group: Option<String>,
}

impl Check<'_> {
    pub fn constraints(
        &self,
        mut sections: Vec<ConstraintSection>,
        body: &BodySource,
    ) -> Result<Option<Constraint>, SceneError> {
        if sections.iter().any(|section| matches!(section, ConstraintSection::Support { .. })) {
            return self.supports(sections, body).map(Some);
        }
        if sections.len() > 1 {
            return Err(self.document.place("constraints[1]").refuse(
                format!("{} constraints", sections.len()),
                "at most one, unless all are of the kind `support`",
                "keep one; a clamp, or a hinge's or slider's region, may hold several places as one physical group",
            ));
        }
        sections.pop().map(|section| self.constraint("constraints[0]", section, body)).transpose()
    }

    /// Constraints that are supports, all of them.
    fn supports(&self, sections: Vec<ConstraintSection>, body: &BodySource) -> Result<Constraint, SceneError> {
        let mut parts = Vec::new();
        for (i, section) in sections.into_iter().enumerate() {
            let key = format!("constraints[{i}]");
            match self.constraint(&key, section, body)? {
                Constraint::Support { parts: of_section } => parts.extend(of_section),
                _ => {
                    return Err(self.document.place(&join(&key, "kind")).refuse(
                        "another constraint beside one of the kind `support`",
                        "supports only, or one constraint of another kind",
                        "hold what is to be held by supports alone: all three directions of two nodes make a hinge",
                    ));
                }
            }
        }
        Ok(Constraint::Support { parts })
    }

    fn constraint(&self, key: &str, section: ConstraintSection, body: &BodySource) -> Result<Constraint, SceneError> {
        match section {
            ConstraintSection::Pin { at, radius } => {
                if let Some(radius) = radius {
                    self.radius(key, radius)?;
                    self.needs_mesh(&join(key, "radius"), body)?;
                }
                Ok(Constraint::Pin { at, radius })
            }
            ConstraintSection::Hinge { at, axis, points, radius, r#box, group, motion } => {
                let line = self.line(key, at, axis, points)?;
                let region = self.region(key, RegionKeys { at, radius: None, r#box, group }, body)?;
                let balls = match (radius, line) {
                    (None, _) => vec![],
                    (Some(radius), HingeLine::Axis { at, .. }) => vec![Region::Ball { at, radius }],
                    (Some(radius), HingeLine::Points(points)) => points.map(|at| Region::Ball { at, radius }).into(),
                };
                if let Some(radius) = radius {
                    self.radius(key, radius)?;
                    self.needs_mesh(&join(key, "radius"), body)?;
                }
                let shaft: Vec<Region> = balls.into_iter().chain(region).collect();
                let motion = self.motion(key, motion)?;
                if motion.is_some() && shaft.is_empty() && !matches!(body, BodySource::Rigid(_)) {
                    return Err(self.document.place(&join(key, "motion")).refuse(
                        "a driven hinge without a shaft",
                        "nodes beside the line that the drive can turn",
                        "say where the rigid shaft holds the body: `radius`, `box` or `group`",
                    ));
                }
                Ok(Constraint::Hinge { line, shaft, motion })
            }
            ConstraintSection::Clamp { at, radius, r#box, group } => {
                if let BodySource::Rigid(_) = body {
                    return Err(self.document.place(&join(key, "kind")).refuse(
                        "a rigid body that is clamped",
                        "a body that can move",
                        "remove the clamp, or give the body a mesh",
                    ));
                }
                self.at_with_radius(key)?;
                match self.region(key, RegionKeys { at, radius, r#box, group }, body)? {
                    Some(region) => Ok(Constraint::Clamp { region }),
                    None => Err(self.no_region(key)),
                }
            }
            ConstraintSection::Slider { mut direction, at, radius, r#box, group, motion } => {
                self.at_with_radius(key)?;
                let help = "give the direction to slide along; its length does not matter";
                self.normalise(&join(key, "direction"), &mut direction, help)?;
                let region = self.region(key, RegionKeys { at, radius, r#box, group }, body)?;
                if region.is_none() && !matches!(body, BodySource::Rigid(_)) {
                    return Err(self.no_region(key));
                }
                let motion = self.motion(key, motion)?;
                Ok(Constraint::Slider { direction, region, motion })
            }
            ConstraintSection::Support { directions, at, radius, r#box, group } => {
                self.at_with_radius(key)?;
                let directions = self.directions(&join(key, "directions"), &directions)?;
                match self.region(key, RegionKeys { at, radius, r#box, group }, body)? {
                    Some(region) => Ok(Constraint::Support { parts: vec![HeldDirections { region, directions }] }),
                    None => Err(self.no_region(key)),
                }
            }
        }
    }

    /// The axes of the mesh that are named.
    fn directions(&self, key: &str, names: &[String]) -> Result<[bool; 3], SceneError> {
        let (expected, help) = ("one to three of \"x\", \"y\" and \"z\"", "e.g. `directions = [\"z\"]`");
        self.require(!names.is_empty(), key, expected, help)?;
        let mut directions = [false; 3];
        for (i, name) in names.iter().enumerate() {
            let axis = ["x", "y", "z"].iter().position(|axis| axis == name);
            self.require(axis.is_some_and(|axis| !directions[axis]), &format!("{key}[{i}]"), expected, help)?;
            axis.into_iter().for_each(|axis| directions[axis] = true);
        }
        Ok(directions)
    }

    /// The line of a hinge, from `at` and `axis` or from `points`.
    fn line(
        &self,
        key: &str,
        at: Option<[f64; 3]>,
        axis: Option<[f64; 3]>,
        points: Option<[[f64; 3]; 2]>,
    ) -> Result<HingeLine, SceneError> {
        let help = "give a point and the direction of the line, `at` and `axis`, or two points of it, `points`";
        let Some(points) = points else {
            return match (at, axis) {
                (Some(at), Some(mut direction)) => {
                    let help = "give the direction of the line; its length does not matter";
                    self.normalise(&join(key, "axis"), &mut direction, help)?;
                    Ok(HingeLine::Axis { at, direction })
                }
                (None, None) => {
                    let found = "neither `at` and `axis` nor `points`";
                    Err(self.document.place(key).refuse(found, "the line of the hinge", help))
                }
                (Some(_), None) => Err(self.missing(key, "axis")),
                (None, Some(_)) => Err(self.missing(key, "at")),
            };
        };
        for name in ["at", "axis"] {
            if self.has(&join(key, name)) {
                let found = format!("both `{name}` and `points`");
                return Err(self.document.place(&join(key, name)).refuse(found, "the line of the hinge once", help));
            }
        }
        let line = HingeLine::Points(points);
        if line.direction() == [0.0; 3] {
            let place = self.document.place(&join(key, "points"));
            return Err(place.refuse("the same point twice", "two different points of the line", help));
        }
        Ok(line)
    }

    pub(super) fn region(&self, key: &str, keys: RegionKeys, body: &BodySource) -> Result<Option<Region>, SceneError> {
        let help = "keep one way to say which nodes are meant";
        self.at_most_one(key, &["radius", "box", "group"], help)?;
        let (name, region) = match keys {
            RegionKeys { r#box: Some([low, high]), .. } => {
                let ordered = low.iter().zip(&high).all(|(low, high)| low <= high);
                self.require(
                    ordered,
                    &join(key, "box"),
                    "a box whose first corner is not above its second in any coordinate",
                    "give the lowest and the highest coordinates, `box = [[x, y, z], [x, y, z]]`; \
                     a flat box holds the nodes in its plane",
                )?;
                ("box", Region::Box { low, high })
            }
            RegionKeys { group: Some(group), .. } => {
                self.group(&join(key, "group"), &group)?;
                ("group", Region::Group(group))
            }
            RegionKeys { at, radius: Some(radius), .. } => {
                let Some(at) = at else { return Err(self.missing(key, "at")) };
                self.radius(key, radius)?;
                ("radius", Region::Ball { at, radius })
            }
            _ => return Ok(None),
        };
        self.needs_mesh(&join(key, name), body)?;
        Ok(Some(region))
    }

    /// Refuses a point that is the centre of no ball.
    fn at_with_radius(&self, key: &str) -> Result<(), SceneError> {
        let at = join(key, "at");
        if !self.has(&at) || self.has(&join(key, "radius")) {
            return Ok(());
        }
        let help = "add `radius` for the nodes within a ball around the point, or remove `at`";
        Err(self.document.place(&at).refuse("`at` without `radius`", "both of them, or neither", help))
    }

    fn radius(&self, key: &str, radius: f64) -> Result<(), SceneError> {
        self.positive(&join(key, "radius"), radius, "give the radius of the ball whose nodes are held")
    }

    fn motion(&self, key: &str, motion: Option<DrivenSpeed>) -> Result<Option<DrivenSpeed>, SceneError> {
        let Some(mut speed) = motion else { return Ok(None) };
        self.history(&join(&join(key, "motion"), "history"), &mut speed.history)?;
        Ok(Some(speed))
    }

    fn no_region(&self, key: &str) -> SceneError {
        self.document.place(key).refuse(
            "none of `radius`, `box` and `group`",
            "the part of the body that is held",
            "add `at` and `radius` for the nodes within a ball, `box = [[x, y, z], [x, y, z]]` for those within a \
             box, or `group` for a physical group of the mesh",
        )
    }
}
