//! A scene that names a body file runs without the mesh, to the last bit; another body is refused.

use std::fs;
use std::path::{Path, PathBuf};

use model::{Builder, Cache, Model};
use scene::{Body, BodySource};
use sealed::{Declared, Format, Kind, SealedFile, Writer};

use super::cache::{FORCE, built, built_with};
use crate::CLAMPED;

const MATERIAL: &str = "material = { young_modulus = 70e3, poisson_ratio = 0.3, density = 2.7e-9 }";
const MASS: &str = "point_masses = [{ at = [200.0, 0.0, 0.0], mass = 1e-6 }]";

/// A scene in a folder of its own, with this body and number of modes.
fn scene(folder: &Path, body: &str, modes: &str, rest: &str) -> Body {
    Body::parse(&text(body, modes, rest), folder.join("scene.toml")).unwrap_or_else(|error| panic!("{error}"))
}

fn text(body: &str, modes: &str, rest: &str) -> String {
    format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\n{body}\n\
         [modes]\n{modes}\n{rest}\n[time]\nend = 2e-4\nstep = 1e-5\n[output.points]\ntip = [200.0, 0.0, 0.0]\n"
    )
}

/// A folder with a mesh, and a body file that was made of it.
fn reduced(modes: &str, rest: &str, matrices: bool) -> (tempfile::TempDir, Body, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("bar.msh");
    fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/bar.msh"), mesh).unwrap();
    let scene = scene(folder.path(), &format!("mesh = \"bar.msh\"\n{MATERIAL}\n{MASS}"), modes, rest);
    let path = folder.path().join("bar.body.h5");
    Builder::default().write_body(&scene, &path, matrices, |_| ()).unwrap();
    (folder, scene, path)
}

const MODES: &str = "flexible = 6\nstatic_correction = true";
const SPIN: &str = "[initial]\nangular_velocity = [3.0, 5.0, 400.0]\n";

/// Conserved: the same bits from the mesh.
#[test]
fn a_body_file_stands_for_the_mesh_to_the_last_bit() {
    for rest in [format!("{SPIN}{FORCE}"), format!("{CLAMPED}{FORCE}[effects]\nrefuse = false\n")] {
        let (folder, direct, _) = reduced(MODES, &rest, false);
        let (expected, assembled) = built(&direct);
        assert_eq!(assembled, 1);
        fs::remove_file(folder.path().join("bar.msh")).unwrap();
        for body in [
            "file = \"bar.body.h5\"".to_owned(),
            format!("file = \"bar.body.h5\"\nmesh = \"bar.msh\"\n{MATERIAL}\n{MASS}"),
        ] {
            let from_file = scene(folder.path(), &body, MODES, &rest);
            let cache = Cache::none();
            let (found, assembled) = built_with(&cache, &from_file);
            assert_eq!((assembled, cache.notes().computed), (0, 0));
            assert!(found == expected, "{rest}");
        }
        // Another speed asks nothing new where the same modes are large; another load does, and is answered from the mesh in the file.
        let faster = rest.replace("400.0", "399.0");
        let body = "file = \"bar.body.h5\"";
        assert_eq!(built(&scene(folder.path(), body, MODES, &faster)).1, 0);
        let elsewhere = scene(folder.path(), body, MODES, &rest.replace("at = [200.0", "at = [100.0"));
        assert_eq!(built(&elsewhere).1, 1);
    }
}

#[test]
fn a_body_file_is_the_same_whether_its_answers_were_known() {
    let (folder, scene, path) = reduced(MODES, SPIN, true);
    let first = fs::read(&path).unwrap();
    let builder = Builder::with_cache(Cache::new(folder.path().join("cache"), 1 << 30));
    for _ in 0..2 {
        builder.write_body(&scene, &path, true, |_| ()).unwrap();
        assert!(fs::read(&path).unwrap() == first);
    }
}

/// Stress of all kinds, of a bar that may bend far.
const STRESS: &str =
    "[effects]\nlarge_deflection = true\nrefuse = false\n[output]\nstress = true\npeak_stress = true\n";
const LARGE: &str = "flexible = 6\nstatic_correction = true\nlarge = [1, 2]";
/// A moment, of which the static answer is a large coordinate.
const MOMENT: &str = "[[loads]]\nkind = \"moment\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 1e4\n\
    history = { kind = \"constant\" }\n";

