//! The examples of library use, each held to its number.

#[path = "../../examples/bounce.rs"]
mod bounce;
#[path = "../../examples/controller.rs"]
mod controller;
#[path = "../../examples/own_integrator.rs"]
mod own_integrator;
#[path = "../../examples/own_matrices.rs"]
mod own_matrices;
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
