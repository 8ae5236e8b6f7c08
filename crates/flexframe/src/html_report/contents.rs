//! Contents of the page of a run.

use std::path::Path;

use dynamics::Manifold;
use modal::{ReducedBody, SecondOrderShapes};
use nalgebra::Vector3;
use report::{
    Balance, Component, Effect, Fact, History, Motion, Report, RunState, SceneText, Shape, ShapeKind, StressField,
    Surface, Units,
};
use results::{Column, Results, Values};
use scene::{Meshed, Model, Scene};

use crate::columns::COLUMNS;
use crate::effects::is_on;
use crate::html_report::quantities::Quantities;
use crate::modes::frequency_unit;
use crate::report::{BodyReport, MeshReport, quantity};
use crate::row::Row;
use crate::surface;
use crate::units::UnitLabels;

/// Most nodes by which a body without elements is drawn.
const MOST_NODES: usize = 20_000;

/// All of it; `None` where the file has not got the columns that it needs.
pub(super) fn contents(file: &Path, results: &Results, scene: &Scene, model: &Model) -> Option<Report> {
    let body = BodyReport::new(model);
    let surface = model.meshed.as_ref().map(|Meshed { mesh, .. }| match mesh.has_elements() {
        true => surface::Surface::new(mesh),
        false => surface::Surface::of_nodes(mesh, MOST_NODES),
    });
    let units = &results.metadata.units;
    let quantities = Quantities::new(results, model);
    Some(Report {
        title: results.metadata.title.clone(),
        program: format!("flexframe {}", results.metadata.program_version),
        state: state(file, results, scene)?,
        units: Units { length: units.length.clone(), time: units.time.clone(), frequency: frequency_unit(&units.time) },
        facts: facts(results, model, &body)?,
        surface: surface.as_ref().map(|surface| reference(surface, model)),
        shapes: shapes(surface.as_ref(), model, &body),
        stress: surface.as_ref().and_then(|surface| stress(surface, results, scene, model)),
        motion: motion(results, model)?,
        histories: in_order().flat_map(|column| histories(column, results, &body, &quantities)).collect(),
        balances: balances(results, &quantities)?,
        effects: effects(scene, model),
        scene: SceneText {
            file: scene.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            text: results.metadata.scene_text.clone(),
        },
        warnings: warnings(results, model),
    })
}

/// The columns in the order in which they are looked at: first the motion of the points, last the quaternion.
fn in_order() -> impl Iterator<Item = &'static Column<Row>> {
    let mut columns: Vec<_> = COLUMNS.iter().collect();
    columns.sort_by_key(|column| match column.values {
        Values::Points(_) | Values::PointNumbers(..) => 0,
        Values::Quaternion(_) => 2,
        _ => 1,
    });
    columns.into_iter()
}

fn state(file: &Path, results: &Results, scene: &Scene) -> Option<RunState> {
    if results.complete {
        return Some(RunState::Complete);
    }
    let reached = results.numbers("time")?.last().copied().unwrap_or_default();
    let time = &results.metadata.units.time;
    let (reached, end) = (quantity(reached), quantity(scene.time.end));
    let words = format!(
        "This run has not come to its end: its rows reach {reached} {time} of {end} {time}. Continue it with: flexframe \
         resume {}",
        file.display()
    );
    Some(RunState::Unfinished(words))
}

fn facts(results: &Results, model: &Model, body: &BodyReport) -> Option<Vec<Fact>> {
    let units = &results.metadata.units;
    let fact = |label: &str, value: String| Fact { label: label.to_owned(), value };
    let mut facts = vec![fact("Mass", format!("{} {}", quantity(body.mass), units.mass))];
    if let Some(mesh) = MeshReport::new(model) {
        facts.push(fact("Mesh", mesh.in_words()));
    }
    let fixed = body.static_shapes();
    let modes = body.natural_frequencies.len() - fixed;
    facts.push(match (modes, fixed) {
        (0, 0) => fact("Shapes", "rigid body".to_owned()),
        (modes, 0) => fact("Shapes", format!("{modes} modes")),
        (modes, fixed) => fact("Shapes", format!("{modes} modes, {fixed} static")),
    });
    let last = results.numbers("time")?.last().copied().unwrap_or_default();
    facts.push(fact("Time", format!("{} {} in {} rows", quantity(last), units.time, results.rows())));
    facts.push(fact("Scheme", format!("{} ({})", results.metadata.scheme, results.metadata.formulation)));
    Some(facts)
}

