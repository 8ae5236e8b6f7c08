//! `flexframe modes`.

use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::Failure;
use flexframe::modes;
use flexframe::outputs::{OutputError, Written, outputs_of_scene};
use flexframe::report::Report;
use flexframe::{figures, mode_shapes, run, system_modes};
use model::Model;
use scene::{Body, Scene};

use crate::arguments::values::{at_time, point};
use crate::arguments::{FileArgs, ModeCountArgs, SceneArgs};
use crate::cli_error::option;
use crate::output;
use crate::session::Session;
use crate::solver_input::SolverInput;

/// Find natural frequencies and mode shapes of a scene's body.
#[derive(Debug, Args)]
pub struct Modes {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    modes: ModeCountArgs,
    /// The point that a base turns about, in the frame of the mesh, for effective moments of inertia [default: the support of a
    /// held body, the center of mass of a free one]; of bodies in joints a global one [default: the first place on the ground].
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    about: Option<[f64; 3]>,
    /// Compare the shapes with those of another body in the same place (MAC): a scene, a body file, or another mesh for this scene.
    #[arg(long, value_name = "OTHER")]
    mac: Option<PathBuf>,
    /// Time of a run at which bodies in joints stand, at rest there [default: the start].
    #[arg(long, value_name = "TIME", value_parser = at_time, allow_hyphen_values = true)]
    time: Option<f64>,
    /// Folder for a picture of the mode shapes (SVG, PDF and PNG), and of bodies in joints a file for ParaView (VTKHDF)
    /// [default: no picture].
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: FileArgs,
    #[command(flatten)]
    solver: SolverInput,
}

impl Modes {
    pub fn execute(self, mut session: Session) -> Result<(), Failure> {
        output::require_file("--output", self.output.as_deref())?;
        let mut scene = session.read_scene(self.scene.scene.clone())?;
        self.check_one_body(&scene)?;
        if let Some(time) = self.time {
            check_time(&scene, time)?;
        }
        self.modes.set(&mut scene);
        if let Some(to) = self.solver.take_of(&scene.bodies, &mut session.builder, session.signals.slepc())? {
            return session.write_only(scene.only_body()?, &to, self.files.overwrite);
        }
        self.output.iter().try_for_each(|folder| Written::FOLDER.check(folder)).map_err(OutputError::from)?;
        let report = match scene.has_connections() {
            true => self.of_bodies_in_joints(&scene, &mut session)?,
            false => self.of_bodies(&scene, &mut session)?,
        };
        session.print(&report, self.scene.json)
    }

    /// Refuses what only one body has.
    fn check_one_body(&self, scene: &Scene) -> Result<(), Failure> {
        let bodies = format!("a scene of {} bodies", scene.bodies.len());
        if self.mac.is_none() || scene.bodies.len() == 1 {
            return Ok(());
        }
        let (expected, help) = ("a scene of one body, to compare it with another one", "name one: --body NAME");
        Err(option("--mac", bodies, expected, help))
    }

    fn of_bodies(&self, scene: &Scene, session: &mut Session) -> Result<Report, Failure> {
        let bodies = &scene.bodies;
        let picture = |folder: &Path, body: &Body| match &body.name {
            Some(name) => folder.join(format!("modes.{name}")),
            None => folder.join("modes"),
        };
        if let Some(folder) = &self.output {
            bodies.iter().try_for_each(modes::require_surface)?;
            let pictures: Vec<_> = bodies.iter().flat_map(|body| figures::files(&picture(folder, body))).collect();
            outputs_of_scene(scene, &session.builder, self.files.overwrite).claim(&pictures)?;
        }
        let (mut reports, mut pictures) = (Vec::new(), Vec::new());
        for body in bodies {
            let (model, mut report) = self.of_body(body, session)?;
            if let Some(other) = &self.mac {
                modes::mac(body, &model, other, &session.builder, &mut report, |p| session.bar.build(p))?;
            }
            if let Some(folder) = self.output.as_ref().filter(|_| model.meshed.is_some() || bodies.len() == 1) {
                make_folder(folder)?;
                pictures.extend(mode_shapes::draw(body, &model, &picture(folder, body))?);
            }
            reports.push((body.name.clone(), report));
        }
        let mut report = Report::of_bodies(reports);
        report.files = pictures;
        Ok(report)
    }

    fn of_body(&self, body: &Body, session: &mut Session) -> Result<(Model, Report), Failure> {
        modes::modes(body, &session.builder, self.about, |p| session.bar.build(p))
            .map_err(|error| self.modes.refusal(error.into()))
    }

    /// Modes of each system that joints make, and of the bodies that none ties.
    fn of_bodies_in_joints(&self, scene: &Scene, session: &mut Session) -> Result<Report, Failure> {
        let models = session
            .builder
            .models(scene, |p| session.bar.build(p))
            .map_err(|error| self.modes.refusal(error.into()))?;
        let systems = system_modes::system_modes(scene, &models, self.time, self.about)?;
        let mut pictures = Vec::new();
        if let Some(folder) = &self.output {
            make_folder(folder)?;
            for (k, (modes, _)) in systems.iter().enumerate() {
                let name = if systems.len() == 1 { "modes".to_owned() } else { format!("modes.system{}", k + 1) };
                let stem = folder.join(name);
                let fields = stem.with_extension("vtkhdf");
                let all: Vec<PathBuf> = figures::files(&stem).into_iter().chain([fields.clone()]).collect();
                outputs_of_scene(scene, &session.builder, self.files.overwrite).claim(&all)?;
                pictures.extend(system_modes::draw(scene, &models, modes, &stem)?.into_iter().flatten());
                if system_modes::write_fields(scene, &models, modes, &fields, self.files.overwrite)? {
                    pictures.push(fields);
                }
            }
        }
        let is_tied = |number: usize| systems.iter().any(|(modes, _)| modes.bodies.contains(&number));
        let mut bodies = Vec::new();
        for (_, body) in scene.bodies.iter().enumerate().filter(|(number, _)| !is_tied(*number)) {
            bodies.push((body.name.clone(), self.of_body(body, session)?.1));
        }
        let mut report = Report::default();
        report.files = pictures;
        report.list("systems", systems.into_iter().map(|(_, report)| (None, report)).collect());
        report.list("bodies", bodies);
        Ok(report)
    }
}

fn make_folder(folder: &Path) -> Result<(), run::RunError> {
    std::fs::create_dir_all(folder).map_err(|source| run::RunError::Folder { folder: folder.to_owned(), source })
}

/// Refuses a time of a run that bodies which nothing ties do not need, and one after its end.
fn check_time(scene: &Scene, time: f64) -> Result<(), Failure> {
    let end = scene.bodies.iter().map(|body| body.time.end).fold(0.0, f64::max);
    let (found, expected, help) = if !scene.has_connections() {
        let help = "leave it out: a body alone has the same modes wherever it is";
        ("a scene of bodies that nothing ties together".to_owned(), "joints, springs or bushings".to_owned(), help)
    } else if time > end {
        (
            format!("{time}"),
            format!("at most the end of the run, {end}"),
            "change `end` in [time], or ask for an earlier time",
        )
    } else {
        return Ok(());
    };
    Err(option("--time", found, expected, help))
}
