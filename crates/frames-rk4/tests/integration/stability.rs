//! RK4 on the modes: the limit 2.83/ω_max that steps are checked against is where the motion starts to grow.

use dynamics::{Initial, Physics, Rows, Setup, SetupError, Simulation, StepControl};

use crate::common::Synthesis as _;
use crate::common::{Specimen, advance, plate};

/// The refusal of a step of a millisecond.
fn refusal(specimen: &Specimen, damping_ratio: f64) -> SetupError {
    let nf = specimen.body.flexible();
    Simulation::new(&Setup {
        body: &specimen.body,
        damping_ratios: &vec![damping_ratio; nf],
        loads: &[],
        physics: &Physics::default(),
        initial: &Initial::at_rest(nf),
        method: &frames_rk4::Paper { reference_points: specimen.reference_points_body() },
        control: StepControl::Fixed(1e-3),
        end: 1.0,
        rows: Rows::EverySteps(1),
        points: &[],
    })
    .unwrap_err()
}

/// Closed form: √8/ω of the highest mode.
#[test]
fn a_millisecond_with_ten_modes_is_refused_by_mode_and_limit() {
    let error = refusal(plate(), 0.0);
    let SetupError::StepBeyondLimit { step, limit, mode, frequency } = error else { panic!("{error}") };
    assert_eq!((step, mode), (1e-3, 10));
    let omega = plate().body.circular_frequencies[9];
    assert!((limit * omega / 8.0_f64.sqrt() - 1.0).abs() < 1e-9, "{}", limit * omega);
    assert!((frequency - 582.0931).abs() < 1e-3, "{frequency}");
    let message = error.to_string();
    for part in ["1e-3", "7.73", "mode 10", "582.09"] {
        assert!(message.contains(part), "{message}");
    }
}

/// Amplitude of the tenth mode after many steps of a body at rest but for this mode, from an amplitude of one.
fn amplitude(damping_ratio: f64, step: f64, steps: usize) -> f64 {
    let mut initial = Initial::at_rest(10);
    initial.modal_displacement[9] = 1.0;
    let mut scheme = plate().scheme(damping_ratio, vec![], &initial, step);
    advance(&mut scheme, steps);
    let omega = plate().body.circular_frequencies[9];
    scheme.state().modal_displacement[15].hypot(scheme.state().modal_velocity[15] / omega)
}

/// Closed form: the polynomial of RK4.
#[test]
fn below_the_limit_the_mode_decays_and_does_so_as_the_polynomial_of_rk4_says() {
    for damping_ratio in [0.0, 0.05] {
        let SetupError::StepBeyondLimit { limit, .. } = refusal(plate(), damping_ratio) else { panic!() };
        let omega = plate().body.circular_frequencies[9];
        let growth = |step: f64| {
            // R(z) as a 2×2 matrix polynomial of H Δt, for the mode in (q, y/ω).
            let h = nalgebra::Matrix2::new(0.0, 1.0, -1.0, -2.0 * damping_ratio) * (omega * step);
            let r = nalgebra::Matrix2::identity() + h + h * h / 2.0 + h * h * h / 6.0 + h * h * h * h / 24.0;
            r.complex_eigenvalues().iter().map(|z| z.norm()).fold(0.0, f64::max)
        };
        // The limit is where the polynomial's amplification passes one.
        assert!(growth(0.999 * limit) < 1.0 && growth(1.001 * limit) > 1.0, "{limit}");
        let step = 0.99 * limit;
        let (first, second) = (amplitude(damping_ratio, step, 200), amplitude(damping_ratio, step, 400));
        let rate = (second / first).powf(1.0 / 200.0);
        // Measured: 2e-16 undamped; 1.7e-4 at 5 %, where the amplitude still swings with the phase.
        assert!((rate / growth(step) - 1.0).abs() < 1e-3, "{rate}");
    }
}