fn reference(surface: &surface::Surface, model: &Model) -> Surface {
    let from_origin = |x: &[f64; 3]| (Vector3::from(*x) - model.body.origin).map(|x| x as f32).into();
    Surface {
        vertices: surface.points.iter().map(from_origin).collect(),
        triangles: surface.triangles.clone(),
        edges: surface.edges.clone(),
    }
}

fn shapes(surface: Option<&surface::Surface>, model: &Model, body: &BodyReport) -> Vec<Shape> {
    let modes = body.natural_frequencies.len() - body.static_shapes();
    let shape = |k: usize| {
        let mut q = vec![0.0; k + 1];
        q[k] = 1.0;
        let displaced = surface.zip(model.meshed.as_ref()).map(|(surface, meshed)| surface.displacements(meshed, &q));
        let (name, kind) = if k < modes {
            let (frequency, damping_ratio) = (body.natural_frequencies[k], body.damping_ratios[k]);
            (format!("mode {}", k + 1), ShapeKind::Natural { frequency, damping_ratio })
        } else if k < model.body.flexible() {
            (format!("static shape {}", k + 1), ShapeKind::Static)
        } else {
            (format!("shape {} of second order", k + 1 - model.body.flexible()), ShapeKind::SecondOrder)
        };
        let displacement = displaced.unwrap_or_default().iter().map(|u| u.map(|x| x as f32).into()).collect();
        Shape { name, kind, displacement }
    };
    (0..extended(model).flexible()).map(shape).collect()
}

/// The stress of each shape, and of each product of two large modes.
fn stress(surface: &surface::Surface, results: &Results, scene: &Scene, model: &Model) -> Option<StressField> {
    let (body, large) = (model.stress.as_ref()?, model.large_modes());
    let shapes = extended(model).flexible();
    if shapes == 0 {
        return None;
    }
    let modal = results.table("modal/displacement")?;
    let rows: Option<Vec<_>> = (0..results.rows()).map(|row| Some(body.coordinates(modal.row(row)?))).collect();
    let rows = rows?;
    let of_nodes: Vec<&[[f64; 6]]> =
        surface.nodes.iter().filter_map(|node| body.of_most_stressed_material(*node, &rows)).collect();
    let pairs = SecondOrderShapes::pairs(large.len());
    let shape = |k: usize| of_nodes.iter().map(|shapes| shapes[k].map(|s| s as f32)).collect::<Vec<_>>();
    Some(StressField {
        unit: UnitLabels::from(&scene.units).stress(),
        shapes: (0..shapes + pairs.len()).map(shape).collect(),
        products: pairs.iter().map(|pair| pair.map(|i| large[i])).collect(),
    })
}

/// The body in all shapes that are drawn: with those that follow large modes.
fn extended(model: &Model) -> &ReducedBody {
    model.physics.large_deflection.as_ref().map_or(&model.body, Manifold::body)
}

fn motion(results: &Results, model: &Model) -> Option<Motion> {
    let modal = results.table("modal/displacement")?;
    let coordinates: Option<Vec<_>> = (0..results.rows()).map(|row| Some(model.coordinates(modal.row(row)?))).collect();
    Some(Motion {
        times: results.numbers("time")?.to_vec(),
        origins: results.vectors::<3>("origin")?.to_vec(),
        attitudes: results.vectors::<4>("attitude")?.to_vec(),
        coordinates: coordinates?.concat(),
    })
}

/// A column as histories: one, or one for each point. The time is none.
fn histories(column: &Column<Row>, results: &Results, body: &BodyReport, quantities: &Quantities<'_>) -> Vec<History> {
    let (unit, least_range) = (quantities.unit(column), quantities.least_range(column));
    let frame = if column.frame == "none" { String::new() } else { format!(" ({})", column.frame) };
    let history = |group: String, name: &str, path: &str| {
        let table = results.table(path)?;
        let components = (0..table.width())
            .map(|k| Component {
                name: component_name(column, k, table.width(), body),
                values: table.column(k).into_iter().flatten().collect(),
            })
            .collect::<Vec<_>>();
        let name = format!("{}{frame}", name.replace('_', " "));
        (!components.is_empty()).then(|| History { group, name, unit: unit.clone(), least_range, components })
    };
    let path = column.path;
    if path == "time" {
        return Vec::new();
    }
    let places = match column.values {
        Values::Points(_) | Values::PointNumbers(..) => Some(("point", "points/")),
        Values::Supports(_) => Some(("support", "supports/")),
        _ => None,
    };
    match places.and_then(|(kind, prefix)| Some((kind, prefix, path.strip_prefix(prefix)?))) {
        Some((kind, prefix, name)) => (column.places(&results.metadata).iter())
            .filter_map(|place| history(format!("{kind} {place}"), name, &format!("{prefix}{place}/{name}")))
            .collect(),
        None => {
            let (group, name) = path.split_once('/').unwrap_or(("body", path));
            let group = if group == "modal" { "modal coordinates" } else { group };
            history(group.to_owned(), name, path).into_iter().collect()
        }
    }
}

