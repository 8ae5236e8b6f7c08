//! Nothing is counted twice: while a body hardly bends, large modes are what stiffening makes of them.

use std::path::{Path, PathBuf};

use dynamics::Observation;
use model::Model;
use scene::{Body, Choice, Effect, Large, LoadKind};
use verification::nonlinear::cases;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name).with_extension("toml")
}

/// A scene of examples/ with its text changed.
fn changed(name: &str, changes: &[(&str, &str)]) -> Body {
    let mut text = std::fs::read_to_string(example(name)).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{name} has no {from}");
        text = text.replace(from, to);
    }
    Body::parse(&text, example(name)).unwrap()
}

/// The motion with stiffening alone, or with this number of large modes.
fn run(body: &Body, large: usize) -> (Model, Vec<Observation>) {
    let mut body = body.clone();
    body.effects.refuse = false;
    body.effects.choices[Effect::LargeDeflection] = if large > 0 { Choice::On } else { Choice::Off };
    body.effects.choices[Effect::GeometricStiffening] = Choice::On;
    body.effects.choices[Effect::Coriolis] = Choice::On;
    body.effects.choices[Effect::DeformedInertia] = Choice::On;
    body.modes.large = (large > 0).then_some(Large::Count(large));
    let model = Model::build(&body, |_| ()).unwrap();
    assert_eq!(model.large_modes().len(), large);
    let rows = cases::rows(&body, &model).unwrap();
    (model, rows)
}

/// Difference of motions that are the same, over the peak.
const SAME: f64 = 1e-3;

/// With its initial deformation and its forces so small that it bends by 1e-5 of its length at most, as far as it does so
/// by itself.
fn made_small(mut body: Body) -> Body {
    let (model, rows) = run(&body, 0);
    let deflection = rows.iter().map(|row| model.deflection(&row.modal_displacement)).fold(0.0, f64::max);
    let part = (1e-5 / deflection).min(1.0);
    body.initial.modal_displacement.iter_mut().for_each(|q| *q *= part);
    body.initial.modal_velocity.iter_mut().for_each(|v| *v *= part);
    body.loads.iter_mut().filter(|load| load.kind == LoadKind::Force).for_each(|load| load.amplitude *= part);
    body
}

/// The largest distance of the large modes from what they are without being large, over the peak; that of the attitude, rad;
/// and the deflection over the length.
fn distance(scene: &Body, large: usize) -> [f64; 3] {
    let (model, without) = run(scene, 0);
    let (_, with) = run(scene, large);
    assert_eq!(without.len(), with.len());
    let (mut off, mut peak, mut turned, mut deflection) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (a, b) in without.iter().zip(&with) {
        for (a, b) in a.modal_displacement.iter().zip(&b.modal_displacement).take(large) {
            off = off.max((a - b).abs());
            peak = peak.max(a.abs());
        }
        turned = turned.max(a.attitude.angle_to(&b.attitude));
        deflection = deflection.max(model.deflection(&a.modal_displacement));
    }
    [off / peak, turned, deflection]
}

fn check(name: &str, body: &Body, large: usize, bound: f64) {
    let [off, turned, deflection] = distance(body, large);
    println!("{name}: {off:.1e} of the peak, {turned:.1e} rad; deflection {:.4} % of the length", 100.0 * deflection);
    assert!(off < bound && turned < 1e-3, "{name}: {off:e} {turned:e}");
}

/// Conserved: the same motion with and without large modes.
#[test]
#[ignore = "minutes: just nonlinear"]
fn small_motions_of_the_examples_are_the_same_with_large_modes() {
    let bars = ["free", "pin", "hinge", "clamp", "slider"].map(|name| format!("bar/{name}"));
    for name in &bars {
        check(name, &made_small(changed(name, &[])), 4, SAME);
    }
    check("plate", &made_small(changed("plate", &[("scheme = \"paper\"", "")])), 4, SAME);
    check("ring", &made_small(changed("ring", &[])), 4, SAME);
    check("accuracy/pulse", &made_small(changed("accuracy/pulse", &[])), 2, SAME);
}

/// Conserved: the same motion with and without large modes, of plates that spin, without what stretches them: a
/// stretching mode, or a static shape, rings from the undeformed start. Large modes feel its stress as it swings,
/// stiffening alone takes it as at rest, and that is no double count.
#[test]
#[ignore = "minutes: just nonlinear"]
fn spinning_plates_are_the_same_with_large_modes() {
    // At 60 rad/s the masses, half of which stand beside the plate, bend it a little. Stiffening without large modes has no initial
    // displacement, and shifts the frequencies of bent bodies by too little or too much: this is what it leaves out.
    let plates =
        [("accuracy/spin", 0.05), ("accuracy/tumbling", SAME), ("spinning_plate", SAME), ("tumbling_plate", SAME)];
    for (name, bound) in plates {
        let mut body = changed(name, &[("flexible = 10", "flexible = 7")]);
        body.modes.static_correction = Choice::Off;
        body.time.end = body.time.end.min(0.5);
        check(name, &made_small(body), 2, bound);
    }
}

/// Conserved: the same motion with and without large modes, of the two beams that are spun up, in a time ten times as
/// long, so that they lag by a tenth; at the end the spin has more than doubled their stiffness.
#[test]
#[ignore = "minutes: just nonlinear"]
fn beams_that_spin_up_slowly_are_the_same_with_large_modes() {
    for (name, end) in [("spin_up", "end = 30.0"), ("wu_haug", "end = 20.0")] {
        let slowly = "min(t, 150)/150 - sin(2*pi*min(t, 150)/150)/(2*pi)";
        let changes = [
            ("min(t, 15)/15 - sin(2*pi*min(t, 15)/15)/(2*pi)", slowly),
            ("discontinuities = [15.0]", "discontinuities = [150.0]"),
            (end, "end = 170.0"),
            ("interval = 0.02", "interval = 0.1"),
        ];
        let body = changed(name, &changes);
        check(name, &body, 4, SAME);
    }
}
