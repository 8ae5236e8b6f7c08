//! Joints whose forces stiffen their bodies.

use std::sync::{Arc, OnceLock};

use dynamics::{History, Joint, Marker, MotionState, Observation, PointForce, System, SystemMotion};
use fem_tet10::Material;
use nalgebra::{Matrix3, Vector3};
use rigid_kin::Attitude;

use crate::flexible::Jointed;

/// N/mm², t/mm³.
const YOUNG: f64 = 70_000.0;
const LENGTH: f64 = 200.0;

/// A bar of 200 × 10 × 10 mm, with its ends for patches.
fn bar() -> &'static Jointed {
    static BAR: OnceLock<Jointed> = OnceLock::new();
    let aluminium = Material { young_modulus: YOUNG, poisson_ratio: 0.0, density: 2.7e-9 };
    BAR.get_or_init(|| Jointed::new("half_bar", aluminium, 4, &["left", "right"]))
}

/// Deflection across of the end of a bar that is held by a joint at the other end and pulled at this one.
fn deflection(pull: f64, across: f64, joint_stiffens: bool) -> f64 {
    let bar = bar();
    let (point, _) = &bar.patches[1];
    let point = point.clone().with_second_order(bar.second_orders[1][0].clone());
    let load = PointForce::dead(point.clone(), Vector3::new(pull, across, 0.0), History::Constant);
    let body = bar.damped(1.0, vec![Arc::new(load)]);
    let start = bar.at_rest(Vector3::new(0.5 * LENGTH, 0.0, 0.0), Attitude::identity());
    let marker = if joint_stiffens { bar.stiffening_marker(0, 0) } else { bar.marker(0, 0) };
    let weld = Joint::fixed("weld", [Marker::on_ground(Vector3::zeros(), Matrix3::identity()), marker]);
    let mut motion = SystemMotion::new(System::new(vec![body], vec![weld]).unwrap(), &[start]).unwrap();
    motion.assemble().unwrap();
    motion.advance(0.2, 1e-6, &mut 1e-4).unwrap();
    motion.find_reactions().unwrap();
    let mut out = Observation::new(bar.body.circular_frequencies.len(), 1);
    motion.observe(0, &[point], &mut out).unwrap();
    out.points[0].displacement.y
}

/// Closed form: a cantilever that is pulled with P bends by Q (L − tanh(kL)/k)/P under Q across its end, k² = P/EI. The
/// joint's force has its part in that.
#[test]
fn a_pulled_bar_on_a_joint_bends_less() {
    let bending = YOUNG * 1e4 / 12.0;
    let across = 1.0;
    let [free, pulled, by_load_alone] = [(0.0, true), (4.0, true), (4.0, false)]
        .map(|(square, joint_stiffens)| deflection(square * bending / (LENGTH * LENGTH), across, joint_stiffens));
    // With what the weld of a mean patch gives way, and shear.
    let slender = across * LENGTH.powi(3) / (3.0 * bending);
    println!("bends by {free}, {pulled}, {by_load_alone}; a beam by {slender}");
    assert!((free / slender - 1.0).abs() < 0.03, "{free} {slender}");
    let expected = 3.0 * (1.0 - 2.0_f64.tanh() / 2.0) / 4.0;
    assert!((pulled / free / expected - 1.0).abs() < 0.02, "{} {expected}", pulled / free);
    assert!(by_load_alone / free > 1.05 * expected, "{} {expected}", by_load_alone / free);
}

/// Conserved: energy and momenta of a free pair of bars that spins fast, welded by a joint that stiffens them.
#[test]
fn joints_that_stiffen_keep_energy_and_momenta() {
    let bar = bar();
    let weld = Joint::fixed("weld", [bar.stiffening_marker(0, 1), bar.stiffening_marker(1, 0)]);
    let system = System::new(vec![bar.conservative(), bar.conservative()], vec![weld]).unwrap();
    let omega = Vector3::new(0.0, 3.0, 200.0);
    let start = |x: f64| {
        let mut state = MotionState {
            velocity_global: omega.cross(&Vector3::new(x, 0.0, 0.0)),
            omega_body: omega,
            ..bar.at_rest(Vector3::new(x, 0.0, 0.0), Attitude::identity())
        };
        state.modal_displacement[0] = 1e-6;
        state
    };
    let mut motion = SystemMotion::new(system, &[start(-100.0), start(100.0)]).unwrap();
    motion.relax().unwrap();
    let mut drifts = Vec::new();
    for tolerance in [1e-4, 1e-6] {
        let mut motion = motion.clone();
        let (momenta, energy) = (motion.momenta(), motion.energy().unwrap());
        let steps = motion.advance(0.02, tolerance, &mut 1e-5).unwrap();
        let drift = (motion.energy().unwrap() / energy - 1.0).abs();
        let [of_momentum, of_spin] =
            [0, 1].map(|k: usize| (motion.momenta()[k] - momenta[k]).norm() / momenta[1].norm());
        println!("{tolerance:e}: {steps} steps, energy {drift:e}, momenta {of_momentum:e} {of_spin:e}");
        assert!(of_spin < 1e-13, "{of_spin:e}");
        drifts.push(drift);
    }
    assert!(drifts[1] < 1e-7, "{drifts:?}");
}
