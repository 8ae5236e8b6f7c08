//! Markers and the systems of a scene.

use std::path::Path;

use dynamics::{Effect, Observation, Reached, Rows, Simulation, Start, StepControl, SystemSetup};
use faer::Mat;
use model::{BodyMarker, Model, StartError, Tied, UnknownTurns, tie};
use nalgebra::Vector3;
use scene::Scene;

use crate::{build, last, parse, point};

const HEAD: &str = "title = 'ties'\nunits = { length = 'mm', mass = 'Mg', time = 's' }\n";
const BAR: &str =
    "mesh = '../data/bar.msh'\nmaterial = { young_modulus = 70e3, poisson_ratio = 0.3, density = 2.7e-9 }\n";
const RIGID: &str =
    "rigid = { mass = 1e-4, center_of_mass = [0, 0, 0], inertia = [[0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.2]] }\n";
const FALLS: &str = "loads = [{ kind = 'gravity', direction = [0, 0, -1], amplitude = 9810.0 }]\n";
const TIME: &str = "[time]\nend = 0.02\ntolerance = 1e-6\n";

fn system(text: &str) -> (Scene, Vec<Model>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/integration/scene.toml");
    let scene = Scene::parse(text, path).unwrap_or_else(|error| panic!("{error}"));
    let models = scene.bodies.iter().map(build).collect();
    (scene, models)
}

/// The first rows of the shapes of a marker (6×nf): its displacement and its rotation in each mode.
fn shapes(marker: &BodyMarker) -> Mat<f64> {
    let (point, turning) = (&marker.point.columns()[6..], &marker.turning.columns()[6..]);
    Mat::from_fn(6, point.len(), |i, k| if i < 3 { point[k][i] } else { turning[k][i - 3] })
}

/// Displacements and rotations of two markers by deformation, under unit forces and moments on them (12×12).
fn compliance(model: &Model) -> Mat<f64> {
    let [one, other] = [0, 1].map(|i| shapes(&model.markers[i]));
    let all = Mat::from_fn(12, one.ncols(), |i, k| if i < 6 { one[(i, k)] } else { other[(i - 6, k)] });
    let omega = &model.body.circular_frequencies;
    let scaled = Mat::from_fn(12, one.ncols(), |i, k| all[(i, k)] / omega[k]);
    &scaled * scaled.transpose()
}

/// Conserved: the static response to forces on the markers, whatever the number of modes.
#[test]
fn two_markers_add_twelve_shapes_that_hold_the_static_response() {
    let with_modes = |modes: usize, effects: &str| {
        build(&parse(&format!(
            "{HEAD}[body]\n{BAR}[body.markers.root]\ngroup = 'root'\n[body.markers.tip]\nbox = [[200, -9, -9], [200, 9, 9]]\n\
             [modes]\nflexible = {modes}\n{effects}{TIME}"
        )))
    };
    let few = with_modes(2, "static_correction = false\n");
    assert_eq!((few.static_shapes(), few.body.flexible()), (12, 14));
    assert_eq!(few.markers.iter().map(|marker| &*marker.name).collect::<Vec<_>>(), ["root", "tip"]);
    // The face of a box is that of the group, and its mean is its middle.
    let tip = few.markers[1].point.position_body();
    assert!((tip - Vector3::new(100.0, 0.0, 0.0)).norm() < 1e-9, "{tip}");
    let (few, many) = (compliance(&few), compliance(&with_modes(9, "static_correction = false\n")));
    for i in 0..12 {
        for j in 0..12 {
            let size = (many[(i, i)] * many[(j, j)]).sqrt();
            assert!((few[(i, j)] - many[(i, j)]).abs() < 1e-6 * size, "{i} {j}: {} {}", few[(i, j)], many[(i, j)]);
        }
    }
    let stretched = with_modes(2, "").static_shapes();
    assert!(stretched > 12, "{stretched}: the joints may let it spin");
    assert_eq!(with_modes(0, "").body.flexible(), 0, "a body that does not deform has no shapes");
}

