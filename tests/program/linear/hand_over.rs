//! `flexframe reduce` into the files of other programs, read back. Needs a Python with pyYeti, pyNastran and pygltflib, which
//! `FLEXFRAME_READERS` names (`./dev test` sees to it).

use std::path::{Path, PathBuf};
use std::process::Command;

use nalgebra::{DMatrix, Matrix3, Vector3};
use serde_json::Value;

use crate::program::{done, json, numbers, root};

const READERS: &str = "FLEXFRAME_READERS";
const MODES: usize = 6;

/// The clamped bar with two points of the output, as a scene.
fn scene(folder: &Path) -> PathBuf {
    let text = format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = \"{}\"\n\
         material = {{ young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }}\n[modes]\nflexible = {MODES}\n\
         damping_ratio = 0.01\nstatic_correction = false\n[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n[time]\nend = 0.01\n\
         tolerance = 1e-6\n[effects]\ndamping = true\n[output]\npoints = {{ tip = [202.07, 0.0, 0.0], middle = [100.0, 5.0, 5.0] }}\n",
        root().join("meshes/rotating_bar.msh").display()
    );
    let path = folder.join("bar.toml");
    std::fs::write(&path, text).unwrap();
    path
}

/// The reader's view of the file of this ending.
fn handed_over(folder: &Path, ending: &str) -> Value {
    let file = folder.join(format!("bar.{ending}"));
    done(&["reduce", scene(folder).to_str().unwrap(), "-o", file.to_str().unwrap()]);
    let python = std::env::var_os(READERS).expect("FLEXFRAME_READERS names no Python with pyYeti; use ./dev test");
    let read = Command::new(python).arg(root().join("tests/read_hand_over.py")).arg(&file).output().unwrap();
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    serde_json::from_slice(&read.stdout).unwrap()
}

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

/// The report of `flexframe modes` about the scene.
fn modes(folder: &Path) -> Value {
    json(&["modes", scene(folder).to_str().unwrap()])
}

/// Conserved: the matrices that pyYeti and pyNastran read have the frequencies and effective masses of `flexframe modes`. Closed form: a bar
/// whose base moves freely has the frequencies of a free bar, 22.3733 √(EI/ρAL⁴) first.
#[test]
fn op4_is_a_model_of_craig_and_bampton() {
    let folder = tempfile::tempdir().unwrap();
    let (found, report) = (handed_over(folder.path(), "op4"), modes(folder.path()));
    let [mass, stiffness, damping] = ["MXX", "KXX", "BXX"].map(|name| matrix(&found[name]));
    assert_eq!(mass, mass.transpose());
    let frequencies = numbers(&report["body"]["natural_frequencies"]);
    let factors = report["carried"]["factors"].as_array().unwrap();
    let whole = numbers(&report["carried"]["whole"]);
    for i in 0..6 {
        assert!((mass[(i, i)] / whole[i] - 1.0).abs() < 1e-9 && stiffness[(i, i)] == 0.0);
    }
    for k in 0..MODES {
        let omega = std::f64::consts::TAU * frequencies[k];
        assert!((stiffness[(6 + k, 6 + k)] / omega.powi(2) - 1.0).abs() < 1e-12);
        assert!((damping[(6 + k, 6 + k)] / (0.02 * omega) - 1.0).abs() < 1e-12);
        for (i, factor) in numbers(&factors[k]).iter().enumerate() {
            assert!((mass[(6 + k, i)] - factor).abs() < 1e-9 * whole[i].sqrt(), "{k} {i}");
        }
    }
    // The base has the mass of the whole body, so that nothing holds it.
    let inverse = mass.cholesky().unwrap().l().try_inverse().unwrap();
    let mut free: Vec<f64> =
        (&inverse * stiffness * inverse.transpose()).symmetric_eigenvalues().iter().copied().collect();
    free.sort_by(f64::total_cmp);
    let expected = 22.3733 * (70_000.0 * 100.0 / 12.0 / (2.7e-9 * 202.07_f64.powi(4))).sqrt();
    assert!((free[6].sqrt() / expected - 1.0).abs() < 0.02, "{} {expected}", free[6].sqrt());
    // Rotations of the base about the root move the tip by its arm.
    let recovery = matrix(&found["TREC"]);
    // Nodes are in the order of the scene.
    assert!((recovery[(1, 5)] - 202.07).abs() < 1e-9 && recovery.nrows() == 12 && recovery[(9, 3)] == 1.0);
}

