//! A body is the same to the last bit, however many threads have made it.

use model::Builder;

use super::cache::{FORCE, built};
use crate::{CLAMPED, bar};

const TIME: &str = "end = 2e-4\nstep = 1e-5";

fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Conserved: the same bits on any number of threads.
#[test]
fn the_number_of_threads_changes_nothing() {
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
        let one = on(1, || built(&scene).0);
        for threads in [2, 32, 64] {
            assert!(on(threads, || built(&scene).0) == one, "{threads} threads: {modes} {rest}");
        }
    }
}

/// Nor a byte of a body file: the memory that the solution took, which goes with the threads, is not in it.
#[test]
fn body_files_of_all_numbers_of_threads_have_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let scene = bar("flexible = 20\nstatic_correction = true", FORCE, TIME);
    let bytes = |threads: usize| {
        let path = folder.path().join(format!("{threads}.h5"));
        on(threads, || Builder::default().write_body(&scene, &path, false, |_| ()).unwrap());
        std::fs::read(path).unwrap()
    };
    let one = bytes(1);
    for threads in [2, 32, 64] {
        assert!(bytes(threads) == one, "{threads} threads");
    }
}
