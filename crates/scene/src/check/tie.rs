//! The rules on what ties bodies together: joints, springs and bushings.

use std::collections::BTreeSet;

use dynamics::{Coordinate, Effect, Friction, Start, Stops};

use super::Check;
use crate::body::Body;
use crate::body::constraint::Constraint;
use crate::body::effects::Choice;
use crate::document::join;
use crate::error::SceneError;
use crate::loads::load::LoadKind;
use crate::text::name::{GROUND, ONLY_BODY, is_part_of_path};
use crate::text::suggest::{nearest, one_of};
use crate::tie::joint::{
    AlongAndAbout, Bushing, Coupling, CouplingKind, End, Joint, JointDrive, JointKind, JointSpring, Locked, Spring,
};
use crate::tie::marker::{GroundMarker, MarkerPlace};
use crate::tie::section::{
    BushingSection, CouplingSection, DriveSection, JointSection, JointSpringSection, SpringSection, StartName,
    StopsSection, TieSections,
};

/// Ties between the bodies of a scene.
#[derive(Default)]
pub(crate) struct Ties {
    pub ground: Vec<GroundMarker>,
    pub joints: Vec<Joint>,
    pub springs: Vec<Spring>,
    pub bushings: Vec<Bushing>,
    pub couplings: Vec<Coupling>,
    pub start: Start,
}

/// The bodies and the ground that ends are looked up in.
struct Ends<'a> {
    bodies: &'a [Body],
    ground: &'a [GroundMarker],
}

