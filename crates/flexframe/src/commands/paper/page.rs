//! The page that sets the run beside the paper.

use std::fmt::Write;

use scene::{Body, History, LoadKind, LoadPlace};

use super::comparison::{Comparison, Histories, Pair};
use crate::commands::run::RunReport;
use crate::rows::units::UnitLabels;

/// The page as Markdown.
pub(super) fn page(body: &Body, run: &RunReport, comparison: &Comparison) -> String {
    let mut page = String::new();
    // Writing to a String cannot fail.
    let _ = write_page(&mut page, body, run, comparison);
    page
}

fn write_page(out: &mut String, body: &Body, run: &RunReport, c: &Comparison) -> std::fmt::Result {
    let [length, mass, time] = &run.units;
    writeln!(out, "# {}: beside the paper\n", body.title)?;
    writeln!(
        out,
        "X. Liu, *A Novel Approach for Flexible Body Dynamics Computation via Synthesizing Incremental Motions in \
         Reconfigured Inertial Frames* (Sandia). Made by flexframe {} from `{}`; `./dev plate` makes it again.\n",
        env!("CARGO_PKG_VERSION"),
        body.path.file_name().unwrap_or_default().display()
    )?;
    writeln!(out, "```text\n{run}\n```\n")?;

    writeln!(out, "## What the paper does not give, and what was assumed\n")?;
    let mesh = run.bodies.first().and_then(|plate| plate.mesh.as_ref());
    let (nodes, elements) = mesh.map_or((0, 0), |mesh| (mesh.nodes, mesh.elements));
    writeln!(
        out,
        "* **Its mesh** (MATLAB's PDE toolbox). Here: gmsh, {nodes} nodes and {elements} ten-node tetrahedra. Each point mass sits on \
         one node, and the compliance under it grows without limit as the mesh is refined: modes 8, 14 and 16 follow \
         the mesh, the others hardly do."
    )?;
    writeln!(out, "* **The history of its force** (Fig. 4 is only a picture). {}", force_in_words(body))?;
    writeln!(
        out,
        "* **The length of its run.** Here {} {time}: {}.",
        body.time.end,
        run.bodies.first().map_or_else(String::new, |plate| plate.steps_in_words(run))
    )?;
    writeln!(
        out,
        "* **Damping** is 5 % \"for all the modes\" in the paper; rigid modes have no frequency to take a share of, so \
         only the flexible ones are damped here.\n"
    )?;

    writeln!(out, "## Mass properties\n")?;
    writeln!(
        out,
        "The paper's moments are those of a body with each element's mass at its centroid; the consistent mass matrix \
         gives the exact ones of the plate. The scheme uses the consistent ones.\n"
    )?;
    writeln!(out, "| quantity | paper | consistent | difference | at centroids | difference |")?;
    writeln!(out, "|---|---:|---:|---:|---:|---:|")?;
    writeln!(out, "| mass, {mass} | {} | {:.6} | {} | | |", c.mass.paper, c.mass.here, percent(&c.mass))?;
    for (i, (exact, lumped)) in c.moments.iter().zip(&c.lumped_moments).enumerate() {
        writeln!(
            out,
            "| I{n}{n}, {mass} {length}² | {} | {:.5} | {} | {:.5} | {} |",
            exact.paper,
            exact.here,
            percent(exact),
            lumped.here,
            percent(lumped),
            n = i + 1
        )?;
    }

    writeln!(out, "\n## Table 1: frequencies of the flexible modes, Hz\n")?;
    writeln!(out, "| mode | paper's number | paper | here | difference |\n|---:|---:|---:|---:|---:|")?;
    for (k, pair) in c.frequencies.iter().enumerate() {
        writeln!(out, "| {} | {} | {:.4} | {:.4} | {} |", k + 1, k + 7, pair.paper, pair.here, percent(pair))?;
    }
    writeln!(
        out,
        "\n![mode shapes](fig03_mode_shapes.png)\n\n*Fig. 3. Mode shapes.* [SVG](fig03_mode_shapes.svg), [PDF](fig03_mode_shapes.pdf)\n"
    )?;

    writeln!(out, "## The motion\n")?;
    writeln!(
        out,
        "The rigid plate has the consistent mass and inertia and the same load, by Euler's equations. \
         \"Apart\" is the largest difference over the run, relative to the rigid plate's peak.\n"
    )?;
    writeln!(out, "| figure | the paper says | here |\n|---|---|---|")?;
    let negligible = "negligible";
    writeln!(out, "| 5 | α₁, α₃ {negligible} | at most {:.1e} of the peak of α₂ |", c.fig_5)?;
    writeln!(out, "| 6 | ω₁, ω₃ {negligible} | at most {:.1e} of the peak of ω₂ |", c.fig_6)?;
    writeln!(out, "| 7 | X₂ displacements trivial | at most {:.1e} of the largest displacement |", c.fig_7)?;
    let matched = "matches the rigid plate precisely";
    let acceleration = format!("{length}/{time}²");
    for (figure, what, h, unit) in [
        (8, "α₂", &c.fig_8, &format!("rad/{time}²")),
        (9, "ω₂", &c.fig_9, &format!("rad/{time}")),
        (10, "X₁ acceleration of P1, embedded rigid motion,", &c.fig_10, &acceleration),
        (11, "X₃ acceleration of P1, embedded rigid motion,", &c.fig_11, &acceleration),
    ] {
        writeln!(out, "| {figure} | {what} {matched} | {} |", apart(h, unit))?;
    }
    for (figure, direction, h) in [(12, "X₁", &c.fig_12), (13, "X₃", &c.fig_13)] {
        writeln!(
            out,
            "| {figure} | {direction} acceleration of P1 shows rigid motion and vibration | {} |",
            apart(h, &acceleration)
        )?;
    }
    writeln!(out)?;
    for (file, caption) in [
        ("fig04_force", "Fig. 4. History of the force: chosen here, see above."),
        ("fig05_angular_acceleration_13", "Fig. 5."),
        ("fig06_angular_velocity_13", "Fig. 6."),
        ("fig07_displacement_2", "Fig. 7."),
        ("fig08_angular_acceleration_2", "Fig. 8."),
        ("fig09_angular_velocity_2", "Fig. 9."),
        ("fig10_rigid_acceleration_1", "Fig. 10."),
        ("fig11_rigid_acceleration_3", "Fig. 11."),
        ("fig12_acceleration_1", "Fig. 12."),
        ("fig13_acceleration_3", "Fig. 13."),
    ] {
        writeln!(out, "![{caption}]({file}.png)\n\n*{caption}* [SVG]({file}.svg), [PDF]({file}.pdf)\n")?;
    }
    Ok(())
}

fn percent(pair: &Pair) -> String {
    format!("{:+.4} %", 100.0 * pair.difference())
}

fn apart(histories: &Histories, unit: &str) -> String {
    format!("apart by {:.1e} of the peak {:.5} {unit}", histories.difference, histories.peak)
}

fn force_in_words(body: &Body) -> String {
    let sentences = body.loads.iter().filter_map(|load| {
        let (LoadKind::Force, LoadPlace::Point(at)) = (load.kind, &load.place) else { return None };
        let History::HalfSine { start, duration } = load.history else { return None };
        Some(format!(
            "Here: a half-sine pulse of {} {} along {:.4?} at {:?}, from {start} for {duration} {}.",
            load.amplitude,
            UnitLabels::from(&body.units).force(),
            load.direction,
            at,
            body.units.time
        ))
    });
    sentences.collect::<Vec<_>>().join(" ")
}
