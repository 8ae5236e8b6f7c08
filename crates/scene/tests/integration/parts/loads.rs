//! Loads of the body.

use scene::{Body, History, Load, LoadFrame, LoadKind, LoadPlace};

use crate::common::EXAMPLE;

const FROM: &str = "[[loads]]";
const TO: &str = "[time]";

fn load(lines: &str) -> Load {
    let pin = "[[constraints]]\nkind = \"pin\"\nat = [0, 0, 0]\n\n";
    let [load] = crate::parts::with(FROM, TO, &format!("{pin}[[loads]]\n{lines}")).loads.try_into().unwrap();
    load
}

#[track_caller]
fn refused(lines: &str, mark: &str, key: &str, words: &[&str]) {
    crate::parts::refused(FROM, TO, &format!("[[loads]]\n{lines}"), mark, &format!("loads[0].{key}"), words);
}

#[test]
fn every_kind() {
    let expected = |kind, place, frame| Load {
        kind,
        place,
        direction: if kind == LoadKind::Pressure { [0.0; 3] } else { [0.0, 0.0, -1.0] },
        frame,
        amplitude: 5.0,
        history: History::Constant,
    };
    let (point, top) = (LoadPlace::Point([1.0, 2.0, 3.0]), LoadPlace::Surface("top".to_owned()));
    let along = "direction = [0, 0, -7]\namplitude = 5";
    let force = format!("kind = \"force\"\nat = [1, 2, 3]\n{along}\nframe = \"body\"");
    assert_eq!(load(&force), expected(LoadKind::Force, point.clone(), LoadFrame::Body));
    let moment = format!("kind = \"moment\"\nat = [1, 2, 3]\n{along}\n");
    assert_eq!(load(&moment), expected(LoadKind::Moment, point, LoadFrame::Global));
    let ball = LoadPlace::Ball { at: [1.0, 2.0, 3.0], radius: 2.0 };
    assert_eq!(
        load(&format!("{moment}radius = 2\nhistory = {{ kind = \"step\", at = 0.1 }}")),
        Load { history: History::Step { at: 0.1 }, ..expected(LoadKind::Moment, ball, LoadFrame::Global) }
    );
    assert_eq!(
        load("kind = \"pressure\"\ngroup = \"top\"\namplitude = -5"),
        Load { amplitude: -5.0, ..expected(LoadKind::Pressure, top.clone(), LoadFrame::Body) }
    );
    assert_eq!(
        load(&format!("kind = \"traction\"\ngroup = \"top\"\n{along}\nframe = \"global\"")),
        expected(LoadKind::Traction, top, LoadFrame::Global)
    );
    let everywhere = |kind| expected(kind, LoadPlace::Everywhere, LoadFrame::Global);
    assert_eq!(load(&format!("kind = \"gravity\"\n{along}")), everywhere(LoadKind::Gravity));
    assert_eq!(
        load(&format!("kind = \"base-acceleration\"\n{along}\nhistory = \"constant\"")),
        everywhere(LoadKind::BaseAcceleration)
    );
}

#[test]
fn what_is_no_load() {
    let kinds = "`force`, `moment`, `pressure`, `traction`, `gravity`, `base-acceleration`";
    for (found, near) in [("tracton", "traction"), ("presure", "pressure"), ("base_acceleration", "base-acceleration")]
    {
        let near = format!("did you mean `{near}`?");
        refused(&format!("kind = \"{found}\""), &format!("\"{found}\""), "kind", &[&near, kinds]);
    }
    for (lines, mark, key, words) in [
        ("kind = \"moment\"\ndirection = [0, 0, 1]\namplitude = 1", "[[loads", "at", "`at` is missing"),
        (
            "kind = \"moment\"\nat = [0, 0, 0]\ndirection = [0, 0, 1]\namplitude = 1\nradius = -77",
            "-77",
            "radius",
            "found -77, expected a number greater than 0",
        ),
        ("kind = \"pressure\"\namplitude = 1", "[[loads", "group", "`group` is missing"),
        ("kind = \"pressure\"\ngroup = \"\"\namplitude = 1", "\"\"", "group", "a name that is not empty"),
        ("kind = \"pressure\"\ngroup = \"a\"\namplitude = 1\nframe = \"body\"", "frame =", "frame", "unknown key"),
        ("kind = \"traction\"\ngroup = \"a\"\namplitude = 1", "[[loads", "direction", "`direction` is missing"),
        (
            "kind = \"traction\"\ngroup = \"a\"\ndirection = [0, 0, 0]\namplitude = 1",
            "[0, 0, 0]",
            "direction",
            "expected a vector that is not zero",
        ),
        ("kind = \"gravity\"\ndirection = [0, 0, 0]\namplitude = 1", "[0, 0, 0]", "direction", "that is not zero"),
        ("kind = \"gravity\"\ndirection = [0, 0, -1]", "[[loads", "amplitude", "`amplitude` is missing"),
        (
            "kind = \"base-acceleration\"\ndirection = [0, 0, 1]\namplitude = 1",
            "[[loads",
            "history",
            "`history` is missing",
        ),
        (
            "kind = \"base-acceleration\"\ndirection = [0, 0, 1]\namplitude = 1\nhistory = \"constant\"",
            "\"base-acc",
            "kind",
            "found the acceleration of the base of a free body, expected a body that something holds",
        ),
        (
            "kind = \"force\"\nat = [0, 0, 0]\ndirection = [0, 0, 1]\namplitude = 1\nframe = \"bdy\"",
            "\"bdy\"",
            "frame",
            "did you mean `body`? ",
        ),
    ] {
        refused(lines, mark, key, &[words.trim_end()]);
    }
}

#[test]
fn surfaces_need_a_mesh() {
    let rigid =
        "[body]\nrigid = { mass = 1, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }\n";
    let free = EXAMPLE.replace(crate::parts::section("[body]", "[frame]"), rigid);
    for (lines, key) in [
        ("kind = \"pressure\"\ngroup = \"a\"\namplitude = 1", "group"),
        ("kind = \"traction\"\ngroup = \"a\"\ndirection = [0, 0, 1]\namplitude = 1", "group"),
        ("kind = \"moment\"\nat = [0, 0, 0]\ndirection = [0, 0, 1]\namplitude = 1\nradius = 2", "radius"),
    ] {
        let text = free.replace(crate::parts::section(FROM, TO), &format!("[[loads]]\n{lines}\n\n"));
        let message = Body::parse(&text, "a.toml").unwrap_err().to_string();
        let words = format!("`loads[0].{key}`: found a part of a mesh, expected none, since `rigid` in [body]");
        assert!(message.contains(&words), "{message}");
    }
}
