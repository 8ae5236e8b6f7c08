//! No command writes over a file that it reads, and none replaces what is there unasked: a table of all of them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use flexframe::fmu::marker;

use crate::program::command_in;

const SCENE: &str = r#"
title = "Bar"
units = { length = "mm", mass = "Mg", time = "s" }
[body]
mesh = "bar.msh"
material = { young_modulus = 70e3, poisson_ratio = 0.3, density = 2.7e-9 }
[modes]
flexible = 2
static_correction = false
[initial]
angular_velocity = [0.0, 0.0, 10.0]
[[loads]]
kind = "force"
at = [200.0, 0.0, 0.0]
direction = [0.0, 1.0, 0.0]
amplitude = 1.0
history = { kind = "table", file = "pulse.csv" }
[time]
end = 2e-4
step = 1e-5
[output.points]
tip = [200.0, 0.0, 0.0]
"#;
const SWEEP: &str = "scene = \"bar.toml\"\n[parameters]\n\"loads[0].amplitude\" = [1.0]\n\
                     [results]\ntip = { final = \"points/tip/displacement\" }\n";

/// The files that every scene reads.
const OF_SCENE: [&str; 3] = ["bar.toml", "bar.msh", "pulse.csv"];
/// The files that every look at the results reads.
const OF_RESULTS: [&str; 4] = ["bar.h5", "bar.toml", "bar.msh", "pulse.csv"];

/// A command, the files that it writes, and those that it reads.
struct Case {
    arguments: &'static [&'static str],
    writes: &'static [&'static str],
    reads: &'static [&'static str],
    /// True if it is done to its end when it may replace what is there.
    to_the_end: bool,
}

const fn case(
    arguments: &'static [&'static str],
    writes: &'static [&'static str],
    reads: &'static [&'static str],
) -> Case {
    Case { arguments, writes, reads, to_the_end: true }
}

