//! `flexframe linearize` and `flexframe campbell` of rotors of solid elements, against beams and CalculiX. Needs gmsh.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use nalgebra::Matrix4;

use crate::program::{json, numbers, root};

const YOUNG: f64 = 2e11;
const DENSITY: f64 = 7800.0;
const RADIUS: f64 = 0.025;
const LENGTH: f64 = 0.9;
const SPIN: f64 = 10_000.0;

/// The shaft of code_aster's case V2.02.141, of steel without Poisson's effect, on simple supports: 30 layers of wedges in tetrahedra.
fn shaft(folder: &Path) -> String {
    let geometry = format!(
        "r = {RADIUS:?};\nPoint(1) = {{0, 0, 0}}; Point(2) = {{0, r, 0}}; Point(3) = {{0, 0, r}}; Point(4) = {{0, -r, 0}}; Point(5) = {{0, 0, -r}};\n\
         Circle(1) = {{2, 1, 3}}; Circle(2) = {{3, 1, 4}}; Circle(3) = {{4, 1, 5}}; Circle(4) = {{5, 1, 2}};\n\
         Transfinite Curve{{1:4}} = 4;\nCurve Loop(1) = {{1, 2, 3, 4}}; Plane Surface(1) = {{1}};\nMesh.MeshSizeMax = 0.012;\n\
         out[] = Extrude {{{LENGTH:?}, 0, 0}} {{ Surface{{1}}; Layers{{30}}; }};\nPhysical Volume(\"shaft\") = {{out[1]}};\n\
         Physical Surface(\"left\") = {{1}};\nPhysical Surface(\"right\") = {{out[0]}};\nMesh.ElementOrder = 2;\n"
    );
    std::fs::write(folder.join("shaft.geo"), geometry).unwrap();
    let joint = |name: &str| {
        format!("[[joints]]\nname = {name:?}\nkind = \"spherical\"\nbetween = [\"ground\", \"shaft.{name}\"]\n")
    };
    let text = format!(
        "title = \"Shaft\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[bodies.shaft]\nmesh = \"shaft.geo\"\n\
         material = {{ young_modulus = {YOUNG:e}, poisson_ratio = 0.0, density = {DENSITY:?} }}\nmodes = {{ flexible = 10 }}\n\
         loads = [{{ kind = \"force\", at = [0.45, 0, 0], direction = [0, 1, 0], amplitude = 1.0 }}]\n\
         points = {{ middle = [0.45, 0, 0] }}\nmarkers = {{ left = {{ group = \"left\" }}, right = {{ group = \"right\" }} }}\n{}{}\
         [time]\nend = 0.1\ntolerance = 1e-6\n",
        joint("left"),
        joint("right")
    );
    let scene = folder.join("shaft.toml");
    std::fs::write(&scene, text).unwrap();
    scene.to_str().unwrap().to_owned()
}

/// Frequencies of the poles of a scene in a spin, rad per time.
fn poles(folder: &Path, scene: &str, spin: f64) -> Vec<f64> {
    let file = folder.join("linear.json");
    let about = format!("{spin},0,0");
    let report = json(&["linearize", scene, "--spin", &about, "-o", file.to_str().unwrap(), "--overwrite"]);
    let all = report["poles"].as_array().unwrap();
    all.iter().map(|pole| TAU * pole["frequency"].as_f64().unwrap()).collect()
}

fn nearest(all: &[f64], to: f64) -> f64 {
    all.iter().copied().min_by(|a, b| (a - to).abs().total_cmp(&(b - to).abs())).unwrap()
}