impl Check<'_> {
    /// Joints, springs and bushings between these bodies.
    pub fn ties(&self, sections: TieSections, bodies: &[Body]) -> Result<Ties, SceneError> {
        let TieSections { relaxed, initial, ground, joints, springs, bushings, couplings } = sections;
        let ground = self.ground_markers(ground.markers)?;
        let counts = [
            ("joints", joints.len()),
            ("springs", springs.len()),
            ("bushings", bushings.len()),
            ("couplings", couplings.len()),
        ];
        for (key, entries) in counts {
            self.not_too_many(key, entries, "make several scenes of them")?;
        }
        let ends = Ends { bodies, ground: &ground };
        let mut names = BTreeSet::new();
        let joint = |(i, section)| self.joint(&format!("joints[{i}]"), i, section, &ends, &mut names);
        let mut joints = joints.into_iter().enumerate().map(joint).collect::<Result<Vec<_>, _>>()?;
        joints.extend(self.supports_as_joints(bodies, &mut names)?);
        let spring = |(i, section)| self.spring(&format!("springs[{i}]"), i, section, &ends, &mut names);
        let springs = springs.into_iter().enumerate().map(spring).collect::<Result<Vec<_>, _>>()?;
        springs.iter().enumerate().try_for_each(|(i, spring)| self.can_be_long(i, spring, &joints, &ends))?;
        let bushing = |(i, section)| self.bushing(&format!("bushings[{i}]"), i, section, &ends, &mut names);
        let bushings = bushings.into_iter().enumerate().map(bushing).collect::<Result<_, _>>()?;
        let coupling = |(i, section)| self.coupling(&format!("couplings[{i}]"), i, section, &joints, &mut names);
        let couplings = couplings.into_iter().enumerate().map(coupling).collect::<Result<_, _>>()?;
        bodies.iter().filter(|body| body.tied).try_for_each(can_be_tied)?;
        let start = match (initial, relaxed) {
            (Some(StartName::Equilibrium), _) => {
                self.all_are_tied(bodies)?;
                Start::Equilibrium
            }
            (None, true) => Start::Relaxed,
            (None, false) => Start::AsPlaced,
        };
        Ok(Ties { ground, joints, springs, bushings, couplings, start })
    }

    /// Refuses an equilibrium of a body that moves alone.
    fn all_are_tied(&self, bodies: &[Body]) -> Result<(), SceneError> {
        let Some(alone) = bodies.iter().find(|body| !body.tied) else { return Ok(()) };
        let found =
            format!("\"equilibrium\" and the body {}, which moves alone", alone.name.as_deref().unwrap_or(ONLY_BODY));
        let (expected, help) =
            ("bodies that joints, springs or bushings tie", "tie it: to the ground, or to another body");
        Err(self.document.place("initial").refuse(found, expected, help))
    }

    fn joint(
        &self,
        key: &str,
        number: usize,
        section: JointSection,
        ends: &Ends<'_>,
        names: &mut BTreeSet<String>,
    ) -> Result<Joint, SceneError> {
        let JointSection { name, kind, locked, between, mut axis, drive, spring, motor } = section;
        let kind = self.kind(key, kind, locked)?;
        let name = self.tie_name(key, name, "joint", number, names)?;
        let between = self.between(key, &between, ends)?;
        if let Some(axis) = &mut axis {
            let help = "give the direction of the axis at the start, global; its length does not matter";
            self.normalise(&join(key, "axis"), axis, help)?;
        }
        self.has_axis(key, kind, between.map(|end| ends.has_axes(end)), axis.is_some())?;
        let drive = drive.map(|drive| self.drive(&join(key, "drive"), kind, drive)).transpose()?;
        let motor = motor.map(|motor| self.drive(&join(key, "motor"), kind, motor)).transpose()?;
        let spring = spring.map(|spring| self.joint_spring(&join(key, "spring"), kind, spring)).transpose()?;
        if let (Some(drive), Some(motor)) = (&drive, &motor)
            && drive.along == motor.along
        {
            let found = format!("a motor along the {} that `drive` gives", drive.along.name());
            let help = "keep `drive` for a motion that is given, or `motor` for a force or moment";
            return Err(self.document.place(&join(key, "motor")).refuse(found, "one of them", help));
        }
        Ok(Joint { key: key.to_owned(), name, kind, between, axis, drive, spring, motor })
    }

    /// The joints to the ground that constraints of bodies in joints are.
    fn supports_as_joints(&self, bodies: &[Body], names: &mut BTreeSet<String>) -> Result<Vec<Joint>, SceneError> {
        let mut joints = Vec::new();
        for (number, body) in bodies.iter().enumerate().filter(|(_, body)| body.tied) {
            for (marker, of_body) in body.markers.iter().enumerate() {
                let MarkerPlace::Held { constraint, .. } = &of_body.place else { continue };
                let name = match &body.name {
                    Some(name) => format!("{name}_{}", of_body.name),
                    None => of_body.name.clone(),
                };
                if !names.insert(name.clone()) {
                    let found = format!("a constraint whose joint to the ground has the name {name:?}, which is taken");
                    let help = "rename the other joint, spring, bushing or coupling";
                    return Err(body.refuse(&of_body.key(), found, "each name once", help));
                }
                joints.push(Joint {
                    key: body.place(&of_body.key()).key.clone(),
                    name,
                    kind: JointKind::of_constraint(constraint).0,
                    between: [End::Ground { marker: None }, End::Body { body: number, marker }],
                    axis: None,
                    drive: None,
                    spring: None,
                    motor: None,
                });
            }
        }
        Ok(joints)
    }

    fn kind(&self, key: &str, kind: Option<JointKind>, locked: Option<Vec<String>>) -> Result<JointKind, SceneError> {
        const NAMES: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];
        self.at_most_one(key, &["kind", "locked"], "keep `kind`, or `locked` for a joint that has no kind")?;
        let names = match (kind, locked) {
            (Some(kind), _) => return Ok(kind),
            (None, None) => return Err(self.missing(key, "kind")),
            (None, Some(names)) => names,
        };
        let key = join(key, "locked");
        let (expected, help) =
            ("some of \"x\", \"y\", \"z\", \"rx\", \"ry\" and \"rz\", each once", "e.g. `locked = [\"x\", \"rz\"]`");
        let mut all = [false; 6];
        for (i, name) in names.iter().enumerate() {
            let axis = NAMES.iter().position(|known| known == name);
            self.require(axis.is_some_and(|axis| !all[axis]), &format!("{key}[{i}]"), expected, help)?;
            axis.into_iter().for_each(|axis| all[axis] = true);
        }
        let [x, y, z, rx, ry, rz] = all;
        Ok(JointKind::Other(Locked { displacements: [x, y, z], turns: [rx, ry, rz] }))
    }

    fn coupling(
        &self,
        key: &str,
        number: usize,
        section: CouplingSection,
        joints: &[Joint],
        names: &mut BTreeSet<String>,
    ) -> Result<Coupling, SceneError> {
        let (turn, slide) = (Coordinate::Turn, Coordinate::Slide);
        let two = |names: &[String], coordinates: [Coordinate; 2]| {
            let key = join(key, "joints");
            let [first, second] = names else {
                let found = format!("{} names", names.len());
                let help = "name two, e.g. `joints = [\"pinion\", \"wheel\"]`";
                return Err(self.document.place(&key).refuse(found, "two joints", help));
            };
            let find = |i: usize, name: &str| self.joint_with(&format!("{key}[{i}]"), name, coordinates[i], joints);
            let found = [find(0, first)?, find(1, second)?];
            let help = "name the other joint";
            self.require(found[0] != found[1], &key, "two different joints", help)?;
            Ok(found)
        };
        let not_zero = |name: &str, value: f64| {
            self.require(
                value != 0.0,
                &join(key, name),
                "a number that is not 0",
                "give how far the one goes for the other",
            )
        };
        let (name, kind) = match section {
            CouplingSection::Gear { name, joints, ratio } => {
                not_zero("ratio", ratio)?;
                (name, CouplingKind::Gear { joints: two(&joints, [turn, turn])?, ratio })
            }
            CouplingSection::Rack { name, joints, radius } => {
                not_zero("radius", radius)?;
                (name, CouplingKind::Rack { joints: two(&joints, [turn, slide])?, radius })
            }
            CouplingSection::Screw { name, joint, lead } => {
                not_zero("lead", lead)?;
                let key = join(key, "joint");
                self.joint_with(&key, &joint, turn, joints)?;
                (name, CouplingKind::Screw { joint: self.joint_with(&key, &joint, slide, joints)?, lead })
            }
        };
        Ok(Coupling { name: self.tie_name(key, name, "coupling", number, names)?, kind })
    }

    /// The number of a joint by its name, which has the coordinate.
    fn joint_with(&self, key: &str, name: &str, coordinate: Coordinate, joints: &[Joint]) -> Result<usize, SceneError> {
        let names = joints.iter().map(|joint| joint.name.as_str());
        let number = number_of(name, names, &format!("joint {name:?}"), "[[joints]]")
            .map_err(|NoEnd { found, expected, help }| self.document.place(key).refuse(found, expected, help))?;
        let kind = joints[number].kind;
        if kind.coordinates().contains(&coordinate) {
            return Ok(number);
        }
        let (found, expected) = (
            format!("a {} joint, which has no {}", kind.name(), coordinate.name()),
            format!("a joint with a {}", coordinate.name()),
        );
        Err(self.document.place(key).refuse(found, expected, "name another joint, or change its kind"))
    }

    fn spring(
        &self,
        key: &str,
        number: usize,
        section: SpringSection,
        ends: &Ends<'_>,
        names: &mut BTreeSet<String>,
    ) -> Result<Spring, SceneError> {
        let SpringSection { name, between, stiffness, damping, free_length } = section;
        let name = self.tie_name(key, name, "spring", number, names)?;
        let between = self.between(key, &between, ends)?;
        if let Some(end) = between.iter().position(|end| *end == End::Ground { marker: None }) {
            let help = "add a place, e.g. `[ground.markers.wall]` with `at`, and name it \"ground.wall\"";
            let place = self.document.place(&format!("{key}.between[{end}]"));
            return Err(place.refuse("the ground at the other end of the spring", "a place on the ground", help));
        }
        self.not_negative(&join(key, "stiffness"), stiffness)?;
        self.not_negative(&join(key, "damping"), damping)?;
        if let Some(length) = free_length {
            let help = "give the length at which the spring has no force; leave it out for that at the start";
            self.require(length >= 0.0, &join(key, "free_length"), "a number of 0 or more", help)?;
        }
        Ok(Spring { name, between, stiffness, damping, free_length })
    }

    /// Refuses a spring between places that joints hold together, one or some in series: a line without length has no direction.
    fn can_be_long(&self, number: usize, spring: &Spring, joints: &[Joint], ends: &Ends<'_>) -> Result<(), SceneError> {
        let [first, second] = spring.between;
        // The places that are held at the first end, each with the place before it and the joint between them.
        let mut held: Vec<(End, Option<(usize, &str)>)> = vec![(first, None)];
        let mut at = 0;
        while at < held.len() && !ends.are_one_place(held[at].0, second) {
            let here = held[at].0;
            for joint in joints.iter().filter(|joint| joint.kind.locked().displacements == [true; 3]) {
                let [i, j] = joint.between;
                for [one, other] in [[i, j], [j, i]] {
                    let is_known = held.iter().any(|(place, _)| ends.are_one_place(*place, other));
                    if ends.are_one_place(one, here) && !is_known {
                        held.push((other, Some((at, &joint.name))));
                    }
                }
            }
            at += 1;
        }
        let Some((_, last)) = held.get(at) else { return Ok(()) };
        let of = |(before, _): &(usize, &str)| held[*before].1;
        let names: Vec<String> = std::iter::successors(*last, of).map(|(_, name)| format!("{name:?}")).collect();
        let found = match &names[..] {
            [name] => format!("a spring between two places that joint {name} holds together"),
            _ => format!("a spring between two places that joints {} hold together", names.join(", ")),
        };
        let help = "name markers that are apart; a spring about the axis of a joint is its `spring`, and one about three axes a bushing";
        let place = self.document.place(&format!("springs[{number}].between"));
        Err(place.refuse(found, "two places that have a line between them", help))
    }

    fn bushing(
        &self,
        key: &str,
        number: usize,
        section: BushingSection,
        ends: &Ends<'_>,
        names: &mut BTreeSet<String>,
    ) -> Result<Bushing, SceneError> {
        let BushingSection { name, between, stiffness, damping } = section;
        let name = self.tie_name(key, name, "bushing", number, names)?;
        let between = self.between(key, &between, ends)?;
        for (table, AlongAndAbout { translation, rotation }) in [("stiffness", stiffness), ("damping", damping)] {
            for (list, values) in [("translation", translation), ("rotation", rotation)] {
                for (axis, value) in values.into_iter().enumerate() {
                    self.not_negative(&format!("{key}.{table}.{list}[{axis}]"), value)?;
                }
            }
        }
        let is_nothing = [stiffness, damping].iter().all(|of| of.translation == [0.0; 3] && of.rotation == [0.0; 3]);
        let help = "give `stiffness = { translation = [x, y, z], rotation = [x, y, z] }`, `damping` likewise, or remove the bushing";
        self.require(!is_nothing, key, "a stiffness or a damping that is not zero", help)?;
        Ok(Bushing { name, between, stiffness, damping })
    }

    /// The name of a tie, or one by its number.
    fn tie_name(
        &self,
        key: &str,
        name: Option<String>,
        what: &str,
        number: usize,
        names: &mut BTreeSet<String>,
    ) -> Result<String, SceneError> {
        let place = || self.document.place(&join(key, "name"));
        let name = match name {
            Some(name) if is_part_of_path(&name) => name,
            Some(name) => {
                let expected = "a name that is not empty, without `.`, `/` and control characters";
                let help = format!("rename the {what}: its name is that of a group in the results file");
                return Err(place().refuse(format!("the name {name:?}"), expected, help));
            }
            None => format!("{what}{}", number + 1),
        };
        if names.insert(name.clone()) {
            return Ok(name);
        }
        let help = format!("give the {what} a `name` of its own");
        Err(place().refuse(
            format!("a second {name:?}"),
            "each name once among joints, springs, bushings and couplings",
            help,
        ))
    }

    /// The ends that `between` names.
    fn between(&self, key: &str, names: &[String], ends: &Ends<'_>) -> Result<[End; 2], SceneError> {
        let key = join(key, "between");
        let help = "name two, e.g. `between = [\"arm.root\", \"ground\"]`";
        let [first, second] = names else {
            let found = format!("{} names", names.len());
            return Err(self.document.place(&key).refuse(found, "the two ends", help));
        };
        let find = |i: usize, name: &str| {
            ends.find(name).map_err(|NoEnd { found, expected, help }| {
                self.document.place(&format!("{key}[{i}]")).refuse(found, expected, help)
            })
        };
        let between = [find(0, first)?, find(1, second)?];
        let refuse = |found: String, help: &str| {
            Err(self.document.place(&key).refuse(found, "markers of two bodies, or of a body and the ground", help))
        };
        match between.map(|end| end.body()) {
            _ if between[0] == between[1] => refuse(format!("{first:?} twice"), "name the other end"),
            [None, None] => refuse("the ground at both ends".to_owned(), "name a marker of a body"),
            [one, other] if one == other => refuse(
                format!("two markers of one body, {first:?} and {second:?}"),
                "nothing moves between them: name another body",
            ),
            _ => Ok(between),
        }
    }

    /// Refuses a joint without the axis that it needs, and an axis that nothing takes.
    fn has_axis(&self, key: &str, kind: JointKind, have_axes: [bool; 2], is_given: bool) -> Result<(), SceneError> {
        if have_axes == [true; 2] && is_given {
            let help = "remove it, or the `z` of a marker";
            let place = self.document.place(&join(key, "axis"));
            return Err(place.refuse("`axis` of a joint whose markers both have axes", "one of them", help));
        }
        if !kind.needs_axis() || is_given || have_axes.contains(&true) {
            return Ok(());
        }
        Err(self.document.place(key).refuse(
            format!("a {} joint without an axis", kind.name()),
            "its axis",
            "add `axis`, global at the start, e.g. `axis = [0, 0, 1]`, or `z` to one of its markers",
        ))
    }

    fn drive(&self, key: &str, kind: JointKind, section: DriveSection) -> Result<JointDrive, SceneError> {
        let DriveSection { along, amplitude, mut history } = section;
        let along = self.along(key, kind, along)?;
        self.history(&join(key, "history"), &mut history)?;
        Ok(JointDrive { along, amplitude, history })
    }

    fn joint_spring(&self, key: &str, kind: JointKind, section: JointSpringSection) -> Result<JointSpring, SceneError> {
        let JointSpringSection { along, stiffness, damping, free, preload, stops, friction } = section;
        let along = self.along(key, kind, along)?;
        self.not_negative(&join(key, "stiffness"), stiffness)?;
        self.not_negative(&join(key, "damping"), damping)?;
        if let Some(Friction { force, rate_scale: rate }) = friction {
            let key = join(key, "friction");
            self.not_negative(&join(&key, "force"), force)?;
            let help =
                "give the rate of the coordinate below which friction is smaller, e.g. a hundredth of the usual one";
            self.positive(&join(&key, "rate"), rate, help)?;
        }
        let stops = stops.map(|stops| self.stops(&join(key, "stops"), stops)).transpose()?;
        Ok(JointSpring { along, stiffness, damping, free, preload, stops, friction })
    }

    fn stops(&self, key: &str, section: StopsSection) -> Result<Stops, SceneError> {
        let StopsSection { low, high, stiffness, damping } = section;
        let help = "give the lowest coordinate, the highest, or both, e.g. `stops = { high = 1.57, stiffness = 1e4 }`";
        self.require(low.is_some() || high.is_some(), key, "`low`, `high` or both", help)?;
        let (low, high) = (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY));
        self.require(low < high, &join(key, "high"), "a number above `low`", help)?;
        self.positive(&join(key, "stiffness"), stiffness, "give the moment or force beyond an end")?;
        self.not_negative(&join(key, "damping"), damping)?;
        Ok(Stops { limits: [low, high], stiffness, damping })
    }

    /// The coordinate that is meant, of those that the joint leaves free.
    fn along(&self, key: &str, kind: JointKind, given: Option<Coordinate>) -> Result<Coordinate, SceneError> {
        let free = kind.coordinates();
        let of_kind = || format!("a {} joint", kind.name());
        match (given, free) {
            (None, [only]) => Ok(*only),
            (Some(given), _) if free.contains(&given) => Ok(given),
            (_, []) => Err(self.document.place(key).refuse(
                format!("{}, which has no turn about an axis and no slide along it", of_kind()),
                "a joint that turns about its axis or slides along it",
                "remove the table, or use a joint of the kind revolute, prismatic, cylindrical or planar",
            )),
            (Some(given), _) => Err(self.document.place(&join(key, "along")).refuse(
                format!("the {} of {}, which has none", given.name(), of_kind()),
                format!("its {}", free[0].name()),
                "change `along`, or the kind of the joint",
            )),
            (None, _) => Err(self.document.place(key).refuse(
                format!("no `along` for {}, which turns and slides", of_kind()),
                "`along = \"turn\"` or `along = \"slide\"`",
                "say which of the two is meant",
            )),
        }
    }

    fn not_negative(&self, key: &str, value: f64) -> Result<(), SceneError> {
        self.require(value >= 0.0, key, "a number of 0 or more", "a negative one would feed energy in")
    }
}

