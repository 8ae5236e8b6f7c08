//! Pages of made-up runs, for the test of the page in a browser.
//!
//!     cargo run -p report --example synthetic -- KIND FILE
//!
//! `small` is a struck plate, `large` one of 60 000 vertices and 40 modes, `unfinished` a run that was stopped, `rigid` a
//! body without a surface, `hinged` a plate that turns about one end, `nodes` one of which only the nodes are known, `patch`
//! a square whose displacement and stress are the same everywhere, `several` three bodies, `compared` a plate of few rows
//! with another one that flies beside it, and `responses` answers over the frequency.

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::path::Path;

use report::{
    Chart, Compared, Component, Curve, Curves, Effect, Fact, PageBalance, PageBody, PageHistory, PageMotion,
    PageStress, PageSurface, PageTrustLine, PageUnits, PageWords, RunPage, RunState, SceneText, Shape, ShapeKind,
    Trust,
};

const LENGTH: f64 = 1000.0;
const WIDTH: f64 = 50.0;
const THICKNESS: f64 = 10.0;
const YOUNG_MODULUS: f64 = 70_000.0;
const DURATION: f64 = 0.5;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [kind, path] = arguments.as_slice() else { return Err("expected: KIND FILE".into()) };
    if kind == "responses" {
        let (facts, warnings) = (vec![Fact::new("About", "rest")], vec!["a warning".to_owned()]);
        let words = PageWords { title: "Two oscillators", program: "flexframe", facts, warnings: &warnings };
        return Ok(responses().write(words, Path::new(path))?);
    }
    let mut report = match kind.as_str() {
        "small" | "unfinished" | "hinged" | "nodes" => plate(120, 8, 6, 5001, "Free plate, 50 N end pulse"),
        "large" => plate(1000, 26, 40, 5001, "Plate of 60 000 vertices and 40 modes"),
        "rigid" => plate(4, 2, 0, 500, "Rigid body without a mesh"),
        "patch" => patch(),
        "several" => several(),
        "compared" => compared(),
        _ => {
            let expected = "small, large, unfinished, rigid, hinged, nodes, patch, several, compared or responses";
            return Err(format!("{kind}: expected {expected}").into());
        }
    };
    if kind == "unfinished" {
        let words = "This run stopped at 0.5 s of 0.8 s. Continue it with `flexframe resume plate.part.h5`.";
        report.state = RunState::Unfinished(words.to_owned());
        let warning = "mode 6: 9 steps per period; choose a step below 1e-5 s </script><b>or a tolerance</b>";
        report.warnings = vec![warning.to_owned()];
    }
    match kind.as_str() {
        "rigid" => report.bodies[0].surface = None,
        "large" => report.bodies[0].stress = None, // as in most runs
        "hinged" => hinge(&mut report),
        "nodes" => {
            report.bodies[0].stress = None;
            if let Some(surface) = &mut report.bodies[0].surface {
                surface.triangles.clear();
                surface.edges.clear();
            }
        }
        _ => {}
    }
    report::write(&report, Path::new(path))?;
    Ok(())
}

