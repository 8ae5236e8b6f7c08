//! A slender cantilever against the exact elastica and against the whole mesh.

use std::borrow::Cow;
use std::sync::Arc;

use dynamics::MotionState;
use fem_tet10::{Materials, assemble};
use modal::Support;
use model::{Builder, Checker, Mend};
use nalgebra::{DMatrix, DVector};
use nonlinear::{EquilibriumSettings, ExternalForces, FullBody, StateErrorSettings, equilibrium};
use reduced_body::RigidMotion;
use verification::nonlinear::bodies::{COLUMN, COLUMN_BENDING};
use verification::nonlinear::cases::{self, TimeCurve};
use verification::nonlinear::{NodalState, Solid, SolidMotion, bodies};

/// Deflection of the tip over the length under a dead end force α EI/L²: θ'' = −α cos θ from the root, θ'(1) = 0, by
/// Runge–Kutta from a curvature that is found by halving.
fn elastica(alpha: f64) -> f64 {
    let shoot = |curvature: f64| {
        let (mut theta, mut slope, mut height, steps) = (0.0_f64, curvature, 0.0, 400);
        let h = 1.0 / f64::from(steps);
        for _ in 0..steps {
            let rate = |t: f64, s: f64| (s, -alpha * t.cos(), t.sin());
            let k1 = rate(theta, slope);
            let k2 = rate(theta + 0.5 * h * k1.0, slope + 0.5 * h * k1.1);
            let k3 = rate(theta + 0.5 * h * k2.0, slope + 0.5 * h * k2.1);
            let k4 = rate(theta + h * k3.0, slope + h * k3.1);
            let mean = |a: f64, b: f64, c: f64, d: f64| h * (a + 2.0 * b + 2.0 * c + d) / 6.0;
            theta += mean(k1.0, k2.0, k3.0, k4.0);
            slope += mean(k1.1, k2.1, k3.1, k4.1);
            height += mean(k1.2, k2.2, k3.2, k4.2);
        }
        (slope, height)
    };
    let (mut low, mut high) = (0.0, alpha);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if shoot(middle).0 < 0.0 { low = middle } else { high = middle }
    }
    shoot(low).1
}

/// The same under a force that stays normal to the tip: from the tip inwards, φ'' = −α cos φ of the angle against the tip,
/// φ = φ' = 0 there.
fn follower_elastica(alpha: f64) -> f64 {
    let steps = 4000;
    let h = 1.0 / f64::from(steps);
    let (mut phi, mut slope) = (0.0_f64, 0.0_f64);
    let mut angles = vec![phi];
    for _ in 0..steps {
        let middle = phi + 0.5 * h * slope;
        let half = slope - 0.5 * h * alpha * phi.cos();
        slope -= h * alpha * middle.cos();
        phi += h * half;
        angles.push(phi);
    }
    angles.windows(2).map(|pair| h * 0.5 * ((pair[0] - phi).sin() + (pair[1] - phi).sin())).sum()
}

/// Deflection of the tip under a dead end force, of a strain energy of fourth order: the least `½ ∫ w''²(1 + w'²) ds − α w(1)`
/// among polynomials, by Newton's iteration.
fn fourth_order(alpha: f64) -> f64 {
    const SHAPES: i32 = 6;
    let count = SHAPES as usize;
    let points = 2000;
    let weight = 1.0 / f64::from(points);
    let slopes_at = |s: f64| {
        let first = DVector::from_iterator(count, (2..2 + SHAPES).map(|k| f64::from(k) * s.powi(k - 1)));
        let second = DVector::from_iterator(count, (2..2 + SHAPES).map(|k| f64::from(k * (k - 1)) * s.powi(k - 2)));
        (first, second)
    };
    let mut w = DVector::zeros(count);
    for _ in 0..12 {
        let mut force = DVector::from_element(count, -alpha);
        let mut stiffness = DMatrix::zeros(count, count);
        for i in 0..points {
            let (first, second) = slopes_at((f64::from(i) + 0.5) * weight);
            let (slope, curvature) = (first.dot(&w), second.dot(&w));
            force +=
                weight * ((curvature * (1.0 + slope * slope)) * &second + (curvature * curvature * slope) * &first);
            let both = &second * first.transpose();
            stiffness += weight
                * ((1.0 + slope * slope) * &second * second.transpose()
                    + curvature * curvature * &first * first.transpose()
                    + 2.0 * curvature * slope * (&both + both.transpose()));
        }
        w -= stiffness.cholesky().unwrap().solve(&force);
    }
    w.sum()
}

