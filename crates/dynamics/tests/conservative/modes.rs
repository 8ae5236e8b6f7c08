//! Numbers of modes: the motion is that of the same body.

use dynamics::{Initial, Method, Rows, StepControl};
use nalgebra::Vector3;

use crate::common::{Specimen, plate_of};
use crate::run::{EXPONENTIAL, Run};

/// The first modal coordinate every 10 ms.
fn first_coordinate(run: &Run, method: Method, step: f64) -> Vec<f64> {
    let rows = run.start(method, StepControl::Fixed(step), Rows::Interval(0.01));
    rows.map(|row| row.unwrap().modal_displacement[0]).collect()
}

/// The plate under the pulse of 0.1 s.
fn pulsed(plate: &Specimen) -> Run<'_> {
    let force = Vector3::new(1.0, 0.0, 1.0).normalize() * 50.0;
    let loads = vec![plate.half_sine([-500.0, 0.0, 10.0], force.into(), 0.1)];
    Run { damping_ratio: 0.05, loads, ..Run::free(plate, Initial::at_rest(plate.body.flexible()), 1.0) }
}

/// The plate tumbling at 10 rad/s, vibrating in its first four modes by `part` of the table of errors.
fn tumbling(plate: &Specimen, part: f64) -> Run<'_> {
    let mut initial = Initial::at_rest(plate.body.flexible());
    initial.omega = Vector3::new(3.0, 8.0, 5.0);
    for (rate, of_table) in initial.modal_velocity.iter_mut().zip([77.0, -54.0, 117.0, 37.0]) {
        *rate = part * of_table;
    }
    Run::free(plate, initial, 1.0)
}

/// Conserved: ten modes move as forty.
#[test]
fn ten_modes_move_as_forty() {
    let forty = plate_of("plate", 40);
    let ten = forty.truncated(10);
    // Largest differences in the first modal coordinate, in parts of its peak.
    let difference = |a: &[f64], b: &[f64]| {
        let peak = b.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / peak
    };
    // Step, truncation, and the limit of the paper's scheme with ten modes:
    for (of_ten, of_forty, most, limit_is_off) in [
        (pulsed(&ten), pulsed(&forty), 1e-5, 1e-6), // 2.5e-12, 7.3e-7, 1.0e-5
        (tumbling(&ten, 0.1), tumbling(&forty, 0.1), 1.5e-4, 0.1), // 8.0e-8, 1.2e-4, 0.15
        (tumbling(&ten, 1.0), tumbling(&forty, 1.0), 3e-4, 0.1), // 7.4e-8, 2.0e-4, 0.24
    ] {
        let best = first_coordinate(&of_forty, EXPONENTIAL, 1e-4);
        let step_error = difference(&best, &first_coordinate(&of_forty, EXPONENTIAL, 5e-5));
        let truncation = difference(&first_coordinate(&of_ten, EXPONENTIAL, 1e-4), &best);
        let limit = difference(&first_coordinate(&of_ten, frames_rk4::LIMIT, 1e-4), &best);
        assert!(step_error < 0.1 * truncation, "{step_error:e} of {truncation:e}");
        assert!(truncation < most, "{truncation:e}");
        assert!(limit > limit_is_off, "{limit:e}");
    }
}
