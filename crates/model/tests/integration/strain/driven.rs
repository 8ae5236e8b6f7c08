//! A slider that a drive pushes along the bar: its lowest modes bend and hold nothing of the answer.

use advice::{Broken, Review};
use model::Model;

use crate::{Body, DENSITY, LENGTH, YOUNG, bar, build, observations, point};

const ACCELERATION: f64 = 5e6;
/// −ρaL²/2E at the tip.
const EXACT: f64 = -DENSITY * ACCELERATION * LENGTH * LENGTH / (2.0 * YOUNG);

fn pushed() -> String {
    format!(
        "[[constraints]]\nkind = \"slider\"\ngroup = \"root\"\ndirection = [1.0, 0.0, 0.0]\n\
         motion = {{ amplitude = {ACCELERATION:e}, history = {{ kind = \"expression\", formula = \"t\" }} }}"
    )
}

/// Critically damped, so that it comes to rest in the frame of the slide; `time` ends with the scheme.
fn driven(modes: &str, time: &str) -> Body {
    bar(&format!("{modes}\ndamping_ratio = 1.0"), &pushed(), &format!("end = 2e-3\n{time}"))
}

/// How far the tip is shortened at the end over theory, what the review says, and the reason in the row of static shapes.
fn shortened(body: &Body) -> (Model, f64, Vec<Broken>, String) {
    let model = build(body);
    let initial = model.initial(body);
    let mut review = Review::new(model.case(body, &initial), model.physics.effects, &model.advice);
    let rows = observations(body, &model);
    rows.iter().for_each(|row| review.observe(row).unwrap());
    let found = point(&model, rows.last().unwrap(), "tip").elastic_displacement_body.x / EXACT;
    let (broken, why) = (review.broken(), model.advice.static_correction.why.clone());
    (model, found, broken, why)
}

/// Closed form: −ρaL²/2E.
#[test]
fn the_default_scheme_takes_a_static_shape_for_the_push() {
    // Of modes that are searched for, one is along the bar.
    for (modes, shapes) in [("flexible = 4", 1), ("flexible = \"auto\"", 0)] {
        let (model, found, broken, why) = shortened(&driven(modes, "step = 1e-5"));
        println!("{modes}: {} {found} {broken:?} {why}", model.static_shapes());
        // The root is held in its plane, too.
        assert!(model.static_shapes() == shapes && (found - 1.0).abs() < 0.01, "{modes}: {found}");
        assert!(broken.is_empty() && !why.contains("lacks"), "{modes}: {broken:?} {why}");
    }
}

/// Closed form: −ρaL²/2E, of which nothing is there.
#[test]
fn where_the_scheme_does_not_take_it_advice_and_review_say_that_the_answer_lacks_it() {
    let (model, found, broken, why) = shortened(&driven("flexible = 4", "step = 2e-6\nscheme = \"rkmk4\""));
    println!("{found} {broken:?} {why}");
    assert!(model.static_shapes() == 0 && found.abs() < 1e-3, "{found}");
    let [Broken::Stretch { left_out, influence, of_drive: true, .. }] = broken[..] else { panic!("{broken:?}") };
    assert!(left_out > 0.99 && influence > 0.9, "{left_out} {influence}");
    assert!(why.contains("acceleration of the drive") && why.contains("lacks"), "{why}");
}

/// Conserved: the stress that is left out in the frame of the slide.
#[test]
fn the_stress_that_is_left_out_is_that_of_a_base_which_is_shaken() {
    let shaken = format!(
        "{}[[loads]]\nkind = \"base-acceleration\"\ndirection = [1.0, 0.0, 0.0]\namplitude = {ACCELERATION:e}\n\
         history = {{ kind = \"constant\" }}",
        crate::CLAMPED
    );
    let left_out = [pushed(), shaken].map(|rest| {
        let scene = bar(
            "flexible = 4\nstatic_correction = false",
            &format!("{rest}\n[output]\npeak_stress = true"),
            "end = 1e-5\nstep = 1e-5",
        );
        let model = build(&scene);
        let rows = observations(&scene, &model);
        model.stress.as_ref().unwrap().peak(rows.last().unwrap()).unwrap().max_left_out
    });
    println!("{left_out:?}");
    // The stress at the root is ρaL, and more in its corners.
    assert!(left_out[0] > DENSITY * ACCELERATION * LENGTH, "{left_out:?}");
    assert!((left_out[0] / left_out[1] - 1.0).abs() < 1e-9, "{left_out:?}");
}
