//! A warning means something: a run that is right ends without one.

use std::process::Command;

use flexframe::advice::Refusal;
use flexframe::advise::advise;
use flexframe::columns::COLUMNS;
use flexframe::dynamics::Rows;
use flexframe::model::{Builder, Cache, Model};
use flexframe::modes::{modes, reduce};
use flexframe::run::{RunError, RunReport, RunSettings, results_path, run};
use flexframe::scene::{Body, Scene};
use flexframe::surface::Surface;
use results::{Results, unfinished};

const UNITS: &str = "title = \"x\"\nunits = { length = \"mm\", mass = \"Mg\", time = \"s\" }\n";

fn scene(text: &str) -> Body {
    Body::parse(&format!("{UNITS}{text}"), "scene.toml").unwrap()
}

fn report(text: &str) -> RunReport {
    let folder = tempfile::tempdir().unwrap();
    let report = run(&scene(text).into(), folder.path(), &RunSettings::default(), |_| ()).unwrap().1;
    // The results file has them, too.
    assert_eq!(Results::open(&report.results, &COLUMNS).unwrap().metadata.warnings, report.warnings);
    report
}

/// A ring of this Young's modulus.
fn ring(young: f64, rest: &str) -> String {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/ring.msh");
    format!(
        "[body]\nmesh = \"{mesh}\"\n\
         material = {{ young_modulus = {young:e}, poisson_ratio = 0.3, density = 7.8e-9 }}\n[modes]\nflexible = 6\n{rest}"
    )
}

/// Conserved: the balance of energy of a rigid body of mass 1 under a force of 50 Hz, with rows on whole periods,
/// where it stands still.
#[test]
fn of_a_shaken_rigid_body() {
    let report = report(
        "[body.rigid]\nmass = 1.0\ncenter_of_mass = [0.0, 0.0, 0.0]\n\
         inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n\
         [[loads]]\nkind = \"force\"\nat = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\namplitude = 1.0\n\
         history = { kind = \"sine\", frequency = 50.0, phase = 1.5707963267948966 }\n\
         [time]\nend = 20.0\nstep = 1e-3\n[output]\ninterval = 0.1\n",
    );
    // Measured: 4.2e-6 of what came and went.
    assert!(report.bodies[0].balances.energy < 1e-4 && report.warnings.is_empty(), "{:?}", report.warnings);
}

/// Closed form: −gt²/2. Gravity neither turns a soft body nor bends it: what its modes do is rounding.
#[test]
fn of_a_body_that_falls() {
    let report = report(&ring(
        1e3,
        "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n\
         [time]\nend = 0.1\ntolerance = 1e-6\n[output]\ninterval = 0.01\n",
    ));
    assert!(
        (report.bodies[0].moved[2] + 0.5 * 9810.0 * 0.01).abs() < 1e-6 && report.warnings.is_empty(),
        "{:?}",
        report.warnings
    );
}

/// Closed form: steps of 1/ω, by which RK4 takes the energy of an undamped mode times 1 − 1/72 + 1/576, a hundred
/// times.
#[test]
fn of_a_mode_that_dies_of_the_scheme_there_are_two() {
    let rest = |step: f64| {
        format!(
            "[initial]\nmodal_velocity = [0.0, 0.0, 0.0, 0.0, 0.0, 1e-3]\n\
             [time]\nend = {:e}\nstep = {step:e}\nscheme = \"rkmk4\"\n",
            100.0 * step
        )
    };
    let model = Model::build(&scene(&ring(210e3, &rest(1e-6))), |_| ()).unwrap();
    let report = report(&ring(210e3, &rest(1.0 / model.body.circular_frequencies[5])));
    let lost = 1.0 - (1.0_f64 - 1.0 / 72.0 + 1.0 / 576.0).powi(100);
    assert!(
        (report.bodies[0].balances.energy / lost - 1.0).abs() < 1e-3,
        "{:e} {lost:e}",
        report.bodies[0].balances.energy
    );
    let [steps, balance] = &report.warnings[..] else { panic!("{:?}", report.warnings) };
    assert!(steps.contains("mode 6 is the worst") && steps.contains("shorter steps"), "{steps}");
    assert!(balance.contains("open by 7.1e-1") && balance.contains("fewer modes"), "{balance}");
}