/// Independent reference: `flexframe modes` of the bar that is clamped at the nodes of the interface, whose first three frequencies the inner modes
/// have to 1e-3, since free modes and static shapes span them nearly. Conserved: the frequencies of the free bar to 1e-6; nodes of the
/// interface have its coordinates as their displacements; rigid motions of it strain nothing, and have the mass.
#[test]
fn an_interface_of_nodes_is_one_of_craig_and_bampton() {
    let folder = tempfile::tempdir().unwrap();
    let clamped = scene(folder.path());
    let at_root = json(&["modes", clamped.to_str().unwrap()]);
    let text = std::fs::read_to_string(&clamped).unwrap().replace("flexible = 6", "flexible = 20");
    let free = text
        .replace("[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n", "")
        .replace("static_correction = false\n", "");
    let markers =
        "[body.markers]\nroot = { group = \"root\", tie = \"nodes\" }\ntip = { at = [202.07, 0.0, 0.0] }\n[output]";
    std::fs::write(&clamped, free.replace("[output]", markers)).unwrap();
    let file = folder.path().join("free.op4");
    done(&["reduce", clamped.to_str().unwrap(), "-o", file.to_str().unwrap()]);
    let python = std::env::var_os(READERS).expect("FLEXFRAME_READERS names no Python with pyYeti; use ./dev test");
    let read = Command::new(python).arg(root().join("tests/read_hand_over.py")).arg(&file).output().unwrap();
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    let found: Value = serde_json::from_slice(&read.stdout).unwrap();
    let [mass, stiffness, recovery] = ["MXX", "KXX", "TREC"].map(|name| matrix(&found[name]));
    let report = json(&["modes", clamped.to_str().unwrap()]);

    // The interface: nodes of the root, then the six of the tip, which is the last node of the file.
    let size = mass.nrows();
    let inner = (0..size)
        .rev()
        .take_while(|k| (mass[(*k, *k)] - 1.0).abs() < 1e-9 && stiffness[(0, *k)].abs() < 1e-9 * stiffness[(0, 0)])
        .count();
    let count = size - inner;
    assert!(count > 6 + 3 * 8 && (count - 6) % 3 == 0, "{count} of {size}");
    let largest = stiffness.amax();
    for k in 0..inner {
        let rows = stiffness.view((0, count + k), (count, 1));
        assert!(rows.amax() < 1e-9 * largest, "{k}");
    }
    let last = recovery.nrows() - 6;
    for i in 0..6 {
        for j in 0..size {
            let expected = if j + 6 == count + i { 1.0 } else { 0.0 };
            assert!((recovery[(last + i, j)] - expected).abs() < 1e-8, "{i} {j}");
        }
    }
    let generalised = |mass: DMatrix<f64>, stiffness: DMatrix<f64>| -> Vec<f64> {
        let inverse = mass.cholesky().unwrap().l().try_inverse().unwrap();
        let mut squares: Vec<f64> =
            (&inverse * stiffness * inverse.transpose()).symmetric_eigenvalues().iter().copied().collect();
        squares.sort_by(f64::total_cmp);
        squares.into_iter().map(|square| square.max(0.0).sqrt() / std::f64::consts::TAU).collect()
    };
    let free = numbers(&report["body"]["natural_frequencies"]);
    let all = generalised(mass.clone(), stiffness.clone());
    for (found, expected) in all[6..].iter().zip(&free[..8]) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
    // With the root held, and the tip free.
    let kept: Vec<usize> = (count - 6..size).collect();
    let held = |of: &DMatrix<f64>| DMatrix::from_fn(kept.len(), kept.len(), |i, j| of[(kept[i], kept[j])]);
    let inner = generalised(held(&mass), held(&stiffness));
    for (found, expected) in inner.iter().zip(&numbers(&at_root["body"]["natural_frequencies"])[..3]) {
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }
    // A translation of all of it.
    let along = |axis: usize| DMatrix::from_fn(size, 1, |i, _| f64::from(u8::from(i < count - 3 && i % 3 == axis)));
    for axis in 0..3 {
        let moved = along(axis);
        assert!((&stiffness * &moved).amax() < 1e-8 * largest);
        let whole = report["body"]["mass"].as_f64().unwrap();
        assert!(((moved.transpose() * &mass * &moved)[(0, 0)] / whole - 1.0).abs() < 1e-9);
    }
    // Turns about the tip, with all else at ease: they strain nothing and turn the root by the same.
    let others: Vec<usize> = (0..count - 6).chain(count..size).collect();
    let of_others = DMatrix::from_fn(others.len(), others.len(), |i, j| stiffness[(others[i], others[j])]).lu();
    for axis in 0..3 {
        let tip = count - 3 + axis;
        let pulled = DMatrix::from_fn(others.len(), 1, |i, _| -stiffness[(others[i], tip)]);
        let at_ease = of_others.solve(&pulled).unwrap();
        let mut turned = DMatrix::zeros(size, 1);
        turned[(tip, 0)] = 1.0;
        others.iter().zip(at_ease.iter()).for_each(|(i, x)| turned[(*i, 0)] = *x);
        let energy = (turned.transpose() * &stiffness * &turned)[(0, 0)];
        assert!(energy.abs() < 1e-6 * stiffness[(tip, tip)], "{axis}: {energy} {}", stiffness[(tip, tip)]);
        let seen = &recovery * &turned;
        let arm = Vector3::new(-202.07, 0.0, 0.0);
        let expected = Vector3::ith(axis, 1.0).cross(&arm);
        // The root is the node before the tip.
        for i in 0..3 {
            let turn = if i == axis { 1.0 } else { 0.0 };
            let (at, of) = (seen[(last - 6 + i, 0)], seen[(last - 3 + i, 0)]);
            assert!((at - expected[i]).abs() < 1e-4 * 202.07 && (of - turn).abs() < 1e-4, "{axis} {i}: {at} {of}");
        }
    }
}

