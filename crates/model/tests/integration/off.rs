//! Effects that are off are not computed.

use std::time::Duration;

use advice::{Refusal, RestOfBody};
use dynamics::{ConservativeBody, Effect};
use model::{Builder, Needs};

use crate::{BENDING, BREADTH, Body, BuildProgress, CLAMPED, LENGTH, Model, YOUNG, bar, build};

const TIME: &str = "end = 1e-3\nstep = 1e-5";
const SPIN: &str = "[initial]\nangular_velocity = [0.0, 0.0, 300.0]\n";

/// Six modes and these effects.
fn effects(which: &str, rest: &str) -> Body {
    bar("flexible = 6\nstatic_correction = false\ndamping_ratio = 0.01", &format!("[effects]\n{which}\n{rest}"), TIME)
}

/// All effects of a spin but one.
fn without(off: &str) -> Model {
    let all = ["deformed_inertia", "coriolis", "geometric_stiffening"];
    let switched: Vec<String> = all.iter().map(|effect| format!("{effect} = {}", *effect != off)).collect();
    build(&effects(&switched.join("\n"), SPIN))
}

/// The numbers that an evaluation of the rates goes through.
fn entries(model: &Model) -> usize {
    let loads = model.loads().to_vec();
    ConservativeBody::new(&model.body, model.damping_ratios(), loads, &model.physics).unwrap().matrix_entries()
}

#[test]
fn each_effect_that_is_off_leaves_its_matrices_out() {
    let all = without("nothing");
    assert!(all.body.stress_stiffness.is_some());
    // Three G_i and six N_ij.
    assert_eq!(entries(&all), 9 * 36);

    let unstiffened = without("geometric_stiffening");
    assert!(unstiffened.body.stress_stiffness.is_none() && !unstiffened.is_stressed());
    assert!(!unstiffened.physics.effects[Effect::GeometricStiffening]);

    assert_eq!(entries(&without("coriolis")), 6 * 36);
    let stiff = without("deformed_inertia");
    assert!(stiff.body.stress_stiffness.is_none());
    assert_eq!(entries(&stiff), 3 * 36);
    let pushed = "[[loads]]\nkind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 9.0";
    let straight = build(&effects("rotation = false", pushed));
    assert!(straight.body.stress_stiffness.is_none());
    assert_eq!(entries(&straight), 0);
    assert_eq!(entries(&build(&effects("", CLAMPED))), 0);
}

/// The stress of a weight is nothing to a short bar; a strong pull is something.
#[test]
fn the_stress_of_steady_loads_counts_where_it_matters() {
    let weight = "[[loads]]\nkind = \"gravity\"\ndirection = [1.0, 0.0, 0.0]\namplitude = 9810.0";
    let pull = "[[loads]]\nkind = \"pressure\"\ngroup = \"tip\"\namplitude = -20.0";
    let built = |on: &str, load: &str| build(&effects(on, &format!("{CLAMPED}{load}")));
    assert!(!built("", weight).is_stressed());
    let pulled = built("", pull);
    assert!(pulled.is_stressed() && entries(&pulled) == 2 * 36);
    assert!(pulled.advice.effects[Effect::GeometricStiffening].on);
    assert!(built("geometric_stiffening = true", weight).is_stressed());
    assert!(!built("geometric_stiffening = false", pull).is_stressed());
}

/// Closed form: Euler's load of a column that is clamped at one end, π² E I/4 L², presses on its tip. The model is refused where its own
/// stiffness is gone, and the message says what the full body does there.
#[test]
fn a_model_without_a_stable_rest_is_refused_with_what_the_full_body_does() {
    let euler = (std::f64::consts::PI / LENGTH).powi(2) * YOUNG * BENDING / 4.0;
    let pressed = |part: f64, modes: usize| {
        let traction = part * euler / (BREADTH * BREADTH);
        let load = format!(
            "[[loads]]\nkind = \"traction\"\ngroup = \"tip\"\ndirection = [-1.0, 0.0, 0.0]\namplitude = {traction}"
        );
        let modes = format!("flexible = {modes}\nstatic_correction = false\ndamping_ratio = 0.01");
        build(&bar(&modes, &format!("{CLAMPED}{load}"), TIME)).refusal
    };
    // The first mode alone loses its stiffness at 1.03 of Euler's load or so.
    for modes in [1, 2, 4, 12] {
        assert_eq!(pressed(0.97, modes), None);
        let refusal = pressed(1.1, modes).unwrap();
        let Refusal::Diverges { of_body: RestOfBody::Unstable { directions: 2 }, .. } = refusal else {
            panic!("{modes}: {refusal:?}")
        };
        let text = refusal.to_string();
        assert!(text.contains("the model has no stable rest") && text.contains("negative in 2 direction(s)"), "{text}");
    }
    // A pull does not.
    assert_eq!(pressed(-3.0, 4), None);
}

