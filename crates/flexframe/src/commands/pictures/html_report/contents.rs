//! Contents of the page of a run.

use std::path::Path;

use fem_tet10::von_mises;
use nalgebra::Vector3;
use report::{
    Component, Effect, Fact, PageBalance, PageBody, PageMotion, PageStress, PageSurface, PageTrustLine, PageUnits,
    RunPage, RunState, SceneText, Shape, ShapeKind, Trust,
};
use results::kind::{NATURAL_MODE, STATIC_SHAPE};
use results::{
    BodyProperties, BodyResults, Components, EffectProperties, History, MeshProperties, Metadata, Results, Scope,
    Shapes, StressShapes, histories,
};

use crate::commands::modes::frequency_unit;
use crate::commands::pictures::html_report::quantities::Quantities;
use crate::drawn::DrawnBody;
use crate::files::scene_file;
use crate::report::{others_in_words, quantity};
use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;
use crate::rows::units::UnitLabels;
use crate::surface;
use crate::trust::card::TrustCard;

/// All of it; `None` where the file has not got the columns that it needs.
pub(super) fn contents(file: &Path, results: &Results, drawn: Vec<DrawnBody>) -> Option<RunPage> {
    let run = &results.metadata;
    let units = &run.units;
    let quantities = Quantities::new(results);
    let scene_file = scene_file::to_path(&run.scene_file);
    let bodies = results.bodies().zip(drawn).map(|(of, drawn)| body(of, drawn.shapes, results));
    Some(RunPage {
        title: run.title.clone(),
        program: format!("flexframe {}", run.program_version),
        state: state(file, results)?,
        units: PageUnits {
            length: units.length.clone(),
            time: units.time.clone(),
            frequency: frequency_unit(&units.time),
        },
        facts: facts(results)?,
        times: results.numbers("time")?.to_vec(),
        bodies: bodies.collect::<Option<_>>()?,
        histories: in_order(run).into_iter().flat_map(|history| courses(history, results, &quantities)).collect(),
        balances: balances(results, &quantities)?,
        scene: SceneText {
            file: scene_file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            text: run.scene_text.clone(),
        },
        warnings: warnings(run),
        trust: trust(file, run),
        live: None,
        compared: None,
    })
}

fn body(of: BodyResults<'_>, shapes: Option<Shapes>, results: &Results) -> Option<PageBody> {
    let model = &of.metadata.model;
    let surface = shapes.map(surface::Surface::new);
    Some(PageBody {
        name: of.metadata.name.clone(),
        facts: facts_of_body(model, surface.is_some(), &results.metadata.units),
        surface: surface.as_ref().map(|surface| reference(surface, model)),
        shapes: surface.as_ref().map_or_else(Vec::new, |surface| described(&surface.shapes, model)),
        stress: surface.as_ref().and_then(|surface| stress(&surface.shapes, of, results)),
        motion: motion(of, results.rows(), surface.as_ref().map(|surface| &surface.shapes))?,
        effects: of.metadata.effects.iter().map(effect).collect(),
    })
}

/// The histories in the order in which they are looked at: body by body, first the motion of the points, last the quaternion;
/// then joint by joint, and the system.
/// Those of the system are the same as those of a single body.
fn in_order(run: &Metadata) -> Vec<History<Row>> {
    let is_several = run.only_body().is_none();
    let mut all: Vec<_> =
        histories(&COLUMNS, run).filter(|history| history.column.scope() != Scope::System || is_several).collect();
    all.sort_by_key(|history| {
        let within = match (history.column.scope(), history.column.components()) {
            (Scope::Point, _) => 0,
            (_, Components::Quaternion) => 2,
            _ => 1,
        };
        (history.body.unwrap_or(usize::MAX), history.joint.unwrap_or(usize::MAX), within)
    });
    all
}

fn state(file: &Path, results: &Results) -> Option<RunState> {
    if results.complete {
        return Some(RunState::Complete);
    }
    let reached = results.numbers("time")?.last().copied().unwrap_or_default();
    let time = &results.metadata.units.time;
    let (reached, end) = (quantity(reached), quantity(results.metadata.end));
    let from =
        results.unchecked_from.map(|from| format!(" No check sum covers them from {} {time} on.", quantity(from)));
    let unchecked = from.unwrap_or_default();
    let words = format!(
        "This run has not come to its end: its rows reach {reached} {time} of {end} {time}.{unchecked} Continue it with: flexframe \
         resume {}",
        file.display()
    );
    Some(RunState::Unfinished(words))
}

