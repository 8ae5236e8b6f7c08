//! `docs/evidence/accuracy.md`: the price lists of several scenes as a page.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

use diagnostic::Failure;
use flexframe::cost::{self, CostReport, CostSettings, LadderRun, Line, MeasuredRun, duration, price_list, setting};
use flexframe::model::Builder;
use flexframe::modes::frequency_unit;
use flexframe::outputs::outputs_of_body;
use flexframe::scene::{Body, Scene};
use flexframe::write_error::WriteError;
use whole_file::write_whole;

/// Errors whose price is shown: 10^−k for these k.
const DECADES: [i32; 6] = [1, 2, 4, 6, 8, 10];

/// Measures the scenes and writes a page about them to `path`, with its diagrams in a folder of the same name; the whole
/// lists go to folders in `lists`. What was there before is only replaced with `overwrite`, and the page stays until everything has been
/// measured.
///
/// # Errors
/// [`Failure`].
pub fn accuracy_page(
    scenes: &[Body],
    path: &Path,
    lists: &Path,
    patience: Duration,
    overwrite: bool,
) -> Result<Vec<PathBuf>, Failure> {
    let pictures = path.with_extension("");
    let picture_of = |scene: &Path| pictures.join(format!("{}.svg", name_of(scene)));
    for scene in scenes {
        let mut files = cost::files(&lists.join(name_of(&scene.path)));
        files.extend([path.to_owned(), picture_of(&scene.path)]);
        outputs_of_body(scene, &Builder::default(), overwrite).claim(&files)?;
    }
    let mut reports = Vec::new();
    for scene in scenes {
        let folder = lists.join(name_of(&scene.path));
        let settings = CostSettings::with_patience(patience);
        reports.push((
            scene,
            price_list(&Scene::from(Body::clone(scene)), &Builder::default(), &folder, settings, |_| ())?,
        ));
    }
    std::fs::create_dir_all(&pictures).map_err(WriteError::of(&pictures))?;
    let mut files = Vec::new();
    for (_, report) in &reports {
        let picture = picture_of(&report.scene);
        if let Some(drawn) = report.files.iter().find(|file| file.extension() == Some("svg".as_ref())) {
            std::fs::read(drawn).and_then(|svg| write_whole(&picture, svg)).map_err(WriteError::of(&picture))?;
            files.push(picture);
        }
    }
    write_whole(path, page(&reports, &pictures)).map_err(WriteError::of(path))?;
    files.push(path.to_owned());
    Ok(files)
}

/// |ω| at the beginning of a scene, each of which has one body.
fn initial_spin(report: &CostReport) -> f64 {
    report.bodies.first().map_or(0.0, |body| body.initial_spin)
}

fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or("scene".as_ref()).display().to_string()
}

fn page(reports: &[(&Body, CostReport)], pictures: &Path) -> String {
    let mut page = String::new();
    // Writing to a String cannot fail.
    let _ = write_page(&mut page, reports, pictures);
    page
}

fn write_page(out: &mut String, reports: &[(&Body, CostReport)], pictures: &Path) -> std::fmt::Result {
    writeln!(out, "# The price of accuracy\n")?;
    if let Some((_, report)) = reports.first() {
        writeln!(
            out,
            "Measured by flexframe {} on {}. `./dev accuracy` measures again and writes this page; \
             `flexframe cost SCENE` does the same for a scene of yours.\n",
            env!("CARGO_PKG_VERSION"),
            report.machine
        )?;
    }
    let worst_spread =
        reports.iter().flat_map(|(_, report)| measured(&report.lines)).map(|(_, _, m)| m.spread).fold(1.0, f64::max);
    writeln!(
        out,
        "The **error** is the largest over up to 100 equally spaced times: the angle to the reference's attitude (rad), and \
         the differences in modal coordinates and in displacement, velocity and acceleration of the points, each over its \
         largest value. The **reference** is the exponential scheme with its step halved until this changes nothing more; \
         \"≤\" is below three times its own error. The **time** is of the loop on one core: the shortest of at least \
         three runs (the slowest took up to {worst_spread:.1} times as long). Beyond the error of the modes, digits come from \
         more modes, not from shorter steps.\n"
    )?;

    writeln!(out, "## In short: the cheapest run for each error\n")?;
    write!(out, "| error |")?;
    for (scene, _) in reports {
        write!(out, " {} |", scene.title)?;
    }
    writeln!(out, "\n|---:|{}", "---|".repeat(reports.len()))?;
    for k in DECADES {
        let cells: Vec<String> = reports
            .iter()
            .map(|(_, report)| cheapest(measured(&report.lines), k).map_or_else(|| "–".to_owned(), with_scheme))
            .collect();
        if cells.iter().any(|cell| cell != "–") {
            writeln!(out, "| 1e-{k} | {} |", cells.join(" | "))?;
        }
    }

    for (scene, report) in reports {
        write_scene(out, scene, report, pictures)?;
    }
    Ok(())
}

