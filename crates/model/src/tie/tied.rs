//! The systems of a scene: bodies that joints, springs and bushings connect.

use std::sync::Arc;

use dynamics::{
    ConservativeBody, Coordinate, Effect, ForceElement, JointForce, JointPart, Marker, MotionState, Physics,
    PointSpring,
};
use nalgebra::{Matrix3, Vector3};
use scene::{
    AlongAndAbout, Body, Bushing, Choice, CouplingKind, End, Joint, JointDrive, JointKind, JointSpring, Locked, Scene,
    Spring,
};

use crate::error::BuildError;
use crate::load::history::history_at;
use crate::model::Model;
use crate::tie::axes::axes;
use crate::tie::body_marker::UnknownTurns;
use crate::tie::ends::{EndAtStart, both};
use crate::tie::islands::islands;
use crate::tie::pairs::{Unpaired, pairs};

/// Sine or cosine of the angle between an axis and a line below which they are parallel or at right angles.
const ALONG: f64 = 1e-6;
/// Time on both sides of a discontinuity at which a drive is looked at, over that of the run.
const BESIDE: f64 = 4e-13;
/// Least jump of a drive over its largest value.
const JUMP: f64 = 1e-9;

/// Bodies that joints, springs and bushings connect with each other.
#[derive(Debug, Clone)]
pub struct Tied {
    /// Their numbers in the scene, ascending: the bodies of [`Tied::system`], in its order.
    pub bodies: Vec<usize>,
    /// The numbers of their joints in the scene, in the order of the system.
    pub joints: Vec<usize>,
    /// The numbers of their couplings in the scene, in the order of the system.
    pub couplings: Vec<usize>,
    /// Names of their springs and bushings, in the order of the system.
    pub elements: Vec<String>,
    /// The bodies, the joints and the elements.
    pub system: dynamics::System,
    /// The motion of each body at the start, as the scene places it: the joints may not fit yet.
    pub states: Vec<MotionState>,
}

/// The systems of a scene, from a model of each of its bodies. Bodies that nothing ties are in none; the ground does not connect.
///
/// # Errors
/// [`BuildError`] for a joint that would hold turns that its marker does not know, for histories, and for a body that is known
/// to be wrong.
pub fn tie(scene: &Scene, models: &[Model]) -> Result<Vec<Tied>, BuildError> {
    tie_models(scene, &models.iter().collect::<Vec<_>>(), false)
}

/// The same of models that are elsewhere. With `together` all bodies are one system, also those that nothing ties.
///
/// # Errors
/// As [`tie`].
pub fn tie_models(scene: &Scene, models: &[&Model], together: bool) -> Result<Vec<Tied>, BuildError> {
    let systems = if together { vec![(0..models.len()).collect()] } else { islands_of(scene, models.len()) };
    systems.into_iter().map(|bodies| Island::new(scene, models, bodies)?.tied()).collect()
}

/// The physics of a body in a system: one at rest that nothing of its scene moves may be moved by others, and by laws from outside.
pub fn physics_in_system(body: &Body, physics: &Physics) -> Physics {
    let mut physics = physics.clone();
    for effect in [Effect::Translation, Effect::Rotation] {
        physics.effects[effect] |= body.effects.choices[effect] == Choice::Auto;
    }
    physics
}

impl Tied {
    /// The markers at two ends, with the axes that a bushing between them has, for a force between them from outside.
    ///
    /// # Errors
    /// [`BuildError`] for a marker whose nodes do not tell all turns.
    pub fn markers(&self, scene: &Scene, models: &[&Model], between: [End; 2]) -> Result<[Marker; 2], BuildError> {
        let island = Island { scene, models, bodies: self.bodies.clone(), states: self.states.clone() };
        if let Some(i) = island.unknown_turns(between) {
            let key = format!("{}.markers", scene.name_of(between[i]).split('.').next().unwrap_or_default());
            return Err(island.refuse(&key, "nodes that do not tell all turns", "a force between markers"));
        }
        Ok(island.markers(between, None))
    }
}

/// Numbers of the bodies of each system.
fn islands_of(scene: &Scene, bodies: usize) -> Vec<Vec<usize>> {
    let Scene { joints, springs, bushings, .. } = scene;
    let of_joints = joints.iter().map(|joint| joint.between);
    let of_elements = springs.iter().map(|spring| spring.between).chain(bushings.iter().map(|b| b.between));
    let pairs = of_joints.chain(of_elements).map(|between| between.map(|end| end.body()));
    // Joints that are coupled may have nothing but the ground in common.
    let first_body = |joint: usize| joints[joint].between.iter().find_map(End::body);
    let coupled = scene.couplings.iter().map(|coupling| coupling.kind.joints().map(first_body));
    let pairs: Vec<_> = pairs.chain(coupled).collect();
    islands(bodies, &pairs)
}

