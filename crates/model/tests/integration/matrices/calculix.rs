//! Matrices of CalculiX with `*FREQUENCY, SOLVER=MATRIXSTORAGE`, against its own frequencies. Needs `ccx` (`./dev test` sees
//! to it).

use std::collections::HashMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use fem_tet10::read_msh;
use model::Model;
use scene::Body;

use super::Files;
use crate::{build, observations};

/// The plate of the paper without its point masses: 1000 × 50 × 10 mm of aluminium.
const SIZE: [f64; 3] = [1000.0, 50.0, 10.0];
const MATERIAL: &str = "*MATERIAL, NAME=M\n*ELASTIC\n70000., 0.33\n*DENSITY\n2.7E-9\n";
const SOLID: &str = "*SOLID SECTION, ELSET=EALL, MATERIAL=M\n";

/// Flexible modes that are compared.
const MODES: usize = 8;
const BODY: &str =
    "matrices = { mass = \"job.mas\", stiffness = \"job.sti\", nodes = \"job.inp\", dofs = \"job.dof\" }";

/// Nodes and elements of an input file.
#[derive(Default)]
struct Model3 {
    nodes: Vec<[f64; 3]>,
    elements: Vec<Vec<usize>>,
}

impl Model3 {
    /// `kind` is the type of the elements, `section` what they are made of.
    fn text(&self, kind: &str, section: &str) -> String {
        let mut text = "*NODE, NSET=ALL\n".to_owned();
        for (i, [x, y, z]) in self.nodes.iter().enumerate() {
            // CalculiX reads 20 characters of a number, and 6.123233995736766e-15 as 0.6123233995736766.
            writeln!(text, "{}, {x:.12}, {y:.12}, {z:.12}", i + 1).unwrap();
        }
        writeln!(text, "*ELEMENT, TYPE={kind}, ELSET=EALL").unwrap();
        for (e, nodes) in self.elements.iter().enumerate() {
            let labels: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
            let lines: Vec<String> = labels.chunks(10).map(|line| line.join(", ")).collect();
            writeln!(text, "{}, {}", e + 1, lines.join(",\n")).unwrap();
        }
        text + MATERIAL + section
    }
}

/// A block of C3D20 with numbers of elements along each axis, or a plate of S8 without the last axis.
fn grid(count: [usize; 3], is_shell: bool, place: impl Fn([f64; 3]) -> [f64; 3]) -> Model3 {
    let mut model = Model3::default();
    let mut known: HashMap<[usize; 3], usize> = HashMap::new();
    let [nx, ny, nz] = count;
    for [a, b, c] in (0..nx).flat_map(|a| (0..ny).flat_map(move |b| (0..nz).map(move |c| [a, b, c]))) {
        let mut node = |p: usize, q: usize, r: usize| {
            let at = [2 * a + p, 2 * b + q, 2 * c + r];
            *known.entry(at).or_insert_with(|| {
                let part = |i: usize| at[i] as f64 / (2 * count[i]) as f64;
                model.nodes.push(place([part(0), part(1), part(2)]));
                model.nodes.len() - 1
            })
        };
        let around: [[usize; 2]; 4] = [[0, 0], [2, 0], [2, 2], [0, 2]];
        let between: [[usize; 2]; 4] = [[1, 0], [2, 1], [1, 2], [0, 1]];
        let mut nodes = Vec::new();
        if is_shell {
            nodes.extend(around.iter().chain(&between).map(|[p, q]| node(*p, *q, 0)));
        } else {
            for (corners, r) in [(around, 0), (around, 2), (between, 0), (between, 2), (around, 1)] {
                nodes.extend(corners.iter().map(|[p, q]| node(*p, *q, r)));
            }
        }
        model.elements.push(nodes);
    }
    model
}

fn plate([x, y, z]: [f64; 3]) -> [f64; 3] {
    [SIZE[0] * (x - 0.5), SIZE[1] * (y - 0.5), SIZE[2] * z]
}

fn ccx(folder: &Path, job: &str) {
    let run = Command::new("ccx").arg(job).current_dir(folder).output();
    let run = run.unwrap_or_else(|error| panic!("ccx: {error}; install calculix-ccx, as ./dev test does"));
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stdout));
}

/// The matrices of a model, and CalculiX's own frequencies of its flexible modes.
fn calculix(model: &str) -> (Files, Vec<f64>) {
    let files = Files::new();
    let step = |parameter: &str| format!("{model}*STEP\n*FREQUENCY{parameter}\n{}\n*END STEP\n", 6 + MODES);
    files.write("job.inp", &step(", SOLVER=MATRIXSTORAGE"));
    files.write("own.inp", &step(""));
    ccx(files.path(), "job");
    ccx(files.path(), "own");
    // "      7   0.1083371E+06   0.3291460E+03   0.5238521E+02   0.0000000E+00": the third number is in cycles.
    let text = files.text("own.dat");
    let table = text.split("P A R T I C I P A T I O N").next().unwrap();
    let numbers = |line: &str| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
    let rows = table.lines().filter_map(numbers).filter(|row| row.len() == 5);
    (files, rows.skip(6).map(|row| row[3]).collect())
}

