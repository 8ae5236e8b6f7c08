//! What is doubtful of a scene: values that can be computed with, but that no material has, mostly a slip of units; and what
//! of its mesh file was left out.

use fem_tet10::{Material, Materials};
use frames_rk4::Effect;
use scene::{Body, Choice, Model, Scene, Units};

use crate::units::UnitLabels;

/// Young's moduli of materials, Pa: from the softest gels to above diamond.
const YOUNG_MODULI: [f64; 2] = [1e2, 2e12];
/// Their densities, kg/m³: from aerogels to above osmium.
const DENSITIES: [f64; 2] = [0.1, 3e4];

/// What is doubtful of a scene, its mesh and its modes, in sentences. Moduli and densities are only judged where the labels of all units
/// are known.
pub(crate) fn doubts(scene: &Scene, model: &Model) -> Vec<String> {
    let mut doubts = Vec::new();
    if let Body::Matrices(files) = &scene.body {
        let notes = model.meshed.iter().flat_map(|meshed| &meshed.mesh_notes);
        doubts.extend(notes.map(|note| format!("{}: {note}", files.stiffness.display())));
        doubts.extend(without_elements(scene, model));
    }
    if let Body::Meshed(body) = &scene.body {
        let notes = model.meshed.iter().flat_map(|meshed| &meshed.mesh_notes);
        doubts.extend(notes.map(|note| format!("{}: {note}", body.mesh.display())));
        match &body.materials {
            Materials::Uniform(material) => doubts.extend(of_material(material, "", &scene.units)),
            Materials::ByGroup(each) => doubts.extend(
                each.iter()
                    .flat_map(|(group, material)| of_material(material, &format!(" of {group:?}"), &scene.units)),
            ),
        }
    }
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
    doubts
}

/// What a motion of a body of matrices may lack.
fn without_elements(scene: &Scene, model: &Model) -> impl Iterator<Item = String> {
    let missing = |effect: Effect| {
        let row = &model.advice.effects[effect];
        let is_open = scene.effects.choices[effect] == Choice::Auto && !scene.time.method.is_of_paper();
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
        let factor = 10_f64.powi(labels.tens(powers)?);
        let in_si = value * factor;
        (!(least..=most).contains(&in_si)).then(|| {
            format!(
                "the {name}{of}, {value:e} {unit}, is {in_si:.1e} {si}, which no material has: check it against the units of the \
                 scene (steel: {:.4e} {unit})",
                steel / factor
            )
        })
    };
    [stress, density].into_iter().filter_map(doubt).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn units(length: &str, mass: &str) -> Units {
        Units { length: length.into(), mass: mass.into(), time: "s".into() }
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
}
