//! First steps: the wrong file, the wrong option, the wrong unit; and what a summary says.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

use crate::program::command_in;

/// A clamped bar of 200 x 10 x 10 mm of steel under a force at its tip.
const BAR: &str = r#"
title = "Bar"
units = { length = "mm", mass = "Mg", time = "s" }
[body]
mesh = "bar.msh"
material = { young_modulus = 210e3, poisson_ratio = 0.3, density = 7.85e-9 }
[modes]
flexible = 4
damping_ratio = 0.01
[[constraints]]
kind = "clamp"
group = "root"
[[loads]]
kind = "force"
at = [200.0, 5.0, 5.0]
direction = [0.0, 0.0, 1.0]
amplitude = 1.0
history = { kind = "half-sine", duration = 0.002 }
[time]
end = 0.01
tolerance = 1e-4
[output]
interval = 1e-3
points = { tip = [200.0, 5.0, 5.0] }
"#;

/// A folder with the mesh of the bar.
struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../../crates/model/tests/data/bar.msh");
        fs::copy(mesh, desk.path("bar.msh")).unwrap();
        desk.file("bar.toml", BAR);
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    /// The bar with changes, as `x.toml`.
    fn changed(&self, changes: &[(&str, &str)]) {
        let mut text = BAR.to_owned();
        for (from, to) in changes {
            assert!(text.contains(from), "{from}");
            text = text.replace(from, to);
        }
        self.file("x.toml", &text);
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = command_in(self.0.path(), arguments);
        command.stdin(Stdio::null());
        command
    }

    fn output(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Standard output and standard error of a command that succeeds.
    #[track_caller]
    fn done(&self, arguments: &[&str]) -> (String, String) {
        let output = self.output(arguments);
        let [said, told] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert!(output.status.success(), "{arguments:?}: {told}");
        (said, told)
    }

    /// Checks the words of a command that is refused, with this exit code.
    #[track_caller]
    fn refused(&self, code: i32, arguments: &[&str], words: &[&str]) {
        let output = self.output(arguments);
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {told}");
        for word in words {
            assert!(told.contains(word), "{arguments:?}: {word} in: {told}");
        }
    }
}

#[test]
fn a_file_of_another_kind_is_recognized_with_the_command_that_takes_it() {
    let desk = Desk::new();
    desk.done(&["run", "bar.toml", "-o", "out"]);
    desk.done(&["reduce", "bar.toml", "-o", "body.h5"]);
    desk.file("part.stl", "solid x\nendsolid x\n");
    desk.file("sweep.toml", "scene = \"bar.toml\"\n[parameters]\n[results]\n");
    for (arguments, words) in [
        (&["run", "bar.msh"][..], ["a mesh", "expected a scene file", "`flexframe new bar.msh`"]),
        (&["modes", "out/bar.h5"], ["a results file", "expected a scene file", "`flexframe report out/bar.h5`"]),
        (&["advise", "body.h5"], ["a body file", "expected a scene file", "`file = \"…\"` in [body]"]),
        (&["run", "sweep.toml"], ["the file of a sweep", "expected a scene file", "`flexframe sweep sweep.toml`"]),
        (&["report", "bar.toml"], ["a scene", "expected a results file", "`flexframe run bar.toml`"]),
        (&["export", "bar.msh", "--csv", "t.csv"], ["a mesh", "expected a results file", "`flexframe new bar.msh`"]),
        (&["report", "body.h5"], ["a body file", "expected a results file", "`flexframe fmu`"]),
        (&["resume", "bar.toml"], ["a scene", "unfinished results file", "`flexframe run bar.toml`"]),
        (&["sweep", "bar.toml"], ["a scene", "the file of a sweep", "`flexframe run bar.toml`"]),
        (&["new", "bar.toml"], ["a scene", "expected a mesh", "`flexframe run bar.toml`"]),
        (&["new", "out/bar.h5"], ["a results file", "expected a mesh", "`flexframe report out/bar.h5`"]),
        (&["new", "part.stl"], ["a surface of triangles", "no elements", "STEP"]),
        (&["new", "."], ["this is a folder", "cannot read the mesh", "name the mesh file"]),
        (&["fmu", "bar.msh", "-o", "x.fmu"], ["a mesh", "expected a scene", "`flexframe new bar.msh`"]),
    ] {
        let is_folder = arguments[1] == ".";
        desk.refused(if is_folder { 6 } else { 3 }, arguments, &words);
    }
    // For scripts, too.
    let told = desk.output(&["run", "bar.msh", "--json"]).stderr;
    let object: Value = serde_json::from_slice(&told).unwrap();
    assert_eq!(object["kind"], "input");
    assert_eq!(object["expected"], "a scene file");
    assert!(object["help"].as_str().unwrap().contains("flexframe new bar.msh"), "{object}");
    // A scene that names a file of another kind as its mesh.
    desk.file("part.xyz", "1 2 3\n");
    for (mesh, words) in
        [("part.stl", "a surface of triangles"), ("part.xyz", "no mesh or geometry of a format that is read")]
    {
        desk.changed(&[("bar.msh", mesh)]);
        desk.refused(3, &["modes", "x.toml"], &[mesh, words]);
    }
}

