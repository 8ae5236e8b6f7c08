//! Balances: conserved quantities, and the account of loads and damping.

use dynamics::{Initial, Method, Rows, StepControl};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use reduced_body::ReducedBody;

use crate::common::{plate, ring};
use crate::run::{EXPONENTIAL, RKMK4, Run, energy, fitted_order, relative, relative_3};

fn with_vibration(flexible: usize) -> Initial {
    let mut initial = Initial::at_rest(flexible);
    initial.omega = Vector3::new(5.0, 5.0, 7.0);
    initial.modal_displacement[..4].copy_from_slice(&[0.1, 0.02, 0.02, 0.01]);
    initial.modal_velocity[..4].copy_from_slice(&[10.0, 5.0, -5.0, 3.0]);
    initial
}

/// Conserved: energy and angular momentum.
#[test]
fn ten_seconds_of_tumbling_keep_energy_and_angular_momentum() {
    let initial = Initial { omega: Vector3::new(0.01, 10.0, 0.01), ..Initial::at_rest(10) };
    let run = Run::free(plate(), initial, 10.0);
    let start = run.beginning();
    let mut largest_spin_about_x = 0.0_f64;
    for row in run.start(EXPONENTIAL, StepControl::Fixed(1e-4), Rows::Interval(0.1)) {
        let row = row.unwrap();
        // Measured, largest of all rows: 6.7e-14 and 8.0e-14.
        let energy_error = (energy(&row) / energy(&start) - 1.0).abs();
        let momentum_error = relative_3(&row.angular_momentum_global, &start.angular_momentum_global);
        assert!(energy_error < 1e-12 && momentum_error < 1e-12, "{}: {energy_error:e}, {momentum_error:e}", row.time);
        largest_spin_about_x = largest_spin_about_x.max(row.omega_body.x);
    }
    // It does tumble: the spin about axis 2 is unstable.
    assert!(largest_spin_about_x > 9.0, "{largest_spin_about_x}");
}

/// Tumbling, vibrating and damped under two loads that have ended before the run does.
fn loaded() -> (Run<'static>, Vector3<f64>) {
    let plate = plate();
    let pulses = [([-500.0, 0.0, 10.0], [20.0, 10.0, 30.0], 0.15), ([500.0, 25.0, 0.0], [-15.0, 40.0, 5.0], 0.083_21)];
    let loads = pulses.map(|(at, force, duration)| plate.half_sine(at, force, duration)).into();
    let impulse = pulses.map(|(_, force, duration)| Vector3::from(force) * (2.0 * duration / std::f64::consts::PI));
    (Run { damping_ratio: 0.05, loads, ..Run::free(plate, with_vibration(10), 0.2) }, impulse.iter().sum())
}

/// How far the balances of energy, linear and angular momentum are from closed, in parts of the work and the impulses.
fn gaps(run: &Run, impulse: &Vector3<f64>, method: Method, step: f64) -> [f64; 3] {
    let (start, row) = (run.beginning(), run.end(method, step));
    let energy = (row.energy_balance() - start.energy_balance()) / row.work.work;
    let angular = row.angular_balance_global() - start.angular_balance_global();
    [
        energy.abs(),
        relative_3(&row.linear_momentum_global, impulse),
        angular.norm() / row.work.angular_impulse_global.norm(),
    ]
}

/// Conserved: the balances of energy and momenta; orders 4.
#[test]
fn balances_close_with_loads_and_damping() {
    let (run, impulse) = loaded();
    let steps = [4e-4, 2e-4, 1e-4, 5e-5];
    let of = |method: Method| steps.map(|step| gaps(&run, &impulse, method, step));
    // Energy; the angular momentum, whose gap is rounding below 1e-4 s (1e-13).
    let exponential = of(EXPONENTIAL); // 4.8e-9, 2.1e-10, 1.2e-11, 7.5e-13; 7.6e-12, 4.6e-13, 8e-14, 6e-14
    let rkmk4 = of(RKMK4); // 8.8e-6, 3.8e-7, 7.4e-9, 9.6e-11; 4.9e-11, 3.5e-12, 2e-13, 1e-13
    let order = |gaps: [[f64; 3]; 4]| fitted_order(steps, gaps.map(|gap| gap[0]));
    let orders = [exponential, rkmk4].map(order); // 4.2, 5.5
    assert!((orders[0] - 4.2).abs() < 0.2 && orders[1] > 4.0, "{orders:?}");
    assert!(exponential[2][0] < 1e-10 && rkmk4[2][0] < 1e-7);
    for gaps in [exponential, rkmk4] {
        // Linear momentum against the half-sines' own impulse: Simpson's rule, 3.7e-14.
        assert!(gaps[2][1] < 1e-9 && gaps[2][2] < 1e-12, "{gaps:?}");
    }
}

