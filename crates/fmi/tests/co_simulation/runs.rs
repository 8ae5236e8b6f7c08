//! Runs of an FMU against runs of the library without one.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use flexframe::dynamics::{LoadFn, Rows, Setup, SharedLoad, Simulation};
use flexframe::fmu::{FmuModel, Source};
use flexframe::model::Builder;
use flexframe::nalgebra::Vector3;
use flexframe::scene::Body;
use flexframe_fmi::c_interface::{fmi2EnterInitializationMode, fmi2ExitInitializationMode};

use crate::importer::{Fmu, Instance};
use crate::scenes::{END, FREE, LARGE, STEP, bodies, driven, own_run, rigid, scene, scene_in_steps};

/// All that is to agree does so to this part of the largest number of its kind.
const SAME: f64 = 1e-10;

/// A run of the FMU in equal communication steps, seconds: at each point `control` sets inputs.
fn run(fmu: &Fmu, count: usize, step: f64, mut control: impl FnMut(&mut Instance, f64)) -> Vec<Vec<f64>> {
    let (references, _) = fmu.of_row();
    let mut instance = fmu.start();
    let mut rows = Vec::new();
    for k in 0..=count {
        rows.push(instance.get(&references).unwrap());
        if k < count {
            let time = k as f64 * step;
            control(&mut instance, time);
            instance.step(time, step).unwrap();
        }
    }
    rows
}

/// Compares the variables of a run with rows, but for those that follow inputs at once where these jump.
fn compare(fmu: &Fmu, rows: &[Vec<f64>], expected: &[Vec<f64>], inputs_jump: bool) {
    assert_eq!(rows.len(), expected.len());
    let (references, places) = fmu.of_row();
    let group = |reference: u32| {
        let name = &fmu.variables[reference as usize].name;
        // What is left of a balance is compared with what it is of.
        let kind = if name.contains("energy.") { "energy" } else { name.split('[').next().unwrap() };
        kind.trim_end_matches("_balance").to_owned()
    };
    let mut worst: HashMap<String, [f64; 2]> = HashMap::new();
    for (i, (reference, place)) in references.iter().zip(&places).enumerate() {
        if inputs_jump && matches!(fmu.variables[*reference as usize].source, Source::Row { is_direct: true, .. }) {
            continue;
        }
        let [off, scale] = worst.entry(group(*reference)).or_insert([0.0; 2]);
        for (row, expected) in rows.iter().zip(expected) {
            *off = off.max((row[i] - expected[*place]).abs());
            *scale = scale.max(expected[*place].abs());
        }
    }
    assert!(worst.len() > 10);
    for (name, [off, scale]) in worst {
        assert!(off <= SAME * scale, "{name}: off by {off:e} of {scale:e}");
    }
}

/// Conserved: the same numbers as a run of the library without an FMU.
#[test]
fn a_run_is_that_of_the_program() {
    let of_table = "{ amplitude = 1.0, history = { kind = \"half-sine\", duration = 0.4 } }";
    for body in [scene(FREE), scene(LARGE), scene(&driven(of_table)), rigid()] {
        let fmu = Fmu::of(&body);
        let seconds = if body.units.time == "ms" { 1e-3 } else { 1.0 };
        let rows = run(&fmu, 10, body.time.end / 10.0 * seconds, |_, _| ());
        compare(&fmu, &rows, &own_run(&body), false);
    }
}

