//! Files are read into what the scene holds; those that cannot be read say why.

use std::path::Path;

use scene::{
    Body, BodySource, Choice, Damping, Effect, Effects, Flexible, History, Load, LoadFrame, LoadKind, LoadPlace,
    Material, Materials, MeshedBody, Method, Rows, SceneError, StepControl,
};

const EXAMPLE: &str = include_str!("../../src/text/example.toml");

/// Closed form: the direction (1, 0, 1)/√2.
#[test]
fn the_whole_example() {
    let body = Body::parse(EXAMPLE, "examples/plate.toml").unwrap();
    assert_eq!(body.title, "Free plate, 50 N end pulse");
    let units = &body.units;
    assert_eq!([&units.length, &units.mass, &units.time], ["mm", "Mg", "s"]);
    assert_eq!(meshed(&body).mesh, Path::new("examples/../meshes/plate.msh"));
    let aluminium = Material { young_modulus: 70000.0, poisson_ratio: 0.33, density: 2.7e-9 };
    assert_eq!(meshed(&body).materials, Materials::Uniform(aluminium));
    assert_eq!(meshed(&body).point_masses.len(), 1);
    let point_mass = meshed(&body).point_masses[0];
    assert_eq!((point_mass.at, point_mass.mass), ([-500.0, -25.0, 0.0], 0.001));
    assert_eq!(point_mass.spread, None);
    assert_eq!((body.modes.flexible, &body.modes.damping), (Flexible::Count(10), &Damping::Uniform(0.05)));
    let frame = body.frame.unwrap();
    assert_eq!(frame.r, [-500.0, -25.0, 0.0]);
    assert_eq!(frame.p, [500.0, -25.0, 0.0]);
    assert_eq!(frame.q, [500.0, 25.0, 0.0]);
    assert_eq!(body.initial, Default::default());
    let [Load { kind, place, direction, amplitude, frame, history }] = &body.loads[..] else {
        panic!("not one load: {:?}", body.loads)
    };
    assert_eq!((*kind, place), (LoadKind::Force, &LoadPlace::Point([-500.0, 0.0, 10.0])));
    assert_eq!((*amplitude, *frame), (50.0, LoadFrame::Global));
    assert!((direction[0] - 0.5f64.sqrt()).abs() < 1e-15 && direction[0] == direction[2]);
    assert_eq!(direction[1], 0.0);
    assert_eq!(*history, History::HalfSine { start: 0.0, duration: 0.02 });
    assert_eq!((body.time.end, body.time.control), (0.5, StepControl::Fixed(1e-4)));
    assert_eq!(*body.method(), Method::EXPONENTIAL);
    assert_eq!(body.rows, Rows::EverySteps(1));
    assert_eq!(body.output.points.len(), 1);
    assert_eq!(body.output.points["P1"], [-500.0, -25.0, 0.0]);
    assert_eq!(body.text_alone, EXAMPLE);
    assert_eq!(body.path, Path::new("examples/plate.toml"));
}

/// The body of a scene with a mesh.
fn meshed(body: &Body) -> &MeshedBody {
    match &body.source {
        BodySource::Meshed(meshed) => meshed,
        BodySource::File(_) | BodySource::Rigid(_) | BodySource::Matrices(_) => panic!("a body without a mesh"),
    }
}

/// A scene of the required keys alone, with `more` at its end.
fn least(more: &str) -> String {
    format!(
        "title = ''\nunits = {{ length = 'm', mass = 'kg', time = 's' }}\n\
         body.mesh = 'a.msh'\n\
         body.materials = {{ core = {{ young_modulus = 1, poisson_ratio = 0, density = 1 }} }}\n\
         modes.flexible = 0\n[time]\nend = 1\nstep = 1\n{more}"
    )
}

#[test]
fn defaults_and_whole_numbers() {
    let body = Body::parse(&least(""), "a.toml").unwrap();
    assert_eq!(meshed(&body).mesh, Path::new("a.msh"));
    let Materials::ByGroup(groups) = &meshed(&body).materials else { panic!("not by group") };
    let unit = Material { young_modulus: 1.0, poisson_ratio: 0.0, density: 1.0 };
    assert_eq!(groups.iter().collect::<Vec<_>>(), [(&"core".to_owned(), &unit)]);
    assert!(meshed(&body).point_masses.is_empty() && body.loads.is_empty());
    assert_eq!((body.modes.flexible, &body.modes.damping), (Flexible::Count(0), &Damping::Uniform(0.0)));
    assert_eq!(body.modes.static_correction, Choice::Auto);
    assert_eq!((body.effects, &body.constraint), (Effects::default(), &None));
    assert_eq!((body.effects.choices[Effect::Rotation], body.effects.tolerance), (Choice::Auto, 1e-3));
    assert_eq!(body.frame, None);
    assert_eq!(body.initial.velocity, [0.0; 3]);
    assert_eq!(body.initial.angular_velocity, [0.0; 3]);
    assert!(body.initial.modal_displacement.is_empty());
    assert_eq!((body.rows, body.output.points.len()), (Rows::EverySteps(1), 0));
    assert_eq!((body.time.end, body.time.control), (1.0, StepControl::Fixed(1.0)));
    assert_eq!(*body.method(), Method::EXPONENTIAL);
}

