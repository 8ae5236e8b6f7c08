//! Which modes `large_deflection = "auto"` takes, and how far they may bend the body.

use advice::Refusal;
use model::Model;

use crate::strain::manifold::plate;
use crate::{CLAMPED, DENSITY, LENGTH, YOUNG, bar, build, rigid};

const TIME: &str = "end = 0.25\nstep = 1e-4";

fn large(effects: &str, initial: &str, time: &str) -> Vec<usize> {
    plate("", effects, initial, time).1.large_modes().to_vec()
}

#[test]
fn auto_takes_the_modes_whose_amplitudes_call_for_it_and_no_others() {
    // 18 mm of 1 m in the first mode, six periods: 0.8 % of the frequency, 0.3 rad. A hundredth of it: 3e-5 rad.
    assert_eq!(large("", "modal_displacement = [0.5]", TIME), [0]);
    assert_eq!(large("", "modal_displacement = [0.005]", TIME), [] as [usize; 0]);
    // The same deflection over less than a hundredth of a period is not out of phase, but held by other forces.
    assert_eq!(
        large("[effects]\ntolerance = 0.01", "modal_displacement = [0.5]", "end = 1e-4\nstep = 1e-4"),
        [] as [usize; 0]
    );
    // Each for its own sake.
    assert_eq!(large("", "modal_displacement = [0.0, 0.0, 0.3]", TIME), [2]);
    assert_eq!(large("", "modal_displacement = [0.5, 0.0, 0.3]", TIME), [0, 2]);
}

#[test]
fn auto_leaves_it_off_where_it_cannot_be_or_is_not_wanted() {
    let far = "modal_displacement = [0.5]";
    assert_eq!(large("[effects]\nlarge_deflection = false", far, TIME), [] as [usize; 0]);
    assert_eq!(large("[effects]\ngeometric_stiffening = false", far, TIME), [] as [usize; 0]);
    for scheme in ["paper", "rkmk4\"\nformulation = \"paper"] {
        let time = format!("{TIME}\nscheme = \"{scheme}\"");
        assert_eq!(large("", far, &time), [] as [usize; 0]);
        // A refusal in words, before anything is built.
        let text = format!("[effects]\nlarge_deflection = true\n[time]\n{time}");
        let found = scene::Body::parse(&crate::strain::large::whole(&text), "scene.toml").unwrap_err().to_string();
        assert!(found.contains("large_deflection = true` with the paper's formulation"), "{found}");
    }
    assert_eq!(build(&rigid("", "end = 1.0\nstep = 1e-2")).large_modes(), [] as [usize; 0]);
}

/// A scene without initial state.
fn whole(rest: &str) -> String {
    format!(
        "title = \"x\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = \"x.msh\"\n\
         material = {{ young_modulus = 1.0, poisson_ratio = 0.3, density = 1.0 }}\n[modes]\nflexible = 4\n{rest}"
    )
}

/// Independent reference: nonlinear finite elements that were given with the project.
#[test]
fn the_advice_says_what_linear_strain_gets_wrong_of_each_mode() {
    let (_, model) = plate("", "", "modal_displacement = [0.5]", TIME);
    let error = model.advice.modes[0].strain.unwrap();
    // Nonlinear finite elements: 0.799 % of the frequency at this amplitude.
    assert!((error.frequency / -0.00799 - 1.0).abs() < 0.02, "{error:?}");
    let phase = 0.00799 * 0.25 * model.body.circular_frequencies[0];
    assert!((error.phase / phase - 1.0).abs() < 0.02 && (0.017..0.021).contains(&error.deflection), "{error:?}");
    let row = &model.advice.effects[dynamics::Effect::LargeDeflection];
    assert!(
        row.on && row.why.contains("Mode 1 moves the body by up to 18.59 mm") && row.why.contains("too high"),
        "{row:?}"
    );
    // Nothing is computed for the modes that do not move.
    assert!(model.advice.modes[1..].iter().all(|mode| mode.strain.is_none()), "{:?}", model.advice.modes);
}

/// A clamped bar with its first mode displaced by a part of its length.
fn bent(part: f64, rest: &str) -> Model {
    let at = |q: f64| {
        build(&bar(
            "flexible = 4\nlarge = 2",
            &format!("{CLAMPED}[initial]\nmodal_displacement = [{q:e}]\n{rest}"),
            "end = 1e-3\nstep = 1e-5",
        ))
    };
    let one = at(1e-9).deflection(&[1.0, 0.0, 0.0, 0.0]);
    at(part / one)
}

#[test]
fn a_body_that_is_bent_by_more_than_its_length_is_refused() {
    assert!(bent(0.3, "").refusal.is_none() && bent(0.9, "").refusal.is_none());
    let Some(refusal @ Refusal::Deflected { deflection }) = bent(1.1, "").refusal else { panic!() };
    assert!((deflection - 1.1).abs() < 1e-9, "{refusal}");
}

/// Closed form: ¼ √(E/ρ)/L of a rod. A mode that stretches the bar moves far enough to be large by itself, but
/// bending draws it in: it is not large, and its frequency goes with its amplitude as that of any mode that is not.
#[test]
fn a_mode_that_others_draw_in_is_not_large_and_its_backbone_is_kept() {
    let model = |initial: &[f64]| {
        let initial = format!("[initial]\nmodal_displacement = {initial:?}\n[effects]\nrefuse = false\n");
        build(&bar(
            "flexible = 10\nstatic_correction = false",
            &format!("{CLAMPED}{initial}"),
            "end = 0.05\nstep = 1e-5",
        ))
    };
    let at_rest = model(&[0.0]);
    let rod = 0.25 * (YOUNG / DENSITY).sqrt() / LENGTH;
    let stretches = at_rest.natural_frequencies().iter().position(|f| (f / rod - 1.0).abs() < 1e-2).unwrap();
    let at = |mode: usize, part: f64| {
        let mut one = vec![0.0; 10];
        one[mode] = 1.0;
        part / at_rest.deflection(&one)
    };
    let mut far = vec![0.0; 10];
    (far[0], far[stretches]) = (at(0, 0.1), at(stretches, 0.05));
    let bent = model(&far);
    println!("{stretches} {:?} {:?}", bent.large_modes(), bent.backbones());
    // Two are advised at the most: of a square section the pair that bends.
    assert_eq!(bent.advice.large_modes(10), [0, 1]);
    assert!(bent.large_modes().contains(&0) && !bent.large_modes().contains(&stretches), "{:?}", bent.large_modes());
    assert!(bent.backbones()[stretches].is_some() && bent.backbones()[0].is_none(), "{:?}", bent.backbones());
}
