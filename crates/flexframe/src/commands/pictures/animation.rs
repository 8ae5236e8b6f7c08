//! `flexframe animate`: a scene or a results file as a moving picture.

mod film;
mod mode;
mod settings;

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

use diagnostic::{Diagnostic, Failure, Kind};
use dynamics::{Observation, Reached, Simulation, StepError};
use figures::{Animation, FilmFrame};
use model::{BuildError, Builder};
use nalgebra::Vector3;
use results::{BodyResults, Shapes, Units};
use rigid_kin::Attitude;
use scene::{Rows, Scene, Shared, Time};
use whole_file::TemporaryFolder;

use self::film::Format;
pub use self::mode::animate_mode;
pub use self::settings::{AnimationSettings, Coloured, MAX_FRAMES};
use crate::commands::export::{no_elements, no_rows};
use crate::commands::modes::require_surface;
use crate::commands::run::{self, RunError, RunProgress, RunSettings};
use crate::drawn::{Drawn, Part};
use crate::report::quantity;
use crate::rows::units::UnitLabels;
use crate::surface::Surface;

/// Runs the bodies of a scene and draws them into a moving picture at `path`, which ends in `.gif`, or with ffmpeg in `.mp4` or
/// `.webm`. Returns a warning where the frames are too few to show the spin.
///
/// # Errors
/// [`Failure`].
pub fn animate(
    scene: &Scene,
    builder: &Builder,
    path: &Path,
    settings: AnimationSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<Option<String>, Failure> {
    let format = Format::of(path)?;
    let scenes = &scene.bodies[..];
    let surface_of = |body| require_surface(body).map_err(|error| RunError::from(BuildError::from(error)));
    scenes.iter().try_for_each(surface_of)?;
    let [from, to] = settings.times(scene.time.end)?;
    if scene.has_ties() {
        return animate_tied(scene, builder, path, settings, progress);
    }
    let mut bodies = Vec::new();
    let mut simulations = Vec::new();
    for body in scenes {
        let model = builder.build(body, |p| progress(RunProgress::Build(p))).map_err(RunError::from)?;
        let surface = match settings.coloured {
            Coloured::Displacement => Surface::of_model(&model),
            Coloured::Stress => Surface::with_stress(&model)?,
        };
        let mut simulation = model
            .start(body)
            .map_err(|source| RunError::Setup { scene: body.path.clone(), source: Box::new(source) })?;
        simulation.keep_last_step();
        simulations.push(simulation);
        bodies.push(PictureBody::new(model.body.origin, surface, settings.coloured, &body.path)?);
    }
    let last = settings.frames.clamp(2, MAX_FRAMES) - 1;
    let units = run::units(scene);
    let mut picture = Picture::new(&scene.title, &units, bodies, settings, (to - from) / last as f64);
    for frame in 0..=last {
        let part = frame as f64 / last as f64;
        let due = from * (1.0 - part) + to * part;
        let now = simulations.iter_mut().map(|simulation| observed_at(simulation, due)).collect::<Result<Vec<_>, _>>();
        let now = now.map_err(|source| source.in_file(&scene.path))?;
        let state =
            |now: &Observation| (now.origin_global, now.attitude, now.modal_displacement.clone(), now.omega_body);
        picture.add(due, &now.iter().map(state).collect::<Vec<_>>());
        progress(RunProgress::Motion(due / to));
    }
    picture.save(format, path)
}

/// Draws bodies that are tied together, from the results of a run whose rows are the frames.
fn animate_tied(
    scene: &Scene,
    builder: &Builder,
    path: &Path,
    settings: AnimationSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<Option<String>, Failure> {
    let [from, to] = settings.times(scene.time.end)?;
    let rows = Rows::Interval((to - from) / (settings.frames.clamp(2, MAX_FRAMES) - 1) as f64);
    let until = |shared: Shared| Shared { time: Time { end: to, ..shared.time }, rows, ..shared };
    let scene = scene.clone().with_shared(until);
    let temporary = TemporaryFolder::new();
    let temporary = temporary.map_err(|source| RunError::Folder { folder: std::env::temp_dir(), source })?;
    let run_settings = RunSettings { large: true, builder: builder.clone(), ..RunSettings::default() };
    let (_, report) = run::run(&scene, temporary.path(), &run_settings, &mut progress)?;
    animate_results(&report.results, path, settings, progress)
}

/// Draws the rows of a results file, finished or not, as [`animate`] draws a scene. Each frame is a row: there are as many
/// as asked for, or as there are rows.
///
/// # Errors
/// [`Failure`].
pub fn animate_results(
    file: &Path,
    path: &Path,
    settings: AnimationSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<Option<String>, Failure> {
    let format = Format::of(path)?;
    let Drawn { results, bodies } = Drawn::open(file, Part::Surface)?;
    let drawn: Vec<(BodyResults<'_>, Shapes)> =
        results.bodies().zip(bodies).filter_map(|(of, body)| Some((of, body.shapes?))).collect();
    if drawn.is_empty() {
        return Err(no_elements(file));
    }
    if drawn.iter().any(|(_, shapes)| shapes.faces.is_empty()) {
        return Err(no_elements(file));
    }
    let times = results.numbers("time").unwrap_or_default();
    let [from, to] = settings.times(times.last().copied().unwrap_or_default())?;
    let slack = 1e-9 * to;
    let rows: Vec<usize> = (0..times.len()).filter(|row| (from - slack..=to + slack).contains(&times[*row])).collect();
    let last = rows.len().min(settings.frames.clamp(2, MAX_FRAMES) as usize).saturating_sub(1);
    if last == 0 {
        let times = [times.first(), times.last()].map(|time| time.copied().unwrap_or_default());
        return Err(no_rows(file, times));
    }
    let chosen: Vec<usize> = (0..=last).map(|frame| rows[(frame * (rows.len() - 1) + last / 2) / last]).collect();
    let interval = chosen.windows(2).map(|pair| times[pair[1]] - times[pair[0]]).fold(0.0, f64::max);
    let (mut of_bodies, mut bodies) = (Vec::new(), Vec::new());
    for (of, shapes) in drawn {
        let origin = of.metadata.model.origin.into();
        bodies.push(PictureBody::new(origin, Surface::new(shapes), settings.coloured, file)?);
        of_bodies.push(of);
    }
    let run = &results.metadata;
    let mut picture = Picture::new(&run.title, &run.units, bodies, settings, interval);
    for (frame, row) in chosen.into_iter().enumerate() {
        let state = |of: &BodyResults<'_>| {
            let history = |path: &str| of.table(path).and_then(|table| table.row(row)).unwrap_or_default();
            let vector = |path: &str| Vector3::from_iterator(history(path).iter().copied().chain([0.0; 3]));
            let attitude = history("attitude").try_into().ok().and_then(|wxyz| Attitude::from_wxyz(wxyz).ok());
            let attitude = attitude.unwrap_or(Attitude::identity());
            (vector("origin"), attitude, history("modal/displacement").to_vec(), vector("angular_velocity"))
        };
        picture.add(times[row], &of_bodies.iter().map(state).collect::<Vec<_>>());
        progress(RunProgress::Motion(frame as f64 / last as f64));
    }
    picture.save(format, path)
}

impl AnimationSettings {
    /// Times of the first and the last frame of a run to this end.
    fn times(&self, end: f64) -> Result<[f64; 2], Failure> {
        let (from, to) = (self.from.unwrap_or(0.0), self.to.unwrap_or(end));
        if 0.0 <= from && from < to && to <= end {
            Ok([from, to])
        } else {
            let wrong = Kind::Usage.alone().key("--from, --to").found(format!("the times from {from} to {to}"));
            let help = format!("give --from and --to so that 0 ≤ from < to ≤ {end}, or leave them out");
            Err(wrong.expected(format!("a part of the run, which goes from 0 to {end}")).help(help).into())
        }
    }
}

/// A moving picture in the making.
struct Picture<'a> {
    title: &'a str,
    units: &'a Units,
    bodies: Vec<PictureBody>,
    settings: AnimationSettings,
    /// Longest time from frame to frame.
    interval: f64,
    frames: Vec<FilmFrame>,
    /// Largest spin at a frame.
    fastest: f64,
}

/// A body in a moving picture.
struct PictureBody {
    /// Origin of the body frame, mesh axes.
    origin: Vector3<f64>,
    surface: Surface,
}

impl PictureBody {
    /// Refuses a body that deforms and has no stress where that is the coloured quantity.
    fn new(origin: Vector3<f64>, surface: Surface, coloured: Coloured, file: &Path) -> Result<Self, Failure> {
        let Shapes { displacements, stress, .. } = &surface.shapes;
        if coloured == Coloured::Stress && stress.is_none() && !displacements.is_empty() {
            let words = "the stress of a body that deforms is not known, because its elements are not";
            return Err(Kind::Input.of(file).help("leave --colour stress out").says(words));
        }
        Ok(Self { origin, surface })
    }

    /// The coloured quantity at the points, which are displaced by `u`.
    fn values(&self, q: &[f64], u: &[Vector3<f64>], coloured: Coloured) -> Vec<f64> {
        match coloured {
            Coloured::Displacement => u.iter().map(Vector3::norm).collect(),
            Coloured::Stress => self.surface.von_mises(&self.surface.shapes.stress_coordinates(q)),
        }
    }
}

/// A body in a frame: place of its origin, attitude, modal coordinates, and its spin in body axes.
type State = (Vector3<f64>, Attitude, Vec<f64>, Vector3<f64>);

impl<'a> Picture<'a> {
    /// A picture without frames.
    fn new(
        title: &'a str,
        units: &'a Units,
        bodies: Vec<PictureBody>,
        settings: AnimationSettings,
        interval: f64,
    ) -> Self {
        Self { title, units, bodies, settings, interval, frames: Vec::new(), fastest: 0.0 }
    }

    fn add(&mut self, time: f64, states: &[State]) {
        let (mut points, mut values) = (Vec::new(), Vec::new());
        for (body, (origin_global, attitude, q, omega_body)) in self.bodies.iter().zip(states) {
            let PictureBody { origin, surface } = body;
            self.fastest = self.fastest.max(omega_body.norm());
            let u = surface.displacements(&surface.shapes.coordinates(q));
            let drawn: Vec<Vector3<f64>> = u.iter().map(|u| u * self.settings.magnification).collect();
            points.extend(surface.placed(origin, origin_global, attitude, &drawn));
            values.extend(body.values(q, &u, self.settings.coloured));
        }
        let decimals = decimals(self.interval);
        self.frames.push(FilmFrame { points, values, caption: format!("t = {time:.decimals$} {}", self.units.time) });
    }

    /// Writes it. Returns a warning where the frames are too few to show the spin.
    fn save(self, format: Format, path: &Path) -> Result<Option<String>, Failure> {
        let Self { title, units, bodies, settings, interval, frames, fastest } = self;
        let factor = match settings.magnification {
            1.0 => String::new(),
            factor => format!(" (drawn {factor} times as large)"),
        };
        // The points of all bodies are in one list.
        let (mut triangles, mut plain, mut edges, mut first) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for PictureBody { surface, .. } in &bodies {
            let triangles = if surface.shapes.displacements.is_empty() { &mut plain } else { &mut triangles };
            triangles.extend(surface.triangles.iter().map(|points| points.map(|point| first + point)));
            edges.extend(surface.edges.iter().map(|points| points.map(|point| first + point)));
            first += surface.shapes.positions.len() as u32;
        }
        let value_label = match settings.coloured {
            Coloured::Displacement => format!("displacement by deformation, {}{factor}", units.length),
            Coloured::Stress => {
                let Units { length, mass, time } = units;
                let deformation = if factor.is_empty() { String::new() } else { format!("; deformation{factor}") };
                format!("von Mises stress, {}{deformation}", UnitLabels { length, mass, time }.stress())
            }
        };
        let animation = Animation {
            title: title.to_owned(),
            value_label,
            triangles: &triangles,
            plain_triangles: &plain,
            edges: &edges,
            frames: &frames,
            frame_milliseconds: 50,
            view: settings.view,
            ground: true,
            traced_point: None,
        };
        format.write(&animation, path, |_| ())?;
        Ok(aliased(interval, frames.len() as u64 - 1, fastest, &units.time))
    }
}

/// The motion at a time that has not been passed yet.
fn observed_at(simulation: &mut Simulation, due: f64) -> Result<Observation, StepError> {
    while simulation.time() < due && simulation.advance(1)? != Reached::End {}
    if simulation.time() <= due {
        return simulation.observation();
    }
    let mut now = simulation.observation()?;
    simulation.interpolate(due, [&mut now])?;
    Ok(now)
}

/// How many decimals tell the times of frames apart that are so far from each other.
fn decimals(interval: f64) -> usize {
    (-interval.log10().floor()).clamp(0.0, 15.0) as usize
}

/// A warning where the body turns by more than half a turn from frame to frame, so that it seems to turn slower or
/// backwards. A quarter of a turn is seen as what it is.
fn aliased(interval: f64, intervals: u64, fastest: f64, time_unit: &str) -> Option<String> {
    let angle = fastest * interval;
    if angle <= PI {
        return None;
    }
    let enough = (intervals as f64 * angle / FRAC_PI_2).ceil() + 1.0;
    let help = if enough <= MAX_FRAMES as f64 {
        format!("--frames {enough:.0} shows it, or less of the time with --from and --to")
    } else {
        let time = (MAX_FRAMES - 1) as f64 * FRAC_PI_2 / fastest;
        format!("show {} {time_unit} or less with --from, --to and --frames {MAX_FRAMES}", quantity(time))
    };
    Some(format!(
        "the body turns by up to {:.2} turns from frame to frame, so that its spin looks slower than it is, or backwards: \
         {help}",
        angle / TAU
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: turns between two frames.
    #[test]
    fn a_spin_that_the_frames_do_not_show_is_told_with_the_frames_that_do() {
        // 0.4 turns a frame is seen; 0.6 looks like 0.4 backwards.
        assert_eq!(aliased(0.1, 10, 0.4 * TAU / 0.1, "s"), None);
        let warning = aliased(0.1, 10, 0.6 * TAU / 0.1, "s").unwrap();
        // Ten intervals of 0.6 turns are 24 quarters.
        assert!(warning.contains("0.60 turns") && warning.contains("--frames 25 "), "{warning}");
        let warning = aliased(1.0, 10, 1e4 * TAU, "s").unwrap();
        assert!(warning.contains("--frames 10000") && warning.contains("show 0.249975 s"), "{warning}");
    }

    #[test]
    fn times_of_frames_are_told_apart() {
        assert_eq!([decimals(0.5), decimals(0.01), decimals(0.0012), decimals(3.0)], [1, 2, 3, 0]);
    }
}
