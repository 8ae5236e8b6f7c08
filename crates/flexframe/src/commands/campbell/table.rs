//! The branches and the critical speeds for people.

use std::f64::consts::TAU;
use std::fmt;

use super::critical::{Critical, CriticalKind, SwingLimit};
use super::report::{CampbellReport, SpinEffects};
use crate::report::quantity;

/// More speeds than this are thinned: the file has them all.
const ROWS: usize = 26;
/// More modes than this do not fit a line.
const COLUMNS: usize = 10;

impl fmt::Display for CampbellReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        if let Some(mesh) = &self.mesh {
            writeln!(f, "  mesh     {mesh}")?;
        }
        if !self.bodies.is_empty() {
            writeln!(f, "  bodies   {}", self.bodies.join(", "))?;
        }
        // A coordinate that is zero but for rounding is shown as zero.
        let vector = |v: &[f64; 3]| {
            let dust = 1e-9 * v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            v.map(|x| quantity(if x.abs() < dust { 0.0 } else { x })).join(", ")
        };
        writeln!(f, "  spin     about ({}) through ({})", vector(&self.axis), vector(&self.origin))?;
        if let Some(rotor) = &self.rotor {
            writeln!(f, "  rotor    {rotor} alone spins; the others are its support")?;
        }
        let others = self.rotors.iter();
        others.clone().try_for_each(|of| writeln!(f, "  and      {}, at all speeds", of.words(&self.time_unit)))?;
        if let Some(effects) = self.effects {
            writeln!(f, "  effects  {effects}")?;
        }
        let time = &self.time_unit;
        if let Some(most) = self.deflection.iter().copied().reduce(f64::max) {
            writeln!(
                f,
                "  rest     bent by up to {} {}: vibrations about the rest at each speed",
                quantity(most),
                self.length_unit
            )?;
        }
        if let Some(reason) = &self.no_rest {
            writeln!(f, "  rest     {reason}: vibrations about the undeformed body")?;
        }
        match self.stable_below {
            Some(speed) if self.of_undeformed() => {
                let asks = if self.no_rest.is_none() { " (`--about-rest always` asks the full body)" } else { "" };
                writeln!(f, "  stable   below {} rad/{time}, about the undeformed body{asks}", quantity(speed))?;
            }
            Some(speed) if self.speeds.first().is_some_and(|first| *first >= speed) => {
                writeln!(f, "  stable   not at {} rad/{time}, the lowest speed of this range", quantity(speed))?;
            }
            Some(speed) => writeln!(f, "  stable   below {} rad/{time}", quantity(speed))?,
            None if !self.of_undeformed() => writeln!(f, "  stable   at all speeds of this range")?,
            None => writeln!(f, "  stable   no frequency falls to zero at any speed")?,
        }
        self.write_branches(f)?;
        self.write_critical_speeds(f)?;
        self.write_swing_limits(f)?;
        write!(f, "\n  wrote     ")?;
        self.files.iter().try_for_each(|file| write!(f, " {}", file.display()))?;
        self.warnings.iter().try_for_each(|warning| write!(f, "\n  warning   {warning}"))
    }
}

impl CampbellReport {
    /// Turns a minute, where time is in seconds.
    fn rpm(&self, speed: f64) -> Option<f64> {
        (self.time_unit == "s").then_some(60.0 * speed / TAU)
    }

    /// True if the vibrations are those of modes of one undeformed body.
    fn of_undeformed(&self) -> bool {
        self.bodies.is_empty() && self.deflection.is_empty()
    }

