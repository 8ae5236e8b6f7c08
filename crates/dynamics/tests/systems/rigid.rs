//! Rigid bodies in hinges, against closed forms and conserved quantities.

use std::f64::consts::PI;
use std::sync::Arc;

use dynamics::{LoadFn, Observation, PointShapes, SharedLoad, SystemMotion, SystemScheme};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{BodyPoint, ReducedBody, RigidMotion};

use crate::mechanism::{Link, Mechanism, angle};

pub const GRAVITY: f64 = 9.81;

pub fn weight(mass: f64) -> SharedLoad {
    let body = ReducedBody::rigid(1.0, Vector3::zeros(), Matrix3::identity(), RigidMotion::free()).unwrap();
    let center = PointShapes::new(&body, &BodyPoint::rigid(Vector3::zeros()));
    Arc::new(LoadFn::new("weight", move |motion, applied| {
        applied.force(&center, &(motion.body_from_global * Vector3::new(0.0, -mass * GRAVITY, 0.0)));
    }))
}

/// A bar of 1 m and 1 kg, hung by its end at an angle from below.
pub fn pendulum(amplitude: f64) -> SystemMotion {
    let mut mechanism = Mechanism::default();
    let center = [0.5 * amplitude.sin(), -0.5 * amplitude.cos()];
    let link = mechanism.link(Link {
        mass: 1.0,
        inertia: Vector3::new(1.0 / 12.0, 1e-3, 1.0 / 12.0),
        center,
        angle: amplitude,
        loads: vec![weight(1.0)],
    });
    mechanism.hinge([None, Some(link)], [0.0; 2]);
    mechanism.starts(&[([0.0; 2], 0.0)])
}

/// Closed form: the period of a pendulum of length 2/3 by the arithmetic-geometric mean.
#[test]
fn a_pendulum_has_its_period() {
    let amplitude: f64 = 2.0;
    let (mut a, mut g) = (1.0, (0.5 * amplitude).cos());
    while f64::abs(a - g) > 1e-15 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    let period = 2.0 * PI * f64::sqrt(2.0 / 3.0 / GRAVITY) / a;
    let mut last = f64::INFINITY;
    let tolerances = [1e-5, 1e-7, 1e-9];
    let both = [SystemScheme::Radau, SystemScheme::Rkmk4];
    for (scheme, tolerance) in both.into_iter().flat_map(|scheme| tolerances.map(|tolerance| (scheme, tolerance))) {
        let mut motion = pendulum(amplitude).with_scheme(scheme);
        let steps = motion.advance(period, tolerance, &mut 1e-3).unwrap();
        let error = (angle(&motion, 0) - amplitude).abs() + motion.state(0).unwrap().omega_body.norm();
        let [residuals, rates] =
            motion.residuals().unwrap().map(|list| list.iter().fold(0.0_f64, |a, b| a.max(b.abs())));
        println!("{scheme:?} {tolerance:e}: {steps} steps, error {error:e}, residual {residuals:e}, rate {rates:e}");
        assert!(error < 30.0 * tolerance && (tolerance == tolerances[0] || error < 0.3 * last));
        assert!(residuals < 1e-14 && rates < 1e-12);
        last = error;
    }
}

/// Conserved: two bars that a hinge joins fly and turn: momenta stay to rounding at any tolerance, energy at the
/// tolerance.
#[test]
fn a_free_pair_keeps_its_momenta() {
    let bar = |x: f64| Link {
        mass: 1.0,
        inertia: Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0),
        center: [x, 0.0],
        angle: 0.0,
        loads: Vec::new(),
    };
    let start = || {
        let mut mechanism = Mechanism::default();
        let [a, b] = [-0.5, 0.5].map(|x| mechanism.link(bar(x)));
        mechanism.hinge([Some(a), Some(b)], [0.0; 2]);
        mechanism.starts(&[([1.0, -1.5], 3.0), ([1.0, 1.0], 2.0)])
    };
    for scheme in [SystemScheme::Radau, SystemScheme::Rkmk4] {
        let mut drifts = Vec::new();
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let mut motion = start().with_scheme(scheme);
            let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
            let steps = motion.advance(5.0, tolerance, &mut 1e-2).unwrap();
            let now = motion.momenta();
            let drift = (motion.energy().unwrap() / energy - 1.0).abs();
            let of_momenta = [0, 1].map(|k: usize| (now[k] - momenta[k]).norm());
            println!("{tolerance:e}: {steps} steps, momenta {of_momenta:?}, energy {drift:e}");
            assert!(of_momenta.iter().all(|error| *error < 1e-12));
            drifts.push(drift);
        }
        assert!(drifts[2] < 1e-8 && drifts[2] < 1e-3 * drifts[0].max(1e-7));
    }
}

