//! The rigid motions that the support of a body leaves.

use keys::{Key, Keyed};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

use crate::error::{BodyError, check_finite};

/// How far from 1 the length of a direction may be.
const UNIT: f64 = 1e-9;

/// The rigid motions of a body that what holds it leaves free, mesh axes.
///
/// It tells the directions that the body may translate along, the axes that it may turn about, and
/// the point that stays where it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RigidMotion {
    translations: Directions,
    rotations: Directions,
    fixed_point: Option<Vector3<f64>>,
    others: Twists,
}

/// A rigid motion: the velocity of a point of the body, and its angular velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// Velocity of the point.
    pub velocity: Vector3<f64>,
    /// Angular velocity; zero of a translation.
    pub rotation: Vector3<f64>,
}

/// Up to six rigid motions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "Vec<Twist>", try_from = "Vec<Twist>")]
struct Twists {
    list: [Twist; 6],
    count: usize,
}

impl Twists {
    const NONE: Self = Self {
        list: [Twist { velocity: Vector3::new(0.0, 0.0, 0.0), rotation: Vector3::new(0.0, 0.0, 0.0) }; 6],
        count: 0,
    };
}

/// Up to three unit vectors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(into = "Vec<Vector3<f64>>", try_from = "Vec<Vector3<f64>>")]
struct Directions {
    list: [Vector3<f64>; 3],
    count: usize,
}

impl Directions {
    const NONE: Self = Self { list: [Vector3::new(0.0, 0.0, 0.0); 3], count: 0 };
    const ALL: Self = Self {
        list: [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0)],
        count: 3,
    };

    fn one(direction: Vector3<f64>) -> Self {
        Self { list: [direction, Vector3::zeros(), Vector3::zeros()], count: 1 }
    }

    fn as_slice(&self) -> &[Vector3<f64>] {
        &self.list[..self.count]
    }
}

impl From<Twists> for Vec<Twist> {
    fn from(Twists { list, count }: Twists) -> Self {
        list[..count].to_vec()
    }
}

impl TryFrom<Vec<Twist>> for Twists {
    type Error = &'static str;

    fn try_from(twists: Vec<Twist>) -> Result<Self, Self::Error> {
        let mut list = Self::NONE.list;
        list.get_mut(..twists.len()).ok_or("more than six rigid motions")?.copy_from_slice(&twists);
        Ok(Self { list, count: twists.len() })
    }
}

impl From<Directions> for Vec<Vector3<f64>> {
    fn from(directions: Directions) -> Self {
        directions.as_slice().to_vec()
    }
}

impl TryFrom<Vec<Vector3<f64>>> for Directions {
    type Error = &'static str;

    fn try_from(directions: Vec<Vector3<f64>>) -> Result<Self, Self::Error> {
        let mut list = Self::NONE.list;
        list.get_mut(..directions.len()).ok_or("more than three directions")?.copy_from_slice(&directions);
        Ok(Self { list, count: directions.len() })
    }
}

impl RigidMotion {
    /// The motion of a free body: three translations and three rotations.
    pub const fn free() -> Self {
        Self { translations: Directions::ALL, rotations: Directions::ALL, fixed_point: None, others: Twists::NONE }
    }

    /// Three rotations about a point.
    pub const fn pin(point: Vector3<f64>) -> Self {
        Self {
            translations: Directions::NONE,
            rotations: Directions::ALL,
            fixed_point: Some(point),
            others: Twists::NONE,
        }
    }

    /// A rotation about an axis: a point of it and its direction, a unit vector.
    pub fn hinge(point: Vector3<f64>, axis: Vector3<f64>) -> Self {
        Self {
            translations: Directions::NONE,
            rotations: Directions::one(axis),
            fixed_point: Some(point),
            others: Twists::NONE,
        }
    }

    /// A translation along a unit vector.
    pub fn slider(direction: Vector3<f64>) -> Self {
        Self {
            translations: Directions::one(direction),
            rotations: Directions::NONE,
            fixed_point: None,
            others: Twists::NONE,
        }
    }

    /// None: the body can only deform. Positions are measured from `origin`, e.g. a point of the axis that a clamp is
    /// turned about.
    pub const fn clamp(origin: Vector3<f64>) -> Self {
        Self {
            translations: Directions::NONE,
            rotations: Directions::NONE,
            fixed_point: Some(origin),
            others: Twists::NONE,
        }
    }

    /// Motions of another kind, up to six; positions are measured from `origin`.
    pub fn other(origin: Vector3<f64>, motions: impl Iterator<Item = Twist>) -> Self {
        let mut others = Twists::NONE;
        for motion in motions.take(others.list.len()) {
            others.list[others.count] = motion;
            others.count += 1;
        }
        Self { others, ..Self::clamp(origin) }
    }

    /// A basis of the motions that a support left, as velocities of [`Self::fixed_point`] and angular
    /// velocities, where they are not those of a free, pinned, hinged, sliding or clamped body: e.g. two translations and a
    /// rotation in a plane. Empty otherwise. Such a body has modes; the equations of large motion are not there for it.
    pub fn others(&self) -> &[Twist] {
        &self.others.list[..self.others.count]
    }

    /// Unit vectors that the body may translate along: three, one or none.
    pub fn translations(&self) -> &[Vector3<f64>] {
        self.translations.as_slice()
    }

    /// Unit vectors that the body may turn about: three, one or none.
    pub fn rotations(&self) -> &[Vector3<f64>] {
        self.rotations.as_slice()
    }

    /// Number of rigid modes: 6, 3, 1 or 0, or that of [`Self::others`].
    pub fn count(&self) -> usize {
        self.translations.count + self.rotations.count + self.others.count
    }