/// CalculiX prints seven digits.
fn assert_same_frequencies(files: &Files, expected: &[f64]) -> Model {
    let scene = files.scene(BODY, &format!("flexible = {MODES}"), "", "end = 1.0\nstep = 1e-3");
    let model = build(&scene);
    assert_eq!(expected.len(), MODES);
    for (expected, found) in expected.iter().zip(model.natural_frequencies()) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} against CalculiX' {expected}");
    }
    model
}

/// Independent reference: CalculiX' own frequencies.
#[test]
fn hexahedra_have_calculix_own_frequencies() {
    let (files, expected) = calculix(&grid([20, 2, 1], false, plate).text("C3D20", SOLID));
    let model = assert_same_frequencies(&files, &expected);
    let checks = model.meshed.as_ref().and_then(|meshed| meshed.checks).unwrap();
    assert!(checks.is_scalar_mass && checks.asymmetry.is_none() && checks.rigid_stiffness < 1e-10, "{checks:?}");
    let mass = SIZE.iter().product::<f64>() * 2.7e-9;
    assert!((model.body.mass / mass - 1.0).abs() < 1e-9, "{}", model.body.mass);
}

/// `[body]` of a mesh of the plate.
fn of_mesh(path: &Path) -> String {
    format!("mesh = {path:?}\nmaterial = {{ young_modulus = 70000.0, poisson_ratio = 0.33, density = 2.7e-9 }}")
}

fn meshes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes")
}

/// The plate in coarse tetrahedra, as an input file of CalculiX and as a scene of its mesh.
fn tetrahedra(folder: &Path) -> (Model3, String) {
    let path = folder.join("plate.msh");
    let run = Command::new("gmsh")
        .args(["-3", "-order", "2", "-clscale", "2.5", "-format", "msh41", "-o"])
        .args([&path, &meshes().join("plate.geo")])
        .output()
        .unwrap_or_else(|error| panic!("gmsh: {error}; install gmsh, as ./dev test does"));
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stdout));
    let mesh = read_msh(&path).unwrap();
    // The last two mid-edge nodes are the other way round there.
    let element = |&[a, b, c, d, ab, bc, ac, ad, cd, bd]: &[u32; 10]| {
        [a, b, c, d, ab, bc, ac, ad, bd, cd].map(|node| node as usize).to_vec()
    };
    let model = Model3 { nodes: mesh.positions().to_vec(), elements: mesh.elements().iter().map(element).collect() };
    (model, of_mesh(&path))
}

/// Independent reference: CalculiX' own frequencies.
#[test]
fn tetrahedra_have_calculix_own_frequencies_and_ours() {
    let folder = tempfile::tempdir().unwrap();
    let (model, body) = tetrahedra(folder.path());
    let (files, expected) = calculix(&model.text("C3D10", SOLID));
    let model = assert_same_frequencies(&files, &expected);
    let ours = build(&files.scene(&body, &format!("flexible = {MODES}"), "", "end = 1.0\nstep = 1e-3"));
    for (a, b) in model.natural_frequencies().iter().zip(ours.natural_frequencies()) {
        // Up to 7e-6, growing with the mode; whose quadrature that is has not been looked into.
        assert!((a / b - 1.0).abs() < 1e-5, "{a} against {b} of our elements");
    }
}

/// Independent reference: CalculiX' own frequencies. It computes shells with solid elements, and does not say where
/// their nodes are.
#[test]
fn shells_have_calculix_own_frequencies() {
    let shell = "*SHELL SECTION, ELSET=EALL, MATERIAL=M\n10.\n";
    let flat = |[x, y, _]: [f64; 3]| plate([x, y, 0.0]);
    let (files, expected) = calculix(&grid([20, 2, 1], true, flat).text("S8", shell));
    let model = assert_same_frequencies(&files, &expected);
    let mesh = &model.meshed.as_ref().unwrap().mesh;
    let found = mesh.positions();
    // Corners have three nodes across the thickness, mid-edges two.
    let mut heights = [0; 3];
    for [x, y, z] in found {
        let level = (z / 5.0).round();
        heights[(level + 1.0) as usize] += 1;
        // 14 digits of K are that much of the bending of a slender plate.
        assert!((z - 5.0 * level).abs() < 1e-5, "{z}");
        let steps = [(x + 500.0) / 25.0, (y + 25.0) / 12.5];
        assert!(steps.iter().all(|step| (step - step.round()).abs() < 1e-6), "{x}, {y}");
    }
    assert_eq!(heights, [165, 63, 165]);
    assert!(model.meshed.as_ref().unwrap().mesh_notes[0].contains("165 nodes of shells"));
}

