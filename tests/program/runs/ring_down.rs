//! Poles of a run: what a small ring-down swings with, by the eigensystem realisation of its signals, against `linearize` and `campbell`.

use std::f64::consts::TAU;
use std::path::Path;

use faer::linalg::solvers::{Solve, Svd};
use faer::{Mat, c64};
use serde_json::Value;

use crate::program::{done, json, numbers, root};

/// The signals of a run after `from`, a row a time: their changes from row to row, which have no rest of the bent body in them, each
/// over its largest value.
fn signals(folder: &Path, scene: &str, columns: &[&str], from: f64) -> (f64, Mat<f64>) {
    let out = folder.join("out");
    json(&["run", scene, "--no-check", "--overwrite", "-o", out.to_str().unwrap()]);
    let file = out.join(Path::new(scene).with_extension("h5").file_name().unwrap());
    let csv = folder.join("run.csv");
    done(&["export", file.to_str().unwrap(), "--csv", csv.to_str().unwrap(), "--overwrite"]);
    let text = std::fs::read_to_string(csv).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let place = |column: &&str| header.iter().position(|name| name.starts_with(*column)).unwrap();
    let places: Vec<usize> = columns.iter().map(place).collect();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    let interval = rows[1][0] - rows[0][0];
    let change = |pair: &[Vec<f64>]| places.iter().map(|place| pair[1][*place] - pair[0][*place]).collect::<Vec<f64>>();
    let changes: Vec<Vec<f64>> = rows.windows(2).filter(|pair| pair[0][0] > from).map(change).collect();
    let largest = |j: usize| changes.iter().map(|row| row[j].abs()).fold(0.0, f64::max);
    let scales: Vec<f64> = (0..places.len()).map(largest).collect();
    (interval, Mat::from_fn(changes.len(), places.len(), |i, j| changes[i][j] / scales[j]))
}

/// Poles of signals that are sums of `order` exponentials, slowest first, without those on the real axis: the observability of the
/// left singular vectors of their block Hankel matrix, shifted by a row (Juang and Pappa 1985).
fn poles(interval: f64, signals: &Mat<f64>, order: usize) -> Vec<c64> {
    let (times, count) = (signals.nrows(), signals.ncols());
    let blocks = (times / 4).min(100);
    let hankel = Mat::from_fn(blocks * count, times - blocks + 1, |i, j| signals[(j + i / count, i % count)]);
    let left = Svd::new_thin(hankel.as_ref()).unwrap().U().subcols(0, order).to_owned();
    let kept = left.nrows() - count;
    let (before, after) = (left.subrows(0, kept), left.subrows(count, kept));
    let step = (before.transpose() * before).partial_piv_lu().solve(before.transpose() * after);
    let mut poles: Vec<c64> = step.eigenvalues().unwrap().into_iter().map(|z: c64| z.ln() / interval).collect();
    poles.retain(|pole| pole.im > 0.0);
    poles.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    poles
}

/// Poles of `linearize`, slowest first.
fn linear_poles(folder: &Path, scene: &str, more: &[&str]) -> (Value, Vec<c64>) {
    let file = folder.join("linear.json");
    let report = json(&[&["linearize", scene, "--overwrite", "-o", file.to_str().unwrap()], more].concat());
    let number = |pole: &Value, key: &str| pole[key].as_f64().unwrap();
    let of = |pole: &Value| c64::new(number(pole, "growth"), TAU * number(pole, "frequency"));
    let poles = report["poles"].as_array().unwrap().iter().map(of).collect();
    (report, poles)
}

/// The nearest pole of `all` is within `within` of the magnitude.
#[track_caller]
fn assert_among(found: &[c64], all: &[c64], within: f64) {
    for pole in found {
        let off = all.iter().map(|other| (other - pole).norm()).fold(f64::INFINITY, f64::min) / pole.norm();
        println!("{:.9} {:.9} off by {off:.1e}", pole.im / TAU, pole.re);
        assert!(off < within, "{pole}: {off:e} of {all:?}");
    }
}

