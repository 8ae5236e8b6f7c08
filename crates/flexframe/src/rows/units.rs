//! The units that have names, in the labels of a scene: N, mJ and MPa where it is in mm, Mg and s; lbf and psi in inches with the mass
//! that goes with them.

use scene::{BaseUnit, POUND_FORCE, UnitSize};

/// Labels of a scene's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct UnitLabels<'a> {
    pub(crate) length: &'a str,
    pub(crate) mass: &'a str,
    pub(crate) time: &'a str,
}

impl<'a> From<&'a scene::Units> for UnitLabels<'a> {
    fn from(scene::Units { length, mass, time }: &'a scene::Units) -> Self {
        Self { length, mass, time }
    }
}

impl UnitLabels<'_> {
    /// "N", "lbf", or "lb in/s²" where the units are neither those of SI with a power of 1000 of N, nor those of a pound-force.
    pub(crate) fn force(&self) -> String {
        let Self { length, mass, time } = self;
        self.named_force().unwrap_or_else(|| format!("{mass} {length}/{time}²"))
    }

    /// "mJ".
    pub(crate) fn energy(&self) -> String {
        let Self { length, mass, time } = self;
        let of_pounds = || self.with_pounds().map(|length| format!("{length} lbf"));
        self.named("J", [2, 1, -2]).or_else(of_pounds).unwrap_or_else(|| format!("{mass} {length}²/{time}²"))
    }

    /// "MPa".
    pub(crate) fn stress(&self) -> String {
        let Self { length, mass, time } = self;
        let of_pounds = || {
            self.with_pounds().map(|length| if length == "in" { "psi".to_owned() } else { format!("lbf/{length}²") })
        };
        self.named("Pa", [-1, 1, -2]).or_else(of_pounds).unwrap_or_else(|| format!("{mass}/({length} {time}²)"))
    }

    /// "N mm".
    pub(crate) fn moment(&self) -> String {
        self.times_force(&[self.length]).unwrap_or_else(|| format!("{} {}²/{}²", self.mass, self.length, self.time))
    }

    /// "mW".
    pub(crate) fn power(&self) -> String {
        let Self { length, mass, time } = self;
        let of_pounds = || self.with_pounds().map(|length| format!("{length} lbf/s"));
        self.named("W", [2, 1, -3]).or_else(of_pounds).unwrap_or_else(|| format!("{mass} {length}²/{time}³"))
    }

    /// "N s".
    pub(crate) fn momentum(&self) -> String {
        self.times_force(&[self.time]).unwrap_or_else(|| format!("{} {}/{}", self.mass, self.length, self.time))
    }

    /// "N mm s".
    pub(crate) fn angular_momentum(&self) -> String {
        let Self { length, mass, time } = self;
        self.times_force(&[length, time]).unwrap_or_else(|| format!("{mass} {length}²/{time}"))
    }

    /// The unit of force where it has a name, times other units.
    fn times_force(&self, others: &[&str]) -> Option<String> {
        let force = self.named_force()?;
        Some([&[force.as_str()], others].concat().join(" "))
    }

    /// The unit of force, where it has a name.
    fn named_force(&self) -> Option<String> {
        self.named("N", [1, 1, -2]).or_else(|| self.with_pounds().map(|_| "lbf".to_owned()))
    }

    /// The unit of length, "in" or "ft", where force is in pounds.
    fn with_pounds(&self) -> Option<&'static str> {
        let [length, mass] =
            [BaseUnit::Length.size(self.length)?, BaseUnit::Mass.size(self.mass)?].map(UnitSize::factor);
        let is_pound = self.time == "s" && (mass * length / POUND_FORCE - 1.0).abs() < 1e-9;
        is_pound.then_some(if length < 0.1 { "in" } else { "ft" })
    }

    /// A unit of SI with its prefix, from the powers of length, mass and time that it has in m, kg and s.
    fn named(&self, name: &str, powers: [i32; 3]) -> Option<String> {
        let prefix = match self.tens(powers)? {
            -9 => "n",
            -6 => "µ",
            -3 => "m",
            0 => "",
            3 => "k",
            6 => "M",
            9 => "G",
            _ => return None,
        };
        Some(format!("{prefix}{name}"))
    }

    /// Seconds in the unit of time.
    pub(crate) fn seconds(&self) -> Option<f64> {
        BaseUnit::Time.size(self.time).map(UnitSize::factor)
    }

    /// A unit in m, kg and s, from the powers of length, mass and time that it has; inches and pounds are known, too.
    pub(crate) fn in_si(&self, powers: [i32; 3]) -> Option<f64> {
        let units =
            [BaseUnit::Length.size(self.length)?, BaseUnit::Mass.size(self.mass)?, BaseUnit::Time.size(self.time)?];
        Some(units.iter().zip(powers).map(|(unit, power)| unit.factor().powi(power)).product())
    }

    /// "mm/s²".
    pub(crate) fn acceleration(&self) -> String {
        format!("{}/{}²", self.length, self.time)
    }

    /// The power of ten of a unit in m, kg and s, from the powers of length, mass and time that it has.
    pub(crate) fn tens(&self, powers: [i32; 3]) -> Option<i32> {
        let tens =
            [ten(BaseUnit::Length, self.length)?, ten(BaseUnit::Mass, self.mass)?, ten(BaseUnit::Time, self.time)?];
        Some(tens.iter().zip(powers).map(|(ten, power)| ten * power).sum())
    }
}