/// Conserved: the same numbers as a run of the library with the damper inside. Outside, it takes the velocity of the
/// tip at each communication point, and holds its force until the next.
#[test]
fn a_controller_outside_is_the_same_controller_inside() {
    const GAIN: f64 = 15.0;
    let (count, step) = (50, 2.0 * STEP);
    let body = scene(FREE);
    let fmu = Fmu::of(&body);
    let along = |what: &str| [1, 2, 3].map(|i| fmu.reference(&format!("points.tip.{what}[{i}]")));
    let (velocity, force) = (along("velocity"), along("force"));
    let rows = run(&fmu, count, step, |instance, _| {
        let held: Vec<f64> = instance.get(&velocity).unwrap().iter().map(|v| -GAIN * v).collect();
        instance.set(&force, &held).unwrap();
    });

    let fmu_model = FmuModel::new(body.clone().into(), &Builder::default(), |_| ()).unwrap();
    assert_eq!(fmu_model.scene, body.clone().into(), "needs are no edits of the scene");
    let (model, tip) = (&fmu_model.bodies[0].model, 1);
    assert_eq!(model.points[tip].0, "tip");
    let held = Arc::new(Mutex::new(Vector3::zeros()));
    let (point, force) = (model.points[tip].1.clone(), Arc::clone(&held));
    let damper: SharedLoad = Arc::new(LoadFn::new("damper", move |motion, applied| {
        applied.force(&point, &(motion.body_from_global * *force.lock().unwrap()));
    }));
    let loads: Vec<SharedLoad> = model.loads().iter().cloned().chain([damper]).collect();
    let points: Vec<_> = model.points.iter().map(|(_, point)| point.clone()).collect();
    let initial = model.initial(&body);
    let rows_at = Rows::Interval(step);
    let setup = Setup { loads: &loads, points: &points, rows: rows_at, ..model.setup(&body, &initial) };
    let mut simulation = Simulation::new(&setup).unwrap();
    let place = |name: &str| fmu.of_row().0.iter().position(|reference| *reference == fmu.reference(name)).unwrap();
    let tip_y = place("points.tip.displacement[2]");
    let strain = place("energy.strain");
    let mut freely = 0.0f64;
    for row in &rows {
        let now = simulation.next().unwrap().unwrap();
        let (found, expected) = (row[tip_y], now.points[tip].displacement.y);
        assert!((found - expected).abs() < SAME, "{found} {expected}");
        assert!((row[strain] - now.strain_energy).abs() < SAME * (1.0 + now.strain_energy));
        *held.lock().unwrap() = now.points[tip].velocity * -GAIN;
        freely = freely.max(row[strain]);
    }
    // It does something: without it, the motion is another.
    let alone = own_run(&body);
    let (last, at) = (rows.last().unwrap()[tip_y], fmu.of_row().1[tip_y]);
    assert!((last - alone.last().unwrap()[at]).abs() > 1e-2);
}

/// Conserved: the same numbers as a run of the library. Forces, moments and factors from outside are those of loads
/// that the scene has.
#[test]
fn inputs_are_the_loads_of_a_scene() {
    let load = |kind: &str, direction: &str, amplitude: f64, history: &str| {
        let at = "at = [8.0, 0.0, 0.0]";
        format!(
            "[[loads]]\nkind = \"{kind}\"\n{at}\ndirection = {direction}\namplitude = {amplitude}\nhistory = {history}\n"
        )
    };
    let effects =
        "[effects]\ngeometric_stiffening = false\ncoriolis = true\ndeformed_inertia = true\nlarge_deflection = false\n";
    let gravity = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9.81\n";
    // From half of the run on there is a force, a moment that was there before is gone, and gravity is doubled.
    let half = END / 2.0;
    let step = format!("{{ kind = \"step\", at = {half} }}");
    let expected = scene(
        &[
            effects,
            gravity,
            &gravity.replace("9.81", &format!("9.81\nhistory = {step}")),
            &load("force", "[1.0, 2.0, 2.0]", 30.0, &step),
            &load("moment", "[0.0, 1.0, 0.0]", 40.0, "\"constant\""),
            &load("moment", "[0.0, 1.0, 0.0]", -40.0, &step),
        ]
        .concat(),
    );
    let fmu = Fmu::of(&scene(&[effects, gravity].concat()));
    let reference = |name: &str| fmu.reference(name);
    let rows = run(&fmu, 10, END / 10.0, |instance, time| {
        let later = f64::from(u8::from(time > half - STEP));
        let factor = reference("loads[1].factor");
        instance.set(&[factor], &[1.0 + later]).unwrap();
        let force = [1, 2, 3].map(|i| reference(&format!("points.tip.force[{i}]")));
        instance.set(&force, &[10.0 * later, 20.0 * later, 20.0 * later]).unwrap();
        instance.set(&[reference("points.tip.moment[2]")], &[40.0 * (1.0 - later)]).unwrap();
        assert_eq!(instance.get(&[factor]).unwrap(), [1.0 + later]);
    });
    compare(&fmu, &rows, &own_run(&expected), true);
}

