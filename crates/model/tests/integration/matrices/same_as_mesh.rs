//! The matrices of a mesh, written and read, move as the mesh does.

use std::path::Path;

use dynamics::Effect;
use fem_tet10::{Material, Materials, Matrices, Mesh, assemble, read_msh};
use model::{Builder, Cache};

use super::files::{abaqus, matrix_market, table};
use super::{Files, MARKET};
use crate::{DENSITY, POISSON, YOUNG, build, observations};

pub fn bar() -> (Mesh, Matrices) {
    let mesh = read_msh(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/bar.msh")).unwrap();
    let material = Material { young_modulus: YOUNG, poisson_ratio: POISSON, density: DENSITY };
    let matrices = assemble(&mesh, &Materials::Uniform(material), &[]).unwrap();
    (mesh, matrices)
}

/// The bar in Matrix Market files: K by one triangle, M by both.
pub fn bar_files() -> Files {
    let (files, (mesh, matrices)) = (Files::new(), bar());
    files.write("K.mtx", &matrix_market(matrices.stiffness(), true));
    files.write("M.mtx", &matrix_market(matrices.mass(), false));
    files.write("nodes.csv", &table(&mesh));
    files
}

fn of_mesh() -> String {
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/bar.msh");
    format!(
        "mesh = {mesh:?}\nmaterial = {{ young_modulus = {YOUNG:e}, poisson_ratio = {POISSON}, density = {DENSITY:e} }}"
    )
}

const TIME: &str = "end = 4e-3\ntolerance = 1e-8\n[output]\ninterval = 1e-3\npoints = { tip = [200.0, 0.0, 0.0] }";
const PLAIN: &str = "[effects]\ngeometric_stiffening = false\nlarge_deflection = false\n";

/// Modes and rows of a scene, with its body from the mesh and from other files.
fn compare(files: &Files, body: &str, rest: &str) {
    let modes = "flexible = 6\nstatic_correction = true\ndamping_ratio = 0.01";
    let rest = format!("{PLAIN}{rest}");
    let (expected, found) = (files.scene(&of_mesh(), modes, &rest, TIME), files.scene(body, modes, &rest, TIME));
    let (of_mesh, of_matrices) = (build(&expected), build(&found));
    assert_eq!(of_mesh.natural_frequencies().len(), of_matrices.natural_frequencies().len());
    // What a static shape adds to the modes may be a thousandth of its response, and has the rounding of the whole.
    for (k, (a, b)) in of_mesh.natural_frequencies().iter().zip(of_matrices.natural_frequencies()).enumerate() {
        assert!((b / a - 1.0).abs() < if k < 6 { 1e-9 } else { 1e-6 }, "{k}: {b} against {a}");
    }
    let (a, b) = (observations(&expected, &of_mesh), observations(&found, &of_matrices));
    let mut moved = 0.0_f64;
    for (a, b) in a.iter().zip(&b) {
        let (expected, found) = (a.points[0].displacement, b.points[0].displacement);
        moved = moved.max(expected.norm());
        assert!((expected - found).norm() < 1e-6 * moved.max(1e-3), "{expected:?} against {found:?} at {}", a.time);
    }
    assert!(moved > 1e-2, "{moved}");
    let checks = of_matrices.meshed.as_ref().and_then(|meshed| meshed.checks).unwrap();
    assert!(checks.is_scalar_mass && checks.dofs == 3 && checks.left_out == 0.0, "{checks:?}");
    assert!(checks.rigid_stiffness < 1e-12, "{checks:?}");
}

/// Conserved: the same motion from the mesh.
#[test]
fn free_with_a_force_and_a_moment() {
    let rest = "[initial]\nangular_velocity = [3.0, 8.0, 5.0]\n\
        [[loads]]\nkind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = [0, 1, 1]\namplitude = 5.0\nhistory = { kind = \"constant\" }\n\
        [[loads]]\nkind = \"moment\"\nat = [200.0, 0.0, 0.0]\nradius = 12.0\ndirection = [1, 0, 0]\namplitude = 50.0\n\
        history = { kind = \"constant\" }\n";
    compare(&bar_files(), MARKET, rest);
}

/// Conserved: the same motion from the mesh.
#[test]
fn clamped_by_a_group_under_gravity_and_base_motion() {
    let rest = "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n\
        [[loads]]\nkind = \"gravity\"\ndirection = [0, 0, -1]\namplitude = 9810.0\nhistory = { kind = \"constant\" }\n\
        [[loads]]\nkind = \"base-acceleration\"\ndirection = [0, 1, 0]\namplitude = 1e6\n\
        history = { kind = \"half-sine\", start = 0.0, duration = 1e-3 }\n";
    compare(&bar_files(), MARKET, rest);
}

/// Conserved: the same motion from the mesh.
#[test]
fn driven_about_a_hinge() {
    let rest = "[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0, 0, 1]\ngroup = \"root\"\n\
        motion = { amplitude = 50.0, history = { kind = \"ramp\", duration = 4e-3 } }\n";
    compare(&bar_files(), MARKET, rest);
}

/// Conserved: the same motion from the mesh.
#[test]
fn in_the_form_of_abaqus() {
    let (files, (mesh, matrices)) = (Files::new(), bar());
    let label = |node: usize| mesh.node_tags()[node];
    files.write("bar_STIF1.mtx", &abaqus(matrices.stiffness(), label));
    files.write("bar_MASS1.mtx", &abaqus(matrices.mass(), label));
    let nodes: String = mesh
        .node_tags()
        .iter()
        .zip(mesh.positions())
        .map(|(label, [x, y, z])| format!("{label}, {x:?}, {y:?}, {z:?}\n"))
        .collect();
    let root: Vec<String> =
        mesh.group_nodes("root").unwrap().iter().map(|node| label(*node as usize).to_string()).collect();
    files.write("bar.inp", &format!("*HEADING\nbar\n*NODE\n{nodes}*NSET, NSET=root\n{}\n", root.join(",\n")));
    let body = "matrices = { mass = \"bar_MASS1.mtx\", stiffness = \"bar_STIF1.mtx\", nodes = \"bar.inp\" }";
    compare(
        &files,
        body,
        "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n[[loads]]\nkind = \"force\"\nat = [200.0, 0.0, 0.0]\n\
        direction = [0, 1, 0]\namplitude = 5.0\nhistory = { kind = \"constant\" }\n",
    );
}

#[test]
fn what_is_asked_again_is_in_the_cache() {
    let files = bar_files();
    let folder = tempfile::tempdir().unwrap();
    let scene = files.scene(MARKET, "flexible = 4", "[initial]\nangular_velocity = [0, 0, 5]", TIME);
    let run = || {
        let builder = Builder::with_cache(Cache::new(folder.path(), u64::MAX));
        let model = builder.build(&scene, |_| ()).unwrap();
        (model.natural_frequencies(), builder.cache.notes())
    };
    let (first, notes) = run();
    assert!(notes.read == 0 && notes.computed > 1, "{notes:?}");
    let (again, notes) = run();
    assert!(notes.computed == 0 && again == first, "{notes:?}");
    // Another matrix is another body.
    files.write("M.mtx", &files.text("M.mtx").replacen("%\n", "% another\n", 1));
    let (_, notes) = run();
    assert!(notes.read == 0, "{notes:?}");
}

#[test]
fn what_needs_elements_is_off_and_told() {
    let files = bar_files();
    let rest = "[initial]\nangular_velocity = [0.0, 0.0, 200.0]\n";
    let model = build(&files.scene(MARKET, "flexible = 4", rest, TIME));
    let row = &model.advice.effects[Effect::GeometricStiffening];
    assert!(row.on && !model.physics.effects[Effect::GeometricStiffening], "{row:?}");
    assert!(row.why.contains("the elements of a body of matrices are not known"), "{}", row.why);
    assert!(model.large_modes().is_empty() && model.stress.is_none());
}
