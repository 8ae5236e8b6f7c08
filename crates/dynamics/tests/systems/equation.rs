//! Equations of joints from outside.

use std::f64::consts::PI;
use std::sync::Arc;

use dynamics::{
    CommonSpin, ConservativeBody, Coupling, DescriptionError, EquationValue, History, Joint, JointEquationFn, Marker,
    MotionState, Physics, PointForce, PointShapes, RelativePlace, Rows, SetupError, Simulation, Start, StepControl,
    System, SystemMotion, SystemScheme, SystemSetup,
};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};
use rigid_kin::{Attitude, transformation_matrix};

use crate::described;
use crate::linkages::run;

const GRAVITY: f64 = 9.81;
const MASS: f64 = 2.0;
const INERTIA: [f64; 3] = [0.2, 0.3, 0.4];

fn body(gravity: f64) -> ConservativeBody {
    let inertia = Matrix3::from_diagonal(&INERTIA.into());
    let reduced = ReducedBody::rigid(MASS, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, 0.0, -MASS * gravity), History::Constant);
    ConservativeBody::new(&reduced, &[], vec![Arc::new(weight)], &Physics::default()).unwrap()
}

fn state(origin: [f64; 3], velocity: [f64; 3], omega: [f64; 3]) -> MotionState {
    MotionState {
        time: 0.0,
        attitude: Attitude::identity(),
        origin_global: origin.into(),
        velocity_global: velocity.into(),
        omega_body: omega.into(),
        modal_displacement: Vec::new(),
        modal_velocity: Vec::new(),
    }
}

fn on(body: usize, place: [f64; 3], axes: Matrix3<f64>) -> Marker {
    Marker::on_rigid(body, place.into(), axes)
}

fn ground() -> Marker {
    Marker::on_ground(Vector3::zeros(), Matrix3::identity())
}

/// The markers stay at one distance: a rod of no mass.
fn rod(name: &str, markers: [Marker; 2], length: f64) -> Joint {
    let equation = move |RelativePlace { position, .. }: &RelativePlace| EquationValue {
        residual: (position.norm_squared() - length * length) / (2.0 * length),
        by_position: position / length,
        by_turn: Vector3::zeros(),
    };
    Joint::new(name, markers, Vec::new()).with_equation(Arc::new(JointEquationFn::new("rod", equation)))
}

/// Axes that lie along nothing.
fn skew() -> Matrix3<f64> {
    transformation_matrix(&Vector3::new(0.4, -0.9, 0.3))
}

/// Closed form: a ball on a rod circles at a slope θ with ω² = g/(l cos θ).
#[test]
fn a_ball_on_a_rod_circles_as_a_conical_pendulum() {
    let (length, slope) = (1.3, 0.5_f64);
    let omega = (GRAVITY / (length * slope.cos())).sqrt();
    let radius = length * slope.sin();
    let height = -length * slope.cos();
    let rod = rod("rod", [ground(), on(0, [0.0; 3], skew())], length);
    let system = System::new(vec![body(GRAVITY)], vec![rod]).unwrap();
    for scheme in [SystemScheme::Radau, SystemScheme::Gauss, SystemScheme::Rkmk4] {
        let start = state([radius, 0.0, height], [0.0, radius * omega, 0.0], [1.0, 2.0, 3.0]);
        let mut motion = SystemMotion::new(system.clone(), &[start]).unwrap().with_scheme(scheme);
        motion.advance(2.0, 1e-9, &mut 1e-3).unwrap();
        let found = motion.state(0).unwrap().origin_global;
        let angle = 2.0 * omega;
        let expected = Vector3::new(radius * angle.cos(), radius * angle.sin(), height);
        println!("{scheme:?}: {:e}", (found - expected).norm());
        assert!((found - expected).norm() < 1e-7, "{scheme:?}: {found} {expected}");
    }
}

