//! Scenes of several bodies: one results file, each body moves as it would alone, bit for bit, and every command takes all
//! of them, or one by its name.

use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use flexframe::columns::COLUMNS;
use flexframe::run::{RunError, RunProgress, RunSettings, resume, run};
use flexframe::scene::{Body, Scene};
use results::{Results, Scope, histories};
use serde_json::Value;

use crate::program::command_in;

/// Two bodies that tumble and are struck, at places and times of their own.
const SCENE: &str = include_str!("../../two.toml");
/// Its steps and rows.
const CONTROLLED: [&str; 2] = ["tolerance = 1e-6", "interval = 5e-4"];
/// Others.
const FIXED: [&str; 2] = ["step = 3e-5", "every = 10"];
const BODIES: [&str; 2] = ["ring", "bar"];

/// A folder with the scene, and a cache for the tests of this file that build its bodies again.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new(time: [&str; 2]) -> Self {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).canonicalize().unwrap();
        let desk = Self { folder: tempfile::tempdir().unwrap() };
        let scene = SCENE.replace("../", &format!("{}/", root.display()));
        let scene = CONTROLLED.iter().zip(time).fold(scene, |scene, (these, others)| scene.replace(these, others));
        std::fs::write(desk.path("two.toml"), scene).unwrap();
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn flexframe(&self, arguments: &[&str]) -> Output {
        let mut command = command_in(self.folder.path(), arguments);
        command.env("FLEXFRAME_CACHE", self.path("cache")).output().unwrap()
    }

    /// Standard output of a command that succeeds.
    fn done(&self, arguments: &[&str]) -> String {
        let Output { status, stdout, stderr } = self.flexframe(arguments);
        assert!(status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
        String::from_utf8(stdout).unwrap()
    }

    fn json(&self, arguments: &[&str]) -> Value {
        serde_json::from_str(&self.done(&[arguments, &["--json"]].concat())).unwrap()
    }

    fn results(&self, name: &str) -> Results {
        Results::open(self.path(name), &COLUMNS).unwrap()
    }
}

/// The bits of all columns of a body, row by row, by their paths within the body.
fn columns_of(results: &Results, body: &str) -> Vec<(String, Vec<Vec<u64>>)> {
    let metadata = &results.metadata;
    let of_body =
        histories(&COLUMNS, metadata).filter(|history| history.body(metadata).is_some_and(|b| b.name == body));
    let bits = of_body.map(|history| {
        let (values, width) = (results.dataset(history), history.width(metadata));
        let rows = values.chunks(width).map(|row| row.iter().map(|x| x.to_bits()).collect());
        (history.column.path(), rows.collect())
    });
    bits.collect()
}

/// Conserved: the numbers of each body are those of a run of its own, to the last bit.
/// Conserved: the bits of a run of the body alone.
#[test]
fn each_body_moves_as_it_would_alone_to_the_last_bit() {
    for time in [CONTROLLED, FIXED] {
        let desk = Desk::new(time);
        let summary = desk.json(&["run", "two.toml", "-o", "both"]);
        let both = desk.results("both/two.h5");
        assert!(both.complete && both.metadata.bodies.len() == 2);
        for (number, body) in BODIES.into_iter().enumerate() {
            let alone = desk.json(&["run", "two.toml", "-o", "one", "--body", body]);
            let said = &summary["bodies"][number];
            assert_eq!(said["name"], body);
            for key in ["steps", "rejected_steps", "step_lengths", "evaluations", "moved", "turned", "balances"] {
                let differs = time == FIXED && ["turned", "balances"].contains(&key);
                assert!(differs || said[key] == alone["bodies"][0][key], "{key}: {said} {alone}");
            }
            let alone = desk.results(&format!("one/two.{body}.h5"));
            let (found, expected) = (columns_of(&both, body), columns_of(&alone, body));
            assert!(found.len() > 20 && found.len() == expected.len(), "{}", found.len());
            for ((path, found), (_, expected)) in found.iter().zip(&expected) {
                // With rows after a number of steps, those of both are at common times, and a step that a load has cut is
                // no row of the other body.
                let both_have = if time == FIXED { found.len() - 1.. } else { 0.. };
                let rows = expected.len() - found[both_have.clone()].len()..;
                assert_eq!(found[both_have], expected[rows], "{body} {path}");
            }
        }
        let times = both.numbers("time").unwrap();
        let interval = if time == FIXED { 10.0 * 0.01 / 334.0 } else { 5e-4 };
        for (i, time) in times[..times.len() - 1].iter().enumerate() {
            assert!((time - interval * i as f64).abs() < 1e-12, "{times:?}");
        }
        assert!((times.last().unwrap() - 0.01).abs() < 1e-15);
    }
}