/// Conserved: the same bits from the mesh.
#[test]
fn the_stress_from_a_body_file_is_the_same_to_the_last_bit_and_not_recovered_again() {
    for (modes, load) in [(MODES, FORCE), (LARGE, FORCE), (LARGE, MOMENT)] {
        let rest = format!(
            "{CLAMPED}{load}{}",
            if modes == LARGE { STRESS } else { &STRESS[STRESS.find("[output]").unwrap()..] }
        );
        let (folder, direct, _) = reduced(modes, &rest, false);
        let builder = Builder::default();
        let stresses = |body: &Body| {
            let model = builder.build(body, |_| ()).unwrap();
            assert_eq!(model.static_answer(), (load == MOMENT).then_some(2));
            let stress = model.stress.as_ref().unwrap();
            let of_row = |now: dynamics::Observation| {
                let peak = stress.peak(&now).unwrap();
                let at_points: Vec<_> = stress.at_points(&now.modal_displacement).flatten().collect();
                ([peak.von_mises, peak.left_out, peak.max_left_out].map(f64::to_bits), peak.node, at_points)
            };
            model.start(body).unwrap().map(|now| of_row(now.unwrap())).collect::<Vec<_>>()
        };
        let expected = stresses(&direct);
        let counts = || [builder.cache.notes().assembled, builder.cache.notes().computed];
        let before = counts();
        assert!(f64::from_bits(expected.last().unwrap().0[0]) > 0.0);
        fs::remove_file(folder.path().join("bar.msh")).unwrap();
        let from_file = scene(folder.path(), "file = \"bar.body.h5\"", modes, &rest);
        assert!(stresses(&from_file) == expected);
        assert_eq!(counts(), before);
    }
}

/// Independent reference: sums over what is read of the file.
#[test]
fn what_is_bent_far_and_its_stress_follow_from_what_others_read() {
    let (_folder, direct, path) = reduced(LARGE, &format!("{CLAMPED}{FORCE}{STRESS}"), false);
    let model = Model::build(&direct, |_| ()).unwrap();
    let (meshed, stress) = (model.meshed.as_ref().unwrap(), model.stress.as_ref().unwrap());
    let file = SealedFile::open(&path, Format::BODY).unwrap();
    let read = |name: &str| file.read::<f64>(name).unwrap();
    let factors = file.read::<u32>("large_deflection/factors").unwrap();
    let one = model.body.flexible() as u32;
    // Two large modes and three that follow: 15 products of two, and four of three.
    assert_eq!((factors.shape[..].to_vec(), &factors.values[..6]), (vec![19, 3], &[0, 0, one, 0, 1, one][..]));
    let q: Vec<f64> = (0..model.body.flexible()).map(|k| 1e-3 * (1.0 + k as f64).sin()).collect();
    let factor = |k: &u32| if *k == one { 1.0 } else { q[*k as usize] };
    let products: Vec<f64> =
        factors.values.as_chunks::<3>().0.iter().map(|factors| factors.iter().map(factor).product()).collect();
    // The coordinates of all shapes.
    let of_products = read("large_deflection/products");
    let all = of_products.shape[1];
    let mut xi = q.clone();
    xi.resize(all, 0.0);
    for (product, adds) in products.iter().zip(of_products.values.chunks_exact(all)) {
        xi.iter_mut().zip(adds).for_each(|(xi, adds)| *xi += product * adds);
    }
    let shapes =
        ["modes/shapes", "static_shapes/shapes", "large_deflection/shapes"].map(|name| read(name).values).concat();
    let (rows, expected) = (meshed.modes.shapes.nrows(), model.coordinates(&q));
    assert_eq!((shapes.len(), expected.len()), (all * rows, all));
    let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let follow = largest(&expected[q.len()..]);
    assert!(
        follow > 0.0 && xi.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12 * follow),
        "{xi:?} {expected:?}"
    );
    let following = meshed.following.as_ref();
    let column = |k: usize| if k < q.len() { meshed.modes.shapes.col(k) } else { following.col(k - q.len()) };
    for i in 0..rows {
        let found: f64 = (0..all).map(|k| shapes[k * rows + i] * xi[k]).sum();
        let truth: f64 = (0..all).map(|k| column(k)[i] * expected[k]).sum();
        assert!((found - truth).abs() < 1e-12 * largest(&q) * largest(&shapes[..rows]), "{i}: {found} {truth}");
    }
    // The stress, at every node.
    let nodes = file.read::<u32>("stress/nodes").unwrap().values;
    assert_eq!(nodes.len(), meshed.mesh.positions().len());
    let (linear, second) = (read("stress/shapes"), read("stress/products"));
    assert_eq!((&linear.shape[..], &second.shape[..]), (&[all, nodes.len(), 6][..], &[19, nodes.len(), 6][..]));
    let coordinates = stress.coordinates(&q);
    let mut of_products = 0.0_f64;
    for (site, node) in nodes.iter().enumerate() {
        let truth = stress.in_coordinates(*node, &coordinates);
        for c in 0..6 {
            let sum = |values: &[f64], by: &[f64]| -> f64 {
                by.iter().enumerate().map(|(k, by)| by * values[6 * (k * nodes.len() + site) + c]).sum()
            };
            let second = sum(&second.values, &products);
            of_products = of_products.max(second.abs());
            let found = sum(&linear.values, &xi) + second;
            assert!((found - truth[c]).abs() < 1e-11 * largest(&truth), "{node}: {found} {truth:?}");
        }
    }
    assert!(of_products > 0.0);
}