/// A point mass with its weight.
fn point(mass: f64, gravity: f64) -> ConservativeBody {
    let reduced = ReducedBody::point(mass, Vector3::zeros()).unwrap();
    let center = PointShapes::new(&reduced, &BodyPoint::rigid(Vector3::zeros()));
    let weight = PointForce::dead(center, Vector3::new(0.0, 0.0, -mass * gravity), History::Constant);
    ConservativeBody::new(&reduced, &[], vec![Arc::new(weight)], &Physics::default()).unwrap()
}

/// A run of two units of time.
fn begin(system: System, states: Vec<MotionState>) -> Result<Simulation, SetupError> {
    run(system, states, 1e-8, 2.0)
}

/// Closed form: a point mass on a rod circles as a ball does, with ω² = g/(l cos θ), and has two ways to move.
#[test]
fn a_point_mass_on_a_rod_circles_as_a_conical_pendulum() {
    let (length, slope) = (1.3, 0.5_f64);
    let omega = (GRAVITY / (length * slope.cos())).sqrt();
    let (radius, height) = (length * slope.sin(), -length * slope.cos());
    for scheme in [SystemScheme::Radau, SystemScheme::Gauss, SystemScheme::Rkmk4] {
        let rod = rod("rod", [ground(), on(0, [0.0; 3], skew())], length);
        let system = System::new(vec![point(MASS, GRAVITY)], vec![rod]).unwrap();
        let start = state([radius, 0.0, height], [0.0, radius * omega, 0.0], [0.0; 3]);
        let simulation = begin(system.clone(), vec![start.clone()]).unwrap();
        assert_eq!(simulation.system().unwrap().rigid_dofs(), 2);
        let mut motion = SystemMotion::new(system, &[start]).unwrap().with_scheme(scheme);
        motion.advance(2.0, 1e-9, &mut 1e-3).unwrap();
        let found = motion.state(0).unwrap();
        let angle = 2.0 * omega;
        let expected = Vector3::new(radius * angle.cos(), radius * angle.sin(), height);
        println!("{scheme:?}: {:e}", (found.origin_global - expected).norm());
        assert!((found.origin_global - expected).norm() < 1e-7, "{scheme:?}: {found:?} {expected}");
        assert!(found.omega_body == Vector3::zeros());
        let momentum = expected.cross(&(Vector3::z() * omega).cross(&expected)) * MASS;
        assert!((motion.momenta()[1] - momentum).norm() < 1e-6, "{scheme:?}: {:?}", motion.momenta());
    }
}

/// Leads a free system for five units of time: momenta stay to rounding, energy to the tolerance.
fn keep_momenta_and_energy(system: System, states: &[MotionState]) -> SystemMotion {
    let mut motion = SystemMotion::new(system, states).unwrap();
    motion.assemble().unwrap();
    let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
    motion.advance(5.0, 1e-8, &mut 1e-3).unwrap();
    let drift = motion.momenta().iter().zip(momenta).map(|(now, start)| (now - start).norm()).fold(0.0, f64::max);
    let of_energy = (motion.energy().unwrap() / energy - 1.0).abs();
    println!("momenta {drift:e}, energy {of_energy:e}");
    assert!(drift < 1e-12 && of_energy < 1e-7, "{drift:e} {of_energy:e}");
    motion
}

/// Conserved: a point mass on a rod at a tumbling body: momenta to rounding, energy to the tolerance.
#[test]
fn a_point_mass_that_whirls_with_a_body_keeps_momenta_and_energy() {
    let markers = [on(0, [0.3, -0.2, 0.1], skew()), on(1, [0.0; 3], Matrix3::identity())];
    let system = System::new(vec![body(0.0), point(0.7, 0.0)], vec![rod("rod", markers, 0.8)]).unwrap();
    let states =
        [state([0.0; 3], [0.1, 0.2, -0.3], [1.0, -2.0, 0.5]), state([1.1, -0.2, 0.1], [0.0, 0.5, 0.0], [0.0; 3])];
    keep_momenta_and_energy(system, &states);
}

