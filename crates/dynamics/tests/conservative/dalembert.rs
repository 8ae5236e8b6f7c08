//! Observations against sums over the nodes and differences in time: a second way to every equation of motion.
//!
//! A particle at `x = X + Φq` of the body frame has `v = V + ω×x + Φq̇` and
//! `a = A + α×x + ω×(ω×x) + 2ω×Φq̇ + Φq̈`. By d'Alembert's principle the forces less `M a` do no work in a rigid
//! displacement, nor in that of a mode, where strain and damping oppose: no inertia, momentum or constant of the
//! reduced body enters.

use dynamics::{ConservativeBody, Initial, Observation, Oscillators, Physics, Rows, SharedLoad, StepControl};
use faer::sparse::SparseColMatRef;
use nalgebra::Vector3;

use crate::common::{Specimen, ring};
use crate::run::{EXPONENTIAL, Run, relative, relative_3};

const DAMPING_RATIO: f64 = 0.05;

/// Spinning, flying, deformed and vibrating, no entry zero.
fn start() -> Initial {
    let list = |seed: f64, size: f64| (0..10).map(|k| size * (seed + f64::from(k * k)).sin()).collect::<Vec<f64>>();
    Initial {
        attitude: rigid_kin::Attitude::identity(),
        origin: None,
        velocity: Vector3::new(300.0, -200.0, 500.0),
        omega: Vector3::new(40.0, -60.0, 70.0),
        modal_displacement: list(1.0, 0.02),
        modal_velocity: list(2.0, 30.0),
    }
}

const PLACES: [([f64; 3], [f64; 3], f64); 2] =
    [([-100.0, 0.0, 0.0], [30.0, -50.0, 80.0], 0.1), ([95.0, 30.0, 20.0], [-40.0, 20.0, 10.0], 0.03)];

fn loads(ring: &Specimen) -> Vec<SharedLoad> {
    PLACES
        .map(|(at, force, duration)| ring.half_sine(ring.mesh.positions()[ring.nearest_node(at)], force, duration))
        .into()
}

fn run(ring: &Specimen) -> Run<'_> {
    Run { damping_ratio: DAMPING_RATIO, loads: loads(ring), ..Run::free(ring, start(), 0.01) }
}

/// M x for one vector a node.
pub fn times(mass: SparseColMatRef<'_, usize, f64>, x: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut product = vec![Vector3::zeros(); x.len()];
    for column in 0..3 * x.len() {
        let x = x[column / 3][column % 3];
        for (row, m) in mass.symbolic().row_idx_of_col(column).zip(mass.val_of_col(column)) {
            product[row / 3][row % 3] += m * x;
        }
    }
    product
}

/// Φ c at the nodes.
fn field(ring: &Specimen, c: &[f64]) -> Vec<Vector3<f64>> {
    let shapes = &ring.modes.shapes;
    let at = |row: usize| c.iter().enumerate().map(|(k, c)| shapes[(row, k)] * c).sum();
    (0..ring.mesh.positions().len()).map(|n| Vector3::from_fn(|axis, _| at(3 * n + axis))).collect()
}

/// Φᵀ f.
fn projected(ring: &Specimen, f: &[Vector3<f64>]) -> Vec<f64> {
    let shape = |n: usize, k: usize| Vector3::from_fn(|axis, _| ring.modes.shapes[(3 * n + axis, k)]);
    (0..10).map(|k| f.iter().enumerate().map(|(n, f)| shape(n, k).dot(f)).sum()).collect()
}

/// Undeformed positions from the centre of mass.
fn undeformed(ring: &Specimen) -> Vec<Vector3<f64>> {
    ring.mesh.positions().iter().map(|x| Vector3::from(*x) - ring.body.center_of_mass).collect()
}

pub fn sum<'a>(x: &'a [Vector3<f64>], f: &'a [Vector3<f64>]) -> Vector3<f64> {
    x.iter().zip(f).map(|(x, f)| x.cross(f)).sum()
}

