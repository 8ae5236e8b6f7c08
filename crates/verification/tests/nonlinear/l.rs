//! The free L: legs of 1 and 0.6 m of square section.

use verification::nonlinear::{Solid, bodies, cases};

const MANIFOLD: &str =
    "static_correction = false\nlarge = [IN_PLANE]\n[effects]\nlarge_deflection = true\nrefuse = false";

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
fn the_static_energy_of_the_first_mode_is_that_of_the_whole_mesh() {
    let (_, model) = cases::the_l("static_correction = false\n[time]\nend = 1e-3\nstep = 1e-3").unwrap();
    let solid = Solid::new(bodies::mesh("l").unwrap(), bodies::SOFT, |_| false).unwrap();
    let peak = cases::peaks(&cases::shape(&model, 0), 2)[0];
    for part in [-0.06, -0.03, -0.01, 0.01, 0.03, 0.06] {
        let q = part / peak;
        let expected = cases::static_energy(&solid, &model, 0, q).unwrap();
        let (scene, bent) = cases::the_l(&format!(
            "static_correction = false\nlarge = [1]\n[effects]\nlarge_deflection = true\nrefuse = false\n\
             [initial]\nmodal_displacement = [{q:e}]\n[time]\nend = 1e-4\nstep = 1e-4"
        ))
        .unwrap();
        let omega = model.body.circular_frequencies[0];
        let found = cases::rows(&scene, &bent).unwrap()[0].strain_energy / (0.5 * (omega * q).powi(2)) - 1.0;
        println!("{part}: {found:.5}, nonlinear elements {expected:.5}");
        assert!((found / expected - 1.0).abs() < 0.03, "{part}: {found} instead of {expected}");
    }
}

/// Independent reference: the nonlinear finite elements of this crate.
#[test]
fn it_bends_as_the_whole_mesh_when_it_spins() {
    let (_, courses) = cases::spinning_l(0.1, 2.0, &[MANIFOLD]).unwrap();
    let off = courses[1].distance(&courses[0]) / courses[0].peak();
    println!("{off:e} of the peak");
    assert!(off < 0.01, "{off}");
}

/// Independent reference: the nonlinear finite elements of this crate, and those of the prototype.
#[test]
#[ignore = "a minute: just nonlinear"]
fn its_frequency_rises_with_the_spin() {
    let stiffened = "static_correction = false\n[effects]\nlarge_deflection = false\nrefuse = false";
    // What the prototype of the method had on another mesh, and the nonlinear elements there.
    let elsewhere = [[0.2835, 0.2823], [0.0337, 0.0334], [0.0084, 0.0084]];
    for ((part, tolerance), elsewhere) in [(0.3, 3e-3), (0.1, 1e-3), (0.05, 3e-4)].into_iter().zip(elsewhere) {
        let (omega, courses) = cases::spinning_l(part, 12.0, &[stiffened, MANIFOLD]).unwrap();
        let free = omega / std::f64::consts::TAU;
        let shift = |i: usize| {
            let step = (i == 0).then(|| courses[0].times[1]);
            cases::cycles(&courses[i], omega, step) - free
        };
        let off = |i: usize| courses[i].distance(&courses[0]) / courses[0].peak();
        println!(
            "{part}: nonlinear elements {:.5} Hz, stiffened {:.5} (off {:.1e} of the peak), manifold {:.5} ({:.1e})",
            shift(0),
            shift(1),
            off(1),
            shift(2),
            off(2)
        );
        assert!((shift(2) - shift(0)).abs() < tolerance, "{part}: {} instead of {}", shift(2), shift(0));
        let [ours, theirs] = [shift(2) / shift(0), elsewhere[0] / elsewhere[1]];
        assert!((ours - theirs).abs() < 0.015, "{part}: {ours} instead of {theirs} of that of nonlinear elements");
    }
}