/// Backward and forward whirl, from the ground, of mode n of a Timoshenko shaft on simple supports with gyroscopic moments:
/// κGA(k²w − kφ) = ρAω²w, (EIk² + κGA)φ − κGA k w = ρI ω² φ ∓ 2ρIΩ ω φ with the shear factor of a circle, 6(1 + ν)/(7 + 6ν).
fn timoshenko(n: f64, spin: f64) -> [f64; 2] {
    let k = n * PI / LENGTH;
    let radius = RADIUS * RADIUS / 4.0; // I/A
    let shear = 6.0 / 7.0 * YOUNG / 2.0 / DENSITY;
    let bending = YOUNG / DENSITY * radius;
    // y' = A y of (w, φ, w', φ') with w and φ turning together: i of the gyroscopic moment makes the rates real.
    let stiff = [[shear * k * k, -shear * k], [-shear * k / radius, (bending * k * k + shear) / radius]];
    let a = Matrix4::new(
        0.0,
        0.0,
        1.0,
        0.0,
        0.0,
        0.0,
        0.0,
        1.0,
        stiff[0][0],
        stiff[0][1],
        0.0,
        0.0,
        stiff[1][0],
        stiff[1][1],
        0.0,
        2.0 * spin,
    );
    let mut rates: Vec<f64> = a.complex_eigenvalues().iter().map(|rate| rate.re).collect();
    rates.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let [a, b] = [rates[0].abs(), rates[1].abs()];
    [a.min(b), a.max(b)]
}

/// Closed form: a Timoshenko shaft; and √(λ² + 1) ∓ λ of a thin one, λ = Ω I_x/(2√(EIρS)), code_aster V2.02.141: 119.7548 and 125.8150 Hz
/// where it is at 122.7475 Hz at rest. The solid has shear and rotary inertia, which take 0.3 % of the first frequency.
#[test]
fn a_spinning_shaft_whirls_as_a_beam_does() {
    let folder = tempfile::tempdir().unwrap();
    let scene = shaft(folder.path());
    let (at_rest, spinning) = (poles(folder.path(), &scene, 0.0), poles(folder.path(), &scene, SPIN));
    let lambda = SPIN * RADIUS * (DENSITY / YOUNG).sqrt() / 2.0;
    for (n, of_beam, of_thin) in [(1.0, 1e-3, 1e-3), (2.0, 1e-3, 1.5e-3), (3.0, 1e-3, 4e-3)] {
        let thin = (n * PI / LENGTH).powi(2) * RADIUS / 2.0 * (YOUNG / DENSITY).sqrt();
        let rest = nearest(&at_rest, timoshenko(n, 0.0)[0]);
        let [backward, forward] = timoshenko(n, SPIN);
        // The shaft sees the frequencies by its speed apart.
        let found = [nearest(&spinning, backward + SPIN) - SPIN, SPIN - nearest(&spinning, SPIN - forward)];
        println!("{n}: {rest} {found:?} {backward} {forward}");
        assert!((rest / timoshenko(n, 0.0)[0] - 1.0).abs() < of_beam, "{rest}");
        for ((found, beam), sign) in found.into_iter().zip([backward, forward]).zip([-1.0, 1.0]) {
            assert!((found / beam - 1.0).abs() < of_beam, "{n}: {found} {beam}");
            let ratio = (lambda * lambda + 1.0).sqrt() + sign * lambda;
            assert!((found / rest / ratio - 1.0).abs() < of_thin, "{n}: {} {ratio}", found / rest);
        }
        if n == 1.0 {
            assert!((thin / TAU - 122.7475).abs() < 1e-4);
            assert!((rest / thin - 1.0).abs() < 3.5e-3);
        }
    }
}

/// Independent reference: CalculiX 2.20 with the same mesh (`./dev calculix-disc`): frequencies at rest, and at 2000 rad/s about the nonlinear
/// rest in the spin, with centrifugal and Coriolis forces, as the disc sees them.
const AT_REST: [f64; 8] = [334.344, 334.344, 385.132, 385.132, 773.863, 801.932, 801.932, 848.011];
const SPINNING: [f64; 8] = [401.941, 464.573, 694.070, 727.148, 733.929, 818.430, 1185.057, 1209.573];