#[test]
fn a_results_file_becomes_a_moving_picture() {
    let desk = Desk::new();
    desk.done(&["run", "bar.toml", "-o", "out"]);
    let rows = |gif: &str, more: &[&str]| {
        desk.done(&[&["animate", "out/bar.h5", "-o", gif], more].concat());
        let bytes = fs::read(desk.path(gif)).unwrap();
        assert!(bytes.starts_with(b"GIF89a"));
        bytes
    };
    // Eleven rows: no more frames than these. The frames of the scene itself at the times of the rows are the same ones.
    let all = rows("all.gif", &[]);
    assert_eq!(all, rows("eleven.gif", &["--frames", "11"]));
    desk.done(&["animate", "bar.toml", "-o", "scene.gif", "--frames", "11"]);
    let scene = fs::read(desk.path("scene.gif")).unwrap();
    assert_eq!(frames(&all), 11);
    assert_eq!(frames(&scene), 11);
    assert!((all.len() as f64 / scene.len() as f64 - 1.0).abs() < 0.05, "{} {}", all.len(), scene.len());
    assert_eq!(frames(&rows("part.gif", &["--frames", "3", "--from", "0.002", "--to", "0.008"])), 3);
    desk.refused(2, &["animate", "out/bar.h5", "-o", "x.gif", "--to", "1.0"], &["--to", "from 0 to 0.01"]);
    desk.refused(2, &["animate", "out/bar.h5", "-o", "x.gif", "--set", "time.end=1"], &["--set", "a results file"]);
    fs::remove_file(desk.path("bar.msh")).unwrap();
    assert_eq!(rows("alone.gif", &[]), all);
}

#[test]
fn a_moving_picture_shows_stress_and_modes_and_needs_ffmpeg_for_films_alone() {
    let desk = Desk::new();
    desk.done(&["run", "bar.toml", "-o", "out"]);
    let drawn = |gif: &str, arguments: &[&str]| {
        desk.done(&[&["animate"], arguments, &["-o", gif, "--frames", "4"]].concat());
        fs::read(desk.path(gif)).unwrap()
    };
    let of_results = drawn("results.gif", &["out/bar.h5"]);
    let by_stress = drawn("stress.gif", &["out/bar.h5", "--colour", "stress"]);
    assert_eq!((frames(&by_stress), by_stress == of_results), (4, false));
    assert_ne!(drawn("xz.gif", &["out/bar.h5", "--view", "xz"]), of_results);
    // A bar is as thick as it is wide: its first two modes are one, turned. The fourth is longitudinal or torsional.
    let modes = [
        drawn("first.gif", &["bar.toml", "--mode", "1"]),
        drawn("third.gif", &["bar.toml", "--mode", "3"]),
        drawn("strained.gif", &["bar.toml", "--mode", "1", "--colour", "stress"]),
    ];
    assert!(modes.iter().all(|gif| frames(gif) == 4) && modes[0] != modes[1] && modes[0] != modes[2]);

    desk.refused(2, &["animate", "bar.toml", "--mode", "5", "-o", "x.gif"], &["--mode: found 5", "1 to 4"]);
    desk.refused(2, &["animate", "out/bar.h5", "--mode", "1", "-o", "x.gif"], &["--mode", "a results file", "a scene"]);
    desk.refused(2, &["animate", "bar.toml", "--mode", "1", "--to", "1", "-o", "x.gif"], &["--mode", "--to"]);
    desk.refused(2, &["animate", "bar.toml", "--view", "front", "-o", "x.gif"], &["--view", "iso, xy, xz"]);
    let film = |ending: &str| {
        let film = format!("x.{ending}");
        let arguments = ["animate", "out/bar.h5", "-o", &film];
        let output = desk.command(&arguments).env("FLEXFRAME_FFMPEG", "no-such-program").output().unwrap();
        assert_eq!(output.status.code(), Some(6));
        let words = String::from_utf8(output.stderr).unwrap();
        for part in [&film[..], "`no-such-program` cannot be started", "apt install ffmpeg", "FLEXFRAME_FFMPEG", ".gif"]
        {
            assert!(words.contains(part), "{part}: {words}");
        }
        assert!(!desk.path(&film).exists());
    };
    film("mp4");
    film("webm");
}

