//! Answers that are kept from run to run give the same body, to the last bit, and nothing else is taken for them.

use std::fs;
use std::path::{Path, PathBuf};

use model::{Builder, Cache, CacheNotes, Needs};
use scene::{Body, BodySource};

use crate::{CLAMPED, bar, observations};

const LIMIT: u64 = 1 << 30;
const TIME: &str = "end = 2e-4\nstep = 1e-5";
const SPIN: &str = "[initial]\nangular_velocity = [3.0, 5.0, 400.0]\n";
pub const FORCE: &str = "[[loads]]\nkind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = [-1.0, 0.5, 0.0]\namplitude = 200.0\n\
                     history = { kind = \"constant\" }\n";
const GRAVITY: &str = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n\
                       history = { kind = \"constant\" }\n";

/// All that a model has, to the last bit, without the time that it took; then how often matrices were assembled.
pub fn built(body: &Body) -> (String, usize) {
    built_with(&Cache::none(), body)
}

/// The same with a cache.
pub fn built_with(cache: &Cache, body: &Body) -> (String, usize) {
    built_by(&Builder::with_cache(cache.clone()), body)
}

/// The same with needs.
pub fn built_by(builder: &Builder, body: &Body) -> (String, usize) {
    let before = builder.cache.notes().assembled;
    let model = builder.build(body, |_| ()).unwrap();
    let assembled = builder.cache.notes().assembled - before;
    let meshed = model.meshed.as_ref().unwrap();
    let modes = &meshed.modes;
    let text = format!(
        "{:?}",
        (
            (
                &model.body,
                &model.physics,
                &model.points,
                model.paper.reference_points,
                model.loads(),
                model.backbones()
            ),
            (model.damping_ratios(), &model.advice, model.refusal, &meshed.mesh, meshed.matrix_bytes),
            (&modes.eigenvalues, &modes.shapes, &modes.rigid, &modes.residuals, &modes.force_residuals),
            observations(body, &model),
        )
    );
    (text, assembled)
}

fn notes(read: usize, computed: usize, assembled: usize) -> CacheNotes {
    CacheNotes { read, computed, assembled, warnings: Vec::new() }
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.sort();
    found
}

/// Conserved: the same bits without the cache.
#[test]
fn a_body_from_the_cache_is_the_same_to_the_last_bit_and_solves_nothing() {
    let driven = "[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\ngroup = \"root\"\n\
                  motion = { amplitude = 100.0, history = { kind = \"half-sine\", duration = 0.1 } }\n";
    for (modes, rest) in [
        ("flexible = 6", String::new()),
        ("flexible = 0", SPIN.to_owned()),
        ("flexible = 6\nstatic_correction = true", format!("{SPIN}{FORCE}")),
        ("flexible = \"auto\"\nmost = 8", format!("{SPIN}{GRAVITY}")),
        ("flexible = 4", format!("{CLAMPED}{FORCE}{GRAVITY}[effects]\ngeometric_stiffening = true\nrefuse = false\n")),
        ("flexible = 4", driven.to_owned()),
        ("flexible = 6\nlarge = 2", format!("{CLAMPED}{FORCE}[effects]\nlarge_deflection = true\nrefuse = false\n")),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let scene = bar(modes, &rest, TIME);
        let (direct, assembled) = built(&scene);
        assert_eq!(assembled, 1);
        let cache = Cache::new(folder.path(), LIMIT);
        let (first, assembled) = built_with(&cache, &scene);
        let computed = cache.notes().computed;
        assert_eq!((assembled, cache.notes()), (1, notes(0, computed, 1)), "{modes} {rest}");
        assert!(first == direct, "{modes} {rest}");
        let cache = Cache::new(folder.path(), LIMIT);
        let (second, assembled) = built_with(&cache, &scene);
        // The mesh is no answer, but is read, too.
        assert_eq!((assembled, cache.notes()), (0, notes(computed + 1, 0, 0)), "{modes} {rest}");
        assert!(second == direct, "{modes} {rest}");
    }
}

/// Regression only: the modes of this body are under this name in the caches of users, whatever the program calls its
/// fields. With another version of the key, write down another name.
#[test]
fn the_name_of_the_modes_stays() {
    const NAME: &str = "d7472c103cf264b5499bacbb0397a3f5cbc5b89a63accf671c455af9087007c1/\
                        9e775670cf8998baba496b79b81a792669b33e98a85081446a59a23178bd85c5.kept";
    let folder = tempfile::tempdir().unwrap();
    built_with(&Cache::new(folder.path(), LIMIT), &bar("flexible = 2", CLAMPED, TIME));
    let names: Vec<_> = files(folder.path()).iter().map(|path| path.display().to_string()).collect();
    assert!(names.iter().any(|name| name.ends_with(NAME)), "{names:?}");
}

/// Conserved: the same bits without the cache. Speeds and sizes of loads share one solution; another load, material,
/// support or number of modes is asked for anew.
#[test]
fn only_what_is_the_same_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let spin = |speed: f64| format!("[initial]\nangular_velocity = [0.0, 0.0, {speed:.1}]\n");
    let modes = "flexible = 6\nstatic_correction = true";
    // It depends on the amplitude which modes may bend the body far, and are asked for their backbones.
    let needs = Needs { backbones: false, ..Needs::default() };
    let assembled = |body: &Body| {
        let (direct, _) = built_by(&Builder::default().needing(needs.clone()), body);
        let builder = Builder::with_cache(Cache::new(folder.path(), LIMIT)).needing(needs.clone());
        let (kept, assembled) = built_by(&builder, body);
        assert!(kept == direct);
        assembled
    };
    assert_eq!(assembled(&bar(modes, &spin(100.0), TIME)), 1);
    for speed in [200.0, 300.0, 400.0] {
        assert_eq!(assembled(&bar(modes, &spin(speed), TIME)), 0, "{speed}");
    }
    assert_eq!(assembled(&bar("flexible = 5\nstatic_correction = true", &spin(100.0), TIME)), 1);
    let forced = |force: &str| bar(modes, &format!("{CLAMPED}{force}[output]\npeak_stress = true\n"), TIME);
    assert_eq!(assembled(&forced(FORCE)), 1);
    for amplitude in ["20.0", "351.7", "0.3"] {
        let force = FORCE.replace("200.0\nhistory", &format!("{amplitude}\nhistory"));
        assert_ne!(force, FORCE);
        assert_eq!(assembled(&forced(&force)), 0, "{amplitude}");
    }
    assert_eq!(assembled(&forced(&FORCE.replace("0.5, 0.0", "0.0, 0.5"))), 1);
    let mut heavier = bar(modes, &spin(100.0), TIME);
    let BodySource::Meshed(meshed) = &mut heavier.source else { panic!() };
    meshed.point_masses.push(scene::PointMass { at: [200.0, 0.0, 0.0], mass: 1e-6, spread: None });
    assert_eq!(assembled(&heavier), 1);
}

