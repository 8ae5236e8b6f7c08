//! Forces along the free coordinates of joints: springs, dampers, stops, friction, motors.
//!
//! Eq. (J12) of `docs/method/systems.md`.

use std::sync::Arc;

use crate::system::joint::drive::JointDrive;
use crate::system::joint::law::JointLaw;
use crate::system::joint::work::JointWork;

/// A force along the slide of a joint, or a moment about its turn; positive on the second marker along the coordinate.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct JointForce {
    /// Force per length, or moment per angle (rad).
    pub stiffness: f64,
    /// Force per velocity, or moment per angular velocity.
    pub damping: f64,
    /// Coordinate at which the spring has no force beside the preload.
    pub free: f64,
    /// Force or moment at all times.
    pub preload: f64,
    /// A further force over the coordinate, which stands for the time of the history: a table, or a formula in t.
    pub characteristic: Option<JointDrive>,
    /// Stops.
    pub stops: Option<Stops>,
    /// Dry friction.
    pub friction: Option<Friction>,
    /// A force or moment over time.
    pub motor: Option<JointDrive>,
    /// Laws from outside.
    #[serde(skip)]
    pub laws: Vec<Arc<dyn JointLaw>>,
}

/// Ends of a coordinate: stiff springs on one side, which push and do not pull.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Stops {
    /// Lowest and highest coordinate; −∞ and ∞ without them.
    pub limits: [f64; 2],
    /// Moment per rad, or force per length, beyond them, > 0.
    pub stiffness: f64,
    /// Moment per angular velocity, or force per velocity, while they are touched, ≥ 0.
    pub damping: f64,
}

/// Dry friction: −force · tanh(rate of the coordinate / rate).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Moment or force, ≥ 0.
    pub force: f64,
    /// Rate of the coordinate below which it is smaller, > 0.
    #[serde(rename = "rate")]
    pub rate_scale: f64,
}

/// A force, or its power, by what becomes of its work.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Forces {
    /// Force of springs, stops and the preload: a function of the coordinate whose energy is known.
    pub spring: f64,
    /// Force of a characteristic, whose energy no formula tells.
    pub characteristic: f64,
    /// Force of dampers and friction.
    pub friction: f64,
    /// Part of a motor and of laws from outside.
    pub motor: f64,
}

impl Forces {
    /// All of them times a factor.
    pub fn times(&self, factor: f64) -> Self {
        Self {
            spring: self.spring * factor,
            characteristic: self.characteristic * factor,
            friction: self.friction * factor,
            motor: self.motor * factor,
        }
    }

    /// Powers of the forces whose energy no formula tells.
    pub fn of_laws(&self) -> JointWork {
        JointWork { drive: self.motor, spring: self.characteristic, loss: -self.friction }
    }

    /// Their sum.
    pub fn sum(&self) -> f64 {
        self.spring + self.characteristic + self.friction + self.motor
    }
}

/// How Newton's method takes dry friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FrictionSlope {
    /// By its slope: what is held converges at once, near the limit of the friction too.
    Tangent,
    /// By the friction over the rate: what slides fast comes to rest, which the slope has nothing to slow down by.
    Secant,
}

impl JointForce {
    /// The force at a coordinate and its rate, at a time by the branch of another.
    pub(crate) fn at(&self, [x, rate]: [f64; 2], times: [f64; 2]) -> Forces {
        let of = |amplitude: &Option<JointDrive>, times| amplitude.as_ref().map_or(0.0, |drive| drive.at(times)[0]);
        let mut forces = Forces {
            spring: self.preload - self.stiffness * (x - self.free),
            characteristic: of(&self.characteristic, [x, x]),
            friction: -self.damping * rate,
            motor: of(&self.motor, times) + self.laws.iter().map(|law| law.force(times, [x, rate])).sum::<f64>(),
        };
        if let Some(Friction { force, rate_scale }) = self.friction {
            forces.friction -= force * (rate / rate_scale).tanh();
        }
        if let Some(stops) = self.stops
            && let Some(depth) = stops.depth(x)
        {
            let spring = -stops.stiffness * depth;
            let damped = spring - stops.damping * rate;
            let pushing = if depth > 0.0 { damped.min(0.0) } else { damped.max(0.0) };
            forces.spring += spring;
            forces.friction += pushing - spring;
        }
        forces
    }
}

impl JointForce {
    /// Energy of its spring, its stops and the preload at a coordinate.
    pub(crate) fn energy(&self, x: f64) -> f64 {
        let beyond = self.stops.and_then(|stops| Some(0.5 * stops.stiffness * stops.depth(x)?.powi(2)));
        0.5 * self.stiffness * (x - self.free).powi(2) - self.preload * x + beyond.unwrap_or_default()
    }