fn component_name(column: &Column<Row>, k: usize, width: usize, body: &BodyReport) -> String {
    match column.values {
        Values::Modal(_) => {
            let modes = width - body.static_shapes().min(width);
            if k < modes { format!("{}", k + 1) } else { format!("static {}", k + 1) }
        }
        Values::Quaternion(_) => ["w", "x", "y", "z"][k].to_owned(),
        Values::Vector(_) | Values::Points(_) | Values::Supports(_) => ["x", "y", "z"][k].to_owned(),
        Values::PointNumbers(6, _) => ["xx", "yy", "zz", "xy", "yz", "zx"][k].to_owned(),
        Values::PointNumbers(count, _) if count > 1 => format!("{}", k + 1),
        Values::Number(_) | Values::PointNumbers(..) => String::new(),
    }
}

/// The three balances, each with its terms and with its change since the first row.
fn balances(results: &Results, quantities: &Quantities<'_>) -> Option<Vec<Balance>> {
    let balance = |name: &str, law: &str, terms: &[(&str, &str)], error: &str| {
        let column = COLUMNS.iter().find(|column| column.path == error)?;
        let components = |path: &str, name: &str, from_first: bool| -> Option<Vec<Component>> {
            let table = results.table(path)?;
            let component = |k: usize| {
                let values: Vec<f64> = table.column(k)?.collect();
                let first = if from_first { values.first().copied().unwrap_or_default() } else { 0.0 };
                let axis = if table.width() == 1 { "" } else { ["x", "y", "z"][k] };
                let name = [name, axis].into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ");
                Some(Component { name, values: values.iter().map(|value| value - first).collect() })
            };
            (0..table.width()).map(component).collect()
        };
        let terms: Vec<Vec<Component>> =
            terms.iter().map(|(path, name)| components(path, name, false)).collect::<Option<_>>()?;
        Some(Balance {
            name: name.to_owned(),
            law: law.to_owned(),
            unit: quantities.unit(column),
            least_range: quantities.least_range(column),
            terms: terms.into_iter().flatten().collect(),
            errors: components(error, "", true)?,
        })
    };
    let energies = [
        ("energy/kinetic", "kinetic"),
        ("energy/strain", "strain"),
        ("energy/work", "work"),
        ("energy/dissipation", "dissipation"),
    ];
    Some(vec![
        balance(
            "Energy",
            "kinetic + strain energy − work of the loads + dissipation is constant",
            &energies,
            "energy/balance",
        )?,
        balance(
            "Linear momentum",
            "momentum less the impulse of the loads is constant (global axes)",
            &[("momentum/linear", "")],
            "momentum/linear_balance",
        )?,
        balance(
            "Angular momentum",
            "angular momentum less the angular impulse of the loads, about the centre of mass, is constant (global axes)",
            &[("momentum/angular", "")],
            "momentum/angular_balance",
        )?,
    ])
}

/// The paper's formulation has its own effects.
fn effects(scene: &Scene, model: &Model) -> Vec<Effect> {
    if !scene.time.method.abilities.switches_effects {
        return Vec::new();
    }
    let effect = |(subject, row): (advice::Subject, &advice::Row)| Effect {
        name: subject.name().replace('_', " "),
        state: match is_on(scene, model, subject) {
            Some(true) => "on",
            Some(false) => "off",
            None => "–",
        }
        .to_owned(),
        measure: format!("{} = {}", subject.formula(), quantity(row.value)),
        reason: row.why.clone(),
    };
    model.advice.rows().map(effect).collect()
}

/// Why the model is known to be wrong, and those of the run.
fn warnings(results: &Results, model: &Model) -> Vec<String> {
    let refusal = model.refusal.as_ref().map(ToString::to_string);
    let of_run = results.metadata.warnings.iter().filter(|warning| Some(*warning) != refusal.as_ref()).cloned();
    refusal.iter().cloned().chain(of_run).collect()
}
