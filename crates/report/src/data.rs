//! The report as the page reads it. `web/src/data.ts` has the same fields.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::numbers::Numbers;
use crate::packed::packed;
use crate::peak::{length, peak, von_mises};
use crate::run_page::{
    Compared, Component, Control, Fact, Live, PageBody, PageMotion, PageStress, PageSurface, RunPage, RunState, Shape,
    ShapeKind, Trust,
};
use crate::thin::{Thinning, spread};

/// The crate `live` for a browser, which `./dev live-page` builds.
const PROGRAM: &[u8] = include_bytes!("../web/live.wasm.gz");

/// Bytes of the rows of the motion, before base64.
const MOTION_BYTES: usize = 1 << 20;
/// Bytes of the histories and balances together, before base64.
const HISTORY_BYTES: usize = 5 << 17;
/// Points of a history: few enough for the budget of bytes, but never fewer than the first, nor more than the second.
const HISTORY_POINTS: (usize, usize) = (500, 4000);

#[derive(Debug, Serialize)]
pub(crate) struct Data<'a> {
    title: &'a str,
    program: &'a str,
    /// Reason of an incomplete run.
    unfinished: Option<&'a str>,
    units: PageUnits<'a>,
    facts: Vec<[&'a str; 2]>,
    /// Rows of the run, before any was left out.
    rows: usize,
    /// Times of the rows of all motions.
    times: Numbers,
    bodies: Vec<BodyData<'a>>,
    history_times: Numbers,
    histories: Vec<HistoryData<'a>>,
    balances: Vec<BalanceData<'a>>,
    scene: [&'a str; 2],
    warnings: &'a [String],
    trust: &'a Trust,
    live: Option<LiveData<'a>>,
    compared: Option<ComparedData<'a>>,
}

#[derive(Debug, Serialize)]
struct ComparedData<'a> {
    name: &'a str,
    times: Numbers,
    bodies: Vec<BodyData<'a>>,
}

#[derive(Debug, Serialize)]
struct LiveData<'a> {
    /// The program of the page and the data of the run, packed by gzip, in base64.
    program: String,
    run: String,
    masses: Vec<f64>,
    controls: Vec<ControlData<'a>>,
    units: &'a [String; 4],
}

#[derive(Debug, Serialize)]
struct ControlData<'a> {
    group: &'a str,
    name: &'a str,
    unit: &'a str,
    change: [usize; 3],
    range: [f64; 2],
    recorded: f64,
}

#[derive(Debug, Serialize)]
struct BodyData<'a> {
    name: &'a str,
    facts: Vec<[&'a str; 2]>,
    surface: Option<SurfaceData>,
    shapes: Vec<ShapeData<'a>>,
    /// Greatest length of a displacement over all rows, in the unit of length.
    displacement_peak: f64,
    stress: Option<StressData<'a>>,
    motion: MotionData,
    effects: Vec<[&'a str; 4]>,
}

#[derive(Debug, Serialize)]
struct PageUnits<'a> {
    length: &'a str,
    time: &'a str,
    frequency: &'a str,
}

#[derive(Debug, Serialize)]
struct SurfaceData {
    vertices: Numbers,
    triangles: Numbers,
    edges: Numbers,
}

#[derive(Debug, Serialize)]
struct ShapeData<'a> {
    name: &'a str,
    kind: &'static str,
    frequency: Option<f64>,
    damping_ratio: Option<f64>,
    displacement: Numbers,
}

#[derive(Debug, Serialize)]
struct StressData<'a> {
    unit: &'a str,
    /// Greatest von Mises stress over all rows.
    peak: f64,
    /// Stresses of the shapes, then of the products.
    shapes: Vec<Numbers>,
    products: &'a [Vec<usize>],
}

#[derive(Debug, Serialize)]
struct MotionData {
    origins: Numbers,
    attitudes: Numbers,
    coordinates: Numbers,
}

#[derive(Debug, Serialize)]
struct HistoryData<'a> {
    group: &'a str,
    name: &'a str,
    unit: &'a str,
    least_range: f64,
    components: Vec<ComponentData<'a>>,
}

