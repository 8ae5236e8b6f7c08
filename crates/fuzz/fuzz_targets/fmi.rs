//! The functions of FMI 2.0 in any order, with any arguments that a pointer does not make wrong: three bytes for each call.
#![no_main]

use std::ffi::CString;
use std::path::Path;
use std::ptr;
use std::sync::LazyLock;

use flexframe::fmu::{FmuSettings, marker, pack};
use flexframe::model::Builder;
use flexframe::scene::Scene;
use flexframe_fmi::c_interface::*;
use libfuzzer_sys::fuzz_target;

const SCENE: &str = r#"
title = "two"
units = { length = "m", mass = "kg", time = "s" }
[bodies.one]
rigid = { mass = 1.0, center_of_mass = [0.2, 0, 0], inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]] }
markers = { a = { at = [0, 0, 0] }, b = { at = [0.5, 0, 0] } }
[bodies.two]
rigid = { mass = 1.0, center_of_mass = [0.7, 0, 0], inertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]] }
markers = { a = { at = [0.5, 0, 0] } }
[[joints]]
name = "p"
kind = "revolute"
axis = [0, 1, 0]
between = ["ground", "one.a"]
[[joints]]
name = "q"
kind = "revolute"
axis = [0, 1, 0]
between = ["one.b", "two.a"]
[time]
end = 1.0
tolerance = 1e-4
"#;

/// The folder of an FMU, its GUID and the number of its variables.
static FMU: LazyLock<(tempfile::TempDir, String, u32)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    std::fs::write(place("library"), format!("{} fmi2DoStep", marker())).unwrap();
    let settings = FmuSettings { library: Some(place("library")) };
    let scene = Scene::parse(SCENE, "two.toml").unwrap();
    let report = pack(&scene, &Builder::default(), &place("two.fmu"), &settings, |_| ()).unwrap();
    let file = std::fs::File::open(place("two.fmu")).unwrap();
    zip::ZipArchive::new(file).unwrap().extract(folder.path()).unwrap();
    let description = std::fs::read_to_string(place("modelDescription.xml")).unwrap();
    let variables = description.matches("<ScalarVariable").count() as u32;
    (folder, report.guid, variables)
});

/// An instance, and the functions that live as long.
fn instance(folder: &Path, guid: &str) -> (fmi2Component, Box<fmi2CallbackFunctions>) {
    let functions = Box::new(fmi2CallbackFunctions {
        logger: None,
        allocateMemory: None,
        freeMemory: None,
        stepFinished: None,
        componentEnvironment: ptr::null_mut(),
    });
    let text = |text: &str| CString::new(text).unwrap();
    let (name, guid) = (text("two"), text(guid));
    let location = text(&format!("file://{}/resources", folder.display()));
    // SAFETY: all live until the call returns, the functions as long as the instance.
    let component = unsafe {
        fmi2Instantiate(name.as_ptr(), fmi2CoSimulation, guid.as_ptr(), location.as_ptr(), &*functions, 0, 0)
    };
    (component, functions)
}

const NUMBERS: [f64; 8] = [0.0, 1.0, -1.0, 1e-3, 0.01, f64::NAN, f64::INFINITY, 1e300];

fuzz_target!(|bytes: &[u8]| {
    let (folder, guid, variables) = &*FMU;
    let (c, _functions) = instance(folder.path(), guid);
    assert!(!c.is_null());
    let mut states: Vec<fmi2FMUstate> = Vec::new();
    let mut time = 0.0;
    for &[function, a, b] in bytes.as_chunks().0.iter().take(200) {
        let [x, y] = [a, b].map(|byte| NUMBERS[usize::from(byte) % NUMBERS.len()]);
        let reference = u32::from(a) % (variables + 1);
        let mut value = f64::NAN;
        // SAFETY: pointers to one value each, and states that are there.
        let status = unsafe {
            match function % 12 {
                0 => fmi2SetupExperiment(c, 0, x, y, i32::from(a > 128), x),
                1 => fmi2EnterInitializationMode(c),
                2 => fmi2ExitInitializationMode(c),
                3 => fmi2GetReal(c, &reference, 1, &mut value),
                4 => fmi2SetReal(c, &reference, 1, &y),
                5 | 6 => {
                    let step = if function % 12 == 5 { 0.01 } else { x };
                    let status = fmi2DoStep(c, if b > 200 { y } else { time }, step, 1);
                    time += if status == fmi2OK { step } else { 0.0 };
                    status
                }
                7 => {
                    let mut state = ptr::null_mut();
                    let status = fmi2GetFMUstate(c, &mut state);
                    states.extend((status == fmi2OK).then_some(state));
                    status
                }
                8 if !states.is_empty() => fmi2SetFMUstate(c, states[usize::from(a) % states.len()]),
                9 if !states.is_empty() => {
                    let mut state = states.swap_remove(usize::from(a) % states.len());
                    fmi2FreeFMUstate(c, &mut state)
                }
                10 if a > 200 => fmi2Terminate(c),
                11 if a > 200 => fmi2Reset(c),
                _ => fmi2OK,
            }
        };
        assert!([fmi2OK, fmi2Warning, fmi2Discard, fmi2Error].contains(&status));
        assert!(function % 12 != 3 || status != fmi2OK || value.is_finite());
    }
    // SAFETY: states and a component that nobody uses afterwards.
    unsafe {
        states.iter_mut().for_each(|state| _ = fmi2FreeFMUstate(c, state));
        fmi2FreeInstance(c);
    }
});
