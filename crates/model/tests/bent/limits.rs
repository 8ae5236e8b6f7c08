//! Refusals of a model that has no rest, and the answer of the full body there.

use advice::{Refusal, RestOfBody};
use model::Model;
use nonlinear::StateErrorSettings;
use scene::{Body, Choice, Effect};

use crate::bodies::{BLADE, CLAMP, CONSTANT, Solid, built, checked};

const COLUMN: Solid = Solid { mesh: "column", tip: [1.0, 0.0, 0.0], axis: [0.0, 0.0, 1.0] };

impl Solid {
    /// The scene of a beginner: nothing is said of the model.
    fn plain(&self, rest: &str) -> Body {
        let mut body = self.scene("", rest);
        body.modes.static_correction = Choice::Auto;
        body.effects.refuse = true;
        body
    }
}

/// The tip's displacement in the full body, the relative error of the model's, and the number of directions in which the body has lost
/// its stiffness.
fn tip(body: &Body) -> (f64, f64, Option<usize>) {
    let (_, check) = checked(body, &StateErrorSettings::converged());
    let moved = check.points[0].displacement.iter().map(|u| u * u).sum::<f64>().sqrt();
    (moved, check.points[0].relative, check.negative_directions)
}

/// Independent reference: the full nonlinear body. Linear modes have no rest from 0.59 of the first frequency on; the body stands and
/// stiffens, and so does the model that the program takes by itself: it is not refused, and is right.
#[test]
fn a_swept_blade_is_not_refused_where_linear_modes_have_no_rest() {
    for (part, bound) in [(0.59, 0.002), (1.0, 0.01), (2.0, 0.04)] {
        let body = BLADE.plain(&BLADE.driven(part * BLADE.first()));
        let model = built(&body);
        assert_eq!(model.refusal, None, "at {part}");
        assert!(model.start(&body).is_ok(), "at {part}");
        let (moved, error, negative) = tip(&body);
        println!("blade at {part}: large {:?}, tip {moved:.4} m, off by {:.4} %", model.large_modes(), 100.0 * error);
        assert!(error < bound && negative == Some(0), "at {part}: {error} {negative:?}");
    }
}

/// Independent reference: the rest of the full body by another way, the check of a model with large modes.
#[test]
fn a_model_without_a_rest_is_refused_with_that_of_the_full_body() {
    let mut body = BLADE.plain(&BLADE.driven(1.2 * BLADE.first()));
    let (moved, ..) = tip(&body);
    body.effects.choices[Effect::LargeDeflection] = Choice::Off;
    body.effects.choices[Effect::GeometricStiffening] = Choice::Off;
    let model = built(&body);
    let Some(Refusal::Indefinite { of_body: RestOfBody::Stable { displacement }, spin, critical, stiffening: false }) =
        model.refusal
    else {
        panic!("{:?}", model.refusal)
    };
    println!("rest of the full body: {displacement} {moved}");
    // The tip is the node that moves most but for corners of its face.
    assert!(spin > critical && (1.0..1.1).contains(&(displacement / moved)), "{displacement} {moved}");
    let said = model.start(&body).err().unwrap().to_string();
    assert!(said.contains("the full body of the mesh has a stable one"), "{said}");
    body.effects.refuse = false;
    assert!(Model::build(&body, |_| ()).unwrap().start(&body).is_ok());
}

/// Closed form: the Euler load of a column, π² E I / (4 L²), of which a square section has two.
#[test]
fn a_column_beyond_its_euler_load_is_refused_by_the_pivots_of_the_full_body() {
    let euler = std::f64::consts::PI.powi(2) * 2e9 * 0.025_f64.powi(4) / 12.0 / 4.0;
    let pushed = |times: f64| {
        let push = COLUMN.force([-1.0, 0.0, 0.0], times * euler, CONSTANT);
        COLUMN.plain(&format!("{CLAMP}{push}"))
    };
    let below = built(&pushed(0.9));
    assert_eq!(below.refusal, None);
    let mut beyond = pushed(1.1);
    match built(&beyond).refusal {
        Some(Refusal::Diverges { of_body: RestOfBody::Unstable { directions: 2 }, .. }) => {}
        other => panic!("{other:?}"),
    }
    // A model that knows nothing of the stress runs on. The check of its rest knows.
    beyond.effects.choices[Effect::GeometricStiffening] = Choice::Off;
    beyond.effects.choices[Effect::LargeDeflection] = Choice::Off;
    assert_eq!(built(&beyond).refusal, None);
    let (_, error, negative) = tip(&beyond);
    println!("column at 1.1: off by {error:e}");
    assert_eq!(negative, Some(2));
    let mut below = pushed(0.9);
    below.effects.choices = beyond.effects.choices;
    assert_eq!(tip(&below).2, Some(0));
}