    fn write_branches(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = &self.branches[..self.branches.len().min(COLUMNS)];
        let rpm = if self.rpm(0.0).is_some() { "       rpm" } else { "" };
        write!(f, "\n  {:>10}{rpm}  ", format!("rad/{}", self.time_unit))?;
        if !self.deflection.is_empty() {
            write!(f, "{:>10}", format!("bent, {}", self.length_unit))?;
        }
        shown.iter().try_for_each(|branch| write!(f, "{:>10}", branch.label()))?;
        writeln!(f, "   frequency, {}", self.frequency_unit)?;
        let last = self.speeds.len() - 1;
        let stride = last.div_ceil(ROWS - 1).max(1);
        let (mut rows, mut any_grows) = (0, false);
        for (i, speed) in self.speeds.iter().enumerate().filter(|(i, _)| i % stride == 0 || *i == last) {
            rows += 1;
            write!(f, "  {speed:>10.3}")?;
            if let Some(rpm) = self.rpm(*speed) {
                write!(f, "{rpm:>10.1}")?;
            }
            write!(f, "  ")?;
            if let Some(deflection) = self.deflection.get(i) {
                write!(f, "{:>9} ", quantity(*deflection))?;
            }
            for branch in shown {
                let grows = branch.growth[i] > 0.0;
                any_grows |= grows;
                write!(f, "{:>9.3}{}", branch.frequency[i], if grows { '!' } else { ' ' })?;
            }
            writeln!(f)?;
        }
        if any_grows {
            writeln!(f, "  ! the vibration grows")?;
        }
        if rows < self.speeds.len() || shown.len() < self.branches.len() {
            let (speeds, modes) = (self.speeds.len(), self.branches.len());
            writeln!(f, "  {rows} of {speeds} speeds, {} of {modes} modes; campbell.csv has them all", shown.len())?;
        }
        Ok(())
    }

    fn write_critical_speeds(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.critical_speeds.is_empty() {
            return writeln!(f, "\n  no critical speed in this range");
        }
        let rpm = if self.rpm(0.0).is_some() { "       rpm" } else { "" };
        let unit = format!("rad/{}", self.time_unit);
        writeln!(f, "\n  critical speeds\n  order  mode  {unit:>10}{rpm}  frequency, {}", self.frequency_unit)?;
        for &Critical { kind, order, mode, speed, frequency } in &self.critical_speeds {
            write!(f, "  {:>5}  {mode:>4}  {speed:>10.3}", format!("{order}x"))?;
            if let Some(rpm) = self.rpm(speed) {
                write!(f, "{rpm:>10.1}")?;
            }
            let words = match kind {
                CriticalKind::Crossing => "",
                CriticalKind::ZeroFrequency if self.of_undeformed() => {
                    "   the frequency is zero: no rest of the model from here on"
                }
                CriticalKind::ZeroFrequency => "   the frequency is zero: a limit of stability",
                CriticalKind::GrowthBegins => "   the vibration grows from here on: a limit of stability",
                CriticalKind::GrowthEnds => "   the vibration grows up to here: a limit of stability",
            };
            writeln!(f, "  {frequency:>9.3}{words}")?;
        }
        Ok(())
    }

    fn write_swing_limits(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for &SwingLimit { mode, speed, swings_above } in &self.swing_limits {
            let (swings, decays) = if swings_above { ("above", "below") } else { ("below", "above") };
            let (speed, time) = (quantity(speed), &self.time_unit);
            writeln!(
                f,
                "  mode {mode} swings {swings} {speed} rad/{time}; {decays} it is damped so much that it only decays"
            )?;
        }
        Ok(())
    }
}

impl fmt::Display for SpinEffects {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all =
            [("Coriolis", self.coriolis), ("softening", self.softening), ("geometric stiffening", self.stiffening)];
        let named =
            |wanted: bool| -> Vec<&str> { all.iter().filter(|(_, on)| *on == wanted).map(|(name, _)| *name).collect() };
        match (named(true).join(", "), named(false).join(", ")) {
            (on, off) if off.is_empty() => write!(f, "{on}"),
            (on, off) if on.is_empty() => write!(f, "none: {off} are off"),
            (on, off) => write!(f, "{on}; off: {off}"),
        }
    }
}