/// Facts about the run.
fn facts(results: &Results) -> Option<Vec<Fact>> {
    let Metadata { units, bodies, scheme, formulation, .. } = &results.metadata;
    let last = results.numbers("time")?.last().copied().unwrap_or_default();
    let several = (bodies.len() > 1).then(|| Fact::new("Bodies", bodies.len().to_string()));
    let time = Fact::new("Time", format!("{} {} in {} rows", quantity(last), units.time, results.rows()));
    Some(several.into_iter().chain([time, Fact::new("Scheme", format!("{scheme} ({formulation})"))]).collect())
}

fn facts_of_body(body: &BodyProperties, is_drawn: bool, units: &results::Units) -> Vec<Fact> {
    let mut facts = vec![Fact::new("Mass", format!("{} {}", quantity(body.mass), units.mass))];
    match &body.mesh {
        Some(MeshProperties { nodes, elements: 0, .. }) => {
            facts.push(Fact::new("Mesh", format!("{nodes} nodes, matrices of another program")));
        }
        Some(MeshProperties { nodes, elements, .. }) => {
            facts.push(Fact::new("Mesh", format!("{nodes} nodes, {elements} elements")));
        }
        None if is_drawn => {
            facts.push(Fact::new("Shown as", "the box of its mass and inertia, bars to its points".to_owned()));
        }
        None => {}
    }
    facts.push(Fact::new("Shapes", shapes_in_words(body)));
    facts
}

/// How many shapes there are of each kind.
fn shapes_in_words(body: &BodyProperties) -> String {
    let natural = body.kinds().filter(|kind| *kind == NATURAL_MODE).count();
    let modes = (natural > 0).then(|| format!("{natural} {}", if natural == 1 { "mode" } else { "modes" }));
    let kinds: Vec<&str> = body.kinds().collect();
    let all: Vec<String> = modes.into_iter().chain(others_in_words(kinds.iter().copied())).collect();
    if all.is_empty() { "rigid body".to_owned() } else { all.join(", ") }
}

fn reference(surface: &surface::Surface, body: &BodyProperties) -> PageSurface {
    let from_origin = |x: &[f64; 3]| (Vector3::from(*x) - Vector3::from(body.origin)).map(|x| x as f32).into();
    PageSurface {
        vertices: surface.shapes.positions.iter().map(from_origin).collect(),
        triangles: surface.triangles.clone(),
        edges: surface.edges.clone(),
    }
}

/// The shapes with their names.
fn described(shapes: &Shapes, body: &BodyProperties) -> Vec<Shape> {
    let kinds: Vec<&str> = body.kinds().collect();
    let shape = |(k, displacement): (usize, &Vec<[f64; 3]>)| {
        let (name, kind) = match kinds.get(k) {
            Some(&NATURAL_MODE) => {
                let (frequency, damping_ratio) = (body.frequencies[k], body.damping_ratios[k]);
                (format!("mode {}", k + 1), ShapeKind::Natural { frequency, damping_ratio })
            }
            // Static answers and combinations of modes have no frequency, either.
            Some(kind) => (format!("{kind} {}", k + 1), ShapeKind::Static),
            None => (format!("shape {} of second order", k + 1 - kinds.len()), ShapeKind::SecondOrder),
        };
        Shape { name, kind, displacement: displacement.iter().map(|u| u.map(|x| x as f32)).collect() }
    };
    shapes.displacements.iter().enumerate().map(shape).collect()
}

/// The stress of each shape, and of each product of large modes and of those that follow; at a node between materials, of the one whose von Mises
/// stress is largest in all rows.
fn stress(shapes: &Shapes, of: BodyResults<'_>, results: &Results) -> Option<PageStress> {
    let stress = shapes.stress.as_ref().filter(|_| !shapes.displacements.is_empty())?;
    let modal = of.table("modal/displacement")?;
    let rows: Vec<_> = (0..results.rows()).filter_map(|row| Some(shapes.stress_coordinates(modal.row(row)?))).collect();
    let sites = most_stressed(stress, &rows);
    let count = modal.row(0).map_or(0, <[f64]>::len);
    let is_coordinate = |k: &usize| *k < count;
    let products =
        shapes.factors.iter().map(|factors| factors.iter().map(|k| *k as usize).filter(is_coordinate).collect());
    let results::Units { length, mass, time } = &results.metadata.units;
    Some(PageStress {
        unit: UnitLabels { length, mass, time }.stress(),
        shapes: stress.shapes.iter().map(|shape| sites.iter().map(|i| shape[*i].map(|s| s as f32)).collect()).collect(),
        products: products.collect(),
    })
}