#[test]
fn auto_keeps_all_modes_of_a_body_with_markers_and_has_the_effects_of_unknown_forces() {
    let scene = parse(&format!(
        "{HEAD}[body]\n{BAR}markers = {{ tip = {{ group = 'tip' }} }}\n{FALLS_AT_ROOT}\
         [modes]\nflexible = 'auto'\nmost = 5\ndamping_ratio = 0.1\n{TIME}"
    ));
    let model = build(&scene);
    assert_eq!(model.body.natural_modes, 5);
    let of_unknown_forces = [
        Effect::Translation,
        Effect::Rotation,
        Effect::Gravity,
        Effect::Damping,
        Effect::DeformedInertia,
        Effect::Coriolis,
    ];
    assert!(of_unknown_forces.iter().all(|effect| model.physics.effects[*effect]));
    assert!(model.damping_ratios().iter().all(|ratio| *ratio == 0.1));
}

const FALLS_AT_ROOT: &str = "[[loads]]\nkind = 'gravity'\ndirection = [0, 0, -1]\namplitude = 9810.0\n";

/// An arm that lies along y, a hub at its tip, and a block that hangs from the ground by itself.
fn two_islands() -> String {
    format!(
        "{HEAD}[bodies.arm]\n{BAR}{FALLS}modes = {{ flexible = 2 }}\n\
         initial = {{ position = [0, 50, 0], attitude = [1, 0, 0, 1], angular_velocity = [0, 0, 2], velocity = [-200, 0, 0] }}\n\
         [bodies.arm.markers.root]\ngroup = 'root'\n[bodies.arm.markers.tip]\ngroup = 'tip'\nz = [0, 1, 0]\n\
         [bodies.block]\n{RIGID}markers = {{ top = {{ at = [0, 0, 10] }} }}\n\
         [bodies.hub]\n{RIGID}initial = {{ position = [0, 250, 0], velocity = [-400, 0, 0], angular_velocity = [3, 0, 2] }}\nmarkers = {{ left = {{ at = [0, 0, 0] }} }}\n\
         [bodies.stone]\n{RIGID}\
         [ground.markers.ceiling]\nat = [0, 0, 100]\n\
         [[joints]]\nkind = 'revolute'\nbetween = ['arm.tip', 'hub.left']\n\
         [[joints]]\nname = 'hook'\nkind = 'spherical'\nbetween = ['ground', 'block.top']\n\
         [[joints]]\nkind = 'revolute'\nbetween = ['arm.root', 'ground']\naxis = [0, 0, 1]\nspring = {{ stiffness = 5.0 }}\n\
         [[springs]]\nbetween = ['block.top', 'ground.ceiling']\nstiffness = 1.0\n\
         [[bushings]]\nbetween = ['hub.left', 'ground']\nstiffness = {{ rotation = [1, 1, 1] }}\n{TIME}"
    )
}

fn start(tied: &Tied, control: StepControl, end: f64) -> Simulation {
    Simulation::of_system(SystemSetup {
        system: tied.system.clone(),
        states: tied.states.clone(),
        start: Start::AsPlaced,
        scheme: dynamics::SystemScheme::Radau,
        control,
        end,
        rows: Rows::Interval(end),
        points: vec![Vec::new(); tied.bodies.len()],
    })
    .unwrap()
}

