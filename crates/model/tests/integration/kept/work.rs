//! How much work of the mesh's size a body takes, so that it does not grow unseen.

use model::{BuildWork, Builder, Needs};

use crate::bar;

const SPIN: &str = "[initial]\nangular_velocity = [3.0, 5.0, 40.0]";

fn work(modes: &str, effects: &str) -> BuildWork {
    let scene = bar(modes, &format!("[effects]\n{effects}\n{SPIN}"), "end = 1e-4\nstep = 1e-5");
    let assembly = Builder::default().assemble(&scene, |_| ()).unwrap();
    let mut variants = assembly.variants().unwrap();
    variants.build(&scene, &Needs::default(), |_| ()).unwrap();
    variants.work()
}

#[test]
fn four_large_modes_and_the_stress_of_the_spin_take_so_much() {
    let none = "geometric_stiffening = false\nlarge_deflection = false\nrefuse = false";
    let plain = work("flexible = 10", none);
    assert_eq!(plain.element_passes, 0);
    let spin = "geometric_stiffening = true\ndeformed_inertia = true\nrefuse = false";
    let large = work("flexible = 10\nlarge = [1, 2, 3, 4]", &format!("{spin}\nlarge_deflection = true"));
    // The spin has its static responses in both. 28 products of two of the four large and three following modes, and 20 of
    // three large ones, take three solutions each (a plate takes two). Of the elements: the stiffness of the spin in the modes,
    // in the static shapes, and beside the large modes; what the large modes relieve of each other (two passes); the forces of
    // products of two and of three, and the energies.
    println!("{plain:?}, {large:?}");
    assert!(plain.columns > 0 && large.columns > plain.columns && large.element_passes > 0, "{plain:?}, {large:?}");
    assert!(large.columns - plain.columns <= 3 * 48, "{plain:?}, {large:?}");
    assert!(large.blocks - plain.blocks <= 12, "{plain:?}, {large:?}");
    assert!(large.element_passes <= 8, "{large:?}");
}
