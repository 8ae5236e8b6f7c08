//! Modes about the rest of a body that spins freely.

use dynamics::{ConservativeBody, MotionState};
use faer::Mat;
use faer::linalg::solvers::Solve;
use model::{Builder, Checker, Model, StateCheck};
use nonlinear::StateErrorSettings;
use scene::{Body, Marker, MarkerPlace, Tie};

use crate::bodies::{BRACKET, CLAMP, CONED, CONSTANT, built};

/// The bracket, held by nothing, in a spin about the axis across its plane: a principal one.
fn spinning(modes: &str, spin: f64) -> Body {
    let initial = format!("[initial]\nangular_velocity = [0.0, 0.0, {spin:e}]\n");
    BRACKET.scene(modes, &initial)
}

/// Its first circular frequency.
fn first() -> f64 {
    built(&spinning("", 0.0)).body.circular_frequencies[0]
}

/// The modal displacements with which a model rests in its frame in the spin of its start.
fn resting(given: &Body, model: &Model) -> MotionState {
    let initial = model.initial(given);
    let body = ConservativeBody::new(&model.body, model.damping_ratios(), model.loads().to_vec(), &model.physics);
    let body = body.unwrap().beginning_at(&initial);
    let at = |q: &[f64]| MotionState {
        time: 0.0,
        attitude: initial.attitude,
        origin_global: initial.origin.unwrap_or(model.body.origin),
        velocity_global: initial.velocity,
        omega_body: initial.omega,
        modal_displacement: q.to_vec(),
        modal_velocity: vec![0.0; q.len()],
    };
    let acceleration = |q: &[f64]| body.observed_at(&at(q), &[]).unwrap().modal_acceleration;
    let nf = model.body.flexible();
    // A body of about 1 kg is moved by about this.
    let step = 1e-6;
    let mut q = vec![0.0; nf];
    for _ in 0..20 {
        let slopes: Vec<Vec<f64>> = (0..nf)
            .map(|k| {
                let [ahead, back] = [step, -step].map(|by| {
                    let mut moved = q.clone();
                    moved[k] += by;
                    acceleration(&moved)
                });
                ahead.iter().zip(back).map(|(ahead, back)| (ahead - back) / (2.0 * step)).collect()
            })
            .collect();
        let here = acceleration(&q);
        let by = Mat::from_fn(nf, nf, |i, k| slopes[k][i]).partial_piv_lu().solve(Mat::from_fn(nf, 1, |i, _| -here[i]));
        q.iter_mut().enumerate().for_each(|(k, q)| *q += by[(k, 0)]);
        if by.norm_max() < 1e-13 {
            break;
        }
    }
    at(&q)
}

/// The rest of a model in its spin, checked by the full body.
fn rest(given: &Body) -> (Model, StateCheck) {
    let model = built(given);
    let settings = StateErrorSettings { small: 0.0, max_factors: 12, ..StateErrorSettings::converged() };
    let full = Builder::default().full(given, |_| ()).unwrap().unwrap();
    let body = full.body().unwrap();
    let checker = Checker::new(&full, given, &model, &body).unwrap();
    let check = checker.check(&resting(given, &model), &[], &settings, false).unwrap();
    (model, check)
}

/// Independent reference: the full nonlinear body, free to move as a whole. At the reference the model rests where it does, with
/// any number of modes.
#[test]
fn a_free_body_rests_in_the_reference() {
    for part in [0.3, 0.6] {
        let (model, check) = rest(&spinning("about = \"spin\"\n", part * first()));
        assert!(model.meshed.as_ref().unwrap().reference.is_some());
        let tip = &check.points[0];
        println!(
            "free bracket at {part}: tip {:?} off by {:.2e}, body {:.2e}",
            tip.displacement, tip.relative, check.error
        );
        assert!(tip.relative < 1e-8 && check.error < 1e-8, "{part}: {check:?}");
    }
}

/// Independent reference: as above. The spin is another one than that of the reference; about the undeformed body the errors are 0.2, 0.4,
/// 0.9 and 1.8 %.
#[test]
fn about_the_reference_a_free_body_may_spin_at_another_speed() {
    let spin = 0.5 * first();
    let about = format!("about = {{ angular_velocity = [0.0, 0.0, {spin:e}] }}\n");
    for (change, bound) in [(-0.3, 4e-3), (-0.1, 3.5e-4), (0.1, 3e-4), (0.3, 2.5e-3)] {
        let error = |modes: &str| rest(&spinning(modes, (1.0 + change) * spin)).1.error;
        let (with, without) = (error(&about), error(""));
        println!("free bracket, spin changed by {change}: off by {with:.3e}, {without:.3e} without a reference");
        assert!(with < bound && (change < -0.2 || with < 0.2 * without), "{change}: {with} {without}");
    }
}

