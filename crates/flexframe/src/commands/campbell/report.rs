//! Report of a diagram: branches, engine orders and where they cross.

use std::f64::consts::TAU;

use figures::{LineChart, Scale, Series, Stroke};
use report::{File, Form, Report, Table, Value, quantity};

use super::branches::Branch;
use super::critical::{Critical, CriticalKind, SwingLimit};
use crate::commands::modes::frequency_unit;
use crate::commands::system_modes::SpinningRotor;
use crate::report::MeshReport;

/// The files of [`campbell`](super::campbell): `campbell.csv`, `critical_speeds.csv`, and `campbell` as SVG, PDF and PNG.
pub const FILES: [File; 3] = [File::Table("campbell"), File::Table("critical_speeds"), File::Chart("campbell")];

/// More speeds than this are thinned: the file has them all.
const ROWS: usize = 26;
/// More modes than this do not fit a line.
const COLUMNS: usize = 10;
/// More branches than this, solid and dashed, cannot be told apart.
const MAX_BRANCHES: usize = 14;
/// The diagram reaches this far above the highest order,
const ABOVE_ORDERS: f64 = 1.15;
/// but at most so far above the highest branch.
const ABOVE_BRANCHES: f64 = 1.05;

/// Natural frequencies against the speed of a spin.
#[derive(Debug, Default)]
pub(super) struct Diagram {
    pub mesh: Option<MeshReport>,
    /// Names of the bodies of a system; none of one body alone.
    pub bodies: Vec<String>,
    /// The body of a system that spins, where the others are its support; none where all spin.
    pub rotor: Option<String>,
    /// Rotors beside it that spin as they do at the start of the scene, at the same speed at all speeds of the diagram.
    pub rotors: Vec<SpinningRotor>,
    /// Turns that are left out.
    pub warnings: Vec<String>,
    /// Unit vector, axes of the mesh; of a system global.
    pub axis: [f64; 3],
    /// The point that the axis goes through, mesh axes; of a system global.
    pub origin: [f64; 3],
    /// None of a rotor, whose spin does nothing to the bodies of its support.
    pub effects: Option<SpinEffects>,
    /// Radians per time.
    pub speeds: Vec<f64>,
    /// Largest displacement of a node by deformation at each speed, where the vibrations are about the rest of the full body; none where
    /// they are about the undeformed body.
    pub deflection: Vec<f64>,
    /// The reason that the rest of the full body cannot be found, and how far the spin bends the body.
    pub no_rest: Option<String>,
    /// In the order of their frequencies at the lowest speed.
    pub branches: Vec<Branch>,
    /// The spin speed at which the body loses its stability because K + Ω²(K_σ − N) is no longer positive definite; none
    /// if it never does. Of a system, and about the rest of the full body, the lowest of the speeds at which a vibration grows.
    pub stable_below: Option<f64>,
    /// Where orders and branches cross, by order and speed; order 0 where a frequency is zero, or growth begins or ends.
    pub critical_speeds: Vec<Critical>,
    /// Where vibrations that are damped so much that they only decay begin to swing, or stop to, by speed: no limits of stability.
    pub swing_limits: Vec<SwingLimit>,
}

/// Effects of the spin that are computed: Coriolis forces G, the centrifugal forces of the deformation N, and the stress of the centrifugal
/// field K_σ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SpinEffects {
    pub coriolis: bool,
    pub softening: bool,
    pub stiffening: bool,
}

impl SpinEffects {
    /// True if all are computed.
    pub fn all(self) -> bool {
        self.coriolis && self.softening && self.stiffening
    }

    fn in_words(self) -> String {
        let all =
            [("Coriolis", self.coriolis), ("softening", self.softening), ("geometric stiffening", self.stiffening)];
        let named =
            |wanted: bool| -> Vec<&str> { all.iter().filter(|(_, on)| *on == wanted).map(|(name, _)| *name).collect() };
        match (named(true).join(", "), named(false).join(", ")) {
            (on, off) if off.is_empty() => on,
            (on, off) if on.is_empty() => format!("none: {off} are off"),
            (on, off) => format!("{on}; off: {off}"),
        }
    }
}

impl Diagram {
    /// True if the vibrations are about one undeformed body.
    fn of_undeformed(&self) -> bool {
        self.bodies.is_empty() && self.deflection.is_empty()
    }