#[test]
fn bodies_that_joints_connect_are_a_system_and_those_beside_them_another() {
    let (system, models) = system(&two_islands());
    let tied = tie(&system, &models).unwrap();
    let numbers: Vec<_> =
        tied.iter().map(|tied| (&tied.bodies[..], &tied.joints[..], tied.elements.concat())).collect();
    assert_eq!(numbers, [(&[0, 2][..], &[0, 2][..], "bushing1".to_owned()), (&[1], &[1], "spring1".to_owned())]);
    let names = |tied: &Tied| tied.system.joints().iter().map(|joint| joint.name.clone()).collect::<Vec<_>>();
    assert_eq!((names(&tied[0]), names(&tied[1])), (vec!["joint1".into(), "joint3".into()], vec!["hook".into()]));
    // The arm turns about its root, and the joints find the bodies where they belong, with axes that fit.
    for tied in &tied {
        let begun = start(tied, StepControl::Tolerance(1e-4), 1e-3);
        for (body, change) in tied.bodies.iter().zip(begun.system().unwrap().assembled()) {
            assert!(change.moved < 1e-9 && change.turned < 1e-12, "{body}: {change:?}");
            assert!(change.velocity < 1e-8 && change.angular_velocity < 1e-10, "{body}: {change:?}");
        }
    }
    let error = models[0].start(&system.bodies[0]).unwrap_err();
    assert!(matches!(error, StartError::Tied { .. }) && error.to_string().contains("run the whole scene"), "{error}");
}

/// Independent reference: the same bar held at the same node by the reduction, without any joint.
#[test]
fn a_ball_to_the_ground_moves_a_bar_as_a_pin_does() {
    let body = |rest: &str| {
        format!(
            "{HEAD}[body]\n{BAR}{rest}{FALLS_AT_ROOT}[modes]\nflexible = 6\n[output]\npoints = {{ tip = [200, 0, 0] }}\ninterval = 0.02\n{TIME}"
        )
    };
    let pinned = parse(&body("[[constraints]]\nkind = 'pin'\nat = [0, 0, 0]\n"));
    let (model, end) = last(&pinned);
    let expected = point(&model, &end, "tip").displacement;

    let text = body(
        "markers = { root = { at = [0, 0, 0] } }\n[[joints]]\nkind = 'spherical'\nbetween = ['body.root', 'ground']\n",
    );
    let (system, models) = system(&text);
    let tied = tie(&system, &models).unwrap().remove(0);
    let points = vec![models[0].points.iter().map(|(_, point)| point.clone()).collect()];
    let mut simulation = Simulation::of_system(SystemSetup {
        system: tied.system,
        states: tied.states,
        start: Start::AsPlaced,
        scheme: dynamics::SystemScheme::Radau,
        control: StepControl::Tolerance(1e-6),
        end: 0.02,
        rows: Rows::Interval(0.02),
        points,
    })
    .unwrap();
    let mut row: Vec<Observation> = vec![simulation.room(0)];
    while simulation.advance_watched(1000, |_, _| ()).unwrap() != Reached::End {}
    simulation.observe(&mut row).unwrap();
    let found = row[0].points[0].displacement;
    println!("{found:?} {expected:?} {:e}", (found - expected).norm());
    assert!((found - expected).norm() < 2e-4 * expected.norm());
}

/// Closed form: a cantilever that is pulled with P = 4 EI/L² bends by 3 (1 − tanh(2)/2)/4 of what it does without.
#[test]
fn the_force_of_a_joint_stiffens_its_body() {
    let bent = |pull: f64, effects: &str| {
        let bending = 70e3 * 1e4 / 12.0;
        let text = format!(
            "{HEAD}[body]\n{BAR}markers = {{ root = {{ group = 'root' }} }}\n[modes]\nflexible = 4\ndamping_ratio = 1.0\n{effects}\
             [[loads]]\nkind = 'force'\nat = [200, 0, 0]\ndirection = [1, 0, 0]\namplitude = {:e}\n\
             [[loads]]\nkind = 'force'\nat = [200, 0, 0]\ndirection = [0, 1, 0]\namplitude = 1.0\n\
             [[joints]]\nkind = 'fixed'\nbetween = ['body.root', 'ground']\n\
             [output]\npoints = {{ tip = [200, 0, 0] }}\n[time]\nend = 0.1\ntolerance = 1e-6\n",
            pull * bending / (200.0 * 200.0)
        );
        let (system, models) = system(&text);
        let tied = tie(&system, &models).unwrap().remove(0);
        let mut simulation = start(&tied, StepControl::Tolerance(1e-6), 0.1);
        while simulation.advance_watched(1000, |_, _| ()).unwrap() != Reached::End {}
        let state = simulation.system_motion().unwrap().state(0).unwrap();
        let (_, tip) = &models[0].points[0];
        let arm = tip.position_body() + tip.deformation(&state.modal_displacement);
        (state.origin_global + state.attitude.to_global(&arm)).y
    };
    let free = bent(0.0, "");
    let expected = 3.0 * (1.0 - 2.0_f64.tanh() / 2.0) / 4.0;
    let [stiffened, not] = ["", "[effects]\ngeometric_stiffening = false\n"].map(|effects| bent(4.0, effects) / free);
    println!("{stiffened} {not} {expected}");
    assert!((stiffened / expected - 1.0).abs() < 0.02 && not > 1.05 * expected, "{stiffened} {not} {expected}");
}