/// A name that is that of no end.
struct NoEnd {
    found: String,
    expected: String,
    help: String,
}

impl Ends<'_> {
    /// The end of this name: `BODY.MARKER`, `ground` or `ground.MARKER`.
    fn find(&self, name: &str) -> Result<End, NoEnd> {
        let (body, marker) = match name.split_once('.') {
            Some((body, marker)) => (body, Some(marker)),
            None => (name, None),
        };
        if body == GROUND {
            let names = || self.ground.iter().map(|marker| marker.name.as_str());
            let find =
                |marker| number_of(marker, names(), &format!("marker {marker:?} of the ground"), "[ground.markers]");
            return Ok(End::Ground { marker: marker.map(find).transpose()? });
        }
        let names = || self.bodies.iter().map(|body| body.name.as_deref().unwrap_or(ONLY_BODY));
        let number = number_of(body, names().chain([GROUND]), &format!("body {body:?}"), "the scene")?;
        let of_body = || self.bodies[number].markers.iter().map(|marker| marker.name.as_str());
        let table = format!("the body {body:?}");
        let Some(marker) = marker else {
            let known: Vec<String> = of_body().map(|marker| format!("{body}.{marker}")).collect();
            return Err(NoEnd {
                found: format!("the body {body:?} without a marker"),
                expected: if known.is_empty() { "a marker of it".to_owned() } else { one_of(&known) },
                help: format!("name a marker of the body, e.g. `{body}.tip` of `[…{body}.markers.tip]`"),
            });
        };
        let marker = number_of(marker, of_body(), &format!("marker {marker:?} of {table}"), &table)?;
        Ok(End::Body { body: number, marker })
    }

    /// True if two ends are one place, though it may have two names.
    fn are_one_place(&self, one: End, other: End) -> bool {
        let of = |body: usize, marker: usize| {
            let marker = &self.bodies[body].markers[marker];
            (&marker.place, marker.tie)
        };
        match (one, other) {
            (End::Body { body, marker }, End::Body { body: same, marker: second }) => {
                body == same && of(body, marker) == of(body, second)
            }
            (End::Ground { marker: Some(one) }, End::Ground { marker: Some(other) }) => {
                self.ground[one].at == self.ground[other].at
            }
            _ => false,
        }
    }

    /// True if the marker at an end has axes of its own.
    fn has_axes(&self, end: End) -> bool {
        match end {
            End::Body { body, marker } => self.bodies[body].markers[marker].axes.is_some(),
            End::Ground { marker } => marker.is_some_and(|marker| self.ground[marker].axes.is_some()),
        }
    }
}