/// Conserved: the same numbers as a run of the library. A drive whose acceleration is held is one whose speed is a
/// table.
#[test]
fn a_drive_is_steered_by_its_acceleration() {
    let accelerations = [4.0, -2.0, 0.0, 9.0, 1.0, -7.0, 0.0, 0.0, 3.0, 2.0];
    let step = END / accelerations.len() as f64;
    let (mut speed, mut points) = (0.5, vec![[0.0, 0.5]]);
    for (k, acceleration) in accelerations.iter().enumerate() {
        speed += acceleration * step;
        points.push([(k + 1) as f64 * step, speed]);
    }
    let table = format!("{{ amplitude = 1.0, history = {{ kind = \"table\", points = {points:?} }} }}");
    let fmu = Fmu::of(&scene(&driven("{ amplitude = 0.5, history = \"constant\" }")));
    let mut next = accelerations.iter();
    let rows = run(&fmu, accelerations.len(), step, |instance, _| {
        instance.set(&[fmu.reference("drive.acceleration")], &[*next.next().unwrap()]).unwrap();
    });
    compare(&fmu, &rows, &own_run(&scene(&driven(&table))), true);
}

/// Conserved: order 4. Between communication points the scheme keeps it, whatever steps they are apart, fixed or
/// under control.
#[test]
fn held_inputs_cost_no_order() {
    let end = |step: &str| -> Vec<f64> {
        let fmu = Fmu::of(&scene_in_steps(FREE, step));
        let force = [1, 2, 3].map(|i| fmu.reference(&format!("points.tip.force[{i}]")));
        let moved = [1, 2, 3].map(|i| fmu.reference(&format!("points.tip.displacement[{i}]")));
        let mut instance = fmu.start();
        // The steps do not divide these.
        for k in 0..9 {
            instance.set(&force, &[0.0, 100.0 * (k % 3) as f64, -50.0 * (k % 2) as f64]).unwrap();
            instance.step(k as f64 * 0.021, 0.021).unwrap();
        }
        instance.get(&moved).unwrap()
    };
    let exact = end("step = 2e-4");
    let off = |step: &str| -> f64 { end(step).iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt() };
    // Steps of a 4th and a 9th of 21 ms.
    let order = (off("step = 6e-3") / off("step = 2.4e-3")).ln() / (9.0f64 / 4.0).ln();
    assert!((3.6..4.6).contains(&order), "{order}");
    let controlled = off("tolerance = 1e-7");
    assert!(controlled < 1e-6, "{controlled}");
}

/// Conserved: the same numbers alone and beside another.
#[test]
fn two_instances_know_nothing_of_each_other() {
    let fmu = Fmu::of(&scene(FREE));
    let (references, _) = fmu.of_row();
    let force = [fmu.reference("points.tip.force[2]")];
    let alone = run(&fmu, 5, 0.02, |_, _| ());
    let [mut one, mut other] = [fmu.start(), fmu.start()];
    for k in 0..5 {
        other.set(&force, &[1e3]).unwrap();
        one.step(f64::from(k) * 0.02, 0.02).unwrap();
        other.step(f64::from(k) * 0.02, 0.02).unwrap();
        assert_eq!(one.get(&references).unwrap(), alone[k as usize + 1]);
    }
    assert!(other.get(&references).unwrap() != one.get(&references).unwrap());
}