/// Conserved: order 5 of Radau, 6 of Gauss and 4 of the explicit scheme, by halving a fixed step.
#[test]
fn the_error_falls_with_the_order_of_the_scheme() {
    for (scheme, least) in [(SystemScheme::Radau, 4.5), (SystemScheme::Gauss, 5.4), (SystemScheme::Rkmk4, 3.7)] {
        let end = |steps: usize| {
            let mut motion = pendulum(1.5).with_scheme(scheme);
            let h = 1.0 / steps as f64;
            for k in 0..steps {
                motion.try_step(h, (k + 1) as f64 * h, 1e-13, f64::INFINITY).unwrap();
            }
            [angle(&motion, 0), motion.state(0).unwrap().omega_body.z]
        };
        let exact = end(400);
        let errors = [10, 20, 40].map(|steps| {
            let found = end(steps);
            (found[0] - exact[0]).hypot(found[1] - exact[1])
        });
        let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
        println!("{scheme:?}: {errors:?} {orders:?}");
        assert!(orders.iter().all(|order| *order > least), "{orders:?}");
    }
}

/// Conserved: the energy of a pair that turns freely, in 4000 steps of some 0.3 rad: Gauss loses a hundredth of what Radau loses; both
/// keep the momenta.
#[test]
fn gauss_keeps_energy_over_long_times() {
    let bar = |x: f64| Link {
        mass: 1.0,
        inertia: Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0),
        center: [x, 0.0],
        angle: 0.0,
        loads: Vec::new(),
    };
    let lost = [SystemScheme::Radau, SystemScheme::Gauss].map(|scheme| {
        let mut mechanism = Mechanism::default();
        let [a, b] = [-0.5, 0.5].map(|x| mechanism.link(bar(x)));
        mechanism.hinge([Some(a), Some(b)], [0.0; 2]);
        let mut motion = mechanism.starts(&[([1.0, -1.5], 3.0), ([1.0, 1.0], 2.0)]).with_scheme(scheme);
        let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
        for step in 1..=4000_u32 {
            motion.try_step(0.1, 0.1 * f64::from(step), 1e-10, f64::INFINITY).unwrap();
        }
        let of_momenta = [0, 1].map(|k: usize| (motion.momenta()[k] - momenta[k]).norm());
        assert!(of_momenta.iter().all(|error| *error < 1e-10), "{of_momenta:?}");
        (motion.energy().unwrap() / energy - 1.0).abs()
    });
    println!("{lost:?}");
    assert!(lost[1] < 1e-2 * lost[0], "{lost:?}");
}

/// Closed form: the force of the hinge of a bar that swings, m (ω² l/2 + g cos θ) along it and m g sin θ/4 across.
#[test]
fn the_reaction_of_a_pendulum_is_that_of_its_swing() {
    let (amplitude, length) = (1.2_f64, 1.0);
    let mut motion = pendulum(amplitude);
    let mut out = Observation::new(0, 0);
    for end in [0.0, 0.2, 0.5, 0.9] {
        if end > 0.0 {
            motion.advance(end, 1e-10, &mut 1e-3).unwrap();
        }
        motion.find_reactions().unwrap();
        motion.observe(0, &[], &mut out).unwrap();
        let theta = angle(&motion, 0);
        let square = 3.0 * GRAVITY / length * (theta.cos() - amplitude.cos());
        let along = 0.5 * length * square + GRAVITY * theta.cos();
        let across = 0.25 * GRAVITY * theta.sin();
        // From the centre to the hinge, and at right angles to it.
        let [to_hinge, beside] =
            [[-theta.sin(), theta.cos()], [theta.cos(), theta.sin()]].map(|[x, y]| Vector3::new(x, y, 0.0));
        let found = motion.reaction(0).force_global;
        assert!((found.dot(&to_hinge) - along).abs() < 1e-7, "{end}: {found} {along}");
        assert!((found.dot(&beside) - across).abs() < 1e-7, "{end}: {found} {across}");
        let alpha = -1.5 * GRAVITY / length * theta.sin();
        assert!((out.alpha_body.z - alpha).abs() < 1e-7, "{end}: {} {alpha}", out.alpha_body.z);
    }
}

/// Independent reference: Bricard's linkage of five rods of 1 m and 1 kg along the edges of a cube, 1e-3 kg m² about themselves,
/// under gravity. Another program has the centre of the third rod at (1.11401, −0.48059, 1.25119) after 1 s.
#[test]
fn bricards_linkage_goes_where_others_have_it() {
    let edges = [Vector3::z(), Vector3::y(), Vector3::x(), -Vector3::z(), -Vector3::y(), -Vector3::x()];
    let mut points = vec![Vector3::zeros()];
    edges[..5].iter().for_each(|edge| points.push(points[points.len() - 1] + edge));
    let axes: Vec<Vector3<f64>> = (0..6).map(|k| edges[(k + 5) % 6].cross(&edges[k])).collect();
    let mut motion = linkage(&points, &axes);
    let steps = motion.advance(1.0, 1e-7, &mut 1e-3).unwrap();
    let center = motion.state(2).unwrap().origin_global;
    println!("{steps} steps, {center:?}");
    assert!((center - Vector3::new(1.11401, -0.48059, 1.25119)).amax() < 1e-5, "{center}");
    // Six hinges have 30 rows, of which 29 are independent: it moves although it should not.
    assert_eq!(motion.dependent_rows(), 1);
}