/// Conserved: sums over the bodies.
#[test]
fn the_system_has_the_energy_and_momentum_of_its_bodies() {
    let desk = Desk::new(CONTROLLED);
    let summary = desk.json(&["run", "two.toml", "-o", "."]);
    let results = desk.results("two.h5");
    let last = results.rows() - 1;
    for path in ["energy/kinetic", "energy/strain", "energy/work"] {
        let of = |group: &str| results.numbers(&format!("{group}/{path}")).unwrap();
        let (system, ring, bar) = (of("system"), of("bodies/ring"), of("bodies/bar"));
        assert!(system[last] != 0.0);
        for row in 0..=last {
            let sum = ring[row] + bar[row];
            assert!((system[row] - sum).abs() <= 1e-14 * sum.abs(), "{path} {row}");
        }
    }
    let vectors = |path: &str| results.vectors::<3>(path).unwrap()[last].into();
    let [ring, bar, all] = ["bodies/ring", "bodies/bar", "system"]
        .map(|group| -> nalgebra::Vector3<f64> { vectors(&format!("{group}/momentum/linear")) });
    assert!((ring + bar - all).norm() < 1e-12 * all.norm());
    let mut angular = nalgebra::Vector3::zeros();
    for (body, linear) in [("ring", ring), ("bar", bar)] {
        let own: nalgebra::Vector3<f64> = vectors(&format!("bodies/{body}/momentum/angular"));
        let center: nalgebra::Vector3<f64> = vectors(&format!("bodies/{body}/position"));
        angular += own + center.cross(&linear);
    }
    let all: nalgebra::Vector3<f64> = vectors("system/momentum/angular");
    assert!((angular - all).norm() < 1e-12 * all.norm(), "{angular} {all}");
    let told: Vec<f64> = serde_json::from_value(summary["system"]["angular_momentum"].clone()).unwrap();
    assert_eq!(told, all.as_slice());
    // The ring begins where it was placed: the mesh is centred on its plane z = 20 mm to some mm.
    let [_, _, z] = results.vectors::<3>("bodies/ring/origin").unwrap()[0];
    assert!((500.0..540.0).contains(&z), "{z}");
}

/// Conserved: the bytes of an uninterrupted run.
#[test]
fn a_run_that_was_stopped_ends_in_the_same_file_and_what_is_there_is_kept() {
    for time in [CONTROLLED, FIXED] {
        let desk = Desk::new(time);
        let scene = Scene::read(desk.path("two.toml")).unwrap();
        let settings = RunSettings::default();
        run(&scene, &desk.path("whole"), &settings, |_| ()).unwrap();
        let expected = std::fs::read(desk.path("whole/two.h5")).unwrap();
        let Err(error) = run(&scene, &desk.path("whole"), &settings, |_| ()) else { panic!("there is a file") };
        assert!(error.to_string().contains("two.h5"), "{error}");

        // Again and again, so soon as it moves.
        let stop = Arc::new(AtomicBool::new(false));
        let settings = RunSettings { stop: stop.clone(), ..settings };
        let stops = |progress: RunProgress| {
            if matches!(progress, RunProgress::Motion(_)) {
                stop.store(true, Ordering::Relaxed);
            }
        };
        let first = run(&scene, &desk.path("parts"), &settings, stops);
        let Err(RunError::Stopped { .. }) = first else { panic!("{first:?}") };
        let mut rounds = 0;
        loop {
            stop.store(false, Ordering::Relaxed);
            let stops = |progress: RunProgress| {
                if matches!(progress, RunProgress::Motion(_)) && rounds < 3 {
                    stop.store(true, Ordering::Relaxed);
                }
            };
            match resume(&desk.path("parts/two.h5"), &settings, stops) {
                Ok(report) => {
                    assert_eq!(report.bodies.len(), 2);
                    break;
                }
                Err(RunError::Stopped { .. }) => rounds += 1,
                Err(error) => panic!("{error}"),
            }
        }
        assert!(std::fs::read(desk.path("parts/two.h5")).unwrap() == expected, "{time:?}");
    }
}

