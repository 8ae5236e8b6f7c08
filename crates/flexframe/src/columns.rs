//! The columns of a results file of `flexframe run`.
//!
//! To add a quantity, compute it in [`Observation`](frames_rk4::Observation) or in [`Row`] and give it a line here. Writing, reading, the check that numbers are
//! finite, and the attributes in the file follow from the line; a test says what to put into `docs/results.md`.

use results::Column;
use results::Values::{Modal, Number, Point, Quaternion, Stress, Vector};

use crate::row::Row;

const ENERGY: &str = "mass length^2/time^2";
const MOMENTUM: &str = "mass length/time";
const STRESS: &str = "mass/(length time^2)";
const ANGULAR_MOMENTUM: &str = "mass length^2/time";

/// Path, unit, frame, description, and how an observation gives the values.
pub static COLUMNS: [Column<Row>; 24] = [
    Column::new("time", "time", "none", "time of each row", Number(|now| now.time)),
    Column::new(
        "attitude",
        "1",
        "body to global",
        "unit quaternion (w, x, y, z) that takes body components to global ones",
        Quaternion(|now| now.attitude.wxyz()),
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
        "points/<name>/displacement",
        "length",
        "global",
        "displacement of the point from its place at t = 0 in the undeformed body",
        Point(|now, i| Some(now.points.get(i)?.displacement.into())),
    ),
    Column::new(
        "points/<name>/velocity",
        "length/time",
        "global",
        "velocity of the point",
        Point(|now, i| Some(now.points.get(i)?.velocity.into())),
    ),
    Column::new(
        "points/<name>/acceleration",
        "length/time^2",
        "global",
        "acceleration of the point",
        Point(|now, i| Some(now.points.get(i)?.acceleration.into())),
    ),
    Column::new(
        "points/<name>/rigid_acceleration",
        "length/time^2",
        "global",
        "part of the point's acceleration that belongs to the rigid motion",
        Point(|now, i| Some(now.points.get(i)?.rigid_acceleration.into())),
    ),
    Column::new(
        "points/<name>/stress",
        STRESS,
        "body",
        "stress at the point: components xx, yy, zz, xy, yz, zx",
        Stress(6, |now, i| Some(&now.stress.get(i)?.components)),
    ),
    Column::new(
        "points/<name>/von_mises_stress",
        STRESS,
        "none",
        "von Mises stress at the point",
        Stress(1, |now, i| Some(&now.stress.get(i)?.von_mises)),
    ),
    Column::new(
        "points/<name>/principal_stress",
        STRESS,
        "none",
        "principal stresses at the point, the largest first",
        Stress(3, |now, i| Some(&now.stress.get(i)?.principal)),
    ),
];
