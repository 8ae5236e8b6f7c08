//! The columns of a results file of `flexframe run`.
//!
//! To add a quantity, compute it in [`Observation`](dynamics::Observation), [`BodyRow`] or [`Row`] and give it a line here. Writing,
//! reading, the check that numbers are finite, and the attributes in the file follow from the line; a test says what to put into
//! `docs/reference/results.md`.

use dynamics::JointObservation;
use results::Dimension::{
    Acceleration, Angle, AngularAcceleration, AngularMomentum, AngularVelocity, Energy, Force, Length, Moment,
    Momentum, Other, Power, Stress, Velocity,
};
use results::Quantities::{Named, Vectors};
use results::Quantity::{Number, Quaternion, Vector};
use results::Role::{Direct, Internal};
use results::{Column, Dimension, Quantities, Quantity, Scope};

use crate::rows::row::{BodyRow, Row};

/// Parts of bodies and joints that have more columns: see [`results::BodyMetadata::parts`] and
/// [`results::JointMetadata::parts`].
pub mod part {
    /// Something holds the body.
    pub const CONSTRAINT: &str = "constraint";
    /// It may turn about one axis.
    pub const HINGE: &str = "hinge";
    /// It may move along one direction.
    pub const SLIDER: &str = "slider";
    /// Something drives it.
    pub const DRIVE: &str = "drive";
    /// A load stands for the acceleration of its support.
    pub const MOVING_SUPPORT: &str = "moving support";
    /// Several supports hold it.
    pub const SUPPORTS: &str = "supports";
    /// The stress at the points is asked for.
    pub const STRESS: &str = "stress";
    /// The hinge is driven.
    pub const DRIVEN_HINGE: &str = "driven hinge";
    /// The slider is driven.
    pub const DRIVEN_SLIDER: &str = "driven slider";
    /// The joint may turn about its axis.
    pub const TURNS: &str = "turns";
    /// The joint may slide along its axis.
    pub const SLIDES: &str = "slides";
    /// A spring or a motor acts about the axis of the joint.
    pub const TURN_FORCE: &str = "turn force";
    /// A spring or a motor acts along the axis of the joint.
    pub const SLIDE_FORCE: &str = "slide force";
    /// A spring acts in the joint, with a damper, stops and friction.
    pub const SPRING: &str = "spring";
    /// It is a spring along the line between two markers.
    pub const LINE: &str = "line";
}