/// The most stressed of the materials at each node, by its place in the list of stresses.
fn most_stressed(stress: &StressShapes, rows: &[Vec<f64>]) -> Vec<usize> {
    let at = |site: usize, coordinates: &[f64]| {
        let mut sum = [0.0; 6];
        for (shape, coordinate) in stress.shapes.iter().zip(coordinates) {
            sum.iter_mut().zip(&shape[site]).for_each(|(sum, s)| *sum += s * coordinate);
        }
        von_mises(&sum)
    };
    let largest = |site: usize| rows.iter().map(|coordinates| at(site, coordinates)).fold(0.0, f64::max);
    let places: Vec<usize> = (0..stress.nodes.len()).collect();
    let of_node = |sites: &[usize]| match sites {
        [only] => Some(*only),
        several => several.iter().copied().max_by(|a, b| largest(*a).total_cmp(&largest(*b))),
    };
    places.chunk_by(|a, b| stress.nodes[*a] == stress.nodes[*b]).filter_map(of_node).collect()
}

fn motion(of: BodyResults<'_>, rows: usize, shapes: Option<&Shapes>) -> Option<PageMotion> {
    let modal = of.table("modal/displacement")?;
    // Without a surface there are no shapes to be seen.
    let of_row = |q: &[f64]| shapes.map_or_else(Vec::new, |shapes| shapes.coordinates(q));
    let coordinates: Option<Vec<_>> = (0..rows).map(|row| Some(of_row(modal.row(row)?))).collect();
    Some(PageMotion {
        origins: of.vectors::<3>("origin")?.to_vec(),
        attitudes: of.vectors::<4>("attitude")?.to_vec(),
        coordinates: coordinates?.concat(),
    })
}

/// The name of a joint, or that of a body in front of what is of it; nothing of a single body, and that of all bodies of the
/// system.
fn prefix(history: History<Row>, run: &Metadata) -> String {
    if let Some(joint) = history.joint(run) {
        return format!("joint {}", joint.name);
    }
    match history.body(run) {
        None => "all bodies: ".to_owned(),
        Some(_) if run.only_body().is_some() => String::new(),
        Some(body) => format!("{}: ", body.name),
    }
}

/// A history as courses: one, or one for each point.
fn courses(history: History<Row>, results: &Results, quantities: &Quantities<'_>) -> Vec<report::PageHistory> {
    let (run, column) = (&results.metadata, history.column);
    let (unit, least_range) = (quantities.unit(column), quantities.least_range(history));
    let frame = if column.frame == "none" { String::new() } else { format!(" ({})", column.frame) };
    let course = |group: String, place: Option<&str>| {
        let table = results.table(&history.path_of(run, place))?;
        let components = (0..table.width())
            .map(|k| Component {
                name: component_name(history, k, run),
                values: table.column(k).into_iter().flatten().collect(),
            })
            .collect::<Vec<_>>();
        let (name, unit) = (format!("{}{frame}", column.name.replace('_', " ")), unit.clone());
        (!components.is_empty()).then_some(report::PageHistory { group, name, unit, least_range, components })
    };
    let places = match column.scope() {
        Scope::Point => "point",
        Scope::Support => "support",
        Scope::System | Scope::Body | Scope::Joint => {
            let group = match (column.components(), column.group) {
                (Components::Modes, _) => "modal coordinates",
                (_, "") if column.scope() == Scope::Joint => "",
                (_, "") => "body",
                (_, group) => group,
            };
            return course(format!("{}{group}", prefix(history, run)), None).into_iter().collect();
        }
    };
    let name_of = |place: &str| match history.body(run).filter(|_| run.only_body().is_none()) {
        Some(body) => format!("{places} {}.{place}", body.name),
        None => format!("{places} {place}"),
    };
    history.places(run).iter().filter_map(|place| course(name_of(place), Some(place))).collect()
}

fn component_name(history: History<Row>, k: usize, run: &Metadata) -> String {
    match (history.column.components(), history.body(run)) {
        (Components::Modes, Some(body)) => match body.model.kinds().nth(k) {
            Some(NATURAL_MODE) => format!("{}", k + 1),
            Some(STATIC_SHAPE) | None => format!("static {}", k + 1),
            Some(kind) => format!("{kind} {}", k + 1),
        },
        (components, _) => components.names().get(k).copied().unwrap_or_default().to_owned(),
    }
}

