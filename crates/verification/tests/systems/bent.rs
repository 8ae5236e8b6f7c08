//! A body that bends far, in joints, against nonlinear finite elements of the same mesh.

use std::path::Path;

use dynamics::{Observation, Rows, Simulation, Start, StepControl, SystemScheme, SystemSetup};
use fem_tet10::{Material, Mesh};
use nalgebra::Vector3;
use verification::nonlinear::{NodalState, Solid, SolidMotion, cases};
use verification::stability::meshes::box_mesh;
use verification::systems::meshes::write;
use verification::systems::run::{built, rows};

pub const SIZE: [f64; 3] = [1.0, 0.03, 0.02];
pub const CELLS: [usize; 3] = [10, 1, 1];
/// Without Poisson's ratio: a clamp does not hinder it, nor does a mean leave it free.
pub const MATERIAL: Material = Material { young_modulus: 1e9, poisson_ratio: 0.0, density: 1000.0 };
pub const UNITS: &str = "title = 'bar'\nunits = { length = 'm', mass = 'kg', time = 's' }\n";

pub fn tip() -> Vector3<f64> {
    Vector3::new(SIZE[0], 0.5 * SIZE[1], 0.5 * SIZE[2])
}

pub fn at(solid: &Solid, place: &Vector3<f64>) -> usize {
    solid.mesh().positions().iter().position(|x| (Vector3::from(*x) - place).norm() < 1e-9).unwrap()
}

pub fn solid(young_modulus: f64, is_held: impl Fn(&Vector3<f64>) -> bool) -> Solid {
    let material = Material { young_modulus, ..MATERIAL };
    Solid::new(Mesh::new(box_mesh(SIZE, CELLS)).unwrap(), material, |x| is_held(&x)).unwrap()
}

/// The bar as a body of a system, named, with these modes and what else its table has.
pub fn body(name: &str, young_modulus: f64, modes: &str, rest: &str) -> String {
    let large = modes.contains("large");
    format!(
        "[bodies.{name}]\nmesh = 'bar.msh'\n\
         material = {{ young_modulus = {young_modulus:e}, poisson_ratio = 0.0, density = {:e} }}\n\
         modes = {{ {modes} }}\neffects = {{ large_deflection = {large} }}\n{rest}",
        MATERIAL.density
    )
}

fn run(directory: &Path, text: &str, tolerance: f64, end: f64, interval: f64, bodies: usize) -> Vec<Vec<Observation>> {
    let built = built(directory, &format!("{UNITS}{text}[time]\nend = {end}\ntolerance = {tolerance:e}\n")).unwrap();
    let mut simulation = built.start(StepControl::Tolerance(tolerance), end, interval, false).unwrap();
    rows(&mut simulation, bodies).unwrap()
}

pub fn with_bar() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    write(directory.path(), "bar", &box_mesh(SIZE, CELLS), &[]).unwrap();
    directory
}

