//! The check of bodies that move: what it says of a row, and how far the model is from the nonlinear body at that time.

use fem_tet10::Material;
use model::{Builder, Checker};
use nalgebra::Vector3;
use nonlinear::StateErrorSettings;

use crate::nonlinear::cases::{built, peaks, rows, shape};
use crate::nonlinear::{NodalState, Solid, SolidMotion, bodies, mean_axes};

/// A body that is let go from its first mode.
#[derive(Debug, Clone, Copy)]
pub struct LetGo {
    /// Its name.
    pub name: &'static str,
    mesh: &'static str,
    material: Material,
    /// Largest displacement over the length of 1 m.
    pub deflection: f64,
    clamped: bool,
    /// Name and scene keys of the model.
    pub model: &'static str,
    modes: &'static str,
    effects: &'static str,
}

/// A row of a motion.
#[derive(Debug, Clone, Copy)]
pub struct MotionRow {
    /// Time over the period of the linear first mode.
    pub periods: f64,
    /// Distance of the model from the nonlinear body at that time over the largest displacement of that in the motion, both over the body.
    pub off: f64,
    /// The error that the check states, over the same.
    pub stated: f64,
    /// Its part beside the modes.
    pub beside: f64,
    /// The frequency of the first mode that it states, over the model's, less 1.
    pub frequency: f64,
}

/// Periods, modes, steps of a period of the nonlinear body and of the model, and rows of a period.
const PERIODS: usize = 4;
const MODES: usize = 8;
const STEPS: usize = 200;
const FINE: usize = 10;
const ROWS: usize = 8;

/// The motions.
pub fn motions() -> Vec<LetGo> {
    const LINEAR: (&str, &str, &str) = ("linear", "", "large_deflection = false\n");
    const LARGE: (&str, &str, &str) = ("large modes", "large = 2\n", "large_deflection = true\n");
    let mut all = Vec::new();
    for (model, modes, effects) in [LINEAR, LARGE] {
        for (name, mesh, material, deflection, clamped) in [
            ("clamped column", "column", bodies::COLUMN, 0.03, true),
            ("clamped column", "column", bodies::COLUMN, 0.1, true),
            ("free L", "l", bodies::SOFT, 0.03, false),
        ] {
            all.push(LetGo { name, mesh, material, deflection, clamped, model, modes, effects });
        }
    }
    all
}

/// Lets it go, and checks rows of the last period.
///
/// # Errors
/// Scenes and steps that fail, in words.
pub fn let_go(case: &LetGo) -> Result<Vec<MotionRow>, String> {
    let words = |error: &dyn std::fmt::Display| format!("{} in {}: {error}", case.name, case.model);
    let clamp = if case.clamped { "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n" } else { "" };
    let text = |initial: &str, end: f64, step: f64, rows: &str| {
        format!(
            "[modes]\nflexible = {MODES}\nstatic_correction = false\n{}{clamp}{initial}[effects]\nrefuse = false\n{}\
             {rows}[time]\nend = {end:e}\nstep = {step:e}\n",
            case.modes, case.effects
        )
    };
    let (_, model) = built(case.mesh, case.material, &text("", 1e-3, 1e-3, "")).map_err(|error| words(&error))?;
    let period = std::f64::consts::TAU / model.body.circular_frequencies[0];
    let held = |x: Vector3<f64>| case.clamped && x.x < 1e-9;
    let mesh = bodies::mesh(case.mesh).map_err(|error| words(&error))?;
    let solid = Solid::new(mesh, case.material, held).map_err(|error| words(&error))?;
    // Held in its first mode, and at rest in all others.
    let phi = shape(&model, 0);
    let mut shapes = vec![phi.clone()];
    if let Some(meshed) = model.meshed.as_ref().filter(|_| !case.clamped) {
        shapes.extend(meshed.modes.rigid.shapes.col_iter().map(|column| column.iter().copied().collect()));
    }
    let mut amounts = vec![0.0; shapes.len()];
    amounts[0] = case.deflection / peaks(&phi, 0)[0];
    let omega = model.body.circular_frequencies[0];
    let u = solid.held_in_modes(&shapes, &amounts, 0.3 * omega * omega, 8).map_err(|error| words(&error))?;
    // The coordinates of the model whose displacements have the same parts along its modes.
    let along = |k: usize| -> f64 { solid.momentum(&shape(&model, k)).iter().zip(&u).map(|(m, u)| m * u).sum() };
    let wanted: Vec<f64> = (0..MODES).map(along).collect();
    let mut start = wanted.clone();
    for _ in 0..10 {
        let found = model.coordinates(&start);
        start.iter_mut().zip(wanted.iter().zip(found)).for_each(|(q, (wanted, found))| *q += wanted - found);
    }
    let initial = format!("[initial]\nmodal_displacement = {start:?}\n");
    let h = period / STEPS as f64;
    let end = PERIODS as f64 * period;
    let every = format!("[output]\ninterval = {:e}\n", period / ROWS as f64);
    let text = text(&initial, end, h / FINE as f64, &every);
    let (scene, model) = built(case.mesh, case.material, &text).map_err(|error| words(&error))?;
    let observed = rows(&scene, &model).map_err(|error| words(&error))?;

    let full = Builder::default().full(&scene, |_| ()).map_err(|error| words(&error))?.ok_or("no elements")?;
    let body = full.body().map_err(|error| words(&error))?;
    let checker = Checker::new(&full, &scene, &model, &body).map_err(|error| words(&error))?;
    let on_nodes = |row: &dynamics::Observation| {
        checker.state(row, &[]).map(|state| state.displacement).map_err(|error| words(&error))
    };
    let largest = body.mass_norm(&u);
    let state = NodalState { time: 0.0, v: vec![0.0; u.len()], u };
    let mut motion = SolidMotion::new(&solid, state, h, |_, u: &[f64]| vec![0.0; u.len()]);
    let mut found = Vec::new();
    for step in 1..=PERIODS * STEPS {
        motion.advance().map_err(|error| words(&error))?;
        let is_row = step % (STEPS / ROWS) == 0 && step > (PERIODS - 1) * STEPS;
        let Some(row) = observed.get(step * ROWS / STEPS).filter(|_| is_row) else { continue };
        let truth = if case.clamped { motion.state.u.clone() } else { mean_axes(&solid, &motion.state.u).displacement };
        let off: Vec<f64> = truth.iter().zip(on_nodes(row)?).map(|(t, u)| t - u).collect();
        let state = dynamics::MotionState {
            time: row.time,
            attitude: row.attitude,
            origin_global: row.origin_global,
            velocity_global: row.velocity_global,
            omega_body: row.omega_body,
            modal_displacement: row.modal_displacement.clone(),
            modal_velocity: row.modal_velocity.clone(),
        };
        let check = checker.check(&state, &[], &StateErrorSettings::default(), true).map_err(|error| words(&error))?;
        let own = on_nodes(row)?;
        // What the check states is relative to the displacements of the row.
        let size = body.mass_norm(&own) / largest;
        found.push(MotionRow {
            periods: step as f64 / STEPS as f64,
            off: body.mass_norm(&off) / largest,
            stated: check.error * size,
            beside: check.beside_modes * size,
            frequency: check.frequencies.first().map_or(0.0, |first| -first.error),
        });
    }
    Ok(found)
}
