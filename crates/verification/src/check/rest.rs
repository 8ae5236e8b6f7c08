//! The rest of a model in its coordinates: q̈ = 0 with q̇ = 0.

use dynamics::{ConservativeBody, MotionState};
use faer::Mat;
use faer::linalg::solvers::Solve;
use model::Model;
use scene::Body;

/// Most iterations, and the change over the size that ends them.
const MOST: usize = 60;
const CHANGE: f64 = 1e-11;

/// The state of rest of a model, with the spin of its start or of its drive; `None` where there is none.
pub fn rest(given: &Body, model: &Model) -> Option<(ConservativeBody, MotionState)> {
    let initial = model.initial(given);
    let body = ConservativeBody::new(&model.body, model.damping_ratios(), model.loads().to_vec(), &model.physics);
    let body = body.ok()?.beginning_at(&initial);
    // Of a body that is held, or whose drive holds its spin, the program knows it.
    if model.body.motion.count() == 0 {
        return Some((body, model.rest(given).ok()?));
    }
    let nf = model.body.flexible();
    let beginning = initial.state(&model.body);
    let at =
        |q: &[f64]| MotionState { modal_displacement: q.to_vec(), modal_velocity: vec![0.0; nf], ..beginning.clone() };
    let acceleration = |q: &[f64]| Some(body.observed_at(&at(q), &[]).ok()?.modal_acceleration);
    let omega = &model.body.circular_frequencies;
    let mut q = vec![0.0; nf];
    // The answer of the undeformed body sets the scale of differences.
    let mut scale = 1e-12;
    for _ in 0..MOST {
        let here = acceleration(&q)?;
        scale = here.iter().zip(omega).map(|(a, w)| (a / (w * w)).abs()).fold(scale, f64::max);
        let mut jacobian = Mat::zeros(nf, nf);
        for k in 0..nf {
            let h = 1e-5 * scale;
            let moved = |sign: f64| {
                let mut moved = q.clone();
                moved[k] += sign * h;
                acceleration(&moved)
            };
            let (after, before) = (moved(1.0)?, moved(-1.0)?);
            for i in 0..nf {
                jacobian[(i, k)] = (after[i] - before[i]) / (2.0 * h);
            }
        }
        let right = Mat::from_fn(nf, 1, |i, _| -here[i]);
        let change = jacobian.partial_piv_lu().solve(&right);
        let size = |list: &[f64]| list.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
        let way: Vec<f64> = (0..nf).map(|k| change[(k, 0)]).collect();
        // No further at once than the linear answer is large.
        let part = (scale / size(&way)).min(1.0);
        q.iter_mut().zip(&way).for_each(|(q, way)| *q += part * way);
        if !q.iter().all(|q| q.is_finite()) {
            return None;
        }
        if size(&way) <= CHANGE * size(&q) {
            return Some((body, at(&q)));
        }
    }
    None
}
