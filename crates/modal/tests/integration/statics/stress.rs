//! Recovered stress against closed forms on finer and finer meshes.

mod meshes;

use faer::Mat;
use fem_tet10::{Location, Material, Materials, Mesh, StressError, StressRecovery, shape_gradients};
use modal::{Support, centrifugal_fields};
use nalgebra::{Matrix3, Vector3};

use crate::beam::order;
use crate::bodies::{Body, STEEL, block_mesh};
use meshes::{Point, disc, holed, hollow_sphere};

/// A static response and its stress.
struct Answer {
    mesh: Mesh,
    material: Material,
    displacement: Mat<f64>,
}

impl Answer {
    fn new(mesh: Mesh, material: Material, support: &Support, force: impl Fn(&Mesh, &Body) -> Mat<f64>) -> Self {
        let body = Body::new(&mesh, material);
        let force = force(&mesh, &body);
        let displacement = body.held(support).static_response(force.as_ref()).unwrap();
        Self { mesh, material, displacement }
    }

    fn recovered(&self) -> Vec<[f64; 6]> {
        let recovery = StressRecovery::new(&self.mesh, &Materials::Uniform(self.material)).unwrap();
        in_rows(&recovery.nodal_stress(self.displacement.as_ref()).unwrap())
    }

    fn estimate(&self) -> f64 {
        let recovery = StressRecovery::new(&self.mesh, &Materials::Uniform(self.material)).unwrap();
        let all = recovery.error_estimate(self.displacement.subcols(0, 1)).unwrap();
        all.into_iter().sum::<StressError>().relative()
    }

    /// The mean over the elements around a node of their own stress there: written down a second time.
    fn averaged(&self) -> Vec<[f64; 6]> {
        let positions = self.mesh.positions();
        let mut sums = vec![([0.0; 6], 0.0); positions.len()];
        for nodes in self.mesh.elements() {
            for (place, node) in nodes.iter().enumerate() {
                let (stress, weight) =
                    element_stress(positions, nodes, &self.displacement, &self.material, CORNERS[place]);
                sums[*node as usize].0.iter_mut().zip(stress).for_each(|(sum, s)| *sum += s * weight);
                sums[*node as usize].1 += weight;
            }
        }
        sums.into_iter().map(|(sum, weight)| sum.map(|s| s / weight)).collect()
    }

    fn at(&self, stress: &[[f64; 6]], point: Point) -> [f64; 6] {
        let Location { nodes, weights } = self.mesh.locate(point).unwrap();
        std::array::from_fn(|c| nodes.iter().zip(&weights).map(|(node, w)| w * stress[*node as usize][c]).sum())
    }
}

const CORNERS: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
];

/// Stress of an element at a reference point, and the determinant of its Jacobian there.
fn element_stress(
    positions: &[Point],
    nodes: &[u32; 10],
    u: &Mat<f64>,
    material: &Material,
    at: [f64; 3],
) -> ([f64; 6], f64) {
    let (mut jacobian, mut slopes) = (Matrix3::zeros(), Matrix3::zeros());
    for (node, gradient) in nodes.iter().zip(shape_gradients(at)) {
        let node = *node as usize;
        jacobian += Vector3::from(positions[node]) * Vector3::from(gradient).transpose();
        slopes += Vector3::from_fn(|axis, _| u[(3 * node + axis, 0)]) * Vector3::from(gradient).transpose();
    }
    let gradient = slopes * jacobian.try_inverse().unwrap();
    let strain = 0.5 * (gradient + gradient.transpose());
    let (lambda, mu) = material.lame();
    let s = lambda * strain.trace() * Matrix3::identity() + 2.0 * mu * strain;
    ([s[(0, 0)], s[(1, 1)], s[(2, 2)], s[(0, 1)], s[(1, 2)], s[(2, 0)]], jacobian.determinant())
}

fn in_rows(nodal: &Mat<f64>) -> Vec<[f64; 6]> {
    (0..nodal.nrows() / 6).map(|node| std::array::from_fn(|c| nodal[(6 * node + c, 0)])).collect()
}

/// Largest difference of a component at a node, over the largest component.
fn worst(mesh: &Mesh, stress: &[[f64; 6]], truth: impl Fn(Point) -> [f64; 6]) -> f64 {
    let (mut off, mut scale) = (0.0_f64, 0.0_f64);
    for (x, found) in mesh.positions().iter().zip(stress) {
        for (a, b) in found.iter().zip(truth(*x)) {
            off = off.max((a - b).abs());
            scale = scale.max(b.abs());
        }
    }
    off / scale
}