#[derive(Debug, Serialize)]
struct ComponentData<'a> {
    name: &'a str,
    values: Numbers,
}

#[derive(Debug, Serialize)]
struct BalanceData<'a> {
    group: &'a str,
    name: &'a str,
    law: &'a str,
    unit: &'a str,
    least_range: f64,
    /// Greatest magnitude of an error, and of a term, over all rows.
    error_peak: f64,
    term_peak: f64,
    terms: Vec<ComponentData<'a>>,
    errors: Vec<ComponentData<'a>>,
}

impl<'a> Data<'a> {
    /// Data of a report that has been checked.
    pub(crate) fn new(report: &'a RunPage) -> Self {
        let times = &report.times;
        let rows = times.len();
        let thinning = Thinning::new(rows, history_points(report));
        let kept = motion_rows(times, &report.bodies);
        Self {
            title: &report.title,
            program: &report.program,
            unfinished: match &report.state {
                RunState::Complete => None,
                RunState::Unfinished(words) => Some(words),
            },
            units: PageUnits {
                length: &report.units.length,
                time: &report.units.time,
                frequency: &report.units.frequency,
            },
            facts: facts(&report.facts),
            rows,
            times: Numbers::double(kept.iter().map(|row| times[*row])),
            bodies: report.bodies.iter().map(|body| BodyData::new(body, &kept)).collect(),
            history_times: match &thinning {
                Some(thinning) => Numbers::double(thinning.times(times).into_iter()),
                None => Numbers::double(times.iter().copied()),
            },
            histories: report
                .histories
                .iter()
                .map(|history| HistoryData {
                    group: &history.group,
                    name: &history.name,
                    unit: &history.unit,
                    least_range: history.least_range,
                    components: components(&history.components, thinning.as_ref()),
                })
                .collect(),
            balances: report
                .balances
                .iter()
                .map(|balance| BalanceData {
                    group: &balance.group,
                    name: &balance.name,
                    law: &balance.law,
                    unit: &balance.unit,
                    least_range: balance.least_range,
                    error_peak: greatest(&balance.errors),
                    term_peak: greatest(&balance.terms),
                    terms: components(&balance.terms, thinning.as_ref()),
                    errors: components(&balance.errors, thinning.as_ref()),
                })
                .collect(),
            scene: [&report.scene.file, &report.scene.text],
            warnings: &report.warnings,
            trust: &report.trust,
            live: report.live.as_ref().map(LiveData::new),
            compared: report.compared.as_ref().map(ComparedData::new),
        }
    }
}

impl<'a> ComparedData<'a> {
    fn new(Compared { name, times, bodies }: &'a Compared) -> Self {
        let kept = motion_rows(times, bodies);
        Self {
            name,
            times: Numbers::double(kept.iter().map(|row| times[*row])),
            bodies: bodies.iter().map(|body| BodyData::new(body, &kept)).collect(),
        }
    }
}

impl<'a> LiveData<'a> {
    fn new(live: &'a Live) -> Self {
        let control = |control: &'a Control| {
            let Control { group, name, unit, change, range, recorded } = control;
            ControlData { group, name, unit, change: *change, range: *range, recorded: *recorded }
        };
        Self {
            program: STANDARD.encode(PROGRAM),
            run: STANDARD.encode(packed(&live.run)),
            masses: live.bodies.iter().map(|body| body.mass).collect(),
            controls: live.controls.iter().map(control).collect(),
            units: &live.units,
        }
    }
}

fn facts(facts: &[Fact]) -> Vec<[&str; 2]> {
    facts.iter().map(|fact| [&*fact.label, &*fact.value]).collect()
}

/// The rows of the motion that the page has, evenly spread.
fn motion_rows(times: &[f64], bodies: &[PageBody]) -> Vec<usize> {
    let of_body = |body: &PageBody| (3 + 4 + body.shapes.len()) * size_of::<f32>();
    let bytes = size_of::<f64>() + bodies.iter().map(of_body).sum::<usize>();
    spread(times.len(), MOTION_BYTES / bytes)
}

