//! The list of files read against the files that the system opens: every command, on a scene that has every key with a path.

use std::collections::BTreeSet;
use std::fs;
use std::mem::MaybeUninit;
use std::os::fd::OwnedFd;
use std::path::Path;

use flexframe::fmu::marker;
use flexframe::model::Builder;
use flexframe::scene::Scene;
use rustix::fs::inotify;
use rustix::io::Errno;

use crate::program::command_in;

/// A tetrahedron of a deck that includes another, its reduced body, and a body of matrices.
pub(super) const EVERY_KEY: &str = r#"
title = "every key with a path"
units = { length = "m", mass = "kg", time = "s" }

[bodies.meshed]
mesh = "deck.inp"
material = { young_modulus = 70e3, poisson_ratio = 0.3, density = 1.0 }
modes = { flexible = 2, static_correction = false, measured = "measured.csv" }
markers = { root = { at = [0, 0, 0] } }
points = { tip = [1, 0, 0] }
loads = [
  { kind = "gravity", direction = [0, 0, -1], amplitude = 1.0, history = { kind = "product", factors = [
    { kind = "table", file = "first.csv" }, { kind = "table", file = "second.csv" } ] } },
]

[bodies.reduced]
file = "body.h5"
modes = { flexible = 2 }
markers = { root = { at = [0, 0, 0] } }

[bodies.matrices]
matrices = { mass = "mass.mtx", stiffness = "stiffness.mtx", nodes = "nodes.csv", dofs = "dofs.txt" }
modes = { flexible = 2, static_correction = false }
[[bodies.matrices.constraints]]
kind = "hinge"
at = [0, 0, 0]
axis = [0, 0, 1]
group = "root"
motion = { amplitude = 1.0, history = { kind = "table", file = "hinge.csv" } }

[[joints]]
name = "driven"
kind = "revolute"
axis = [0, 0, 1]
between = ["ground", "meshed.root"]
drive = { amplitude = 1.0, history = { kind = "table", file = "drive.csv" } }

[[joints]]
name = "turned"
kind = "revolute"
axis = [0, 0, 1]
between = ["ground", "reduced.root"]
motor = { amplitude = 1.0, history = { kind = "table", file = "motor.csv" } }

[time]
end = 0.02
tolerance = 1e-3

[output]
interval = 0.01
"#;
const BODY: &str = r#"
title = "reduced"
units = { length = "m", mass = "kg", time = "s" }
body = { mesh = "deck.inp", material = { young_modulus = 70e3, poisson_ratio = 0.3, density = 1.0 } }
modes = { flexible = 2, static_correction = false }
time = { end = 0.01, step = 1e-3 }
"#;
const INCLUDED: &str = "\
1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, .5, 0, 0\n6, .5, .5, 0\n7, 0, .5, 0\n8, 0, 0, .5\n9, .5, 0, .5\n10, 0, .5, .5\n\
*ELEMENT, TYPE=C3D10, ELSET=all\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n";
const SWEEP: &str = "scene = \"every.toml\"\n[parameters]\n\"time.end\" = [0.01]\n\
                     [results]\ntip = { final = \"bodies/meshed/points/tip/displacement\" }\n";

/// How much a command opens of the list of files of its scene.
enum Opens {
    Nothing,
    Part,
    Whole,
    /// The whole list of the scene without the body that is held.
    Linear,
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap().to_str().unwrap().to_owned()
}

/// Watches the files of a folder. The kernel tells of them to any user; no other program is needed.
struct Watch(OwnedFd);

impl Watch {
    fn new(folder: &Path) -> Self {
        let watch = inotify::init(inotify::CreateFlags::NONBLOCK).unwrap();
        inotify::add_watch(&watch, folder, inotify::WatchFlags::OPEN).unwrap();
        Self(watch)
    }