fn cartesian(directions: [Vector3<f64>; 3], stresses: [f64; 3]) -> [f64; 6] {
    let s: Matrix3<f64> = directions.iter().zip(stresses).map(|(d, s)| d * d.transpose() * s).sum();
    [s[(0, 0)], s[(1, 1)], s[(2, 2)], s[(0, 1)], s[(1, 2)], s[(2, 0)]]
}

/// The largest errors at a node on finer and finer meshes: the last one and the fitted order are what was `measured` here, to
/// 2 % and 0.1. The order is 2 on fine meshes; the coarse ones here are still on the way to it (hole, from 2 to 6: 1.8).
fn assert_converges(
    what: &str,
    sizes: &[usize],
    case: impl Fn(usize) -> Answer,
    truth: impl Fn(Point) -> [f64; 6] + Copy,
    measured: (f64, f64),
) {
    let (mut errors, mut estimates) = (Vec::new(), Vec::new());
    for n in sizes {
        let answer = case(*n);
        let recovered = answer.recovered();
        let second = answer.averaged();
        let scale = recovered.iter().flatten().fold(0.0_f64, |most, s| most.max(s.abs()));
        let apart = recovered.iter().flatten().zip(second.iter().flatten()).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-9 * scale, "{what}: not the mean of the elements' stresses");
        errors.push(worst(&answer.mesh, &recovered, truth));
        estimates.push(answer.estimate());
    }
    let found = order(sizes, &errors);
    println!(
        "{what}: errors {errors:?} order {found:.2}, estimates {estimates:?} order {:.2}",
        order(sizes, &estimates)
    );
    let (last, expected) = measured;
    assert!((found - expected).abs() < 0.1, "{what}: order {found}, {errors:?}");
    assert!((errors[errors.len() - 1] / last - 1.0).abs() < 0.02, "{what}: {errors:?}");
    assert!(estimates.windows(2).all(|pair| pair[1] < pair[0]), "{what}: {estimates:?}");
}

const PRESSURE: f64 = 7.0;

fn sphere(n: usize) -> Answer {
    let mesh = hollow_sphere(1.0, 2.0, n, n);
    Answer::new(mesh, STEEL, &Support::free(), |mesh, _| {
        let (nodes, forces) = mesh.surface_pressure("loaded").unwrap();
        let mut force = Mat::zeros(3 * mesh.positions().len(), 1);
        for (node, f) in nodes.iter().zip(&forces) {
            (0..3).for_each(|axis| force[(3 * *node as usize + axis, 0)] += PRESSURE * f[axis]);
        }
        force
    })
}

/// Lamé's solution: a = 1, b = 2.
fn lame(x: Point) -> [f64; 6] {
    let x = Vector3::from(x);
    let (r3, radial) = (x.norm().powi(3), x.normalize());
    let across = radial.cross(&if radial.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() }).normalize();
    let (s_r, s_t) = (PRESSURE / 7.0 * (1.0 - 8.0 / r3), PRESSURE / 7.0 * (1.0 + 4.0 / r3));
    cartesian([radial, across, radial.cross(&across)], [s_r, s_t, s_t])
}

const SPIN: f64 = 300.0;

fn spinning(mesh: Mesh, material: Material, axis_pair: &[usize]) -> Answer {
    Answer::new(mesh, material, &Support::free(), |mesh, body| {
        let solver = body.held(&Support::free());
        let fields = centrifugal_fields(solver.mass(), mesh.positions(), &Vector3::zeros()).unwrap();
        Mat::from_fn(fields.nrows(), 1, |i, _| axis_pair.iter().map(|k| fields[(i, *k)]).sum::<f64>() * SPIN * SPIN)
    })
}

fn spinning_disc(n: usize) -> Answer {
    spinning(disc(10.0, 1.0, n, 1.max(n / 3)), STEEL, &[2])
}