    /// The report of a scene with units of length and time.
    pub fn report(self, title: &str, [length, time]: [&str; 2], orders: &[f64]) -> Report {
        let mut report = Report::new(title);
        let unit = frequency_unit(time);
        report.put("time_unit", time);
        report.put("length_unit", length);
        report.put("frequency_unit", &unit);
        report.put("mesh", self.mesh.as_ref().map(Value::of));
        self.mesh.iter().for_each(|mesh| report.line("mesh", mesh.to_string()));
        if !self.bodies.is_empty() {
            report.put("bodies", &self.bodies[..]);
            report.line("bodies", self.bodies.join(", "));
        }
        // A coordinate that is zero but for rounding is shown as zero.
        let vector = |v: &[f64; 3]| {
            let dust = 1e-9 * v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            v.map(|x| quantity(if x.abs() < dust { 0.0 } else { x })).join(", ")
        };
        report.put("axis", self.axis);
        report.put("origin", self.origin);
        report.line("spin", format!("about ({}) through ({})", vector(&self.axis), vector(&self.origin)));
        if let Some(rotor) = &self.rotor {
            report.put("rotor", rotor);
            report.line("rotor", format!("{rotor} alone spins; the others are its support"));
        }
        if !self.rotors.is_empty() {
            report.put("rotors", Value::of(&self.rotors));
        }
        self.rotors.iter().for_each(|of| report.line("and", format!("{}, at all speeds", of.words(time))));
        if let Some(effects) = self.effects {
            let SpinEffects { coriolis, softening, stiffening } = effects;
            report.put("effects.coriolis", coriolis);
            report.put("effects.softening", softening);
            report.put("effects.stiffening", stiffening);
            report.line("effects", effects.in_words());
        }
        if let Some(most) = self.deflection.iter().copied().reduce(f64::max) {
            report.put("deflection", &self.deflection[..]);
            let most = quantity(most);
            report.line("rest", format!("bent by up to {most} {length}: vibrations about the rest at each speed"));
        }
        if let Some(reason) = &self.no_rest {
            report.put("no_rest", reason);
            report.line("rest", format!("{reason}: vibrations about the undeformed body"));
        }
        report.put("stable_below", self.stable_below);
        report.line("stable", self.stability(time));
        report.put("speeds", &self.speeds[..]);
        self.put_branches(&mut report, [length, time], &unit);
        self.put_critical_speeds(&mut report, time, &unit);
        report.warnings.clone_from(&self.warnings);
        report.charts.push(("campbell", self.chart(title, time, &unit, orders).into()));
        report
    }

    fn stability(&self, time: &str) -> String {
        match self.stable_below {
            Some(speed) if self.of_undeformed() => {
                let asks = if self.no_rest.is_none() { " (`--about-rest always` asks the full body)" } else { "" };
                format!("below {} rad/{time}, about the undeformed body{asks}", quantity(speed))
            }
            Some(speed) if self.speeds.first().is_some_and(|first| *first >= speed) => {
                format!("not at {} rad/{time}, the lowest speed of this range", quantity(speed))
            }
            Some(speed) => format!("below {} rad/{time}", quantity(speed)),
            None if !self.of_undeformed() => "at all speeds of this range".to_owned(),
            None => "no frequency falls to zero at any speed".to_owned(),
        }
    }

    /// A row a speed: the frequencies of all modes, then their growth, then their whirl, and the deflection of a body that is bent.
    fn put_branches(&self, report: &mut Report, [length, time]: [&str; 2], unit: &str) {
        let speeds = || self.speeds.iter().copied();
        let mut rows = Table::new("campbell", None).column("speed", speeds());
        let mut shown = Table::new("", None).titled(format!("frequency, {unit}")).most(ROWS).spread();
        shown = with_turns(shown.text_only(format!("rad/{time}"), Form::Fixed(3), speeds()), time, speeds());
        if !self.deflection.is_empty() {
            shown = shown.text_only(format!("bent, {length}"), Form::Plain, self.deflection.iter().copied());
        }
        let each = || self.branches.iter();
        for of in each() {
            rows = rows.column(format!("frequency_{}", of.mode), of.frequency.iter().copied());
        }
        for of in each() {
            rows = rows.column(format!("growth_{}", of.mode), of.growth.iter().copied());
        }
        for of in each() {
            rows = rows.column(format!("whirl_{}", of.mode), of.whirl.iter().copied());
        }
        if !self.deflection.is_empty() {
            rows = rows.column("deflection", self.deflection.iter().copied());
        }
        for of in each().take(COLUMNS) {
            let cells = of.frequency.iter().zip(&of.growth);
            let cells =
                cells.map(|(frequency, growth)| format!("{frequency:.3}{}", if *growth > 0.0 { "!" } else { "" }));
            shown = shown.text_only(of.label(), Form::Plain, cells);
        }
        report.put("branches", Value::of(&self.branches));
        report.csv_tables.push(rows);
        report.table(shown);
        if each().take(COLUMNS).flat_map(|of| &of.growth).any(|growth| *growth > 0.0) {
            report.words("  ! the vibration grows");
        }
        if self.branches.len() > COLUMNS {
            report.words(format!("  {COLUMNS} of {} modes; campbell.csv has them all", self.branches.len()));
        }
    }