    /// The files that were opened since the last look.
    fn opened(&self) -> BTreeSet<String> {
        let mut buffer = [MaybeUninit::uninit(); 4096];
        let mut reader = inotify::Reader::new(&self.0, &mut buffer);
        let mut names = BTreeSet::new();
        loop {
            match reader.next() {
                Ok(event) => {
                    assert!(!event.events().contains(inotify::ReadFlags::QUEUE_OVERFLOW));
                    names.extend(event.file_name().map(|name| name.to_str().unwrap().to_owned()));
                }
                Err(Errno::AGAIN) => return names,
                Err(error) => panic!("{error}"),
            }
        }
    }
}

#[test]
fn each_command_opens_what_is_in_the_list_of_files_that_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // Linear commands take no body beside the joints that is held.
    let (bodies, joints) = EVERY_KEY.split_once("[[joints]]").unwrap();
    let (free, _) = bodies.split_once("[[bodies.matrices.constraints]]").unwrap();
    let table = "0, 0\n1, 1\n";
    for (name, text) in [
        ("every.toml", EVERY_KEY),
        ("linear.toml", &format!("{free}[[joints]]{joints}")),
        ("body.toml", BODY),
        ("sweep.toml", SWEEP),
        ("deck.inp", "*NODE\n*INCLUDE, INPUT=included.inp\n"),
        ("included.inp", INCLUDED),
        ("measured.csv", "frequency\n90\n"),
        ("test.csv", "frequency,deviation\n90,0.01\n"),
        ("spectra.csv", "frequency,meshed.loads[0].gravity\n10,1\n100,1\n"),
        ("shock.csv", table),
        ("first.csv", table),
        ("second.csv", table),
        ("drive.csv", table),
        ("motor.csv", table),
        ("hinge.csv", table),
        ("lib.so", &format!("{} fmi2DoStep", marker())),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    let boom = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/boom"));
    for (from, to) in [("K.mtx", "stiffness.mtx"), ("M.mtx", "mass.mtx"), ("nodes.csv", "nodes.csv")] {
        fs::copy(boom.join(from), folder.join(to)).unwrap();
    }
    let dofs: Vec<String> = (1..=9).flat_map(|node| (1..=6).map(move |dof| format!("{node}.{dof}\n"))).collect();
    fs::write(folder.join("dofs.txt"), dofs.concat()).unwrap();
    for arguments in [["reduce", "body.toml", "-o", "body.h5"], ["run", "every.toml", "-o", "."]] {
        let output = command_in(folder, &arguments).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
    let scene = Scene::read(folder.join("every.toml")).unwrap();
    let files: BTreeSet<String> = Builder::default().files(&scene).iter().map(|file| name_of(file)).collect();
    assert_eq!(files.len(), 14, "{files:?}");
    let inputs: BTreeSet<String> = fs::read_dir(folder).unwrap().map(|entry| name_of(&entry.unwrap().path())).collect();
    fs::create_dir(folder.join("o")).unwrap();

    let watch = Watch::new(folder);
    // A command, its output where it has one, the files that it names beside the scene, and how much of the list it opens.
    for (arguments, output, own, opens) in [
        (&["new", "deck.inp", "-o", "o/n.toml"][..], "o/n.toml", &["deck.inp", "included.inp"][..], Opens::Nothing),
        (&["run", "every.toml", "-o", "o"], "o/every.h5", &[], Opens::Whole),
        (&["modes", "every.toml"], "", &[], Opens::Whole),
        (&["advise", "every.toml"], "", &[], Opens::Whole),
        (&["reduce", "every.toml", "--body", "meshed", "-o", "o/e.h5"], "o/e.h5", &[], Opens::Part),
        (
            &["campbell", "every.toml", "--joint", "driven", "--speeds", "0:1:2", "-o", "o"],
            "o/campbell.csv",
            &[],
            Opens::Whole,
        ),
        (&["cost", "every.toml", "--patience", "0.01", "-o", "o"], "o/cost.csv", &[], Opens::Whole),
        (&["sweep", "sweep.toml", "-o", "o/sweep.h5"], "o/sweep.h5", &["sweep.toml"], Opens::Whole),
        (&["paper", "every.toml", "--body", "meshed", "-o", "o"], "o/report.md", &[], Opens::Part),
        (&["animate", "every.toml", "-o", "o/e.gif", "--frames", "2"], "o/e.gif", &[], Opens::Part),
        (
            &["fmu", "linear.toml", "-o", "o/e.fmu", "--library", "lib.so"],
            "o/e.fmu",
            &["lib.so", "linear.toml"],
            Opens::Part,
        ),
        (&["linearize", "linear.toml", "-o", "o/e.json"], "o/e.json", &[], Opens::Linear),
        (&["frf", "linear.toml", "--frequencies", "1:2:2", "-o", "o"], "o/frf.csv", &[], Opens::Linear),
        (&["psd", "linear.toml", "--spectra", "spectra.csv", "-o", "o"], "o/psd.csv", &["spectra.csv"], Opens::Linear),
        (
            &["shock", "linear.toml", "--table", "shock.csv", "--input", "meshed.loads[0].gravity"],
            "",
            &["shock.csv"],
            Opens::Linear,
        ),
        (
            &["gradient", "body.toml", "--parameters", "body.material.density", "-o", "o"],
            "o/gradient.csv",
            &["body.toml"],
            Opens::Part,
        ),
        (
            &["fit", "body.toml", "--measured", "test.csv", "--parameters", "body.material.density", "-o", "f.toml"],
            "f.toml",
            &["body.toml", "test.csv"],
            Opens::Part,
        ),
        (&["srs", "shock.csv", "--frequencies", "1:2:2", "-o", "o"], "o/srs.csv", &["shock.csv"], Opens::Nothing),
        (&["check", "every.h5"], "", &["every.h5"], Opens::Part),
        (&["animate", "every.h5", "-o", "o/r.gif", "--frames", "2"], "o/r.gif", &["every.h5"], Opens::Part),
        (&["report", "every.h5", "-o", "o/e.html"], "o/e.html", &["every.h5"], Opens::Part),
        (&["report", "every.h5", "--live", "-o", "o/l.html"], "o/l.html", &["every.h5"], Opens::Part),
        (&["export", "every.h5", "--csv", "o"], "o/every.csv", &["every.h5"], Opens::Part),
    ] {
        let answer = command_in(folder, arguments).output().unwrap();
        let said = String::from_utf8_lossy(&answer.stderr);
        let seen: BTreeSet<String> = watch.opened().intersection(&inputs).cloned().collect();
        let of_scene: BTreeSet<String> = match opens {
            Opens::Nothing => BTreeSet::new(),
            Opens::Whole | Opens::Part => files.clone(),
            Opens::Linear => {
                let other = files.iter().filter(|name| !["every.toml", "hinge.csv"].contains(&&name[..]));
                other.cloned().chain(["linear.toml".to_owned()]).collect()
            }
        };
        let known: BTreeSet<String> = own.iter().map(|&name| name.to_owned()).chain(of_scene).collect();
        assert!(seen.is_subset(&known), "{arguments:?} opens {:?}: {said}", seen.difference(&known));
        if !matches!(opens, Opens::Part) {
            assert!(seen == known, "{arguments:?} does not open {:?}: {said}", known.difference(&seen));
        }
        // No output takes the place of a file that was opened.
        let place = folder.join(output);
        for name in seen.iter().filter(|_| !output.is_empty()) {
            let _ = fs::remove_file(&place);
            fs::hard_link(folder.join(name), &place).unwrap();
            let arguments = [arguments, &["--overwrite"]].concat();
            let refused = command_in(folder, &arguments).output().unwrap();
            let said = String::from_utf8_lossy(&refused.stderr);
            assert!(said.contains("this file is read by the command"), "{arguments:?} in the place of {name}: {said}");
            fs::remove_file(&place).unwrap();
        }
        watch.opened();
    }
}