/// Regression only: the error of large modes under a dead force is that of any strain energy of fourth order: the
/// parts that the Ritz method in this file leaves of the elastica.
#[test]
fn an_energy_of_fourth_order_leaves_a_part_of_the_elastica() {
    for (alpha, expected) in [(0.31, 0.02), (0.59, 0.20), (0.9, 0.83)] {
        let off = 100.0 * (fourth_order(alpha) / elastica(alpha) - 1.0);
        println!("{alpha}: {off:+.3} %");
        assert!((off - expected).abs() < 5e-3, "{alpha}: {off} %");
    }
}

const LARGE: &str = "[modes]\nflexible = 8\nlarge = 2\nfollowing = 6\nstatic_correction = false\n";

/// Where the tip of the column comes to rest, over its length: in eight bending modes, four in each plane, two of them large.
fn tip_at_rest(alpha: f64, frame: &str) -> f64 {
    let text = format!(
        "{LARGE}damping_ratio = 0.7\n[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n\
         [[loads]]\nkind = \"force\"\nat = [1.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\nframe = \"{frame}\"\n\
         amplitude = {:e}\nhistory = {{ kind = \"ramp\", duration = 4.0 }}\n\
         [effects]\nlarge_deflection = true\nrefuse = false\n[output.points]\ntip = [1.0, 0.0, 0.0]\n\
         [time]\nend = 8.0\nstep = 4e-3\n",
        alpha * COLUMN_BENDING
    );
    let (scene, model) = cases::built("column", COLUMN, &text).unwrap();
    cases::rows(&scene, &model).unwrap().pop().unwrap().points[0].displacement.z
}

/// Independent reference: the elastica by shooting.
#[test]
fn a_dead_end_force_bends_it_as_the_elastica() {
    // Measured: -0.014, +0.174, +0.817 %. Of a thin beam, an energy of fourth order leaves +0.02, +0.20 and +0.83 %.
    for (alpha, tolerance) in [(0.31, 1e-3), (0.59, 2e-3), (0.9, 1e-2)] {
        let (found, exact) = (tip_at_rest(alpha, "global"), elastica(alpha));
        let off = found / exact - 1.0;
        println!("tip at {:.2} %: {:+.3} %", 100.0 * exact, 100.0 * off);
        assert!(off.abs() < tolerance, "{alpha}: {found} instead of {exact}");
    }
}

/// Independent reference: the elastica by steps from the tip.
#[test]
fn an_end_force_that_turns_with_the_tip_bends_it_as_the_elastica() {
    // Measured: -0.028, +0.004, +0.070 %.
    for (alpha, tolerance) in [(0.31, 1e-3), (0.59, 1e-3), (0.9, 2e-3)] {
        let (found, exact) = (tip_at_rest(alpha, "material"), follower_elastica(alpha));
        let off = found / exact - 1.0;
        println!("tip at {:.2} %: {:+.3} %", 100.0 * exact, 100.0 * off);
        assert!(off.abs() < tolerance, "{alpha}: {found} instead of {exact}");
    }
}

/// The first mode of the column let go at a deflection of the tip, over four periods: circular frequency, of the linear
/// model, of large modes and of the nonlinear body.
fn let_go(part: f64) -> [f64; 3] {
    let text = |modes: &str, rest: &str, end: f64, step: f64| {
        format!(
            "{modes}[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n\
             [effects]\nlarge_deflection = true\nrefuse = false\n{rest}[time]\nend = {end:e}\nstep = {step:e}\n"
        )
    };
    let (_, rest) = cases::built("column", COLUMN, &text(LARGE, "", 1e-3, 1e-3)).unwrap();
    let omega = rest.body.circular_frequencies[0];
    let end = 4.0 * std::f64::consts::TAU / omega;
    let phi = cases::shape(&rest, 0);
    let q = part / cases::peaks(&phi, 0)[0];
    // Held in its first mode, at rest in all others.
    let solid = Solid::new(bodies::mesh("column").unwrap(), COLUMN, |x| x.x < 1e-9).unwrap();
    let u = solid.held_in_modes(std::slice::from_ref(&phi), &[q], 0.3 * omega * omega, 8).unwrap();
    let along = |k: usize| solid.momentum(&cases::shape(&rest, k)).iter().zip(&u).map(|(m, u)| m * u).sum();
    let start: Vec<f64> = (0..8).map(along).collect();
    let initial = format!("[initial]\nmodal_displacement = {start:?}\n");
    let (scene, model) = cases::built("column", COLUMN, &text(LARGE, &initial, end, end / 4000.0)).unwrap();
    let rows = cases::rows(&scene, &model).unwrap();
    let large = TimeCurve {
        times: rows.iter().step_by(10).map(|row| row.time).collect(),
        values: rows.iter().step_by(10).map(|row| row.modal_displacement[0]).collect(),
    };

    let momentum = solid.momentum(&phi);
    let steps = 480;
    let state = NodalState { time: 0.0, u, v: vec![0.0; phi.len()] };
    let mut motion = SolidMotion::new(&solid, state, end / f64::from(steps), |_, u| vec![0.0; u.len()]);
    let mut course = TimeCurve { times: vec![0.0], values: vec![q] };
    for _ in 0..steps {
        motion.advance().unwrap();
        course.times.push(motion.state.time);
        course.values.push(momentum.iter().zip(&motion.state.u).map(|(m, u)| m * u).sum());
    }
    let off = large.distance(&course) / q.abs();
    println!("off by {off:e} of the peak");
    let tau = std::f64::consts::TAU;
    let nonlinear = tau * cases::cycles(&course, omega, Some(course.times[1]));
    [omega, tau * cases::cycles(&large, omega, None), nonlinear]
}

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
#[ignore = "a minute: just nonlinear"]
fn its_period_is_that_of_the_whole_mesh_at_a_fifth_of_its_length() {
    // Measured: 1e-6 and 4e-5.
    for (part, tolerance) in [(0.1, 1e-5), (0.2, 2e-4)] {
        let [linear, large, nonlinear] = let_go(part);
        println!("{part}: {large:.5} rad/s, nonlinear elements {nonlinear:.5}, linear {linear:.5}");
        assert!((large / nonlinear - 1.0).abs() < tolerance, "{part}: {large} instead of {nonlinear}");
    }
}