/// Conserved: the same bits without the cache. The load says which parts of an answer are known from before, and in
/// which company the others are computed: their last bits.
#[test]
fn answers_of_another_size_of_a_load_are_the_same_to_the_last_bit() {
    let pin = "[[constraints]]\nkind = \"pin\"\nat = [0.0, 0.0, 0.0]\nradius = 6.0\n";
    let scenes = ["1e-6", "200.0", "1e3"].map(|amplitude| {
        let force = FORCE.replace("200.0\nhistory", &format!("{amplitude}\nhistory"));
        let effects = "[effects]\nlarge_deflection = true\nrefuse = false\n";
        bar("flexible = 2\nlarge = 2\nstatic_correction = false", &format!("{pin}{force}{effects}"), TIME)
    });
    let direct = scenes.each_ref().map(|body| built(body).0);
    for (first, body) in scenes.iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(folder.path(), LIMIT);
        built_with(&cache, body);
        for (next, (body, direct)) in scenes.iter().zip(&direct).enumerate() {
            assert!(built_with(&cache, body).0 == *direct, "{next} after {first}");
        }
    }
}

#[test]
fn another_mesh_under_the_same_name_is_another_body() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("bar.msh");
    fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/bar.msh"), &mesh).unwrap();
    let mut body = bar("flexible = 3", "", TIME);
    let BodySource::Meshed(meshed) = &mut body.source else { panic!() };
    meshed.mesh.clone_from(&mesh);
    let cache = Cache::new(folder.path().join("cache"), LIMIT);
    let (before, _) = built_with(&cache, &body);
    assert_eq!(built_with(&cache, &body).1, 0);
    // A node that moves by a hair.
    let text = fs::read_to_string(&mesh).unwrap();
    let moved = text.replacen("\n200 ", "\n200.000001 ", 1);
    assert_ne!(text, moved);
    fs::write(&mesh, moved).unwrap();
    let (after, assembled) = built_with(&cache, &body);
    assert_eq!(assembled, 1);
    assert!(before != after && after == built(&body).0);
}