/// The power of ten of a unit, where it is a power of ten of the unit of SI.
fn ten(unit: BaseUnit, label: &str) -> Option<i32> {
    match unit.size(label)? {
        UnitSize::Ten(power) => Some(power),
        UnitSize::Factor(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::UnitLabels;

    #[test]
    fn derived_units_have_their_names_where_they_are_of_si() {
        for (length, mass, time, expected) in [
            ("mm", "Mg", "s", ["mW", "N mm", "N s", "N mm s"]),
            ("mm", "g", "ms", ["W", "N mm", "N ms", "N mm ms"]),
            ("in", "lb", "s", ["lb in²/s³", "lb in²/s²", "lb in/s", "lb in²/s"]),
            ("in", "lbf s²/in", "s", ["in lbf/s", "lbf in", "lbf s", "lbf in s"]),
        ] {
            let units = UnitLabels { length, mass, time };
            let found = [units.power(), units.moment(), units.momentum(), units.angular_momentum()];
            assert_eq!(found, expected, "{units:?}");
        }
        for (length, mass, time, expected) in [
            ("mm", "Mg", "s", ["N", "mJ", "MPa"]),
            ("mm", "t", "s", ["N", "mJ", "MPa"]),
            ("m", "kg", "s", ["N", "J", "Pa"]),
            ("mm", "kg", "ms", ["kN", "J", "GPa"]),
            ("mm", "g", "ms", ["N", "mJ", "MPa"]),
            ("mm", "kg", "s", ["mN", "µJ", "kPa"]),
            // A dyne is no power of 1000 of N, an erg none of J.
            ("cm", "g", "s", ["g cm/s²", "g cm²/s²", "g/(cm s²)"]),
            ("in", "lb", "s", ["lb in/s²", "lb in²/s²", "lb/(in s²)"]),
            ("in", "slinch", "s", ["lbf", "in lbf", "psi"]),
            ("ft", "slug", "s", ["lbf", "ft lbf", "lbf/ft²"]),
            ("mm", "Mg", "", ["Mg mm/²", "Mg mm²/²", "Mg/(mm ²)"]),
        ] {
            let units = UnitLabels { length, mass, time };
            assert_eq!([units.force(), units.energy(), units.stress()], expected, "{units:?}");
        }
    }

    /// Closed form: steel, aluminium and gravity in each row of docs/reference/units.md, to its four digits.
    #[test]
    fn the_table_of_units_is_right() {
        let table = include_str!("../../../../docs/reference/units.md");
        let rows: Vec<Vec<&str>> = (table.lines().skip_while(|line| !line.starts_with("|---")).skip(1))
            .take_while(|line| line.starts_with('|'))
            .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
            .collect();
        assert_eq!(rows.len(), 9);
        for row in rows {
            let [length, mass, time, force, stress, energy, numbers @ ..] = &row[..] else { panic!("{row:?}") };
            let units = UnitLabels { length, mass, time };
            let [pascals, kilograms, gravity] =
                [[-1, 1, -2], [-3, 1, 0], [1, 0, -2]].map(|of| units.in_si(of).unwrap());
            let expected =
                [2.1e11 / pascals, 7850.0 / kilograms, 7e10 / pascals, 2700.0 / kilograms, 9.80665 / gravity];
            assert_eq!(numbers.len(), expected.len(), "{row:?}");
            for (number, expected) in numbers.iter().zip(expected) {
                let number: f64 = number.parse().unwrap();
                assert!((number / expected - 1.0).abs() < 5e-4, "{row:?}: {number} {expected}");
            }
            if units.tens([1, 1, -2]).is_some_and(|ten| ten % 3 == 0)
                && units.tens([2, 1, -2]).is_some_and(|ten| ten >= -9)
            {
                assert_eq!([units.force(), units.stress(), units.energy()], [*force, *stress, *energy], "{row:?}");
            }
        }
    }
}
