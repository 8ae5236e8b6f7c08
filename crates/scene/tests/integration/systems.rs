//! Scenes of several bodies: each body is what it would be in a scene of its own, and faults name their place in the file.

use scene::{Body, BodySource, LoadKind, Rows, Scene, SceneError, StepControl};

const HEAD: &str = "title = 'two'\nunits = { length = 'm', mass = 'kg', time = 's' }\n";
const TIME: &str = "[time]\nend = 1.0\nstep = 1e-2\n[output]\ninterval = 0.1\n";
const RIGID: &str = "rigid = { mass = 2.0, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 2, 0], [0, 0, 2]] }";
const LOADS: &str = "kind = 'force'\nat = [0.1, 0, 0]\namplitude = 2.0\ndirection = [0, 1, 0]\nhistory = { kind = 'half-sine', duration = 0.2 }\n";

fn two() -> String {
    format!(
        "{HEAD}[bodies.left]\n{RIGID}\npoints = {{ tip = [1, 0, 0] }}\ninitial = {{ position = [0, 3, 0] }}\n\
         [[bodies.left.loads]]\n{LOADS}\
         [bodies.\"the right\"]\n{RIGID}\n[bodies.\"the right\".initial]\nangular_velocity = [0, 0, 1]\n{TIME}"
    )
}

fn refused(text: &str) -> SceneError {
    Scene::parse(text, "two.toml").unwrap_err()
}

#[test]
fn each_body_is_what_it_would_be_alone() {
    let scene = Scene::parse(&two(), "two.toml").unwrap();
    let [left, right] = &scene.bodies[..] else { panic!("{} bodies", scene.bodies.len()) };
    assert_eq!([left, right].map(|body| body.name.as_deref()), [Some("left"), Some("the right")]);
    let alone = format!(
        "{HEAD}[body]\n{RIGID}\n[initial]\nposition = [0, 3, 0]\n[[loads]]\n{LOADS}{TIME}points = {{ tip = [1, 0, 0] }}\n"
    );
    let alone = Body::parse(&alone, "two.toml").unwrap();
    let of_text = Body::parse(&left.text_alone, "two.toml").unwrap();
    let mut expected = Body { text_alone: left.text_alone.clone(), ..alone };
    expected.text = left.text_alone.as_str().into();
    assert_eq!(of_text, expected);
    assert!(matches!(&left.loads[..], [load] if load.kind == LoadKind::Force) && right.loads.is_empty());
    for body in [left, right] {
        let again = Body::parse(&body.text_alone, "two.toml").unwrap();
        assert_eq!((&again.source, &again.initial, &again.loads), (&body.source, &body.initial, &body.loads));
        assert_eq!((&again.time, &again.output), (&body.time, &body.output));
        assert!(matches!(body.source, BodySource::Rigid(_)));
        assert_eq!((body.time.control, body.rows), (StepControl::Fixed(1e-2), Rows::Interval(0.1)));
    }
    assert_eq!(right.initial.angular_velocity, [0.0, 0.0, 1.0]);
}

#[test]
fn a_scene_of_one_body_is_a_system_of_one() {
    let text = format!("{HEAD}[body]\n{RIGID}\n{TIME}");
    let scene = Scene::parse(&text, "one.toml").unwrap();
    assert_eq!(scene.bodies[0].name, None);
    assert_eq!(scene.bodies, [Body::parse(&text, "one.toml").unwrap()]);
}

#[test]
fn faults_name_their_place_in_the_file() {
    for (from, to, line, key) in [
        ("mass = 2.0", "mass = -2.0", 4, "bodies.left.rigid.mass"),
        ("tip = [1, 0, 0]", "'a/b' = [1, 0, 0]", 5, "bodies.left.points.\"a/b\""),
        ("amplitude = 2.0", "amplitud = 2.0", 10, "bodies.left.loads[0].amplitud"),
        ("angular_velocity", "spin", 16, "bodies.\"the right\".initial.spin"),
        ("step = 1e-2", "step = -1e-2", 19, "time.step"),
        ("[bodies.left]\nrigid", "[bodies.left]\nrigit", 4, "bodies.left.rigit"),
    ] {
        let text = two();
        assert!(text.contains(from), "{from}");
        let error = refused(&text.replacen(from, to, 1));
        let place = error.place().unwrap();
        assert_eq!((place.line, place.key.as_str()), (line, key), "{error}");
    }
    let scene = Scene::parse(&two(), "two.toml").unwrap();
    let place = scene.bodies[0].place("loads[0].at");
    assert_eq!((place.line, place.key.as_str()), (9, "bodies.left.loads[0].at"));
}

#[test]
fn parts_of_a_body_beside_the_bodies_are_refused_and_so_are_names_that_are_no_names() {
    for (text, words) in [
        (two() + "[modes]\nflexible = 3\n", "`[bodies.hub.modes]`"),
        (two() + "[[loads]]\nkind = 'gravity'\n", "`[bodies.hub.loads]`"),
        (two() + "[body]\nmesh = 'a.msh'\n", "`[bodies.hub]`"),
        (two().replace("interval = 0.1", "interval = 0.1\nstress = true"), "with `stress = …`"),
        (two().replace("\"the right\"", "\"the.right\""), "without `.`, `/`"),
        (two().replace("\"the right\"", "\"\""), "rename the body"),
        (format!("{HEAD}[bodies]\n{TIME}"), "one table for each body"),
        (format!("{HEAD}bodies = 3\n{TIME}"), "one table for each body"),
        (two() + "[joint]\n", "unknown key `joint`"),
    ] {
        let error = refused(&text).to_string();
        assert!(error.contains(words) && error.starts_with("two.toml:"), "{words}: {error}");
    }
    for (name, words) in
        [(None, "name one of them: left, the right"), (Some("hub"), "name one of those that are there: left")]
    {
        let error = Body::parse_body(&two(), "two.toml", name).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let one = format!("{HEAD}[body]\n{RIGID}\n{TIME}");
    assert!(Body::parse_body(&one, "one.toml", Some("hub")).unwrap_err().to_string().contains("leave the name out"));
}
