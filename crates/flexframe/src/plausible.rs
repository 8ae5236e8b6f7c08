//! Doubts about a scene: values that can be computed with, but that no material has, mostly a slip of units; and parts
//! of its mesh file that were left out.
//!
//! None of it is refused: labels of units are shown, not used, and a scene whose numbers fit each other is computed rightly
//! whatever its labels say.

use dynamics::Effect;
use fem_tet10::{Material, Materials};
use modal::NoCycles;
use model::{BodyMarker, Doubt, Meshed, Model};
use scene::{Body, BodySource, Choice, Interpolation, Joint, Load, LoadKind, Scene, TablePoints, Units, tables_of};

use crate::report::quantity;
use crate::rows::units::UnitLabels;

/// Young's moduli of materials, Pa: from the softest gels to above diamond.
const YOUNG_MODULI: [f64; 2] = [1e2, 2e12];
/// Their densities, kg/m³: from aerogels to above osmium.
const DENSITIES: [f64; 2] = [0.1, 3e4];

/// Speeds of sound √(E/ρ), m/s: below those of the softest gels, and above those of diamond and of graphite along its layers.
const SPEEDS_OF_SOUND: [f64; 2] = [0.3, 3e4];
/// Metals, ceramics and rocks begin at this density, kg/m³, and are never as slow as this, m/s (lead: 1190; rubbers that are
/// filled with metal may be).
const DENSE: f64 = 2500.0;
const SLOWEST_DENSE: f64 = 300.0;
/// A mass, kg, that no part has which is drawn solid: 1300 m³ of steel. A part of 20 mm whose mesh is in mm and is taken for one in m is as heavy.
const HEAVIEST: f64 = 1e7;
/// Standard gravity, m/s², and its number in the usual units: m, cm, mm; in, ft.
const GRAVITY: f64 = 9.80665;
const DECIMAL_GRAVITIES: [f64; 3] = [9.81, 981.0, 9810.0];
const IMPERIAL_GRAVITIES: [f64; 2] = [386.09, 32.174];

/// Doubts about a scene by itself, in sentences: materials and gravity. They are only judged where the labels of all
/// units are known.
pub fn doubts_of_body(body: &Body) -> Vec<String> {
    let mut doubts = Vec::new();
    if let BodySource::Meshed(meshed) = &body.source {
        doubts.extend(of_materials(&meshed.materials, &body.units));
    }
    doubts.extend(body.loads.iter().enumerate().filter_map(|(load, acts)| of_acceleration(load, acts, &body.units)));
    doubts
}

/// The same of all bodies of a scene, each with the name of its body where there are several.
pub fn doubts_of_scene(scene: &Scene) -> Vec<String> {
    let of_body = |body: &Body| {
        let name = body.name.clone().filter(|_| scene.bodies.len() > 1);
        let named =
            move |doubt| name.as_ref().map_or_else(|| String::clone(&doubt), |name| format!("body {name}: {doubt}"));
        doubts_of_body(body).into_iter().map(named).collect::<Vec<_>>()
    };
    scene.bodies.iter().flat_map(of_body).chain(struck_drives(scene)).collect()
}

/// Drives whose coordinate goes along straight lines of a table: its rate jumps where they meet.
pub(crate) fn struck_drives(scene: &Scene) -> Vec<String> {
    let end = scene.time.end;
    let of_joint = |joint: &Joint| {
        let tables = joint.drive.as_ref().map_or_else(Vec::new, |drive| tables_of(&drive.history));
        let lines = tables.into_iter().filter(|table| table.interpolation == Interpolation::Linear);
        let jumps = lines.filter_map(|TablePoints { points, .. }| {
            let (times, values) = points.iter().map(|[t, v]| (*t, *v)).unzip();
            let table = dynamics::Table::new(times, values).ok()?;
            let [first, last] = [points.first()?[0], points.last()?[0]];
            let is_inside = |time: &&f64| **time > first.max(0.0) && **time < last.min(end);
            Some(table.discontinuities().iter().filter(is_inside).count())
        });
        let jumps: usize = jumps.sum();
        (jumps > 0).then(|| {
            format!(
                "joint {}: the drive goes along straight lines between the points of its table, so its speed jumps {jumps} times, and each \
                 jump strikes the bodies; `interpolation = \"monotone-cubic\"` beside the points has a speed without jumps",
                joint.name
            )
        })
    };
    scene.joints.iter().filter_map(of_joint).collect()
}

