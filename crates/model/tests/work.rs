//! The work that four scenes take, by counts: `work.txt`, so that a change of it shows where a change is looked at.

use std::fmt::Write;
use std::path::Path;

use dynamics::Reached;
use model::{Builder, Model};
use scene::{Body, StepControl};

/// A rigid body on a hinge; step control; a formula, static shapes, and fixed steps of a driven body; large modes under a tip load.
const SCENES: [&str; 4] = ["pendulum", "ring", "spin_up", "boom"];
/// Writes the counts that are found in the place of those that are expected.
const ACCEPT: &str = "FLEXFRAME_ACCEPT";

/// The counts of a scene, a line for each stage.
fn counts(name: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let body = Body::read(root.join("examples").join(name).with_extension("toml")).unwrap();
    let builder = Builder::default();
    let assembly = builder.assemble(&body, |_| ()).unwrap();
    let mut variants = assembly.variants().unwrap();
    let model = variants.build(&body, &builder.needs, |_| ()).unwrap();
    let work = variants.work();
    let mut text = format!("{name}\n");
    if let Some(meshed) = &model.meshed {
        let stats = meshed.modes.stats;
        let (unknowns, entries, cycles) = (stats.unknowns, stats.factor_entries, stats.cycles);
        writeln!(text, "  factor      {unknowns} unknowns, {entries} entries").unwrap();
        let (solves, basis) = (stats.block_solves, stats.basis_size);
        writeln!(text, "  modes       {solves} block solves, {basis} vectors in the basis, {cycles} cycles").unwrap();
        let (blocks, columns, passes) = (work.blocks, work.columns, work.element_passes);
        writeln!(text, "  all of it   {blocks} block solves, {columns} columns, {passes} passes over the elements")
            .unwrap();
    }
    writeln!(text, "{}", run(&body, &model)).unwrap();
    text
}

/// The counts of the time loop.
fn run(body: &Body, model: &Model) -> String {
    let mut simulation = model.start(body).unwrap();
    let mut rows = 0;
    let allocated = allocation_counter::measure(|| {
        loop {
            match simulation.advance(u64::MAX).unwrap() {
                Reached::End => break,
                _ => rows += 1,
            }
        }
    });
    let stats = simulation.stats();
    // Counts of a run by `tolerance` go by rounding, and so by the vectors of the processor.
    let count = |count: u64| match body.time.control {
        StepControl::Fixed(_) => count.to_string(),
        StepControl::Tolerance(_) => format!("about {:.1e}", count as f64),
    };
    let (accepted, evaluations) = (count(stats.accepted), count(stats.evaluations));
    let (rejected, allocations) = (stats.rejected < stats.accepted / 100, count(allocated.count_total));
    let rejected = if rejected { "hardly any" } else { "many" };
    let steps =
        format!("  steps       {accepted} accepted, {rejected} rejected, {evaluations} evaluations of the rates");
    format!("{steps}\n  rows        {rows}, {allocations} allocations from the first step to the last\n")
}

/// Regression only: counts of the program as it is.
#[test]
fn the_work_of_the_scenes_is_what_it_was() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/work.txt");
    let found: String = SCENES.map(counts).concat();
    if std::env::var_os(ACCEPT).is_some() {
        std::fs::write(&file, &found).unwrap();
    }
    let expected = std::fs::read_to_string(&file).unwrap_or_default();
    let other = expected.lines().zip(found.lines()).filter(|(expected, found)| expected != found);
    let other: String = other.map(|(expected, found)| format!("- {expected}\n+ {found}\n")).collect();
    assert!(
        expected == found,
        "other work than in crates/model/tests/work.txt; if that is meant: {ACCEPT}=1 cargo test -p model --test work\n{other}"
    );
}