/// Closed form: an arm on a hinge with a point mass at its end on a ball swings with ω² = g (m₁ l/2 + m₂ l)/(J + m₁ l²/4 + m₂ l²), and
/// that is all that vibrates.
#[test]
fn a_point_mass_on_a_ball_swings_with_its_arm() {
    let hinge = Joint::revolute("hinge", [ground(), on(0, [0.0, 0.0, 0.5], Matrix3::identity())]);
    let ball = Joint::spherical("ball", [on(0, [0.0, 0.0, -0.5], Matrix3::identity()), on(1, [0.0; 3], skew())]);
    // The hinge turns about y.
    let about_y = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    let hinge =
        Joint { markers: [Marker::on_ground(Vector3::zeros(), about_y), on(0, [0.0, 0.0, 0.5], about_y)], ..hinge };
    let system = System::new(vec![body(GRAVITY), point(0.7, GRAVITY)], vec![hinge, ball]).unwrap();
    let states = vec![state([0.0, 0.0, -0.5], [0.0; 3], [0.0; 3]), state([0.0, 0.0, -1.0], [0.0; 3], [0.0; 3])];
    let motion = SystemMotion::new(system, &states).unwrap();
    let vibrations = motion.steady_state(&CommonSpin::REST).unwrap().linear.vibrations().unwrap();
    let expected = (GRAVITY * (0.5 * MASS + 0.7) / (INERTIA[1] + 0.25 * MASS + 0.7)).sqrt();
    let found: Vec<f64> = vibrations.modes.iter().map(|mode| mode.eigenvalue.im).collect();
    assert!(found.len() == 1 && (found[0] - expected).abs() < 1e-9, "{found:?} {expected}");
}

/// A point mass that something would turn is refused with its name.
#[test]
fn what_would_turn_a_point_mass_is_told() {
    let at = || on(0, [0.0; 3], Matrix3::identity());
    let off = || on(0, [0.1, 0.0, 0.0], Matrix3::identity());
    for joint in [
        Joint::revolute("it", [ground(), at()]),
        Joint::prismatic("it", [ground(), at()]),
        Joint::spherical("it", [ground(), off()]),
        Joint::locked("it", [at(), ground()], [true, false, false], [false; 3]),
        rod("it", [ground(), off()], 1.0),
    ] {
        let system = System::new(vec![point(1.0, GRAVITY)], vec![joint]).unwrap().with_names(vec!["bob".into()]);
        let refused = begin(system, vec![state([0.0, 0.6, -0.8], [0.0; 3], [0.0; 3])]).err();
        let Some(SetupError::PointTurned { body, by }) = &refused else { panic!("{refused:?}") };
        assert_eq!((body.number, body.to_string(), &**by), (0, "the body \"bob\"".to_owned(), "the joint \"it\""));
    }
    let bead = Joint::locked("bead", [ground(), at()], [true, true, false], [false; 3]);
    let system = System::new(vec![point(1.0, GRAVITY)], vec![bead]).unwrap();
    begin(system, vec![state([0.0; 3], [0.0; 3], [0.0; 3])]).unwrap();
}

/// Conserved: two bodies that tumble on a rod between places off their centres: momenta to rounding, energy to the tolerance.
#[test]
fn a_free_pair_on_a_rod_keeps_momenta_and_energy() {
    let markers = [on(0, [0.3, -0.2, 0.1], skew()), on(1, [-0.1, 0.4, 0.2], Matrix3::identity())];
    let system = System::new(vec![body(0.0); 2], vec![rod("rod", markers, 0.8)]).unwrap();
    let states =
        [state([0.0; 3], [0.1, 0.2, -0.3], [1.0, -2.0, 0.5]), state([1.2, 0.3, 0.0], [0.0; 3], [0.3, 0.6, 2.0])];
    let motion = keep_momenta_and_energy(system, &states);
    let [first, second] = [0, 1].map(|k| motion.state(k).unwrap());
    let place = |state: &MotionState, at: [f64; 3]| state.origin_global + state.attitude.to_global(&at.into());
    let distance = (place(&first, [0.3, -0.2, 0.1]) - place(&second, [-0.1, 0.4, 0.2])).norm();
    assert!((distance - 0.8).abs() < 1e-11, "{distance}");
}

