//! `flexframe animate --mode`: one mode of a scene, which swings through a period.

use std::f64::consts::TAU;
use std::path::Path;

use diagnostic::{Failure, Kind};
use figures::{Animation, FilmFrame};
use model::{Builder, Needs};
use nalgebra::Vector3;
use scene::{Scene, Shared};

use super::film::Format;
use super::settings::{AnimationSettings, Coloured, MAX_FRAMES};
use crate::commands::modes::{frequency_unit, require_flexible, require_surface};
use crate::commands::run::RunProgress;
use crate::commands::system_modes::{self, SystemSurface};
use crate::surface::Surface;

/// Largest displacement drawn, as a fraction of the size of what is drawn, with a factor of 1.
const DRAWN: f64 = 0.08;

/// Draws mode `number` of a scene, from 1, through one period. Of bodies that are tied together it is a vibration of the whole where it
/// stands at the start; damped ones are drawn as if they did not decay, and with a phase that differs from place to place where they
/// have one.
///
/// # Errors
/// [`Failure`].
pub fn animate_mode(
    scene: &Scene,
    builder: &Builder,
    number: usize,
    path: &Path,
    settings: AnimationSettings,
    mut progress: impl FnMut(RunProgress),
) -> Result<(), Failure> {
    let format = Format::of(path)?;
    let no_such = |modes: usize| {
        let wrong = Kind::Usage.of(&scene.path).key("--mode").found(number.to_string());
        let help = "`flexframe modes` lists them; ask for more in [modes] of the scene";
        Failure::from(wrong.expected(format!("1 to {modes}")).help(help))
    };
    let several = |count: usize| {
        let found = format!("{count} bodies or systems that move apart, each with modes of its own");
        let wrong = Kind::Usage.of(&scene.path).key("--mode").found(found);
        Err(wrong.expected("one").help("choose a body with --body NAME").into())
    };
    let index = number.wrapping_sub(1);
    if scene.has_connections() {
        let models = builder.models(scene, |p| progress(RunProgress::Build(p)))?;
        let found = system_modes::vibrations(scene, &models)?;
        let [modes] = &found[..] else {
            return several(found.len());
        };
        let count = modes.vibrations.modes.len();
        let mode = modes.vibrations.modes.get(index).ok_or_else(|| no_such(count))?;
        let surface = SystemSurface::new(scene, &models, modes, settings.coloured == Coloured::Stress)?;
        let swinging = Swinging {
            title: title(scene, number, modes.report.modes[index].frequency),
            triangles: &surface.triangles,
            edges: &surface.edges,
            points: &surface.points,
            diagonal: surface.diagonal(),
        };
        return swinging.write(
            |phase| (surface.displacements(&mode.motion, phase), surface.stress(&mode.motion, phase)),
            (format, path),
            settings,
            progress,
        );
    }
    let [given] = &scene.bodies[..] else {
        return several(scene.bodies.len());
    };
    require_surface(given)?;
    let model = builder.needing(Needs::modes()).build(given, |p| progress(RunProgress::Build(p)))?;
    let meshed = require_flexible(given, &model)?;
    let frequencies = meshed.modes.natural_frequencies();
    let frequency = *frequencies.get(index).ok_or_else(|| no_such(frequencies.len()))?;
    let surface = match settings.coloured {
        Coloured::Stress => Surface::with_stress(&model)?,
        Coloured::Displacement => Surface::of_model(&model),
    };
    let swinging = Swinging {
        title: title(scene, number, frequency),
        triangles: &surface.triangles,
        edges: &surface.edges,
        points: &surface.shapes.positions,
        diagonal: meshed.mesh.diagonal(),
    };
    let at = |phase: f64| {
        let mut q = vec![0.0; number];
        q[index] = phase.cos();
        (surface.displacements(&q), surface.von_mises(&q))
    };
    swinging.write(at, (format, path), settings, progress)
}

fn title(scene: &Shared, number: usize, frequency: f64) -> String {
    format!("{}: mode {number}, {frequency:.4} {}", scene.title, frequency_unit(&scene.units.time))
}

/// A mode that swings.
struct Swinging<'a> {
    title: String,
    triangles: &'a [[u32; 3]],
    edges: &'a [[u32; 2]],
    points: &'a [[f64; 3]],
    /// Its size.
    diagonal: f64,
}

impl Swinging<'_> {
    /// Writes it. `at` gives displacements and stresses of the points at a phase; the stresses may be none.
    fn write(
        self,
        at: impl Fn(f64) -> (Vec<Vector3<f64>>, Vec<f64>),
        (format, path): (Format, &Path),
        settings: AnimationSettings,
        mut progress: impl FnMut(RunProgress),
    ) -> Result<(), Failure> {
        let count = settings.frames.clamp(2, MAX_FRAMES);
        // The last frame is one before the first: the picture goes round without a halt.
        let phases: Vec<f64> = (0..count).map(|frame| TAU * frame as f64 / count as f64).collect();
        let shapes: Vec<(Vec<Vector3<f64>>, Vec<f64>)> = phases.iter().map(|phase| at(*phase)).collect();
        let values = |(shape, stress): &(Vec<Vector3<f64>>, Vec<f64>)| match settings.coloured {
            Coloured::Displacement => shape.iter().map(Vector3::norm).collect::<Vec<_>>(),
            Coloured::Stress => stress.clone(),
        };
        let greatest = |values: Vec<f64>| values.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let largest = shapes.iter().map(|(shape, _)| greatest(shape.iter().map(Vector3::norm).collect()));
        let scale = settings.magnification * DRAWN * self.diagonal / largest.fold(f64::MIN_POSITIVE, f64::max);
        let highest = shapes.iter().map(|shape| greatest(values(shape))).fold(f64::MIN_POSITIVE, f64::max);
        let frames: Vec<FilmFrame> = shapes
            .iter()
            .zip(&phases)
            .map(|(shape, phase)| FilmFrame {
                points: self.points.iter().zip(&shape.0).map(|(x, u)| (Vector3::from(*x) + u * scale).into()).collect(),
                values: values(shape).into_iter().map(|value| value / highest).collect(),
                caption: format!("{:.2} of a period", phase / TAU),
            })
            .collect();
        let quantity = match settings.coloured {
            Coloured::Displacement => "displacement",
            Coloured::Stress => "von Mises stress",
        };
        let animation = Animation {
            title: self.title,
            value_label: format!("{quantity} / largest of the mode"),
            triangles: self.triangles,
            edges: self.edges,
            frames: &frames,
            frame_milliseconds: 50,
            view: settings.view,
            ground: false,
            plain_triangles: &[],
            traced_point: None,
        };
        format.write(&animation, path, |part| progress(RunProgress::Motion(part)))
    }
}