/// Conserved: the mass of the body in the first three coordinates, which nothing strains: one node, or two, which are on a line, hold no
/// body. Three nodes hold it: the nine displacements are coordinates.
#[test]
fn markers_that_do_not_hold_a_body_are_told_and_leave_its_rigid_motions() {
    let folder = tempfile::tempdir().unwrap();
    let path = scene(folder.path());
    let text = std::fs::read_to_string(&path).unwrap().replace("flexible = 6", "flexible = 12");
    let free = text
        .replace("[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n", "")
        .replace("static_correction = false\n", "");
    let node = |name: &str, at: [f64; 3]| format!("{name} = {{ at = {at:?}, radius = 1e-3, tie = \"nodes\" }}");
    let (a, b, c) = (node("a", [0.0, 5.0, 5.0]), node("b", [0.0, -5.0, 5.0]), node("c", [0.0, 5.0, -5.0]));
    let file = folder.path().join("free.op4");
    let reduced = |markers: &[&str]| -> (String, [DMatrix<f64>; 2]) {
        let with = format!("[body.markers]\n{}\n[output]", markers.join("\n"));
        std::fs::write(&path, free.replace("[output]", &with)).unwrap();
        let asked = ["reduce", path.to_str().unwrap(), "-o", file.to_str().unwrap(), "--overwrite"];
        let told = json(&asked)["warnings"].to_string();
        let python = std::env::var_os(READERS).expect("FLEXFRAME_READERS names no Python with pyYeti; use ./dev test");
        let read = Command::new(python).arg(root().join("tests/read_hand_over.py")).arg(&file).output().unwrap();
        assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
        let found: Value = serde_json::from_slice(&read.stdout).unwrap();
        (told, ["MXX", "KXX"].map(|name| matrix(&found[name])))
    };
    for (markers, words) in [
        (vec![&a[..]], ["a do not hold", "six rigid motions"]),
        (vec![&a, &b], ["a, b do not hold", "six rigid motions"]),
    ] {
        let (told, [mass, stiffness]) = reduced(&markers);
        assert!(words.iter().all(|word| told.contains(word)), "{told}");
        assert!(stiffness.rows(0, 6).amax() == 0.0 && (mass[(0, 0)] / mass[(1, 1)] - 1.0).abs() < 1e-12);
        assert!(mass[(0, 1)].abs() < 1e-12 * mass[(0, 0)]);
    }
    let (told, [_, stiffness]) = reduced(&[&a, &b, &c]);
    assert!(!told.contains("no interface") && (0..9).all(|i| stiffness[(i, i)] > 0.0), "{told}");
}