/// Independent reference: the nonlinear finite elements of this crate at rest, with the nodes of one end held. The same body alone, by a
/// clamp, has what it has by a fixed joint.
#[test]
fn a_cantilever_on_a_fixed_joint_bends_as_one_that_is_clamped() {
    let directory = with_bar();
    let clamped = solid(MATERIAL.young_modulus, |x| x.x < 1e-9);
    let node = at(&clamped, &tip());
    let bending = MATERIAL.young_modulus * SIZE[1] * SIZE[2].powi(3) / 12.0;
    for (deflection, within) in [(0.1, [1e-3, 1e-3]), (0.2, [3e-3, 9e-3])] {
        let force = 3.0 * bending * deflection;
        let forces = |_: &[f64]| {
            let mut forces = vec![0.0; clamped.dofs()];
            forces[3 * node + 2] = -force;
            forces
        };
        let u = clamped.at_rest(8, 0.0, forces).unwrap();
        let expected = Vector3::from_column_slice(&u[3 * node..3 * node + 3]);
        let load = format!(
            "{{ kind = 'force', at = {:?}, direction = [0, 0, -1], amplitude = {force:e}, history = {{ kind = 'ramp', duration = 2.0 }} }}",
            tip().as_slice()
        );
        let found = |modes: &str| {
            let rest = format!(
                "markers = {{ root = {{ box = [[-1e-6, -1, -1], [1e-6, 1, 1]] }} }}\nloads = [{load}]\npoints = {{ tip = {:?} }}\n",
                tip().as_slice()
            );
            let text = body("bar", MATERIAL.young_modulus, modes, &rest)
                + "[[joints]]\nkind = 'fixed'\nbetween = ['ground', 'bar.root']\n";
            // The joint takes the body along: its bending is damped by a tenth of the ratio.
            let rows = run(directory.path(), &text, 1e-6, 20.0, 1.0, 1);
            let [last, before] = [1, 2].map(|back| rows[rows.len() - back][0].points[0].displacement);
            assert!((last - before).norm() < 1e-8, "at rest: {last} {before}");
            last
        };
        let in_joint = found("flexible = 16, damping_ratio = 0.7, large = [1, 3], following = 7");
        let text = format!(
            "{UNITS}[body]\nmesh = 'bar.msh'\n\
             material = {{ young_modulus = {:e}, poisson_ratio = 0.0, density = {:e} }}\n\
             [modes]\nflexible = 8\ndamping_ratio = 0.7\nlarge = 1\n[[constraints]]\nkind = 'clamp'\n\
             box = [[-1e-6, -1, -1], [1e-6, 1, 1]]\n[output]\ninterval = 1.0\npoints = {{ tip = {:?} }}\n\
             [time]\nend = 6.0\ntolerance = 1e-5\n",
            MATERIAL.young_modulus,
            MATERIAL.density,
            tip().as_slice(),
        ) + &format!(
            "[[loads]]\n{}\n",
            load.trim_matches(['{', '}'])
                .trim()
                .replace(", direction", "\ndirection")
                .replace(", amplitude", "\namplitude")
                .replace(", history", "\nhistory")
                .replace(", at", "\nat")
        );
        let body = scene::Body::parse(&text, directory.path().join("scene.toml")).unwrap();
        let model = model::Model::build(&body, |_| ()).unwrap();
        let alone = cases::rows(&body, &model).unwrap().last().unwrap().points[0].displacement;
        let mut of_joint = f64::INFINITY;
        for (what, moved) in
            [("joint", in_joint), ("clamp", alone), ("joint, small modes", found("flexible = 16, damping_ratio = 0.7"))]
        {
            let off = (moved - expected) / deflection;
            println!(
                "{deflection}, {what}: {:.6} {:.6} instead of {:.6} {:.6}: {:+.2e} {:+.2e}",
                moved.x, moved.z, expected.x, expected.z, off.x, off.z
            );
            match what {
                // They do not draw the bar in.
                "joint, small modes" => assert!(off.x.abs() > 2.0 * of_joint, "{off} {of_joint}"),
                _ => assert!(off.x.abs() < within[0] && off.z.abs() < within[1], "{what}: {moved} {expected}"),
            }
            if what == "joint" {
                of_joint = off.x.abs();
            }
        }
    }
}

/// Independent reference: the nonlinear finite elements of this crate, hinged at the nodes of a line.
#[test]
fn a_soft_pendulum_swings_as_the_whole_mesh_does() {
    let directory = with_bar();
    let (young_modulus, gravity, end, steps) = (2e7, 9.81, 0.6, 300);
    let is_held = |x: &Vector3<f64>| x.x < 1e-9 && x.z > SIZE[2] - 1e-9;
    let hinged = solid(young_modulus, is_held);
    let node = at(&hinged, &tip());
    let down: Vec<f64> = (0..hinged.dofs()).map(|k| if k % 3 == 2 { -gravity } else { 0.0 }).collect();
    let weight = hinged.momentum(&down);
    let whole = |steps: usize| {
        let start = NodalState { time: 0.0, u: vec![0.0; hinged.dofs()], v: vec![0.0; hinged.dofs()] };
        let mut motion = SolidMotion::new(&hinged, start, end / steps as f64, |_, _| weight.clone());
        let mut found = vec![Vector3::zeros()];
        for step in 1..=steps {
            motion.advance().unwrap();
            if step % (steps / 30) == 0 {
                found.push(Vector3::from_column_slice(&motion.state.u[3 * node..3 * node + 3]));
            }
        }
        found
    };
    let [coarse, fine] = [whole(steps), whole(2 * steps)];
    let expected: Vec<Vector3<f64>> =
        coarse.iter().zip(&fine).map(|(coarse, fine)| (fine * 4.0 - coarse) / 3.0).collect();
    let mut offs = Vec::new();
    for modes in ["flexible = 12, large = [1, 3], following = 7", "flexible = 12, large = 1", "flexible = 12"] {
        let rest = format!(
            "markers = {{ root = {{ box = [[-1e-6, -1, {}], [1e-6, 1, 1]], tie = 'nodes' }} }}\n\
             loads = [{{ kind = 'gravity', direction = [0, 0, -1], amplitude = {gravity} }}]\npoints = {{ tip = {:?} }}\n",
            SIZE[2] - 1e-6,
            tip().as_slice()
        );
        let text = body("bar", young_modulus, modes, &rest)
            + "[[joints]]\nkind = 'revolute'\nbetween = ['ground', 'bar.root']\naxis = [0, 1, 0]\n";
        let found = run(directory.path(), &text, 1e-6, end, end / 30.0, 1);
        let off =
            found.iter().zip(&expected).map(|(row, u)| (row[0].points[0].displacement - u).norm()).fold(0.0, f64::max);
        let bent = found.iter().map(|row| row[0].points[0].elastic_displacement_body.norm()).fold(0.0, f64::max);
        let energies: Vec<f64> =
            found.iter().map(|row| row[0].kinetic_energy + row[0].strain_energy - row[0].work.work).collect();
        let largest = found.iter().map(|row| row[0].kinetic_energy).fold(0.0, f64::max);
        let lost = energies.iter().map(|e| (e - energies[0]).abs()).fold(0.0, f64::max) / largest;
        println!("{modes}: off by {off:.5} of 1 m, bent by {bent:.4}, energy {lost:.1e}");
        offs.push(off);
        // Conserved: energy, but for the work of loads and joints.
        assert!(lost < 1e-5, "{lost}");
    }
    assert!(offs[0] < 2e-3 && offs[0] < 0.4 * offs[2], "{offs:?}");
}