/// Points of a box: top and bottom of the plate, each a grid, with a rim between them.
fn surface(along: usize, across: usize) -> PageSurface {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    let mut edges = Vec::new();
    let mut sheet = |n: usize, m: usize, place: &dyn Fn(f64, f64) -> [f64; 3]| {
        let first = vertices.len() as u32;
        let at = |i: usize, j: usize| first + (i * (m + 1) + j) as u32;
        for i in 0..=n {
            for j in 0..=m {
                vertices.push(place(i as f64 / n as f64, j as f64 / m as f64).map(|x| x as f32));
            }
        }
        for i in 0..n {
            for j in 0..m {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        edges.extend((0..n).flat_map(|i| [[at(i, 0), at(i + 1, 0)], [at(i, m), at(i + 1, m)]]));
        edges.extend((0..m).flat_map(|j| [[at(0, j), at(0, j + 1)], [at(n, j), at(n, j + 1)]]));
    };
    let (l, w, t) = (LENGTH, WIDTH, THICKNESS);
    sheet(along, across, &|a, b| [l * (a - 0.5), w * (b - 0.5), t / 2.0]);
    sheet(along, across, &|a, b| [l * (0.5 - a), w * (b - 0.5), -t / 2.0]);
    sheet(along, 2, &|a, b| [l * (a - 0.5), -w / 2.0, t * (b - 0.5)]);
    sheet(along, 2, &|a, b| [l * (0.5 - a), w / 2.0, t * (b - 0.5)]);
    sheet(across, 2, &|a, b| [l / 2.0, w * (a - 0.5), t * (b - 0.5)]);
    sheet(across, 2, &|a, b| [-l / 2.0, w * (0.5 - a), t * (b - 0.5)]);
    PageSurface { vertices, triangles, edges }
}

/// Lays the origin into the end of the plate and leaves it there, so that the middle of the plate goes around it.
fn hinge(report: &mut RunPage) {
    let body = &mut report.bodies[0];
    for [x, ..] in body.surface.iter_mut().flat_map(|surface| &mut surface.vertices) {
        *x += LENGTH as f32 / 2.0;
    }
    body.motion.origins.fill([0.0; 3]);
}

/// A square with two shapes: one moves it by (3, 4, 0) under tension in x, one by (0, 0, 2) under shear.
fn patch() -> RunPage {
    let mut report = plate(2, 2, 0, 3, "Patch");
    let body = &mut report.bodies[0];
    body.surface = Some(PageSurface {
        vertices: vec![[-500.0, -500.0, 0.0], [500.0, -500.0, 0.0], [500.0, 500.0, 0.0], [-500.0, 500.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        edges: vec![[0, 1], [1, 2], [2, 3], [3, 0]],
    });
    let kind = ShapeKind::Natural { frequency: 1.0, damping_ratio: 0.0 };
    let shape = |name: &str, u: [f32; 3]| Shape { name: name.into(), kind, displacement: vec![u; 4] };
    body.shapes = vec![shape("tension", [3.0, 4.0, 0.0]), shape("shear", [0.0, 0.0, 2.0])];
    body.stress = Some(PageStress {
        unit: "MPa".into(),
        shapes: vec![
            vec![[100.0, 0.0, 0.0, 0.0, 0.0, 0.0]; 4],
            vec![[0.0, 0.0, 0.0, 30.0, 0.0, 0.0]; 4],
            vec![[0.0, 0.0, 0.0, 0.0, 25.0, 0.0]; 4],
        ],
        products: vec![vec![0, 1]],
    });
    body.motion.origins = vec![[0.0; 3]; 3];
    body.motion.attitudes = vec![[1.0, 0.0, 0.0, 0.0]; 3];
    body.motion.coordinates = vec![2.0, 0.0, 0.0, 1.5, -1.0, 2.0];
    report
}

/// A struck plate, a smaller one without stress beside it, and a rigid body without a mesh.
fn several() -> RunPage {
    let mut report = plate(60, 4, 4, 1001, "Three bodies");
    let [mut other, mut rigid] = [plate(20, 4, 2, 1001, ""), plate(4, 2, 0, 1001, "")];
    for (i, (of, name)) in
        [(&mut report, "plate"), (&mut other, "left arm"), (&mut rigid, "hub")].into_iter().enumerate()
    {
        let body = &mut of.bodies[0];
        body.name = name.to_owned();
        body.motion.origins.iter_mut().for_each(|[_, y, _]| *y += 600.0 * i as f64);
        of.histories.iter_mut().for_each(|history| {
            history.group = match history.group.strip_prefix("point ") {
                Some(point) => format!("point {name}.{point}"),
                None => format!("{name}: {}", history.group),
            };
        });
        of.balances.iter_mut().for_each(|balance| balance.group = name.to_owned());
    }
    (other.bodies[0].stress, rigid.bodies[0].surface) = (None, None);
    for of in [other, rigid] {
        report.bodies.extend(of.bodies);
        report.histories.extend(of.histories);
        report.balances.extend(of.balances);
    }
    report
}

/// A struck plate whose every row is in the page, and another run of it, 200 mm beside it and half as far bent.
fn compared() -> RunPage {
    let mut report = plate(120, 8, 6, 501, "Two runs of a plate");
    let RunPage { times, mut bodies, .. } = plate(60, 4, 2, 301, "");
    let PageMotion { origins, coordinates, .. } = &mut bodies[0].motion;
    origins.iter_mut().for_each(|[_, y, _]| *y += 200.0);
    coordinates.iter_mut().for_each(|q| *q *= 0.5);
    let half = |name: String, of: &Component| Component { name, values: of.values.iter().map(|x| 0.5 * x).collect() };
    report.histories = std::mem::take(&mut report.histories)
        .into_iter()
        .flat_map(|history| {
            let difference = history.components.iter().map(|of| half(of.name.clone(), of)).collect();
            let difference = PageHistory {
                name: format!("{}: difference", history.name),
                components: difference,
                ..history.clone()
            };
            let theirs: Vec<_> = history.components.iter().map(|of| half(format!("{} (slow)", of.name), of)).collect();
            let mut both = history;
            both.components.extend(theirs);
            [both, difference]
        })
        .collect();
    report.compared = Some(Compared { name: "slow".to_owned(), times, bodies });
    report
}

/// Bending like that of a bar between supports: w = cos(k π (x/L + 1/2)), with its rotation and stress.
fn shape(number: usize, kind: ShapeKind, name: String, surface: &PageSurface) -> (Shape, Vec<[f32; 6]>) {
    let wave = number as f64 * PI / LENGTH;
    let displacement = |[x, _, z]: [f64; 3]| {
        let angle = wave * (x + LENGTH / 2.0);
        [wave * angle.sin() * z, 0.0, angle.cos()].map(|u| u as f32)
    };
    let stress = |[x, _, z]: [f64; 3]| {
        let strain = wave * wave * (wave * (x + LENGTH / 2.0)).cos() * z;
        [YOUNG_MODULUS * strain, 0.0, 0.0, 0.0, 0.0, 0.0].map(|s| s as f32)
    };
    let at = |v: &[f32; 3]| v.map(f64::from);
    let displacements = surface.vertices.iter().map(|v| displacement(at(v))).collect();
    let stresses = surface.vertices.iter().map(|v| stress(at(v))).collect();
    (Shape { name, kind, displacement: displacements }, stresses)
}

fn plate(along: usize, across: usize, modes: usize, rows: usize, title: &str) -> RunPage {
    let surface = surface(along, across);
    let frequency = |k: usize| 12.0 * ((k + 2) as f64 / 2.0).powi(2);
    let (shapes, stresses): (Vec<_>, Vec<_>) = (0..modes)
        .map(|k| {
            let is_static = k > 1 && k + 1 == modes;
            let kind = match is_static {
                true => ShapeKind::Static,
                false => ShapeKind::Natural { frequency: frequency(k), damping_ratio: 0.05 },
            };
            let name = if is_static { "static shape of load 1".to_owned() } else { format!("mode {}", k + 1) };
            shape(k + 2, kind, name, &surface)
        })
        .unzip();
    let times: Vec<f64> = (0..rows).map(|row| DURATION * row as f64 / (rows - 1) as f64).collect();
    let coordinate = |k: usize, t: f64| {
        let omega = TAU * frequency(k);
        20.0 / (1.0 + k as f64).powi(3) * (-0.05 * omega * t).exp() * (omega * t).sin()
    };
    let angle = |t: f64| 7.0 * t;
    let motion = PageMotion {
        origins: times.iter().map(|t| [400.0 * t, -90.0 * t, 700.0 * t - 500.0 * t * t]).collect(),
        attitudes: times.iter().map(|t| [(angle(*t) / 2.0).cos(), 0.0, (angle(*t) / 2.0).sin(), 0.0]).collect(),
        coordinates: times.iter().flat_map(|t| (0..modes).map(move |k| coordinate(k, *t))).collect(),
    };
    let course = |name: &str, value: &dyn Fn(f64) -> f64| Component {
        name: name.to_owned(),
        values: times.iter().map(|t| value(*t)).collect(),
    };
    let vector = |group: &str, name: &str, unit: &str, value: &dyn Fn(f64) -> [f64; 3]| PageHistory {
        group: group.to_owned(),
        name: name.to_owned(),
        unit: unit.to_owned(),
        least_range: 1e-12,
        components: ["x", "y", "z"].iter().enumerate().map(|(i, axis)| course(axis, &|t| value(t)[i])).collect(),
    };
    let bending = |t: f64| (0..modes).map(|k| coordinate(k, t)).sum::<f64>();
    let rate = |t: f64| (bending(t + 1e-6) - bending(t - 1e-6)) / 2e-6;
    let mut histories = vec![
        vector("body", "position of the centre of mass (global)", "mm", &|t| {
            [400.0 * t, -90.0 * t, 700.0 * t - 500.0 * t * t]
        }),
        vector("body", "angular velocity (body)", "rad/s", &|_| [0.0, 7.0, 0.0]),
    ];
    for point in 1..=8 {
        let group = format!("point P{point}");
        let sign = if point % 2 == 0 { 1.0 } else { -1.0 };
        histories.push(vector(&group, "elastic displacement (body)", "mm", &|t| [0.0, 0.0, sign * bending(t)]));
        histories.push(vector(&group, "displacement (global)", "mm", &|t| {
            [400.0 * t + bending(t) * angle(t).sin(), -90.0 * t, 700.0 * t - 500.0 * t * t + bending(t)]
        }));
        histories.push(vector(&group, "velocity (global)", "mm/s", &|t| [400.0, -90.0, 700.0 - 1000.0 * t + rate(t)]));
        histories.push(vector(&group, "acceleration (global)", "mm/s²", &|t| {
            [0.0, 0.0, (rate(t + 1e-5) - rate(t - 1e-5)) / 2e-5 - 1000.0]
        }));
    }
    let strain = |t: f64| 0.1 * bending(t).powi(2);
    let balances = vec![
        PageBalance {
            group: String::new(),
            name: "Energy".into(),
            law: "kinetic + strain energy − work of the loads + dissipation is constant".into(),
            unit: "mJ".into(),
            least_range: 6e-11,
            terms: vec![course("kinetic", &|t| 60.0 - strain(t)), course("strain", &strain), course("work", &|_| 60.0)],
            errors: vec![course("", &|t| 2e-9 * (400.0 * t).sin())],
        },
        PageBalance {
            group: String::new(),
            name: "Linear momentum".into(),
            law: "momentum − impulse of the loads is constant".into(),
            unit: "N s".into(),
            least_range: 4e-12,
            terms: ["x", "y", "z"].iter().map(|axis| course(axis, &|t| 4.0 * (t * 3.0).sin())).collect(),
            errors: ["x", "y", "z"].iter().map(|axis| course(axis, &|t| 1e-14 * (900.0 * t).cos())).collect(),
        },
    ];
    let effect = |name: &str, state: &str, measure: &str, reason: &str| Effect {
        name: name.into(),
        state: state.into(),
        measure: measure.into(),
        reason: reason.into(),
    };
    RunPage {
        title: title.to_owned(),
        program: "flexframe 0.1.0".to_owned(),
        state: RunState::Complete,
        units: PageUnits { length: "mm".into(), time: "s".into(), frequency: "Hz".into() },
        facts: vec![Fact::new("Time", format!("{DURATION} s in {rows} rows"))],
        bodies: vec![PageBody {
            name: "body".to_owned(),
            facts: vec![
                Fact::new("Mass", "9.35 kg"),
                Fact::new("Surface", format!("{} vertices", surface.vertices.len())),
                Fact::new("Shapes", modes.to_string()),
            ],
            stress: (modes > 0).then(|| PageStress { unit: "MPa".into(), shapes: stresses, products: Vec::new() }),
            surface: Some(surface),
            shapes,
            motion,
            effects: vec![
                effect("damping", "on", "ζ = 0.05", "the scene asks for it"),
                effect(
                    "Coriolis forces",
                    "on",
                    "Ω/ω₁ = 0.09",
                    "influence of 2 % of the deformation, above the limit of 0.1 %",
                ),
                effect("stiffening by stress", "off", "1e-5", "influence below the limit of 0.1 %"),
            ],
        }],
        histories,
        balances,
        times,
        scene: SceneText {
            file: "plate.toml".into(),
            text: "title = \"Free plate, 50 N end pulse\"\n\n[body]\nmesh = \"plate.msh\"\n\n[modes]\nflexible = 10 # <all>\n".into(),
        },
        warnings: Vec::new(),
        trust: trust(),
        live: None,
        compared: None,
    }
}

/// A card with an error that calls for something, one that is not known, and small ones.
fn trust() -> Trust {
    let line = |place: &str, error: Option<f64>, meaning: &str, known: &str, next: &str| PageTrustLine {
        place: place.into(),
        body: String::new(),
        error,
        meaning: meaning.into(),
        known: known.into(),
        next: next.into(),
    };
    let measured = "measured by the full nonlinear body in 4 rows";
    Trust {
        lines: vec![
            line("modes", Some(0.031), "displacements off by 3.10 % of the largest", measured, "static shapes"),
            line("model", None, "not known: it was not asked for", "", "`flexframe check plate.h5`"),
            line("mesh", Some(0.004), "displacements about 0.40 % too small", "estimated", "a smaller `mesh_size`"),
            line("steps", Some(1e-6), "motion off by at most 1e-4 % of its largest", "bounded by `tolerance`", ""),
        ],
        unseen: "Not seen: phase.".into(),
    }
}

/// Two oscillators at 10 and 100 Hz, and an output that sees nothing: their response, and the phase.
fn responses() -> Curves {
    let frequencies: Vec<f64> = (0..500).map(f64::from).collect();
    let curve = |name: &str, natural: f64, unit: &str| {
        let of = |f: &f64| {
            let (stiff, damped) = (natural * natural - f * f, 0.04 * natural * f);
            [1.0 / stiff.hypot(damped), (-damped).atan2(stiff).to_degrees()]
        };
        let values: Vec<[f64; 2]> = frequencies.iter().map(of).collect();
        Curve {
            name: name.to_owned(),
            units: vec![unit.to_owned(), "°".to_owned()],
            values: [0, 1].map(|k| values.iter().map(|value| value[k]).collect()).to_vec(),
            about: vec![format!("at {natural} Hz")],
        }
    };
    let nothing = Curve { values: vec![vec![0.0; 500]; 2], ..curve("nothing / </script><b>push", 1.0, "mm per N") };
    Curves {
        subject: "frequency response",
        frequency_unit: "Hz".to_owned(),
        logarithmic: false,
        charts: [("Magnitude", true), ("Phase, degrees", false)]
            .map(|(name, logarithmic)| Chart::new(name, logarithmic))
            .to_vec(),
        resonances: Vec::new(),
        headings: vec!["Highest"],
        curves: vec![curve("slow / push", 10.0, "mm per N"), curve("fast / push", 100.0, "mm/s per N"), nothing],
        frequencies,
    }
}
