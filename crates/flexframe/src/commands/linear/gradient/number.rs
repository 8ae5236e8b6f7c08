//! Numbers of a scene of one body, or of bodies in joints, that its vibrations follow.

use diagnostic::{Failure, Kind};
use fem_tet10::BodyNumber;
use model::{BuildError, Parameter};
use scene::{AlongAndAbout, Body, BodySource, MeshedBody, Scene, one_of};

use crate::commands::modes::lone_body;

/// A number of a scene, with the path of its key.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Number {
    pub name: String,
    pub place: Place,
}

/// Where it stands.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Place {
    Spring(usize),
    /// Number, part of its stiffness, axis.
    Bushing(usize, Part, usize),
    Joint(usize),
    /// Number of the body in the scene.
    Body(usize, Parameter),
}

/// A part of the stiffness of a bushing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Part {
    Translation,
    Rotation,
}

/// The refusal of a name that is none of a number, or is named twice.
fn no_number(name: &str, expected: String) -> Failure {
    let help = "name each once; of bodies in joints, stiffnesses and the materials and point masses of bodies with a mesh are the parameters \
                that frequencies have rates with";
    Kind::Usage.alone().found(name).expected(expected).help(help).into()
}

impl Number {
    /// All of a scene: stiffnesses that are not zero, then the materials and point masses of bodies.
    ///
    /// # Errors
    /// A body whose numbers cannot be listed.
    pub fn all(scene: &Scene) -> Result<Vec<Self>, Failure> {
        if !scene.has_connections() {
            let numbers = Parameter::all(lone_body(scene).map_err(BuildError::from)?);
            return Ok(Self::of_body(0, numbers.map_err(BuildError::from)?).collect());
        }
        let springs = scene
            .springs
            .iter()
            .enumerate()
            .map(|(i, _)| Self { name: format!("springs[{i}].stiffness"), place: Place::Spring(i) });
        let of_bushing = |i: usize| {
            let of = move |(kind, part): (&'static str, Part)| {
                (0..3).map(move |axis| Self {
                    name: format!("bushings[{i}].stiffness.{kind}[{axis}]"),
                    place: Place::Bushing(i, part, axis),
                })
            };
            [("translation", Part::Translation), ("rotation", Part::Rotation)].into_iter().flat_map(of)
        };
        let joints = scene
            .joints
            .iter()
            .enumerate()
            .filter(|(_, joint)| joint.spring.is_some())
            .map(|(i, _)| Self { name: format!("joints[{i}].spring.stiffness"), place: Place::Joint(i) });
        let stiffnesses = springs.chain((0..scene.bushings.len()).flat_map(of_bushing)).chain(joints);
        let mut all: Vec<Self> = stiffnesses.filter(|stiffness| stiffness.value(scene) > 0.0).collect();
        for (number, body) in scene.bodies.iter().enumerate().filter(|(_, body)| varies(body)) {
            let numbers = Parameter::all(body).map_err(BuildError::from)?;
            all.extend(Self::of_body(number, numbers));
        }
        Ok(all)
    }

    fn of_body(body: usize, numbers: Vec<Parameter>) -> impl Iterator<Item = Self> {
        numbers.into_iter().map(move |of| Self { name: of.name.clone(), place: Place::Body(body, of) })
    }

    /// The numbers of some names, of one body also stretches of its mesh; all without any.
    pub fn named(scene: &Scene, names: &[String]) -> Result<Vec<Self>, Failure> {
        if !scene.has_connections() {
            let numbers = Parameter::named(lone_body(scene).map_err(BuildError::from)?, names);
            return Ok(Self::of_body(0, numbers.map_err(BuildError::from)?).collect());
        }
        let all = Self::all(scene)?;
        if names.is_empty() && !all.is_empty() {
            return Ok(all);
        }
        const STIFF: &str = "a spring, a bushing, a joint with a spring or a body with a mesh";
        let of_name = |(i, name): (usize, &String)| {
            let known = all.iter().find(|number| number.name == *name).filter(|_| !names[..i].contains(name));
            known.cloned().ok_or_else(|| {
                let names: Vec<String> = all.iter().map(|number| number.name.clone()).collect();
                let expected = match &names[..] {
                    [] => format!("a parameter of {STIFF}, and the scene has none of these"),
                    names => one_of(names),
                };
                no_number(name, expected)
            })
        };
        if names.is_empty() {
            return Err(no_number("nothing that is stiff", STIFF.to_owned()));
        }
        names.iter().enumerate().map(of_name).collect()
    }

    /// Its value in a scene.
    pub fn value(&self, scene: &Scene) -> f64 {
        match &self.place {
            Place::Spring(i) => scene.springs[*i].stiffness,
            Place::Bushing(i, part, axis) => {
                let AlongAndAbout { translation, rotation } = scene.bushings[*i].stiffness;
                match part {
                    Part::Translation => translation[*axis],
                    Part::Rotation => rotation[*axis],
                }
            }
            Place::Joint(i) => scene.joints[*i].spring.map_or(0.0, |spring| spring.stiffness),
            Place::Body(i, parameter) => meshed(&scene.bodies[*i]).map_or(f64::NAN, |body| parameter.value(body)),
        }
    }

    /// Gives it a value in a scene.
    pub fn set(&self, scene: &mut Scene, value: f64) {
        match &self.place {
            Place::Spring(i) => scene.springs[*i].stiffness = value,
            Place::Bushing(i, part, axis) => {
                let AlongAndAbout { translation, rotation } = &mut scene.bushings[*i].stiffness;
                match part {
                    Part::Translation => translation[*axis] = value,
                    Part::Rotation => rotation[*axis] = value,
                }
            }
            Place::Joint(i) => {
                if let Some(spring) = &mut scene.joints[*i].spring {
                    spring.stiffness = value;
                }
            }
            Place::Body(i, parameter) => {
                if let BodySource::Meshed(body) = &mut scene.bodies[*i].source {
                    parameter.set(body, value);
                }
            }
        }
    }

    /// The number of a body that it is.
    pub fn parameter(&self) -> Option<&Parameter> {
        match &self.place {
            Place::Body(_, parameter) => Some(parameter),
            _ => None,
        }
    }

    /// True of a Poisson's ratio.
    pub fn is_poisson_ratio(&self) -> bool {
        self.parameter().is_some_and(|parameter| matches!(parameter.number, BodyNumber::PoissonRatio(_)))
    }
}

/// True of a body in joints whose modes follow from its mesh and its materials alone.
fn varies(body: &Body) -> bool {
    let Some(_) = meshed(body) else { return false };
    body.tied && body.modes.flexible.most() > 0 && body.modes.about.is_none() && body.modes.measured.is_none()
}

fn meshed(body: &Body) -> Option<&MeshedBody> {
    match &body.source {
        BodySource::Meshed(meshed) => Some(meshed),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_without_a_parameter_says_what_one_would_be() {
        let text = "title = \"t\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n[bodies.a]\n\
                    rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }\n\
                    markers = { root = { at = [0, 0, 0] } }\n[[joints]]\nname = \"j\"\nkind = \"revolute\"\naxis = [0, 0, 1]\n\
                    between = [\"ground\", \"a.root\"]\n[time]\nend = 1.0\nstep = 0.1\n";
        let scene = Scene::parse(text, "scene.toml").unwrap();
        for names in [&[][..], &["springs[0].stiffness".to_owned()]] {
            let told = Number::named(&scene, names).unwrap_err().to_string();
            assert!(told.contains("a spring, a bushing, a joint with a spring or a body with a mesh"), "{told}");
        }
    }
}
