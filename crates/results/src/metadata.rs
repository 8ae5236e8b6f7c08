//! Metadata of a results file: the run as a whole.

use crate::FileError;
use crate::error::check_length;
use crate::kind::{NATURAL_MODE, STATIC_SHAPE};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::path::Path;

/// Labels of the units; any consistent set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// For instance "mm".
    pub length: String,
    /// For instance "Mg".
    pub mass: String,
    /// For instance "s".
    pub time: String,
}

impl Units {
    /// A unit such as "mass length/time", in these labels in place of the three words.
    pub(crate) fn in_labels(&self, unit: &str) -> String {
        let is_no_letter = |c: char| !c.is_ascii_lowercase();
        let replaced = unit.split_inclusive(is_no_letter).map(|piece| {
            let word = piece.trim_end_matches(is_no_letter);
            let label = match word {
                "length" => &self.length,
                "mass" => &self.mass,
                "time" => &self.time,
                other => other,
            };
            label.to_owned() + &piece[word.len()..]
        });
        replaced.collect()
    }
}

/// Rigid-body and modal properties of the body, in its undeformed state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyProperties {
    /// Total mass.
    pub mass: f64,
    /// Centre of mass in the mesh's coordinates.
    pub center_of_mass: [f64; 3],
    /// Inertia about the centre of mass, body axes, row by row.
    pub inertia: [[f64; 3]; 3],
    /// Origin of the body frame in the mesh's coordinates.
    pub origin: [f64; 3],
    /// Natural frequencies of the flexible modes, in cycles per unit of time (Hz if that is s); after them those of the
    /// static shapes, which are no natural frequencies.
    pub frequencies: Vec<f64>,
    /// Damping ratios of the flexible modes and static shapes, as many as frequencies.
    pub damping_ratios: Vec<f64>,
    /// How many static shapes there are.
    pub static_shapes: usize,
    /// Kind of each coordinate, in words; empty where natural modes come first and then static shapes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub kinds: Vec<String>,
    /// Unit vectors, body axes, about which the support lets the body turn: three, one or none.
    pub rotation_axes: Vec<[f64; 3]>,
    /// Unit vectors, body axes, along which the support lets the origin move: three, one or none.
    pub translation_axes: Vec<[f64; 3]>,
    /// The finite-element model; `None` for a rigid body without one.
    pub mesh: Option<MeshProperties>,
}

/// Size of a finite-element model, and the file that has all of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshProperties {
    /// Nodes.
    pub nodes: usize,
    /// Elements; 0 where they are not known.
    pub elements: usize,
    /// Extent along the axes of the mesh.
    pub size: [f64; 3],
    /// The body file with the shapes on all nodes, for what the results file does not carry: a path, written as
    /// [`Metadata::scene_file`], or a name, of a file beside the results file.
    pub body_file: String,
    /// Hash of the shapes on all nodes, in hexadecimal digits: the body file has the same ones.
    pub shapes_hash: String,
}

/// An effect of the motion, in words: whether the run has it, and why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EffectProperties {
    /// Its name.
    pub name: String,
    /// "on", "off", or "–" where it cannot act.
    pub state: String,
    /// How large it is, as a formula and its value.
    pub measure: String,
    /// A sentence that says why.
    pub reason: String,
}

/// A line of the trust card of a run: one place where its answer may be wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrustLine {
    /// The place, such as "mesh".
    pub place: String,
    /// The body that it is worst in; `None` in a run of a single one, and where all bodies are alike.
    pub body: Option<String>,
    /// The error, relative; `None` where it is not known.
    pub error: Option<f64>,
    /// Meaning of the error, or that it is not known and why.
    pub meaning: String,
    /// The way in which it is known; empty where it is not.
    pub known: String,
    /// Means that would make it smaller, or known; empty where nothing is called for.
    pub next: String,
}

/// Everything of one body that does not change with time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyMetadata {
    /// Its name, which is that of its group.
    pub name: String,
    /// Its model.
    pub model: BodyProperties,
    /// Names of the points whose motion is stored, in the order of a row's points.
    pub point_names: Vec<String>,
    /// Where they are in the undeformed body, in the mesh's coordinates.
    pub point_positions: Vec<[f64; 3]>,
    /// Further parts of the run, so that the body has the columns that ask for them ([`Column::part`](crate::Column::part)).
    pub parts: Vec<String>,
    /// Names of the supports whose reactions are stored, where there are several, in the order of a row's supports.
    pub support_names: Vec<String>,
    /// Effects of the motion.
    pub effects: Vec<EffectProperties>,
    /// Known error of the model at the beginning, in a run that was wanted all the same.
    pub refusal: Option<String>,
}

/// Everything of one joint that does not change with time.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointMetadata {
    /// Its name, which is that of its group.
    pub name: String,
    /// Its kind, such as "revolute".
    pub kind: String,
    /// The two markers that it joins, such as "arm.root", or "ground".
    pub between: [String; 2],
    /// Further parts of it, so that it has the columns that ask for them ([`Column::part`](crate::Column::part)).
    pub parts: Vec<String>,
}

