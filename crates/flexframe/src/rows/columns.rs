//! The columns of a results file of `flexframe run`.
//!
//! To add a quantity, compute it in [`Observation`](dynamics::Observation) or in [`Row`] and give it a line here. Writing, reading, the check that numbers are
//! finite, and the attributes in the file follow from the line; a test says what to put into `docs/reference/results.md`.

use results::Column;
use results::Values::{Modal, Number, PointNumbers, Points, Quaternion, Supports, Vector};

use crate::rows::row::Row;

/// Parts of runs whose files have more columns: see [`results::Metadata::parts`].
pub mod part {
    /// Something holds the body.
    pub const CONSTRAINT: &str = "constraint";
    /// It may turn about one axis.
    pub const HINGE: &str = "hinge";
    /// It may move along one direction.
    pub const SLIDER: &str = "slider";
    /// Something drives it.
    pub const DRIVE: &str = "drive";
    /// Several supports hold it.
    pub const SUPPORTS: &str = "supports";
    /// The stress at the points is asked for.
    pub const STRESS: &str = "stress";
    /// The hinge is driven.
    pub const DRIVEN_HINGE: &str = "driven hinge";
    /// The slider is driven.
    pub const DRIVEN_SLIDER: &str = "driven slider";
}

const ENERGY: &str = "mass length^2/time^2";
const MOMENTUM: &str = "mass length/time";
const STRESS: &str = "mass/(length time^2)";
const ANGULAR_MOMENTUM: &str = "mass length^2/time";
const FORCE: &str = "mass length/time^2";
const MOMENT: &str = "mass length^2/time^2";
const POWER: &str = "mass length^2/time^3";