/// By the default scheme a spinning ring widens; `rkmk4` says that it has not got the shapes for it, before and after.
#[test]
fn of_a_stretch_that_the_modes_do_not_hold() {
    let spin = |scheme: &str| {
        ring(
            210e3,
            &format!(
                "[initial]\nangular_velocity = [0.0, 0.0, 50.0]\n\
                 [time]\nend = 0.01\nstep = 1e-5\nscheme = \"{scheme}\"\n[output]\ninterval = 1e-3\n"
            ),
        )
    };
    let table = |text: &str| advise(&scene(text).into(), &Builder::default(), false, |_| ()).unwrap().to_string();
    let (with, without) = (spin("exponential"), spin("rkmk4"));
    assert!(report(&with).warnings.is_empty() && !table(&with).contains("lacks"));
    let report = report(&without);
    let [warning] = &report.warnings[..] else { panic!("{:?}", report.warnings) };
    assert!(
        warning.contains("left out")
            && warning.contains("static response to the spin")
            && warning.contains("static_correction = true"),
        "{warning}"
    );
    assert!(report.to_string().contains(warning.as_str()));
    let table = table(&without);
    assert!(table.contains("The answer lacks") && table.contains("off, may matter"), "{table}");
}

/// The plate of the paper with its first mode at 5 % of its length, through zero at every row; with linear strain.
fn bent_plate(part: f64, rest: &str) -> String {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/plate.msh");
    // Mass-normalised, 1 mm at the ends is 0.1 of the modal coordinate or so; the first frequency without masses is 50 Hz.
    format!(
        "[body]\nmesh = \"{mesh}\"\nmaterial = {{ young_modulus = 70e3, poisson_ratio = 0.33, density = 2.7e-9 }}\n\
         [modes]\nflexible = 4\ndamping_ratio = 0.0\n[effects]\nlarge_deflection = false\n\
         [initial]\nmodal_displacement = [{part:e}]\n\
         [time]\nend = 0.1\nstep = 1e-4\n[output]\ninterval = 0.1\n{rest}"
    )
}

#[test]
fn of_a_body_that_bends_far_it_says_what_is_wrong_by_how_much_and_too_far_is_refused() {
    let model = Model::build(&scene(&bent_plate(1.0, "")), |_| ()).unwrap();
    let unit = model.deflection(&[1.0]);
    let report = report(&bent_plate(0.05 / unit, ""));
    let [warning] = &report.warnings[..] else { panic!("{:?}", report.warnings) };
    println!("{warning}");
    for words in ["5.0 % of the length", "the frequency of mode 1 is about", "too high", "of a period after"] {
        assert!(warning.contains(words), "{warning}");
    }
    let text = bent_plate(36.0 / unit, "");
    let failed = run(&scene(&text).into(), tempfile::tempdir().unwrap().path(), &RunSettings::default(), |_| ());
    let message = failed.unwrap_err().to_string();
    assert!(message.contains("36.00 times its length"), "{message}");
    assert!(
        advise(&scene(&text).into(), &Builder::default(), false, |_| ())
            .unwrap()
            .to_string()
            .contains("This model is refused: the body bends by")
    );
}

/// A step of force that the body answers with far more than its length: nothing is known of it before, with a formula.
#[test]
fn of_a_load_that_bends_the_body_without_end_the_run_stops() {
    let load = "[[loads]]\nkind = \"force\"\nat = [500.0, 25.0, 10.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 1e5\n\
                history = { kind = \"half-sine\", start = 0.0, duration = 0.02 }\n";
    let folder = tempfile::tempdir().unwrap();
    let failed = run(&scene(&bent_plate(0.0, load)).into(), folder.path(), &RunSettings::default(), |_| ());
    let message = failed.unwrap_err().to_string();
    // It is thrown out of its model within one step, which fails by the turn that this makes.
    assert!(message.contains("at time 0.0") && message.contains("means nothing"), "{message}");
}

