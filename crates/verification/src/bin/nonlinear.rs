//! The curves of docs/evidence/nonlinear.md: flexframe against the nonlinear body.
//!
//! `nonlinear DIRECTORY [--overwrite]` writes them there as SVG.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

use figures::{LineChart, Scale, Series, Stroke};
use verification::nonlinear::cases::{TimeCurve, pendulum, spinning_l};
use whole_file::Outputs;

const STIFFENED: &str = "[effects]\nlarge_deflection = false\nrefuse = false";

fn main() -> ExitCode {
    let (options, arguments): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with('-'));
    let (true, [directory]) = (options.iter().all(|option| option == "--overwrite"), arguments.as_slice()) else {
        eprintln!("usage: nonlinear DIRECTORY [--overwrite]");
        return ExitCode::FAILURE;
    };
    match curves(Path::new(directory), !options.is_empty()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("nonlinear: {error}");
            ExitCode::FAILURE
        }
    }
}

fn curves(directory: &Path, overwrite: bool) -> Result<(), Box<dyn Error>> {
    let [spinning, soft] = ["spinning_l.svg", "soft_rod.svg"].map(|name| directory.join(name));
    Outputs::new(Vec::new(), overwrite).claim(&[&spinning, &soft])?;
    let stiffened = format!("static_correction = false\n{STIFFENED}");
    let manifold = "static_correction = false\nlarge = [IN_PLANE]\n[effects]\nlarge_deflection = true\nrefuse = false";
    let (_, courses) = spinning_l(0.3, 6.0, &[&stiffened, manifold])?;
    let title = "Free L that spins at 0.3 of its first frequency, from the undeformed state";
    save(&spinning, title, "First modal coordinate", &courses)?;
    let stiffened = format!("[modes]\nflexible = 8\n{STIFFENED}");
    let manifold = "[modes]\nflexible = 8\nlarge = 4\n[effects]\nlarge_deflection = true\nrefuse = false";
    let courses = pendulum(2e7, 1.0, 800, &[&stiffened, manifold])?;
    let title = "Soft rod that falls from the horizontal about its hinge";
    save(&soft, title, "Deflection of the tip over the length", &courses)?;
    Ok(())
}

fn save(path: &Path, title: &str, y_label: &str, courses: &[TimeCurve]) -> Result<(), Box<dyn Error>> {
    let names =
        [("nonlinear elements", Stroke::Dashed), ("stiffened modes", Stroke::Solid), ("large modes", Stroke::Solid)];
    let series = names.into_iter().zip(courses).map(|((label, stroke), course)| Series {
        label: label.to_owned(),
        points: course.times.iter().copied().zip(course.values.iter().copied()).collect(),
        stroke,
    });
    let chart = LineChart {
        title: title.to_owned(),
        x_label: "Time (s)".to_owned(),
        y_label: y_label.to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series: series.collect(),
        reference: None,
    };
    Ok(chart.save_svg(path)?)
}
