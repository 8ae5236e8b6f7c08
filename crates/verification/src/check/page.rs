//! `docs/evidence/check.md`.

use std::fmt::Write;
use std::path::Path;

use figures::{LineChart, Scale, Series, Stroke};

use super::{CaseInModel, MotionRow, cases, let_go, motions, pair, pairs, random_cases};

/// Classes of the true error.
const CLASSES: [(&str, f64, f64); 4] =
    [("below 1 %", 0.0, 0.01), ("1 to 10 %", 0.01, 0.1), ("10 to 60 %", 0.1, 0.6), ("above 60 %", 0.6, f64::INFINITY)];

/// The page, and its picture of the scenes by lot.
///
/// # Errors
/// A case that cannot be built, in words.
pub fn page(picture: &Path, mut progress: impl FnMut(&str)) -> Result<String, String> {
    let (mut all, mut left_out) = (Vec::new(), Vec::new());
    for case in cases() {
        progress(&format!("{} ({})", case.name, case.parameter));
        all.extend(pairs(&case, &mut left_out)?);
    }
    let mut page = format!(
        "# The check against the truth\n\n\
         Made by `./dev check-table`: {} pairs of a case and a model of ten modes with static shapes. The model comes to its rest \
         under a load or in a steady spin; [the check](../method/check.md) says how far that is from the full body, by one \
         factor and by two. The truth is the rest of the full body to 1e-10 of its displacements. Models: without stiffening, \
         stiffened by stress, with two large modes. Cases: a column, a coned bar, a blade, a quarter arc and a free L, which \
         bend by up to 0.59 of their size.\n\n\
         Estimate over truth of the error at the tip, smallest and largest:\n\n\
         | true error | pairs | one factor | two factors |\n|---|---:|---|---|\n",
        all.len()
    );
    for (name, from, to) in CLASSES {
        let of: Vec<&CaseInModel> = all.iter().filter(|pair| (from..to).contains(&pair.error)).collect();
        let range = |which: usize| {
            let values = of.iter().map(|pair| pair.estimates[which]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            if of.is_empty() { "–".to_owned() } else { format!("{low:.3} to {high:.3}") }
        };
        // Writing to a String cannot fail.
        let _ = writeln!(page, "| {name} | {} | {} | {} |", of.len(), range(0), range(1));
    }
    let stated = |pair: &&CaseInModel| pair.stated[1] >= 0.8 * pair.stated[0];
    let near = |pair: &&CaseInModel| pair.stated[1] <= 3.0 * pair.stated[0];
    let _ = writeln!(
        page,
        "\nOver the whole body, with as many factors as the check takes by itself, it states at least 0.8 of the true error in {} of {} \
         pairs, and at most 3 times of it in {}.",
        all.iter().filter(stated).count(),
        all.len(),
        all.iter().filter(near).count()
    );
    if !left_out.is_empty() {
        let _ = writeln!(page, "\nLeft out: {}.", left_out.join("; "));
    }
    let _ = write!(
        page,
        "\n## In motion\n\n\
         The check does not see how far the phase of a vibration is off, nor that the inertia lacks the foreshortening. A body is let go from its first mode; eight modes and the nonlinear body (midpoint \
         rule, 200 steps a period) move for four periods. Largest values in the rows of the fourth period, over the largest \
         displacement: how far the model is off, and how far the check says that it is.\n\n\
         | body | let go at, of its length | model | off, % | stated, % | beside the modes, % | frequency that it states, % |\n\
         |---|---:|---|---:|---:|---:|---:|\n"
    );
    for motion in motions() {
        progress(&format!("{} let go, {}", motion.name, motion.model));
        let rows = let_go(&motion)?;
        let most = |of: fn(&MotionRow) -> f64| rows.iter().map(of).fold(0.0, f64::max);
        let frequency =
            rows.iter().map(|row| row.frequency).fold(0.0, |most: f64, f| if f.abs() > most.abs() { f } else { most });
        let _ = writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {:+.3} |",
            motion.name,
            motion.deflection,
            motion.model,
            percent(most(|row| row.off)),
            percent(most(|row| row.stated)),
            percent(most(|row| row.beside)),
            100.0 * frequency
        );
    }
    let _ = writeln!(
        page,
        "\nThe frequency that it states is of small vibrations about the row, without the inertia of large ones."
    );
    scenes_by_lot(&mut page, picture, &mut progress)?;
    Ok(page)
}

/// Scenes that are drawn by lot.
const SCENES: usize = 200;
/// Errors below this are rounding, and drawn there.
const ROUNDING: f64 = 1e-9;

fn scenes_by_lot(page: &mut String, picture: &Path, mut progress: impl FnMut(&str)) -> Result<(), String> {
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for (number, (case, model)) in random_cases(SCENES).into_iter().enumerate() {
        progress(&format!("scene {}: {}", number + 1, case.name));
        found.extend(pair(&case, model, &mut left_out)?);
    }
    let part = |count: usize| {
        format!("{count} of {} ({:.1} %)", found.len(), 100.0 * count as f64 / found.len().max(1) as f64)
    };
    let enough = found.iter().filter(|pair| pair.stated[1] >= 0.8 * pair.stated[0]).count();
    let near = found.iter().filter(|pair| pair.stated[1] <= 3.0 * pair.stated[0]).count();
    let _ = write!(
        page,
        "\n## Scenes by lot\n\n\
         {SCENES} scenes of four bodies, drawn at random: clamped, in a spin, in one that speeds up, or on a slider that accelerates; \
         under no load, a force, gravity, a moment or a pressure; in one of the three models. The error over the body that the \
         check states, against the true one. {} scenes have no rest to compare with.\n\n\
         | | pairs |\n|---|---:|\n\
         | stated at least 0.8 of the true error | {} |\n\
         | stated at most 3 times of it | {} |\n\n\
         ![Stated error against true error](check/scenes.svg)\n",
        left_out.len(),
        part(enough),
        part(near)
    );
    let at = |part: f64| 100.0 * part.max(ROUNDING);
    let points = found.iter().map(|pair| (at(pair.stated[0]), at(pair.stated[1]))).collect();
    let line = |factor: f64| [1e-5, 1e4].map(|x| (x, factor * x)).to_vec();
    let series = |label: &str, points, stroke| Series { label: label.to_owned(), points, stroke };
    let chart = LineChart {
        title: format!("{} scenes by lot", found.len()),
        x_label: "True error, %".to_owned(),
        y_label: "Stated error, %".to_owned(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series: vec![
            series("scenes", points, Stroke::Rings),
            series("0.8 of it", line(0.8), Stroke::Guide),
            series("3 times", line(3.0), Stroke::Guide),
        ],
        reference: None,
    };
    chart.save_svg(picture).map_err(|error| error.to_string())?;
    Ok(())
}

fn percent(part: f64) -> String {
    format!("{:.3}", 100.0 * part)
}