/// How many points a history may have.
fn history_points(report: &RunPage) -> usize {
    let of_histories: usize = report.histories.iter().map(|history| history.components.len()).sum();
    let of_balances: usize = report.balances.iter().map(|balance| balance.terms.len() + balance.errors.len()).sum();
    let (least, most) = HISTORY_POINTS;
    (HISTORY_BYTES / size_of::<f32>() / (of_histories + of_balances).max(1)).clamp(least, most)
}

fn components<'a>(components: &'a [Component], thinning: Option<&Thinning>) -> Vec<ComponentData<'a>> {
    let values = |component: &Component| match thinning {
        Some(thinning) => Numbers::single(thinning.values(&component.values).into_iter(), 1),
        None => Numbers::single(component.values.iter().copied(), 1),
    };
    components.iter().map(|component| ComponentData { name: &component.name, values: values(component) }).collect()
}

fn greatest(components: &[Component]) -> f64 {
    components.iter().flat_map(|component| &component.values).fold(0.0, |greatest, value| value.abs().max(greatest))
}

impl<'a> BodyData<'a> {
    fn new(body: &'a PageBody, kept: &[usize]) -> Self {
        let displacements: Vec<&[[f32; 3]]> = body.shapes.iter().map(|shape| &*shape.displacement).collect();
        let effects = body.effects.iter();
        Self {
            name: &body.name,
            facts: facts(&body.facts),
            surface: body.surface.as_ref().map(SurfaceData::new),
            shapes: body.shapes.iter().map(ShapeData::new).collect(),
            displacement_peak: peak(&displacements, &body.motion.coordinates, length),
            stress: body.stress.as_ref().map(|stress| StressData::new(stress, &body.motion)),
            motion: MotionData::new(&body.motion, body.shapes.len(), kept),
            effects: effects.map(|effect| [&*effect.name, &*effect.state, &*effect.measure, &*effect.reason]).collect(),
        }
    }
}

impl SurfaceData {
    fn new(surface: &PageSurface) -> Self {
        let count = surface.vertices.len();
        Self {
            vertices: Numbers::single(surface.vertices.as_flattened().iter().map(|x| f64::from(*x)), 3),
            triangles: Numbers::indices(surface.triangles.as_flattened(), count),
            edges: Numbers::indices(surface.edges.as_flattened(), count),
        }
    }
}

impl<'a> ShapeData<'a> {
    fn new(shape: &'a Shape) -> Self {
        let (kind, frequency, damping_ratio) = match shape.kind {
            ShapeKind::Natural { frequency, damping_ratio } => ("natural", Some(frequency), Some(damping_ratio)),
            ShapeKind::Static => ("static", None, None),
            ShapeKind::SecondOrder => ("second order", None, None),
        };
        let displacement = Numbers::quantised(&shape.displacement);
        Self { name: &shape.name, kind, frequency, damping_ratio, displacement }
    }
}

impl<'a> StressData<'a> {
    fn new(stress: &'a PageStress, motion: &PageMotion) -> Self {
        let shapes: Vec<&[[f32; 6]]> = stress.shapes.iter().map(Vec::as_slice).collect();
        let rows = motion.coordinates.chunks_exact((shapes.len() - stress.products.len()).max(1));
        let products = |q: &[f64]| {
            stress.products.iter().map(|factors| factors.iter().map(|k| q[*k]).product()).collect::<Vec<f64>>()
        };
        let coordinates: Vec<f64> = rows.flat_map(|q| q.iter().copied().chain(products(q))).collect();
        Self {
            unit: &stress.unit,
            products: &stress.products,
            peak: peak(&shapes, &coordinates, von_mises),
            shapes: shapes.iter().map(|shape| Numbers::coarse(shape)).collect(),
        }
    }
}

impl MotionData {
    fn new(motion: &PageMotion, shapes: usize, kept: &[usize]) -> Self {
        Self {
            origins: Numbers::single(kept.iter().flat_map(|row| motion.origins[*row]), 3),
            attitudes: Numbers::single(kept.iter().flat_map(|row| motion.attitudes[*row]), 4),
            coordinates: Numbers::single(
                kept.iter().flat_map(|row| &motion.coordinates[row * shapes..(row + 1) * shapes]).copied(),
                shapes,
            ),
        }
    }
}