    /// True if its friction holds at a rate: it does not slide.
    pub(crate) fn holds(&self, rate: f64) -> bool {
        self.friction.is_some_and(|Friction { rate_scale, .. }| rate.abs() <= HELD * rate_scale)
    }

    /// True if a coordinate is beyond a stop.
    pub(crate) fn is_at_stop(&self, x: f64) -> bool {
        self.stops.is_some_and(|stops| stops.depth(x).is_some())
    }

    /// True if it has work that only sums tell: of dampers, friction, motors, characteristics, stops or laws from outside.
    pub(crate) fn has_work(&self) -> bool {
        let Self { damping, characteristic, stops, friction, motor, laws, .. } = self;
        let is_damped = *damping != 0.0 || friction.is_some() || stops.is_some();
        is_damped || characteristic.is_some() || motor.is_some() || !laws.is_empty()
    }

    /// Functions that change their signs where the force has kinks: the gap to the nearest stop, and those of laws from outside.
    pub(crate) fn switches(&self, at: [f64; 2], times: [f64; 2]) -> impl Iterator<Item = f64> {
        let gap = |Stops { limits: [low, high], .. }: Stops| (at[0] - low).min(high - at[0]);
        self.stops.map(gap).into_iter().chain(self.laws.iter().filter_map(move |law| law.switch(times, at)))
    }

    /// How much the force falls by the coordinate and by its rate; nothing where it rises.
    pub(crate) fn stiffness_and_damping(&self, [x, rate]: [f64; 2], times: [f64; 2], by: FrictionSlope) -> [f64; 2] {
        let slope = self.characteristic.as_ref().map_or(0.0, |of| of.at([x, x])[1]);
        let (mut stiffness, mut damping) = (self.stiffness - slope, self.damping);
        if let Some(Friction { force, rate_scale }) = self.friction {
            let x = rate / rate_scale;
            damping += force / rate_scale
                * match by {
                    FrictionSlope::Tangent => x.cosh().powi(-2),
                    FrictionSlope::Secant if x.abs() < 1e-8 => 1.0,
                    FrictionSlope::Secant => x.tanh() / x,
                };
        }
        if let Some(stops) = self.stops
            && stops.depth(x).is_some()
        {
            stiffness += stops.stiffness;
            damping += stops.damping;
        }
        for law in &self.laws {
            let [of_coordinate, of_rate] = law.stiffness_and_damping(times, [x, rate]);
            (stiffness, damping) = (stiffness + of_coordinate, damping + of_rate);
        }
        [stiffness, damping].map(|slope| slope.max(0.0))
    }
}

impl JointForce {
    /// The slopes of the force over the coordinate and over its rate; of laws from outside by central differences.
    pub(crate) fn slopes(&self, [x, rate]: [f64; 2], times: [f64; 2]) -> [f64; 2] {
        let of_law = self.characteristic.as_ref().map_or(0.0, |of| of.at([x, x])[1]);
        let mut slopes = [of_law - self.stiffness, -self.damping];
        if let Some(Friction { force, rate_scale }) = self.friction {
            slopes[1] -= force / rate_scale / (rate / rate_scale).cosh().powi(2);
        }
        if let Some(stops) = self.stops
            && let Some(depth) = stops.depth(x)
            && depth * (stops.stiffness * depth + stops.damping * rate) > 0.0
        {
            slopes[0] -= stops.stiffness;
            slopes[1] -= stops.damping;
        }
        for law in &self.laws {
            for (slope, direction) in slopes.iter_mut().zip([[1.0, 0.0], [0.0, 1.0]]) {
                let small = DIFFERENCE * (direction[0] * x + direction[1] * rate).abs().max(1.0);
                let at = |by: f64| law.force(times, [x + direction[0] * by, rate + direction[1] * by]);
                *slope += (at(small) - at(-small)) / (2.0 * small);
            }
        }
        slopes
    }
}

/// Rate over the scale of friction up to which it holds: there it is at 99.5 % of its limit.
const HELD: f64 = 3.0;
/// Differences of coordinates and rates, relative to these or to 1.
const DIFFERENCE: f64 = 1e-6;

impl Stops {
    /// How far a coordinate is beyond an end: positive above the highest, negative below the lowest.
    fn depth(&self, x: f64) -> Option<f64> {
        let [low, high] = self.limits;
        if x > high {
            Some(x - high)
        } else if x < low {
            Some(x - low)
        } else {
            None
        }
    }
}