const CASES: [Case; 24] = [
    case(&["new", "bar.msh", "-o", "new.toml"], &["new.toml"], &["bar.msh"]),
    case(&["run", "bar.toml", "-o", "o"], &["o/bar.h5"], &OF_SCENE),
    case(&["reduce", "bar.toml", "-o", "o/b.h5"], &["o/b.h5"], &OF_SCENE),
    case(&["reduce", "of_body.toml", "-o", "o/b.h5"], &["o/b.h5"], &["of_body.toml", "body.h5", "pulse.csv"]),
    Case {
        to_the_end: false,
        ..case(
            &["fmu", "bar.toml", "-o", "o/b.fmu", "--library", "lib.so"],
            &["o/b.fmu"],
            &["bar.toml", "bar.msh", "pulse.csv", "lib.so"],
        )
    },
    case(&["modes", "bar.toml", "-o", "o"], &["o/modes.svg", "o/modes.pdf", "o/modes.png"], &OF_SCENE),
    case(
        &["modes", "bar.toml", "--solver", "slepc", "--ranks", "2", "--write-only", "o"],
        &["o/problem.json", "o/K.petsc", "o/M.petsc", "o/rigid.petsc", "o/driver.py", "o/job.sh", "o/README.txt"],
        &OF_SCENE,
    ),
    Case {
        to_the_end: false,
        ..case(
            &["run", "bar.toml", "--solver", "slepc", "--ranks", "2", "--write-only", "o"],
            &[
                "o/modes.json",
                "o/modes.petsc",
                "o/driver.log",
                "o/forces-0123456789abcdef.json",
                "o/statics-0123456789abcdef.petsc",
            ],
            &OF_SCENE,
        )
    },
    case(
        &["campbell", "bar.toml", "--axis", "z", "--speeds", "0:10:2", "-o", "o"],
        &["o/campbell.csv", "o/critical_speeds.csv", "o/campbell.svg", "o/campbell.pdf", "o/campbell.png"],
        &OF_SCENE,
    ),
    case(&["linearize", "bar.toml", "-o", "o/b.mat"], &["o/b.mat"], &OF_SCENE),
    case(
        &["frf", "bar.toml", "--frequencies", "1:2:2", "-o", "o"],
        &["o/frf.csv", "o/frf.html", "o/frf.svg", "o/frf.pdf", "o/frf.png"],
        &OF_SCENE,
    ),
    case(
        &["psd", "bar.toml", "--spectra", "spectra.csv", "-o", "o"],
        &["o/psd.csv", "o/psd.html", "o/psd.svg", "o/psd.pdf", "o/psd.png"],
        &["bar.toml", "bar.msh", "pulse.csv", "spectra.csv"],
    ),
    case(
        &["gradient", "bar.toml", "--frequencies", "1:2:2", "-o", "o"],
        &["o/gradient.csv", "o/gradient_frf.csv"],
        &OF_SCENE,
    ),
    case(
        &[
            "fit",
            "bar.toml",
            "--measured",
            "test.csv",
            "--parameters",
            "body.material.young_modulus",
            "-o",
            "fitted.toml",
        ],
        &["fitted.toml"],
        &["bar.toml", "bar.msh", "pulse.csv", "test.csv"],
    ),
    case(
        &["srs", "pulse.csv", "--frequencies", "1e3:1e5:5", "-o", "o"],
        &["o/srs.csv", "o/srs.html", "o/srs.svg", "o/srs.pdf", "o/srs.png"],
        &["pulse.csv"],
    ),
    Case {
        // Only the paper's plate has all that it takes.
        to_the_end: false,
        ..case(
            &["paper", "bar.toml", "-o", "o"],
            &["o/report.md", "o/fig03_mode_shapes.svg", "o/fig13_acceleration_3.png"],
            &OF_SCENE,
        )
    },
    case(
        &["cost", "bar.toml", "--patience", "0.01", "-o", "o"],
        &["o/cost.csv", "o/work_precision.svg", "o/work_precision.pdf", "o/work_precision.png"],
        &OF_SCENE,
    ),
    case(&["export", "bar.h5", "--csv", "o"], &["o/bar.csv"], &OF_RESULTS),
    case(&["export", "bar.h5", "--vtkhdf", "o/b.vtkhdf"], &["o/b.vtkhdf"], &OF_RESULTS),
    case(&["export", "bar.h5", "--modes", "o/b.vtkhdf"], &["o/b.vtkhdf"], &OF_RESULTS),
    case(&["export", "bar.h5", "--vtu", "o", "--every", "10"], &["o/bar.pvd", "o/bar_000001.vtu"], &OF_RESULTS),
    case(&["report", "bar.h5", "-o", "o/b.html"], &["o/b.html"], &OF_RESULTS),
    case(&["animate", "bar.h5", "-o", "o/b.gif", "--frames", "2"], &["o/b.gif"], &OF_RESULTS),
    case(&["animate", "bar.toml", "-o", "o/b.gif", "--frames", "2"], &["o/b.gif"], &OF_SCENE),
];

/// A folder in which each command has something to work on.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new() -> Self {
        let desk = Self { folder: tempfile::tempdir().unwrap() };
        let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("crates/model/tests/data/bar.msh");
        fs::copy(data, desk.at("bar.msh")).unwrap();
        for (name, text) in [
            ("bar.toml", SCENE),
            (
                "of_body.toml",
                &SCENE.replace("mesh = \"bar.msh\"", "file = \"body.h5\"").replace("material", "# material"),
            ),
            ("pulse.csv", "0, 0\n1e-4, 1\n2e-4, 0\n"),
            ("spectra.csv", "frequency,loads[0]\n10,1\n100,1\n"),
            ("test.csv", "frequency\n1000\n"),
            ("sweep.toml", SWEEP),
            ("lib.so", &format!("{} fmi2DoStep", marker())),
        ] {
            fs::write(desk.at(name), text).unwrap();
        }
        fs::create_dir(desk.at("o")).unwrap();
        desk.done(&["run", "bar.toml", "-o", "."]);
        desk.done(&["reduce", "bar.toml", "-o", "body.h5"]);
        desk
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn flexframe(&self, arguments: &[&str]) -> Output {
        command_in(self.folder.path(), arguments).output().unwrap()
    }

    fn done(&self, arguments: &[&str]) {
        let output = self.flexframe(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    }

    /// Checks that the command fails and says so.
    fn refused(&self, arguments: &[&str], words: &str) {
        let output = self.flexframe(arguments);
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && text.contains(words), "{arguments:?}: {text}");
    }

    /// Checks that this is all that is in the folder of outputs.
    fn alone(&self, name: &str, arguments: &[&str]) {
        let names: Vec<_> = fs::read_dir(self.at("o")).unwrap().map(|entry| entry.unwrap().path()).collect();
        if name.starts_with("o/") {
            assert_eq!(names, [self.at(name)], "{arguments:?}");
        }
    }

    /// Checks that it is, and as it was.
    fn only(&self, name: &str, bytes: &[u8], arguments: &[&str]) {
        self.alone(name, arguments);
        assert!(fs::read(self.at(name)).unwrap() == bytes, "{arguments:?}: {name}");
    }
}

