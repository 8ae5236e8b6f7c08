//! Constraints and drives of the body.

use scene::{Body, Constraint, DrivenSpeed, HeldDirections, HingeLine, History, Region};

use crate::common::EXAMPLE;

const FROM: &str = "[initial]";
const TO: &str = "[[loads]]";

fn held(lines: &str) -> Constraint {
    crate::parts::with(FROM, TO, &format!("[[constraints]]\n{lines}")).constraint.unwrap()
}

#[track_caller]
fn refused(lines: &str, mark: &str, key: &str, words: &[&str]) {
    crate::parts::refused(FROM, TO, &format!("[[constraints]]\n{lines}"), mark, &format!("constraints[0]{key}"), words);
}

#[test]
fn a_pin() {
    let at = [1.0, 2.0, 3.0];
    assert_eq!(held("kind = \"pin\"\nat = [1, 2, 3]"), Constraint::Pin { at, radius: None });
    assert_eq!(held("kind = \"pin\"\nat = [1, 2, 3]\nradius = 4"), Constraint::Pin { at, radius: Some(4.0) });
    refused("kind = \"pin\"", "[[constraints", ".at", &["`at` is missing", "at = [0.0"]);
    refused(
        "kind = \"pin\"\nat = [1, 2, 3]\nradius = 0",
        "0\n\n[[",
        ".radius",
        &["found 0, expected a number greater"],
    );
    refused("kind = \"pin\"\nat = [1, 2, 3]\ngroup = \"a\"", "group", ".group", &["unknown key `group`", "`radius`"]);
}

/// Closed form: the direction (0, 3, 4)/5.
#[test]
fn a_hinge() {
    let at = [1.0, 2.0, 3.0];
    let hinge = |lines: &str| match held(&format!("kind = \"hinge\"\n{lines}")) {
        Constraint::Hinge { line, shaft, motion } => (line, shaft, motion),
        other => panic!("{other:?}"),
    };
    let (line, shaft, motion) = hinge("at = [1, 2, 3]\naxis = [0, 3, 4]");
    assert_eq!(line, HingeLine::Axis { at, direction: line.direction() });
    assert_eq!((line.at(), shaft, motion), (at, vec![], None));
    assert!((line.direction()[1] - 0.6).abs() < 1e-15 && (line.direction()[2] - 0.8).abs() < 1e-15);

    let points = [at, [1.0, 2.0, 7.0]];
    let (line, shaft, _) = hinge("points = [[1, 2, 3], [1, 2, 7]]");
    assert_eq!((line, shaft), (HingeLine::Points(points), vec![]));
    assert_eq!((line.at(), line.direction()), (at, [0.0, 0.0, 1.0]));

    let ball = |at| Region::Ball { at, radius: 0.5 };
    assert_eq!(hinge("at = [1, 2, 3]\naxis = [0, 0, 1]\nradius = 0.5").1, [ball(at)]);
    assert_eq!(hinge("points = [[1, 2, 3], [1, 2, 7]]\nradius = 0.5").1, points.map(ball));
    let volume = Region::Box { low: [0.0, 0.0, 0.0], high: [1.0, 2.0, 3.0] };
    assert_eq!(hinge("at = [1, 2, 3]\naxis = [0, 0, 1]\nbox = [[0, 0, 0], [1, 2, 3]]").1, [volume]);
    let (_, shaft, motion) = hinge(
        "at = [1, 2, 3]\naxis = [0, 0, 1]\ngroup = \"shaft\"\n\
         motion = { amplitude = -6, history = { kind = \"ramp\", duration = 15 } }",
    );
    assert_eq!(shaft, [Region::Group("shaft".to_owned())]);
    let history = History::Ramp { start: 0.0, duration: 15.0 };
    assert_eq!(motion, Some(DrivenSpeed { amplitude: -6.0, history }));
}