#[test]
fn damaged_answers_are_computed_again_and_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar("flexible = 4", SPIN, TIME);
    let cache = Cache::new(folder.path(), LIMIT);
    let (direct, _) = built_with(&cache, &scene);
    let all = files(folder.path());
    let damages: [fn(Vec<u8>) -> Vec<u8>; 4] = [
        |_| Vec::new(),
        |bytes| bytes[..bytes.len() / 2].to_vec(),
        |bytes| b"something else".iter().copied().chain(bytes).collect(),
        |mut bytes| {
            // The last byte of the last array, behind which HDF5 may have more.
            let at = bytes.iter().rposition(|byte| *byte != 0).unwrap();
            bytes[at] ^= 1;
            bytes[100] ^= 1;
            bytes
        },
    ];
    for damage in damages {
        for path in &all {
            fs::write(path, damage(fs::read(path).unwrap())).unwrap();
        }
        let cache = Cache::new(folder.path(), LIMIT);
        assert!(built_with(&cache, &scene).0 == direct);
        let notes = cache.notes();
        assert_eq!((notes.read, notes.warnings.len()), (0, all.len()), "{notes:?}");
        assert!(notes.warnings[0].contains("cache entry damaged; recomputing"), "{notes:?}");
        let cache = Cache::new(folder.path(), LIMIT);
        assert_eq!(built_with(&cache, &scene).1, 0);
    }
}

/// The answer to another question, whole in itself, under the name of this one.
#[test]
fn an_answer_under_another_name_is_not_taken() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar("flexible = 4", SPIN, TIME);
    let (direct, _) = built_with(&Cache::new(folder.path(), LIMIT), &scene);
    let all = files(folder.path());
    let contents: Vec<_> = all.iter().map(|path| fs::read(path).unwrap()).collect();
    for (i, path) in all.iter().enumerate() {
        fs::write(path, &contents[(i + 1) % all.len()]).unwrap();
    }
    let cache = Cache::new(folder.path(), LIMIT);
    assert!(built_with(&cache, &scene).0 == direct);
    assert_eq!(cache.notes().read, 0);
}

#[test]
fn a_cache_that_cannot_be_written_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar("flexible = 3", "", TIME);
    let (direct, _) = built(&scene);
    // A file is where the folder would be.
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let cache = Cache::new(&file, LIMIT);
    assert!(built_with(&cache, &scene).0 == direct);
    let notes = cache.notes();
    assert_eq!(notes.warnings.len(), 1, "{notes:?}");
    assert!(notes.warnings[0].contains("cannot be written, and what is computed is not kept"), "{notes:?}");
}

#[test]
fn the_oldest_are_removed_beyond_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |folder: &Path| files(folder).iter().map(|path| fs::metadata(path).unwrap().len()).sum::<u64>();
    let [small, large] = ["flexible = 2", "flexible = 8"].map(|modes| bar(modes, "", TIME));
    built_with(&Cache::new(folder.path(), LIMIT), &small);
    let before = files(folder.path());
    let limit = bytes(folder.path()) + 200_000;
    let (direct, _) = built(&large);
    assert!(built_with(&Cache::new(folder.path(), limit), &large).0 == direct);
    assert!(bytes(folder.path()) <= limit);
    let after = files(folder.path());
    assert!(before.iter().any(|path| !after.contains(path)), "{before:?} {after:?}");
    // What is not of the cache is left alone.
    let others = ["mine/mine/mine.h5", "mine.h5"].map(|name| folder.path().join(name));
    fs::create_dir_all(folder.path().join("mine/mine")).unwrap();
    others.iter().for_each(|path| fs::write(path, "").unwrap());
    // With room for nothing, nothing is kept, and the answers are the same.
    assert!(built_with(&Cache::new(folder.path(), 0), &large).0 == direct);
    assert_eq!(files(folder.path()), others);
}

/// Several threads that build the same body at once compute it once.
#[test]
fn threads_that_ask_the_same_wait_for_one_answer() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar("flexible = 6", SPIN, TIME);
    let (direct, _) = built(&scene);
    let cache = Cache::new(folder.path(), LIMIT);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert!(built_with(&cache, &scene).0 == direct));
        }
    });
    assert_eq!(cache.notes().assembled, 1);
    assert!(cache.notes().warnings.is_empty());
}

/// Two programs know nothing of each other: each has a cache of its own over the same folder.
#[test]
fn two_programs_may_use_the_folder_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar("flexible = 6", SPIN, TIME);
    let (direct, _) = built(&scene);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..2 {
                    let cache = Cache::new(folder.path(), LIMIT);
                    assert!(built_with(&cache, &scene).0 == direct);
                    assert!(cache.notes().warnings.is_empty(), "{:?}", cache.notes());
                }
            });
        }
    });
    assert!(files(folder.path()).iter().all(|path| !path.to_str().unwrap().contains(".flexframe-")));
}