/// Stress of a thin disc, with the terms of its thickness: right but near the rim.
fn disc_truth([x, y, z]: Point) -> [f64; 6] {
    let (nu, load, r2) = (STEEL.poisson_ratio, STEEL.density * SPIN * SPIN, x * x + y * y);
    let c2 = 0.25;
    let third = nu * (1.0 + nu) / (6.0 * (1.0 - nu)) * (c2 - 3.0 * z * z);
    let s_r = load * ((3.0 + nu) / 8.0 * (100.0 - r2) + third);
    let s_t = load * ((3.0 + nu) / 8.0 * 100.0 - (1.0 + 3.0 * nu) / 8.0 * r2 + third);
    let radial = if r2 > 0.0 { Vector3::new(x, y, 0.0).normalize() } else { Vector3::x() };
    cartesian([radial, Vector3::z().cross(&radial), Vector3::z()], [s_r, s_t, 0.0])
}

const RODLIKE: Material = Material { poisson_ratio: 0.0, ..STEEL };

fn spinning_bar(n: usize) -> Answer {
    spinning(block_mesh([8.0, 0.1, 0.1], [2 * n, 1, 1]), RODLIKE, &[2])
}

fn bar_truth([x, ..]: Point) -> [f64; 6] {
    [0.5 * STEEL.density * SPIN * SPIN * (16.0 - x * x), 0.0, 0.0, 0.0, 0.0, 0.0]
}

/// The nodal forces of a stress field that is in balance: those of its tractions on the surface.
fn forces_of(mesh: &Mesh, truth: impl Fn(Point) -> [f64; 6]) -> Mat<f64> {
    let mut force = Mat::zeros(3 * mesh.positions().len(), 1);
    let (a1, w1) = (0.310_885_919_263_300_6, 0.018_781_320_953_002_643);
    let (a2, w2) = (0.092_735_250_310_891_23, 0.012_248_840_519_393_66);
    let (a3, w3) = (0.045_503_704_125_649_65, 0.007_091_003_462_846_911);
    let mut rule = Vec::new();
    for (a, w) in [(a1, w1), (a2, w2)] {
        let b = 1.0 - 3.0 * a;
        rule.extend([[a, a, a], [b, a, a], [a, b, a], [a, a, b]].map(|at| (at, w)));
    }
    let (a, b) = (a3, 0.5 - a3);
    rule.extend([[a, a, b], [a, b, a], [b, a, a], [b, b, a], [b, a, b], [a, b, b]].map(|at| (at, w3)));
    for nodes in mesh.elements() {
        for (at, weight) in &rule {
            let shapes = fem_tet10::shape_functions(*at);
            let (mut jacobian, mut place) = (Matrix3::zeros(), Vector3::zeros());
            for ((node, gradient), n) in nodes.iter().zip(shape_gradients(*at)).zip(shapes) {
                let x = Vector3::from(mesh.positions()[*node as usize]);
                jacobian += x * Vector3::from(gradient).transpose();
                place += x * n;
            }
            let [xx, yy, zz, xy, yz, zx] = truth(place.into());
            let stress = Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
            let inverse = jacobian.try_inverse().unwrap().transpose();
            for (node, gradient) in nodes.iter().zip(shape_gradients(*at)) {
                let f = stress * (inverse * Vector3::from(gradient)) * (weight * jacobian.determinant());
                (0..3).for_each(|axis| force[(3 * *node as usize + axis, 0)] += f[axis]);
            }
        }
    }
    force
}

/// Kirsch's solution of a hole of radius 1 in a plate that is pulled along x with the stress 1.
fn kirsch([x, y, _]: Point) -> [f64; 6] {
    let (r2, angle) = (1.0 / (x * x + y * y), y.atan2(x));
    let (s, c) = ((2.0 * angle).sin(), (2.0 * angle).cos());
    let s_r = 0.5 * (1.0 - r2) + 0.5 * (1.0 - 4.0 * r2 + 3.0 * r2 * r2) * c;
    let s_t = 0.5 * (1.0 + r2) - 0.5 * (1.0 + 3.0 * r2 * r2) * c;
    let s_rt = -0.5 * (1.0 + 2.0 * r2 - 3.0 * r2 * r2) * s;
    let radial = Vector3::new(angle.cos(), angle.sin(), 0.0);
    let around = Vector3::z().cross(&radial);
    let shear = radial * around.transpose() + around * radial.transpose();
    let stress = radial * radial.transpose() * s_r + around * around.transpose() * s_t + shear * s_rt;
    [stress[(0, 0)], stress[(1, 1)], 0.0, stress[(0, 1)], 0.0, 0.0]
}

