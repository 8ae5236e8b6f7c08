//! The spin that the paper's scheme makes or loses in steady rotation.

use flexframe::dynamics::{Rows, StepControl};
use flexframe::frames_rk4;
use flexframe::model::{BuildError, Builder, ModeCount, Needs};
use flexframe::scene::Scene;

/// Steps of the runs.
const STEPS: [u64; 4] = [1000, 2000, 5000, 10_000];

/// Change of the spin by a run of the paper's scheme.
pub(super) struct SpinRow {
    pub flexible: usize,
    pub step: f64,
    /// ln(|ω| at the end / |ω| at the beginning) per time.
    pub rate: f64,
    /// The same for the limit of short steps.
    pub rate_of_limit: f64,
}

/// Runs the paper's scheme, and its limit, with all and with half of the modes. Runs that fail are left
/// out.
pub(super) fn spin_rates(scene: &Scene) -> Result<Vec<SpinRow>, BuildError> {
    let end = scene.time.end;
    let mut rows = Vec::new();
    let assembly = Builder::default().assemble(scene, |_| ())?;
    let mut variants = assembly.variants()?;
    let model = variants.build(scene, &Needs::default(), |_| ())?;
    let most = model.body.flexible() - model.static_shapes();
    for flexible in [most / 2, most] {
        let needs = Needs { flexible: Some(ModeCount::Count(flexible)), ..Needs::default() };
        let model = variants.build(scene, &needs, |_| ())?;
        let rate = |method, step| -> Option<f64> {
            let rows = model.start_with(scene, method, StepControl::Fixed(step), Rows::Interval(end)).ok()?;
            let spins: Vec<f64> =
                rows.map(|row| row.map(|now| now.omega_body.norm())).collect::<Result<_, _>>().ok()?;
            Some((spins.last()? / spins.first()?).ln() / end)
        };
        let finest = end / STEPS.into_iter().fold(1, u64::max) as f64;
        let Some(rate_of_limit) = rate(frames_rk4::LIMIT, finest) else { continue };
        rows.extend(STEPS.iter().filter_map(|steps| {
            let step = end / *steps as f64;
            Some(SpinRow { flexible, step, rate: rate(frames_rk4::PAPER, step)?, rate_of_limit })
        }));
    }
    Ok(rows)
}
