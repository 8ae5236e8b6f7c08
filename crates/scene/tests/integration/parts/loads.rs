//! Loads of the body.

use scene::{BaseAcceleration, Force, Gravity, History, Load, LoadFrame, Moment, Pressure, Scene, Traction};

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
    let (at, direction) = ([1.0, 2.0, 3.0], [0.0, 0.0, -1.0]);
    let constant = History::Constant;
    assert_eq!(
        load("kind = \"force\"\nat = [1, 2, 3]\ndirection = [0, 0, -7]\namplitude = 5\nframe = \"body\""),
        Load::Force(Force { at, direction, amplitude: 5.0, frame: LoadFrame::Body, history: constant.clone() })
    );
    let moment = "kind = \"moment\"\nat = [1, 2, 3]\ndirection = [0, 0, -7]\namplitude = 5\n";
    let expected = Moment { at, direction, amplitude: 5.0, frame: LoadFrame::Global, history: constant, radius: None };
    assert_eq!(load(moment), Load::Moment(expected.clone()));
    assert_eq!(
        load(&format!("{moment}radius = 2\nhistory = {{ kind = \"step\", at = 0.1 }}")),
        Load::Moment(Moment { radius: Some(2.0), history: History::Step { at: 0.1 }, ..expected })
    );
    let (group, history) = ("top".to_owned(), History::Constant);
    assert_eq!(
        load("kind = \"pressure\"\ngroup = \"top\"\namplitude = -5"),
        Load::Pressure(Pressure { group: group.clone(), amplitude: -5.0, history: history.clone() })
    );
    assert_eq!(
        load("kind = \"traction\"\ngroup = \"top\"\ndirection = [0, 0, -7]\namplitude = 5\nframe = \"global\""),
        Load::Traction(Traction { group, direction, amplitude: 5.0, frame: LoadFrame::Global, history })
    );
    assert_eq!(
        load("kind = \"gravity\"\ndirection = [0, 0, -7]\namplitude = 9.81"),
        Load::Gravity(Gravity { direction, amplitude: 9.81, history: History::Constant })
    );
    assert_eq!(
        load("kind = \"base-acceleration\"\ndirection = [0, 0, -7]\namplitude = 5\nhistory = \"constant\""),
        Load::BaseAcceleration(BaseAcceleration { direction, amplitude: 5.0, history: History::Constant })
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
        let message = Scene::parse(&text, "a.toml").unwrap_err().to_string();
        let words = format!("`loads[0].{key}`: found a part of a mesh, expected none, since `rigid` in [body]");
        assert!(message.contains(&words), "{message}");
    }
}