/// Conserved: the same numbers in both files, bit for bit.
#[test]
fn op2_has_the_matrices_of_op4() {
    let folder = tempfile::tempdir().unwrap();
    let [binary, text] = ["op2", "op4"].map(|ending| handed_over(folder.path(), ending));
    assert_eq!(binary, text);
    assert_eq!(binary.as_object().unwrap().len(), 4);
}

/// The matrices that pyYeti and pyNastran read of a scene, and the words about them.
fn op4_of(scene: &Path) -> (Value, String) {
    let file = scene.with_extension("op4");
    let said = done(&["reduce", scene.to_str().unwrap(), "-o", file.to_str().unwrap()]);
    let python = std::env::var_os(READERS).expect("FLEXFRAME_READERS names no Python with pyYeti; use ./dev test");
    let read = Command::new(python).arg(root().join("tests/read_hand_over.py")).arg(&file).output().unwrap();
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    (serde_json::from_slice(&read.stdout).unwrap(), said)
}

/// Closed form: the slope at the end of a cantilever over its deflection there is between 1.3765/L, without a mass at its end, and 1.5/L, of
/// a mass alone.
#[test]
fn points_of_matrices_turn_as_their_nodes_do() {
    let folder = tempfile::tempdir().unwrap();
    let examples = root().join("examples");
    std::fs::create_dir(folder.path().join("boom")).unwrap();
    for name in ["boom.toml", "boom/K.mtx", "boom/M.mtx", "boom/nodes.csv"] {
        std::fs::copy(examples.join(name), folder.path().join(name)).unwrap();
    }
    let (found, said) = op4_of(&folder.path().join("boom.toml"));
    let recovery = matrix(&found["TREC"]);
    let (column, length) = (6, 6.0);
    let slope = [recovery[(1, column)], recovery[(2, column)]];
    let turn = [recovery[(5, column)], -recovery[(4, column)]];
    let along = usize::from(slope[1].abs() > slope[0].abs());
    let ratio = turn[along] / slope[along] * length;
    assert!((1.3765..1.5).contains(&ratio), "{ratio}");
    assert!(!said.contains("do not tell"), "{said}");
}

/// Closed form: the points are at the corners of a cube, which the motions of its base take along. Its nodes have three degrees of freedom: no turns
/// of them are known, which is said.
#[test]
fn matrices_without_turns_are_handed_over_with_a_word_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let at: Vec<Vector3<f64>> =
        (0..8).map(|n| Vector3::new(f64::from(n & 1), f64::from(n >> 1 & 1), f64::from(n >> 2))).collect();
    let mut stiffness = DMatrix::<f64>::zeros(24, 24);
    for (a, b) in (0..8).flat_map(|a| (0..a).map(move |b| (a, b))) {
        let along = (at[a] - at[b]).normalize();
        let spring = 1e4 * along * along.transpose();
        for (i, j, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
            let mut part = stiffness.view_mut((3 * i, 3 * j), (3, 3));
            part += sign * spring;
        }
    }
    let written = |of: &DMatrix<f64>| {
        let entries: Vec<String> = (0..24)
            .flat_map(|j| (j..24).map(move |i| (i, j)))
            .filter(|at| of[*at] != 0.0)
            .map(|(i, j)| format!("{} {} {:?}", i + 1, j + 1, of[(i, j)]))
            .collect();
        format!("%%MatrixMarket matrix coordinate real symmetric\n24 24 {}\n{}\n", entries.len(), entries.join("\n"))
    };
    let nodes: String = (1..).zip(&at).map(|(n, x)| format!("{n},{:?},{:?},{:?}\n", x.x, x.y, x.z)).collect();
    for (name, text) in [
        ("K.mtx", written(&stiffness)),
        ("M.mtx", written(&DMatrix::identity(24, 24))),
        ("nodes.csv", format!("node,x,y,z\n{nodes}")),
        (
            "cube.toml",
            "title = \"Cube\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n[body]\nmatrices = { mass = \"M.mtx\", \
             stiffness = \"K.mtx\", nodes = \"nodes.csv\" }\n[modes]\nflexible = 3\n[time]\nend = 0.01\ntolerance = 1e-6\n\
             [output]\npoints = { z = [1.0, 1.0, 1.0], \"a b\" = [1.0, 0.0, 0.0] }\n"
                .to_owned(),
        ),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let (found, said) = op4_of(&folder.path().join("cube.toml"));
    let recovery = matrix(&found["TREC"]);
    assert_eq!(recovery.shape(), (12, 9));
    // z comes first, as in the scene. Its arm from the middle is half an edge: a turn about z moves it along −x and y.
    assert!((recovery[(0, 5)] + 0.5).abs() < 1e-12 && (recovery[(1, 5)] - 0.5).abs() < 1e-12);
    assert!((recovery[(6, 5)] - 0.5).abs() < 1e-12 && (recovery[(7, 5)] - 0.5).abs() < 1e-12);
    assert!(recovery.view((3, 6), (3, 3)).amax() == 0.0 && recovery.view((0, 6), (3, 3)).amax() > 0.1);
    assert!(said.contains("the nodes at z, a b do not tell how the material there turns"), "{said}");
}