#[test]
fn the_table_has_every_command_that_writes() {
    let desk = Desk::new();
    let help = desk.flexframe(&["--help"]).stdout;
    let help = String::from_utf8(help).unwrap();
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let commands: BTreeSet<&str> = commands
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|name| !name.is_empty())
        .collect();
    assert!(commands.len() > 12, "{commands:?}");
    let of_table: BTreeSet<&str> = CASES.iter().map(|case| case.arguments[0]).collect();
    // They write nothing, or are below.
    let others = BTreeSet::from([
        "advise",
        "check",
        "completions",
        "equilibrium",
        "help",
        "play",
        "resume",
        "schema",
        "shock",
        "sweep",
        "verify",
    ]);
    assert_eq!(commands, of_table.union(&others).copied().collect());
}

#[test]
fn an_output_that_is_an_input_is_refused_by_any_name() {
    let desk = Desk::new();
    for Case { arguments, writes, reads, .. } in &CASES {
        let arguments = [arguments, &["--overwrite"][..]].concat();
        for (i, output) in writes.iter().enumerate() {
            for (k, input) in reads.iter().enumerate() {
                // Each kind of link is had by each command.
                let place = desk.at(output);
                let bytes = fs::read(desk.at(input)).unwrap();
                if (i + k) % 2 == 0 {
                    fs::hard_link(desk.at(input), &place).unwrap();
                } else {
                    std::os::unix::fs::symlink(desk.at(input), &place).unwrap();
                }
                desk.refused(&arguments, "this file is read by the command");
                desk.only(output, &bytes, &arguments);
                fs::remove_file(&place).unwrap();
            }
        }
    }
    // By its own name, and by another path to it.
    for arguments in [
        ["reduce", "bar.toml", "-o", "bar.msh"],
        ["reduce", "bar.toml", "-o", "o/../bar.msh"],
        ["fmu", "bar.toml", "-o", "bar.toml"],
        ["report", "bar.h5", "-o", "bar.h5"],
        ["report", "bar.h5", "-o", "bar.toml"],
        ["new", "bar.msh", "-o", "bar.msh"],
    ] {
        desk.refused(&[&arguments[..], &["--overwrite"]].concat(), "this file is read by the command");
        desk.refused(&arguments, "this file is read by the command");
    }
}

#[test]
fn what_is_there_is_replaced_only_when_asked() {
    let desk = Desk::new();
    for Case { arguments, writes, to_the_end, .. } in &CASES {
        for output in *writes {
            fs::write(desk.at(output), "mine").unwrap();
            let words = if arguments[0] == "run" && output.ends_with("h5") {
                "is not a results file"
            } else {
                "is there already"
            };
            desk.refused(arguments, words);
            desk.only(output, b"mine", arguments);
            if !*to_the_end {
                fs::remove_file(desk.at(output)).unwrap();
                continue;
            }
            desk.done(&[arguments, &["--overwrite"][..]].concat());
            assert!(fs::read(desk.at(output)).unwrap() != b"mine", "{arguments:?}: {output}");
            fs::remove_file(desk.at(output)).unwrap();
            for entry in fs::read_dir(desk.at("o")).unwrap() {
                fs::remove_file(entry.unwrap().path()).unwrap();
            }
        }
    }
    desk.refused(&["export", "bar.h5", "--vtkhdf", "o/x", "--modes", "o/../o/x"], "is there already");
}