fn written(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Independent reference: the run. A bar on a driven hinge, whose spin couples its modes.
#[test]
fn a_body_in_a_spin_rings_down_with_the_poles_of_its_linear_model() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = {:?}\n\
         material = {{ young_modulus = 70000.0, poisson_ratio = 0.3, density = 2.7e-9 }}\n[modes]\nflexible = 4\ndamping_ratio = 0.01\n\
         static_correction = false\n[[constraints]]\nkind = \"hinge\"\nat = [0, 0, 0]\naxis = [0, 0, 1]\ngroup = \"root\"\n\
         motion = {{ amplitude = 300.0, history = \"constant\" }}\n[[loads]]\nkind = \"force\"\nat = [202.07, 0.0, 0.0]\nframe = \"body\"\n\
         direction = [0, 1, 0.5]\namplitude = 1e-3\nhistory = {{ kind = \"half-sine\", duration = 4e-4 }}\n[time]\nend = 0.1\n\
         step = 1e-6\n[effects]\nlarge_deflection = false\n[output]\ninterval = 1e-4\npoints = {{ tip = [202.07, 0.0, 0.0] }}\n",
        root().join("meshes/rotating_bar.msh")
    );
    let scene = written(folder.path(), "bar.toml", &text);
    let columns = ["points/tip/elastic_displacement_body y", "points/tip/elastic_displacement_body z"];
    let (interval, motion) = signals(folder.path(), &scene, &columns, 1e-3);
    let found = poles(interval, &motion, 8);
    let (_, expected) = linear_poles(folder.path(), &scene, &[]);
    assert_eq!(found.len(), 4);
    assert_among(&found, &expected, 1e-6);
}

/// Independent reference: the run, of two flexible bars on hinges with springs and dampers.
#[test]
fn bodies_in_joints_ring_down_with_the_poles_of_their_linear_model() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = root().join("meshes/half_bar.msh");
    let bar = |name: &str, more: &str| {
        format!(
            "[bodies.{name}]\nmesh = {mesh:?}\nmaterial = {{ young_modulus = 70000.0, poisson_ratio = 0.33, density = 2.7e-9 }}\n\
             modes = {{ flexible = 2, damping_ratio = 0.02, static_correction = false }}\n{more}\n"
        )
    };
    let upper = bar("upper", "markers = { root = { group = \"left\" }, tip = { group = \"right\" } }");
    // The push turns the joints by 1e-5 rad: what is not linear is 1e-10 of it.
    let lower = bar(
        "lower",
        "markers = { root = { group = \"left\" } }\ninitial = { position = [200, 0, 0] }\npoints = { end = [200, 0, 0] }\n\
         loads = [{ kind = \"force\", at = [200, 0, 0], direction = [0, 1, 1], amplitude = 0.03, \
         history = { kind = \"half-sine\", duration = 1e-3 } }]",
    );
    let joint = |name: &str, between: &str, damping: f64| {
        format!(
            "[[joints]]\nname = {name:?}\nkind = \"revolute\"\nbetween = [{between}]\naxis = [0, 1, 0]\n\
             spring = {{ stiffness = 2e4, damping = {damping:?}, free = 0.0 }}\n"
        )
    };
    let text = format!(
        "title = \"Ring-down\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n{upper}{lower}{}{}[time]\nend = 0.35\n\
         tolerance = 1e-11\n[output]\ninterval = 5e-4\n",
        joint("hook", "\"ground\", \"upper.root\"", 5.0),
        joint("knee", "\"upper.tip\", \"lower.root\"", 2.0)
    );
    let scene = written(folder.path(), "pair.toml", &text);
    let columns = [
        "bodies/lower/points/end/displacement y",
        "bodies/lower/points/end/elastic_displacement_body y",
        "bodies/lower/points/end/elastic_displacement_body z",
        "joints/hook/angle",
        "joints/knee/angle",
    ];
    // Later, what the fastest vibrations leave is below the errors of the steps.
    let (interval, motion) = signals(folder.path(), &scene, &columns, 0.1);
    let found = poles(interval, &motion, 12);
    let (_, expected) = linear_poles(folder.path(), &scene, &[]);
    assert_eq!(found.len(), 6);
    // The two fastest have decayed by 1e-3 and 1e-2 before the first row that counts.
    assert_among(&found[..4], &expected, 1e-7);
    assert_among(&found, &expected, 1e-6);
}