/// Run by `./dev film-test`, which installs ffmpeg.
#[test]
#[ignore = "needs ffmpeg: ./dev film-test"]
fn films_have_the_frames_of_the_picture() {
    let desk = Desk::new();
    desk.done(&["run", "bar.toml", "-o", "out"]);
    for (film, codec) in [("x.mp4", "h264"), ("x.webm", "vp9")] {
        desk.done(&["animate", "out/bar.h5", "-o", film]);
        let fields = "stream=codec_name,width,height,r_frame_rate,nb_read_frames";
        let asked = ["-v", "error", "-count_frames", "-show_entries", fields, "-of", "csv=p=0", film];
        let said = Command::new("ffprobe").args(asked).current_dir(desk.path("")).output().unwrap().stdout;
        // Eleven rows; 0.05 s each.
        assert_eq!(String::from_utf8(said).unwrap().trim(), format!("{codec},1440,880,20/1,11"));
    }
    assert_eq!(fs::read_dir(desk.path("")).unwrap().count(), 5, "nothing else is left");
}

/// Pictures of a GIF: each has a graphic control extension.
fn frames(gif: &[u8]) -> usize {
    gif.windows(4).filter(|bytes| *bytes == [0x21, 0xf9, 0x04, 0x04] || *bytes == [0x21, 0xf9, 0x04, 0x00]).count()
}

#[test]
fn a_dash_is_standard_output_for_texts_and_refused_for_all_else() {
    let desk = Desk::new();
    let (scene, _) = desk.done(&["new", "bar.msh", "-o", "-"]);
    assert!(scene.contains("[body]") && scene.contains("mesh = \"bar.msh\"") && !scene.contains("wrote"), "{scene}");
    desk.file("new.toml", &scene);
    desk.done(&["run", "new.toml", "-o", "out", "--set", "time.end=0.001"]);
    let (table, _) = desk.done(&["export", "out/new.h5", "--csv", "-", "--columns", "energy"]);
    assert!(table.starts_with("time [s],energy/kinetic [Mg mm^2/s^2]"), "{table}");
    desk.done(&["export", "out/new.h5", "--csv", "t.csv", "--columns", "energy"]);
    assert_eq!(table, fs::read_to_string(desk.path("t.csv")).unwrap());
    let (page, _) = desk.done(&["report", "out/new.h5", "-o", "-"]);
    assert!(page.starts_with("<!doctype html>"));
    for (option, arguments) in [
        ("--output", &["run", "bar.toml", "-o", "-"][..]),
        ("--output", &["reduce", "bar.toml", "-o", "-"]),
        ("--output", &["fmu", "bar.toml", "-o", "-"]),
        ("--output", &["modes", "bar.toml", "-o", "-"]),
        ("--output", &["cost", "bar.toml", "-o", "-"]),
        ("--output", &["paper", "bar.toml", "-o", "-"]),
        ("--output", &["animate", "bar.toml", "-o", "-"]),
        ("--output", &["campbell", "bar.toml", "--axis", "z", "--speeds", "0:1:2", "-o", "-"]),
        ("--vtkhdf", &["export", "out/new.h5", "--vtkhdf", "-"]),
        ("--vtu", &["export", "out/new.h5", "--vtu", "-"]),
        ("--modes", &["export", "out/new.h5", "--modes", "-"]),
    ] {
        desk.refused(2, arguments, &[option, "standard output", "./-"]);
    }
    assert!(!desk.path("-").exists());
}

