//! Values that can be computed with, but that no material has: mostly a slip of units.

use fem_tet10::{Material, Materials};
use scene::{Body, Model, Scene, Units};

/// Young's moduli of materials, Pa: from the softest gels to above diamond.
const YOUNG_MODULI: [f64; 2] = [1e2, 2e12];
/// Their densities, kg/m³: from aerogels to above osmium.
const DENSITIES: [f64; 2] = [0.1, 3e4];

/// What is doubtful of a scene and its modes, in sentences. Moduli and densities are only judged where the labels of all units
/// are known.
pub(crate) fn doubts(scene: &Scene, model: &Model) -> Vec<String> {
    let mut doubts = Vec::new();
    if let Body::Meshed(body) = &scene.body {
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

fn of_material(material: &Material, of: &str, units: &Units) -> Vec<String> {
    let (Some(metre), Some(kilogram), Some(second)) = (length(&units.length), mass(&units.mass), time(&units.time))
    else {
        return Vec::new();
    };
    let Units { length, mass, time } = units;
    let doubt = |name: &str, value: f64, unit: String, factor: f64, si: &str, [least, most]: [f64; 2]| {
        let in_si = value * factor;
        let right = (least..=most).contains(&in_si);
        (!right).then(|| {
            format!(
                "the {name}{of}, {value:e} {unit}, is {in_si:.1e} {si}, which no material has: check it against the units of the \
                 scene (steel: {:.4e} {unit})",
                if si == "Pa" { 2.1e11 / factor } else { 7850.0 / factor }
            )
        })
    };
    let stress = doubt(
        "Young's modulus",
        material.young_modulus,
        format!("{mass}/({length} {time}²)"),
        kilogram / (metre * second * second),
        "Pa",
        YOUNG_MODULI,
    );
    let density =
        doubt("density", material.density, format!("{mass}/{length}³"), kilogram / metre.powi(3), "kg/m³", DENSITIES);
    stress.into_iter().chain(density).collect()
}

/// Metres in a unit of length.
fn length(label: &str) -> Option<f64> {
    Some(match label {
        "m" => 1.0,
        "cm" => 1e-2,
        "mm" => 1e-3,
        "um" | "µm" => 1e-6,
        "km" => 1e3,
        "in" => 0.0254,
        "ft" => 0.3048,
        _ => return None,
    })
}

/// Kilograms in a unit of mass.
fn mass(label: &str) -> Option<f64> {
    Some(match label {
        "kg" => 1.0,
        "g" => 1e-3,
        "Mg" | "t" => 1e3,
        "lb" => 0.453_592_37,
        _ => return None,
    })
}

/// Seconds in a unit of time.
fn time(label: &str) -> Option<f64> {
    Some(match label {
        "s" => 1.0,
        "ms" => 1e-3,
        "us" | "µs" => 1e-6,
        _ => return None,
    })
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
        for words in ["Young's modulus of \"web\", 2.1e11 Mg/(mm s²), is 2.1e17 Pa", "steel: 2.1000e5"] {
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