#[test]
fn a_body_that_does_not_deform_has_no_modes_and_asks_for_none() {
    let mut asked = 0;
    let body = effects("flexibility = false", SPIN);
    let model = Model::build(&body, |progress| {
        asked += usize::from(matches!(progress, BuildProgress::Modes(_)));
    })
    .unwrap();
    assert_eq!((model.body.flexible(), model.damping_ratios().len(), entries(&model)), (0, 0, 0));
    assert_eq!(asked, 0);
    assert!(model.body.stress_stiffness.is_none() && !model.is_stressed());
}

/// Without a spin, a load or a correction, nothing static is solved for.
#[test]
fn nothing_static_is_computed_where_nothing_asks_for_it() {
    for (modes, rest) in [
        ("flexible = 4", ""),
        ("flexible = 4", CLAMPED),
        (
            "flexible = 4\nstatic_correction = false",
            "[effects]\ngeometric_stiffening = false\n[initial]\nangular_velocity = [0.0, 0.0, 300.0]",
        ),
    ] {
        let mut statics = 0;
        let model = Model::build(&bar(modes, rest, TIME), |progress| {
            statics += usize::from(progress == BuildProgress::Statics);
        })
        .unwrap();
        assert_eq!(statics, 0, "{modes} {rest}");
        assert_eq!(model.times.statics, Duration::ZERO);
        assert!(model.body.stress_stiffness.is_none());
    }
    let mut statics = 0;
    Model::build(&effects("", SPIN), |progress| statics += usize::from(progress == BuildProgress::Statics)).unwrap();
    assert_eq!(statics, 1);
}

#[test]
fn loads_of_gravity_that_are_off_are_not_there() {
    let falls = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n\
                 [[loads]]\nkind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 9.0";
    assert_eq!(build(&effects("", &format!("{CLAMPED}{falls}"))).loads().len(), 2);
    assert_eq!(build(&effects("gravity = false", &format!("{CLAMPED}{falls}"))).loads().len(), 1);
}

#[test]
fn under_unknown_forces_nothing_is_left_out_but_what_the_scene_switches_off() {
    let faint = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 1e-9\n\
                 [[loads]]\nkind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 9.0";
    for (which, rest, loads, ratios) in [
        ("", CLAMPED.to_owned(), [0, 0], [0.0, 0.01]),
        ("", format!("{CLAMPED}{faint}"), [1, 2], [0.01, 0.01]),
        ("damping = false\ngravity = false", format!("{CLAMPED}{faint}"), [1, 1], [0.0, 0.0]),
    ] {
        let body = effects(which, &rest);
        let alone = build(&body);
        assert_eq!(alone.loads().len(), loads[0], "{which} {rest}");
        assert_eq!(alone.damping_ratios(), [ratios[0]; 6], "{which} {rest}");
        let (physics, of_scene, damping_ratios) = alone.under_unknown_forces(&body);
        assert_eq!(of_scene.len(), loads[1], "{which} {rest}");
        assert_eq!(damping_ratios, [ratios[1]; 6], "{which} {rest}");

        let full = Builder::default().needing(Needs::external_inputs()).build(&body, |_| ()).unwrap();
        assert_eq!(physics.effects, full.physics.effects, "{which} {rest}");
        assert_eq!(of_scene.len(), full.loads().len(), "{which} {rest}");
        assert_eq!(damping_ratios, full.damping_ratios(), "{which} {rest}");
    }
}

#[test]
fn gravity_is_found_by_its_kind_wherever_it_stands_among_the_loads() {
    let weight =
        |size: &str| format!("[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = {size}\n");
    let push = "[[loads]]\nkind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 9.0\n";
    let forces = |choice: &str, loads: &str| -> Vec<f64> {
        let model = build(&effects(choice, &format!("{CLAMPED}{loads}")));
        model.loads().iter().map(|load| load.pattern().unwrap().vector.z).collect()
    };
    let faint = weight("1e-9");
    for loads in [format!("{faint}{push}"), format!("{push}{faint}")] {
        for choice in ["", "gravity = \"auto\"", "gravity = false"] {
            assert_eq!(forces(choice, &loads), [9.0], "{choice} {loads}");
        }
        assert_eq!(forces("gravity = true", &loads).len(), 2, "{loads}");
    }
    assert!(matches!(forces("", &format!("{}{push}", weight("9810.0")))[..], [down, 9.0] if down < 0.0));
}