/// Closed form: a rigid body that spins at 30 rad/s for 10 s turns by 300 rad, which is 47.75 turns and leaves it
/// 1.593 rad from its first attitude.
#[test]
fn a_summary_says_by_how_much_the_body_has_turned_in_all() {
    let desk = Desk::new();
    let rigid = "title = \"x\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n\
                 [body.rigid]\nmass = 1.0\ncenter_of_mass = [0.0, 0.0, 0.0]\ninertia = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]\n\
                 [time]\nend = 10.0\nstep = 1e-2\n[output]\ninterval = 5.0\n[initial]\n";
    let of = |more: &str| {
        desk.file("x.toml", &format!("{rigid}{more}"));
        let (said, _) = desk.done(&["run", "x.toml", "-o", "out", "--overwrite"]);
        let (json, _) = desk.done(&["run", "x.toml", "-o", "out", "--overwrite", "--json"]);
        (said, serde_json::from_str::<Value>(&json).unwrap())
    };
    let near = |value: &Value, expected: f64| {
        let found = value.as_f64().unwrap();
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    };
    let (said, json) = of("angular_velocity = [0.0, 0.0, 30.0]\n");
    assert!(said.contains("turned by 300 rad (47.75 turns), to an attitude 1.593 rad from the first"), "{said}");
    near(&json["turned"], 300.0);
    near(&json["turned_from_start"], 48.0 * std::f64::consts::TAU - 300.0);
    // An attitude at the beginning is no turn.
    let (said, json) = of("attitude = [0.6, 0.8, 0.0, 0.0]\n");
    assert!(said.contains("turned by 0 rad, centre"), "{said}");
    near(&json["turned_from_start"], 0.0);
    // A hinge turns about its axis, with its sign.
    let (said, json) = of(
        "angular_velocity = [0.0, 0.0, -3.0]\n[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n",
    );
    assert!(said.contains("turned by -30 rad (-4.775 turns)"), "{said}");
    near(&json["turned"], -30.0);
}

#[test]
fn supports_that_leave_a_plane_are_a_refused_model() {
    let desk = Desk::new();
    let clamp = "kind = \"clamp\"\ngroup = \"root\"";
    for plane in [
        "kind = \"support\"\ndirections = [\"z\"]\ngroup = \"root\"",
        // All of the body in the plane z: two translations and a rotation are left.
        "kind = \"support\"\ndirections = [\"z\"]\ngroup = \"bar\"",
    ] {
        for history in ["{ kind = \"half-sine\", duration = 0.002 }", "\"constant\""] {
            desk.changed(&[(clamp, plane), ("{ kind = \"half-sine\", duration = 0.002 }", history)]);
            desk.refused(4, &["run", "x.toml"], &["x.toml", "2 translations", "[[constraints]]", "`flexframe modes`"]);
        }
    }
}

#[test]
fn formulas_of_other_languages_are_refused_with_ours() {
    let desk = Desk::new();
    let half_sine = "{ kind = \"half-sine\", duration = 0.002 }";
    for (history, words) in [
        (
            "{ kind = \"expression\", formula = \"t**2\" }",
            ["x.toml:18:44", "`**` is not an operator", "write a power with ^, as in t^2"],
        ),
        (
            "{ kind = \"expression\", formula = \"np.sin(t)\" }",
            ["history.formula", "`np` is not known", "as in sin(t)"],
        ),
        ("{ kind = \"expression\", formula = \"t < 1\" }", ["history.formula", "`<` is not known", "no conditions"]),
        ("{ kind = \"formula\", formula = \"t^2\" }", ["history.kind", "did you mean `expression`", "rename"]),
        ("\"t^2\"", ["loads[0].history", "unknown value `t^2`", "formula = \"t^2\""]),
    ] {
        desk.changed(&[(half_sine, history)]);
        desk.refused(3, &["run", "x.toml"], &words);
    }
}

#[test]
fn a_number_of_modes_that_is_none_is_refused() {
    let desk = Desk::new();
    for count in ["0", "-3", "2.5", "ten"] {
        for command in [
            &["modes", "bar.toml", "-n", count][..],
            &["campbell", "bar.toml", "--axis", "z", "--speeds", "0:1:2", "-n", count],
        ] {
            desk.refused(2, command, &[count, "--flexible", "a whole number, 1 or more"]);
        }
    }
    desk.changed(&[("flexible = 4", "flexible = 0")]);
    let (said, _) = desk.done(&["modes", "x.toml"]);
    assert!(
        said.contains("modes    none, as the scene has it: `flexible = 0`") && !said.contains("frequency"),
        "{said}"
    );
}

