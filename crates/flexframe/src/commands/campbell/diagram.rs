//! The diagram of a family of vibrations: branches, and the limits that branches pass.

use diagnostic::Failure;
use dynamics::SpinMode;

use super::branches::Branches;
use super::critical::CriticalKind;
use super::family::Family;
use super::limits::Limits;
use super::report::Diagram;

/// The branches over rising speeds, of which the last ones are static shapes, and the limits that they pass.
pub(super) fn diagram(
    family: &dyn Family,
    static_shapes: usize,
    speeds: Vec<f64>,
    orders: &[f64],
    done: impl FnMut(usize),
) -> Result<Diagram, Failure> {
    let branches = Branches::follow(family, speeds, done)?;
    let Limits { critical, swings } = Limits::of(family, &branches, orders)?;
    let stable_below = match family.resonances(0.0)? {
        Some(speeds) => speeds.first().copied(),
        None => {
            let grows = |here: &Vec<SpinMode>| here.iter().any(|mode| mode.growth > 0.0);
            let unstable = branches.modes.iter().position(grows).map(|at| branches.speeds[at]);
            let ends = |kind| matches!(kind, CriticalKind::ZeroFrequency | CriticalKind::GrowthBegins);
            let ends = critical.iter().filter(|critical| ends(critical.kind)).map(|critical| critical.speed);
            ends.chain(unstable).reduce(f64::min)
        }
    };
    Ok(Diagram {
        stable_below,
        critical_speeds: critical,
        swing_limits: swings,
        branches: branches.lines(static_shapes),
        speeds: branches.speeds,
        ..Diagram::default()
    })
}