#[test]
fn joints_of_markers_that_do_not_tell_their_turns_and_regions_without_faces_are_refused() {
    let nodes = |kind: &str, marker: &str, axis: &str| {
        format!(
            "{HEAD}[body]\n{BAR}markers = {{ root = {marker} }}\n[modes]\nflexible = 2\n\
             [[joints]]\nkind = '{kind}'\nbetween = ['body.root', 'ground']\n{axis}\n{TIME}"
        )
    };
    for marker in ["{ box = [[10, -1, -1], [11, 1, 1]] }", "{ group = 'rot' }"] {
        let body = parse(&nodes("fixed", marker, ""));
        let error = Model::build(&body, |_| ()).unwrap_err().to_string();
        assert!(error.contains("body.markers.root"), "{error}");
    }
    // A point of a mesh has the turns of the elements around it.
    let (system, models) = system(&nodes("fixed", "{ at = [0, 0, 0] }", ""));
    assert_eq!(models[0].markers[0].unknown_turns, UnknownTurns::None);
    assert_eq!(tie(&system, &models).unwrap().len(), 1);
}

const CUBE: &str = "mesh = '../../../fem-tet10/tests/data/cube.msh'\nmaterial = { young_modulus = 70e3, poisson_ratio = 0.3, density = 2.7e-9 }\n";

/// Closed form: the centroid of the cube; a force on the mean of a volume works on the motion of the centre of mass of a free body, in
/// which no mode moves it.
#[test]
fn a_physical_volume_is_a_region_of_each_tie() {
    let of = |tie: &str, body: &str, group: &str| {
        let marker = format!("markers = {{ all = {{ group = '{group}', tie = '{tie}' }} }}");
        parse(&format!("{HEAD}[body]\n{body}{marker}\n[modes]\nflexible = 3\n{TIME}"))
    };
    let mean = build(&of("mean", CUBE, "cube"));
    let center = mean.markers[0].point.position_body();
    assert!(center.norm() < 1e-9, "{center}");
    let bar = build(&of("mean", BAR, "bar"));
    // Modes of a free body leave its centre of mass where it is. Measured: 1e-3.
    let moved = bar.markers[0].point.columns()[6..9].iter().map(Vector3::norm).fold(0.0, f64::max);
    assert!(moved < 0.05 / bar.body.mass.sqrt(), "{moved}");
    for tie in ["nodes", "rigid"] {
        let model = build(&of(tie, CUBE, "cube"));
        assert!(model.markers[0].point.position_body().norm() < 2.0, "{tie}");
        let refused = Model::build(&of(tie, BAR, "bar"), |_| ()).unwrap_err().to_string();
        assert!(refused.contains("1625 nodes to"), "{refused}");
    }
}

/// All nodes of a body in a rigid part leave no mode that might be large.
#[test]
fn large_modes_of_a_rigid_part_are_refused_whatever_is_left_of_the_body() {
    for group in ["group = 'cube'", "box = [[-1, -1, -1], [1, 11, 11]]"] {
        for large in ["large = 1", "large = [2]"] {
            let scene = parse(&format!(
                "{HEAD}[body]\n{CUBE}markers = {{ all = {{ {group}, tie = 'rigid' }} }}\n[modes]\nflexible = 2\n{large}\n\
                 [effects]\nlarge_deflection = true\n{TIME}"
            ));
            let refused = Model::build(&scene, |_| ()).unwrap_err().to_string();
            assert!(refused.contains("a rigid part of a body with large modes"), "{refused}");
        }
    }
}

