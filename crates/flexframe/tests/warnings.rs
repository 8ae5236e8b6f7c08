//! A warning means something: a run that is right ends without one.

use flexframe::run::{RunReport, RunSettings, run};
use flexframe::scene::Scene;

const UNITS: &str = "title = \"x\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n";

fn report(text: &str) -> RunReport {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::parse(&format!("{UNITS}{text}"), folder.path().join("scene.toml")).unwrap();
    run(&scene, folder.path(), &RunSettings::default(), |_| ()).unwrap().1
}

/// A rigid body of 1 kg under a force of 50 Hz, with rows on whole periods, where it stands still.
#[test]
fn of_a_shaken_rigid_body() {
    let report = report(
        "[body.rigid]\nmass = 1.0\ncenter_of_mass = [0.0, 0.0, 0.0]\n\
         inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n\
         [[loads]]\nkind = \"force\"\nat = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\namplitude = 1.0\n\
         history = { kind = \"sine\", frequency = 50.0, phase = 1.5707963267948966 }\n\
         [time]\nend = 20.0\nstep = 1e-3\n[output]\ninterval = 0.1\n",
    );
    // Measured: 4.2e-6 of what came and went.
    assert!(report.balances.energy < 1e-4 && report.warnings.is_empty(), "{:?}", report.warnings);
}

/// The ring of the examples, soft, falls: gravity neither turns it nor bends it.
#[test]
fn of_a_body_that_falls() {
    let report = report(&format!(
        "[body]\nmesh = \"{}/../../meshes/ring.msh\"\n\
         material = {{ young_modulus = 1e3, poisson_ratio = 0.3, density = 7.8e-9 }}\n[modes]\nflexible = 6\n\
         [[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n\
         [time]\nend = 0.1\ntolerance = 1e-6\n[output]\ninterval = 0.01\n",
        env!("CARGO_MANIFEST_DIR")
    ));
    assert!(
        (report.moved[2] + 0.5 * 9810.0 * 0.01).abs() < 1e-6 && report.warnings.is_empty(),
        "{:?}",
        report.warnings
    );
}