#[test]
fn a_rigid_region_of_a_body_with_large_modes_is_refused() {
    let directory = with_bar();
    let of = |tie: &str| {
        let rest = format!("markers = {{ root = {{ box = [[-1e-6, -1, -1], [1e-6, 1, 1]], tie = '{tie}' }} }}\n");
        let text = body("bar", MATERIAL.young_modulus, "flexible = 3, large = 1", &rest)
            + "[[joints]]\nkind = 'fixed'\nbetween = ['ground', 'bar.root']\n";
        built(directory.path(), &format!("{UNITS}{text}[time]\nend = 1.0\ntolerance = 1e-6\n"))
    };
    assert!(of("mean").is_ok());
    let message = of("rigid").err().unwrap().to_string();
    for words in
        ["`bodies.bar.markers.root.tie`: found a rigid part of a body with large modes", "large_deflection = false"]
    {
        assert!(message.contains(words), "{words:?} is not in: {message}");
    }
}

/// Conserved: momenta to rounding, and energy by the tolerance, of two bars that tumble freely, bent far, on a hinge.
#[test]
fn a_free_pair_of_bent_bars_keeps_its_momenta_and_energy() {
    let directory = with_bar();
    let face = |x: f64| format!("{{ box = [[{}, -1, -1], [{}, 1, 1]] }}", x - 1e-6, x + 1e-6);
    let markers = format!("markers = {{ root = {}, end = {} }}\n", face(0.0), face(1.0));
    let modes = "flexible = 6, large = [1, 2], following = 3";
    let initial =
        "initial = { angular_velocity = [2, 3, 5], velocity = [0.3, 0, -0.2], modal_displacement = [0.01, -0.004] }\n";
    let text = body("a", 1e8, modes, &(markers.clone() + initial))
        + &body("b", 1e8, modes, &(markers + "initial = { position = [1, 0, 0] }\n"))
        + "[[joints]]\nkind = 'revolute'\nbetween = ['a.end', 'b.root']\naxis = [0, 1, 1]\n";
    let mut energies = Vec::new();
    for tolerance in [1e-4, 1e-6] {
        let built =
            built(directory.path(), &format!("{UNITS}{text}[time]\nend = 0.2\ntolerance = {tolerance:e}\n")).unwrap();
        // Gauss forgets no vibration.
        let setup = SystemSetup {
            system: built.tied.system.clone(),
            states: built.tied.states.clone(),
            start: Start::AsPlaced,
            scheme: SystemScheme::Gauss,
            control: StepControl::Tolerance(tolerance),
            end: 0.2,
            rows: Rows::Interval(0.02),
            points: vec![Vec::new(); 2],
        };
        let mut simulation = Simulation::of_system(setup).unwrap();
        let found = rows(&mut simulation, 2).unwrap();
        let sums = |row: &Vec<Observation>| {
            let linear: Vector3<f64> = row.iter().map(|of| of.linear_momentum_global).sum();
            let about =
                |of: &Observation| of.origin_global.cross(&of.linear_momentum_global) + of.angular_momentum_global;
            let angular: Vector3<f64> = row.iter().map(about).sum();
            ([linear, angular], row.iter().map(|of| of.kinetic_energy + of.strain_energy).sum::<f64>())
        };
        let (momenta, energy_at_start) = sums(&found[0]);
        let off = |which: usize| {
            let of_row = |row| (sums(row).0[which] - momenta[which]).norm();
            found.iter().map(of_row).fold(0.0, f64::max) / momenta[which].norm()
        };
        let [linear, angular] = [0, 1].map(off);
        let energy = found.iter().map(|row| (sums(row).1 / energy_at_start - 1.0).abs()).fold(0.0, f64::max);
        let q =
            found.iter().flat_map(|row| row[0].modal_displacement.iter()).fold(0.0_f64, |most, q| most.max(q.abs()));
        println!("{tolerance:e}: momenta {linear:.1e} {angular:.1e}, energy {energy:.1e}, q {q:.4}");
        // Rounding of each step.
        let rounding = 1e-14 * (simulation.stats().accepted as f64).sqrt();
        assert!(linear < rounding && angular < rounding, "{linear} {angular}");
        energies.push(energy);
    }
    assert!(energies[1] < 1e-4 && energies[1] < 0.05 * energies[0], "{energies:?}");
}
