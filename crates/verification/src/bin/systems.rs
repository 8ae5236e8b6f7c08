//! A system at several tolerances, timed, for `./dev exudyn` and `./dev schemes`.
//!
//! `systems SCENE BODY POINT ROWS TOLERANCE...`, a tolerance also as SCHEME:TOLERANCE, prints a line of JSON for each
//! tolerance: processor seconds of the motion alone, steps, and the position and the elastic displacement (body axes) of a point of a
//! body at equal times.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use dynamics::{Observation, Reached, StepControl, SystemScheme};
use nalgebra::Vector3;
use verification::systems::run::built;

/// Time of all runs of one tolerance together, at least.
const LEAST_SECONDS: f64 = 0.2;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, body, point, rows, tolerances @ ..] = arguments.as_slice() else {
        eprintln!("usage: systems SCENE BODY POINT ROWS TOLERANCE...");
        return ExitCode::FAILURE;
    };
    match ladder(Path::new(scene), [body, point], rows, tolerances) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("systems: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Processor time of this thread where the system tells it, otherwise what goes by.
struct Clock {
    processor: Option<u64>,
    begin: Instant,
}

impl Clock {
    fn new() -> Self {
        Self { processor: nanoseconds(), begin: Instant::now() }
    }

    fn seconds(&self) -> f64 {
        match self.processor.zip(nanoseconds()) {
            Some((begin, now)) => (now - begin) as f64 * 1e-9,
            None => self.begin.elapsed().as_secs_f64(),
        }
    }
}

/// Nanoseconds of this thread on a processor, of Linux, which counts them where threads take turns.
fn nanoseconds() -> Option<u64> {
    std::thread::yield_now();
    std::fs::read_to_string("/proc/thread-self/schedstat").ok()?.split(' ').next()?.parse().ok()
}

fn ladder(scene: &Path, [body, point]: [&str; 2], rows: &str, tolerances: &[String]) -> Result<(), Box<dyn Error>> {
    let text = std::fs::read_to_string(scene)?;
    let system = scene::Scene::parse(&text, scene)?;
    let built = built(scene.parent().unwrap_or(Path::new(".")), &text)?;
    let number = system.bodies.iter().position(|other| other.name.as_deref() == Some(body)).ok_or("no such body")?;
    let of_system = built.tied.bodies.iter().position(|other| *other == number).ok_or("a body that is not tied")?;
    let seen = built.models[number].points.iter().position(|(name, _)| name == point).ok_or("no such point")?;
    let end = system.time.end;
    for tolerance in tolerances {
        let interval = end / rows.parse::<f64>()?;
        let (scheme, tolerance) = tolerance.split_once(':').unwrap_or((SystemScheme::Radau.name(), tolerance));
        let known = SystemScheme::ALL.into_iter().find(|known| known.name() == scheme);
        let scheme = known.ok_or("no such scheme")?;
        let control = StepControl::Tolerance(tolerance.parse()?);
        let (_, shapes) = &built.models[number].points[seen];
        let place = |row: &[Observation]| {
            let body = &row[of_system];
            let bent = body.points[seen].elastic_displacement_body;
            [body.origin_global + body.attitude.to_global(&(shapes.position_body() + bent)), bent]
        };
        // Short runs are repeated: clocks are coarse.
        let (mut seconds, mut runs) = (0.0, 0.0);
        let (places, simulation) = loop {
            let mut simulation = built.start_by(scheme, control, end, interval, false)?;
            let mut row: Vec<Observation> = (0..built.models.len()).map(|body| simulation.room(body)).collect();
            let begin = Clock::new();
            simulation.observe(&mut row)?;
            let mut places = vec![place(&row)];
            while places.len() as f64 * interval < end * (1.0 + 1e-9) {
                while simulation.advance_watched(1000, |_, _| ())? == Reached::Between {}
                simulation.observe(&mut row)?;
                places.push(place(&row));
            }
            (seconds, runs) = (seconds + begin.seconds(), runs + 1.0);
            if seconds > LEAST_SECONDS {
                break (places, simulation);
            }
        };
        let seconds = seconds / runs;
        let stats = simulation.stats();
        let [positions, displacements] = [0, 1].map(|which| {
            let of_row =
                |row: &[Vector3<f64>; 2]| format!("[{:?}, {:?}, {:?}]", row[which].x, row[which].y, row[which].z);
            places.iter().map(of_row).collect::<Vec<String>>().join(", ")
        });
        println!(
            "{{\"scheme\": \"{}\", \"tolerance\": {tolerance}, \"seconds\": {seconds}, \"steps\": {}, \"positions\": [{positions}], \
             \"displacements\": [{displacements}]}}",
            scheme.name(),
            stats.accepted,
        );
    }
    Ok(())
}
