//! The examples of library use, each held to its number.

#[path = "../../examples/bounce.rs"]
mod bounce;
#[path = "../../examples/controller.rs"]
mod controller;
#[path = "../../examples/own_integrator.rs"]
mod own_integrator;
#[path = "../../examples/own_matrices.rs"]
mod own_matrices;
#[path = "../../examples/robot_arm_pd.rs"]
mod robot_arm_pd;
#[path = "../../examples/spring_to_ground.rs"]
mod spring_to_ground;

/// Conserved: energy less the work of the controller.
#[test]
fn a_controller_from_outside_damps_the_plate_and_its_work_is_accounted_for() {
    let controller::Answer { strain_energy_left, balance } = controller::run().unwrap();
    println!("{strain_energy_left} {balance:e}");
    assert!((0.01..0.9).contains(&strain_energy_left), "{strain_energy_left}");
    assert!(balance < 1e-9, "{balance:e}");
}

/// Closed form: free fall, √(2h/g).
#[test]
fn an_event_is_found_to_the_accuracy_of_the_scheme_and_a_new_state_goes_on() {
    let bounce::Answer { impact, back } = bounce::run().unwrap();
    println!("{impact:?} {back:?}");
    for [found, exact] in [impact, back] {
        assert!((found - exact).abs() < 1e-12, "{found} {exact}");
    }
}

/// Conserved: second order, against the exponential scheme.
#[test]
fn an_own_scheme_has_its_order_and_takes_step_control() {
    let [coarse, fine, controlled] = own_integrator::run().unwrap();
    println!("{coarse:e} {fine:e} {controlled:e}");
    assert!(controlled < 1e-6, "{controlled:e}");
    assert!(fine < 1e-3 && (coarse / fine - 4.0).abs() < 0.4, "{coarse:e} {fine:e}");
}

/// Closed form: frequencies of a free beam, cos β cosh β = 1; energy and momentum stay.
#[test]
fn a_beam_from_its_own_matrices_has_its_frequencies_and_tumbles_without_loss() {
    let own_matrices::Answer { frequencies, energy, angular_momentum, against_rigid } = own_matrices::run().unwrap();
    println!("{frequencies:?} {energy:e} {angular_momentum:e} {against_rigid:e}");
    // Those of the second pair are 3.9e-5 above.
    assert!(frequencies.iter().all(|ratio| (1.0..1.0001).contains(ratio)), "{frequencies:?}");
    // 2.0e-11 and 1.6e-12
    assert!(energy < 1e-10 && angular_momentum < 1e-11, "{energy:e} {angular_momentum:e}");
    assert!(against_rigid > 1e-2, "{against_rigid:e}");
}

/// Closed form: a period of 2π√(m/k), and T/(mΩ²) (1 − cos Ωt) across the spin.
#[test]
fn laws_as_closures_have_their_closed_forms() {
    let spring_to_ground::Answer { after_a_period, energy, circled } = spring_to_ground::run().unwrap();
    println!("{after_a_period} {energy} {circled:?}");
    assert!((after_a_period - 1.0).abs() < 1e-9 && (energy - 1.0).abs() < 1e-9, "{after_a_period} {energy}");
    assert!((circled[0] - circled[1]).abs() < 1e-10, "{circled:?}");
}

/// Independent reference: Lagrange's equations of the two links, which stand at the head of the example, in 20 000 steps of RK4.
#[test]
fn a_robot_arm_under_controllers_moves_by_lagranges_equations() {
    use robot_arm_pd::{ARRIVAL, END, GAINS, INERTIA, LENGTH, MASS, TARGETS, path};

    // Angles of the links against the horizontal and their rates; the sine of the elbow is that of their difference.
    let rates = |time: f64, [first, second, first_rate, second_rate]: [f64; 4]| {
        let torque = |joint: usize, angle: f64, rate: f64| {
            let ([proportional, derivative], [wanted, wanted_rate]) = (GAINS[joint], path(TARGETS[joint], time));
            proportional * (wanted - angle) + derivative * (wanted_rate - rate)
        };
        let (shoulder, elbow) = (torque(0, first, first_rate), torque(1, second - first, second_rate - first_rate));
        let square = MASS * LENGTH * LENGTH;
        let (weight, bend) = (MASS * 9.81 * LENGTH, second - first);
        let (m11, m22, m12) = (INERTIA + 1.25 * square, INERTIA + 0.25 * square, 0.5 * square * bend.cos());
        let right = [
            shoulder - elbow + 0.5 * square * bend.sin() * second_rate.powi(2) - 1.5 * weight * first.cos(),
            elbow - 0.5 * square * bend.sin() * first_rate.powi(2) - 0.5 * weight * second.cos(),
        ];
        let determinant = m11 * m22 - m12 * m12;
        let accelerations = [m22 * right[0] - m12 * right[1], m11 * right[1] - m12 * right[0]];
        [first_rate, second_rate, accelerations[0] / determinant, accelerations[1] / determinant]
    };
    let robot_arm_pd::Answer { rows, open, steps } = robot_arm_pd::run().unwrap();
    assert!((rows.len(), rows[20].time) == (21, END) && ARRIVAL < END);
    let (mut state, h) = ([0.0; 4], END / 20_000.0);
    let mut worst = 0.0_f64;
    for k in 0..=20_000_u32 {
        if k % 1000 == 0 {
            let row = &rows[k as usize / 1000];
            let [first, second, first_rate, second_rate] = state;
            let expected = [first, second - first, first_rate, second_rate - first_rate];
            let found = [row.angles, row.rates].concat();
            worst = found.iter().zip(expected).fold(worst, |worst, (a, b)| worst.max((a - b).abs()));
        }
        let time = f64::from(k) * h;
        let add = |slope: [f64; 4], by: f64| -> [f64; 4] { std::array::from_fn(|i| state[i] + by * slope[i]) };
        let one = rates(time, state);
        let two = rates(time + 0.5 * h, add(one, 0.5 * h));
        let three = rates(time + 0.5 * h, add(two, 0.5 * h));
        let four = rates(time + h, add(three, h));
        state = std::array::from_fn(|i| state[i] + h / 6.0 * (one[i] + 2.0 * two[i] + 2.0 * three[i] + four[i]));
    }
    println!("{worst:e} off, energy open by {open:e}, {steps} steps");
    // 1e-6 rad and rad/s
    assert!(worst < 1e-6 && open < 1e-6, "{worst:e} {open:e}");
    // The arm arrives, but for what its weight asks of the springs.
    assert!((rows[20].angles[0] - TARGETS[0]).abs() < 0.1, "{:?}", rows[20].angles);
}