/// Independent reference: `campbell`, and the run. A bar on a hub that a drive turns: linear model, diagram and ring-down are of one spin.
#[test]
fn a_spinning_system_rings_down_with_the_poles_of_its_campbell_diagram() {
    let folder = tempfile::tempdir().unwrap();
    let spin = 600.0;
    let text = format!(
        "title = \"Bar on a hub\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[bodies.hub]\n\
         rigid = {{ mass = 1e-3, center_of_mass = [0, 0, 0], inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]] }}\n\
         markers = {{ shaft = {{ at = [0, 0, 0] }}, root = {{ at = [0, 0, 0] }} }}\ninitial = {{ angular_velocity = [0, 0, {spin}] }}\n\
         [bodies.bar]\nmesh = {:?}\nmaterial = {{ young_modulus = 70000.0, poisson_ratio = 0.0, density = 2.7e-9 }}\n\
         modes = {{ flexible = 4, damping_ratio = 0.02, static_correction = false }}\nmarkers = {{ root = {{ group = \"root\" }} }}\n\
         initial = {{ angular_velocity = [0, 0, {spin}], velocity = [0, {}, 0] }}\npoints = {{ tip = [202.07, 0, 0] }}\n\
         loads = [{{ kind = \"force\", at = [202.07, 0, 0], frame = \"body\", direction = [0, 1, 1], amplitude = 1.0, \
         history = {{ kind = \"half-sine\", duration = 1e-3 }} }}]\n[[joints]]\nname = \"shaft\"\nkind = \"revolute\"\n\
         between = [\"ground\", \"hub.shaft\"]\naxis = [0, 0, 1]\n\
         drive = {{ amplitude = {spin}, history = {{ kind = \"expression\", formula = \"t\" }} }}\n[[joints]]\nname = \"weld\"\n\
         kind = \"fixed\"\nbetween = [\"hub.root\", \"bar.root\"]\n[time]\nend = 0.15\ntolerance = 1e-11\n[output]\ninterval = 2e-4\n",
        root().join("meshes/rotating_bar.msh"),
        spin * 0.5 * 202.07,
    );
    let scene = written(folder.path(), "hub.toml", &text);
    let (report, expected) = linear_poles(folder.path(), &scene, &[]);
    assert_eq!(numbers(&report["omega_global"]), [0.0, 0.0, spin]);
    let out = folder.path().join("campbell");
    let speeds = format!("0:{spin}:2");
    let arguments = ["campbell", &scene, "--speeds", &speeds, "-o", out.to_str().unwrap()];
    let diagram = json(&arguments);
    let of_branch = |branch: &Value| {
        let at = |key: &str| branch[key][1].as_f64().unwrap();
        c64::new(at("growth"), TAU * at("frequency"))
    };
    let branches: Vec<c64> = diagram["branches"].as_array().unwrap().iter().map(of_branch).collect();
    assert_eq!(branches.len(), expected.len());
    assert_among(&branches, &expected, 1e-9);

    let columns =
        ["bodies/bar/points/tip/elastic_displacement_body y", "bodies/bar/points/tip/elastic_displacement_body z"];
    // Later, the third pair is below the errors of the steps.
    let (interval, motion) = signals(folder.path(), &scene, &columns, 0.05);
    let found = poles(interval, &motion, 8);
    // At rest the two lowest are alike to 5e-5; the spin takes them apart by 10 %.
    assert!(found[1].im > 1.1 * found[0].im, "{found:?}");
    assert_among(&found[..2], &expected, 1e-7);
}