#[test]
fn what_others_read_is_what_the_model_has() {
    let (_folder, direct, path) = reduced(MODES, &format!("{SPIN}{FORCE}"), true);
    let model = Model::build(&direct, |_| ()).unwrap();
    let meshed = model.meshed.as_ref().unwrap();
    let file = SealedFile::open(&path, Format::BODY).unwrap();
    let (natural, all, nodes) = (meshed.modes.natural(), model.body.flexible(), meshed.mesh.positions().len());
    assert!(natural < all);
    for (group, first, count) in [("modes", 0, natural), ("static_shapes", natural, all - natural)] {
        let shapes = file.read::<f64>(&format!("{group}/shapes")).unwrap();
        assert_eq!(shapes.shape, [count, nodes, 3]);
        for k in 0..count {
            for i in 0..3 * nodes {
                assert_eq!(shapes.values[3 * nodes * k + i].to_bits(), meshed.modes.shapes[(i, first + k)].to_bits());
            }
        }
        let ratios = file.read::<f64>(&format!("{group}/damping_ratios")).unwrap().values;
        assert_eq!(ratios, model.damping_ratios()[first..first + count]);
    }
    let frequencies = file.read::<f64>("modes/frequencies").unwrap().values;
    assert_eq!(frequencies, model.natural_frequencies()[..natural]);
    let gyroscopic = file.read::<f64>("constants/gyroscopic").unwrap();
    assert_eq!(gyroscopic.shape, [3, all, all]);
    assert_eq!(gyroscopic.values[all * all + 2 * all + 1], model.body.gyroscopic[1][(2, 1)]);
    let products = file.read::<f64>("constants/rotation_products").unwrap().values;
    let size = 6 + all;
    assert_eq!(products[(5 * size + 7) * size + 2], model.body.rotation_products[1][2][(7, 2)]);
    // Every edge of the surface has two faces.
    let faces = file.read::<u32>("mesh/surface_triangles").unwrap();
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for face in faces.values.as_chunks::<6>().0 {
        edges.extend([0, 1, 2].map(|i| [face[i], face[(i + 1) % 3]]));
    }
    let count = edges.len();
    edges.sort_unstable();
    edges.dedup();
    assert_eq!(edges.len(), count);
    assert!(edges.iter().all(|[a, b]| edges.binary_search(&[*b, *a]).is_ok()));
    let attribute = |name: &str| file.text(name).unwrap().to_owned();
    assert_eq!((attribute("title"), attribute("scene")), ("Bar".to_owned(), direct.text_alone.clone()));
}

fn message(folder: &Path, body: &str, modes: &str, rest: &str) -> String {
    match Body::parse(&text(body, modes, rest), folder.join("scene.toml")) {
        Err(error) => error.to_string(),
        Ok(scene) => Model::build(&scene, |_| ()).unwrap_err().to_string(),
    }
}

#[test]
fn a_body_file_of_another_scene_is_refused_with_what_differs() {
    let (folder, _, _) = reduced(MODES, SPIN, false);
    let refused = |body: &str, modes: &str, rest: &str, words: &str| {
        let message = message(folder.path(), body, modes, rest);
        assert!(message.contains("scene.toml:") && message.contains("body.file"), "{message}");
        assert!(message.contains(words) && message.contains("flexframe reduce"), "{message}");
    };
    let file = "file = \"bar.body.h5\"";
    refused(file, "flexible = 9", SPIN, "a body file with 6 modes, expected one with 9, as [modes] asks");
    refused(file, MODES, CLAMPED, "a body file of a body that is held otherwise");
    let steel = MATERIAL.replace("70e3", "210e3");
    refused(&format!("{file}\n{steel}"), MODES, SPIN, "a body file of another material");
    refused(&format!("{file}\npoint_masses = []"), MODES, SPIN, "a body file with other point masses (1 of them)");
    let mut changed = fs::read(folder.path().join("bar.msh")).unwrap();
    changed.push(b'\n');
    fs::write(folder.path().join("bar.msh"), changed).unwrap();
    refused(&format!("{file}\nmesh = \"bar.msh\""), MODES, SPIN, "a body file that was made of another mesh");
    refused("file = \"nowhere.h5\"", MODES, SPIN, "cannot open the file");
    refused("file = \"bar.msh\"", MODES, SPIN, "this is not a body file");
}