/// Independent reference: another implementation: a screw as an equation of a cylindrical joint between two tumbling bodies, and as a coupling.
#[test]
fn an_equation_of_turns_does_what_a_screw_does() {
    let lead = 0.5;
    let markers = || [on(0, [0.2, 0.0, 0.1], skew()), on(1, [0.1, 0.1, 0.0], Matrix3::identity())];
    let equation = JointEquationFn::new("screw", move |RelativePlace { position, axes }: &RelativePlace| {
        let angle = axes[(1, 0)].atan2(axes[(0, 0)]);
        EquationValue {
            residual: position.z - lead / (2.0 * PI) * angle,
            by_position: Vector3::z(),
            by_turn: Vector3::z() * (-lead / (2.0 * PI)),
        }
    });
    let joint = Joint::cylindrical("screw", markers());
    let bodies = || vec![body(0.0); 2];
    let own = System::new(bodies(), vec![joint.clone().with_equation(Arc::new(equation))]).unwrap();
    let coupling = Coupling { sum: Some(0.0), ..Coupling::screw("thread", 0, lead) };
    let known = System::new(bodies(), vec![joint]).unwrap().with_couplings(vec![coupling]).unwrap();
    // At an angle of zero, so that both find the same place.
    let second = MotionState {
        attitude: Attitude::from_global_to_body(&skew().transpose()).unwrap(),
        ..state([0.2, -0.1, 0.1], [0.0, 0.0, 0.3], [0.5, 0.2, 2.0])
    };
    let states = [state([0.0; 3], [0.1, 0.0, 0.0], [0.4, -0.3, 0.2]), second];
    let [own, known] = [own, known].map(|system| {
        let mut motion = SystemMotion::new(system, &states).unwrap();
        motion.assemble().unwrap();
        motion.advance(1.0, 1e-10, &mut 1e-3).unwrap();
        (motion.joint_coordinates(0), motion.state(1).unwrap().origin_global)
    });
    println!("{own:?} {known:?}");
    assert!(known.0.turn.abs() > 0.5, "it turns: {known:?}");
    assert!((own.0.turn - known.0.turn).abs() < 1e-8 && (own.1 - known.1).norm() < 1e-8, "{own:?} {known:?}");
}

/// Closed form: a body that hangs from a rod of length l at a above its centre is a double pendulum, whose first part has no mass:
/// [[ml², mla], [mla, ma² + J]] against mg diag(l, a).
#[test]
fn a_body_on_a_rod_has_the_frequencies_of_a_double_pendulum() {
    let (l, a) = (1.3, 0.4);
    let rod = rod("rod", [ground(), on(0, [0.0, 0.0, a], skew())], l);
    let system = System::new(vec![body(GRAVITY)], vec![rod]).unwrap();
    let motion = SystemMotion::new(system, &[state([0.0, 0.0, -l - a], [0.0; 3], [0.0; 3])]).unwrap();
    let found = motion.steady_state(&CommonSpin::REST).unwrap().linear.vibrations().unwrap();
    // The turn about the vertical.
    assert_eq!(found.rigid.ncols(), 1);
    let mut expected: Vec<f64> = INERTIA[..2]
        .iter()
        .flat_map(|inertia| {
            // det(K − λM) = 0
            let (cross, turned) = (MASS * l * a, MASS * a * a + inertia);
            let (first, k) = (MASS * l * l, MASS * GRAVITY);
            let (square, linear, constant) =
                (first * turned - cross * cross, k * (l * turned + a * first), k * k * l * a);
            let root = (linear * linear - 4.0 * square * constant).sqrt();
            [-1.0, 1.0].map(|sign| ((linear + sign * root) / (2.0 * square)).sqrt())
        })
        .collect();
    expected.sort_by(f64::total_cmp);
    let found: Vec<f64> = found.modes.iter().map(|mode| mode.circular_frequency()).collect();
    println!("{found:?} {expected:?}");
    assert_eq!(found.len(), 4);
    assert!(found.iter().zip(&expected).all(|(found, expected)| (found / expected - 1.0).abs() < 1e-9));
}