#[test]
fn what_is_no_hinge() {
    let axis = "kind = \"hinge\"\nat = [1, 2, 3]\naxis = [0, 0, 1]\n";
    for (lines, mark, key, words) in [
        ("", "[[constraints", "", "found neither `at` and `axis` nor `points`, expected the line of the hinge"),
        ("at = [1, 2, 3]", "[[constraints", ".axis", "`axis` is missing"),
        ("axis = [1, 2, 3]", "[[constraints", ".at", "`at` is missing"),
        (
            "at = [1, 2, 3]\naxis = [0, 0, 0]",
            "[0, 0, 0]",
            ".axis",
            "found [0, 0, 0], expected a vector that is not zero",
        ),
        ("points = [[1, 2, 3], [1, 2, 3]]", "[[1, 2", ".points", "found the same point twice"),
        ("points = [[1, 2, 3]]", "[[1, 2", ".points", "found a list of 1 entry"),
        ("points = [[1, 2, 3], [1, 2, 4]]\nat = [9, 2, 3]", "[9", ".at", "both `at` and `points`"),
        ("points = [[1, 2, 3], [1, 2, 4]]\naxis = [9, 2, 3]", "[9", ".axis", "both `axis` and `points`"),
    ] {
        refused(&format!("kind = \"hinge\"\n{lines}"), mark, key, &[words]);
    }
    for (lines, mark, key, words) in [
        ("radius = -1", "-1", ".radius", "found -1, expected a number greater than 0"),
        ("radius = 1\ngroup = \"a\"", "\"a\"", ".group", "both `radius` and `group`, expected at most one"),
        ("box = [[0, 0, 0], [1, 1, 1]]\ngroup = \"a\"", "\"a\"", ".group", "both `box` and `group`"),
        ("group = \"\"", "\"\"", ".group", "expected a name that is not empty"),
        ("box = [[0, 0, 0], [1, -1, 1]]", "[[0, 0, 0], [1", ".box", "whose first corner is not above its second"),
        ("motion = { amplitude = 1, history = 'constant' }", "{ amp", ".motion", "a driven hinge without a shaft"),
        ("radius = 1\nmotion = { amplitude = 1 }", "{ amp", ".motion.history", "`history` is missing"),
        ("radius = 1\nmotion = { history = 'constant' }", "{ his", ".motion.amplitude", "`amplitude` is missing"),
        (
            "radius = 1\nmotion = { amplitude = 1, history = { kind = 'ramp', duration = 0 } }",
            "0 } }",
            ".motion.history.duration",
            "found 0, expected a number greater than 0",
        ),
    ] {
        refused(&format!("{axis}{lines}"), mark, key, &[words]);
    }
}

#[test]
fn a_clamp_and_a_slider() {
    let region = Region::Ball { at: [1.0, 2.0, 3.0], radius: 4.0 };
    assert_eq!(held("kind = \"clamp\"\nat = [1, 2, 3]\nradius = 4"), Constraint::Clamp { region: region.clone() });
    let slider = held("kind = \"slider\"\ndirection = [0, -2, 0]\nat = [1, 2, 3]\nradius = 4");
    let direction = [0.0, -1.0, 0.0];
    assert_eq!(slider, Constraint::Slider { direction, region: Some(region), motion: None });
    let driven = held(
        "kind = \"slider\"\ndirection = [0, -2, 0]\ngroup = \"base\"\n\
         motion = { amplitude = 2, history = { kind = \"sine\", frequency = 5 } }",
    );
    let history = History::Sine { frequency: 5.0, phase: 0.0, start: 0.0, duration: None };
    let motion = Some(DrivenSpeed { amplitude: 2.0, history });
    assert_eq!(driven, Constraint::Slider { direction, region: Some(Region::Group("base".to_owned())), motion });

    for kind in ["kind = \"clamp\"\n", "kind = \"slider\"\ndirection = [1, 0, 0]\n"] {
        for (lines, mark, key, words) in [
            ("", "[[constraints", "", "found none of `radius`, `box` and `group`, expected the part of the body"),
            ("radius = 4", "[[constraints", ".at", "`at` is missing"),
            ("at = [9, 2, 3]", "[9", ".at", "found `at` without `radius`, expected both of them, or neither"),
            ("at = [9, 2, 3]\ngroup = \"a\"", "[9", ".at", "found `at` without `radius`"),
            ("at = [9, 2, 3]\nradius = 0", "0\n\n[[loads", ".radius", "found 0, expected a number greater than 0"),
            ("box = [[0, 0, 0], [1, -1, 1]]", "[[0, 0, 0], [1", ".box", "is not above its second in any coordinate"),
        ] {
            refused(&format!("{kind}{lines}"), mark, key, &[words]);
        }
    }
    refused("kind = \"slider\"\ngroup = \"a\"", "[[constraints", ".direction", &["`direction` is missing"]);
    let zero = "kind = \"slider\"\ngroup = \"a\"\ndirection = [0, 0, 0.0]";
    refused(zero, "[0, 0, 0.0]", ".direction", &["expected a vector that is not zero"]);
}