/// Outputs that `modelDescription.xml` says to follow the inputs at once do so, and nothing else.
#[test]
fn outputs_depend_on_inputs_as_described() {
    let mut found = [false; 2];
    for body in [scene(FREE), scene(LARGE), scene(&driven("{ amplitude = 0.5, history = \"constant\" }"))] {
        let fmu = Fmu::of(&body);
        let (references, _) = fmu.of_row();
        let mut instance = fmu.instantiate().unwrap();
        instance.set_up(0.0, None).unwrap();
        instance.call(fmi2EnterInitializationMode).unwrap();
        let before = instance.get(&references).unwrap();
        let (inputs, _): (Vec<u32>, Vec<_>) = fmu.inputs().into_iter().unzip();
        instance.set(&inputs, &vec![3.0; inputs.len()]).unwrap();
        let after = instance.get(&references).unwrap();
        for (i, reference) in references.iter().enumerate() {
            let variable = &fmu.variables[*reference as usize];
            let Source::Row { is_direct, is_output, .. } = variable.source else { unreachable!() };
            let index = format!("<Unknown index=\"{}\"", reference + 1);
            let expected = if is_direct { format!("{index}/>") } else { format!("{index} dependencies=\"\"/>") };
            let times = fmu.description.matches(&expected).count();
            assert_eq!(times, if is_output { 2 } else { 0 }, "{}", variable.name);
            if !is_direct {
                assert_eq!(before[i], after[i], "{}", variable.name);
            } else if before[i] != after[i] {
                found[usize::from(variable.name.starts_with("reaction"))] = true;
            }
        }
        instance.call(fmi2ExitInitializationMode).unwrap();
        instance.step(0.0, 0.02).unwrap();
    }
    assert_eq!(found, [true; 2]);
}

/// FMI counts time in seconds, the scene in milliseconds; other units are described by their powers of SI.
#[test]
fn time_is_in_seconds_and_units_are_described() {
    let body: Body = rigid();
    let fmu = Fmu::of(&body);
    let mut instance = fmu.start();
    instance.step(0.0, 0.02).unwrap();
    assert_eq!(instance.time(), 0.02);
    assert_eq!(instance.get(&[fmu.reference("time")]).unwrap(), [0.02]);
    let plain: String = fmu.description.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "<DefaultExperiment startTime=\"0\" stopTime=\"0.2\" stepSize=\"0.02\"/>",
        "<Unit name=\"s\"> <BaseUnit s=\"1\"/> </Unit>",
        "<Unit name=\"mm/ms\"> <BaseUnit m=\"1\" s=\"-1\"/> </Unit>",
        "<Unit name=\"Mg.mm/ms2\"> <BaseUnit kg=\"1\" m=\"1\" s=\"-2\" factor=\"1e6\"/> </Unit>",
        "causality=\"input\" variability=\"continuous\"> <Real start=\"1\"/>",
        "variableNamingConvention=\"structured\"",
    ] {
        assert!(plain.contains(part), "{part}\n{}", fmu.description);
    }
}

/// Each as in an FMU of its own, bit for bit, under a force on one of them; and again from a state that was saved.
#[test]
fn the_bodies_of_a_scene_are_one_fmu_and_know_nothing_of_each_other() {
    let scenes = bodies();
    let (both, count, step) = (Fmu::of_bodies(&scenes), 20, 2.0 * STEP);
    let number = |fmu: &Fmu, instance: &mut Instance, name: &str| instance.get(&[fmu.reference(name)]).unwrap()[0];
    let force = both.reference("beam.points.tip.force[2]");
    let follow = |instance: &mut Instance, from: usize| -> Vec<[f64; 3]> {
        let names = ["beam.points.tip.displacement[2]", "'the top'.attitude[2]", "system.energy.total"];
        let row = |i: usize, instance: &mut Instance| {
            instance.step(i as f64 * step, step).unwrap();
            names.map(|name| number(&both, instance, name))
        };
        (from..count).map(|i| row(i, instance)).collect()
    };
    let mut instance = both.start();
    instance.set(&[force], &[3.0]).unwrap();
    let rows = follow(&mut instance, 0);
    for (i, (body, of_body)) in scenes.iter().zip(["points.tip.displacement[2]", "attitude[2]"]).enumerate() {
        let alone = Fmu::of(&flexframe::scene::Body { name: None, ..body.clone() });
        let mut of_alone = alone.start();
        if i == 0 {
            of_alone.set(&[alone.reference("points.tip.force[2]")], &[3.0]).unwrap();
        }
        for (k, row) in rows.iter().enumerate() {
            of_alone.step(k as f64 * step, step).unwrap();
            assert_eq!(row[i].to_bits(), number(&alone, &mut of_alone, of_body).to_bits(), "{of_body} in row {k}");
        }
    }
    // Back to the middle, and on.
    let mut instance = both.start();
    instance.set(&[force], &[3.0]).unwrap();
    (0..count / 2).for_each(|i| instance.step(i as f64 * step, step).unwrap());
    let state = instance.save().unwrap();
    let first = follow(&mut instance, count / 2);
    instance.restore(state).unwrap();
    assert_eq!(first, rows[count / 2..]);
    assert_eq!(follow(&mut instance, count / 2), first);
    instance.free(state);
}