/// Closed form: a bead at the lowest point of a wire of radius r swings with √(g/r), also where its markers meet but for rounding.
#[test]
fn a_bead_at_the_lowest_point_of_its_wire_has_its_frequency() {
    let radius = 0.7;
    let wire = move |RelativePlace { position, .. }: &RelativePlace| EquationValue {
        residual: position.z - position.x.powi(2) / (2.0 * radius),
        by_position: Vector3::new(-position.x / radius, 0.0, 1.0),
        by_turn: Vector3::zeros(),
    };
    let place = [0.3, -0.1, 0.7];
    // About (0.3, −0.1, 0.7), but for rounding.
    let marker = [0.1 + 0.2 - 0.3, 0.0, 1e-17];
    let markers = [Marker::on_ground(place.into(), Matrix3::identity()), on(0, marker, skew())];
    let joint = Joint::locked("wire", markers, [false, true, false], [true; 3])
        .with_equation(Arc::new(JointEquationFn::new("wire", wire)));
    let turned =
        MotionState { attitude: Attitude::from_global_to_body(&skew()).unwrap(), ..state(place, [0.0; 3], [0.0; 3]) };
    let motion = SystemMotion::new(System::new(vec![body(GRAVITY)], vec![joint]).unwrap(), &[turned]).unwrap();
    let found = motion.steady_state(&CommonSpin::REST).unwrap().linear.vibrations().unwrap().modes;
    assert_eq!(found.len(), 1);
    assert!((found[0].circular_frequency() / (GRAVITY / radius).sqrt() - 1.0).abs() < 1e-9, "{found:?}");
}

/// Independent reference: another implementation: a hinge by five equations between two moving bodies, and the hinge that is there: the
/// frequencies of a double pendulum.
#[test]
fn a_hinge_of_equations_between_moving_bodies_has_the_frequencies_of_a_hinge() {
    let about_y = || Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    let top = |body| [Marker::on_ground(Vector3::zeros(), about_y()), on(body, [0.0, 0.0, 0.4], about_y())];
    let knee = || [on(0, [0.1, 0.0, -0.4], about_y()), on(1, [0.0, 0.0, 0.3], about_y())];
    let mut own = Joint::new("knee", knee(), Vec::new());
    for axis in 0..3 {
        own = own.with_equation(Arc::new(JointEquationFn::new("point", move |place: &RelativePlace| EquationValue {
            residual: place.position[axis],
            by_position: Vector3::ith(axis, 1.0),
            by_turn: Vector3::zeros(),
        })));
    }
    for axis in 0..2 {
        own = own.with_equation(Arc::new(JointEquationFn::new("axis", move |place: &RelativePlace| {
            let column: Vector3<f64> = place.axes.column(axis).into();
            EquationValue { residual: column.z, by_position: Vector3::zeros(), by_turn: column.cross(&Vector3::z()) }
        })));
    }
    let frequencies = [own, Joint::revolute("knee", knee())].map(|knee| {
        let joints = vec![Joint::revolute("top", top(0)), knee];
        let system = System::new(vec![body(GRAVITY); 2], joints).unwrap();
        // The centers hang below each other, the upper body with its knee beside its own line.
        let states = [state([0.0, 0.0, -0.4], [0.0; 3], [0.0; 3]), state([0.1, 0.0, -1.1], [0.0; 3], [0.0; 3])];
        let mut motion = SystemMotion::new(system, &states).unwrap();
        motion.assemble().unwrap();
        let found = motion.steady_state(&CommonSpin::REST).unwrap().linear.vibrations().unwrap();
        found.modes.iter().map(|mode| mode.circular_frequency()).collect::<Vec<f64>>()
    });
    println!("{frequencies:?}");
    let [own, known] = &frequencies;
    assert_eq!((own.len(), known.len()), (2, 2));
    assert!(own.iter().zip(known).all(|(own, known)| (own / known - 1.0).abs() < 1e-9), "{frequencies:?}");
}