#[test]
fn supports_hold_directions_of_regions() {
    let group = |name: &str| Region::Group(name.to_owned());
    let one = "kind = \"support\"\ndirections = [\"z\", \"x\"]\ngroup = \"a\"";
    let part = HeldDirections { region: group("a"), directions: [true, false, true] };
    assert_eq!(held(one), Constraint::Support { parts: vec![part.clone()] });
    let two = format!("{one}\n[[constraints]]\nkind = \"support\"\ndirections = [\"y\"]\ngroup = \"b\"");
    let other = HeldDirections { region: group("b"), directions: [false, true, false] };
    assert_eq!(held(&two), Constraint::Support { parts: vec![part, other] });

    let support = "kind = \"support\"\ngroup = \"a\"\n";
    let expected = ["expected one to three of \"x\", \"y\" and \"z\""];
    refused(&format!("{support}directions = []"), "[]", ".directions", &expected);
    refused(&format!("{support}directions = [\"w\"]"), "\"w\"", ".directions[0]", &expected);
    refused(&format!("{support}directions = ['z', \"z\"]"), "\"z\"]", ".directions[1]", &expected);
    refused(support, "[[constraints", ".directions", &["`directions` is missing"]);
    let nowhere = "kind = \"support\"\ndirections = [\"z\"]";
    refused(nowhere, "[[constraints", "", &["found none of `radius`, `box` and `group`"]);
    let mixed = format!("[[constraints]]\n{one}\n[[constraints]]\nkind = \"clamp\"\ngroup = \"a\"");
    let words = ["found another constraint beside one of the kind `support`"];
    crate::parts::refused(FROM, TO, &mixed, "\"clamp\"", "constraints[1].kind", &words);
}

#[test]
fn kinds_and_numbers_of_constraints() {
    refused(
        "kind = \"hing\"",
        "\"hing\"",
        ".kind",
        &["did you mean `hinge`?", "`pin`, `hinge`, `clamp`, `slider`, `support`"],
    );
    refused("at = [0, 0, 0]", "[[constraints", ".kind", &["`kind` is missing", "kind = \"hinge\""]);
    let two = "[[constraints]]\nkind = \"pin\"\nat = [0, 0, 0]\n[[constraints]]\nkind = \"pin\"\nat = [1, 0, 0]";
    let words = ["found 2 constraints, expected at most one, unless all are of the kind `support`", "keep one"];
    crate::parts::refused(FROM, TO, two, "[[constraints]]\nkind = \"pin\"\nat = [1", "constraints[1]", &words);
    let table = "[constraints]\nkind = \"pin\"\nat = [0, 0, 0]";
    let words = ["found a table, expected a list", "write it like this:\n     [[constraints]]\n     kind = \"hinge\""];
    crate::parts::refused(FROM, TO, table, "[constraints]", "constraints", &words);
}

