//! Mistakes of an importing program: each is refused in words, and the FMU stays as it was.

use std::fs;

use flexframe::fmu::MANIFEST;
use flexframe_fmi::c_interface::{fmi2EnterInitializationMode, fmi2ExitInitializationMode, fmi2Reset, fmi2Terminate};

use crate::importer::{Fmu, instantiate, instantiate_at};
use crate::scenes::{FREE, rigid, scene, scene_in_steps};

fn says(said: &str, words: &[&str]) {
    words.iter().for_each(|words| assert!(said.contains(words), "{words:?} is not in: {said}"));
}

#[test]
fn an_fmu_that_is_not_whole_is_not_instantiated() {
    let fmu = Fmu::of(&scene(FREE));
    let resources = fmu.resources();
    let said = instantiate("{no}", &resources).err().unwrap();
    says(&said, &["the GUID {no} is not that of this FMU", &fmu.guid, "unpack the FMU again"]);
    for (location, words) in
        [("http://host/resources", "is no folder of this machine"), ("file:///nowhere", "unpack the whole FMU again")]
    {
        says(&instantiate_at(&fmu.guid, location).err().unwrap(), &[words]);
    }
    for name in ["body.h5", "scene.toml", MANIFEST] {
        let path = resources.join(name);
        let whole = fs::read(&path).unwrap();
        fs::remove_file(&path).unwrap();
        says(&instantiate(&fmu.guid, &resources).err().unwrap(), &[name, "unpack the whole FMU again"]);
        let mut damaged = whole.clone();
        let middle = damaged.len() / 2;
        damaged[middle] ^= 1;
        damaged.truncate(if name == "body.h5" { damaged.len() } else { middle });
        fs::write(&path, &damaged).unwrap();
        says(&instantiate(&fmu.guid, &resources).err().unwrap(), &[name, "changed or damaged"]);
        fs::write(&path, whole).unwrap();
    }
    let path = resources.join(MANIFEST);
    let other = fs::read_to_string(&path).unwrap().replace(env!("CARGO_PKG_VERSION"), "0.0.9");
    fs::write(&path, other).unwrap();
    says(&instantiate(&fmu.guid, &resources).err().unwrap(), &["those of flexframe 0.0.9", "pack it again"]);
}

#[test]
fn calls_come_in_their_order() {
    let fmu = Fmu::of(&rigid());
    let mut instance = fmu.instantiate().unwrap();
    says(&instance.save().unwrap_err(), &["fmi2GetFMUstate cannot be called before fmi2EnterInitializationMode"]);
    says(&instance.get(&[0]).unwrap_err(), &["fmi2GetReal cannot be called before"]);
    says(
        &instance.step(0.0, 0.02).unwrap_err(),
        &["fmi2DoStep cannot be called", "between fmi2ExitInitializationMode"],
    );
    says(&instance.call(fmi2ExitInitializationMode).unwrap_err(), &["after fmi2EnterInitializationMode"]);
    says(&instance.set_up(1.0, None).unwrap_err(), &["the start time is 1", "begins at time 0"]);
    for stop in [0.0, -1.0, f64::NAN] {
        says(&instance.set_up(0.0, Some(stop)).unwrap_err(), &["the stop time is"]);
    }
    instance.begin().unwrap();
    says(&instance.set_up(0.0, None).unwrap_err(), &["fmi2SetupExperiment cannot be called after"]);
    says(&instance.call(fmi2EnterInitializationMode).unwrap_err(), &["once, after fmi2SetupExperiment"]);
    instance.step(0.0, 0.02).unwrap();
    instance.call(fmi2Terminate).unwrap();
    says(&instance.step(0.02, 0.02).unwrap_err(), &["after fmi2Terminate"]);
    instance.get(&[0]).unwrap();
    // A reset instance is as new.
    instance.call(fmi2Reset).unwrap();
    instance.begin().unwrap();
    instance.step(0.0, 0.02).unwrap();
}

