//! Numbers of a scene that rates are found with.

use fem_tet10::{BodyNumber, Material, Materials};
use scene::{Body, BodySource, MeshedBody, SceneError, key_path, one_of};

/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];
/// The first part of the name of a stretch.
const THICKNESS: &str = "thickness";

/// A number of a scene, with its name: the path of its key in the scene file, or `thickness.z` and `thickness.GROUP.z` for a factor by
/// which the mesh or a group of it is stretched along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its meaning in the body.
    pub number: BodyNumber,
}

impl Parameter {
    /// All keys of the materials and the point masses of a scene's body.
    ///
    /// # Errors
    /// The refusal of a body that is not made of elements with materials.
    pub fn all(given: &Body) -> Result<Vec<Self>, SceneError> {
        let body = meshed(given)?;
        let in_file = |key: String, number: BodyNumber| Self { name: given.place(&key).key, number };
        let mut all = Vec::new();
        let mut of_material = |key: &str, group: Option<String>| {
            let numbers = [
                ("young_modulus", BodyNumber::YoungModulus(group.clone())),
                ("poisson_ratio", BodyNumber::PoissonRatio(group.clone())),
                ("density", BodyNumber::Density(group)),
            ];
            all.extend(numbers.map(|(name, number)| in_file(key_path(key, name), number)));
        };
        match &body.materials {
            Materials::Uniform(_) => of_material("body.material", None),
            Materials::ByGroup(by_name) => {
                by_name.keys().for_each(|name| of_material(&key_path("body.materials", name), Some(name.clone())))
            }
        }
        let masses = 0..body.point_masses.len();
        all.extend(masses.map(|i| in_file(format!("body.point_masses[{i}].mass"), BodyNumber::PointMass(i))));
        Ok(all)
    }

    /// The parameters of these names; all keys without any.
    ///
    /// # Errors
    /// A name that the scene does not have, or has twice; as [`all`](Self::all).
    pub fn named(body: &Body, names: &[String]) -> Result<Vec<Self>, SceneError> {
        let all = Self::all(body)?;
        if names.is_empty() {
            return Ok(all);
        }
        let of_name = |(i, name): (usize, &String)| {
            let refuse = |found: String, help: &str| {
                let names: Vec<String> = all.iter().map(|parameter| parameter.name.clone()).collect();
                let expected = format!("{}, or thickness.GROUP.z", one_of(&names));
                Err(body.refuse("body", found, expected, help))
            };
            if names[..i].contains(name) {
                return refuse(format!("the parameter {name} twice"), "name each parameter once");
            }
            match all.iter().find(|parameter| parameter.name == *name).cloned().or_else(|| stretch(name)) {
                Some(parameter) => Ok(parameter),
                None => refuse(format!("no parameter {name}"), "name the key as the scene file has it"),
            }
        };
        names.iter().enumerate().map(of_name).collect()
    }

    /// Its value in a body.
    pub fn value(&self, meshed: &MeshedBody) -> f64 {
        let material = |group: &Option<String>| match (&meshed.materials, group) {
            (Materials::Uniform(material), _) => Some(*material),
            (Materials::ByGroup(by_name), Some(name)) => by_name.get(name).copied(),
            (Materials::ByGroup(_), None) => None,
        };
        let value = match &self.number {
            BodyNumber::YoungModulus(group) => material(group).map(|material| material.young_modulus),
            BodyNumber::PoissonRatio(group) => material(group).map(|material| material.poisson_ratio),
            BodyNumber::Density(group) => material(group).map(|material| material.density),
            BodyNumber::PointMass(i) => meshed.point_masses.get(*i).map(|mass| mass.mass),
            BodyNumber::Stretch(..) => Some(1.0),
        };
        value.unwrap_or(f64::NAN)
    }

    /// Gives it a value in a body; a stretch stays.
    pub fn set(&self, meshed: &mut MeshedBody, value: f64) {
        let mut material = |group: &Option<String>, set: fn(&mut Material, f64)| match (&mut meshed.materials, group) {
            (Materials::Uniform(material), _) => set(material, value),
            (Materials::ByGroup(by_name), Some(name)) => {
                if let Some(material) = by_name.get_mut(name) {
                    set(material, value);
                }
            }
            (Materials::ByGroup(_), None) => {}
        };
        match &self.number {
            BodyNumber::YoungModulus(group) => material(group, |material, value| material.young_modulus = value),
            BodyNumber::PoissonRatio(group) => material(group, |material, value| material.poisson_ratio = value),
            BodyNumber::Density(group) => material(group, |material, value| material.density = value),
            BodyNumber::PointMass(i) => {
                if let Some(mass) = meshed.point_masses.get_mut(*i) {
                    mass.mass = value;
                }
            }
            BodyNumber::Stretch(..) => {}
        }
    }

    /// True of a number that stands in the scene.
    pub fn is_key(&self) -> bool {
        !matches!(self.number, BodyNumber::Stretch(..))
    }
}

/// The body of elements of a scene.
///
/// # Errors
/// The refusal of another one.
pub(crate) fn meshed(body: &Body) -> Result<&MeshedBody, SceneError> {
    let (key, found) = match &body.source {
        BodySource::Meshed(meshed) if meshed.tied_masses.is_empty() => return Ok(meshed),
        BodySource::Meshed(_) => ("body.tied_masses", "masses beside the body, whose rates are not known"),
        BodySource::File(_) => ("body.file", "a body file, whose numbers stay"),
        BodySource::Matrices(_) => ("body.matrices", "a body of matrices, whose elements are not known"),
        BodySource::Rigid(_) => ("body.rigid", "a rigid body, which has no natural frequencies"),
    };
    let expected = "a body with a mesh and materials, whose numbers can change";
    Err(body.refuse(key, found, expected, "give the body its mesh: `mesh` and `material` in [body]"))
}

/// The stretch of a name.
fn stretch(name: &str) -> Option<Parameter> {
    let (group, axis) = name.strip_prefix(THICKNESS)?.strip_prefix('.')?.rsplit_once('.').map_or_else(
        || (None, name.rsplit('.').next().unwrap_or_default()),
        |(group, axis)| (Some(group.trim_matches('"').to_owned()), axis),
    );
    let axis = AXES.iter().position(|known| *known == axis)?;
    Some(Parameter { name: name.to_owned(), number: BodyNumber::Stretch(group, axis) })
}