fn kirsch_plate(n: usize) -> Answer {
    let mesh = holed(1.0, |_| 4.0, 0.5, n, 2 * n, |_| false);
    Answer::new(mesh, RODLIKE, &Support::free(), |mesh, _| forces_of(mesh, kirsch))
}

/// A bar of length 8, width 1 and height 2 that is bent by a force at its end: stress σ_xx = (4 − x) z and a parabola of
/// shear, exact without Poisson's effect.
fn flexure([x, _, z]: Point) -> [f64; 6] {
    [(4.0 - x) * z, 0.0, 0.0, 0.0, 0.0, 0.5 * (z * z - 1.0)]
}

fn bent_bar(n: usize) -> Answer {
    let mesh = block_mesh([8.0, 1.0, 2.0], [2 * n, 1, n]);
    Answer::new(mesh, RODLIKE, &Support::free(), |mesh, _| forces_of(mesh, flexure))
}

/// Closed form: σ = 3 + 2z − y.
#[test]
fn a_bar_in_tension_and_pure_bending_is_exact() {
    let truth = |[_, y, z]: Point| [3.0 + 2.0 * z - y, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mesh = block_mesh([8.0, 1.0, 2.0], [4, 1, 2]);
    let answer = Answer::new(mesh, STEEL, &Support::free(), |mesh, _| forces_of(mesh, truth));
    let off = worst(&answer.mesh, &answer.recovered(), truth);
    assert!(off < 1e-8, "{off:e}");
    assert!(answer.estimate() < 1e-6);
}

/// Closed form: flexure, σ = (4 − x) z. Error and order are figures of this program.
#[test]
fn a_bar_that_a_force_bends_converges() {
    assert_converges("bent bar", &[2, 4, 8], bent_bar, flexure, (3.8700e-3, 1.94));
}

/// Closed form: Lamé's hollow sphere. Error and order are figures of this program.
#[test]
fn a_hollow_sphere_under_pressure_converges_to_lame() {
    assert_converges("hollow sphere", &[2, 4], sphere, lame, (0.16573, 1.32));
}

/// Closed form: the thin disc with the terms of its thickness. Error and order are figures of this program.
#[test]
fn a_spinning_disc_converges() {
    assert_converges("spinning disc", &[3, 6, 9], spinning_disc, disc_truth, (6.5627e-3, 1.70));
}

/// Closed form: σ = ρω²(L²/4 − x²)/2. Error and order are figures of this program.
#[test]
fn a_spinning_bar_converges() {
    assert_converges("spinning bar", &[2, 4, 8], spinning_bar, bar_truth, (2.9317e-3, 1.92));
}

/// Closed form: Kirsch's hole in a plate. Error and order are figures of this program.
#[test]
fn a_hole_in_a_plate_converges_to_three() {
    assert_converges("hole", &[1, 2, 4], kirsch_plate, kirsch, (1.8986e-2, 1.50));
    let answer = kirsch_plate(4);
    let beside = answer.at(&answer.recovered(), [0.0, 1.0, 0.0])[0];
    println!("stress beside the hole {beside}");
    assert!((beside - 3.0).abs() < 0.05, "{beside}");
}

/// Independent reference: Howland's formula of the stress beside the hole over that of the whole width, 0.284 + 2/(1
/// − s) − 0.6 (1 − s) + 1.32 (1 − s)² with s = 0.1, which is 3.035. His plate is long, this one is square and ten
/// times as wide as its hole.
#[test]
fn a_plate_of_finite_width_has_the_stress_concentration_of_the_handbook() {
    let half = 10.0;
    let outer = |angle: f64| half / angle.cos().abs().max(angle.sin().abs());
    let mesh = holed(1.0, outer, 0.5, 4, 10, |x| (x[0].abs() - half).abs() < 1e-6);
    let answer = Answer::new(mesh, RODLIKE, &Support::free(), |mesh, _| {
        let (nodes, forces) = mesh.surface_pressure("loaded").unwrap();
        let mut force = Mat::zeros(3 * mesh.positions().len(), 1);
        for (node, f) in nodes.iter().zip(&forces) {
            (0..3).for_each(|axis| force[(3 * *node as usize + axis, 0)] -= f[axis]);
        }
        force
    });
    let beside = answer.at(&answer.recovered(), [0.0, 1.0, 0.0])[0];
    println!("finite width {beside}");
    assert!((beside / 3.035 - 1.0).abs() < 0.03, "{beside}");
}