/// Conserved: three files say the same of one body by their own integrals, 42's `L` and `N` turned as `InitFlexModes` turns them.
#[test]
fn integrals_of_mbdyn_42_and_standard_input_data_agree() {
    let folder = tempfile::tempdir().unwrap();
    let [fem, flex, sid] = ["fem", "flex42", "sid_fem"].map(|ending| handed_over(folder.path(), ending));
    let groups = &fem["groups"];
    assert_eq!(fem["nodes"].as_array().unwrap().len(), 2);
    let vectors = |table: &Value| -> Vec<Vector3<f64>> {
        table.as_array().unwrap().iter().map(|row| Vector3::from_vec(numbers(row))).collect()
    };
    let of_sid = |name: &str, order: &str| -> Vec<Vec<f64>> {
        let path = format!("part/modal/{name}");
        sid[&path][order].as_array().unwrap_or(&Vec::new()).iter().map(numbers).collect()
    };
    let entry = |list: &[Vec<f64>], at: &[usize]| {
        let is_it = |row: &&Vec<f64>| row.iter().zip(at).all(|(found, index)| *found == (index + 1) as f64);
        list.iter().find(is_it).map_or(0.0, |row| row[at.len()])
    };
    let close = |a: f64, b: f64, scale: f64, what: &str| assert!((a - b).abs() <= 1e-12 * scale, "{what}: {a} {b}");
    // 42's tensors.
    let tensor = |name: &str, at: &[usize]| {
        let is_it = |row: &&Vec<f64>| row.iter().zip(at).all(|(found, index)| *found == *index as f64);
        let list: Vec<Vec<f64>> = flex[name].as_array().unwrap().iter().map(numbers).collect();
        list.iter().find(is_it).map_or(0.0, |row| row[at.len()])
    };
    let (inv3, inv4) = (matrix(&groups["14"]), matrix(&groups["15"]));
    let (inv8, inv5, inv9) = (matrix(&groups["16"]), matrix(&groups["17"]), matrix(&groups["18"]));
    let (pf, hf) = (vectors(&flex["pf"]), vectors(&flex["hf"]));
    let [ct, cr, gr, inertia] = [("Ct", "m0"), ("Cr", "m0"), ("Gr", "m0"), ("J", "m1")].map(|(n, o)| of_sid(n, o));
    let cr1 = of_sid("Cr", "m1");
    let oe1 = of_sid("Oe", "m1");
    for k in 0..MODES {
        let r = Matrix3::from_fn(|i, j| tensor("l", &[j, i, k]));
        // R of 42: ∫ [X×][φ×] dm.
        let r = Matrix3::from_fn(|i, j| if i == j { r[(i, i)] - r.trace() } else { tensor("l", &[j, i, k]) });
        let scale = r.norm();
        for i in 0..3 {
            close(inv3[(i, k)], pf[k][i], 1.0, "momentum");
            close(inv3[(i, k)], entry(&ct, &[k, i]), 1.0, "Ct");
            close(inv4[(i, k)], hf[k][i], 100.0, "angular momentum");
            close(inv4[(i, k)], entry(&cr, &[k, i]), 100.0, "Cr");
            for j in 0..3 {
                close(inv8[(i, 3 * k + j)], -r[(i, j)], scale, "invariant 8");
                close(entry(&gr, &[i, 3 * k + j]), -2.0 * r[(i, j)], scale, "Gr");
            }
            close(entry(&inertia, &[i, k, 0]), -2.0 * r[(i, i)], scale, "J");
        }
        for l in 0..MODES {
            let n = Matrix3::from_fn(|i, j| tensor("n", &[i, j, k, l]));
            let cross = Vector3::new(n[(1, 2)] - n[(2, 1)], n[(2, 0)] - n[(0, 2)], n[(0, 1)] - n[(1, 0)]);
            for i in 0..3 {
                close(inv5[(i, MODES * k + l)], cross[i], 1.0, "invariant 5");
                close(entry(&cr1, &[k, l, i]), -cross[i], 1.0, "Cr");
                close(entry(&oe1, &[k, l, i]), n[(i, i)] - n.trace(), 1.0, "Oe");
                for j in 0..3 {
                    let expected = n[(j, i)] - if i == j { n.trace() } else { 0.0 };
                    close(inv9[(i, 3 * (MODES * k + l) + j)], expected, 1.0, "invariant 9");
                }
            }
            // The modal mass is one.
            close(n.trace(), f64::from(u8::from(k == l)), 1e3, "mass");
        }
    }
    assert_eq!(sid["part/modal/refmod"]["nelastq"], MODES.to_string());
}

