//! Real influence of an effect: the scene run with it switched.

use advice::Subject;
use diagnostic::{Diagnostic, Failure};
use dynamics::{Effect, EffectMap, Observation, Rows, StepControl};
use model::{ModeCount, Model, Needs, Variants};
use nalgebra::{Matrix3, Vector3};
use scene::Body;

use crate::commands::run::RunFailure;
use crate::rows::effects::is_on;

/// Times at which motions are compared.
const COMPARED: f64 = 500.0;

/// An attitude that turns by less, rad, does not turn: what rounding may do.
const LEAST_TURN: f64 = 1e-6;
/// Rounding error of an attitude, rad.
const ROUNDING: f64 = 1e-14;

const FLEXIBILITY: Subject = Subject::Effect(Effect::Flexibility);

/// Result of switching an effect.
pub(super) enum Real {
    /// Relative difference of the motions.
    Difference(f64),
    /// One of the runs fails, with the reason.
    Fails(String),
}

/// The scene as it is.
pub(super) struct Base<'a, 'b> {
    body: &'a Body,
    model: &'a Model,
    needs: &'a Needs,
    builder: &'a mut Variants<'b>,
    motion: Vec<Observation>,
}

impl<'a, 'b> Base<'a, 'b> {
    pub(super) fn new(
        body: &'a Body,
        needs: &'a Needs,
        model: &'a Model,
        builder: &'a mut Variants<'b>,
    ) -> Result<Self, Failure> {
        // Settled as the others are, so that nothing but the switch is between them.
        let settled = settled(needs, body, model, None);
        let motion = follow(body, needs, &builder.build(body, &settled, |_| ())?);
        let motion = motion.map_err(|source| source.in_file(&body.path))?;
        Ok(Self { body, needs, model, builder, motion })
    }

    /// The difference that switching an effect or the static shapes makes.
    pub(super) fn influence(&mut self, subject: Subject) -> Real {
        let Some(on) = is_on(self.body, self.model, subject) else { return Real::Difference(0.0) };
        let switched = settled(self.needs, self.body, self.model, Some((subject, !on)));
        let model = match self.builder.build(self.body, &switched, |_| ()) {
            Ok(model) => model,
            Err(error) => return Real::Fails(error.to_string()),
        };
        match follow(self.body, self.needs, &model) {
            Ok(motion) => Real::Difference(self.difference(&motion, subject)),
            Err(failure) => Real::Fails(failure.to_string()),
        }
    }

    /// Largest relative difference of the motions: of the modal displacements (flexibility: the deflection over the
    /// length), of the attitude against the angle turned (up to 1 rad), and of the way of the centre of mass.
    fn difference(&self, other: &[Observation], subject: Subject) -> f64 {
        let (a, b) = (&self.motion, other);
        let norm = |q: &[f64]| q.iter().map(|q| q * q).sum::<f64>().sqrt();
        let largest = |of: &dyn Fn(&Observation) -> f64| a.iter().chain(b).map(of).fold(0.0, f64::max);
        let turned = |x: &Observation, y: &Observation| {
            let change = x.attitude.global_to_body() * y.attitude.global_to_body().transpose();
            (change - Matrix3::identity()).norm() / 2.0_f64.sqrt()
        };
        let way = |x: &Observation| (x.position_global - a[0].position_global).norm();
        let deformation = largest(&|x| norm(&x.modal_displacement));
        let angle = largest(&|x| turned(x, &a[0])).min(1.0);
        let travelled = largest(&way);
        let relative = |part: f64, whole: f64| if part > 1e-12 * whole { part / whole } else { 0.0 };
        let apart = a.iter().zip(b).map(|(x, y)| {
            let bent = if subject == FLEXIBILITY {
                0.0
            } else {
                let count = x.modal_displacement.len().max(y.modal_displacement.len());
                let at = |o: &Observation, k: usize| o.modal_displacement.get(k).copied().unwrap_or(0.0);
                relative(norm(&(0..count).map(|k| at(x, k) - at(y, k)).collect::<Vec<_>>()), deformation)
            };
            let moved: Vector3<f64> = x.position_global - y.position_global;
            bent.max(if angle > LEAST_TURN { relative((turned(x, y) - ROUNDING).max(0.0), angle) } else { 0.0 })
                .max(relative(moved.norm(), travelled))
        });
        let apart = apart.fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x) });
        if subject == FLEXIBILITY {
            apart.max(largest(&|x| self.model.deflection(&x.modal_displacement)))
        } else {
            apart
        }
    }
}

/// Needs with all effects and static shapes as a model has them, but for one that is switched.
pub(crate) fn settled(needs: &Needs, body: &Body, model: &Model, switched: Option<(Subject, bool)>) -> Needs {
    let natural = model.body.flexible() - model.static_shapes();
    let has_all = switched == Some((FLEXIBILITY, true));
    let choose = |subject: Subject| match switched {
        Some((of, on)) if of == subject => on,
        _ => is_on(body, model, subject).unwrap_or(false),
    };
    let large: Vec<usize> =
        model.large_modes().iter().filter(|k| model.static_answer() != Some(**k)).map(|k| k + 1).collect();
    Needs {
        flexible: Some(if has_all { ModeCount::All } else { ModeCount::Count(natural) }),
        large: Some(large).filter(|large| !large.is_empty()),
        static_correction: Some(choose(Subject::StaticCorrection)),
        effects: EffectMap::from_fn(|effect| Some(choose(Subject::Effect(effect)))),
        ..needs.clone()
    }
}

fn follow(body: &Body, needs: &Needs, model: &Model) -> Result<Vec<Observation>, RunFailure> {
    let control = body.time.control;
    let interval = match control {
        StepControl::Fixed(step) => (body.time.end / step / COMPARED).ceil() * step,
        StepControl::Tolerance(_) => body.time.end / COMPARED,
    };
    let method = needs.method_of(body);
    let simulation = model.start_with(body, method, control, Rows::Interval(interval))?;
    Ok(simulation.collect::<Result<Vec<_>, _>>()?)
}
