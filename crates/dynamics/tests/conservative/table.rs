//! The table of errors of the plate that tumbles at 10 rad/s with strong vibration.

use dynamics::{Initial, Method, Observation};
use nalgebra::Vector3;

use crate::common::plate_of;
use crate::run::{EXPONENTIAL, Error, RKMK4, Run, energy, relative_3};

/// Attitude and modal displacements against the reference; energy and angular momentum against the start.
fn errors(found: &Observation, expected: &Observation, start: &Observation) -> [f64; 4] {
    let error = Error::between(found, expected);
    let momentum = relative_3(&found.angular_momentum_global, &start.angular_momentum_global);
    [error.attitude, error.modal, (energy(found) / energy(start) - 1.0).abs(), momentum]
}

/// Independent reference: the table of errors of the prototype that was given with the project.
#[test]
fn errors_are_those_of_the_prototype() {
    let plate = plate_of("plate_lc12", 10);
    let mut initial = Initial::at_rest(10);
    initial.omega = Vector3::new(3.0, 8.0, 5.0);
    initial.velocity = Vector3::new(100.0, 0.0, 0.0);
    initial.modal_velocity[..4].copy_from_slice(&[77.0, -54.0, 117.0, 37.0]);
    let run = Run::free(&plate, initial, 1.0);
    let (start, reference) = (run.beginning(), run.end(EXPONENTIAL, 2.5e-5));
    let check = |method: Method, step: f64, table: &[f64]| {
        let found = errors(&run.end(method, step), &reference, &start);
        // Measured: between 0.5 and 1.15 of the table's.
        for (found, table) in found.iter().zip(table) {
            assert!(*found < 3.0 * table, "{method:?} {step:e}: {found:e}, the table has {table:e}");
        }
    };
    check(RKMK4, 5e-4, &[4.9e-5, 3.2e-2, 2e-3]); // 3.5e-5, 3.2e-2, 1.7e-3
    check(RKMK4, 2e-4, &[5.0e-6, 8.1e-4, 3e-5]); // 3.5e-6, 8.1e-4, 2.5e-5
    check(RKMK4, 1e-4, &[4.0e-7, 4.5e-4, 2e-6]); // 2.8e-7, 4.5e-4, 1.8e-6
    check(EXPONENTIAL, 5e-3, &[8.1e-3, 1.8e-1, 9e-4, 1e-3]); // 5.7e-3, 1.8e-1, 9.4e-4, 1.1e-3
    check(EXPONENTIAL, 2e-3, &[3.6e-4, 4.6e-3, 6e-5, 2e-5]); // 2.6e-4, 4.6e-3, 5.8e-5, 2.1e-5
    check(EXPONENTIAL, 1e-3, &[2.6e-5, 2.8e-4, 2e-6, 8e-7]); // 1.9e-5, 2.8e-4, 2.3e-6, 7.5e-7
    check(EXPONENTIAL, 5e-4, &[1.9e-6, 1.7e-5, 7e-8, 2e-8]); // 1.3e-6, 1.7e-5, 6.9e-8, 2.4e-8
    check(EXPONENTIAL, 2e-4, &[4.8e-8, 4.3e-7, 7e-10, 3e-10]); // 3.4e-8, 4.3e-7, 7.4e-10, 2.5e-10
    check(EXPONENTIAL, 1e-4, &[3.0e-9, 2.7e-8, 3e-11, 8e-12]); // 2.1e-9, 2.7e-8, 2.7e-11, 7.8e-12
}