#[test]
fn what_is_no_input_is_not_set_and_no_input_is_set_in_part() {
    let fmu = Fmu::of(&scene(FREE));
    let mut instance = fmu.start();
    let [force, output, local] =
        ["points.tip.force[1]", "points.tip.velocity[1]", "energy.kinetic"].map(|n| fmu.reference(n));
    let last = fmu.variables.len() as u32;
    for (reference, words) in [
        (0, "time cannot be set: it is the time"),
        (output, "points.tip.velocity[1] cannot be set: it is an output"),
        (local, "energy.kinetic cannot be set: it is a variable to look at"),
        (last, "is none of this FMU, which has 0 to"),
    ] {
        says(&instance.set(&[force, reference], &[1.0, 1.0]).unwrap_err(), &[words]);
    }
    for value in [f64::NAN, f64::INFINITY] {
        let second = fmu.reference("points.tip.force[2]");
        let said = instance.set(&[force, second], &[1.0, value]).unwrap_err();
        says(&said, &["points.tip.force[2] cannot be", "give a finite number"]);
    }
    assert_eq!(instance.get(&[force]).unwrap(), [0.0]);
    says(&instance.get(&[last]).unwrap_err(), &["is none of this FMU"]);
    for said in instance.refusals() {
        assert!(said.len() > 20, "{said}");
    }
    instance.step(0.0, 0.02).unwrap();
}

#[test]
fn steps_go_forward_from_where_the_fmu_is() {
    let fmu = Fmu::of(&rigid());
    let mut instance = fmu.start();
    for step in [0.0, -0.01, f64::NAN, f64::INFINITY, 1e-20] {
        says(&instance.step(0.0, step).unwrap_err(), &["the communication step is", "forward in time"]);
    }
    for point in [0.02, -0.01, f64::NAN] {
        says(&instance.step(point, 0.02).unwrap_err(), &["the communication point is", "the FMU is at time 0"]);
    }
    says(&instance.step(0.0, 0.21).unwrap_err(), &["beyond the end", "a longer stop time"]);
    instance.step(0.0, 0.2).unwrap();
    says(&instance.step(0.2, 0.02).unwrap_err(), &["beyond the end"]);
    // A longer experiment goes further.
    instance.call(fmi2Reset).unwrap();
    instance.set_up(0.0, Some(0.3)).unwrap();
    instance.call(fmi2EnterInitializationMode).unwrap();
    instance.call(fmi2ExitInitializationMode).unwrap();
    instance.step(0.0, 0.2).unwrap();
    instance.step(0.2, 0.1).unwrap();
    assert!((instance.time() - 0.3).abs() < 1e-15);
}

/// Conserved: the same run without the step that fails: a force that no step can follow; the step fails in the words
/// of the program, and what was before is still there.
#[test]
fn after_a_step_that_fails_the_fmu_can_go_on() {
    let rigid_spin = rigid();
    for (fmu, name, huge, step) in [
        (Fmu::of(&rigid_spin), "points.top.moment[3]", 1e12, 0.02),
        (Fmu::of(&scene_in_steps(FREE, "tolerance = 1e-6")), "points.tip.moment[1]", 1e30, 0.02),
        (Fmu::of(&scene(FREE)), "points.tip.force[2]", 1e9, 0.02),
    ] {
        let (references, _) = fmu.of_row();
        let mut calm = fmu.start();
        let mut instance = fmu.start();
        let force = [fmu.reference(name)];
        for k in 0..2 {
            let time = f64::from(k) * step;
            let before = instance.get(&references).unwrap();
            instance.set(&force, &[huge]).unwrap();
            let said = instance.step(time, step).unwrap_err();
            says(&said, &["the step failed: ", "The FMU stays at time", "other inputs may be set"]);
            assert!((instance.time() - time).abs() < 1e-15);
            instance.set(&force, &[0.0]).unwrap();
            assert_eq!(instance.get(&references).unwrap(), before);
            instance.step(time, step).unwrap();
            calm.step(time, step).unwrap();
            assert_eq!(instance.get(&references).unwrap(), calm.get(&references).unwrap());
        }
    }
}