#[test]
fn gltf_has_the_surface_and_an_animation_of_each_mode() {
    let folder = tempfile::tempdir().unwrap();
    let found = handed_over(folder.path(), "glb");
    let extent = numbers(&found["extent"]);
    assert!((extent[0] - 202.07).abs() < 1e-3 && (extent[1] - 10.0).abs() < 1e-3, "{extent:?}");
    assert!(found["last_index"].as_u64().unwrap() < found["points"].as_u64().unwrap());
    assert_eq!(found["animations"].as_array().unwrap().len(), MODES);
    // 33 frames of a weight for each target.
    assert!(numbers(&found["weights"]).iter().all(|length| *length == (33 * MODES) as f64));
    // The largest displacement is 8 % of the size; one of its components is no less than that over √3.
    let largest = numbers(&found["largest"]);
    let size = 0.08 * (202.07_f64.powi(2) + 200.0).sqrt();
    assert!(largest.iter().all(|length| (size / 3f64.sqrt() * 0.999..size * 1.001).contains(length)), "{largest:?}");
}

/// Forms for motion do not hold the internal forces of a bent rest: the load of the rest would bend the body once more.
#[test]
fn a_bent_rest_is_handed_over_as_matrices_alone() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = crate::program::root().join("crates/verification/meshes/l.msh");
    let scene = folder.path().join("bracket.toml");
    let text = format!(
        "title = \"Bracket\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\nmesh = {mesh:?}\n\
         material = {{ young_modulus = 7e10, poisson_ratio = 0.3, density = 2700.0 }}\n[modes]\nflexible = 4\nabout = \"loads\"\n\
         [effects]\nlarge_deflection = false\n[[constraints]]\nkind = \"clamp\"\ngroup = \"end\"\n[[loads]]\nkind = \"force\"\n\
         at = [1.0, 0.05, 0.05]\ndirection = [0.0, 1.0, 0.0]\namplitude = 6e4\n[time]\nend = 1e-3\ntolerance = 1e-4\n\
         [output]\npoints = {{ tip = [1.0, 0.05, 0.05] }}\n"
    );
    std::fs::write(&scene, text).unwrap();
    for (ending, code) in [("fem", 3), ("flex42", 3), ("sid_fem", 3), ("op4", 0)] {
        let file = folder.path().join(format!("bracket.{ending}"));
        let done = crate::program::flexframe(&["reduce", scene.to_str().unwrap(), "-o", file.to_str().unwrap()]);
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(code), "{ending}: {said}");
        assert!(code == 0 || said.contains("`modes.about`: found modes about a bent rest"), "{said}");
    }
}
