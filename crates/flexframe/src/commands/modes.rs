//! `flexframe modes`: natural frequencies and mode shapes of a scene's body.

mod carried;
mod mac;
mod scenes;
mod strain_energy;

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

use model::{BuildError, BuildProgress, Builder, Model, Needs};
use scene::Scene;
use serde::Serialize;

use crate::plausible;
pub use carried::CarriedReport;
pub use mac::{MacReport, mac};
pub use scenes::require_surface;
pub(crate) use scenes::{lone_body, require_flexible};
pub use strain_energy::{EnergyPart, StrainEnergyReport};

use crate::report::{BodyReport, MeshReport, Times, size_and_mass};

/// Report of `flexframe modes`.
#[derive(Debug, Clone, Serialize)]
pub struct ModesReport {
    /// Title of the scene.
    pub title: String,
    /// Labels of length, mass and time.
    pub units: [String; 3],
    /// Unit of frequencies, such as "1/s".
    pub frequency_unit: String,
    /// The finite-element model.
    pub mesh: Option<MeshReport>,
    /// Mass properties and modes.
    pub body: BodyReport,
    /// The mass that each mode carries; none of a body without flexible modes, and of one that is written to a file.
    pub carried: Option<CarriedReport>,
    /// Where the strain energy of each mode is, and the error of its frequency; none of a body without elements.
    pub strain_energy: Option<StrainEnergyReport>,
    /// The modes beside those of another body, where one is given.
    pub mac: Option<MacReport>,
    /// Parts of the mesh file that were left out, and values that no material has.
    pub warnings: Vec<String>,
    /// Where the time went, seconds.
    pub times: Times,
}

impl ModesReport {
    pub(crate) fn new(scene: &Scene, model: &Model) -> Self {
        Self {
            title: scene.title.clone(),
            units: [scene.units.length.clone(), scene.units.mass.clone(), scene.units.time.clone()],
            frequency_unit: frequency_unit(&scene.units.time),
            warnings: plausible::doubts(scene, model),
            mesh: MeshReport::new(model),
            body: BodyReport::new(model),
            carried: None,
            strain_energy: None,
            mac: None,
            times: Times::of_model(model),
        }
    }
}

/// Reduces a scene's body as a run of it asks for, and writes it to a body file; with `matrices`, mass and stiffness are in it,
/// with `stress`, the stress of all nodes, as where the scene asks for stress.
///
/// # Errors
/// [`BuildError`].
pub fn reduce(
    scene: &Scene,
    builder: &Builder,
    output: &Path,
    matrices: bool,
    stress: bool,
    progress: impl FnMut(BuildProgress),
) -> Result<ModesReport, BuildError> {
    let builder = builder.needing(Needs { stress_field: stress, ..Needs::default() });
    let model = builder.write_body(scene, output, matrices, progress)?;
    Ok(ModesReport::new(scene, &model))
}

/// Finds the modes of a scene's body, and what each carries: rotations of the base are `about` a point in the frame of the mesh, or
/// about the support of a held body and the center of mass of a free one.
///
/// # Errors
/// [`BuildError`].
pub fn modes(
    scene: &Scene,
    builder: &Builder,
    about: Option<[f64; 3]>,
    progress: impl FnMut(BuildProgress),
) -> Result<(Model, ModesReport), BuildError> {
    let model = builder.needing(Needs::modes()).build(scene, progress)?;
    let mut report = ModesReport::new(scene, &model);
    if let Some(meshed) = model.meshed.as_ref().filter(|_| model.body.flexible() > 0) {
        report.carried = Some(CarriedReport::new(&model, about));
        let start = Instant::now();
        report.strain_energy = StrainEnergyReport::new(meshed)?;
        report.times.add("mesh error", start.elapsed());
    }
    Ok((model, report))
}

/// Writes the modes that a scene asks for as a problem for SLEPc on a number of ranks. Returns the files.
///
/// # Errors
/// [`BuildError`].
pub fn write_problem(
    scene: &Scene,
    builder: &Builder,
    folder: &Path,
    ranks: usize,
    progress: impl FnMut(BuildProgress),
) -> Result<Vec<PathBuf>, BuildError> {
    builder.assemble(scene, progress)?.variants()?.write_problem(scene, folder, ranks)
}

/// "Hz" where time is in seconds.
pub fn frequency_unit(time: &str) -> String {
    if time == "s" { "Hz".to_owned() } else { format!("1/{time}") }
}

impl fmt::Display for ModesReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        if let Some(mesh) = &self.mesh {
            writeln!(f, "  mesh   {mesh}")?;
            if let Some(matrices) = &mesh.matrices {
                writeln!(f, "  K, M   {matrices}")?;
            }
            if let Some(engine) = &mesh.engine {
                writeln!(f, "  modes  {engine}")?;
            }
        }
        let [length, mass, _] = &self.units;
        writeln!(f, "  body   {}", size_and_mass(self.mesh.as_ref(), &self.body, length, mass))?;
        let body = &self.body;
        if body.natural_frequencies.is_empty() {
            let why = match self.mesh {
                Some(_) => {
                    "none, as the scene has it: `flexible = 0` in [modes], or `flexibility = false` in [effects]"
                }
                None => "none: a rigid body without a mesh has no natural frequencies",
            };
            writeln!(f, "  modes  {why}")?;
        } else {
            let error = if self.strain_energy.is_some() { "  mesh error" } else { "" };
            writeln!(f, "\n  mode  frequency, {:<6}  damping  residual{error}", self.frequency_unit)?;
        }
        for (k, (frequency, damping)) in body.natural_frequencies.iter().zip(&body.damping_ratios).enumerate() {
            let kind = body.kinds.get(k).copied().unwrap_or_default();
            let residual = body.residuals.get(k).map_or_else(|| kind.to_owned(), |r| format!("{r:.0e}"));
            write!(f, "  {:>4}  {frequency:>17.6}  {damping:>7.4}  {residual}", k + 1)?;
            if let Some(error) = self.strain_energy.as_ref().and_then(|energy| energy.mesh_errors.get(k)) {
                write!(f, "  {:>8.1e} %", 100.0 * error)?;
            }
            writeln!(f)?;
        }
        if let Some(carried) = &self.carried {
            write!(f, "{carried}")?;
        }
        if let Some(energy) = &self.strain_energy {
            write!(f, "{energy}")?;
        }
        if let Some(mac) = &self.mac {
            write!(f, "{mac}")?;
        }
        write!(f, "\n  time   {}", self.times)?;
        self.warnings.iter().try_for_each(|warning| write!(f, "\n  warning  {warning}"))
    }
}