/// The number of a name among those that are known.
fn number_of<'n>(name: &str, known: impl Iterator<Item = &'n str>, what: &str, table: &str) -> Result<usize, NoEnd> {
    let known: Vec<&str> = known.collect();
    if let Some(number) = known.iter().position(|known| *known == name) {
        return Ok(number);
    }
    let help = match nearest(name, &known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("name one that is there, or add it to {table}"),
    };
    let expected = if known.is_empty() {
        format!("a marker, of which {table} has none")
    } else {
        one_of(&known.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>())
    };
    Err(NoEnd { found: format!("the {what}, which is not there"), expected, help })
}

/// Refuses a body in joints with effects off that joints need, with a support that is given a speed, or whose support moves.
fn can_be_tied(body: &Body) -> Result<(), SceneError> {
    let in_joint = "of a body that joints, springs or bushings hold";
    if body.constraint.as_ref().and_then(Constraint::motion).is_some() {
        let help = "say it as a joint between a marker of the body and \"ground\" whose `drive` gives the angle or the path over time";
        let found = format!("the speed of a constraint {in_joint}");
        return Err(body.refuse("constraints[0].motion", found, "a constraint without `motion`", help));
    }
    if let Some(number) = body.loads.iter().position(|load| load.kind == LoadKind::BaseAcceleration) {
        let help = "give each body of the scene a load `kind = \"gravity\"` in the opposite direction";
        let found = format!("the acceleration of the base {in_joint}");
        return Err(body.refuse(
            &format!("loads[{number}].kind"),
            found,
            "a body that its constraints alone hold",
            help,
        ));
    }
    for effect in [Effect::Translation, Effect::Rotation] {
        if body.effects.choices[effect] == Choice::Off {
            let found = format!("`{} = false` {in_joint}", effect.name());
            return Err(body.refuse(&join("effects", effect.name()), found, "`true` or `\"auto\"`", "remove it"));
        }
    }
    Ok(())
}