fn simulated(joint: Joint, start: MotionState) -> Result<Simulation, SetupError> {
    Simulation::of_system(SystemSetup {
        system: System::new(vec![body(GRAVITY)], vec![joint]).unwrap(),
        states: vec![start],
        start: Start::AsPlaced,
        scheme: SystemScheme::Radau,
        control: StepControl::Tolerance(1e-6),
        end: 1.0,
        rows: Rows::Interval(0.1),
        points: vec![Vec::new()],
    })
}

/// Bad input: derivatives that are not those of the equation.
#[test]
fn derivatives_that_do_not_fit_are_refused() {
    let parabola = |slope: f64| {
        let equation = move |RelativePlace { position, .. }: &RelativePlace| EquationValue {
            residual: position.z - position.x * position.x,
            by_position: Vector3::new(-slope * position.x, 0.0, 1.0),
            by_turn: Vector3::zeros(),
        };
        Joint::new("wire", [ground(), on(0, [0.0; 3], skew())], Vec::new())
            .with_equation(Arc::new(JointEquationFn::new("parabola", equation)))
    };
    let start = || state([0.5, 0.0, 0.25], [0.0; 3], [0.0; 3]);
    assert!(simulated(parabola(2.0), start()).is_ok());
    let error = simulated(parabola(1.0), start()).unwrap_err();
    let SetupError::NotItsDerivative { name, found, expected, .. } = &error else { panic!("{error}") };
    assert_eq!((*name, *found), ("by_position.x", -0.5));
    assert!((expected + 1.0).abs() < 1e-6, "{error}");
    for words in ["\"wire\"", "parabola", "by_position"] {
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// Bad input: an equation that is the square of a distance, which holds nothing where it is zero.
#[test]
fn an_equation_without_derivatives_is_refused() {
    let square = |RelativePlace { position, .. }: &RelativePlace| EquationValue {
        residual: position.x.powi(2) + position.y.powi(2),
        by_position: Vector3::new(2.0 * position.x, 2.0 * position.y, 0.0),
        by_turn: Vector3::zeros(),
    };
    let joint = Joint::new("axis", [ground(), on(0, [0.0; 3], skew())], Vec::new())
        .with_equation(Arc::new(JointEquationFn::new("square", square)));
    let error = simulated(joint, state([0.0; 3], [0.0; 3], [0.0; 3])).unwrap_err();
    assert!(matches!(error, SetupError::NoDerivative { .. }) && error.to_string().contains("\"axis\""), "{error}");
}

/// Bad input: an equation that is not a number at some place ends the run there, and cannot be written as data.
#[test]
fn an_equation_that_is_no_number_ends_the_run() {
    let floor = |RelativePlace { position, .. }: &RelativePlace| EquationValue {
        residual: if position.x < 0.4 { position.z } else { f64::NAN },
        by_position: Vector3::z(),
        by_turn: Vector3::zeros(),
    };
    let joint = Joint::new("floor", [ground(), on(0, [0.0; 3], skew())], Vec::new())
        .with_equation(Arc::new(JointEquationFn::new("floor", floor)));
    let mut simulation = simulated(joint.clone(), state([0.0; 3], [1.0, 0.0, 0.0], [0.0; 3])).unwrap();
    let error = loop {
        match simulation.advance(10_000) {
            Ok(dynamics::Reached::Row) => {}
            Ok(reached) => panic!("{reached:?}"),
            Err(error) => break error,
        }
    };
    println!("{error}");
    assert!((0.3..0.41).contains(&simulation.system_motion().unwrap().time()), "{error}");
    let mut run = described::run();
    run.joints[1] = Joint { name: "second".into(), ..joint };
    let refused = run.to_bytes().unwrap_err();
    assert_eq!(refused, DescriptionError::Equation { joint: "second".into() });
}