/// Conserved: the same numbers by both paths.
#[test]
fn the_file_of_a_system_has_the_paths_that_the_page_on_results_gives() {
    let desk = Desk::new(CONTROLLED);
    desk.done(&["run", "two.toml", "-o", "."]);
    desk.done(&["run", "two.toml", "-o", ".", "--body", "bar"]);
    let file = hdf5::File::open(desk.path("two.h5")).unwrap();
    for path in ["time", "system/energy/total", "bodies/ring/points/velocity", "bodies/bar/model/frequencies"] {
        assert!(file.dataset(path).is_ok(), "{path}");
    }
    for path in ["energy", "points", "body", "modal"] {
        assert!(!file.link_exists(path), "{path}");
    }
    // A body that has the file to itself is there by the short paths, too.
    let results = desk.results("two.bar.h5");
    let file = hdf5::File::open(desk.path("two.bar.h5")).unwrap();
    for history in histories(&COLUMNS, &results.metadata).filter(|history| history.column.scope() != Scope::System) {
        let path = history.path(&results.metadata);
        let short = path.strip_prefix("bodies/bar/").unwrap();
        let read = |path: &str| file.dataset(path).unwrap().read_raw::<f64>().unwrap();
        assert_eq!(read(short), read(&path));
    }
    assert_eq!(results.vectors::<3>("points/tip/velocity"), results.vectors::<3>("bodies/bar/points/tip/velocity"));
}