/// A folder, or a link that leads nowhere, where a file is to go: nothing is written before the command sees it.
#[test]
fn what_is_no_file_is_refused_before_the_work() {
    let desk = Desk::new();
    for Case { arguments, writes, .. } in CASES.iter().filter(|case| case.to_the_end && case.arguments[0] != "run") {
        for output in *writes {
            let place = desk.at(output);
            for overwrite in [&[][..], &["--overwrite"]] {
                let arguments = [arguments, overwrite].concat();
                fs::create_dir(&place).unwrap();
                desk.refused(&arguments, "a folder of this name is there");
                desk.alone(output, &arguments);
                fs::remove_dir(&place).unwrap();
                std::os::unix::fs::symlink("gone/file", &place).unwrap();
                desk.refused(&arguments, "this symbolic link leads nowhere");
                desk.alone(output, &arguments);
                fs::remove_file(&place).unwrap();
            }
        }
    }
    for arguments in [
        &["reduce", "bar.toml", "-o", "gone/x.h5"][..],
        &["animate", "bar.toml", "-o", "gone/x.gif"],
        &["animate", "bar.h5", "-o", "gone/x.gif"],
        &["export", "bar.h5", "--csv", "gone/x.csv"],
        &["export", "bar.h5", "--modes", "gone/x.vtkhdf"],
        &["report", "bar.h5", "-o", "gone/x.html"],
        &["new", "bar.msh", "-o", "gone/x.toml"],
    ] {
        desk.refused(arguments, "there is no folder gone to write it in");
    }
}

/// A link to a file stays, and the file gets the new bytes, whatever writes it.
#[test]
fn a_link_to_an_output_stays() {
    let desk = Desk::new();
    for (arguments, name) in [
        (&["reduce", "bar.toml", "-o"][..], "link.h5"),
        (&["sweep", "sweep.toml", "-o"], "table.h5"),
        (&["export", "bar.h5", "--vtkhdf"], "link.vtkhdf"),
        (&["export", "bar.h5", "--csv"], "link.csv"),
        (&["report", "bar.h5", "-o"], "link.html"),
    ] {
        fs::write(desk.at("o/file"), "mine").unwrap();
        std::os::unix::fs::symlink("o/file", desk.at(name)).unwrap();
        desk.done(&[arguments, &[name, "--overwrite"]].concat());
        assert!(desk.at(name).is_symlink() && fs::read(desk.at("o/file")).unwrap() != b"mine", "{arguments:?}");
    }
}

/// A pipe that nobody writes into, and a device without an end.
#[test]
fn what_never_ends_is_not_read() {
    let desk = Desk::new();
    let made = Command::new("mkfifo").arg(desk.at("pipe")).status().unwrap();
    assert!(made.success());
    for input in ["pipe", "/dev/zero"] {
        desk.refused(&["sweep", input], "not an ordinary file but a device or a pipe");
        desk.refused(
            &["fmu", "bar.toml", "-o", "o/b.fmu", "--library", input],
            "not an ordinary file but a device or a pipe",
        );
    }
    fs::write(desk.at("latin.toml"), b"scene = \"\xe9\"").unwrap();
    desk.refused(&["sweep", "latin.toml"], "this is not text in UTF-8 (byte 10)");
}

