//! The estimate of the check, and the truth.

use model::{Builder, Checker};
use nalgebra::Vector3;
use nonlinear::{EquilibriumSettings, NonlinearError, StateErrorSettings, equilibrium, state_error};
use scene::Body;

use super::cases::{CheckedCase, MODELS, Truth};
use super::rest::rest;
use crate::nonlinear::bodies::mesh_path;

/// A case in a model.
#[derive(Debug, Clone)]
pub struct CaseInModel {
    /// The case.
    pub case: String,
    /// Its parameter.
    pub parameter: f64,
    /// The model.
    pub model: &'static str,
    /// Displacement of the tip over the largest extent of the body.
    pub deflection: f64,
    /// True error of the model at the tip, of the true displacement.
    pub error: f64,
    /// Estimate over truth after one factor and after two.
    pub estimates: [f64; 2],
    /// Error of the model's displacements over the body, and what the check states with its own settings.
    pub stated: [f64; 2],
    /// Factors that the truth took, from the undeformed body.
    pub factors: usize,
}

/// The pairs of a case, in all models.
///
/// # Errors
/// As [`pair`].
pub fn pairs(case: &CheckedCase, left_out: &mut Vec<String>) -> Result<Vec<CaseInModel>, String> {
    let found = (0..MODELS.len()).map(|model| pair(case, model, left_out)).collect::<Result<Vec<_>, _>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// The pair of a case and a model; one without a rest is left out, and named in `left_out`.
///
/// # Errors
/// Scenes that are refused, and factors that cannot be made, in words.
pub fn pair(case: &CheckedCase, model: usize, left_out: &mut Vec<String>) -> Result<Option<CaseInModel>, String> {
    let (name, modes, effects) = MODELS[model];
    let builder = Builder::default();
    let base = build(&builder, case, ["", ""], [0.0; 3])?.1;
    let omega = base.body.circular_frequencies[0];
    // A force at the end of a bar with a quarter of its mass there.
    let force = omega * omega * 0.25 * base.body.mass;
    let [spin, push, gravity] = case.parts.map(|part| part * case.parameter);
    let numbers = [spin * omega, push * force, gravity * omega * omega];
    let (scene, model) = build(&builder, case, [modes, effects], numbers)?;
    let words = |error: &dyn std::fmt::Display| format!("{} in {name}: {error}", case.name);
    let Some((moving, motion)) = rest(&scene, &model) else {
        left_out.push(format!("{} ({}), {name}: it finds no rest", case.name, case.parameter));
        return Ok(None);
    };
    let full = builder.full(&scene, |_| ()).map_err(|error| words(&error))?.ok_or("no elements")?;
    let body = full.body().map_err(|error| words(&error))?;
    let checker = Checker::new(&full, &scene, &model, &body).map_err(|error| words(&error))?;
    let observed = moving.observed_at(&motion, &[]).map_err(|error| words(&error))?;
    let state = checker.state(&observed, &[]).map_err(|error| words(&error))?;
    let at_rest = body.at_rest().map_err(|error| words(&error))?;
    let by = |settings: StateErrorSettings| state_error(&body, &at_rest, &state, &settings);
    let found = match case.truth {
        // From the undeformed body, whatever the model says.
        Truth::Rest => {
            let settings = EquilibriumSettings::default();
            equilibrium(&body, &state.forces, &state.omega_body, None, &settings)
                .map(|rest| (rest.displacement, rest.factors, true))
        }
        Truth::OfRow => by(StateErrorSettings::converged()).map(|row| {
            let sum = row.error.iter().zip(&state.displacement).map(|(e, u)| u + e).collect();
            (sum, row.factors, row.last_change < 1e-3)
        }),
    };
    let (of_truth, factors) = match found {
        Ok((truth, factors, true)) => (truth, factors),
        Ok(_) | Err(NonlinearError::NoEquilibrium { .. } | NonlinearError::NotFinite { .. }) => {
            left_out.push(format!("{} ({}), {name}: the full body finds no rest", case.name, case.parameter));
            return Ok(None);
        }
        Err(error) => return Err(words(&error)),
    };
    let true_error: Vec<f64> = of_truth.iter().zip(&state.displacement).map(|(t, u)| t - u).collect();
    let two = StateErrorSettings { small: 0.0, settled: 0.0, max_factors: 2 };
    let estimate = by(two).map_err(|error| words(&error))?;
    let own = by(StateErrorSettings::default()).map_err(|error| words(&error))?;
    let nodes = full_tip(&body, case.tip);
    let at = |list: &[f64]| Vector3::from_column_slice(&list[3 * nodes..3 * nodes + 3]).norm();
    let true_size = body.mass_norm(&of_truth);
    let own_truth: Vec<f64> = state.displacement.iter().zip(&own.error).map(|(u, e)| u + e).collect();
    let extent = body.mesh().size().into_iter().fold(0.0, f64::max);
    Ok(Some(CaseInModel {
        case: case.name.clone(),
        parameter: case.parameter,
        model: name,
        deflection: at(&of_truth) / extent,
        error: at(&true_error) / at(&of_truth),
        estimates: [&estimate.first, &estimate.error].map(|e| at(e) / at(&true_error)),
        stated: [body.mass_norm(&true_error) / true_size, body.mass_norm(&own.error) / body.mass_norm(&own_truth)],
        factors,
    }))
}

/// The node nearest to a point.
fn full_tip(body: &nonlinear::FullBody<'_>, tip: [f64; 3]) -> usize {
    let distance = |node: &usize| (Vector3::from(body.mesh().positions()[*node]) - Vector3::from(tip)).norm();
    (0..body.mesh().positions().len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

fn build(
    builder: &Builder,
    case: &CheckedCase,
    [modes, effects]: [&str; 2],
    [spin, force, gravity]: [f64; 3],
) -> Result<(Body, model::Model), String> {
    let material = case.material;
    let rest = case.text.replace("SPIN", &format!("{spin:e}")).replace("FORCE", &format!("{force:e}"));
    let rest = rest.replace("GRAVITY", &format!("{gravity:e}"));
    let initial =
        if case.spins { format!("[initial]\nangular_velocity = [0.0, 0.0, {spin:e}]\n") } else { String::new() };
    let text = format!(
        "title = \"Check\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\nmesh = \"{}\"\n\
         material = {{ young_modulus = {:e}, poisson_ratio = {:e}, density = {:e} }}\n\
         [modes]\nflexible = 10\n{modes}{rest}{initial}[effects]\nrefuse = false\n{effects}\
         [time]\nend = 1e-3\nstep = 1e-4\n",
        mesh_path(case.mesh).display(),
        material.young_modulus,
        material.poisson_ratio,
        material.density
    );
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scene.toml");
    let body = Body::parse(&text, path).map_err(|error| error.to_string())?;
    let model = builder.build(&body, |_| ()).map_err(|error| format!("{}: {error}", case.name))?;
    Ok((body, model))
}
