//! The motion of the body as a whole: what excites it, and how a change of its spin adds up.

use crate::motion::case::Case;
use crate::motion::excitation::Spin;
use crate::motion::response::{Response, norm};
use crate::motion::source::Source;
use crate::table::estimate::Estimate;
use crate::table::relative::relative;

/// Relative change of the attitude by a change of momentum that is there all the time (in the scale of
/// [`Spin::momentum`]): of the angle turned up to 1 rad, or of the vibration where the body hardly turns.
pub(crate) fn attitude_change(case: &Case, spin: &Spin, momentum: f64, vibration: f64) -> f64 {
    if case.drive.is_some() || case.body.motion.count() == 0 || momentum == 0.0 {
        return 0.0;
    }
    let turned = spin.certain_momentum * if spin.turn > 1.0 { case.end / spin.turn } else { case.end };
    relative(momentum * case.end * separation(case, spin), turned.max(vibration))
}

/// How far two neighbouring motions of a rigid body move apart: near its middle axis they do so exponentially.
fn separation(case: &Case, spin: &Spin) -> f64 {
    if case.body.motion.rotations().len() < 3 {
        return 1.0;
    }
    let eigen = case.body.inertia.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|i, j| eigen.eigenvalues[*i].total_cmp(&eigen.eigenvalues[*j]));
    let [a, b, c] = order.map(|i| eigen.eigenvalues[i]);
    let omega = case.initial.omega;
    let about_middle = eigen.eigenvectors.column(order[1]).dot(&omega).abs() > 0.7 * omega.norm();
    let growth = spin.largest * ((b - a) * (c - b) / (a * c)).max(0.0).sqrt() * case.end;
    if omega.norm() > 0.0 && about_middle { growth.min(50.0).exp() } else { 1.0 }
}

pub(crate) fn gravity(case: &Case, sources: &[Source], response: &Response) -> Estimate {
    if !case.is_gravity.contains(&true) {
        return Estimate { value: 0.0, influence: 0.0, why: "There is none.".into() };
    }
    let sum = |gravity: bool, of: &dyn Fn(&Source) -> f64| -> f64 {
        sources.iter().filter(|s| s.gravity == gravity).map(|s| of(s) * s.impulse()).sum()
    };
    let initial = case.initial;
    let body = case.body;
    let spin = (body.rotation_basis.transpose() * body.inertia * initial.omega).norm();
    let share = |part: f64, rest: f64| relative(part, part + rest);
    let largest = |of: &dyn Fn(&Source) -> f64| {
        sources.iter().filter(|s| !s.gravity).map(|s| of(s) * s.impulse()).fold(0.0, f64::max)
    };
    // A velocity at the start makes gravity no smaller, and what else pushes the body does not if gravity takes it from where it would be.
    let impulse = sum(true, &|s| s.translation);
    let path = impulse / body.mass.sqrt() * case.end;
    let moved = share(impulse, largest(&|s| s.translation)).max((path / case.length).min(1.0));
    let turned = share(sum(true, &|s| s.rotation), spin.max(largest(&|s| s.rotation)));
    // Gravity that begins with the run swings the modes to twice its static response, and what it adds goes on from there.
    let bent = relative(4.0 * norm(&response.of_gravity), response.scale);
    let value = moved.max(turned);
    let why = format!(
        "It makes {moved:.1e} of the translation, {turned:.1e} of the rotation and {bent:.1e} of the deformation."
    );
    Estimate { value, influence: value.max(bent), why }
}

pub(crate) fn translation(case: &Case, sources: &[Source]) -> Estimate {
    let pushed: f64 = sources.iter().map(|s| s.translation * s.impulse()).sum();
    let start = (case.body.translation_basis.transpose() * case.initial.velocity * case.body.mass).norm();
    let driven = matches!(case.drive.map(|d| d.motion), Some(dynamics::DrivenMotion::Slide { .. }));
    // All or nothing: whatever moves the body moves all of its points.
    let value = f64::from(u8::from(driven || pushed + start > 0.0));
    let why = match (value > 0.0, case.body.translation_basis.iter().all(|x| *x == 0.0)) {
        (true, _) => "Something moves the body as a whole.",
        (false, true) => "What holds the body leaves none.",
        (false, false) => "Nothing ever pushes the body.",
    };
    Estimate { value, influence: value, why: why.into() }
}

pub(crate) fn rotation(case: &Case, spin: &Spin, sources: &[Source], response: &Response) -> Estimate {
    let driven = matches!(case.drive.map(|d| d.motion), Some(dynamics::DrivenMotion::Turn { .. }));
    if driven || spin.certain > 0.0 {
        return Estimate { value: 1.0, influence: 1.0, why: "The body turns from the beginning, or is driven.".into() };
    }
    if case.body.rotation_basis.iter().all(|x| *x == 0.0) {
        return Estimate { value: 0.0, influence: 0.0, why: "What holds the body leaves none.".into() };
    }
    // Beside the moments: the arms that a deflection adds, and what vibrations of two modes turn.
    let basis = case.body.rotation_basis.singular_values().max();
    let bent: f64 = response.displacement.iter().zip(case.peaks).map(|(q, a)| q * a).sum();
    let arms: f64 = sources.iter().map(|s| s.translation * case.body.mass.sqrt() * s.impulse() * bent * basis).sum();
    let g = crate::motion::tensor::of_vectors(&case.body.gyroscopic, &case.body.rotation_basis);
    let (q, v) = (&response.displacement, &response.velocity);
    let exchanged: f64 =
        (0..q.len()).flat_map(|k| (0..v.len()).map(move |l| (k, l))).map(|(k, l)| g[(k, l)] * q[k] * v[l]).sum();
    let turned = spin.momentum + arms + exchanged;
    let pushed = sources.iter().map(|s| s.translation * s.impulse()).fold(0.0, f64::max);
    let value = relative(turned, (pushed + response.scale / case.end).max(f64::MIN_POSITIVE));
    let why = if value == 0.0 { "Nothing ever turns the body." } else { "The loads or the vibrations turn the body." };
    Estimate { value, influence: value, why: why.into() }
}