/// The file again, without some datasets and with other texts.
fn rewritten(path: &Path, keep: impl Fn(&str) -> bool, change: impl Fn(&str) -> String) {
    let file = SealedFile::open(path, Format::BODY).unwrap();
    let texts = file.texts().iter().map(|(name, text)| (name.clone(), change(text))).collect();
    let described = |name: &str| {
        let (kind, shape, _) = file.described(name).unwrap();
        Declared { path: name.to_owned(), kind, shape: shape.to_vec(), attributes: Vec::new(), same_as: None }
    };
    let declared: Vec<_> = file.datasets().filter(|name| keep(name)).map(described).collect();
    let mut writer = Writer::create(path, texts, &declared).unwrap();
    for Declared { path, kind, .. } in &declared {
        match kind {
            Kind::F64 => writer.write(path, &file.read::<f64>(path).unwrap().values),
            Kind::F32 => writer.write(path, &file.read::<f32>(path).unwrap().values),
            Kind::U64 => writer.write(path, &file.read::<u64>(path).unwrap().values),
            Kind::U32 => writer.write(path, &file.read::<u32>(path).unwrap().values),
        }
        .unwrap();
    }
    writer.finish(false).unwrap();
}

#[test]
fn a_body_file_of_another_version_or_with_a_part_missing_is_refused() {
    let file = "file = \"bar.body.h5\"";
    let (folder, _, path) = reduced(MODES, SPIN, false);
    let whole = fs::read(&path).unwrap();
    let version = concat!("\"program_version\":\"", env!("CARGO_PKG_VERSION"), "\"");
    rewritten(&path, |_| true, |text| text.replace(version, "\"program_version\":\"0.0.9\""));
    let other = message(folder.path(), file, MODES, SPIN);
    assert!(other.contains("a body file of flexframe 0.0.9, expected one of flexframe"), "{other}");

    fs::write(&path, &whole).unwrap();
    rewritten(&path, |name| !name.ends_with("/shapes"), str::to_owned);
    let missing = message(folder.path(), file, MODES, SPIN);
    assert!(missing.contains("it has no dataset answers/") && missing.contains("/shapes"), "{missing}");

    fs::write(&path, &whole).unwrap();
    rewritten(&path, |name| name != "mesh/tetrahedra", str::to_owned);
    let missing = message(folder.path(), file, MODES, SPIN);
    assert!(missing.contains("it has no dataset mesh/tetrahedra"), "{missing}");

    fs::write(&path, &whole[..whole.len() - 1]).unwrap();
    let cut = message(folder.path(), file, MODES, SPIN);
    assert!(cut.contains("the body file is damaged") && cut.contains("were written"), "{cut}");
    // A bit of the numbers of the modes.
    let body = {
        fs::write(&path, &whole).unwrap();
        scene(folder.path(), file, MODES, SPIN)
    };
    let shapes = SealedFile::open(&path, Format::BODY).unwrap().read::<f64>("modes/shapes").unwrap().values;
    let needle: Vec<u8> = shapes[..8].iter().flat_map(|x| x.to_ne_bytes()).collect();
    let at = whole.windows(needle.len()).position(|window| window == needle).unwrap();
    let mut damaged = whole.clone();
    damaged[at] ^= 1;
    fs::write(&path, damaged).unwrap();
    let error = Model::build(&body, |_| ()).unwrap_err().to_string();
    assert!(error.contains("has been changed"), "{error}");
}

#[test]
fn a_rigid_body_has_no_body_file() {
    let folder = tempfile::tempdir().unwrap();
    let body = crate::rigid("", "end = 1.0\nstep = 0.1");
    assert!(matches!(body.source, BodySource::Rigid(_)));
    let error =
        Builder::default().write_body(&body, &folder.path().join("b.h5"), false, |_| ()).unwrap_err().to_string();
    assert!(error.contains("a body with a mesh"), "{error}");
}