/// Regression only: the balance of energy of the spinning plate closes to 6.3e-7 in steps of 2.5 ms, in which its
/// eighth mode swings by 0.18 of the largest coordinate beside where it should be.
#[test]
fn of_modes_that_long_steps_get_wrong_though_the_energy_is_right_there_is_one() {
    let mut body = Body::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/accuracy/spin.toml")).unwrap();
    let mut with_step = |step: f64| {
        body.time.control = flexframe::scene::StepControl::Fixed(step);
        body.rows = flexframe::scene::Rows::EverySteps(1);
        let advice = advise(&body.clone().into(), &Builder::default(), false, |_| ()).unwrap();
        let report =
            run(&body.clone().into(), tempfile::tempdir().unwrap().path(), &RunSettings::default(), |_| ()).unwrap().1;
        let rows = advice.value("rows").unwrap();
        let row = rows.as_array().unwrap().iter().find(|row| row["effect"] == "step").unwrap();
        (row["influence"].as_f64().unwrap(), row["why"].as_str().unwrap().to_owned(), report)
    };
    let (influence, why, report) = with_step(2.5e-3);
    assert!(report.bodies[0].balances.energy < 1e-5, "{:e}", report.bodies[0].balances.energy);
    assert!((0.1..0.3).contains(&influence), "{why}");
    let named =
        |text: &str| text.contains("1.8e-1 of the largest modal coordinate") && text.contains("mode 7 is the worst");
    assert!(named(&why), "{why}");
    assert!(report.warnings.iter().any(|warning| named(warning) && warning.contains("shorter steps")), "{report}");

    let (influence, why, report) = with_step(2e-4);
    assert!(influence < 1e-3, "{why}");
    assert!(!report.warnings.iter().any(|warning| warning.contains("shorter steps")), "{report}");
}

/// Without spin the modes follow their own motion exactly in steps of more than a period; what damping takes of them is
/// not summed right.
#[test]
fn of_long_exact_steps() {
    let rest = |stepping: &str| {
        format!(
            "damping_ratio = 0.02\n[initial]\nmodal_velocity = [1e-3, 0.0, 2e-3]\n\
             [time]\nend = 0.01\n{stepping}\n[output]\ninterval = 2e-3\n"
        )
    };
    for stepping in ["step = 1e-3", "tolerance = 1e-6"] {
        let report = report(&ring(210e3, &rest(stepping)));
        assert!(report.bodies[0].step_lengths[1] > 1e-4, "{:?}", report.bodies[0].step_lengths);
        assert!(report.bodies[0].balances.energy > 1e-2 && report.warnings.is_empty(), "{stepping}: {report}");
        assert!(report.to_string().contains("by modes faster than the steps"), "{report}");
    }
}

/// A clamped bar of 200 mm whose first mode begins with a displacement of a part of its length, and whose first two modes begin with
/// velocities over ω. It ends after half a period.
fn clamped(modes: &str, displacement: f64, velocities: [f64; 2]) -> Body {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../../crates/model/tests/data/bar.msh");
    let of = |q: f64, [v, w]: [f64; 2]| {
        scene(&format!(
            "[body]\nmesh = \"{mesh}\"\nmaterial = {{ young_modulus = 70e3, poisson_ratio = 0.3, density = 2.7e-9 }}\n\
             [modes]\nflexible = 4\n{modes}[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n\
             [initial]\nmodal_displacement = [{q:e}]\nmodal_velocity = [{v:e}, {w:e}]\n\
             [time]\nend = 2e-3\nstep = 1e-5\n[output]\ninterval = 1e-4\npoints = {{ tip = [200.0, 5.0, 5.0] }}\n"
        ))
    };
    let model = Model::build(&of(1e-9, [0.0; 2]), |_| ()).unwrap();
    let units = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]].map(|q| model.deflection(&q));
    let rate = |k: usize| velocities[k] * model.body.circular_frequencies[k] / units[k];
    of(displacement / units[0], [rate(0), rate(1)])
}