/// Conserved: forces on nodes and on patches add up to that on their mean, which moves as their mean does.
#[test]
fn a_marker_of_several_places_is_their_mean() {
    let of = |marker: &str| {
        build(&parse(&format!(
            "{HEAD}[body]\n{BAR}markers = {{ tip = {{ box = [[200, -9, -9], [200, 9, 9]], {marker} }} }}\n\
             [modes]\nflexible = 2\nstatic_correction = false\n{TIME}"
        )))
    };
    let (patches, nodes) = (of("patches = 3, along = [0, 1, 0]"), of("tie = 'nodes'"));
    assert_eq!(patches.static_shapes(), 18);
    let count = nodes.markers[0].parts.len();
    assert!(count > 5 && nodes.static_shapes() == 3 * count, "{count} {}", nodes.static_shapes());
    for model in [&patches, &nodes] {
        let marker = &model.markers[0];
        let parts = &marker.parts;
        let middle: Vector3<f64> =
            parts.iter().map(|part| part.point.position_body()).sum::<Vector3<f64>>() / parts.len() as f64;
        assert!((middle - marker.point.position_body()).norm() < 1e-9, "{middle}");
        let size = marker.point.columns()[6..].iter().map(|shape| shape.norm()).fold(0.0, f64::max);
        for (k, shape) in marker.point.columns()[6..].iter().enumerate() {
            let mean: Vector3<f64> =
                parts.iter().map(|part| part.point.columns()[6 + k]).sum::<Vector3<f64>>() / parts.len() as f64;
            assert!((mean - shape).norm() < 1e-9 * size, "{k}: {mean} {shape}");
        }
        // u₂ is the mean of those of the places, also where the force is on the mean.
        let q: Vec<f64> = (0..model.body.flexible()).map(|k| 1e-3 / (1.0 + k as f64)).collect();
        let moved = |point: &dynamics::PointShapes| -> Vector3<f64> { point.deformation(&q) };
        let mean: Vector3<f64> = parts.iter().map(|part| moved(&part.point)).sum::<Vector3<f64>>() / parts.len() as f64;
        assert!((mean - moved(&marker.point)).norm() < 1e-9 * mean.norm(), "{mean}");
    }
}