    fn put_critical_speeds(&self, report: &mut Report, time: &str, unit: &str) {
        let words = |kind: CriticalKind| match kind {
            CriticalKind::Crossing => "",
            CriticalKind::ZeroFrequency if self.of_undeformed() => {
                "the frequency is zero: no rest of the model from here on"
            }
            CriticalKind::ZeroFrequency => "the frequency is zero: a limit of stability",
            CriticalKind::GrowthBegins => "the vibration grows from here on: a limit of stability",
            CriticalKind::GrowthEnds => "the vibration grows up to here: a limit of stability",
        };
        let each = || self.critical_speeds.iter();
        let table = Table::new("critical_speeds", "critical_speeds")
            .titled("critical speeds")
            .without_rows("no critical speed in this range")
            .all()
            .text_only("order", Form::Plain, each().map(|of| format!("{}x", of.order)))
            .column("order", each().map(|of| of.order))
            .shown("mode", "mode", Form::Plain, each().map(|of| of.mode))
            .shown("speed", format!("rad/{time}"), Form::Fixed(3), each().map(|of| of.speed));
        let table = with_turns(table, time, each().map(|of| of.speed));
        report.table(
            table
                .shown("frequency", format!("frequency, {unit}"), Form::Fixed(3), each().map(|of| of.frequency))
                .column("kind", each().map(|of| of.kind.name()))
                .text_only("", Form::Plain, each().map(|of| words(of.kind))),
        );
        if !self.swing_limits.is_empty() {
            report.put("swing_limits", Value::of(&self.swing_limits));
        }
        for &SwingLimit { mode, speed, swings_above } in &self.swing_limits {
            let (swings, decays) = if swings_above { ("above", "below") } else { ("below", "above") };
            let speed = quantity(speed);
            report.words(format!(
                "  mode {mode} swings {swings} {speed} rad/{time}; {decays} it is damped so much that it only decays"
            ));
        }
    }

    /// Branches far above every order are left out.
    fn chart(&self, title: &str, time: &str, unit: &str, orders: &[f64]) -> LineChart {
        let [start, end] = [self.speeds.first(), self.speeds.last()].map(|speed| speed.copied().unwrap_or_default());
        let top = self.top(orders.iter().copied().fold(0.0, f64::max) * end / TAU);
        let drawn = self.branches.iter().filter(|branch| branch.frequency.iter().any(|f| *f <= top));
        let branch = |(k, branch): (usize, &Branch)| Series {
            label: branch.label(),
            points: self.speeds.iter().copied().zip(branch.frequency.iter().copied()).collect(),
            stroke: Stroke::of_line(k),
        };
        let mut series: Vec<Series> = drawn.take(MAX_BRANCHES).enumerate().map(branch).collect();
        for order in orders {
            let points = vec![(start, order * start / TAU), (end, order * end / TAU)];
            series.push(Series { label: format!("{order}×"), points, stroke: Stroke::Guide });
        }
        let points: Vec<(f64, f64)> = self.critical_speeds.iter().map(|c| (c.speed, c.frequency)).collect();
        if !points.is_empty() {
            series.push(Series { label: "critical speed".to_owned(), points, stroke: Stroke::Rings });
        }
        let axis = self.axis.map(|x| format!("{}", (1e4 * x).round() / 1e4).replace('-', "−")).join(", ");
        LineChart {
            title: format!("{title}: natural frequencies in spin about ({axis})"),
            x_label: format!("Spin speed Ω (rad/{time})"),
            y_label: format!("Frequency ({unit})"),
            x_scale: Scale::Linear,
            y_scale: Scale::Window(0.0, top),
            series,
            reference: None,
        }
    }

    /// The highest frequency drawn: above all orders and the lowest branch, but not far above all branches.
    fn top(&self, highest_order: f64) -> f64 {
        let most = |frequency: &[f64]| frequency.iter().copied().fold(0.0, f64::max);
        let lowest = self.branches.iter().map(|branch| most(&branch.frequency)).fold(f64::INFINITY, f64::min);
        let highest = self.branches.iter().map(|branch| most(&branch.frequency)).fold(0.0, f64::max);
        (ABOVE_ORDERS * highest_order.max(lowest)).min(ABOVE_BRANCHES * highest)
    }
}

/// A table with the turns a minute of some speeds, where time is in seconds.
fn with_turns(table: Table, time: &str, speeds: impl Iterator<Item = f64>) -> Table {
    match time {
        "s" => table.text_only("rpm", Form::Fixed(1), speeds.map(|speed| 60.0 * speed / TAU)),
        _ => table,
    }
}