#[test]
fn formulation_and_scheme_name_a_method() {
    for (keys, method) in [
        ("", Method::EXPONENTIAL),
        ("formulation = 'conservative'", Method::EXPONENTIAL),
        ("scheme = 'exponential'", Method::EXPONENTIAL),
        ("scheme = { kind = 'exponential' }", Method::EXPONENTIAL),
        ("formulation = 'conservative'\nscheme = 'exponential'", Method::EXPONENTIAL),
        ("scheme = 'rkmk4'", Method::RKMK4),
        ("formulation = 'conservative'\nscheme = 'rkmk4'", Method::RKMK4),
        ("scheme = 'paper'", frames_rk4::PAPER),
        ("formulation = 'paper'", frames_rk4::PAPER),
        ("formulation = 'paper'\nscheme = 'paper'", frames_rk4::PAPER),
        ("formulation = 'paper'\nscheme = 'rkmk4'", frames_rk4::LIMIT),
    ] {
        let body = Body::parse(&least(keys), "a.toml").unwrap_or_else(|error| panic!("{keys}: {error}"));
        assert_eq!(*body.method(), method, "{keys}");
    }
}

#[test]
fn steps_or_a_tolerance_and_the_rows() {
    let tolerance = "end = 1\ntolerance = 1e-8";
    for (time, output, stepping, rows) in [
        ("end = 1\nstep = 0.5", "", StepControl::Fixed(0.5), Rows::EverySteps(1)),
        ("end = 1\nstep = 0.5", "every = 7", StepControl::Fixed(0.5), Rows::EverySteps(7)),
        ("end = 1\nstep = 0.5", "interval = 0.25", StepControl::Fixed(0.5), Rows::Interval(0.25)),
        ("end = 1\nstep = 0.5\nscheme = 'paper'", "interval = 1", StepControl::Fixed(0.5), Rows::Interval(1.0)),
        (tolerance, "", StepControl::Tolerance(1e-8), Rows::Interval(0.002)),
        ("end = 1\nscheme = 'rkmk4'\ntolerance = 0.5", "", StepControl::Tolerance(0.5), Rows::Interval(0.002)),
        (tolerance, "interval = 1", StepControl::Tolerance(1e-8), Rows::Interval(1.0)),
    ] {
        let text = least(&format!("[output]\n{output}\n")).replace("end = 1\nstep = 1", time);
        let body = Body::parse(&text, "a.toml").unwrap_or_else(|error| panic!("{text}: {error}"));
        assert_eq!((body.time.control, body.rows), (stepping, rows), "{text}");
    }
}

#[test]
fn numbers_in_every_writing() {
    for (written, value) in [
        ("2_000", 2000.0),
        ("+3", 3.0),
        ("0x10", 16.0),
        ("2_000.5", 2000.5),
        ("-1E3", -1000.0),
        ("1000000000000000000000000", 1e24),
    ] {
        let text = least(&format!("[initial]\nvelocity = [0, {written}, 0]"));
        assert_eq!(Body::parse(&text, "").unwrap().initial.velocity, [0.0, value, 0.0]);
    }
}

/// Closed form: the direction (0, −3, 4)/5.
#[test]
fn every_optional_key() {
    let text = least(
        "[initial]\nangular_velocity = [1, 2, 3]\n[[loads]]\nkind = 'force'\nat = [0, 0, 0]\n\
         direction = [0, -3e200, 4e200]\namplitude = -2\n\
         history = { kind = 'half-sine', duration = 3, start = -1 }\n[output]\nevery = 5\n",
    )
    .replace("flexible = 0", "flexible = 2\nmodes.damping_ratio = 1.5")
    .replace("modes.flexible", "body.point_masses = [{ at = [1, 2, 3], mass = 4, spread = 5 }]\nmodes.flexible");
    let body = Body::parse(&text, "/a/b.toml").unwrap();
    assert_eq!(meshed(&body).mesh, Path::new("/a/a.msh"));
    assert_eq!(meshed(&body).point_masses[0].spread, Some(5.0));
    assert_eq!((body.modes.flexible, &body.modes.damping), (Flexible::Count(2), &Damping::Uniform(1.5)));
    assert_eq!(body.initial.velocity, [0.0; 3]);
    assert_eq!(body.initial.angular_velocity, [1.0, 2.0, 3.0]);
    let force = &body.loads[0];
    assert_eq!(force.kind, LoadKind::Force);
    for (found, wanted) in force.direction.iter().zip([0.0, -0.6, 0.8]) {
        assert!((found - wanted).abs() < 1e-15, "{:?}", force.direction);
    }
    assert_eq!((force.amplitude, force.frame), (-2.0, LoadFrame::Global));
    assert_eq!(force.history, History::HalfSine { start: -1.0, duration: 3.0 });
    assert_eq!(body.rows, Rows::EverySteps(5));

    let absolute = text.replace("'a.msh'", "'/meshes/a.msh'");
    let body = Body::parse(&absolute, "/a/b.toml").unwrap();
    assert_eq!(meshed(&body).mesh, Path::new("/meshes/a.msh"));
}