fn of_materials(materials: &Materials, units: &Units) -> Vec<String> {
    match materials {
        Materials::Uniform(material) => of_material(material, "", units).into_iter().collect(),
        Materials::ByGroup(each) => {
            let of_group = |(group, material)| of_material(material, &format!(" of {group:?}"), units);
            each.iter().flat_map(of_group).collect()
        }
    }
}

/// Doubts about a scene, its mesh and its modes, in sentences.
pub(crate) fn doubts(given: &Body, model: &Model) -> Vec<String> {
    let mut doubts = doubts_of_body(given);
    if let BodySource::Matrices(files) = &given.source {
        let notes = model.meshed.iter().flat_map(|meshed| &meshed.mesh_notes);
        doubts.extend(notes.map(|note| format!("{}: {note}", files.stiffness.display())));
        doubts.extend(without_elements(given, model));
    }
    if let Some(Meshed { mesh, elements: Some(body), mesh_notes, .. }) = &model.meshed {
        if let BodySource::File(_) = given.source {
            doubts.extend(of_materials(&body.materials, &given.units));
        }
        doubts.extend(mesh_notes.iter().map(|note| format!("{}: {note}", body.mesh.display())));
        doubts.extend(of_mass(model.body.mass, mesh.size(), &given.units));
        doubts.extend(model::doubts(given, &given.loads, body, mesh).into_iter().map(|doubt: Doubt| doubt.to_string()));
    }
    if let Some(reason) = model.meshed.as_ref().and_then(|meshed| meshed.no_cycles.as_ref()) {
        doubts.push(without_cycles(reason));
    }
    doubts.extend(model.markers.iter().filter_map(warping));
    let ratios = &model.damping_ratios()[..model.body.flexible() - model.static_shapes()];
    let over: Vec<f64> = ratios.iter().copied().filter(|ratio| *ratio > 1.0).collect();
    if let Some(largest) = over.iter().copied().reduce(f64::max) {
        doubts.push(format!(
            "{} of {} modes have a damping ratio above 1 (up to {largest:.4}): they do not vibrate. Two per cent of critical \
             damping is 0.02",
            over.len(),
            ratios.len()
        ));
    }
    doubts.extend(without_statics(model));
    doubts
}

/// Stress of modes that leave out something of the static response.
fn without_statics(model: &Model) -> Option<String> {
    let row = &model.advice.static_correction;
    let has_modes = model.stress.is_some() && model.body.flexible() > 0;
    (has_modes && model.static_shapes() == 0 && row.on).then(|| {
        format!(
            "the stress lacks what the modes leave out of the static response, which is largest beside loads and supports. {} Take \
             static_correction = true with the scheme exponential, or more modes; `peak_stress = true` tells how much is missing",
            row.why
        )
    })
}

/// Multigrid cycles that could not spare a long time and much memory.
fn without_cycles(reason: &NoCycles) -> String {
    format!(
        "the stiffness matrix was factored, which takes long: multigrid cycles did not take the place of the factor; {reason}"
    )
}

/// A marker whose faces warp.
fn warping(marker: &BodyMarker) -> Option<String> {
    let warp = marker.warp.as_ref()?;
    let count = warp.patches()?;
    // A component that is zero but for rounding is shown as zero.
    let along = warp.along.map_or_else(String::new, |along| {
        let [x, y, z] = [0, 1, 2].map(|k| if along[k].abs() < 1e-3 { 0.0 } else { (1e3 * along[k]).round() / 1e3 });
        format!(" with `along = [{x:?}, {y:?}, {z:?}]`")
    });
    let left = warp.left_out[count - 1];
    let still = if warp.along.is_some() && left > 0.5 * warp.left_out[0] {
        "; the faces extend as far in two directions, and patches help in one: `tie = \"nodes\"` with a fixed joint sees all"
    } else {
        ""
    };
    Some(format!(
        "the marker {:?}: its faces warp by {:.0} % of their displacements under the forces of a joint, which their mean does not see, \
         so that the joint is too soft; `patches = {count}`{along} leaves out {:.0} %{still}",
        marker.name,
        100.0 * warp.left_out[0],
        100.0 * left
    ))
}