/// Independent reference: the nonlinear finite elements of this crate. Small vibrations about the rest of a bent
/// column, in its plane and across it, are not those about the straight one.
#[test]
fn the_modes_of_a_bent_column_are_those_of_the_whole_mesh_about_its_rest() {
    let force = 0.6 * COLUMN_BENDING;
    let clamp = "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n";
    let time = "[time]\nend = 1e-3\nstep = 1e-3\n";
    let text = format!(
        "{LARGE}{clamp}[[loads]]\nkind = \"force\"\nat = [1.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\n\
         amplitude = {force:e}\n[effects]\nlarge_deflection = true\nrefuse = false\n{time}"
    );
    let (scene, model) = cases::built("column", COLUMN, &text).unwrap();
    let found: Vec<f64> = model.loaded_modes(&scene).unwrap().iter().map(|mode| mode.circular_frequency).collect();

    let solid = Solid::new(bodies::mesh("column").unwrap(), COLUMN, |x| x.x < 1e-9).unwrap();
    let tip = |x: &[f64; 3]| (x[0] - 1.0).abs() < 1e-9 && x[1].abs() < 1e-9 && x[2].abs() < 1e-9;
    let tip = solid.mesh().positions().iter().position(tip).unwrap();
    let mut load = vec![0.0; solid.dofs()];
    load[3 * tip + 2] = force;
    let rest = solid.at_rest(6, 0.0, |_| load.clone()).unwrap();
    let shapes: Vec<Vec<f64>> = (0..8).map(|k| cases::shape(&model, k)).collect();
    let expected = solid.frequencies_at_rest(&rest, &shapes).unwrap();
    let straight = &model.body.circular_frequencies;
    println!("tip {:.3}", rest[3 * tip + 2]);
    println!("found {found:.4?}\nnonlinear elements {expected:.4?}\nstraight {straight:.4?}");
    for k in 0..4 {
        let off = found[k] / expected[k] - 1.0;
        // Measured: 0.31 % at most; about the straight column 2.8 %.
        assert!(off.abs() < 5e-3, "mode {k}: {} instead of {}", found[k], expected[k]);
    }
}

/// Closed form: ¼ √(E/ρ)/L of a rod.
#[test]
fn a_mode_that_bending_draws_in_is_refused_as_a_large_one() {
    // The twelfth stretches the column: see the frequency of a rod, ¼ √(E/ρ)/L.
    let text = "[modes]\nflexible = 13\nlarge = LARGE\nstatic_correction = false\n\
                [[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n\
                [effects]\nlarge_deflection = true\n[time]\nend = 1e-3\nstep = 1e-3\n";
    let (_, model) = cases::built("column", COLUMN, &text.replace("large = LARGE", "large = 2")).unwrap();
    let rod = 0.25 * (COLUMN.young_modulus / COLUMN.density).sqrt();
    let frequencies = model.natural_frequencies();
    let stretches = frequencies.iter().position(|f| (f / rod - 1.0).abs() < 1e-3).unwrap() + 1;
    println!("{frequencies:.2?} {stretches}");
    let refused = cases::built("column", COLUMN, &text.replace("LARGE", &format!("[1, 2, {stretches}]"))).err();
    let message = refused.map(|error| error.to_string()).unwrap_or_default();
    println!("{message}");
    for words in [&format!("mode {stretches}"), "drawn in where mode 1 bends", "large = [1, 2]"] {
        assert!(message.contains(words), "{message}");
    }
}

