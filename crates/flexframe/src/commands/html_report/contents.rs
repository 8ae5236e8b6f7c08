//! Contents of the page of a run.

use std::path::Path;

use fem_tet10::von_mises;
use nalgebra::Vector3;
use report::{
    Balance, Component, Effect, Fact, History, Motion, Report, RunState, SceneText, Shape, ShapeKind, StressField,
    Surface, Units,
};
use results::{BodyProperties, Column, EffectProperties, MeshProperties, Results, Shapes, StressShapes, Values};

use crate::commands::html_report::quantities::Quantities;
use crate::commands::modes::frequency_unit;
use crate::files::scene_file;
use crate::report::quantity;
use crate::rows::columns::COLUMNS;
use crate::rows::row::Row;
use crate::rows::units::UnitLabels;
use crate::surface;

/// All of it; `None` where the file has not got the columns that it needs.
pub(super) fn contents(file: &Path, results: &Results, shapes: Option<Shapes>) -> Option<Report> {
    let run = &results.metadata;
    let (body, units) = (&run.body, &run.units);
    let surface = shapes.map(surface::Surface::new);
    let quantities = Quantities::new(results);
    let scene_file = scene_file::to_path(&run.scene_file);
    Some(Report {
        title: run.title.clone(),
        program: format!("flexframe {}", run.program_version),
        state: state(file, results)?,
        units: Units { length: units.length.clone(), time: units.time.clone(), frequency: frequency_unit(&units.time) },
        facts: facts(results)?,
        surface: surface.as_ref().map(|surface| reference(surface, body)),
        shapes: surface.as_ref().map_or_else(Vec::new, |surface| described(&surface.shapes, body)),
        stress: surface.as_ref().and_then(|surface| stress(&surface.shapes, results)),
        motion: motion(results, surface.as_ref().map(|surface| &surface.shapes))?,
        histories: in_order().flat_map(|column| histories(column, results, &quantities)).collect(),
        balances: balances(results, &quantities)?,
        effects: effects(results),
        scene: SceneText {
            file: scene_file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            text: run.scene_text.clone(),
        },
        warnings: warnings(results),
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

fn state(file: &Path, results: &Results) -> Option<RunState> {
    if results.complete {
        return Some(RunState::Complete);
    }
    let reached = results.numbers("time")?.last().copied().unwrap_or_default();
    let time = &results.metadata.units.time;
    let (reached, end) = (quantity(reached), quantity(results.metadata.end));
    let words = format!(
        "This run has not come to its end: its rows reach {reached} {time} of {end} {time}. Continue it with: flexframe \
         resume {}",
        file.display()
    );
    Some(RunState::Unfinished(words))
}

fn facts(results: &Results) -> Option<Vec<Fact>> {
    let units = &results.metadata.units;
    let body = &results.metadata.body;
    let fact = |label: &str, value: String| Fact { label: label.to_owned(), value };
    let mut facts = vec![fact("Mass", format!("{} {}", quantity(body.mass), units.mass))];
    match &body.mesh {
        Some(MeshProperties { nodes, elements: 0, .. }) => {
            facts.push(fact("Mesh", format!("{nodes} nodes, matrices of another program")));
        }
        Some(MeshProperties { nodes, elements, .. }) => {
            facts.push(fact("Mesh", format!("{nodes} nodes, {elements} elements")));
        }
        None => {}
    }
    facts.push(match (natural_modes(body), body.static_shapes) {
        (0, 0) => fact("Shapes", "rigid body".to_owned()),
        (modes, 0) => fact("Shapes", format!("{modes} modes")),
        (modes, fixed) => fact("Shapes", format!("{modes} modes, {fixed} static")),
    });
    let last = results.numbers("time")?.last().copied().unwrap_or_default();
    facts.push(fact("Time", format!("{} {} in {} rows", quantity(last), units.time, results.rows())));
    facts.push(fact("Scheme", format!("{} ({})", results.metadata.scheme, results.metadata.formulation)));
    Some(facts)
}

/// Number of natural modes, which come before the static shapes.
fn natural_modes(body: &BodyProperties) -> usize {
    body.frequencies.len().saturating_sub(body.static_shapes)
}

fn reference(surface: &surface::Surface, body: &BodyProperties) -> Surface {
    let from_origin = |x: &[f64; 3]| (Vector3::from(*x) - Vector3::from(body.origin)).map(|x| x as f32).into();
    Surface {
        vertices: surface.shapes.positions.iter().map(from_origin).collect(),
        triangles: surface.triangles.clone(),
        edges: surface.edges.clone(),
    }
}

/// The shapes with their names.
fn described(shapes: &Shapes, body: &BodyProperties) -> Vec<Shape> {
    let (modes, flexible) = (natural_modes(body), body.frequencies.len());
    let shape = |(k, displacement): (usize, &Vec<[f64; 3]>)| {
        let (name, kind) = if k < modes {
            let (frequency, damping_ratio) = (body.frequencies[k], body.damping_ratios[k]);
            (format!("mode {}", k + 1), ShapeKind::Natural { frequency, damping_ratio })
        } else if k < flexible {
            (format!("static shape {}", k + 1), ShapeKind::Static)
        } else {
            (format!("shape {} of second order", k + 1 - flexible), ShapeKind::SecondOrder)
        };
        Shape { name, kind, displacement: displacement.iter().map(|u| u.map(|x| x as f32)).collect() }
    };
    shapes.displacements.iter().enumerate().map(shape).collect()
}

/// The stress of each shape, and of each product of two large modes; at a node between materials, of the one whose von Mises
/// stress is largest in all rows.
fn stress(shapes: &Shapes, results: &Results) -> Option<StressField> {
    let stress = shapes.stress.as_ref().filter(|_| !shapes.displacements.is_empty())?;
    let modal = results.table("modal/displacement")?;
    let rows: Vec<_> = (0..results.rows()).filter_map(|row| Some(shapes.stress_coordinates(modal.row(row)?))).collect();
    let sites = most_stressed(stress, &rows);
    let results::Units { length, mass, time } = &results.metadata.units;
    Some(StressField {
        unit: UnitLabels { length, mass, time }.stress(),
        shapes: stress.shapes.iter().map(|shape| sites.iter().map(|i| shape[*i].map(|s| s as f32)).collect()).collect(),
        products: shapes.pairs.iter().map(|pair| pair.map(|k| k as usize)).collect(),
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

fn motion(results: &Results, shapes: Option<&Shapes>) -> Option<Motion> {
    let modal = results.table("modal/displacement")?;
    let of_row = |q: &[f64]| shapes.map_or_else(|| q.to_vec(), |shapes| shapes.coordinates(q));
    let coordinates: Option<Vec<_>> = (0..results.rows()).map(|row| Some(of_row(modal.row(row)?))).collect();
    Some(Motion {
        times: results.numbers("time")?.to_vec(),
        origins: results.vectors::<3>("origin")?.to_vec(),
        attitudes: results.vectors::<4>("attitude")?.to_vec(),
        coordinates: coordinates?.concat(),
    })
}

/// A column as histories: one, or one for each point. The time is none.
fn histories(column: &Column<Row>, results: &Results, quantities: &Quantities<'_>) -> Vec<History> {
    let (unit, least_range) = (quantities.unit(column), quantities.least_range(column));
    let frame = if column.frame == "none" { String::new() } else { format!(" ({})", column.frame) };
    let history = |group: String, name: &str, path: &str| {
        let table = results.table(path)?;
        let components = (0..table.width())
            .map(|k| Component {
                name: component_name(column, k, table.width(), &results.metadata.body),
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

fn component_name(column: &Column<Row>, k: usize, width: usize, body: &BodyProperties) -> String {
    match column.values {
        Values::Modal(_) => {
            let modes = width - body.static_shapes.min(width);
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

fn effects(results: &Results) -> Vec<Effect> {
    let effect = |effect: &EffectProperties| {
        let EffectProperties { name, state, measure, reason } = effect.clone();
        Effect { name, state, measure, reason }
    };
    results.metadata.effects.iter().map(effect).collect()
}

/// Known errors of the model, and warnings of the run.
fn warnings(results: &Results) -> Vec<String> {
    let refusal = &results.metadata.refusal;
    let of_run = results.metadata.warnings.iter().filter(|warning| Some(*warning) != refusal.as_ref()).cloned();
    refusal.iter().cloned().chain(of_run).collect()
}
