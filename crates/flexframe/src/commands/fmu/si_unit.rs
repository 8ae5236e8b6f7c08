//! The unit of a quantity as FMI describes it: powers of the base units of SI, and a factor.

use scene::Units;

use crate::rows::units::UnitLabels;

/// Powers of the scene's units in a quantity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Powers {
    pub length: i32,
    pub mass: i32,
    pub time: i32,
    pub angle: i32,
}

impl Powers {
    /// The powers of a unit such as "mass/(length time^2)", as in [`COLUMNS`](crate::rows::columns::COLUMNS); none where a power
    /// is no whole
    /// number, which FMI has no base units for.
    pub fn of(unit: &str) -> Option<Self> {
        let mut powers = Self::default();
        let (above, below) = unit.split_once('/').unwrap_or((unit, ""));
        for (part, sign) in [(above, 1), (below.trim_matches(['(', ')']), -1)] {
            for factor in part.split_whitespace().filter(|factor| *factor != "1") {
                let (name, power) = factor.split_once('^').unwrap_or((factor, "1"));
                let power = sign * power.parse::<i32>().ok()?;
                match name {
                    "length" => powers.length += power,
                    "mass" => powers.mass += power,
                    "time" => powers.time += power,
                    "rad" => powers.angle += power,
                    _ => return None,
                }
            }
        }
        Some(powers)
    }

    /// Its name, written as Modelica does: "Mg.mm/s2", "Mg/(mm.s2)", "1".
    pub fn name(&self, units: &Units) -> String {
        let factors =
            [(self.mass, &*units.mass), (self.angle, "rad"), (self.length, &units.length), (self.time, &units.time)];
        let written = |sign: i32| -> Vec<String> {
            let of = |(power, label): (i32, &str)| match power * sign {
                1 => Some(label.to_owned()),
                2.. => Some(format!("{label}{}", power.abs())),
                _ => None,
            };
            factors.into_iter().filter_map(of).collect()
        };
        let (above, below) = (written(1), written(-1));
        let above = if above.is_empty() { "1".to_owned() } else { above.join(".") };
        match below.len() {
            0 => above,
            1 => format!("{above}/{}", below[0]),
            _ => format!("{above}/({})", below.join(".")),
        }
    }

    /// Size of the unit in SI; none where the labels are no decimal units of SI.
    pub fn factor(&self, units: &Units) -> Option<f64> {
        let powers = [self.length, self.mass, self.time];
        if powers == [0; 3] {
            return Some(1.0);
        }
        UnitLabels::from(units).tens(powers).map(|tens| format!("1e{tens}").parse().unwrap_or(f64::NAN))
    }
}

/// Seconds in the scene's unit of time. FMI counts time in seconds. Where the label is no unit of time, 1.
pub(super) fn seconds(units: &Units) -> f64 {
    UnitLabels::from(units).seconds().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::columns::COLUMNS;

    fn units(length: &str, mass: &str, time: &str) -> Units {
        Units { length: length.into(), mass: mass.into(), time: time.into() }
    }

    /// Closed form: powers of ten of SI.
    #[test]
    fn units_are_powers_of_si_with_a_factor() {
        let mm = units("mm", "Mg", "s");
        for (unit, name, factor) in [
            ("mass length/time^2", "Mg.mm/s2", 1.0),
            ("mass length^2/time^2", "Mg.mm2/s2", 1e-3),
            ("mass/(length time^2)", "Mg/(mm.s2)", 1e6),
            ("rad/time^2", "rad/s2", 1.0),
            ("length/time", "mm/s", 1e-3),
            ("1", "1", 1.0),
        ] {
            let powers = Powers::of(unit).unwrap();
            assert_eq!((powers.name(&mm).as_str(), powers.factor(&mm)), (name, Some(factor)), "{unit}");
        }
        assert_eq!(Powers::of("length mass^(1/2)/time"), None);
        let inch = units("in", "lb", "s");
        let force = Powers::of("mass length/time^2").unwrap();
        assert_eq!((force.name(&inch).as_str(), force.factor(&inch)), ("lb.in/s2", None));
        assert_eq!((seconds(&units("mm", "g", "ms")), seconds(&units("", "", ""))), (1e-3, 1.0));
    }

    #[test]
    fn every_column_has_a_unit_but_those_with_the_root_of_the_mass() {
        for column in &COLUMNS {
            let unit = column.dimension.unit();
            assert_eq!(Powers::of(unit).is_none(), unit.contains("^(1/2)"), "{unit}");
        }
    }
}