/// Independent reference: the double four-bar of the IFToMM library of benchmarks, links of 1 m and 1 kg, thrown with 1 m/s; it
/// passes through positions in which all links are in one line, and more motions are open. B0 after 10 s.
#[test]
fn a_double_four_bar_passes_its_singular_positions() {
    let start = || {
        let mut mechanism = Mechanism::default();
        let mut rod = |center: [f64; 2], angle: f64| {
            let inertia = Vector3::new(1e-3, 1.0 / 12.0, 1.0 / 12.0);
            mechanism.link(Link { mass: 1.0, inertia, center, angle, loads: vec![weight(1.0)] })
        };
        let cranks = [0.0, 1.0, 2.0].map(|x| rod([x, 0.5], 0.5 * PI));
        let couplers = [0.5, 1.5].map(|x| rod([x, 1.0], 0.0));
        for (k, crank) in cranks.into_iter().enumerate() {
            mechanism.hinge([None, Some(crank)], [k as f64, 0.0]);
        }
        for (crank, coupler) in [(0, 0), (1, 0), (1, 1), (2, 1)] {
            mechanism.hinge([Some(cranks[crank]), Some(couplers[coupler])], [crank as f64, 1.0]);
        }
        let turning = ([0.5, 0.0], -1.0);
        mechanism.starts(&[turning, turning, turning, ([1.0, 0.0], 0.0), ([1.0, 0.0], 0.0)])
    };
    for (tolerance, bound) in [(1e-6, 1e-5), (1e-8, 2e-6)] {
        let mut motion = start();
        motion.assemble().unwrap();
        let energy = motion.energy().unwrap();
        let steps = motion.advance(10.0, tolerance, &mut 1e-3).unwrap();
        let turned = angle(&motion, 0);
        let error = (turned.cos() - 0.328_457_376_8).hypot(turned.sin() - 0.944_518_793_7);
        println!("{tolerance:e}: {steps} steps, error {error:e}, energy {energy} at the start");
        assert!(error < bound, "{error:e}");
    }
}

/// Rods between points, the first and the last of which are on the ground, with a hinge at each point.
fn linkage(points: &[Vector3<f64>], axes: &[Vector3<f64>]) -> SystemMotion {
    use dynamics::{ConservativeBody, Joint, Marker, MotionState, Physics, System};
    use rigid_kin::Attitude;

    let rods = points.len() - 1;
    let center = |rod: usize| 0.5 * (points[rod] + points[rod + 1]);
    let bodies = (0..rods).map(|rod| {
        let along = points[rod + 1] - points[rod];
        let length = along.norm();
        let unit = along / length;
        let across = Matrix3::identity() - unit * unit.transpose();
        let inertia = across * (length * length / 12.0) + unit * unit.transpose() * 1e-3;
        let body = ReducedBody::rigid(1.0, Vector3::zeros(), inertia, RigidMotion::free()).unwrap();
        ConservativeBody::new(&body, &[], vec![weight(1.0)], &Physics::default()).unwrap()
    });
    let frame = |axis: &Vector3<f64>| {
        let other = if axis.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let x = axis.cross(&other).normalize();
        Matrix3::from_columns(&[x, axis.cross(&x), *axis])
    };
    let on = |rod: usize, at: usize| Marker::on_rigid(rod, points[at] - center(rod), frame(&axes[at]));
    let ground = |at: usize| Marker::on_ground(points[at], frame(&axes[at]));
    let mut joints = vec![Joint::revolute("first", [ground(0), on(0, 0)])];
    joints.extend((1..rods).map(|at| Joint::revolute("between", [on(at - 1, at), on(at, at)])));
    joints.push(Joint::revolute("last", [on(rods - 1, rods), ground(rods)]));
    let states: Vec<MotionState> = (0..rods)
        .map(|rod| MotionState {
            time: 0.0,
            attitude: Attitude::identity(),
            origin_global: center(rod),
            velocity_global: Vector3::zeros(),
            omega_body: Vector3::zeros(),
            modal_displacement: Vec::new(),
            modal_velocity: Vec::new(),
        })
        .collect();
    let mut motion = SystemMotion::new(System::new(bodies.collect(), joints).unwrap(), &states).unwrap();
    motion.assemble().unwrap();
    motion
}
