//! Which effects are simulated.

use scene::{Choice, Effect, EffectMap};

const KEYS: [&str; 9] = [
    "flexibility",
    "damping",
    "gravity",
    "deformed_inertia",
    "coriolis",
    "geometric_stiffening",
    "large_deflection",
    "translation",
    "rotation",
];

/// Asserts that the keys of effects are refused beside other sections.
#[track_caller]
fn refused(others: &str, line: &str, words: &[&str]) {
    let (name, value) = line.split_once(" = ").unwrap();
    let new = format!("{others}\n[effects]\n{line} #");
    crate::parts::refused("[initial]", "[[loads]]", &new, &format!("{value} #"), &format!("effects.{name}"), words);
}

#[test]
fn each_alone() {
    const GRAVITY: &str = "[[loads]]\nkind = \"gravity\"\ndirection = [0, 0, -1]\namplitude = 9.81\n";
    for (written, choice) in [("true", Choice::On), ("false", Choice::Off), ("\"auto\"", Choice::Auto)] {
        for (effect, key) in Effect::ALL.into_iter().zip(KEYS) {
            let new = format!("[effects]\n{key} = {written}\n{GRAVITY}");
            let effects = crate::parts::with("[initial]", "[[loads]]", &new).effects;
            let wanted = EffectMap::from_fn(|other| if other == effect { choice } else { Choice::Auto });
            assert_eq!((effects.choices, effects.tolerance), (wanted, 1e-3), "{key}");
        }
    }
    assert_eq!(crate::parts::with("[initial]", "[[loads]]", "[effects]\ntolerance = 0.01").effects.tolerance, 0.01);
    assert!(!crate::parts::with("[initial]", "[[loads]]", "[effects]\nrefuse = false").effects.refuse);
}

#[test]
fn values_and_keys() {
    for value in ["0", "1", "-1e-3"] {
        refused("", &format!("tolerance = {value}"), &["expected a number between 0 and 1, both excluded"]);
    }
    refused("", "rotation = \"aut\"", &["did you mean `auto`?"]);
    refused("", "rotation = \"no\"", &["found the string \"no\", expected true, false or \"auto\""]);
    refused("", "rotation = 1", &["found the number 1, expected true, false or \"auto\"", "`rotation = \"auto\"`"]);
    let new = "[effects]\ncoriolys = true";
    crate::parts::refused("[initial]", "[[loads]]", new, "coriolys", "effects.coriolys", &["did you mean `coriolis`?"]);
}

#[test]
fn what_there_is_nothing_to() {
    for key in ["damping", "deformed_inertia", "coriolis", "geometric_stiffening", "large_deflection"] {
        let new = format!("[effects]\nflexibility = false\n{key} = true");
        let words = format!("found `{key} = true` with `flexibility = false`, expected `false` or `\"auto\"`");
        crate::parts::refused("[initial]", "[[loads]]", &new, "true\n\n[[loads", &format!("effects.{key}"), &[&words]);
    }
    for key in ["flexibility", "damping", "deformed_inertia", "coriolis", "geometric_stiffening"] {
        let new = format!("[modes]\nflexible = 0\n[effects]\n{key} = true");
        let words = format!("found `{key} = true` with no flexible modes");
        let key = format!("effects.{key}");
        crate::parts::refused(
            "[modes]",
            "[[loads]]",
            &new,
            "true\n\n[[loads",
            &key,
            &[&words, "or keep flexible modes"],
        );
    }
    refused("", "gravity = true", &["with no load `kind = \"gravity\"`", "or add it to [[loads]]"]);
    let held = |kind: &str| format!("[[constraints]]\n{kind}\n");
    let pin = held("kind = \"pin\"\nat = [0, 0, 0]");
    let hinge = held("kind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]");
    let clamp = held("kind = \"clamp\"\ngroup = \"a\"");
    let slider = held("kind = \"slider\"\ndirection = [1, 0, 0]\ngroup = \"a\"");
    for (constraint, key) in [
        (&pin, "translation"),
        (&hinge, "translation"),
        (&clamp, "translation"),
        (&clamp, "rotation"),
        (&slider, "rotation"),
    ] {
        refused(constraint, &format!("{key} = true"), &["with a constraint that leaves none"]);
    }
    for (constraint, key) in [(&pin, "rotation"), (&hinge, "rotation"), (&slider, "translation")] {
        crate::parts::with("[initial]", "[[loads]]", &format!("{constraint}\n[effects]\n{key} = true"));
    }
}

#[test]
fn what_is_there_by_force() {
    let motion = "motion = { amplitude = 1, history = \"constant\" }";
    let hinge = format!("[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\nradius = 3\n{motion}\n");
    let slider = format!("[[constraints]]\nkind = \"slider\"\ndirection = [1, 0, 0]\ngroup = \"a\"\n{motion}\n");
    refused(&hinge, "rotation = false", &["found `rotation = false` with the `motion` of the constraint"]);
    refused(&slider, "translation = false", &["found `translation = false` with the `motion` of the constraint"]);
    let initial = |line: &str| format!("[initial]\n{line}\n");
    let angular = initial("angular_velocity = [0, 0, 1]");
    refused(&angular, "rotation = false", &["with an initial `angular_velocity`", "or remove an initial"]);
    refused(&initial("velocity = [0, 0, 1]"), "translation = false", &["with an initial `velocity`"]);
    for list in ["modal_displacement = [0, 1]", "modal_velocity = [1]"] {
        refused(&initial(list), "flexibility = false", &["with an initial modal displacement or velocity"]);
    }
}

#[test]
fn the_paper_s_formulation_has_the_effects_that_it_has() {
    let of_paper = crate::common::EXAMPLE
        .replace("formulation = \"conservative\"", "formulation = \"paper\"")
        .replace("scheme = \"exponential\"", "scheme = \"paper\"");
    let parse = |line: &str| {
        scene::Body::parse(&of_paper.replace("[initial]", &format!("[effects]\n{line}\n[initial]")), "dir/plate.toml")
    };
    for line in ["coriolis = false", "deformed_inertia = false", "rotation = false", "geometric_stiffening = true"] {
        let message = parse(line).unwrap_err().to_string();
        assert!(message.contains(&format!("`{line}` with the paper's formulation")), "{message}");
    }
    for line in ["coriolis = true", "geometric_stiffening = false", "damping = false", "flexibility = false"] {
        assert!(parse(line).is_ok(), "{line}");
    }
}