    /// True if nothing holds the body.
    pub fn is_free(&self) -> bool {
        self.translations.count + self.rotations.count == 6
    }

    /// The point that stays where it is (of a clamp and of [`Self::others`], the one that positions are measured from): the
    /// origin of a body with these motions. `None` where that is the centre of mass.
    pub fn fixed_point(&self) -> Option<Vector3<f64>> {
        self.fixed_point
    }

    /// The part of an angular velocity that the body may have: Σ a aᵀ of its axes.
    pub fn rotation_projector(&self) -> Matrix3<f64> {
        self.rotations().iter().map(|axis| axis * axis.transpose()).sum()
    }

    /// The part of a velocity of its origin that the body may have: Σ d dᵀ of its directions.
    pub fn translation_projector(&self) -> Matrix3<f64> {
        self.translations().iter().map(|direction| direction * direction.transpose()).sum()
    }

    /// T and B of a rigid body with these motions: the velocity of the origin is `T y[..3]` and the angular velocity
    /// `B y[3..6]`, where the kinetic energy is ½|y|². Columns of motions that are missing are zero.
    ///
    /// `inertia` is about the origin. B = L⁻ᵀ with J₀ = L Lᵀ where all rotations are free: no principal axes are
    /// needed, which a sphere does not have.
    ///
    /// # Errors
    /// [`BodyError::NoInertia`] where a motion meets none, [`BodyError::NotUnit`], [`BodyError::NotFinite`].
    pub fn bases(&self, mass: f64, inertia: &Matrix3<f64>) -> Result<(Matrix3<f64>, Matrix3<f64>), BodyError> {
        self.check()?;
        let no_inertia = || BodyError::NoInertia { mass, inertia: inertia.diagonal().into() };
        if !(mass > 0.0 && mass.is_finite()) {
            return Err(no_inertia());
        }
        let (mut translation, mut rotation) = (Matrix3::zeros(), Matrix3::zeros());
        for (i, direction) in self.translations().iter().enumerate() {
            translation.set_column(i, &(direction / mass.sqrt()));
        }
        match self.rotations() {
            [] => {}
            [axis] => {
                let moment = axis.dot(&(inertia * axis));
                if !(moment > 0.0 && moment.is_finite()) {
                    return Err(no_inertia());
                }
                rotation.set_column(0, &(axis / moment.sqrt()));
            }
            _ => {
                let factor = inertia.cholesky().ok_or_else(no_inertia)?.l();
                rotation = factor.transpose().try_inverse().ok_or_else(no_inertia)?;
            }
        }
        Ok((translation, rotation))
    }

    /// Displacements of the point X by each of the motions; rotations are by 1/`length`, of a free body about `center`.
    pub fn displacements(&self, position: &Vector3<f64>, center: &Vector3<f64>, length: f64) -> Vec<Vector3<f64>> {
        let about = self.fixed_point.unwrap_or(*center);
        let turned = self.rotations().iter().map(|axis| axis.cross(&(position - about)) / length);
        let others = self.others().iter().map(|twist| twist.velocity + twist.rotation.cross(&(position - about)));
        self.translations().iter().copied().chain(turned).chain(others).collect()
    }

    /// Angular velocities of the same motions.
    pub fn turns(&self, length: f64) -> Vec<Vector3<f64>> {
        let unturned = self.translations().iter().map(|_| Vector3::zeros());
        let turned = self.rotations().iter().map(|axis| axis / length);
        unturned.chain(turned).chain(self.others().iter().map(|twist| twist.rotation)).collect()
    }

    /// Name of column `mode` of the six rigid shapes in messages.
    pub fn name(&self, mode: usize) -> &'static str {
        match (self.translations(), self.rotations()) {
            _ if self.others.count > 0 => "motion that the support leaves",
            (_, [_]) => "rotation about the hinge",
            ([_], _) => "translation along the slider",
            _ => [
                "translation along x",
                "translation along y",
                "translation along z",
                "rotation about x",
                "rotation about y",
                "rotation about z",
            ][mode],
        }
    }

    /// Refuses points that are not finite and directions that are not unit vectors.
    pub fn check(&self) -> Result<(), BodyError> {
        let point = self.fixed_point().unwrap_or_default();
        check_finite("the support's point", point.iter().copied())?;
        let is_unit = |direction: &Vector3<f64>| (direction.norm() - 1.0).abs() < UNIT;
        match self.translations().iter().chain(self.rotations()).find(|direction| !is_unit(direction)) {
            Some(direction) => Err(BodyError::NotUnit { direction: (*direction).into() }),
            None => Ok(()),
        }
    }
}

/// In words, such as "2 translations and 1 rotation".
impl std::fmt::Display for RigidMotion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let turns = self.turns(1.0);
        let rotations = turns.iter().filter(|turn| **turn != Vector3::zeros()).count();
        let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        match (turns.len() - rotations, rotations) {
            (0, 0) => f.write_str("no rigid motion"),
            (0, rotations) => f.write_str(&counted(rotations, "rotation")),
            (translations, 0) => f.write_str(&counted(translations, "translation")),
            (translations, rotations) => {
                write!(f, "{} and {}", counted(translations, "translation"), counted(rotations, "rotation"))
            }
        }
    }
}

impl Keyed for Twist {
    fn key(&self, key: Key) -> Key {
        key.of("twist", 1).with("velocity", &self.velocity).with("rotation", &self.rotation)
    }
}

impl Keyed for RigidMotion {
    fn key(&self, key: Key) -> Key {
        let key = key.of("rigid motion", 1).with("translations", self.translations());
        let key = key.with("rotations", self.rotations()).with("fixed point", &self.fixed_point);
        let others = &self.others.list[..self.others.count];
        others.iter().fold(key.with("others", &others.len()), |key, twist| twist.key(key))
    }
}
