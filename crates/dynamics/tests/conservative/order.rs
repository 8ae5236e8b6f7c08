//! Orders of convergence, and what the paper's scheme converges to.

use dynamics::{Initial, Method, Observation};
use nalgebra::Vector3;

use crate::common::{Specimen, plate};
use crate::run::{EXPONENTIAL, Error, RKMK4, Run, fitted_order};

/// Tumbling at 10 rad/s with vibration under a dead load.
fn tumbling(plate: &Specimen) -> Run<'_> {
    let initial = Initial {
        attitude: rigid_kin::Attitude::identity(),
        origin: None,
        velocity: Vector3::zeros(),
        omega: Vector3::new(5.0, 5.0, 7.0),
        modal_displacement: vec![0.1, 0.02, 0.02, 0.01],
        modal_velocity: vec![10.0, 5.0, -5.0, 3.0],
    };
    let loads = vec![plate.half_sine([-500.0, 0.0, 10.0], [20.0, 10.0, 30.0], 0.5)];
    Run { loads, ..Run::free(plate, initial, 0.2) }
}

/// Fitted orders in attitude and in the modal displacements.
fn fitted<const N: usize>(
    run: &Run,
    method: Method,
    steps: [f64; N],
    expected: &Observation,
) -> (f64, f64, [Error; N]) {
    let errors = steps.map(|step| Error::between(&run.end(method, step), expected));
    let (attitude, modal) = (errors.map(|e| e.attitude), errors.map(|e| e.modal));
    (fitted_order(steps, attitude), fitted_order(steps, modal), errors)
}

/// Conserved: order of convergence.
#[test]
fn each_scheme_has_its_order() {
    let plate = plate().truncated(4);
    let run = tumbling(&plate);
    let expected = run.end(EXPONENTIAL, 1.25e-5);
    for (method, steps, margin) in [
        // 4.02 and 3.99; 8.7e-13 rad and 3.7e-10 at 1e-4 s.
        (EXPONENTIAL, [8e-4, 4e-4, 2e-4, 1e-4], 0.2),
        // 3.89 and 4.02; 1.4e-9 rad and 8.3e-6 at 1e-4 s. Further up it nears its limit.
        (RKMK4, [1e-4, 8e-5, 5e-5, 4e-5], 0.2),
    ] {
        let (attitude, modal, errors) = fitted(&run, method, steps, &expected);
        for order in [attitude, modal] {
            assert!((order - f64::from(method.order)).abs() < margin, "{method:?}: {order} of {errors:?}");
        }
    }
}

/// Conserved: order of convergence.
#[test]
fn a_load_that_ends_between_the_steps_costs_no_order() {
    let plate = plate().truncated(4);
    let loads = vec![plate.half_sine([-500.0, 0.0, 10.0], [20.0, 10.0, 30.0], 0.073_217)];
    let run = Run { loads, damping_ratio: 0.05, ..tumbling(&plate) };
    let expected = run.end(EXPONENTIAL, 1.25e-5);
    for (method, steps, margin) in [
        (EXPONENTIAL, [8e-4, 4e-4, 2e-4, 1e-4], 0.2), // 4.02 and 4.12
        (RKMK4, [1e-4, 8e-5, 5e-5, 4e-5], 0.2),       // 3.91 and 3.99
    ] {
        let (attitude, modal, errors) = fitted(&run, method, steps, &expected);
        for order in [attitude, modal] {
            assert!((order - f64::from(method.order)).abs() < margin, "{method:?}: {order} of {errors:?}");
        }
    }
}

/// Conserved: order of convergence.
#[test]
fn the_limit_of_the_paper_s_scheme_is_met_with_fourth_order_and_by_the_paper_s_scheme_with_first() {
    let plate = plate().truncated(4);
    let run = tumbling(&plate);
    let limit = run.end(frames_rk4::LIMIT, 1.25e-5);
    let steps = [8e-4, 4e-4, 2e-4, 1e-4];

    let (attitude, modal, errors) = fitted(&run, frames_rk4::LIMIT, steps, &limit);
    // Attitude 4.8e-8, 2.0e-9, 9.5e-11, 4.9e-12 rad: order 4.4, since an error of fifth order outweighs that of fourth.
    // Modal displacements 3.8e-2, 2.2e-3, 1.3e-4, 8.2e-6: order 4.06.
    assert!((modal - 4.0).abs() < 0.2, "{modal} of {errors:?}");
    assert!(attitude > 3.8, "{attitude} of {errors:?}");

    let (attitude, _, errors) = fitted(&run, frames_rk4::PAPER, steps, &limit);
    // Attitude 5.3e-3, 2.6e-3, 1.3e-3, 6.6e-4 rad: order 0.997. Modal displacements 3.8e-2, 2.9e-3, 8.7e-4, 4.3e-4:
    // damping by RK4 first, then order 1.03.
    assert!((attitude - 1.0).abs() < 0.1, "{attitude} of {errors:?}");
    let modal = (errors[2].modal / errors[3].modal).log2();
    assert!((modal - 1.0).abs() < 0.1, "{modal} of {errors:?}");
}