#[test]
fn places_that_do_not_fit_each_other_or_their_joint_are_refused() {
    let two = |first: &str, second: &str, joint: &str| {
        format!(
            "{HEAD}[bodies.a]\n{BAR}modes = {{ flexible = 2 }}\nmarkers = {{ m = {{ {first} }} }}\n\
             [bodies.b]\n{BAR}modes = {{ flexible = 2 }}\ninitial = {{ position = [200, 0, 0] }}\nmarkers = {{ m = {{ {second} }} }}\n\
             [[joints]]\nbetween = ['a.m', 'b.m']\n{joint}\n{TIME}"
        )
    };
    let (tip, root) = ("box = [[200, -9, -9], [200, 9, 9]]", "box = [[0, -9, -9], [0, 9, 9]]");
    let line = |x: f64| format!("box = [[{x}, -9, -5.001], [{}, 9, -4.999]], tie = 'nodes'", x + 1e-6);
    let patches = |of: &str, count: usize| format!("{of}, patches = {count}, along = [0, 1, 0]");
    let hinge = "kind = 'revolute'\naxis = [0, 1, 0]";
    for (first, second, joint, key, words) in [
        (patches(tip, 2), patches(root, 3), "kind = 'fixed'", "joints[0].between", "of 2 and 3 places"),
        (patches(tip, 2), root.to_owned(), "kind = 'fixed'", "joints[0].between[1]", "of one place"),
        (patches(tip, 2), patches(root, 2), "kind = 'spherical'", "joints[0].kind", "of patches"),
        (
            patches(tip, 2),
            patches(root, 2),
            "kind = 'revolute'\naxis = [0, 0, 1]",
            "joints[0].kind",
            "revolute about the line",
        ),
        (line(200.0), line(0.0), "kind = 'fixed'", "joints[0]", "which holds that turn"),
        (line(200.0), line(0.0), "kind = 'revolute'\naxis = [0, 0, 1]", "joints[0]", "which holds that turn"),
        (
            line(200.0),
            line(0.0),
            &format!("{hinge}\nspring = {{ stiffness = 1.0 }}"),
            "joints[0]",
            "which holds that turn",
        ),
        (
            line(200.0),
            line(0.0),
            &format!("{hinge}\ndrive = {{ amplitude = 1.0 }}"),
            "joints[0]",
            "which holds that turn",
        ),
        (line(200.0), line(0.0), "kind = 'spherical'", "joints[0].kind", "a joint that is revolute"),
        (
            format!("{tip}, tie = 'nodes'"),
            format!("{root}, tie = 'nodes'"),
            hinge,
            "joints[0].kind",
            "a joint that is fixed",
        ),
        (
            line(200.0),
            line(0.0).replace("-5.001", "4.999").replace("-4.999", "5.001"),
            "kind = 'revolute'\naxis = [0, 0, 1]",
            "joints[0]",
            "turn",
        ),
    ] {
        let (system, models) = system(&two(&first, &second, joint));
        let error = tie(&system, &models).expect_err(joint).to_string();
        assert!(error.contains(key) && error.contains(words), "{key}, {words}: {error}");
    }
    let alone =
        |marker: &str| format!("{HEAD}[body]\n{BAR}markers = {{ m = {{ {marker} }} }}\n[modes]\nflexible = 2\n{TIME}");
    for (marker, words) in [
        (format!("{tip}, patches = 2"), "as far in two directions"),
        ("box = [[-1, -9, -9], [201, 9, 9]], tie = 'nodes'".to_owned(), "100 nodes or fewer"),
    ] {
        let error = Model::build(&parse(&alone(&marker)), |_| ()).expect_err(&marker).to_string();
        assert!(error.contains("body.markers.m.") && error.contains(words), "{words}: {error}");
    }
    // What fits is tied: one joint with rows on each place.
    let (system, models) = system(&two(&line(200.0), &line(0.0), hinge));
    let joint = &tie(&system, &models).unwrap()[0].system.joints()[0].clone();
    assert_eq!((joint.rows.len(), joint.row_count()), (0, 3 * models[0].markers[0].parts.len()));
}

#[test]
fn a_drive_whose_coordinate_jumps_is_refused_with_the_time_and_one_whose_speed_jumps_is_not() {
    let driven = |history: &str| {
        format!(
            "{HEAD}[body]\n{RIGID}markers = {{ m = {{ at = [0, 0, 0] }} }}\n[[joints]]\nkind = 'revolute'\naxis = [0, 0, 1]\n\
             between = ['ground', 'body.m']\ndrive = {{ amplitude = 2.0, history = {history} }}\n{TIME}"
        )
    };
    for (history, words) in [
        ("{ kind = 'step', at = 0.01 }", "jumps from 0 to 2 at time 0.01"),
        ("{ kind = 'sine', frequency = 100.0, phase = 0.5, start = 0.005 }", "at time 0.005"),
        ("{ kind = 'expression', formula = 'floor(100*t)' }", "jumps from 0 to 2 at time 0.01"),
    ] {
        let (system, models) = system(&driven(history));
        let error = tie(&system, &models).expect_err(history).to_string();
        assert!(error.contains("joints[0].drive.history") && error.contains(words), "{history}: {error}");
    }
    for history in [
        "{ kind = 'ramp', start = 0.005, duration = 0.01 }",
        "{ kind = 'table', points = [[0, 0], [0.01, 1], [0.0100001, 5], [0.02, 0]] }",
        "{ kind = 'half-sine', start = 0.001, duration = 0.01 }",
        "{ kind = 'expression', formula = 'abs(t - 0.01)' }",
        "{ kind = 'step', at = 0.0 }",
    ] {
        let (system, models) = system(&driven(history));
        assert!(tie(&system, &models).is_ok(), "{history}");
    }
}