/// All columns; those of the system come last.
pub static COLUMNS: [Column<Row>; 65] = [
    // Each body.
    body(["", "attitude"], (Dimension::Number, "body to global"), "unit quaternion (w, x, y, z) that takes body components to global ones", Quaternion(|now| now.attitude.wxyz())),
    body(["", "origin"], (Length, "global"), "position of the origin of the body frame", Vector(|now| now.origin_global.into())),
    body(["", "position"], (Length, "global"), "position of the centre of mass", Vector(|now| now.position_global.into())),
    body(["", "velocity"], (Velocity, "global"), "velocity of the centre of mass", Vector(|now| now.velocity_global.into())),
    body(["", "angular_velocity"], (AngularVelocity, "body"), "angular velocity of the body frame", Vector(|now| now.omega_body.into())),
    body(["", "angular_acceleration"], (AngularAcceleration, "body"), "angular acceleration of the body frame", Vector(|now| now.alpha_body.into())).in_role(Direct),
    // Modes are mass-normalised, hence the root of the mass.
    modes("displacement", Other("length mass^(1/2)"), "coordinates of the mass-normalised flexible modes and static shapes", |now| &now.modal_displacement).in_role(Internal),
    modes("velocity", Other("length mass^(1/2)/time"), "rates of the modal coordinates", |now| &now.modal_velocity).in_role(Internal),
    body(["energy", "kinetic"], (Energy, "none"), "kinetic energy", Number(|now| now.kinetic_energy)).in_role(Internal),
    body(["energy", "strain"], (Energy, "none"), "strain energy", Number(|now| now.strain_energy)).in_role(Internal),
    body(["energy", "work"], (Energy, "none"), "work of the loads since t = 0", Number(|now| now.work.work)).in_role(Internal),
    body(["energy", "dissipation"], (Energy, "none"), "energy that damping has taken since t = 0", Number(|now| now.work.dissipation)).in_role(Internal),
    body(["energy", "balance"], (Energy, "none"), "kinetic + strain energy - work + dissipation: constant in exact motion", Number(|now| now.energy_balance())).in_role(Internal),
    body(["momentum", "linear"], (Momentum, "global"), "linear momentum", Vector(|now| now.linear_momentum_global.into())).in_role(Internal),
    body(["momentum", "angular"], (AngularMomentum, "global"), "angular momentum about the centre of mass", Vector(|now| now.angular_momentum_global.into())).in_role(Internal),
    body(["momentum", "linear_balance"], (Momentum, "global"), "linear momentum less the impulse of the loads: constant in exact motion", Vector(|now| now.linear_balance_global().into())).in_role(Internal),
    body(["momentum", "angular_balance"], (AngularMomentum, "global"), "angular momentum less the angular impulse of the loads, both about the centre of mass: constant in exact motion", Vector(|now| now.angular_balance_global().into())).in_role(Internal),
    body(["reaction", "force"], (Force, "global"), "force of the constraints on the body", Vector(|now| now.attitude.to_global(&now.reaction.force_body).into())).only_with(part::CONSTRAINT).in_role(Direct),
    body(["reaction", "moment"], (Moment, "global"), "moment of the constraints on the body about its origin", Vector(|now| now.attitude.to_global(&now.reaction.moment_body).into())).only_with(part::CONSTRAINT).in_role(Direct),
    body(["reaction", "force_body"], (Force, "body"), "force of the constraints on the body", Vector(|now| now.reaction.force_body.into())).only_with(part::CONSTRAINT).in_role(Direct),
    body(["reaction", "moment_body"], (Moment, "body"), "moment of the constraints on the body about its origin", Vector(|now| now.reaction.moment_body.into())).only_with(part::CONSTRAINT).in_role(Direct),
    supports("force", (Force, "global"), "force of the support on the body", Vectors(|now, i| Some(now.supports.get(i)?[0]))).only_with(part::SUPPORTS).in_role(Direct),
    supports("moment", (Moment, "global"), "moment of the support on the body, about the mean of the nodes that it holds", Vectors(|now, i| Some(now.supports.get(i)?[1]))).only_with(part::SUPPORTS).in_role(Direct),
    body(["hinge", "angle"], (Angle, "none"), "angle that the body has turned by about the hinge since t = 0; it grows beyond a turn", Number(|now| now.reaction.hinge_angle)).only_with(part::HINGE),
    body(["hinge", "speed"], (AngularVelocity, "none"), "rate of hinge/angle", Number(|now| now.reaction.hinge_rate)).only_with(part::HINGE),
    body(["slider", "position"], (Length, "none"), "distance that the body has moved by along the slider since t = 0", Number(|now| now.reaction.slider_position)).only_with(part::SLIDER),
    body(["slider", "speed"], (Velocity, "none"), "rate of slider/position", Number(|now| now.reaction.slider_velocity)).only_with(part::SLIDER),
    body(["drive", "torque"], (Moment, "none"), "torque of the drive on the body, about the hinge", Number(|now| now.reaction.drive)).only_with(part::DRIVEN_HINGE).in_role(Direct),
    body(["drive", "force"], (Force, "none"), "force of the drive on the body, along the slider", Number(|now| now.reaction.drive)).only_with(part::DRIVEN_SLIDER).in_role(Direct),
    body(["drive", "power"], (Power, "none"), "power of the drive", Number(|now| now.reaction.drive_power)).only_with(part::DRIVE).in_role(Direct),
    points("displacement", (Length, "global"), "displacement of the point from its place at t = 0 in the undeformed body", Vectors(|now, i| Some(now.points.get(i)?.displacement.into()))),
    points("velocity", (Velocity, "global"), "velocity of the point", Vectors(|now, i| Some(now.points.get(i)?.velocity.into()))),
    points("acceleration", (Acceleration, "global"), "acceleration of the point, with that of the support", Vectors(|now, i| Some(now.absolute(now.points.get(i)?.acceleration)))).in_role(Direct),
    points("acceleration_relative", (Acceleration, "global"), "acceleration of the point relative to the support, which a base acceleration moves", Vectors(|now, i| Some(now.points.get(i)?.acceleration.into()))).only_with(part::MOVING_SUPPORT).in_role(Direct),
    points("rigid_acceleration", (Acceleration, "global"), "part of the point's acceleration that belongs to the rigid motion, with that of the support", Vectors(|now, i| Some(now.absolute(now.points.get(i)?.rigid_acceleration)))).in_role(Direct),
    points("elastic_displacement", (Length, "global"), "displacement of the point by deformation alone, seen from the body frame", Vectors(|now, i| Some(now.points.get(i)?.elastic_displacement_global.into()))),
    points("elastic_displacement_body", (Length, "body"), "the same in body axes", Vectors(|now, i| Some(now.points.get(i)?.elastic_displacement_body.into()))),
    points("stress", (Stress, "body"), "stress at the point: components xx, yy, zz, xy, yz, zx", Named(&STRESSES, |now, i| Some(&now.stress.get(i)?.components))).only_with(part::STRESS),
    points("von_mises_stress", (Stress, "none"), "von Mises stress at the point", Quantities::Number(|now, i| Some(now.stress.get(i)?.von_mises))).only_with(part::STRESS),
    points("principal_stress", (Stress, "none"), "principal stresses at the point, the largest first", Named(&["1", "2", "3"], |now, i| Some(&now.stress.get(i)?.principal))).only_with(part::STRESS),
    // Each joint, spring and bushing.
    joint("angle", (Angle, "none"), "angle about the z axis of the first marker, from its x axis to that of the second; it grows beyond a turn", Number(|now| now.coordinates.turn)).only_with(part::TURNS),
    joint("rate", (AngularVelocity, "none"), "rate of the angle", Number(|now| now.coordinates.turn_rate)).only_with(part::TURNS),
    joint("position", (Length, "none"), "distance of the second marker along the z axis of the first", Number(|now| now.coordinates.slide)).only_with(part::SLIDES),
    joint("velocity", (Velocity, "none"), "rate of the position", Number(|now| now.coordinates.slide_rate)).only_with(part::SLIDES),
    joint("torque", (Moment, "none"), "moment of the spring, the damper, the stops, friction, the motor and couplings on the second body, about the axis", Number(|now| now.turn_effort)).only_with(part::TURN_FORCE).in_role(Direct),
    joint("thrust", (Force, "none"), "force of the same along the axis", Number(|now| now.slide_effort)).only_with(part::SLIDE_FORCE).in_role(Direct),
    joint("force", (Force, "global"), "force of the joint, spring or bushing on its second body, at the second marker; on the first it is the opposite", Vector(|now| now.reaction_global.force_global.into())).in_role(Direct),
    joint("moment", (Moment, "global"), "moment of the joint or bushing on its second body, about the second marker", Vector(|now| now.reaction_global.moment_global.into())).only_without(part::LINE).in_role(Direct),
    joint("force_marker", (Force, "first marker"), "the same force, in the axes of the first marker", Vector(|now| now.force_marker.into())).only_without(part::LINE).in_role(Direct),
    joint("moment_marker", (Moment, "first marker"), "the same moment, in the axes of the first marker", Vector(|now| now.moment_marker.into())).only_without(part::LINE).in_role(Direct),
    joint("drive_work", (Energy, "none"), "work of the drive and the motor since t = 0", Number(|now| now.work.drive)).only_with(part::DRIVE).in_role(Internal),
    joint("drive_power", (Power, "none"), "power of the drive and the motor", Number(|now| now.drive_power)).only_with(part::DRIVE).in_role(Direct),
    joint("spring_work", (Energy, "none"), "work of the spring or bushing, the stops and the preload since t = 0, without dampers", Number(|now| now.work.spring)).only_with(part::SPRING).in_role(Internal),
    joint("loss", (Energy, "none"), "energy that friction and dampers have taken since t = 0", Number(|now| now.work.loss)).only_with(part::SPRING).in_role(Internal),
    joint("length", (Length, "none"), "distance between the markers of a spring", Number(|now| now.line.length)).only_with(part::LINE),
    joint("length_rate", (Velocity, "none"), "rate of the length", Number(|now| now.line.rate)).only_with(part::LINE),
    joint("pull", (Force, "none"), "force by which the spring and its damper pull the markers together; negative where they push", Number(|now| now.line.pull)).only_with(part::LINE).in_role(Direct),
    // All bodies together.
    system(["energy", "kinetic"], (Energy, "none"), "kinetic energy of all bodies", Number(Row::kinetic_energy)),
    system(["energy", "strain"], (Energy, "none"), "strain energy of all bodies", Number(Row::strain_energy)),
    system(["energy", "total"], (Energy, "none"), "kinetic + strain energy of all bodies", Number(Row::energy)),
    system(["energy", "work"], (Energy, "none"), "work of the loads on all bodies since t = 0", Number(Row::work)),
    system(["energy", "dissipation"], (Energy, "none"), "energy that damping has taken since t = 0", Number(Row::dissipation)),
    system(["energy", "balance"], (Energy, "none"), "total energy - work + dissipation: constant in exact motion", Number(Row::energy_balance)),
    system(["momentum", "linear"], (Momentum, "global"), "linear momentum of all bodies", Vector(|now| now.linear_momentum_global().into())),
    system(["momentum", "angular"], (AngularMomentum, "global"), "angular momentum of all bodies about the global origin", Vector(|now| now.angular_momentum_global().into())),
];

