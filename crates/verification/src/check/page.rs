//! `docs/evidence/check.md`.

use std::fmt::Write;

use super::{Pair, cases, pairs};

/// Classes of the true error.
const CLASSES: [(&str, f64, f64); 4] =
    [("below 1 %", 0.0, 0.01), ("1 to 10 %", 0.01, 0.1), ("10 to 60 %", 0.1, 0.6), ("above 60 %", 0.6, f64::INFINITY)];

/// The page.
///
/// # Errors
/// A case that cannot be built, in words.
pub fn page(mut progress: impl FnMut(&str)) -> Result<String, String> {
    let (mut all, mut left_out) = (Vec::new(), Vec::new());
    for case in cases() {
        progress(&format!("{} ({})", case.name, case.parameter));
        all.extend(pairs(&case, &mut left_out)?);
    }
    let mut page = format!(
        "# The check against the truth\n\n\
         Made by `./dev check-table`: {} pairs of a case and a model of ten modes with static shapes where the program takes them. The model comes \
         to its rest under the load, or to its rest in a steady spin; [the check](../method/check.md) then says how far it is \
         from the full body, by one factor and by two. The truth is the rest of the full body, found from the undeformed one by the mixed iteration to 1e-10 of its displacements. Models: without \
         stiffening (`linear`), stiffened by stress (`stress`), with two large modes. Forces are named by the deflection in metres that \
         they would about cause in a linear body, spins by their part of the first frequency.\n\n\
         Estimate over truth of the error at the tip, smallest and largest:\n\n\
         | true error | pairs | one factor | two factors |\n|---|---:|---|---|\n",
        all.len()
    );
    for (name, from, to) in CLASSES {
        let of: Vec<&Pair> = all.iter().filter(|pair| (from..to).contains(&pair.error)).collect();
        let range = |which: usize| {
            let values = of.iter().map(|pair| pair.estimates[which]);
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            if of.is_empty() { "–".to_owned() } else { format!("{low:.3} to {high:.3}") }
        };
        // Writing to a String cannot fail.
        let _ = writeln!(page, "| {name} | {} | {} | {} |", of.len(), range(0), range(1));
    }
    let stated = |pair: &&Pair| pair.stated[1] >= 0.8 * pair.stated[0];
    let near = |pair: &&Pair| pair.stated[1] <= 3.0 * pair.stated[0];
    let _ = writeln!(
        page,
        "\nOver the whole body, with as many factors as the check takes by itself, it states at least 0.8 of the true error in {} of {} \
         pairs, and at most 3 times of it in {}.\n\n\
         | case | | model | tip, of the size | true error at the tip, % | one factor | two | stated over the body, % | true, % | \
         factors of the truth |\n|---|---:|---|---:|---:|---:|---:|---:|---:|---:|",
        all.iter().filter(stated).count(),
        all.len(),
        all.iter().filter(near).count()
    );
    for pair in &all {
        let Pair { case, parameter, model, deflection, error, estimates: [one, two], stated: [truth, stated], factors } =
            pair;
        let _ = writeln!(
            page,
            "| {case} | {parameter} | {model} | {deflection:.3} | {} | {one:.3} | {two:.3} | {} | {} | {factors} |",
            percent(*error),
            percent(*stated),
            percent(*truth)
        );
    }
    if !left_out.is_empty() {
        let _ = writeln!(page, "\nLeft out: {}.", left_out.join("; "));
    }
    Ok(page)
}

fn percent(part: f64) -> String {
    format!("{:.3}", 100.0 * part)
}