#[test]
fn later_checks_name_the_place() {
    let body = Body::parse(EXAMPLE, "plate.toml").unwrap();
    for (key, start) in [
        ("body.mesh", "\"../meshes"),
        ("body.material", "{ young"),
        ("body.point_masses[0]", "{ at"),
        ("body.point_masses[0].at", "[-500.0, -25.0, 0.0], mass"),
        ("loads[0]", "[[loads]]"),
        ("loads[0].at", "[-500.0, 0.0, 10.0]"),
        ("frame.Q", "[500.0, 25.0"),
        ("output.points.P1", "[-500.0, -25.0, 0.0] }\n"),
        ("output.points.P2", "{ P1"),
        ("body.point_masses[7].at", "[ { at"),
    ] {
        let place = body.place(key);
        let at = EXAMPLE.rfind(start).unwrap();
        let line = 1 + EXAMPLE[..at].matches('\n').count();
        let column = 1 + at - EXAMPLE[..at].rfind('\n').unwrap() - 1;
        assert_eq!((place.line, place.column, place.key.as_str()), (line, column, key));
        assert_eq!(place.to_string(), format!("plate.toml:{line}:{column}: `{key}`"));
    }
    let error = body.refuse("loads[0].at", "12 mm to the mesh", "at most 1 mm", "move it");
    assert_eq!(
        error.to_string(),
        "plate.toml:26:6: `loads[0].at`: found 12 mm to the mesh, expected at most 1 mm\n   \
            |\n\
         26 | at = [-500.0, 0.0, 10.0]\n   \
            |      ^^^^^^^^^^^^^^^^^^^\n   \
            = move it"
    );
}

#[test]
fn files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.toml");
    std::fs::write(&path, EXAMPLE).unwrap();
    assert_eq!(Body::read(&path).unwrap(), Body::parse(EXAMPLE, &path).unwrap());

    std::fs::write(&path, EXAMPLE.replace('\n', "\r\n")).unwrap();
    assert_eq!(Body::read(&path).unwrap().time.control, StepControl::Fixed(1e-4));

    std::fs::write(&path, format!("\u{feff}{EXAMPLE}")).unwrap();
    assert_eq!(Body::read(&path).unwrap().text_alone, EXAMPLE);

    let refusal = |path: &Path| {
        let error = Body::read(path).unwrap_err();
        assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
        (error.to_string(), error)
    };
    let (message, error) = refusal(&folder.path().join("palte.toml"));
    assert!(matches!(error, SceneError::Unreadable { .. }) && error.place().is_none());
    assert!(message.contains("cannot be read") && message.contains("check its name"), "{message}");

    let (message, error) = refusal(folder.path());
    assert!(matches!(error, SceneError::Unreadable { .. }));
    assert!(message.contains("this is a folder"), "{message}");
    // Nor is anything opened that might never end.
    #[cfg(unix)]
    {
        let (message, _) = refusal(Path::new("/dev/zero"));
        assert!(message.contains("not an ordinary file but a device or a pipe"), "{message}");
    }

    std::fs::write(&path, b"title = 'a'\n# caf\xe9\n").unwrap();
    let (message, error) = refusal(&path);
    assert!(matches!(error, SceneError::NotUtf8 { line: 2, byte: 0xe9, .. }));
    assert!(message.contains("plate.toml:2: ") && message.contains("encoding UTF-8"), "{message}");

    let limit = 1 << 20;
    let mut long = EXAMPLE.to_owned() + "#";
    long.push_str(&"x".repeat(limit - long.len()));
    std::fs::write(&path, &long).unwrap();
    Body::read(&path).unwrap();
    std::fs::write(&path, long + "x").unwrap();
    let (message, error) = refusal(&path);
    assert!(matches!(error, SceneError::TooLarge { limit: 1_048_576, .. }));
    assert!(message.contains("longer than 1048576 bytes"), "{message}");
}