/// Parts of a motion that a body of matrices may lack.
fn without_elements(body: &Body, model: &Model) -> impl Iterator<Item = String> {
    let missing = |effect: Effect| {
        let row = &model.advice.effects[effect];
        let is_open = model.choices[effect] == Choice::Auto && body.method().abilities.switches_effects;
        (is_open && row.on).then(|| {
            format!(
                "{} may change the answer by up to {:.1e} (a bound), and is left out: the elements of a body of matrices are not \
                 known. If it matters, give the body a mesh; `{} = false` in [effects] ends this warning",
                effect.name(),
                row.influence,
                effect.name()
            )
        })
    };
    [Effect::GeometricStiffening, Effect::LargeDeflection].into_iter().filter_map(missing)
}

fn of_material(material: &Material, of: &str, units: &Units) -> Vec<String> {
    let labels = UnitLabels::from(units);
    let Units { length, mass, .. } = units;
    let stress = (material.young_modulus, [-1, 1, -2], "Pa", YOUNG_MODULI, 2.1e11, "Young's modulus", labels.stress());
    let density = (material.density, [-3, 1, 0], "kg/m³", DENSITIES, 7850.0, "density", format!("{mass}/{length}³"));
    let doubt = |(value, powers, si, [least, most], steel, name, unit): (f64, _, _, [f64; 2], f64, _, String)| {
        let factor = labels.in_si(powers)?;
        let in_si = value * factor;
        (!(least..=most).contains(&in_si)).then(|| {
            format!(
                "the {name}{of}, {value:e} {unit}, is {in_si:.1e} {si}, which no material has: check it against the units of the \
                 scene (steel: {:.4e} {unit})",
                steel / factor
            )
        })
    };
    let doubts: Vec<String> = [stress, density].into_iter().filter_map(doubt).collect();
    if doubts.is_empty() { of_sound(material, of, &labels).into_iter().collect() } else { doubts }
}

/// The units in which handbooks have them, in SI.
const UNITS_OF_STRESS: [(&str, f64); 5] =
    [("Pa", 1.0), ("MPa", 1e6), ("GPa", 1e9), ("psi", 6894.757), ("ksi", 6.894757e6)];
const UNITS_OF_DENSITY: [(&str, f64); 4] = [("kg/m³", 1.0), ("g/cm³", 1e3), ("Mg/mm³", 1e12), ("lb/in³", 27_679.9)];

/// Doubt about the speed of sound of a material.
fn of_sound(material: &Material, of: &str, labels: &UnitLabels<'_>) -> Option<String> {
    let &Material { young_modulus, density, .. } = material;
    let (pascals, kilograms) = (labels.in_si([-1, 1, -2])?, labels.in_si([-3, 1, 0])?);
    let (e, rho) = (young_modulus * pascals, density * kilograms);
    let [least, most] = SPEEDS_OF_SOUND;
    let least = if rho > DENSE { SLOWEST_DENSE } else { least };
    let speed = (e / rho).sqrt();
    if (least..=most).contains(&speed) {
        return None;
    }
    // The slip of one unit that explains it.
    let is_common = |e: f64, rho: f64| {
        (1e6..=1.2e12).contains(&e) && (10.0..=2.3e4).contains(&rho) && (300.0..=1.4e4).contains(&(e / rho).sqrt())
    };
    let modulus = UNITS_OF_STRESS.iter().find(|(_, unit)| is_common(young_modulus * unit, rho)).map(|(name, unit)| {
        format!("if {young_modulus:?} is in {name}, write young_modulus = {:.4e}", young_modulus * unit / pascals)
    });
    let other = || {
        UNITS_OF_DENSITY.iter().find(|(_, unit)| is_common(e, density * unit)).map(|(name, unit)| {
            format!("if {density:?} is in {name}, write density = {:.4e}", density * unit / kilograms)
        })
    };
    let help = modulus.or_else(other).unwrap_or_else(|| "check both against the units of the scene".to_owned());
    Some(format!(
        "body: Young's modulus and density{of} give a speed of sound √(E/ρ) of {speed:.3e} m/s, where {} from {least} to {most:e}: {help} \
         (steel: young_modulus = {:.4e}, density = {:.4e})",
        if rho > DENSE { "materials of this density have one" } else { "materials have one" },
        2.1e11 / pascals,
        7850.0 / kilograms
    ))
}