#[test]
fn the_initial_motion_that_a_constraint_leaves() {
    let hinge = "[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 1, 1]\n";
    let driven = format!("{hinge}radius = 1\nmotion = {{ amplitude = 1, history = \"constant\" }}\n");
    let slider = "[[constraints]]\nkind = \"slider\"\ndirection = [1, 0, 0]\ngroup = \"a\"\n";
    let pin = "[[constraints]]\nkind = \"pin\"\nat = [0, 0, 0]\n";
    let clamp = "[[constraints]]\nkind = \"clamp\"\ngroup = \"a\"\n";
    for (constraint, lines) in [
        (pin, "angular_velocity = [1, 2, 3]"),
        (hinge, "angular_velocity = [0, -2, -2]"),
        (slider, "velocity = [-3, 0, 0]"),
        (&driven, "modal_velocity = [1]"),
        (clamp, "modal_displacement = [1]"),
    ] {
        crate::parts::with(FROM, TO, &format!("{constraint}[initial]\n{lines}"));
    }
    for (constraint, name, value, words) in [
        (pin, "velocity", "[9, 0, 0]", "found [9, 0, 0], expected 0 with this constraint"),
        (hinge, "velocity", "[9, 0, 0]", "remove it: it follows from the angular velocity about the hinge"),
        (hinge, "angular_velocity", "[0, 9, 9.1]", "expected a multiple of [0.000000, 0.707107, 0.707107]"),
        (&driven, "angular_velocity", "[0, 9, 9]", "remove it: `motion` gives it"),
        (slider, "velocity", "[9, 1, 0]", "expected a multiple of [1.000000, 0.000000, 0.000000]"),
        (slider, "angular_velocity", "[9, 0, 0]", "a slider does not turn"),
        (clamp, "velocity", "[9, 0, 0]", "a clamped body stays"),
        (clamp, "angular_velocity", "[9, 0, 0]", "a clamped body stays"),
    ] {
        let new = format!("{constraint}[initial]\n{name} = {value}");
        crate::parts::refused(FROM, TO, &new, value, &format!("initial.{name}"), &[words]);
    }
}

#[test]
fn a_rigid_body_is_held_without_nodes() {
    let rigid =
        "[body]\nrigid = { mass = 1, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }\n";
    let text = |lines: &str| {
        let text = EXAMPLE.replace(crate::parts::section("[body]", "[frame]"), rigid);
        text.replace(crate::parts::section(FROM, TO), &format!("[[constraints]]\n{lines}\n"))
    };
    let motion = "motion = { amplitude = 1, history = \"constant\" }";
    for lines in [
        "kind = \"pin\"\nat = [0, 0, 0]".to_owned(),
        format!("kind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\n{motion}"),
        format!("kind = \"slider\"\ndirection = [0, 0, 1]\n{motion}"),
    ] {
        Body::parse(&text(&lines), "a.toml").unwrap_or_else(|error| panic!("{error}"));
    }
    for (lines, key, words) in [
        ("kind = \"pin\"\nat = [0, 0, 0]\nradius = 1", "radius", "found a part of a mesh, expected none"),
        ("kind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\nradius = 1", "radius", "found a part of a mesh"),
        ("kind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\ngroup = \"a\"", "group", "found a part of a mesh"),
        ("kind = \"slider\"\ndirection = [0, 0, 1]\nbox = [[0, 0, 0], [1, 1, 1]]", "box", "found a part of a mesh"),
        ("kind = \"clamp\"\ngroup = \"a\"", "kind", "found a rigid body that is clamped"),
        ("kind = \"support\"\ndirections = [\"x\"]\ngroup = \"a\"", "group", "found a part of a mesh"),
    ] {
        let message = Body::parse(&text(lines), "a.toml").unwrap_err().to_string();
        assert!(message.contains(&format!("`constraints[0].{key}`: {words}")), "{message}");
    }
}