/// Independent reference: as above. Moments at both ends that balance bend a rod that nothing holds: they have one static answer together.
#[test]
fn moments_at_both_ends_bend_a_free_rod() {
    for (angle, bound) in [(0.2, 1.5e-4), (0.5, 1.6e-3)] {
        // E I/L.
        let moment = angle * 2e9 * 0.02_f64.powi(4) / 12.0;
        let load = |at: f64, moment: f64| {
            format!(
                "[[loads]]\nkind = \"moment\"\nat = [{at}, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = {moment:e}\n\
                 history = {CONSTANT}\n"
            )
        };
        let mut scene =
            CONED.scene("", &format!("large_deflection = true\n{}{}", load(1.0, moment), load(0.0, -moment)));
        // Before it could turn fast, as each of them alone would have it.
        scene.time.end = 1e-4;
        let (model, check) = rest(&scene);
        assert!(model.meshed.as_ref().unwrap().modes.answer.is_some(), "{:?}", model.large_modes());
        // A scene that begins with amplitudes has the modes themselves as coordinates.
        scene.initial.modal_displacement = vec![0.0];
        let (_, without) = rest(&scene);
        println!(
            "free rod to {angle} rad: large {:?}, off by {:.2e}, {:.2e} without the answer",
            model.large_modes(),
            check.error,
            without.error
        );
        assert!(check.error < bound && check.error < 0.1 * without.error, "{angle}: {} {}", check.error, without.error);
    }
}

/// Conserved: the steady spin. The motion begins in the reference, and stays there: its forces are in balance in the equations of motion, of
/// momentum, too.
#[test]
fn a_free_body_goes_on_in_its_reference() {
    let body = spinning("about = \"spin\"\n", 0.5 * first());
    let model = built(&body);
    let mut simulation = model.start(&body).unwrap();
    let moved = |o: &dynamics::Observation| o.points[0].elastic_displacement_body;
    let begun = moved(&simulation.next().unwrap().unwrap());
    assert!(begun.norm() > 0.01);
    for row in simulation.take(400) {
        let now = moved(&row.unwrap());
        assert!((now - begun).norm() < 1e-4 * begun.norm(), "{now} {begun}");
    }
}

/// A body that tumbles has no rest; `"auto"` does without.
#[test]
fn a_free_body_that_tumbles_has_no_reference() {
    let tumbling = |about: &str| BRACKET.scene(about, "[initial]\nangular_velocity = [20.0, 0.0, 30.0]\n");
    let refused = Model::build(&tumbling("about = \"spin\""), |_| ()).unwrap_err().to_string();
    assert!(refused.contains("about no principal axis") && refused.contains("tumbles"), "{refused}");
    assert!(built(&tumbling("about = \"auto\"")).meshed.unwrap().reference.is_none());
    let loads = Model::build(&tumbling("about = \"loads\""), |_| ()).unwrap_err().to_string();
    assert!(loads.contains("its spin alone"), "{loads}");
}

/// Forces of joints at markers are not known before the motion: the rest without them would be another one.
#[test]
fn a_body_with_markers_has_no_reference() {
    let tip = Marker { name: "tip".to_owned(), place: MarkerPlace::Point(BRACKET.tip), tie: Tie::Mean, axes: None };
    let pushed = format!("{CLAMP}{}", BRACKET.force([0.0, -1.0, 0.0], 30.0, CONSTANT));
    for (about, rest) in [("spin", "[initial]\nangular_velocity = [0.0, 0.0, 30.0]\n"), ("loads", &*pushed)] {
        let scene = BRACKET.scene(&format!("about = \"{about}\""), rest);
        let marked = Body { markers: vec![tip.clone()], ..scene };
        let refused = Model::build(&marked, |_| ()).unwrap_err().to_string();
        assert!(refused.contains("a body with markers") && refused.contains("remove `about`"), "{refused}");
    }
    let scene = BRACKET.scene("about = \"auto\"", &pushed);
    let marked = Body { markers: vec![tip], ..scene.clone() };
    let has_reference = |scene: &Body| built(scene).meshed.unwrap().reference.is_some();
    assert!(has_reference(&scene) && !has_reference(&marked));
}