/// Independent reference: CalculiX.
#[test]
fn a_dished_disc_in_a_spin_has_the_frequencies_of_calculix() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "title = \"Dished disc\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\nmesh = {:?}\n\
         material = {{ young_modulus = 2.1e11, poisson_ratio = 0.3, density = 7800.0 }}\n[modes]\nflexible = 12\n\
         [[constraints]]\nkind = \"clamp\"\ngroup = \"hub\"\n[time]\nend = 0.1\nstep = 1e-5\n",
        root().join("crates/verification/meshes/dished_disc.msh")
    );
    let scene = folder.path().join("disc.toml");
    std::fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let arguments =
        ["campbell", scene.to_str().unwrap(), "--axis", "z", "--speeds", "0:2000:2", "--about-rest", "always"];
    let report = json(&[&arguments[..], &["-o", out.to_str().unwrap()]].concat());
    for (speed, expected, within) in [(0, AT_REST, 2e-4), (1, SPINNING, 1e-4)] {
        let branches = report["branches"].as_array().unwrap();
        let mut found: Vec<f64> = branches.iter().map(|branch| numbers(&branch["frequency"])[speed]).collect();
        found.sort_by(f64::total_cmp);
        for (found, expected) in found.iter().zip(expected) {
            println!("{found} {expected} {:.1e}", found / expected - 1.0);
            assert!((found / expected - 1.0).abs() < within, "{found} {expected}");
        }
    }
}

/// Closed form: a frame on a soft pad carries a wheel that spins at its centre, J φ̈ − i h φ̇ + k φ = 0: √(a² + k/J) ± a, a = h/2J. Without the
/// spin both are √(k/J).
#[test]
fn a_wheel_that_spins_parts_the_frequencies_of_its_frame() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("wheel.toml");
    let write = |inertia: f64, speed: f64| {
        let text = format!(
            "title = \"Wheel\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n\
             [bodies.frame]\nrigid = {{ mass = 3.0, center_of_mass = [0, 0, 0], inertia = [[0.2, 0, 0], [0, 0.3, 0], [0, 0, 0.3]] }}\n\
             markers = {{ c = {{ at = [0, 0, 0] }} }}\n\
             [bodies.wheel]\nrigid = {{ mass = 2.0, center_of_mass = [0, 0, 0], inertia = [[0.4, 0, 0], [0, 0.25, 0], [0, 0, {inertia}]] }}\n\
             markers = {{ c = {{ at = [0, 0, 0] }} }}\ninitial = {{ angular_velocity = [{speed:?}, 0, 0] }}\n\
             [[joints]]\nname = \"bearing\"\nkind = \"revolute\"\nbetween = [\"frame.c\", \"wheel.c\"]\naxis = [1, 0, 0]\n\
             [[bushings]]\nname = \"pad\"\nbetween = [\"ground\", \"frame.c\"]\n\
             stiffness = {{ translation = [4e4, 3e4, 3e4], rotation = [900.0, 500.0, 500.0] }}\n[time]\nend = 1.0\ntolerance = 1e-5\n"
        );
        std::fs::write(&scene, text).unwrap();
        scene.to_str().unwrap().to_owned()
    };
    let (a, still) = (0.5 * 300.0 * 0.4 / 0.55, 500.0 / 0.55_f64);
    let root = (a * a + still).sqrt();
    let path = write(0.25, 300.0);
    let report = json(&["modes", &path]);
    let system = &report["systems"][0];
    let found: Vec<f64> =
        system["modes"].as_array().unwrap().iter().map(|mode| TAU * mode["frequency"].as_f64().unwrap()).collect();
    for expected in [root - a, root + a] {
        assert!((nearest(&found, expected) / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
    }
    assert_eq!(system["rotors"][0]["joint"].as_str(), Some("bearing"));
    assert!((system["rotors"][0]["speed"].as_f64().unwrap() - 300.0).abs() < 1e-9);
    assert!(system["warnings"].as_array().unwrap().is_empty(), "{}", system["warnings"]);
    let file = folder.path().join("linear.json");
    let report = json(&["linearize", &path, "-o", file.to_str().unwrap()]);
    let found: Vec<f64> =
        report["poles"].as_array().unwrap().iter().map(|pole| TAU * pole["frequency"].as_f64().unwrap()).collect();
    for expected in [root - a, root + a] {
        assert!((nearest(&found, expected) / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
    }
    assert!(
        report["about"].as_str().unwrap().contains("a rotor that spins at 300 rad/s in joint bearing"),
        "{}",
        report["about"]
    );

    // One that is not round has equations that change with its turn.
    let path = write(0.3, 300.0);
    let report = json(&["modes", &path]);
    let warning = report["systems"][0]["warnings"][0].as_str().unwrap();
    for words in ["joint bearing turns at 300 rad", "left out", "differs"] {
        assert!(warning.contains(words), "{words} in: {warning}");
    }
}
