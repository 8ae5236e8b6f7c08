//! A body is the same to the last bit, however many threads have made it.

use super::cache::{FORCE, built};
use super::{CLAMPED, bar};

#[test]
fn the_number_of_threads_changes_nothing() {
    const TIME: &str = "end = 2e-4\nstep = 1e-5";
    let spin = "[initial]\nangular_velocity = [3.0, 5.0, 400.0]\n";
    let two = "[[constraints]]\nkind = \"support\"\ndirections = [\"x\", \"y\", \"z\"]\ngroup = \"root\"\n\
               [[constraints]]\nkind = \"support\"\ndirections = [\"z\"]\nbox = [[200.0, -5.0, -5.0], [200.0, 5.0, 5.0]]\n";
    for (modes, rest) in [
        ("flexible = 12\nstatic_correction = true", format!("{spin}{FORCE}")),
        ("flexible = 6", format!("{CLAMPED}{FORCE}[effects]\ngeometric_stiffening = true\nrefuse = false\n")),
        ("flexible = 6\nlarge = 3", format!("{CLAMPED}{FORCE}[effects]\nlarge_deflection = true\nrefuse = false\n")),
        ("flexible = 6", format!("{two}{FORCE}")),
    ] {
        let scene = bar(modes, &rest, TIME);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| built(&scene).0)
        };
        let one = on(1);
        for threads in [2, 32, 64] {
            assert!(on(threads) == one, "{threads} threads: {modes} {rest}");
        }
    }
}