/// Regression only: the gaps of the paper's scheme and its limit; order 1.
#[test]
fn the_limit_of_the_paper_s_scheme_does_not_close_its_balances() {
    let (run, impulse) = loaded();
    let limit = [2e-4, 1e-4, 5e-5].map(|step| gaps(&run, &impulse, frames_rk4::LIMIT, step));
    // Energy 7.5e-7, 3.7e-7, 3.7e-7; angular momentum 1.7e-4 at each step. The linear momentum is right.
    let (before, last) = (limit[1], limit[2]);
    assert!((before[0] / last[0] - 1.0).abs() < 0.1 && (before[2] / last[2] - 1.0).abs() < 1e-3, "{limit:?}");
    assert!(last[2] > 1e-4 && last[1] < 1e-9, "{limit:?}");
    // The paper's own: 1.6e-2, 8.0e-3, 4.0e-3 of the work.
    let steps = [2e-4, 1e-4, 5e-5];
    let paper = steps.map(|step| gaps(&run, &impulse, frames_rk4::PAPER, step));
    assert!((fitted_order(steps, paper.map(|gap| gap[0])) - 1.0).abs() < 0.1, "{paper:?}");
}

fn of_pairs<T>(i: usize, j: usize, list: &[T; 6]) -> &T {
    &list[if i == j { i } else { 6 - i - j }]
}

/// Deformation that a spin `omega` holds.
fn held(body: &ReducedBody, omega: &Vector3<f64>) -> DVector<f64> {
    let nf = body.flexible();
    let mut stiffness = DMatrix::from_diagonal(&DVector::from_fn(nf, |k, _| body.circular_frequencies[k].powi(2)));
    let mut force = DVector::zeros(nf);
    for i in 0..3 {
        for j in 0..3 {
            let w = omega[i] * omega[j];
            let (c, n) = (of_pairs(i, j, &body.inertia_first), of_pairs(i, j, &body.inertia_second));
            stiffness -= DMatrix::from_fn(nf, nf, |k, l| w * n[(k, l)]);
            force += DVector::from_fn(nf, |k, _| w * c[k]);
        }
    }
    stiffness.lu().solve(&force).unwrap()
}

fn inertia(body: &ReducedBody, q: &DVector<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| {
        let (c, n) = (of_pairs(i, j, &body.inertia_first), of_pairs(i, j, &body.inertia_second));
        let second: f64 = (0..q.len()).map(|k| (0..q.len()).map(|l| q[k] * n[(k, l)] * q[l]).sum::<f64>()).sum();
        body.inertia[(i, j)] + 2.0 * (0..q.len()).map(|k| c[k] * q[k]).sum::<f64>() + second
    })
}

/// Conserved: a steady spin with its own deformation stays.
#[test]
fn a_deformed_body_that_spins_as_a_whole_is_not_damped() {
    let ring = ring();
    let spin = 200.0;
    let (mut omega, mut q) = (Vector3::zeros(), DVector::zeros(10));
    for _ in 0..20 {
        let eigen = inertia(&ring.body, &q).symmetric_eigen();
        omega = eigen.eigenvectors.column(eigen.eigenvalues.imax()) * spin;
        q = held(&ring.body, &omega);
    }
    let initial = Initial { omega, modal_displacement: q.as_slice().to_vec(), ..Initial::at_rest(10) };
    let points = vec![ring.point([-100.0, 0.0, 0.0])];
    let run = Run { damping_ratio: 0.05, points, ..Run::free(ring, initial, 0.2) };
    let start = run.beginning();
    // The spin widens the ring by 3 µm.
    assert!(start.points[0].displacement.norm() > 2e-3);

    for method in [EXPONENTIAL, RKMK4] {
        let row = run.end(method, 5e-6);
        // Dissipation 4e-28 of 1e5; the spin keeps every bit; deformation 5e-16.
        assert!(row.work.dissipation < 1e-20 * energy(&start), "{:e}", row.work.dissipation);
        assert!((row.omega_body - omega).norm() < 1e-13 * spin, "{:e}", (row.omega_body - omega).norm());
        assert!(relative(&row.modal_displacement, q.as_slice()) < 1e-12);
    }
    // In the limit of the paper's scheme damping acts on inertial velocities, and six turns cost 2.1e-4 of the spin.
    let limit = run.end(frames_rk4::LIMIT, 5e-6);
    let lost = 1.0 - limit.omega_body.norm() / spin;
    assert!(lost > 1e-4, "{lost:e}");
}