/// Closed form: a rotor on a hinge with a spring, J a'' = M − k a, whose motor gets a moment at 0.2 s and loses it at 0.5 s.
#[test]
fn bodies_in_joints_are_an_fmu_whose_motors_are_inputs() {
    let text = r#"
title = "rotor"
units = { length = "m", mass = "kg", time = "s" }
[bodies.rotor]
rigid = { mass = 1.0, center_of_mass = [0, 0, 0], inertia = [[1.0, 0, 0], [0, 1.5, 0], [0, 0, 0.5]] }
markers = { axle = { at = [0, 0, 0] } }
modes = { flexible = 0 }
[[joints]]
name = "axle"
kind = "revolute"
between = ["ground", "rotor.axle"]
axis = [0, 0, 1]
spring = { stiffness = 8.0 }
[ground.markers.wall]
at = [0, 0, 2]
[[springs]]
name = "wire"
between = ["ground.wall", "rotor.axle"]
stiffness = 3.0
free_length = 1.5
[[bushings]]
name = "pad"
between = ["ground", "rotor.axle"]
damping = { translation = [1.0, 1.0, 1.0] }
[time]
end = 1.0
tolerance = 1e-8
"#;
    let scene = flexframe::scene::Scene::parse(text, "rotor.toml").unwrap();
    let fmu = Fmu::of_system(&scene);
    let motor = fmu.reference("joints.axle.motor.torque");
    let of_springs = ["joints.wire.length", "joints.wire.pull", "joints.wire.force[3]", "joints.pad.force[3]"];
    let of_springs = of_springs.map(|name| fmu.reference(name));
    let seen = ["joints.axle.angle", "joints.axle.rate", "joints.axle.torque", "joints.axle.drive_work"];
    let seen = seen.map(|name| fmu.reference(name));
    let (moment, stiffness, inertia) = (0.6, 8.0, 0.5);
    let omega = f64::sqrt(stiffness / inertia);
    let angle = |time: f64| {
        let since =
            |from: f64| if time > from { moment / stiffness * (1.0 - (omega * (time - from)).cos()) } else { 0.0 };
        since(0.2) - since(0.5)
    };
    let follow = |instance: &mut Instance, from: usize| {
        (from..20).for_each(|i| {
            instance.set(&[motor], &[if (4..10).contains(&i) { moment } else { 0.0 }]).unwrap();
            instance.step(0.05 * i as f64, 0.05).unwrap();
            let now = instance.get(&seen).unwrap();
            let time = 0.05 * (i + 1) as f64;
            assert!((now[0] - angle(time)).abs() < 1e-7, "{now:?} {} at {time}", angle(time));
        });
        instance.get(&seen).unwrap()
    };
    let mut instance = fmu.start();
    for i in 0..7 {
        instance.set(&[motor], &[if i >= 4 { moment } else { 0.0 }]).unwrap();
        instance.step(0.05 * f64::from(i), 0.05).unwrap();
    }
    let state = instance.save().unwrap();
    let last = follow(&mut instance, 7);
    instance.restore(state).unwrap();
    assert_eq!(follow(&mut instance, 7), last);
    instance.free(state);
    // All that the motor has put in is at the end in the spring and in the motion.
    assert!((last[3] - 0.5 * stiffness * last[0].powi(2) - 0.5 * inertia * last[1].powi(2)).abs() < 1e-7, "{last:?}");
    assert!((last[2] + stiffness * last[0]).abs() < 1e-9, "{last:?}");
    // The axle stays 2 from the wall, 0.5 more than the wire has without a force.
    let now = instance.get(&of_springs).unwrap();
    assert!(now.iter().zip([2.0, 1.5, 1.5, 0.0]).all(|(now, expected)| (now - expected).abs() < 1e-9), "{now:?}");
}
