//! States that are saved, restored, and taken through bytes.

use flexframe_fmi::c_interface::{fmi2EnterInitializationMode, fmi2ExitInitializationMode};

use crate::importer::{Fmu, Instance};
use crate::scenes::{FREE, LARGE, driven, rigid, scene, scene_in_steps};

/// Goes some steps of unequal length, with inputs that jump, and gives all outputs at each point.
fn onward(fmu: &Fmu, instance: &mut Instance, from: f64) -> Vec<Vec<f64>> {
    let (references, _) = fmu.of_row();
    let mut time = from;
    [0.01, 0.013, 0.004, 0.02]
        .into_iter()
        .enumerate()
        .map(|(k, step)| {
            for (reference, _) in fmu.inputs().into_iter().step_by(2) {
                instance.set(&[reference], &[1.0 + k as f64]).unwrap();
            }
            instance.step(time, step).unwrap();
            time += step;
            instance.get(&references).unwrap()
        })
        .collect()
}

/// Conserved: the same bits after a state.
#[test]
fn after_a_state_all_goes_on_as_before_bit_for_bit() {
    let driven = driven("{ amplitude = 0.5, history = \"constant\" }");
    for scene in [scene(FREE), scene(LARGE), scene(&driven), scene_in_steps(FREE, "tolerance = 1e-5")] {
        let fmu = Fmu::of(&scene);
        let (references, _) = fmu.of_row();
        let mut instance = fmu.start();
        let inputs = fmu.inputs();
        inputs.iter().for_each(|(reference, _)| instance.set(&[*reference], &[0.7]).unwrap());
        instance.step(0.0, 0.03).unwrap();
        // An input that has been set belongs to the state.
        instance.set(&[inputs[0].0], &[1.5]).unwrap();
        let state = instance.save().unwrap();
        let at_state = instance.get(&references).unwrap();
        let first = onward(&fmu, &mut instance, 0.03);

        instance.restore(state).unwrap();
        assert_eq!(instance.time(), 0.03);
        assert_eq!(instance.get(&[inputs[0].0]).unwrap(), [1.5]);
        assert_eq!(instance.get(&references).unwrap(), at_state);
        assert!(onward(&fmu, &mut instance, 0.03) == first);

        // Through bytes into an instance that has only been made, and over an old state.
        let bytes = instance.serialized(state);
        let mut other = fmu.instantiate().unwrap();
        let same = other.deserialized(&bytes).unwrap();
        other.restore(same).unwrap();
        assert!(other.get(&references).unwrap() == at_state);
        assert!(onward(&fmu, &mut other, 0.03) == first);
        other.free(same);
        instance.free(state);
    }
}

#[test]
fn what_is_no_state_of_this_fmu_is_refused_and_changes_nothing() {
    let fmu = Fmu::of(&scene(FREE));
    let other_fmu = Fmu::of(&scene(LARGE));
    let mut instance = fmu.start();
    instance.step(0.0, 0.02).unwrap();
    let state = instance.save().unwrap();
    let bytes = instance.serialized(state);
    let (references, _) = fmu.of_row();
    let before = instance.get(&references).unwrap();
    for wrong in [&[][..], &bytes[..bytes.len() - 1], b"a state", &[0; 400]] {
        let said = instance.deserialized(wrong).unwrap_err();
        assert!(said.contains("no state of this FMU"), "{said}");
    }
    for place in (0..bytes.len()).step_by(97) {
        let mut changed = bytes.clone();
        changed[place] ^= 4;
        assert!(instance.deserialized(&changed).is_err());
    }
    let mut other = other_fmu.start();
    let foreign = other.deserialized(&bytes).unwrap();
    let said = other.restore(foreign).unwrap_err();
    assert!(said.contains("States are of one FMU"), "{said}");
    other.step(0.0, 0.02).unwrap();
    other.free(foreign);
    assert_eq!(instance.get(&references).unwrap(), before);
    instance.free(state);
}

/// A stop time and an input that were set before the beginning hold after a state was refused.
#[test]
fn a_state_that_is_refused_leaves_an_instance_that_has_not_begun_as_it_was_set_up() {
    let fmu = Fmu::of(&rigid());
    let mut other = fmu.start();
    let state = other.save().unwrap();
    let mut bytes = other.serialized(state);
    other.free(state);
    // The last number of the last input, before the two bytes that end the state of one body, is no number.
    let last = bytes.len() - 10..bytes.len() - 2;
    bytes[last].copy_from_slice(&f64::NAN.to_le_bytes());
    let sum = crc32fast::hash(&bytes[4..]).to_le_bytes();
    bytes[..4].copy_from_slice(&sum);

    let mut instance = fmu.instantiate().unwrap();
    let (factor, _) = fmu.inputs()[0];
    instance.set_up(0.0, Some(0.3)).unwrap();
    instance.set(&[factor], &[0.25]).unwrap();
    let state = instance.deserialized(&bytes).unwrap();
    let said = instance.restore(state).unwrap_err();
    assert!(said.contains("no state of this FMU"), "{said}");
    instance.free(state);
    instance.call(fmi2EnterInitializationMode).unwrap();
    assert_eq!(instance.get(&[factor]).unwrap(), [0.25]);
    instance.call(fmi2ExitInitializationMode).unwrap();
    // Beyond the end of the scene.
    instance.step(0.0, 0.3).unwrap();
}
