//! Dimensions of quantities, and their units.

/// Dimension of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Dimension {
    /// Plain number.
    Number,
    /// Angle, rad.
    Angle,
    /// Length, also of displacements.
    Length,
    /// Length per time.
    Velocity,
    /// Length per time, squared.
    Acceleration,
    /// Angle per time.
    AngularVelocity,
    /// Angle per time, squared.
    AngularAcceleration,
    /// Linear momentum.
    Momentum,
    /// Moment of momentum.
    AngularMomentum,
    /// Force.
    Force,
    /// Moment of a force, torque.
    Moment,
    /// Energy, work.
    Energy,
    /// Energy per time.
    Power,
    /// Force per area.
    Stress,
    /// Any other, by its unit.
    Other(&'static str),
}

impl Dimension {
    /// The unit, such as "mass length/time": the three words stand for the labels of the run's units.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Number => "1",
            Self::Angle => "rad",
            Self::Length => "length",
            Self::Velocity => "length/time",
            Self::Acceleration => "length/time^2",
            Self::AngularVelocity => "rad/time",
            Self::AngularAcceleration => "rad/time^2",
            Self::Momentum => "mass length/time",
            Self::AngularMomentum => "mass length^2/time",
            Self::Force => "mass length/time^2",
            Self::Moment | Self::Energy => "mass length^2/time^2",
            Self::Power => "mass length^2/time^3",
            Self::Stress => "mass/(length time^2)",
            Self::Other(unit) => unit,
        }
    }
}