/// Independent reference: CalculiX' own frequencies of a quarter of a tube: its nodes lie half the thickness inside
/// and outside of the shell.
#[test]
fn curved_shells_find_their_nodes() {
    let shell = "*SHELL SECTION, ELSET=EALL, MATERIAL=M\n4.\n";
    let radius = 100.0;
    let on_tube = |[x, y, _]: [f64; 3]| {
        let (sine, cosine) = (x * std::f64::consts::FRAC_PI_2).sin_cos();
        [radius * cosine, radius * sine, 150.0 * y]
    };
    let (files, expected) = calculix(&grid([6, 5, 1], true, on_tube).text("S8", shell));
    let model = assert_same_frequencies(&files, &expected);
    for [x, y, _] in model.meshed.as_ref().unwrap().mesh.positions() {
        let off = (x.hypot(*y) - radius) / 2.0;
        // The normals of the elements are off the radius by what a parabola is off the circle.
        assert!((off - off.round()).abs() < 2e-3 && off.abs() < 1.5, "{x}, {y}: {off}");
    }
}

/// A scene in which the plate tumbles while it vibrates.
fn tumbling(files: &Files, body: &str) -> Body {
    files.scene(
        body,
        "flexible = 8",
        "[effects]\ngeometric_stiffening = false\nlarge_deflection = false\n[initial]\nangular_velocity = [3.0, 8.0, 5.0]\n\
         [[loads]]\nkind = \"force\"\nat = [-500.0, 0.0, 10.0]\ndirection = [1, 0, 1]\namplitude = 50.0\n\
         history = { kind = \"half-sine\", start = 0.0, duration = 0.02 }\n",
        "end = 0.1\ntolerance = 1e-7\n[output]\ninterval = 1e-3\npoints = { end = [500.0, 0.0, 0.0] }",
    )
}

/// Independent reference: the matrices of CalculiX' hexahedra. Only the discretization differs: the frequencies of
/// the two meshes agree to 4e-3 (the first to 1e-4), the elastic displacement of an end in 0.1 s to 3e-3 of its
/// largest, and the attitude after a turn of a radian to 1e-6 rad.
#[test]
fn the_hexahedral_plate_tumbles_as_the_tetrahedral_one() {
    let (files, _) = calculix(&grid([40, 4, 1], false, plate).text("C3D20", SOLID));
    let of_mesh = of_mesh(&meshes().join("plate_lc12.msh"));
    let run = |body: &str| {
        let given = tumbling(&files, body);
        let model = build(&given);
        let rows = observations(&given, &model);
        (model, rows)
    };
    let (hexahedra, of_hexahedra) = run(BODY);
    let (tetrahedra, of_tetrahedra) = run(&of_mesh);
    let pairs = hexahedra.natural_frequencies().into_iter().zip(tetrahedra.natural_frequencies()).take(MODES);
    let frequencies = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    let (mut attitude, mut elastic, mut largest, mut turned) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (a, b) in of_hexahedra.iter().zip(&of_tetrahedra) {
        attitude = attitude.max(a.attitude.angle_to(&b.attitude));
        turned = turned.max(b.attitude.angle_to(&of_tetrahedra[0].attitude));
        let (u, v) = (a.points[0].elastic_displacement_body, b.points[0].elastic_displacement_body);
        elastic = elastic.max((u - v).norm());
        largest = largest.max(v.norm());
    }
    let figures = format!(
        "frequencies {frequencies:.1e}, attitude {attitude:.1e} of {turned:.2} rad, elastic displacement {:.1e} of {largest:.2}",
        elastic / largest
    );
    println!("{figures}");
    assert!(frequencies < 4e-3 && attitude < 1e-6 && elastic < 3e-3 * largest, "{figures}");
    assert!(turned > 0.5 && largest > 1.0, "{figures}");
}

#[test]
fn held_degrees_of_freedom_are_refused_with_the_help() {
    let plate = grid([4, 1, 1], false, plate);
    for (held, says) in
        [("1, 1, 2", "node 1 with the degree(s) of freedom 3 only"), ("1, 1, 3\n2, 1, 3", "a body that is not free")]
    {
        let text = plate.text("C3D20", SOLID) + "*BOUNDARY\n" + held + "\n";
        let files = Files::new();
        files.write("job.inp", &format!("{text}*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n9\n*END STEP\n"));
        ccx(files.path(), "job");
        let scene = files.scene(BODY, "flexible = 2", "", "end = 1.0\nstep = 1e-3");
        let message = crate::refusal(&scene).to_string();
        assert!(message.contains(says) && message.contains("without *BOUNDARY"), "{message}");
    }
}