#[test]
fn every_output_has_all_bodies() {
    let desk = Desk::new(CONTROLLED);
    let text = desk.done(&["run", "two.toml", "-o", "out"]);
    for words in ["body ring\n", "body bar\n", "all 2 bodies\n", "(21 rows)"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    desk.done(&["export", "out/two.h5", "--csv", "all.csv"]);
    let table = std::fs::read_to_string(desk.path("all.csv")).unwrap();
    let head = table.lines().next().unwrap();
    for name in ["system/energy/total [", "bodies/ring/points/rim/velocity x [", "bodies/bar/modal/displacement 3 ["] {
        assert!(head.contains(name), "{name}: {head}");
    }
    assert_eq!(table.lines().count(), 22);
    desk.done(&["export", "out/two.h5", "--csv", "some.csv", "--columns", "bodies/bar/points/tip/velocity"]);
    let some = std::fs::read_to_string(desk.path("some.csv")).unwrap();
    assert_eq!(some.lines().next().unwrap().split(',').count(), 4);

    desk.done(&["export", "out/two.h5", "--vtkhdf", "all.vtkhdf", "--vtu", "vtu", "--modes", "modes.vtkhdf"]);
    let file = hdf5::File::open(desk.path("all.vtkhdf")).unwrap();
    let elements = |body: &str| file.dataset(&format!("VTKHDF/{body}/Points")).unwrap().shape()[0];
    assert!(elements("ring") > 100 && elements("bar") > 100 && elements("ring") != elements("bar"));
    let listed = std::fs::read_to_string(desk.path("vtu/two.pvd")).unwrap();
    assert_eq!(listed.matches("<DataSet").count(), 2 * 21, "{listed}");

    desk.done(&["animate", "out/two.h5", "-o", "all.gif", "--frames", "3"]);
    desk.done(&["animate", "two.toml", "-o", "scene.gif", "--frames", "3"]);
    assert!(std::fs::read(desk.path("all.gif")).unwrap() == std::fs::read(desk.path("scene.gif")).unwrap());
    desk.done(&["report", "out/two.h5", "-o", "page.html"]);
    let page = std::fs::read_to_string(desk.path("page.html")).unwrap();
    assert!(page.contains("\"ring\"") && page.contains("\"bar\""));

    let advice = desk.done(&["advise", "two.toml"]);
    let modes = desk.done(&["modes", "two.toml", "-o", "pictures"]);
    for text in [advice, modes] {
        assert!(text.contains("body ring\n") && text.contains("body bar\n"), "{text}");
    }
    let listed = desk.json(&["modes", "two.toml"]);
    assert_eq!(listed["bodies"][1]["name"], "bar");
    for body in BODIES {
        assert!(desk.path(&format!("pictures/modes.{body}.svg")).exists(), "{body}");
    }
}

/// Conserved: the numbers of a run.
#[test]
fn a_sweep_of_a_system_varies_one_body_and_keeps_results_of_the_other() {
    let desk = Desk::new(CONTROLLED);
    let sweep = "scene = \"two.toml\"\n[parameters]\n\"bodies.bar.modes.flexible\" = [1, 3]\n[results]\n\
                 tip = { final = \"bodies/bar/points/tip/displacement\" }\nrim = { final = \"bodies/ring/points/rim/displacement\" }\n\
                 total = { final = \"system/energy/total\" }\n";
    std::fs::write(desk.path("sweep.toml"), sweep).unwrap();
    desk.done(&["sweep", "sweep.toml", "-o", "sweep.h5"]);
    let file = hdf5::File::open(desk.path("sweep.h5")).unwrap();
    let read = |name: &str| file.dataset(&format!("results/{name}")).unwrap().read_raw::<f64>().unwrap();
    let (tip, rim) = (read("tip"), read("rim"));
    assert_eq!(rim[..3], rim[3..]);
    assert!(tip[..3] != tip[3..], "{tip:?}");
    desk.done(&["run", "two.toml", "-o", "."]);
    let results = desk.results("two.h5");
    let last = |path: &str| *results.vectors::<3>(path).unwrap().last().unwrap();
    assert_eq!(tip[3..], last("bodies/bar/points/tip/displacement"));
    assert_eq!(rim[3..], last("bodies/ring/points/rim/displacement"));
    assert_eq!(read("total")[1], *results.numbers("system/energy/total").unwrap().last().unwrap());
}

#[test]
fn one_body_is_asked_for_where_there_are_several() {
    let desk = Desk::new(CONTROLLED);
    for (arguments, words) in [
        (&["reduce", "-o", "b.body.h5"][..], "name one of them: ring, bar"),
        (&["modes", "--body", "wheel"], "no body `wheel`"),
        (&["run", "--solver", "slepc", "--ranks", "2"], "--body NAME"),
    ] {
        let all: Vec<&str> = [arguments[0], "two.toml"].into_iter().chain(arguments[1..].iter().copied()).collect();
        let Output { status, stderr, .. } = desk.flexframe(&all);
        let stderr = String::from_utf8(stderr).unwrap();
        assert!(!status.success() && stderr.contains(words), "{arguments:?}: {stderr}");
    }
    // By its name it is a scene of one, whose results carry the whole text.
    let text = std::fs::read_to_string(desk.path("two.toml")).unwrap();
    let bar = Body::parse_body(&text, desk.path("two.toml"), Some("bar")).unwrap();
    run(&bar.into(), desk.folder.path(), &RunSettings::default(), |_| ()).unwrap();
    let metadata = desk.results("two.bar.h5").metadata;
    assert_eq!(metadata.scene_text, text);
    assert_eq!(metadata.only_body().unwrap().name, "bar");
}