/// Path, unit, frame, description, and how an observation gives the values.
pub static COLUMNS: [Column<Row>; 40] = [
    Column::new("time", "time", "none", "time of each row", Number(|now| now.time)),
    Column::new(
        "attitude",
        "1",
        "body to global",
        "unit quaternion (w, x, y, z) that takes body components to global ones",
        Quaternion(|now| now.attitude.wxyz()),
    ),
    Column::new(
        "origin",
        "length",
        "global",
        "position of the origin of the body frame",
        Vector(|now| now.origin_global.into()),
    ),
    Column::new(
        "position",
        "length",
        "global",
        "position of the centre of mass",
        Vector(|now| now.position_global.into()),
    ),
    Column::new(
        "velocity",
        "length/time",
        "global",
        "velocity of the centre of mass",
        Vector(|now| now.velocity_global.into()),
    ),
    Column::new(
        "angular_velocity",
        "rad/time",
        "body",
        "angular velocity of the body frame",
        Vector(|now| now.omega_body.into()),
    ),
    Column::new(
        "angular_acceleration",
        "rad/time^2",
        "body",
        "angular acceleration of the body frame",
        Vector(|now| now.alpha_body.into()),
    ),
    // Modes are mass-normalised, hence the root of the mass.
    Column::new(
        "modal/displacement",
        "length mass^(1/2)",
        "none",
        "coordinates of the mass-normalised flexible modes and static shapes",
        Modal(|now| &now.modal_displacement),
    ),
    Column::new(
        "modal/velocity",
        "length mass^(1/2)/time",
        "none",
        "rates of the modal coordinates",
        Modal(|now| &now.modal_velocity),
    ),
    Column::new("energy/kinetic", ENERGY, "none", "kinetic energy", Number(|now| now.kinetic_energy)),
    Column::new("energy/strain", ENERGY, "none", "strain energy", Number(|now| now.strain_energy)),
    Column::new("energy/work", ENERGY, "none", "work of the loads since t = 0", Number(|now| now.work.work)),
    Column::new(
        "energy/dissipation",
        ENERGY,
        "none",
        "energy that damping has taken since t = 0",
        Number(|now| now.work.dissipation),
    ),
    Column::new(
        "energy/balance",
        ENERGY,
        "none",
        "kinetic + strain energy - work + dissipation: constant in exact motion",
        Number(|now| now.energy_balance()),
    ),
    Column::new(
        "momentum/linear",
        MOMENTUM,
        "global",
        "linear momentum",
        Vector(|now| now.linear_momentum_global.into()),
    ),
    Column::new(
        "momentum/angular",
        ANGULAR_MOMENTUM,
        "global",
        "angular momentum about the centre of mass",
        Vector(|now| now.angular_momentum_global.into()),
    ),
    Column::new(
        "momentum/linear_balance",
        MOMENTUM,
        "global",
        "linear momentum less the impulse of the loads: constant in exact motion",
        Vector(|now| now.linear_balance_global().into()),
    ),
    Column::new(
        "momentum/angular_balance",
        ANGULAR_MOMENTUM,
        "global",
        "angular momentum less the angular impulse of the loads, both about the centre of mass: constant in exact motion",
        Vector(|now| now.angular_balance_global().into()),
    ),
    Column::new(
        "reaction/force",
        FORCE,
        "global",
        "force of the constraints on the body",
        Vector(|now: &Row| now.attitude.to_global(&now.reaction.force_body).into()),
    )
    .only_with(part::CONSTRAINT),
    Column::new(
        "reaction/moment",
        MOMENT,
        "global",
        "moment of the constraints on the body about its origin",
        Vector(|now: &Row| now.attitude.to_global(&now.reaction.moment_body).into()),
    )
    .only_with(part::CONSTRAINT),
    Column::new(
        "reaction/force_body",
        FORCE,
        "body",
        "force of the constraints on the body",
        Vector(|now: &Row| now.reaction.force_body.into()),
    )
    .only_with(part::CONSTRAINT),
    Column::new(
        "reaction/moment_body",
        MOMENT,
        "body",
        "moment of the constraints on the body about its origin",
        Vector(|now: &Row| now.reaction.moment_body.into()),
    )
    .only_with(part::CONSTRAINT),
    Column::new(
        "supports/force",
        FORCE,
        "global",
        "force of the support on the body",
        Supports(|now: &Row, i| Some(now.supports.get(i)?[0])),
    )
    .only_with(part::SUPPORTS),
    Column::new(
        "supports/moment",
        MOMENT,
        "global",
        "moment of the support on the body, about the mean of the nodes that it holds",
        Supports(|now: &Row, i| Some(now.supports.get(i)?[1])),
    )
    .only_with(part::SUPPORTS),
    Column::new(
        "hinge/angle",
        "rad",
        "none",
        "angle that the body has turned by about the hinge since t = 0; it grows beyond a turn",
        Number(|now: &Row| now.reaction.hinge_angle),
    )
    .only_with(part::HINGE),
    Column::new("hinge/speed", "rad/time", "none", "rate of hinge/angle", Number(|now: &Row| now.reaction.hinge_rate))
        .only_with(part::HINGE),
    Column::new(
        "slider/position",
        "length",
        "none",
        "distance that the body has moved by along the slider since t = 0",
        Number(|now: &Row| now.reaction.slider_position),
    )
    .only_with(part::SLIDER),
    Column::new(
        "slider/speed",
        "length/time",
        "none",
        "rate of slider/position",
        Number(|now: &Row| now.reaction.slider_velocity),
    )
    .only_with(part::SLIDER),
    Column::new(
        "drive/torque",
        MOMENT,
        "none",
        "torque of the drive on the body, about the hinge",
        Number(|now: &Row| now.reaction.drive),
    )
    .only_with(part::DRIVEN_HINGE),
    Column::new(
        "drive/force",
        FORCE,
        "none",
        "force of the drive on the body, along the slider",
        Number(|now: &Row| now.reaction.drive),
    )
    .only_with(part::DRIVEN_SLIDER),
    Column::new("drive/power", POWER, "none", "power of the drive", Number(|now: &Row| now.reaction.drive_power))
        .only_with(part::DRIVE),
    Column::new(
        "points/displacement",
        "length",
        "global",
        "displacement of the point from its place at t = 0 in the undeformed body",
        Points(|now, i| Some(now.points.get(i)?.displacement.into())),
    ),
    Column::new(
        "points/velocity",
        "length/time",
        "global",
        "velocity of the point",
        Points(|now, i| Some(now.points.get(i)?.velocity.into())),
    ),
    Column::new(
        "points/acceleration",
        "length/time^2",
        "global",
        "acceleration of the point",
        Points(|now, i| Some(now.points.get(i)?.acceleration.into())),
    ),
    Column::new(
        "points/rigid_acceleration",
        "length/time^2",
        "global",
        "part of the point's acceleration that belongs to the rigid motion",
        Points(|now, i| Some(now.points.get(i)?.rigid_acceleration.into())),
    ),
    Column::new(
        "points/elastic_displacement",
        "length",
        "global",
        "displacement of the point by deformation alone, seen from the body frame",
        Points(|now, i| Some(now.points.get(i)?.elastic_displacement_global.into())),
    ),
    Column::new(
        "points/elastic_displacement_body",
        "length",
        "body",
        "the same in body axes",
        Points(|now, i| Some(now.points.get(i)?.elastic_displacement_body.into())),
    ),
    Column::new(
        "points/stress",
        STRESS,
        "body",
        "stress at the point: components xx, yy, zz, xy, yz, zx",
        PointNumbers(6, |now: &Row, i| Some(&now.stress.get(i)?.components)),
    )
    .only_with(part::STRESS),
    Column::new(
        "points/von_mises_stress",
        STRESS,
        "none",
        "von Mises stress at the point",
        PointNumbers(1, |now: &Row, i| Some(&now.stress.get(i)?.von_mises)),
    )
    .only_with(part::STRESS),
    Column::new(
        "points/principal_stress",
        STRESS,
        "none",
        "principal stresses at the point, the largest first",
        PointNumbers(3, |now: &Row, i| Some(&now.stress.get(i)?.principal)),
    )
    .only_with(part::STRESS),
];