/// Independent reference: the elastica by shooting, and the linear beam, α/3. The check of a row of linear modes has the true place of
/// the tip, and knows how far they are off.
#[test]
fn the_check_of_linear_modes_knows_where_the_tip_is() {
    for alpha in [0.31, 0.9] {
        let text = format!(
            "[modes]\nflexible = 8\ndamping_ratio = 0.7\n[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n\
             [[loads]]\nkind = \"force\"\nat = [1.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = {:e}\n\
             history = {{ kind = \"ramp\", duration = 4.0 }}\n[effects]\nlarge_deflection = false\nrefuse = false\n\
             [output.points]\ntip = [1.0, 0.0, 0.0]\n[time]\nend = 8.0\nstep = 4e-3\n",
            alpha * COLUMN_BENDING
        );
        let (scene, model) = cases::built("column", COLUMN, &text).unwrap();
        let last = cases::rows(&scene, &model).unwrap().pop().unwrap();
        let motion = MotionState {
            time: last.time,
            attitude: last.attitude,
            origin_global: last.origin_global,
            velocity_global: nalgebra::Vector3::zeros(),
            omega_body: last.omega_body,
            modal_displacement: last.modal_displacement.clone(),
            modal_velocity: last.modal_velocity.clone(),
        };
        let full = Builder::default().full(&scene, |_| ()).unwrap().unwrap();
        let body = full.body().unwrap();
        let checker = Checker::new(&full, &scene, &model, &body).unwrap();
        let found = checker.check(&motion, &[], &StateErrorSettings::default(), true).unwrap();
        let exact = elastica(alpha);
        let point = &found.points[0];
        println!("{alpha}: {found:?}");
        assert!((point.displacement[2] / exact - 1.0).abs() < 2e-3, "{} {exact}", point.displacement[2]);
        let off = alpha / 3.0 / exact - 1.0;
        assert!((point.error[2] / exact - off).abs() < 2e-3, "{} {off}", point.error[2] / exact);
        assert!(found.is_settled && found.negative_directions == Some(0));
        assert_eq!(found.mends, [Mend::LargeModes]);
        // About the bent column: the tests above have them.
        assert!(found.frequencies.len() == 4 && found.frequencies.iter().all(|f| f.error.abs() < 0.1));
    }
}

/// Independent reference: the nonlinear body of this crate, which has loops of its own, and Newton's iteration on displacements.
#[test]
fn the_full_body_of_the_check_is_the_nonlinear_body() {
    let clamped = |x: nalgebra::Vector3<f64>| x.x < 1e-9;
    let solid = Solid::new(bodies::mesh("column").unwrap(), COLUMN, clamped).unwrap();
    let mesh = Arc::new(bodies::mesh("column").unwrap());
    let materials = Materials::Uniform(COLUMN);
    let matrices = assemble(&mesh, &materials, &[]).unwrap();
    let root = (0..).zip(mesh.positions()).filter(|(_, x)| clamped((**x).into())).map(|(node, _)| node).collect();
    let support = Support::new(RigidMotion::clamp(nalgebra::Vector3::zeros()), root);
    let body = FullBody::new(Arc::clone(&mesh), &materials, Cow::Owned(matrices), &support).unwrap();
    let tip = mesh.positions().iter().position(|x| (x[0] - 1.0).abs() + x[1].abs() + x[2].abs() < 1e-9).unwrap();
    let mut load = vec![0.0; solid.dofs()];
    load[3 * tip + 2] = 0.6 * COLUMN_BENDING;
    load[3 * tip + 1] = 0.2 * COLUMN_BENDING;
    let expected = solid.at_rest(6, 0.0, |_| load.clone()).unwrap();
    let forces = ExternalForces::dead(load);
    let settings = EquilibriumSettings::default();
    let found = equilibrium(&body, &forces, &nalgebra::Vector3::zeros(), None, &settings).unwrap().displacement;
    let largest = |a: &[f64], b: &[f64]| {
        let size = b.iter().fold(0.0_f64, |size, b| size.max(b.abs()));
        a.iter().zip(b).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs())) / size
    };
    assert!(largest(&found, &expected) < 1e-8, "{}", largest(&found, &expected));
    let bent: Vec<f64> = found.iter().enumerate().map(|(i, u)| u + 1e-4 * (i as f64).sin()).collect();
    let off = largest(&body.strain().internal_forces(&bent), &solid.internal_forces(&bent, &bent));
    assert!(off < 1e-11, "{off}");
}