/// Terms of the balance of energy: names of the columns.
const ENERGIES: [&str; 4] = ["kinetic", "strain", "work", "dissipation"];

/// The balances of each body, and the energy of several together: their terms, and their change since the first row.
fn balances(results: &Results, quantities: &Quantities<'_>) -> Option<Vec<PageBalance>> {
    let energy = ("Energy", "kinetic + strain energy − work of the loads + dissipation is constant");
    let linear = ("Linear momentum", "momentum less the impulse of the loads is constant (global axes)");
    let angular = (
        "Angular momentum",
        "angular momentum less the angular impulse of the loads, about the centre of mass, is constant (global axes)",
    );
    let run = &results.metadata;
    let of = |body: Option<usize>, words, group: &str, terms: &[&str], error: &str| {
        let history = |name: &str| {
            let mut all = histories(&COLUMNS, run).filter(|history| history.body == body && history.joint.is_none());
            all.find(|history| [history.column.group, history.column.name] == [group, name])
        };
        balance(
            results,
            quantities,
            words,
            terms.iter().map(|name| history(name)).collect::<Option<Vec<_>>>()?,
            history(error)?,
        )
    };
    let mut all = Vec::new();
    for body in (0..run.bodies.len()).map(Some) {
        all.push(of(body, energy, "energy", &ENERGIES, "balance")?);
        all.push(of(body, linear, "momentum", &["linear"], "linear_balance")?);
        all.push(of(body, angular, "momentum", &["angular"], "angular_balance")?);
    }
    if run.only_body().is_none() {
        all.push(of(None, energy, "energy", &ENERGIES, "balance")?);
    }
    Some(all)
}

fn balance(
    results: &Results,
    quantities: &Quantities<'_>,
    (name, law): (&str, &str),
    terms: Vec<History<Row>>,
    error: History<Row>,
) -> Option<PageBalance> {
    let run = &results.metadata;
    let components = |history: History<Row>, name: &str, from_first: bool| -> Option<Vec<Component>> {
        let table = results.table(&history.path(run))?;
        let component = |k: usize| {
            let values: Vec<f64> = table.column(k)?.collect();
            let first = if from_first { values.first().copied().unwrap_or_default() } else { 0.0 };
            let axis = history.column.components().names().get(k).copied().unwrap_or_default();
            let name = [name, axis].into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ");
            Some(Component { name, values: values.iter().map(|value| value - first).collect() })
        };
        (0..table.width()).map(component).collect()
    };
    // A single term needs no name.
    let name_of = |term: &History<Row>| if terms.len() > 1 { term.column.name } else { "" };
    let of_terms = terms.iter().map(|term| components(*term, name_of(term), false)).collect::<Option<Vec<_>>>()?;
    Some(PageBalance {
        group: prefix(error, run).trim_end_matches(": ").to_owned(),
        name: name.to_owned(),
        law: law.to_owned(),
        unit: quantities.unit(error.column),
        least_range: quantities.least_range(error),
        terms: of_terms.into_iter().flatten().collect(),
        errors: components(error, "", true)?,
    })
}

fn effect(effect: &EffectProperties) -> Effect {
    let EffectProperties { name, state, measure, reason } = effect.clone();
    Effect { name, state, measure, reason }
}

/// The trust card of the run.
fn trust(file: &Path, run: &Metadata) -> Trust {
    let TrustCard { lines, unseen, .. } =
        TrustCard::of_file(run, &file.file_name().unwrap_or_default().to_string_lossy());
    let line = |results::TrustLine { place, body, error, meaning, known, next }| PageTrustLine {
        place,
        body: body.unwrap_or_default(),
        error,
        meaning,
        known,
        next,
    };
    Trust { lines: lines.into_iter().map(line).collect(), unseen: unseen.to_owned() }
}

/// Known errors of the models, and warnings of the run.
fn warnings(run: &Metadata) -> Vec<String> {
    let refusals = run.bodies.iter().filter_map(|body| {
        let refusal = body.refusal.as_ref()?;
        Some(if run.only_body().is_some() { refusal.clone() } else { format!("body {}: {refusal}", body.name) })
    });
    let refusals: Vec<String> = refusals.collect();
    let of_run = run.warnings.iter().filter(|warning| !refusals.contains(*warning)).cloned();
    refusals.iter().cloned().chain(of_run).collect()
}