#[test]
fn a_moment_at_a_point_says_why_its_energy_is_not_summed() {
    let desk = Desk::new();
    let of = |radius: &str| {
        desk.changed(&[
            ("kind = \"force\"", &format!("kind = \"moment\"{radius}")),
            ("{ kind = \"half-sine\", duration = 0.002 }", "\"constant\""),
            ("flexible = 4", "flexible = 20"),
            ("tolerance = 1e-4", "tolerance = 1e-3"),
            ("interval = 1e-3", "interval = 6e-3"),
            ("end = 0.01", "end = 0.12"),
        ]);
        desk.done(&["run", "x.toml", "-o", "out", "--overwrite"]).0
    };
    let said = of("");
    for words in [
        "modes faster than the steps (the motion itself is right)",
        "loads[0]: this moment has no `radius`",
        "such as that of a shaft",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let said = of("\nradius = 8.0");
    assert!(!said.contains("no `radius`"), "{said}");
}

/// Each is told on standard error before the work and in the summary, and the run goes on; the right scene says nothing.
#[test]
fn slips_of_units_are_told_at_once_and_in_the_summary() {
    let desk = Desk::new();
    let gravity = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9.81\n[time]";
    let mass = "mesh = \"bar.msh\"\npoint_masses = [{ at = [200.0, 5.0, 5.0], mass = 1.0 }]";
    for (from, to, words) in [
        ("210e3", "210.0", ["speed of sound", "if 210.0 is in GPa, write young_modulus = 2.1000e5"]),
        ("7.85e-9", "7.85", ["the density, 7.85e0 Mg/mm³, is 7.8e12 kg/m³", "steel: 7.8500e-9"]),
        ("[time]", gravity, ["loads[1]: gravity of 9.81 mm/s²", "9.80665e3 mm/s²"]),
        (
            "mesh = \"bar.msh\"",
            mass,
            ["body.point_masses: they sum to 1.0000e0, 6.4e3 times the mass of the mesh", "1.5700e-4"],
        ),
    ] {
        desk.changed(&[(from, to)]);
        let (said, told) = desk.done(&["run", "x.toml", "-o", "out", "--overwrite"]);
        for word in words {
            assert!(told.contains("warning: ") && told.contains(word), "{word}: {told}");
            assert!(said.contains("  warning  ") && said.contains(word), "{word}: {said}");
        }
        let (json, told) = desk.done(&["modes", "x.toml", "--json"]);
        assert_eq!(told, "");
        let json: Value = serde_json::from_str(&json).unwrap();
        let warnings = json["warnings"].as_array().unwrap();
        assert!(
            warnings.iter().any(|warning| words.iter().all(|word| warning.as_str().unwrap().contains(word))),
            "{json}"
        );
    }
    // A force of 1 MN, meant for a scene in kN and m: it is told before the run stops where the bar bends too far.
    desk.changed(&[("amplitude = 1.0", "amplitude = 1e6")]);
    desk.refused(
        4,
        &["run", "x.toml"],
        &["loads[0]: it would bend a solid bar of this size and material", "times its length"],
    );
    let (said, told) = desk.done(&["run", "bar.toml", "-o", "out", "--overwrite"]);
    assert!(!said.contains("warning") && !told.contains("warning"), "{said}{told}");
}

const WHEEL: &str = "title = \"x\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n[time]\nend = 1.5\ntolerance = 1e-8\n\
                     [output]\ninterval = 0.5\n";

fn rigid(name: &str, mass: f64, inertia: f64) -> String {
    format!(
        "[bodies.{name}]\nmarkers = {{ m = {{ at = [0, 0, 0] }} }}\n\
         rigid = {{ mass = {mass}, center_of_mass = [0, 0, 0], inertia = [[{inertia}, 0, 0], [0, {inertia}, 0], [0, 0, {inertia}]] }}\n"
    )
}

/// Closed form: a wheel on a spring with a period of 2 s, which is free at 0.5 rad, has gone to 1 rad and half the way back after 1.5 s. And
/// one that is placed 1 m off its hinge is moved there, with a warning.
#[test]
fn bodies_that_turn_back_or_begin_elsewhere_are_told_to_do_so() {
    let desk = Desk::new();
    let stiffness = 2.0 * std::f64::consts::PI.powi(2);
    let scene = |at: f64| {
        format!(
            "{WHEEL}{}initial = {{ position = [{at}, 0, 0] }}\n[ground.markers.m]\nat = [0, 0, 0]\n[[joints]]\nkind = \"revolute\"\n\
             axis = [0, 0, 1]\nbetween = [\"ground.m\", \"wheel.m\"]\nspring = {{ stiffness = {stiffness}, free = 0.5 }}\n",
            rigid("wheel", 1.0, 2.0)
        )
    };
    desk.file("x.toml", &scene(0.0));
    let (said, _) = desk.done(&["run", "x.toml", "-o", "out"]);
    assert!(said.contains("rad in all, to an attitude 0.5 rad from the first"), "{said}");
    assert!(!said.contains("does not begin where"), "{said}");
    desk.file("x.toml", &scene(1.0));
    let (said, _) = desk.done(&["run", "x.toml", "-o", "out", "--overwrite"]);
    assert!(said.contains("warning  wheel does not begin where its scene has it, but moved by 1 and"), "{said}");
}

/// Closed form: the angle of a drive that begins from rest as t³ does, where nothing else acts: what moves by less than a step may be off by is no
/// reason to end a run.
#[test]
fn a_drive_that_begins_gently_turns_a_flexible_bar_from_rest() {
    let desk = Desk::new();
    let (head, rest) = BAR.split_once("[[constraints]]").unwrap();
    let (_, rest) = rest.split_once("[time]").unwrap();
    let joint = "[[joints]]\nname = \"hinge\"\nkind = \"revolute\"\naxis = [0, 1, 0]\nbetween = [\"ground\", \"body.root\"]\n\
                 drive = { amplitude = 1e4, history = { kind = \"expression\", formula = \"t^3\" } }\n";
    let head = head.replace("[modes]", "[body.markers.root]\ngroup = \"root\"\n[modes]");
    for tolerance in ["1e-4", "1e-8"] {
        let rest = rest.replace("1e-4", tolerance).replace("interval = 1e-3", "interval = 1e-4");
        desk.file("x.toml", &format!("{head}{joint}[time]{rest}"));
        desk.done(&["run", "x.toml", "-o", "out", "--overwrite", "--no-check"]);
        let (table, _) = desk.done(&["export", "out/x.h5", "--csv", "-", "--columns", "joints/hinge/angle"]);
        for line in table.lines().skip(1) {
            let (time, angle) = line.split_once(',').unwrap();
            let [time, angle]: [f64; 2] = [time, angle].map(|number| number.parse().unwrap());
            assert!((angle - 1e4 * time.powi(3)).abs() < 1e-9, "{tolerance}: {line}");
        }
    }
}

/// Closed form: a moment of 2 N m on a pinion of 0.02 kg m² and 0.1 m moves a rack of 3 kg by 2/0.1/(3 + 0.02/0.1²) = 4 m/s². The rack is
/// pushed with 12 N, and 0.8 N m are left to the pinion.
#[test]
fn what_a_coupling_does_is_in_the_results_of_its_joints() {
    let desk = Desk::new();
    desk.file(
        "x.toml",
        &format!(
            "{WHEEL}{}{}[[joints]]\nname = \"turn\"\nkind = \"revolute\"\naxis = [0, 0, 1]\nbetween = [\"ground\", \"pinion.m\"]\n\
             motor = {{ amplitude = 2.0 }}\n[[joints]]\nname = \"slide\"\nkind = \"prismatic\"\naxis = [1, 0, 0]\n\
             between = [\"ground\", \"rack.m\"]\n[[couplings]]\nkind = \"rack\"\njoints = [\"turn\", \"slide\"]\nradius = 0.1\n",
            rigid("pinion", 1.0, 0.02),
            rigid("rack", 3.0, 1.0)
        ),
    );
    desk.done(&["run", "x.toml", "-o", "out"]);
    let (table, _) =
        desk.done(&["export", "out/x.h5", "--csv", "-", "--columns", "joints/slide/thrust,joints/turn/torque"]);
    let heads: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    for (path, expected) in [("joints/slide/thrust", 12.0), ("joints/turn/torque", 0.8)] {
        let column = heads.iter().position(|head| head.starts_with(path)).unwrap_or_else(|| panic!("{table}"));
        for line in table.lines().skip(1) {
            let number: f64 = line.split(',').nth(column).unwrap().parse().unwrap();
            assert!((number - expected).abs() < 1e-6, "{path}: {table}");
        }
    }
}

/// Closed form: 3 kg in rest on a spring of 150 N/m are 0.2 m below its free length of 1 m, and pull with 30 N; 2 kg on a bushing of
/// 100 N/m fall as 0.2 (1 − cos √50 t) m in its x axis, which is up.
#[test]
fn what_springs_and_bushings_do_is_in_the_results() {
    let desk = Desk::new();
    let gravity = "loads = [{ kind = \"gravity\", direction = [0, 0, -1], amplitude = 10.0 }]\n";
    desk.file(
        "x.toml",
        &format!(
            "{WHEEL}{}{gravity}initial = {{ position = [0, 0, -1.2] }}\n{}{gravity}\
             [ground.markers]\nhook = {{ at = [0, 0, 0] }}\nseat = {{ at = [0, 0, 0], z = [0, 1, 0], x = [0, 0, 1] }}\n\
             [[springs]]\nname = \"wire\"\nbetween = [\"ground.hook\", \"stone.m\"]\nstiffness = 150.0\ndamping = 3.0\nfree_length = 1.0\n\
             [[bushings]]\nname = \"pad\"\nbetween = [\"ground.seat\", \"box.m\"]\n\
             stiffness = {{ translation = [100.0, 50.0, 50.0], rotation = [5.0, 5.0, 5.0] }}\n",
            rigid("stone", 3.0, 1.0),
            rigid("box", 2.0, 1.0)
        ),
    );
    let (summary, told) = desk.done(&["run", "x.toml", "-o", "out"]);
    // The energy of the stone in rest is rounding, and so is what is missing of it.
    assert!(![summary, told].concat().contains("balance is open"));
    let (table, _) = desk.done(&["export", "out/x.h5", "--csv", "-"]);
    let column = |head: &str| -> Vec<f64> {
        let heads: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let column =
            heads.iter().position(|of| of.starts_with(&format!("{head} ["))).unwrap_or_else(|| panic!("{heads:?}"));
        table.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect()
    };
    for (path, expected) in [
        ("joints/wire/length", 1.2),
        ("joints/wire/length_rate", 0.0),
        ("joints/wire/pull", 30.0),
        ("joints/wire/force z", 30.0),
    ] {
        let numbers = column(path);
        assert!(
            numbers.len() == 4 && numbers.iter().all(|number| (number - expected).abs() < 1e-9),
            "{path}: {numbers:?}"
        );
    }
    for path in ["joints/pad/force z", "joints/pad/force_marker x"] {
        for (row, number) in column(path).into_iter().enumerate() {
            let expected = 20.0 * (1.0 - (50.0_f64.sqrt() * 0.5 * row as f64).cos());
            assert!((number - expected).abs() < 1e-4, "{path}: {number} {expected}");
        }
    }
    assert!(column("joints/pad/moment y").iter().all(|number| number.abs() < 1e-12));
    // Closed form: −½ k x² of the pad in the work of its springs; neither moves its dampers.
    for (row, number) in column("joints/pad/spring_work").into_iter().enumerate() {
        let fallen = 0.2 * (1.0 - (50.0_f64.sqrt() * 0.5 * row as f64).cos());
        assert!((number + 50.0 * fallen * fallen).abs() < 1e-4, "{number} {fallen}");
    }
    assert!(["wire", "pad"].iter().all(|name| column(&format!("joints/{name}/loss")).iter().all(|loss| *loss < 1e-20)));
    let results = hdf5::File::open(desk.path("out/x.h5")).unwrap();
    let kind = |name: &str| {
        let kind = results.group(&format!("joints/{name}")).unwrap().attr("kind").unwrap();
        kind.read_scalar::<hdf5::types::VarLenUnicode>().unwrap().to_string()
    };
    assert_eq!([kind("wire"), kind("pad")], ["spring", "bushing"]);
    let has = |path: &str| results.dataset(&format!("joints/{path}")).is_ok();
    assert!(has("pad/moment_marker") && !has("pad/length") && !has("wire/moment") && !has("wire/force_marker"));
}