fn dot(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// Independent reference: sums over the nodes by d'Alembert's principle.
#[test]
fn accelerations_balance_all_forces_at_the_nodes() {
    let ring = ring();
    let now: Observation = run(ring).end(EXPONENTIAL, 1e-5);
    let omega = now.omega_body;
    let to_body = |v: &Vector3<f64>| now.attitude.to_body(v);
    let (velocity_of_center, center) = (to_body(&now.velocity_global), undeformed(ring));
    let (u, v) = (field(ring, &now.modal_displacement), field(ring, &now.modal_velocity));
    let a = field(ring, &now.modal_acceleration);
    let x: Vec<Vector3<f64>> = center.iter().zip(&u).map(|(x, u)| x + u).collect();
    let velocity: Vec<Vector3<f64>> = x.iter().zip(&v).map(|(x, v)| velocity_of_center + omega.cross(x) + v).collect();
    let relative_acceleration =
        |n: usize| now.alpha_body.cross(&x[n]) + omega.cross(&omega.cross(&x[n])) + 2.0 * omega.cross(&v[n]) + a[n];
    let acceleration: Vec<Vector3<f64>> = (0..x.len()).map(relative_acceleration).collect();
    let mass = ring.matrices.mass();
    let (momentum, inertial) = (times(mass, &velocity), times(mass, &acceleration));

    // Energy and momenta.
    let kinetic = 0.5 * dot(&velocity, &momentum);
    let strain = 0.5 * dot(&u, &times(ring.matrices.stiffness(), &u));
    let linear: Vector3<f64> = momentum.iter().sum();
    let angular = sum(&x, &momentum);
    let errors = [
        (now.kinetic_energy / kinetic - 1.0).abs(),
        (now.strain_energy / strain - 1.0).abs(),
        relative_3(&now.linear_momentum_global, &now.attitude.to_global(&linear)),
        relative_3(&now.angular_momentum_global, &now.attitude.to_global(&angular)),
    ];
    // Measured: 1.6e-15, 1.5e-13, 6e-15, 5e-16.
    assert!(errors.iter().all(|e| *e < 1e-11), "{errors:?}");

    // Rotation and modes; translation is P' = ΣF.
    let mut moment = Vector3::zeros();
    let mut modal = vec![0.0; 10];
    for (at, force, duration) in PLACES {
        let node = ring.nearest_node(at);
        let factor = (std::f64::consts::PI * now.time / duration).sin();
        let force = to_body(&(Vector3::from(force) * factor));
        moment += x[node].cross(&force);
        for (k, f) in modal.iter_mut().enumerate() {
            *f += Vector3::from_fn(|axis, _| ring.modes.shapes[(3 * node + axis, k)]).dot(&force);
        }
    }
    for (k, f) in modal.iter_mut().enumerate() {
        let omega = ring.body.circular_frequencies[k];
        *f -= omega * omega * now.modal_displacement[k] + 2.0 * DAMPING_RATIO * omega * now.modal_velocity[k];
    }
    // Measured: 9e-16 and 1.6e-15.
    let rotation = relative_3(&sum(&x, &inertial), &moment);
    assert!(rotation < 1e-12, "{rotation:e}");
    let modes = relative(&projected(ring, &inertial), &modal);
    assert!(modes < 1e-12, "{modes:e}");
}

/// Independent reference: ΦᵀM v at the nodes.
#[test]
fn modal_momenta_are_projections_of_the_velocities() {
    let ring = ring();
    let body = ConservativeBody::new(&ring.body, &[0.0; 10], vec![], &Physics::default()).unwrap();
    let state = body.start(&start()).unwrap();
    let u = field(ring, &start().modal_displacement);
    let v = field(ring, &start().modal_velocity);
    let x = undeformed(ring);
    let velocity: Vec<Vector3<f64>> =
        (0..x.len()).map(|n| start().velocity + start().omega.cross(&(x[n] + u[n])) + v[n]).collect();
    let expected = projected(ring, &times(ring.matrices.mass(), &velocity));
    let [_, first] = body.first_modes();
    let error = relative(&state.values[first..first + 10], &expected);
    assert!(error < 1e-13, "{error:e}"); // 1.8e-15
}

/// Five-point differences in time of what `of` reads off rows that are `h` apart, at the middle one.
fn rate(rows: &[Observation; 5], h: f64, of: impl Fn(&Observation) -> Vec<f64>) -> Vec<f64> {
    let [a, b, _, d, e] = rows.each_ref().map(of);
    (0..a.len()).map(|i| (a[i] - e[i] + 8.0 * (d[i] - b[i])) / (12.0 * h)).collect()
}

/// Independent reference: five-point differences in time.
#[test]
fn rates_are_those_of_what_is_observed() {
    let ring = ring();
    let run = Run { points: vec![ring.point([-100.0, 0.0, 0.0]), ring.point([0.0, -80.0, 20.0])], ..run(ring) };
    // The fastest mode has 4.3e4 rad/s.
    let h = 5e-7;
    let rows = run.start(EXPONENTIAL, StepControl::Fixed(h), Rows::EverySteps(1));
    let rows: Vec<Observation> = rows.skip(400).take(5).map(|row| row.unwrap()).collect();
    let rows: [Observation; 5] = rows.try_into().unwrap();
    let now = &rows[2];
    let list = |v: &Vector3<f64>| v.as_slice().to_vec();
    let mut errors = vec![
        relative(&now.modal_velocity, &rate(&rows, h, |row| row.modal_displacement.clone())),
        relative(&now.modal_acceleration, &rate(&rows, h, |row| row.modal_velocity.clone())),
        relative(now.alpha_body.as_slice(), &rate(&rows, h, |row| list(&row.omega_body))),
        relative(now.velocity_global.as_slice(), &rate(&rows, h, |row| list(&row.position_global))),
    ];
    for (n, point) in now.points.iter().enumerate() {
        errors.push(relative(point.velocity.as_slice(), &rate(&rows, h, |row| list(&row.points[n].displacement))));
        errors.push(relative(point.acceleration.as_slice(), &rate(&rows, h, |row| list(&row.points[n].velocity))));
    }
    // Measured: 1e-12 to 9e-9, and 16 times that with twice h: the error of the differences.
    assert!(errors.iter().all(|e| *e < 5e-8), "{errors:?}");
}