/// Doubt about the mass of a mesh: that of one in millimetres, taken for metres.
fn of_mass(mass: f64, size: [f64; 3], units: &Units) -> Option<String> {
    let in_si = mass * UnitLabels::from(units).in_si([0, 1, 0])?;
    let longest = size.into_iter().fold(0.0, f64::max);
    (in_si > HEAVIEST).then(|| {
        format!(
            "the body is {} {} long and has a mass of {mass:.3e} {}: check the unit of its mesh against `units`, since nothing is \
             converted; with a mesh in mm, `length = \"mm\"`, and numbers that go with it (docs/reference/units.md)",
            quantity(longest),
            units.length,
            units.mass
        )
    })
}

/// Doubt about gravity, or about an acceleration of the base: the number of standard gravity in other units than those of
/// the scene.
fn of_acceleration(load: usize, acts: &Load, units: &Units) -> Option<String> {
    let (name, amplitude) = match acts.kind {
        LoadKind::Gravity | LoadKind::BaseAcceleration => (acts.kind.name(), acts.amplitude.abs()),
        _ => return None,
    };
    let labels = UnitLabels::from(units);
    let unit = labels.in_si([1, 0, -2])?;
    let is_number_of = |gravity: &f64| (amplitude / gravity - 1.0).abs() < 5e-3;
    let part = amplitude * unit / GRAVITY;
    // A load of 10 or 100 times gravity may be meant; a shock of the base of 1000 times, too.
    let is_other = part < 0.5 || (part > 500.0 && name == "gravity");
    let is_slip = (DECIMAL_GRAVITIES.iter().any(is_number_of) && is_other)
        || (IMPERIAL_GRAVITIES.iter().any(is_number_of) && (part - 1.0).abs() > 1e-2);
    is_slip.then(|| {
        format!(
            "loads[{load}]: {name} of {amplitude} {unit} is {part:.1e} times the gravity of the Earth, which is {:.5e} {unit}: \
             check it against the units of the scene",
            GRAVITY / labels.in_si([1, 0, -2]).unwrap_or(1.0),
            unit = labels.acceleration()
        )
    })
}

#[cfg(test)]
mod tests {
    use dynamics::LoadFrame;
    use scene::{History, LoadPlace};

    use super::*;

    fn units(length: &str, mass: &str) -> Units {
        Units { length: length.into(), mass: mass.into(), time: "s".into() }
    }

    #[test]
    fn a_factor_in_the_place_of_cycles_is_told_with_the_reason() {
        let told = without_cycles(&NoCycles::FlatElements { left: 0.81, limit: 0.75 });
        assert!(told.contains("takes long") && told.contains("leaves 0.81 of the strain energy"), "{told}");
    }

    /// Closed form: a bar of steel of 200 x 20 x 10 mm has 0.314 kg, and 3.14e8 kg where its mesh is taken to be in metres.
    #[test]
    fn a_mesh_in_millimetres_that_is_taken_for_metres_is_told() {
        let told = of_mass(7850.0 * 200.0 * 20.0 * 10.0, [200.0, 20.0, 10.0], &units("m", "kg")).unwrap();
        assert!(told.contains("200 m long") && told.contains("3.140e8 kg"), "{told}");
        assert!(of_mass(0.314e-3, [200.0, 20.0, 10.0], &units("mm", "Mg")).is_none());
        assert!(of_mass(1e20, [1.0; 3], &units("cubit", "talent")).is_none(), "units without a size");
    }

    /// A marker whose faces warp so.
    fn warped(left_out: &[f64], along: Option<nalgebra::Vector3<f64>>) -> BodyMarker {
        let (zero, inertia) = (nalgebra::Vector3::zeros(), nalgebra::Matrix3::identity());
        let body = reduced_body::ReducedBody::rigid(1.0, zero, inertia, reduced_body::RigidMotion::free()).unwrap();
        let none = faer::Mat::zeros(3, 0);
        let point = reduced_body::BodyPoint { position_body: zero, shapes: none.clone() };
        BodyMarker {
            name: "face".to_owned(),
            point: dynamics::PointShapes::new(&body, &point),
            turning: dynamics::RotationShapes::new(&body, none.as_ref()),
            parts: Vec::new(),
            by_nodes: false,
            warp: Some(model::Warp { left_out: left_out.to_vec(), along }),
            axes: inertia,
            unknown_turns: model::UnknownTurns::None,
        }
    }