/// Stress along a bar at points on its upper side, at rest under a load, by its end.
fn stress_at_rest(text: &str) -> Vec<f64> {
    let (system, models) = system(text);
    let tied = tie(&system, &models).unwrap().remove(0);
    let mut simulation = start(&tied, StepControl::Tolerance(1e-6), 0.1);
    while simulation.advance_watched(1000, |_, _| ()).unwrap() != Reached::End {}
    let q = simulation.system_motion().unwrap().state(0).unwrap().modal_displacement;
    models[0].stress.as_ref().unwrap().at_points(&q).map(|stress| stress[0]).collect()
}

const SEEN: &str = "points = { a = [60, 0, 5], b = [20, 0, 5] }\nstress = true\n";
/// Light beside the bar, so that it comes to rest with it.
const LIGHT: &str =
    "rigid = { mass = 1e-7, center_of_mass = [0, 0, 0], inertia = [[1e-5, 0, 0], [0, 1e-5, 0], [0, 0, 1e-5]] }\n";
const DAMPED: &str = "modes = { flexible = 4, damping_ratio = 1.0 }\neffects = { geometric_stiffening = false }\n";

/// Closed form: a beam on a weld, pushed at its end by another body through a ball, has the stress F (L − x) c/I.
#[test]
fn the_force_of_a_joint_stresses_a_body_as_beams_say() {
    let force = 3.0;
    let found = stress_at_rest(&format!(
        "{HEAD}[bodies.bar]\n{BAR}{DAMPED}{SEEN}markers = {{ root = {{ group = 'root' }}, tip = {{ group = 'tip' }} }}\n\
         [bodies.block]\n{LIGHT}initial = {{ position = [200, 0, 0] }}\nmarkers = {{ m = {{ at = [0, 0, 0] }} }}\n\
         loads = [{{ kind = 'force', at = [0, 0, 0], direction = [0, 0, -1], amplitude = {force} }}]\n\
         [[joints]]\nkind = 'fixed'\nbetween = ['ground', 'bar.root']\n\
         [[joints]]\nkind = 'spherical'\nbetween = ['bar.tip', 'block.m']\n{TIME}"
    ));
    for (found, x) in found.iter().zip([60.0, 20.0]) {
        let expected = force * (200.0 - x) * 5.0 / (1e4 / 12.0);
        println!("{x}: {found} {expected}");
        assert!((found / expected - 1.0).abs() < 0.01, "{x}: {found} {expected}");
    }
}

/// Independent reference: the same bar held by a constraint of the reduction.
#[test]
fn a_weld_stresses_a_bar_as_a_clamp_does() {
    let body = |rest: &str| {
        format!(
            "{HEAD}[body]\n{BAR}{rest}[[loads]]\nkind = 'force'\nat = [200, 0, 0]\ndirection = [0, 1, -2]\namplitude = 2.0\n\
             [modes]\nflexible = 4\ndamping_ratio = 1.0\n[effects]\ngeometric_stiffening = false\n[output]\n{SEEN}interval = 0.1\n\
             [time]\nend = 0.1\ntolerance = 1e-6\n"
        )
    };
    let clamped = parse(&body("[[constraints]]\nkind = 'clamp'\ngroup = 'root'\n"));
    let (model, end) = last(&clamped);
    let expected: Vec<f64> =
        model.stress.as_ref().unwrap().at_points(&end.modal_displacement).map(|stress| stress[0]).collect();
    let weld =
        "markers = { root = { group = 'root' } }\n[[joints]]\nkind = 'fixed'\nbetween = ['body.root', 'ground']\n";
    let found = stress_at_rest(&body(weld));
    println!("{found:?} {expected:?}");
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    }
}