/// The column of a path in a results file, such as "energy/work", "bodies/ring/points/P1/velocity" or "system/energy/total".
pub fn column_of(path: &str) -> Option<&'static Column<Row>> {
    let parts: Vec<&str> = path.split('/').collect();
    let (scopes, rest): (&[Scope], &[&str]) = match &parts[..] {
        ["system", rest @ ..] => (&[Scope::System], rest),
        ["joints", _, rest @ ..] => (&[Scope::Joint], rest),
        ["bodies", _, rest @ ..] => (&[Scope::Body, Scope::Point, Scope::Support], rest),
        rest => (&[Scope::Body, Scope::Point, Scope::Support], rest),
    };
    let is_it = |column: &&Column<Row>| match (rest, column.scope()) {
        ([group, _, name], Scope::Point | Scope::Support) | ([group, name], Scope::System | Scope::Body) => {
            [column.group, column.name] == [*group, *name]
        }
        ([name], Scope::Body | Scope::Joint) => ["", *name] == [column.group, column.name],
        _ => false,
    };
    COLUMNS.iter().filter(|column| scopes.contains(&column.scope())).find(is_it)
}

/// Dimension of a quantity, and the frame of its components.
type Kind = (Dimension, &'static str);

/// Components of stress.
const STRESSES: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

const fn system(path: [&'static str; 2], kind: Kind, description: &'static str, values: Quantity<Row>) -> Column<Row> {
    Column::of_system(path, kind, description, values).in_role(Internal)
}

const fn body(
    path: [&'static str; 2],
    kind: Kind,
    description: &'static str,
    values: Quantity<BodyRow>,
) -> Column<Row> {
    Column::of_body(path, kind, description, values)
}

const fn modes(
    name: &'static str,
    dimension: Dimension,
    description: &'static str,
    values: fn(&BodyRow) -> &[f64],
) -> Column<Row> {
    Column::of_modes(name, dimension, description, values)
}

const fn points(name: &'static str, kind: Kind, description: &'static str, values: Quantities<BodyRow>) -> Column<Row> {
    Column::of_points(name, kind, description, values)
}

const fn joint(
    name: &'static str,
    kind: Kind,
    description: &'static str,
    values: Quantity<JointObservation>,
) -> Column<Row> {
    Column::of_joint(["", name], kind, description, values)
}

const fn supports(
    name: &'static str,
    kind: Kind,
    description: &'static str,
    values: Quantities<BodyRow>,
) -> Column<Row> {
    Column::of_supports(name, kind, description, values)
}