    #[test]
    fn faces_that_warp_in_two_directions_are_told_of_both() {
        let along = Some(nalgebra::Vector3::new(1e-9, 0.6, -0.8));
        let told = warping(&warped(&[0.2, 0.16, 0.15, 0.14, 0.14, 0.13], along)).unwrap();
        let proposal = "`patches = 6` with `along = [0.0, 0.6, -0.8]` leaves out 13 %";
        for words in ["\"face\"", "warp by 20 %", proposal, "patches help in one"] {
            assert!(told.contains(words), "{words}: {told}");
        }
        let told = warping(&warped(&[0.2, 0.05, 0.03, 0.02, 0.02, 0.01], along)).unwrap();
        assert!(told.contains("`patches = 2` with `along") && !told.contains("help in one"), "{told}");
        let told = warping(&warped(&[0.2, 0.05, 0.03, 0.02, 0.02, 0.01], None)).unwrap();
        assert!(told.contains("`patches = 2` leaves out 5 %"), "{told}");
        assert!(warping(&warped(&[0.04, 0.03, 0.03, 0.02, 0.02, 0.01], along)).is_none());
    }

    #[test]
    fn steel_in_the_wrong_units_is_told() {
        let steel = |young_modulus, density| Material { young_modulus, poisson_ratio: 0.3, density };
        assert!(of_material(&steel(210e3, 7.85e-9), "", &units("mm", "Mg")).is_empty());
        assert!(of_material(&steel(210e9, 7850.0), "", &units("m", "kg")).is_empty());
        let doubts = of_material(&steel(210e9, 7850.0), " of \"web\"", &units("mm", "Mg"));
        assert_eq!(doubts.len(), 2);
        for words in ["Young's modulus of \"web\", 2.1e11 MPa, is 2.1e17 Pa", "steel: 2.1000e5"] {
            assert!(doubts[0].contains(words), "{}", doubts[0]);
        }
        assert!(
            doubts[1].contains("7.85e3 Mg/mm³, is 7.8e15 kg/m³") && doubts[1].contains("steel: 7.8500e-9"),
            "{}",
            doubts[1]
        );
        // Megapascals in metres and kilograms.
        assert!(of_material(&steel(210e-3, 7850.0), "", &units("m", "kg"))[0].contains("2.1e-1 Pa"));
        // Units that are not known say nothing.
        assert!(of_material(&steel(210e9, 7850.0), "", &units("cubit", "Mg")).is_empty());
    }

    /// Real materials from gels to diamond in SI: no false alarm.
    #[test]
    fn real_materials_are_not_doubted() {
        for (name, young_modulus, density) in [
            ("steel", 2.1e11, 7850.0),
            ("aluminium", 7e10, 2700.0),
            ("lead", 1.6e10, 11_340.0),
            ("gold", 7.8e10, 19_300.0),
            ("osmium", 5.6e11, 22_590.0),
            ("beryllium", 2.87e11, 1850.0),
            ("diamond", 1.22e12, 3515.0),
            ("carbon fibre, along it", 9.35e11, 2200.0),
            ("wood", 1.1e10, 500.0),
            ("balsa across the grain", 5e7, 120.0),
            ("concrete", 3e10, 2400.0),
            ("polyethylene", 2e8, 920.0),
            ("natural rubber", 1.5e6, 930.0),
            ("soft silicone", 5e4, 1070.0),
            ("gelatine", 3e3, 1010.0),
            ("foam of polyurethane", 1e5, 30.0),
            ("foam of polystyrene", 5e6, 20.0),
            ("aerogel of silica", 1e6, 100.0),
            ("honeycomb of aluminium, along it", 1e9, 50.0),
            ("soil", 2e7, 1900.0),
            ("steel with the mass of a fuselage smeared over it", 2.1e11, 1e5 / 4.0),
        ] {
            let material = Material { young_modulus, poisson_ratio: 0.3, density };
            assert_eq!(of_material(&material, "", &units("m", "kg")), [""; 0], "{name}");
            let in_mm = Material { young_modulus: young_modulus * 1e-6, density: density * 1e-12, ..material };
            assert_eq!(of_material(&in_mm, "", &units("mm", "Mg")), [""; 0], "{name}");
        }
        let slinches = Material { young_modulus: 3e7, poisson_ratio: 0.3, density: 7.345e-4 };
        assert_eq!(of_material(&slinches, "", &units("in", "lbf s²/in")), [""; 0]);
    }