/// Independent reference: the full body, which the run is checked by. The model does not judge itself.
#[test]
fn of_large_modes_it_is_the_check_that_says_how_right_they_are() {
    let report = |body: &Body| {
        let folder = tempfile::tempdir().unwrap();
        let settings = RunSettings { check: true, ..RunSettings::default() };
        run(&body.clone().into(), folder.path(), &settings, |_| ()).unwrap().1
    };
    let error = |report: &RunReport| report.check.as_ref().unwrap().bodies[0].worst().unwrap().state.error;
    let right = report(&clamped("", 0.15, [0.0; 2]));
    assert!(right.bodies[0].large_modes.contains(&1) && right.warnings.is_empty(), "{right}");
    let far = report(&clamped("large = 2\n", 0.4, [0.0; 2]));
    assert!(far.warnings.is_empty(), "{far}");
    println!("{} {}", error(&right), error(&far));
    assert!(error(&right) < 5e-3 && error(&far) > 4.0 * error(&right), "{right}\n{far}");
    // Where it does not bend, none are large.
    let still = report(&clamped("", 1e-5, [0.0; 2]));
    assert!(still.bodies[0].large_modes.is_empty() && still.warnings.is_empty(), "{still}");
}

#[test]
fn far_beyond_it_the_run_stops_and_its_file_can_be_read() {
    let body = clamped("large = 2\n", 0.0, [0.95, 0.95]);
    let folder = tempfile::tempdir().unwrap();
    let refusal = |result: Result<(Vec<Model>, RunReport), RunError>| match result {
        Err(RunError::Refused { time, refusal: Refusal::Deflected { deflection }, .. }) => (time, deflection),
        other => panic!("{other:?}"),
    };
    let (time, deflection) = refusal(run(&body.clone().into(), folder.path(), &RunSettings::default(), |_| ()));
    assert!(time > 1e-4 && deflection > 1.0, "{time} {deflection}");
    let part = unfinished(results_path(&body.clone().into(), folder.path()));
    let rows = Results::open(&part, &COLUMNS).unwrap().rows();
    assert!(rows > 0 && rows as f64 <= 1.0 + time / 1e-4, "{rows} at {time}");
}

/// Conserved: a picture shows what a point of the output does: the shapes that follow, too.
#[test]
fn the_surface_moves_as_the_points_do() {
    let body = clamped("large = 1\n", 0.2, [0.0; 2]);
    let model = Model::build(&body, |_| ()).unwrap();
    let surface = Surface::of_model(&model);
    let tip = surface
        .shapes
        .positions
        .iter()
        .position(|x| (x[0] - 200.0).hypot(x[1] - 5.0).hypot(x[2] - 5.0) < 1e-9)
        .unwrap();
    let mut simulation = model.start_with(&body, *body.method(), body.time.control, Rows::EverySteps(1)).unwrap();
    let now = simulation.observation().unwrap();
    let drawn = surface.displacements(&model.coordinates(&now.modal_displacement))[tip];
    assert!(
        // Shapes that are drawn are in single precision.
        (drawn - now.points[0].displacement).norm() < 1e-7 * drawn.norm(),
        "{drawn} {}",
        now.points[0].displacement
    );
    // It is drawn in by more than a tenth of what it bends by, which the mode alone does not show.
    let alone = surface.displacements(&now.modal_displacement)[tip];
    assert!(drawn.x < alone.x - 0.1 * alone.norm(), "{drawn} {alone}");
}