/// A scene, a table, a picture: no command gives what it writes the name of something else.
#[test]
fn a_name_of_another_kind_of_file_is_refused() {
    let desk = Desk::new();
    let axis = ["--axis", "z", "--speeds", "0:10:2"];
    for (arguments, name, kind) in [
        (&["reduce", "bar.toml", "-o"][..], "o/x.toml", "a body file"),
        (&["reduce", "bar.toml", "-o"], "o/x.csv", "a body file"),
        (&["fmu", "bar.toml", "--library", "lib.so", "-o"], "o/x.h5", "an FMU"),
        (&["new", "bar.msh", "-o"], "o/x.msh", "a scene"),
        (&["report", "bar.h5", "-o"], "o/x.pdf", "a web page"),
        (&["sweep", "sweep.toml", "-o"], "o/x.csv", "the table of a sweep"),
        (&["sweep", "sweep.toml", "--merge", "2", "-o"], "o/x.toml", "the table of a sweep"),
        (&["export", "bar.h5", "--vtkhdf"], "o/x.vtu", "a VTKHDF file"),
        (&["export", "bar.h5", "--modes"], "o/x.csv", "a VTKHDF file"),
        (&["export", "bar.h5", "--vtu"], "o/x.vtu", "a folder"),
        (&["export", "bar.h5", "--csv"], "o/x.h5", "a folder"),
        (&["run", "bar.toml", "-o"], "o/x.h5", "a folder"),
        (&["modes", "bar.toml", "-o"], "o/x.png", "a folder"),
        (&[&["campbell", "bar.toml"][..], &axis, &["-o"]].concat()[..], "o/x.csv", "a folder"),
        (&["cost", "bar.toml", "-o"], "o/x.csv", "a folder"),
        (&["paper", "bar.toml", "-o"], "o/x.html", "a folder"),
    ] {
        for overwrite in [&["--overwrite"][..], &[]] {
            let arguments = [arguments, &[name], overwrite].concat();
            desk.refused(&arguments, &format!("{name}: found the name of "));
            desk.refused(&arguments, &format!("expected that of {kind}\n = give it a name "));
        }
        assert!(!desk.at(name).exists(), "{name}");
    }
}

/// A folder in which someone has files of his own with names that are nearly those of the driver.
#[test]
fn a_problem_for_another_machine_leaves_the_files_of_others() {
    let desk = Desk::new();
    let write = ["modes", "bar.toml", "--solver", "slepc", "--ranks", "2", "--write-only", "o"];
    let mine = ["o/forces-of-mine.csv", "o/statics-notes.txt", "o/forces-0123456789abcdef.csv", "o/modes.csv"];
    mine.iter().for_each(|name| fs::write(desk.at(name), "mine").unwrap());
    desk.done(&write);
    desk.refused(&write, "is there already");
    fs::write(desk.at("o/forces-0123456789abcdef.json"), "{}").unwrap();
    desk.done(&[&write[..], &["--overwrite"]].concat());
    assert!(mine.iter().all(|name| fs::read(desk.at(name)).unwrap() == b"mine"));
    assert!(!desk.at("o/forces-0123456789abcdef.json").exists());
}

#[test]
fn a_run_and_its_continuation_replace_results_only_when_asked() {
    let desk = Desk::new();
    let before = fs::read(desk.at("bar.h5")).unwrap();
    desk.refused(&["run", "bar.toml", "-o", "."], "bar.h5: this file is there already");
    // A run that is refused on its way leaves an unfinished file.
    let strong = [
        "run",
        "bar.toml",
        "-o",
        ".",
        "--set",
        "loads[0].amplitude=1e6",
        "--set",
        "effects.large_deflection=false",
        "--overwrite",
    ];
    assert!(!desk.flexframe(&strong).status.success());
    assert!(desk.at("bar.part.h5").is_file());
    desk.refused(&["resume", "bar.part.h5"], "bar.h5: this file is there already");
    // It goes on, to where it was refused.
    desk.refused(&["resume", "bar.part.h5", "--overwrite"], "the states up to there");
    assert!(fs::read(desk.at("bar.h5")).unwrap() == before);
    desk.done(&["run", "bar.toml", "-o", ".", "--overwrite"]);
    assert!(!desk.at("bar.part.h5").exists());
}

#[test]
fn a_sweep_spares_what_it_reads() {
    let desk = Desk::new();
    for input in ["sweep.toml", "bar.toml", "bar.msh", "pulse.csv"] {
        let bytes = fs::read(desk.at(input)).unwrap();
        for more in [&["--overwrite"][..], &[], &["--merge", "2", "--overwrite"]] {
            desk.refused(&[&["sweep", "sweep.toml", "-o", input], more].concat(), "this file is read by the command");
        }
        assert!(fs::read(desk.at(input)).unwrap() == bytes, "{input}");
    }
    fs::write(desk.at("o/t.h5"), "mine").unwrap();
    desk.refused(&["sweep", "sweep.toml", "-o", "o/t.h5"], "is not the table of this sweep");
    desk.only("o/t.h5", b"mine", &["sweep"]);
    desk.done(&["sweep", "sweep.toml", "-o", "o/t.h5", "--overwrite"]);
}