    #[test]
    fn slips_of_units_in_steel_and_aluminium_are_told_with_the_number_to_write() {
        for (young_modulus, density, length, mass, words) in [
            // g/cm³ for kg/m³: frequencies thirty times too high.
            (210e9, 7.85, "m", "kg", ["1.636e5 m/s", "if 7.85 is in g/cm³, write density = 7.8500e3"]),
            // GPa for MPa and for Pa.
            (210.0, 7.85e-9, "mm", "Mg", ["1.636e2 m/s", "if 210.0 is in GPa, write young_modulus = 2.1000e5"]),
            (70.0, 2.7e-9, "mm", "t", ["1.610e2 m/s", "if 70.0 is in GPa, write young_modulus = 7.0000e4"]),
            (210e3, 7850.0, "m", "kg", ["5.172e0 m/s", "if 210000.0 is in MPa, write young_modulus = 2.1000e11"]),
            (3e7, 7850.0, "m", "kg", ["6.182e1 m/s", "if 30000000.0 is in psi, write young_modulus = 2.0684e11"]),
            (210.0, 7850.0, "m", "kg", ["1.636e-1 m/s", "if 210.0 is in GPa, write young_modulus = 2.1000e11"]),
        ] {
            let material = Material { young_modulus, poisson_ratio: 0.3, density };
            let doubts = of_material(&material, "", &units(length, mass));
            assert_eq!(doubts.len(), 1, "{doubts:?}");
            for word in words {
                assert!(doubts[0].contains(word), "{word}: {}", doubts[0]);
            }
        }
    }

    #[test]
    fn gravity_in_other_units_than_the_scenes_is_told() {
        let gravity = |kind: LoadKind, amplitude: f64| Load {
            kind,
            place: LoadPlace::Everywhere,
            direction: [0.0, 0.0, -1.0],
            frame: LoadFrame::Global,
            amplitude,
            history: History::Constant,
        };
        let told = |kind: LoadKind, amplitude: f64, length: &str| {
            of_acceleration(
                1,
                &gravity(kind, amplitude),
                &Units { length: length.into(), mass: "kg".into(), time: "s".into() },
            )
        };
        for (length, right) in [("m", 9.81), ("cm", 981.0), ("mm", 9810.0), ("in", 386.1), ("ft", 32.2)] {
            for number in [9.81, 981.0, 9810.0, 386.1, 32.17] {
                let told = told(LoadKind::Gravity, number, length);
                let may_be_meant = matches!(
                    (length, number),
                    ("m", 981.0) | ("cm", 9810.0) | ("ft", 981.0 | 9810.0) | ("in", 981.0 | 9810.0)
                );
                assert_eq!(
                    told.is_none(),
                    number / right == 1.0 || (number / right - 1.0).abs() < 1e-2 || may_be_meant,
                    "{length} {number} {told:?}"
                );
            }
            // The Moon, Jupiter, ten times gravity.
            for factor in [0.166, 2.53, 10.0] {
                assert_eq!(told(LoadKind::Gravity, factor * right, length), None, "{length} {factor}");
            }
        }
        let words = told(LoadKind::Gravity, 9.81, "mm").unwrap();
        assert!(
            words.contains("loads[1]: gravity of 9.81 mm/s² is 1.0e-3 times") && words.contains("9.80665e3 mm/s²"),
            "{words}"
        );
        assert!(
            told(LoadKind::BaseAcceleration, 9.81, "mm").is_some()
                && told(LoadKind::BaseAcceleration, 9810.0, "m").is_none()
        );
        assert_eq!(told(LoadKind::Gravity, 9.81, "furlong"), None);
    }
}