/// Everything in a results file that does not change with time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Metadata {
    /// Title of the scene.
    pub title: String,
    /// Labels of the units.
    pub units: Units,
    /// Name of the formulation of the equations of motion.
    pub formulation: String,
    /// Name of the time-integration scheme.
    pub scheme: String,
    /// Length of its steps, where they have one.
    pub step: Option<f64>,
    /// Bound of the sum of the estimated relative errors of all steps, where that sets their lengths.
    pub tolerance: Option<f64>,
    /// Version of the program that made the run.
    pub program_version: String,
    /// Time at which the run is to end.
    pub end: f64,
    /// The scene file, word for word, for people: nothing that comes after the run reads it.
    pub scene_text: String,
    /// Where the scene file was, so that the files that it names can be found again; empty if nowhere. A path, or one that is
    /// no UTF-8 as a `file:` URL.
    pub scene_file: String,
    /// The files that the run read, the scene among them, written alike.
    pub input_files: Vec<String>,
    /// The bodies, at least one, in the order of the scene.
    pub bodies: Vec<BodyMetadata>,
    /// The joints, then the springs and the bushings, each in the order of the scene.
    #[serde(default)]
    pub joints: Vec<JointMetadata>,
    /// Warnings of the run, each a sentence or more: see [`Writer::warn`](crate::Writer::warn).
    pub warnings: Vec<String>,
    /// The trust card, the worst line first; empty in an unfinished file: see [`Writer::trust`](crate::Writer::trust).
    #[serde(default)]
    pub trust: Vec<TrustLine>,
}

impl BodyProperties {
    /// Kind of each coordinate, in words.
    pub fn kinds(&self) -> impl ExactSizeIterator<Item = &str> {
        let count = self.frequencies.len();
        let natural = count.saturating_sub(self.static_shapes);
        (0..count).map(move |k| match self.kinds.get(k) {
            Some(kind) => kind,
            None if k < natural => NATURAL_MODE,
            None => STATIC_SHAPE,
        })
    }
}

impl JointMetadata {
    /// Path of something of this joint, from its path in the joint's group.
    pub(crate) fn path(&self, path: &str) -> String {
        format!("{JOINTS}/{}/{path}", self.name)
    }
}

impl BodyMetadata {
    /// Path of something of this body, from its path in the body's group.
    pub(crate) fn path(&self, path: &str) -> String {
        format!("{BODIES}/{}/{path}", self.name)
    }

    /// Refuses what a file cannot hold; `file` is named in messages.
    fn check(&self, file: &Path) -> Result<(), FileError> {
        self.check_names(file)?;
        let BodyProperties {
            mass,
            center_of_mass,
            inertia,
            origin,
            frequencies,
            damping_ratios,
            static_shapes,
            kinds,
            rotation_axes,
            translation_axes,
            mesh,
        } = &self.model;
        for (quantity, expected, found) in [
            ("model/damping_ratios", frequencies.len(), damping_ratios.len()),
            ("model/kinds", frequencies.len(), frequencies.len().max(*static_shapes)),
            ("model/kinds", if kinds.is_empty() { 0 } else { frequencies.len() }, kinds.len()),
            ("points/position", self.point_names.len(), self.point_positions.len()),
        ] {
            check_length(file, &self.path(quantity), expected, found)?;
        }
        for (quantity, values) in [
            ("model/mass", &[*mass][..]),
            ("model/center_of_mass", center_of_mass),
            ("model/inertia", inertia.as_flattened()),
            ("model/origin", origin),
            ("points/position", self.point_positions.as_flattened()),
            ("model/frequencies", frequencies),
            ("model/damping_ratios", damping_ratios),
            ("model/rotation_axes", rotation_axes.as_flattened()),
            ("model/translation_axes", translation_axes.as_flattened()),
            ("model/mesh/size", mesh.as_ref().map_or(&[], |mesh| &mesh.size)),
        ] {
            check_finite(file, || self.path(quantity), values)?;
        }
        Ok(())
    }

    fn check_names(&self, file: &Path) -> Result<(), FileError> {
        check_names(file, "output point", self.point_names.iter())?;
        check_names(file, "support", self.support_names.iter())
    }
}

impl Metadata {
    /// The body, where it is the only one.
    pub fn only_body(&self) -> Option<&BodyMetadata> {
        match &self.bodies[..] {
            [body] => Some(body),
            _ => None,
        }
    }

    /// Refuses what a file cannot hold; `path` is named in messages.
    pub(crate) fn check(&self, path: &Path) -> Result<(), FileError> {
        check_length(path, "the list of bodies", self.bodies.len().max(1), self.bodies.len())?;
        check_names(path, "body", self.bodies.iter().map(|body| &body.name))?;
        self.bodies.iter().try_for_each(|body| body.check(path))?;
        check_names(path, "joint", self.joints.iter().map(|joint| &joint.name))?;
        for (quantity, values) in
            [("end", &[self.end][..]), ("step", self.step.as_slice()), ("tolerance", self.tolerance.as_slice())]
        {
            check_finite(path, || quantity.to_owned(), values)?;
        }
        let errors = self.trust.iter().filter_map(|line| line.error);
        check_finite(path, || "trust/error".to_owned(), &errors.collect::<Vec<_>>())
    }
}

/// Refuses names that cannot be parts of a path, or occur twice.
fn check_names<'n>(path: &Path, kind: &'static str, names: impl Iterator<Item = &'n String>) -> Result<(), FileError> {
    let mut before = HashSet::new();
    for name in names {
        let reason = match name.as_str() {
            "" => "it is empty",
            name if name.contains('/') => "it holds a /, which separates the parts of a path",
            name if name.contains('\0') => "it holds a NUL character",
            name if !before.insert(name) => "it occurs twice",
            _ => continue,
        };
        return Err(FileError::PlaceName { path: path.to_path_buf(), kind, name: name.clone(), reason });
    }
    Ok(())
}

fn check_finite(path: &Path, quantity: impl Fn() -> String, values: &[f64]) -> Result<(), FileError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(FileError::ConstantNotFinite { path: path.to_path_buf(), quantity: quantity(), value }),
        None => Ok(()),
    }
}

/// Group of the bodies.
pub(crate) const BODIES: &str = "bodies";

/// Group of the joints.
pub(crate) const JOINTS: &str = "joints";
