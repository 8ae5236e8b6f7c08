//! Energy over a long run with all that stresses a body, and large modes.

use nonlinear::cases;

/// Largest gap in the balance of energy over ten seconds of the soft rod, over the largest energy that moves in it.
fn gap(step: f64, end: f64) -> f64 {
    let text = format!(
        "[modes]\nflexible = 6\nlarge = 4\n\
         [[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\n\
         [[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9.81\n\
         [[loads]]\nkind = \"force\"\nat = [1.0, 0.0, 0.0]\ndirection = [1.0, 0.2, 0.1]\namplitude = 0.2\n\
         frame = \"material\"\nhistory = {{ kind = \"sine\", frequency = 1.0 }}\n\
         [[loads]]\nkind = \"pressure\"\ngroup = \"tip\"\namplitude = 200.0\n\
         [initial]\nangular_velocity = [0.0, 3.0, 0.0]\n\
         [effects]\nlarge_deflection = true\ngeometric_stiffening = true\nrefuse = false\n\
         [time]\nend = {end:e}\nstep = {step:e}\n"
    );
    let (scene, model) = cases::built("rod", 2e8, &text).unwrap();
    let rows = cases::rows(&scene, &model).unwrap();
    let balance = |i: usize| rows[i].energy_balance();
    let gap = (0..rows.len()).map(|i| (balance(i) - balance(0)).abs()).fold(0.0, f64::max);
    gap / rows.iter().map(|row| row.energy()).fold(0.0, f64::max)
}

#[test]
#[ignore = "a hundred thousand steps: just nonlinear"]
fn energy_is_kept_for_ten_seconds() {
    let found = gap(1e-4, 10.0);
    println!("{found:e}");
    assert!(found < 1e-9, "{found:e}");
}

#[test]
fn the_error_of_energy_is_of_fourth_order() {
    let [coarse, middle, fine] = [2e-3, 1e-3, 5e-4].map(|step| gap(step, 0.2));
    println!("{coarse:e} {middle:e} {fine:e}");
    // The order of each halving is 4 in the mean.
    assert!(coarse / fine > 12.0 * 12.0, "{coarse:e} {middle:e} {fine:e}");
}