/// Bodies that are connected, with what they are made of.
struct Island<'a> {
    scene: &'a Scene,
    models: &'a [&'a Model],
    /// Numbers in the scene.
    bodies: Vec<usize>,
    states: Vec<MotionState>,
}

impl<'a> Island<'a> {
    fn new(scene: &'a Scene, models: &'a [&'a Model], bodies: Vec<usize>) -> Result<Self, BuildError> {
        let state = |number: &usize| {
            let (of_body, model) = (&scene.bodies[*number], models[*number]);
            if let Some(source) = model.refusal.filter(|_| of_body.effects.refuse) {
                return Err(BuildError::Refused { scene: of_body.path.clone(), source });
            }
            Ok(model.initial(of_body).state(&model.body))
        };
        let states = bodies.iter().map(state).collect::<Result<_, _>>()?;
        Ok(Self { scene, models, bodies, states })
    }

    fn tied(self) -> Result<Tied, BuildError> {
        let scene = self.scene;
        let conservative = |number: &usize| {
            let model = self.models[*number];
            let physics = physics_in_system(&self.scene.bodies[*number], &model.physics);
            ConservativeBody::new(&model.body, model.damping_ratios(), model.loads().to_vec(), &physics)
        };
        let bodies = self.bodies.iter().map(conservative).collect::<Result<_, _>>()?;
        let of_joints = scene.joints.iter().enumerate().filter(|(_, joint)| self.has(joint.between));
        let (numbers, joints): (Vec<_>, Vec<_>) = of_joints
            .map(|(number, joint)| Ok((number, self.joint(joint)?)))
            .collect::<Result<Vec<_>, BuildError>>()?
            .into_iter()
            .unzip();
        let mut names = Vec::new();
        let mut elements: Vec<Arc<dyn ForceElement>> = Vec::new();
        for spring in scene.springs.iter().filter(|spring| self.has(spring.between)) {
            names.push(spring.name.clone());
            elements.push(Arc::new(self.spring(spring)));
        }
        for (number, bushing) in scene.bushings.iter().enumerate().filter(|(_, b)| self.has(b.between)) {
            names.push(bushing.name.clone());
            elements.push(Arc::new(self.bushing(&format!("bushings[{number}]"), bushing)?));
        }
        let number_here = |joint: usize| numbers.iter().position(|number| *number == joint);
        let of_couplings = scene.couplings.iter().enumerate();
        let (couplings, coupled): (Vec<_>, Vec<_>) = of_couplings
            .filter_map(|(number, coupling)| {
                let [first, second] = coupling.kind.joints().map(number_here);
                Some((number, self::coupling(&coupling.name, coupling.kind, [first?, second?])))
            })
            .unzip();
        let system = dynamics::System::new(bodies, joints)?.with_couplings(coupled)?.with_elements(elements)?;
        Ok(Tied { bodies: self.bodies, joints: numbers, couplings, elements: names, system, states: self.states })
    }

    /// True if one of the ends is on a body of these.
    fn has(&self, between: [End; 2]) -> bool {
        between.iter().filter_map(End::body).any(|body| self.bodies.contains(&body))
    }

    fn ends(&self, between: [End; 2]) -> [EndAtStart<'a>; 2] {
        both(between, &self.scene.ground, |body, marker| {
            let number = self.bodies.iter().position(|of| *of == body).unwrap_or_default();
            let axes = self.scene.bodies[body].markers[marker].axes.as_ref();
            EndAtStart::on_body((number, self.models[body]), marker, axes, &self.states[number])
        })
    }

    fn markers(&self, between: [End; 2], axis: Option<[f64; 3]>) -> [Marker; 2] {
        let ends = self.ends(between);
        let [first, second] = axes(&ends, axis.map(Vector3::from));
        [ends[0].marker(first), ends[1].marker(second)]
    }

    fn joint(&self, joint: &Joint) -> Result<dynamics::Joint, BuildError> {
        let Joint { key, name, kind, between, axis, drive, spring, motor } = joint;
        let turns = [drive.as_ref().map(|drive| drive.along), spring.map(|spring| spring.along)];
        let acts_on_turn = turns.contains(&Some(Coordinate::Turn));
        self.knows_turns(key, joint, acts_on_turn)?;
        let ends = self.ends(*between);
        let axes = axes(&ends, axis.map(Vector3::from));
        let markers = [ends[0].marker(axes[0]), ends[1].marker(axes[1])];
        let Locked { displacements, turns } = kind.locked();
        let mut made = match self.pairs(key, *kind, &ends, &axes)? {
            pairs if pairs.is_empty() => dynamics::Joint::locked(name, markers, displacements, turns),
            pairs => {
                // A node has no turn.
                let turns = if ends.iter().any(EndAtStart::is_by_nodes) { [false; 3] } else { turns };
                let part = |markers| JointPart::locked(markers, displacements, turns);
                dynamics::Joint::new(name, markers, Vec::new()).with_parts(pairs.into_iter().map(part).collect())
            }
        };
        if let Some(drive) = drive {
            let given = self.continuous_drive(&format!("{key}.drive"), drive)?;
            made = match drive.along {
                Coordinate::Turn => made.turned_by(given),
                Coordinate::Slide => made.moved_by(given),
            };
        }
        for along in kind.coordinates() {
            let spring = spring.as_ref().filter(|spring| spring.along == *along);
            let motor = motor.as_ref().filter(|motor| motor.along == *along);
            if spring.is_none() && motor.is_none() {
                continue;
            }
            let motor = motor.map(|motor| self.drive(&format!("{key}.motor"), motor)).transpose()?;
            let force = JointForce { motor, ..spring.map(force).unwrap_or_default() };
            made = made.with_force(*along, force);
        }
        Ok(made)
    }

    /// Pairs of places of the two ends, where these are several; refused where they do not fit each other or the joint.
    fn pairs(
        &self,
        key: &str,
        kind: JointKind,
        ends: &[EndAtStart<'_>; 2],
        axes: &[Matrix3<f64>; 2],
    ) -> Result<Vec<[Marker; 2]>, BuildError> {
        let refuse = |key: &str, found: String, expected: String, help: &str| {
            BuildError::from(self.scene.place(key).refuse(found, expected, help))
        };
        let pairs = pairs(ends, axes).map_err(|unpaired| match unpaired {
            Unpaired::Count([first, second]) => refuse(
                &format!("{key}.between"),
                format!("markers of {first} and {second} places"),
                "as many places on both".to_owned(),
                "give both markers the same nodes or as many `patches`, or let both be means of faces",
            ),
            Unpaired::OnePlace(end) => refuse(
                &format!("{key}.between[{end}]"),
                "a marker of one place on a flexible body, against one of several".to_owned(),
                "as many places on both".to_owned(),
                "give it the same nodes or as many `patches`; the ground and bodies with `flexible = 0` need none",
            ),
            Unpaired::Apart(distance) => refuse(
                &format!("{key}.between"),
                format!("markers with places that are {distance:.3e} apart when their middles are not"),
                "places that fit each other".to_owned(),
                "place the bodies so that the markers lie on each other, with nodes at the same places or patches of the same surface",
            ),
        })?;
        let Some(places) = ends.iter().map(EndAtStart::part_positions).find(|places| !places.is_empty()) else {
            return Ok(pairs);
        };
        let by_nodes = ends.iter().any(EndAtStart::is_by_nodes);
        let (what, expected, fits) = match (by_nodes, line(&places)) {
            // Each node is held along some axes, and turns as it will.
            (true, _) if kind.locked().turns == [false; 3] && kind != JointKind::Spherical => return Ok(pairs),
            (true, None) if places.len() == 1 => ("a node", "spherical", kind == JointKind::Spherical),
            (true, None) => ("nodes that are not on a line, one by one", "fixed", kind == JointKind::Fixed),
            (true, Some(_)) => ("nodes on a line, one by one", "revolute", kind == JointKind::Revolute),
            (false, line) => {
                let along = line.is_some_and(|line| line.dot(&axes[0].column(2)).abs() > 1.0 - ALONG);
                let fits = kind == JointKind::Fixed || kind == JointKind::Revolute && along;
                ("patches", "fixed, or revolute about the line on which the patches follow each other", fits)
            }
        };
        if fits {
            return Ok(pairs);
        }
        let key = format!("{key}.{}", if matches!(kind, JointKind::Other(_)) { "locked" } else { "kind" });
        let found = format!("a {} joint of a marker of {what}", kind.name());
        let help = "change `kind`, or let the marker be the mean of its region: remove `tie` or `patches`";
        Err(refuse(&key, found, format!("a joint that is {expected}"), help))
    }

    /// Refuses a joint that holds turns of a marker which its nodes do not tell.
    fn knows_turns(&self, key: &str, joint: &Joint, acts_on_turn: bool) -> Result<(), BuildError> {
        let ends = self.ends(joint.between);
        let both = axes(&ends, joint.axis.map(Vector3::from));
        for (i, (end, axes)) in ends.iter().zip(&both).enumerate() {
            let turns = joint.kind.locked().turns;
            let is_held = |line: &Vector3<f64>, k: usize| turns[k] && axes.column(k).dot(line).abs() > ALONG;
            let holds = |line: Vector3<f64>| acts_on_turn || (0..3).any(|k| is_held(&line, k));
            let (found, held) = match end.unknown_turns() {
                UnknownTurns::None => continue,
                UnknownTurns::About(line) => ("nodes on a line, which have no turn about it", holds(line)),
                UnknownTurns::All => ("a node that has no turn", turns.contains(&true)),
            };
            if held {
                let by = format!("a {} joint", joint.kind.name());
                return Err(self.refuse(&format!("{key}.between[{i}]"), found, &by));
            }
        }
        Ok(())
    }

    /// The first of two ends whose nodes do not tell all turns.
    fn unknown_turns(&self, between: [End; 2]) -> Option<usize> {
        self.ends(between).iter().position(|end| end.unknown_turns() != UnknownTurns::None)
    }

    fn refuse(&self, key: &str, found: &str, by: &str) -> BuildError {
        let found = format!("a marker of {found}, in {by}, which holds that turn");
        let help = "let the marker take faces (`group`, `box`, `at` with `radius`), or use a joint that leaves the turn free: \
                    a line of nodes is hinged by `tie = \"nodes\"` and a revolute joint along it";
        self.scene.place(key).refuse(found, "a marker whose turns are known", help).into()
    }

    /// The drive of a coordinate, which may not jump: no force moves a body in no time.
    fn continuous_drive(&self, key: &str, drive: &JointDrive) -> Result<dynamics::JointDrive, BuildError> {
        let made = self.drive(key, drive)?;
        let end = self.scene.time.end;
        let beside = |time: f64, by: f64| made.history.at(time, time + by * BESIDE * end);
        let rounding = JUMP * made.history.largest(end);
        let jump =
            made.history.discontinuities().into_iter().filter(|time| *time > 0.0 && *time < end).find_map(|time| {
                let [before, after] = [-1.0, 1.0].map(|by| beside(time, by));
                ((after - before).abs() > rounding).then_some((time, before, after))
            });
        let Some((time, before, after)) = jump else { return Ok(made) };
        let [before, after] = [before, after].map(|factor| drive.amplitude * factor);
        let found = format!("a coordinate that jumps from {before} to {after} at time {time}");
        let help = "give it time: a `ramp`, a `table`, or a formula without jumps; a force or a moment that jumps is a `motor`";
        Err(self.scene.place(&format!("{key}.history")).refuse(found, "a coordinate without jumps", help).into())
    }

    fn drive(&self, key: &str, drive: &JointDrive) -> Result<dynamics::JointDrive, BuildError> {
        let place = |key: &str| self.scene.place(key);
        let history = history_at((self.scene.time.end, &place), &format!("{key}.history"), &drive.history)?;
        Ok(dynamics::JointDrive { amplitude: drive.amplitude, history })
    }

    fn spring(&self, spring: &Spring) -> PointSpring {
        let [first, second] = self.ends(spring.between);
        PointSpring {
            markers: self.markers(spring.between, None),
            stiffness: spring.stiffness,
            damping: spring.damping,
            free_length: spring.free_length.unwrap_or_else(|| (second.position - first.position).norm()),
        }
    }

    fn bushing(&self, key: &str, bushing: &Bushing) -> Result<dynamics::Bushing, BuildError> {
        let turns = [bushing.stiffness, bushing.damping].iter().any(|of| of.rotation != [0.0; 3]);
        if let (true, Some(i)) = (turns, self.unknown_turns(bushing.between)) {
            return Err(self.refuse(&format!("{key}.between[{i}]"), "nodes that do not tell all turns", "a bushing"));
        }
        let lists = |of: AlongAndAbout| [of.translation, of.rotation].map(Vector3::from);
        Ok(dynamics::Bushing {
            markers: self.markers(bushing.between, None),
            stiffness: lists(bushing.stiffness),
            damping: lists(bushing.damping),
        })
    }
}

/// The direction of the line that places are on; none where they are not, or are one.
fn line(places: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let middle = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
    let farthest = places.iter().map(|x| x - middle).max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let along = farthest.try_normalize(f64::MIN_POSITIVE)?;
    let is_on = |x: &Vector3<f64>| (x - middle).cross(&along).norm() <= ALONG * farthest.norm();
    places.iter().all(is_on).then_some(along)
}

/// A coupling of two joints by their numbers in the system.
fn coupling(name: &str, kind: CouplingKind, joints: [usize; 2]) -> dynamics::Coupling {
    match kind {
        CouplingKind::Gear { ratio, .. } => dynamics::Coupling::gear(name, joints, ratio),
        CouplingKind::Rack { radius, .. } => dynamics::Coupling::rack(name, joints, radius),
        CouplingKind::Screw { lead, .. } => dynamics::Coupling::screw(name, joints[0], lead),
    }
}

/// The force of a spring along a coordinate.
fn force(spring: &JointSpring) -> JointForce {
    let JointSpring { along: _, stiffness, damping, free, preload, stops, friction } = *spring;
    JointForce { stiffness, damping, free, preload, stops, friction, ..JointForce::default() }
}