fn write_scene(out: &mut String, given: &Body, report: &CostReport, pictures: &Path) -> std::fmt::Result {
    let time = &report.time_unit;
    let file = given.path.file_name().unwrap_or_default().display();
    writeln!(out, "\n## {}\n", given.title)?;
    writeln!(
        out,
        "`examples/accuracy/{file}`: {} {time}, {} flexible modes, spin {:.1} rad/{time} at the beginning. The reference \
         takes {} steps of {:.2e} {time}; its own error is {:.0e}.\n",
        report.end,
        report.bodies.first().map_or(0, |body| body.flexible),
        initial_spin(report),
        report.reference.steps,
        report.reference.step,
        report.reference.own_error.largest()
    )?;
    let folder = pictures.file_name().unwrap_or_default().display();
    writeln!(out, "![time against error]({folder}/{}.svg)\n", name_of(&report.scene))?;

    let lines: Vec<&Line> = report.lines.iter().collect();
    writeln!(out, "| error | {} |", lines.iter().map(|line| line.name()).collect::<Vec<_>>().join(" | "))?;
    writeln!(out, "|---:|{}", "---:|".repeat(lines.len()))?;
    for k in DECADES {
        let cells: Vec<String> = lines
            .iter()
            .map(|line| {
                cheapest(measured(std::slice::from_ref(line)), k).map_or_else(|| "–".to_owned(), without_scheme)
            })
            .collect();
        if cells.iter().any(|cell| cell != "–") {
            writeln!(out, "| 1e-{k} | {} |", cells.join(" | "))?;
        }
    }
    let orders: Vec<String> = lines
        .iter()
        .filter_map(|line| Some(format!("{} {:.2} ({})", line.name(), line.measured_order?, line.order)))
        .collect();
    if !orders.is_empty() {
        writeln!(out, "\nOrders measured (and expected): {}.", orders.join(", "))?;
    }
    writeln!(out, "\n{}\n", paper_in_words(report))?;
    write_modes(out, report)
}

/// The worth of the paper's scheme, in words.
fn paper_in_words(report: &CostReport) -> String {
    let is_paper = |line: &&Line| line.scheme == "paper";
    let paper: Vec<Line> = report.lines.iter().filter(is_paper).cloned().collect();
    let mut words = "**The paper's scheme.** ".to_owned();
    if let Some(errors) = report.paper_limit.as_ref().and_then(|limit| limit.errors) {
        let parts: Vec<String> = errors.named().map(|(name, error)| format!("{name} {error:.1e}")).collect();
        let _ = write!(
            words,
            "However short its steps, the paper's formulation stays away from the conservative one: {}.",
            parts.join(", ")
        );
    }
    if let Some(why) = &report.paper_limit_failure {
        // After the second colon comes advice.
        let why: Vec<&str> = why.split(": ").take(2).collect();
        let _ =
            write!(words, "The limit of the paper's formulation for short steps was not found, {}.", why.join(": "));
    }
    let closest = measured(&paper).map(|(_, _, m)| m.error).fold(f64::INFINITY, f64::min);
    if closest.is_finite() {
        let _ = write!(words, " The smallest error of its runs is {closest:.1e}.");
    }
    words
}

fn write_modes(out: &mut String, report: &CostReport) -> std::fmt::Result {
    let Some(body) = report.bodies.first() else { return Ok(()) };
    let Some(most) = body.modes.last() else { return Ok(()) };
    writeln!(
        out,
        "The price of modes: the same motion against {} modes (steps leave {:.0e}).\n",
        most.flexible, most.step_error
    )?;
    writeln!(
        out,
        "| modes | to, {} | error | attitude | modal | displacement | velocity | acceleration | time of a step |\n\
         |---:|---:|---:|---:|---:|---:|---:|---:|---:|",
        frequency_unit(&report.time_unit)
    )?;
    let optional = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.1e}"));
    for row in &body.modes {
        let errors = match row.errors {
            Some(e) => format!(
                "{:.1e} | {:.1e} | {} | {} | {} | {}",
                e.largest(),
                e.attitude,
                optional(e.modal),
                optional(e.displacement),
                optional(e.velocity),
                optional(e.acceleration)
            ),
            None => "– | – | – | – | – | –".to_owned(),
        };
        writeln!(
            out,
            "| {} | {:.2} | {errors} | {} |",
            row.flexible,
            row.highest_frequency,
            duration(row.seconds_per_step)
        )?;
    }
    Ok(())
}

type Found<'a> = (&'a Line, &'a LadderRun, &'a MeasuredRun);

fn measured(lines: &[Line]) -> impl Iterator<Item = Found<'_>> {
    lines.iter().flat_map(|line| line.rows.iter().filter_map(move |row| Some((line, row, row.measured()?))))
}

/// The fastest run within 10^−k.
fn cheapest<'a>(runs: impl Iterator<Item = Found<'a>>, k: i32) -> Option<Found<'a>> {
    let error = 10_f64.powi(-k);
    runs.filter(|(_, _, m)| m.error <= error).min_by(|a, b| a.2.seconds.total_cmp(&b.2.seconds))
}

fn with_scheme((line, row, m): Found<'_>) -> String {
    format!("{}, {}: {}", line.name(), setting(row.setting), duration(m.seconds))
}

fn without_scheme((_, row, m): Found<'_>) -> String {
    format!("{} ({})", duration(m.seconds), setting(row.setting))
}