/// Parts of a mesh of another format that are left out are a warning of all that is made of it: when it is read, when it
/// comes from
/// the cache, and when it comes from a body file. (Needs gmsh, and meshio in the Python that `FLEXFRAME_PYTHON` names.)
#[test]
fn of_a_mesh_that_was_not_read_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let geometry = concat!(env!("CARGO_MANIFEST_DIR"), "/../../crates/model/tests/data/bar.geo");
    let gmsh =
        Command::new("gmsh").args(["-3", "-order", "2", "-v", "0", geometry, "-o"]).arg(path("bar.inp")).status();
    assert!(gmsh.unwrap().success());
    let mesh = std::fs::read_to_string(path("bar.inp")).unwrap();
    let more = "*EQUATION\n2\n1, 1, 1.0, 2, 1, -1.0\n";
    std::fs::write(path("bar.inp"), mesh + more).unwrap();
    let builder = Builder::with_cache(Cache::new(path("cache"), 1 << 30));
    let scene = |body: &str| {
        let rest = "[modes]\nflexible = 2\n[time]\nend = 1e-4\nstep = 1e-5\n";
        let units = UNITS.replace("\"m\"", "\"mm\"").replace("kg", "Mg");
        Body::parse(&format!("{units}[body]\n{body}\n{rest}"), path("bar.toml")).unwrap()
    };
    let material = "material = { young_modulus = 210e3, poisson_ratio = 0.3, density = 7.85e-9 }";
    let imported = scene(&format!("mesh = \"bar.inp\"\n{material}"));
    let is_told = |warnings: &[String]| {
        let [warning] = warnings else { panic!("{warnings:?}") };
        assert!(warning.contains("bar.inp: read: ") && warning.contains("not used: 1 *EQUATION"), "{warning}");
    };
    is_told(&modes(&imported, &builder, None, |_| ()).unwrap().1.warnings);
    is_told(&modes(&imported, &builder, None, |_| ()).unwrap().1.warnings);
    is_told(&reduce(&imported, &builder, &path("bar.body.h5"), false, false, |_| ()).unwrap().warnings);
    std::fs::remove_file(path("bar.inp")).unwrap();
    let settings = RunSettings { builder: builder.clone(), ..RunSettings::default() };
    let report = run(&scene("file = \"bar.body.h5\"").into(), folder.path(), &settings, |_| ()).unwrap().1;
    is_told(&report.warnings);
    is_told(&Results::open(&report.results, &COLUMNS).unwrap().metadata.warnings);
    assert!(builder.cache.notes().warnings.is_empty(), "{:?}", builder.cache.notes());
}

/// A wheel that a table turns, with the rest of the history.
fn wheel(rest: &str) -> RunReport {
    let text = format!(
        "{UNITS}[bodies.wheel]\nrigid = {{ mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 2]] }}\n\
         markers = {{ hub = {{ at = [0, 0, 0] }} }}\n[[joints]]\nname = \"axle\"\nkind = \"revolute\"\naxis = [0, 0, 1]\n\
         between = [\"ground\", \"wheel.hub\"]\n\
         drive = {{ amplitude = 1.0, history = {{ kind = \"table\", points = [[0, 0], [0.5, 1], [1.25, 1.5], [2, 1.2]]{rest} }} }}\n\
         [time]\nend = 2.0\ntolerance = 1e-6\n[output]\ninterval = 0.1\n"
    );
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::parse(&text, "wheel.toml").unwrap();
    let report = run(&scene, folder.path(), &RunSettings::default(), |_| ()).unwrap().1;
    let results = Results::open(&report.results, &COLUMNS).unwrap();
    let [angle, rate] = ["angle", "rate"].map(|name| results.numbers(&format!("joints/axle/{name}")).unwrap()[4]);
    // Independent reference: PchipInterpolator of SciPy at 0.4, and its derivative; straight lines.
    let expected = match rest {
        "" => [0.8, 2.0],
        _ => [0.870_326_436_781_609_3, 1.541_701_149_425_287],
    };
    assert!((angle - expected[0]).abs() < 1e-9 && (rate - expected[1]).abs() < 1e-7, "{angle} {rate} {expected:?}");
    report
}

#[test]
fn of_a_drive_along_straight_lines() {
    let [lines, cubics] = ["", ", interpolation = \"monotone-cubic\""].map(wheel);
    assert!(lines.warnings.iter().any(|warning| warning.contains("its speed jumps 2 times")), "{:?}", lines.warnings);
    assert!(cubics.warnings.is_empty(), "{:?}", cubics.warnings);
    for (report, words) in
        [(lines, "4 points of the scene: straight lines"), (cubics, "4 points of the scene: monotone cubics")]
    {
        assert!(report.to_string().contains(&format!("  table    {words}\n")), "{report}");
    }
}
