//! Figures of every kind. They are left in the folder `flexframe-figures` of the system's folder for
//! temporary files, to be looked at.

#[path = "../src/body/test_body.rs"]
mod test_body;

use figures::*;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use test_body::Block;

fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join("flexframe-figures");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn series(label: &str, stroke: Stroke, points: impl IntoIterator<Item = (f64, f64)>) -> Series {
    Series { label: label.into(), points: points.into_iter().collect(), stroke }
}

fn chart(title: &str, series: Vec<Series>) -> LineChart {
    LineChart {
        title: title.into(),
        x_label: "Time t (s)".into(),
        y_label: "Angular velocity ω₂ (rad/s)".into(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series,
        reference: None,
    }
}

/// How often a text stands in an SVG.
fn count(svg: &Path, text: &str) -> usize {
    std::fs::read_to_string(svg).unwrap().matches(&format!("\n{text}\n")).count()
}

fn size_of(path: &Path) -> u64 {
    std::fs::metadata(path).unwrap().len()
}

fn times(n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(move |i| 0.5 * i as f64 / (n - 1) as f64)
}

#[test]
fn coinciding_series_are_both_drawn() {
    let response = |t: f64| -0.4 * (1.0 - (-8.0 * t).exp()) + 0.05 * (2.0 * PI * 24.5 * t).sin() * (-6.0 * t).exp();
    let rigid = |t: f64| -0.4 * (1.0 - (-8.0 * t).exp());
    let chart = chart(
        "Angular velocity of the plate about axis 2",
        vec![
            series("flexible plate", Stroke::Solid, times(5001).map(|t| (t, response(t)))),
            series("flexible plate, reference", Stroke::Dashed, times(5001).map(|t| (t, response(t)))),
            series("rigid plate", Stroke::Solid, times(50).map(|t| (t, rigid(t)))),
        ],
    );
    let [svg, ..] = chart.save(folder().join("coinciding")).unwrap();
    let text = std::fs::read_to_string(&svg).unwrap();
    let first = |colour: &str| text.find(&format!("stroke=\"{colour}\"")).unwrap();
    // The dashes of the second colour come after, and so above, all solid lines.
    assert!(first("#D55E00") > first("#0072B2") && text.rfind("#009E73").unwrap() > text.rfind("#0072B2").unwrap());
}

#[test]
fn a_series_without_points_keeps_its_colour_and_is_not_in_the_legend() {
    let line = |label: &str, n: usize| series(label, Stroke::Solid, times(50).take(n).map(|t| (t, t * t)));
    let chart = chart("", vec![line("first", 50), line("second", 0), line("third", 50)]);
    let [svg, ..] = chart.save(folder().join("no points")).unwrap();
    assert_eq!(["first", "second", "third"].map(|label| count(&svg, label)), [1, 0, 1]);
    let text = std::fs::read_to_string(&svg).unwrap();
    assert_eq!(["#0072B2", "#D55E00", "#009E73"].map(|colour| text.contains(colour)), [true, false, true]);
}

/// Closed form: the heights of the spike and of the sine.
#[test]
fn a_long_history_keeps_its_peak_and_a_small_file() {
    let n = 200_000;
    let spike = 123_457;
    let value = |i: usize| if i == spike { 3.0 } else { (i as f64 * 0.37).sin() };
    let points = (0..n).map(|i| (i as f64 * 1e-4, value(i)));
    let mut chart = chart("", vec![series("", Stroke::Solid, points)]);
    chart.y_label = "Acceleration of P1 (mm/s²)".into();
    let [svg, ..] = chart.save(folder().join("long")).unwrap();
    assert!(size_of(&svg) < 100_000, "{}", size_of(&svg));

    // The spike is alone at the top: 3 on an axis from −1.2 to 3.2, whose frame is the tallest path.
    let text = std::fs::read_to_string(&svg).unwrap();
    let places: Vec<(i64, i64)> = text
        .lines()
        .filter(|line| line.contains("#0072B2"))
        .flat_map(|line| line.split("points=\"").nth(1).unwrap().split('"').next().unwrap().split_whitespace())
        .map(|place| place.split_once(',').unwrap())
        .map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap()))
        .collect();
    let top = places.iter().map(|place| place.1).min().unwrap();
    let below: i64 = places.iter().filter(|place| place.0 < 1000).map(|place| place.1).min().unwrap();
    let bottom = places.iter().map(|place| place.1).max().unwrap();
    let measured = (bottom - top) as f64 / (bottom - below) as f64;
    assert!((measured - 4.0 / 2.0).abs() < 0.01, "{measured}");
}

#[test]
fn constant_tiny_and_many_series_have_axes() {
    let zero =
        chart("Linear momentum, undisturbed", vec![series("all zero", Stroke::Solid, times(10).map(|t| (t, 0.0)))]);
    let [svg, ..] = zero.save(folder().join("zero")).unwrap();
    assert_eq!((count(&svg, "all zero"), count(&svg, "−1.0"), count(&svg, "1.0")), (1, 1, 1));
    let single = chart("One point", vec![series("", Stroke::Solid, [(2.0, 5.0)])]);
    let [svg, ..] = single.save(folder().join("single")).unwrap();
    let text = std::fs::read_to_string(&svg).unwrap();
    assert_eq!(text.lines().filter(|line| line.contains("<circle") && line.contains("#0072B2")).count(), 1);

    let drift = |t: f64| 1e-13 * (40.0 * t).sin() - 4e-13 * t;
    let mut tiny = chart("Energy error", vec![series("exponential", Stroke::Solid, times(800).map(|t| (t, drift(t))))]);
    tiny.y_label = "Energy − E₀ (Mg mm²/s²)".into();
    let [svg, ..] = tiny.save(folder().join("tiny")).unwrap();
    assert_eq!((count(&svg, "×10⁻¹⁵"), count(&svg, "−200")), (1, 1));
    let mut offset =
        chart("Kinetic energy", vec![series("", Stroke::Solid, times(800).map(|t| (t, 467.5 + 1e5 * drift(t))))]);
    offset.y_label = "E (Mg mm²/s²)".into();
    let [svg, ..] = offset.save(folder().join("offset")).unwrap();
    assert_eq!((count(&svg, "×10⁻⁹ + 467.5"), count(&svg, "−25")), (1, 1));

    let wave = |k: usize| {
        let stroke = if k.is_multiple_of(2) { Stroke::Solid } else { Stroke::Dashed };
        let points = times(300).map(move |t| (t, 1e5 * (20.0 * t + k as f64).sin() * (1.0 + k as f64)));
        series(&format!("modal coordinate q{k}"), stroke, points)
    };
    let [svg, ..] = chart("Nine series", (0..9).map(wave).collect()).save(folder().join("many")).unwrap();
    for k in 0..9 {
        assert_eq!(count(&svg, &format!("modal coordinate q{k}")), 1);
    }
}

#[test]
fn logarithmic_axes_show_orders_as_slopes() {
    let ladder = || (0..8).map(|i| 5e-3 / 2_f64.powi(i));
    let scheme = |label, order: i32, constant: f64, stroke| {
        series(label, stroke, ladder().map(move |step| (step, constant * step.powi(order))))
    };
    let chart = LineChart {
        title: "Error in attitude after 1 s".into(),
        x_label: "Step Δt (s)".into(),
        y_label: "Error (rad)".into(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series: vec![
            scheme("paper, Δt¹", 1, 14.0, Stroke::Solid),
            scheme("strang, Δt²", 2, 50.0, Stroke::Solid),
            scheme("exponential, Δt⁴", 4, 3e7, Stroke::Dashed),
        ],
        reference: None,
    };
    let [svg, ..] = chart.save(folder().join("logarithmic")).unwrap();
    for decade in ["10⁻⁵", "10⁻²", "10⁻⁴", "10⁻³", "10⁻⁸"] {
        assert!(count(&svg, decade) > 0, "{decade}");
    }

    let mut negative = chart.clone();
    negative.series[1].points[3].1 = 0.0;
    refuses(negative.save(folder().join("never")), "series \"strang, Δt²\" holds 0, entry 3;");
}

/// Refuses data in these words.
fn refuses<T: std::fmt::Debug>(saved: Result<T, FigureError>, words: &str) {
    let error = saved.unwrap_err();
    assert!(matches!(error, FigureError::Unfit { .. }) && error.to_string().contains(words), "{error}");
}

#[test]
fn charts_refuse_what_cannot_be_drawn() {
    let empty = chart("nothing", vec![series("a", Stroke::Solid, [])]);
    refuses(empty.save(folder().join("never")), "has no point");
    let nan = chart("nan", vec![series("a", Stroke::Solid, [(0.0, 1.0), (1.0, f64::NAN)])]);
    refuses(nan.save(folder().join("never")), "not finite: series \"a\", entry 1");
    let chart = chart("fine", vec![series("a", Stroke::Solid, [(0.0, 1.0)])]);
    match chart.save(folder().join("no such folder").join("chart")) {
        Err(FigureError::Write { path, .. }) => assert!(path.ends_with("no such folder/chart.svg")),
        other => panic!("{other:?}"),
    }
}

/// A half-sine pulse at the start that is over after this part of the time, or a step where it stays.
fn pulse(part: f64, stays: bool) -> impl Fn(f64) -> (f64, f64) {
    move |t| {
        let phase = (t / 0.5 / part).min(1.0) * PI;
        (t, 50.0 * if stays { 0.5 * (1.0 - phase.cos()) } else { phase.sin() })
    }
}

#[test]
fn what_is_over_soon_is_enlarged_in_an_inset_and_nothing_else_is() {
    let draw = |name: &str, part: f64, stays: bool| {
        let both = || times(5001).map(pulse(part, stays));
        let lines = vec![series("flexible", Stroke::Solid, both()), series("rigid", Stroke::Dashed, both())];
        let [svg, ..] = chart("A pulse at the start", lines).save(folder().join(name)).unwrap();
        let text = std::fs::read_to_string(svg).unwrap();
        // The frame around the axes is a closed path of five places.
        text.lines().filter(|line| line.contains("#1E1E1E") && line.matches(',').count() == 5).count()
    };
    assert_eq!(draw("pulse", 0.04, false), 2);
    assert_eq!(draw("step", 0.04, true), 2);
    assert_eq!(draw("slow", 0.5, false), 1);
}

#[test]
fn noise_is_called_so_and_does_not_fill_the_axis() {
    let noise = |peak: f64| {
        let lines = vec![series("α₁", Stroke::Solid, times(500).map(|t| (t, 9e-11 * (40.0 * t).sin().powi(3))))];
        let reference = Some(Reference { name: "the peak of α₂".into(), value: peak });
        LineChart { reference, ..chart("Angular acceleration", lines) }
    };
    let [svg, ..] = noise(8.45).save(folder().join("noise")).unwrap();
    // 9e-11 of 8.45; the axis goes to the peak and not by steps of 1e-12.
    assert_eq!(count(&svg, "numerical noise: at most 9.0·10⁻¹¹, 1.1·10⁻¹¹ of the peak of α₂"), 1);
    assert_eq!((count(&svg, "8"), count(&svg, "×10⁻¹²")), (1, 0));

    let [svg, ..] = noise(1e-5).save(folder().join("small")).unwrap();
    assert_eq!(count(&svg, "at most 9.0·10⁻¹¹, 9.0·10⁻⁶ of the peak of α₂"), 1);
    assert_eq!(count(&svg, "×10⁻¹²"), 1);
}

/// Closed form: lines of one to eight times a height.
#[test]
fn small_multiples_share_their_axes() {
    let line = |k: u32| {
        let points = times(2000).map(move |t| (t, 4e-5 * f64::from(k) * (150.0 * t).sin() * (-9.0 * t).exp()));
        series(&format!("P{k}"), Stroke::Solid, points)
    };
    let grid = ChartGrid {
        title: "Displacement in X₂".into(),
        x_label: "time, s".into(),
        y_label: "displacement, mm".into(),
        series: (1..=8).map(line).collect(),
        columns: 2,
        reference: Some(Reference { name: "the largest displacement".into(), value: 400.0 }),
    };
    let [svg, ..] = grid.save(folder().join("multiples")).unwrap();
    assert_eq!((count(&svg, "P1"), count(&svg, "P8"), count(&svg, "time, s"), count(&svg, "×10⁻⁶")), (1, 1, 1, 8));
    // The first line is an eighth of the last, over the same axis.
    let heights: Vec<i64> = std::fs::read_to_string(&svg)
        .unwrap()
        .lines()
        .filter(|line| line.contains("#0072B2"))
        .map(|line| {
            let places = line.split("points=\"").nth(1).unwrap().split('"').next().unwrap().split_whitespace();
            let ys: Vec<i64> = places.map(|place| place.split_once(',').unwrap().1.parse().unwrap()).collect();
            ys.iter().max().unwrap() - ys.iter().min().unwrap()
        })
        .collect();
    assert_eq!(heights.len(), 8);
    assert!((heights[7] as f64 / heights[0] as f64 - 8.0).abs() < 0.5, "{heights:?}");
    refuses(ChartGrid { columns: 0, ..grid }.save(folder().join("never")), "has no column");
}

#[test]
fn a_pdf_has_one_page_of_the_size_of_the_picture_and_the_letters_of_its_texts() {
    let lines = || vec![series("flexible", Stroke::Dashed, times(5001).map(pulse(0.04, false)))];
    let save = |name: &str| chart("Kinetic energy", lines()).save(folder().join(name)).unwrap();
    let [_, pdf, _] = save("page");
    let bytes = std::fs::read(&pdf).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.starts_with("%PDF-1.") && text.trim_end().ends_with("%%EOF"));
    assert!(text.contains("/Type/Pages/Count 1/"), "{:?}", text.split("/Count").nth(1).map(|rest| &rest[..5]));
    // 720 by 440 pixels of 1/96 inch.
    assert!(text.contains("/MediaBox[0 0 540 330]"), "{:?}", text.split("/MediaBox").nth(1).map(|rest| &rest[..40]));
    assert!(text.contains("DejaVuSans") && !text.contains("/Subtype/Image"));
    // Only the letters that are used, of a font of 750 kB.
    assert!(bytes.len() < 60_000, "{}", bytes.len());
    assert_eq!(std::fs::read(&save("page again")[1]).unwrap(), bytes);
}

/// Bending and torsion shapes like those of a free plate, with the size of the displacement.
fn mode(block: &Block, k: usize, amplitude: f64) -> (Vec<[f64; 3]>, Vec<f64>) {
    let displaced = |p: &[f64; 3]| {
        let s = p[0] / 1000.0;
        let n = (k / 2 + 2) as f64;
        let displacement = if k.is_multiple_of(2) {
            let slope = -(n * PI * s).sin() * n * PI / 1000.0;
            [-p[2] * slope * amplitude, 0.0, amplitude * (n * PI * s).cos()]
        } else {
            let twist = amplitude / 25.0 * ((n - 1.0) * PI * s).sin();
            [0.0, -p[2] * twist, p[1] * twist]
        };
        let size = displacement.iter().map(|u| u * u).sum::<f64>().sqrt();
        ([0, 1, 2].map(|i| p[i] + displacement[i]), size)
    };
    block.points.iter().map(displaced).unzip()
}

fn grid<'a>(block: &'a Block, triangles: &'a [[u32; 3]], edges: &'a [[u32; 2]], amplitude: f64) -> ShapeGrid<'a> {
    let panel = |k: usize| {
        let (points, values) = mode(block, k, amplitude);
        Panel { title: format!("Mode {}: {:.2} Hz", k + 1, 24.53 * (k as f64 + 1.0).powi(2)), points, values }
    };
    ShapeGrid {
        title: "Flexible modes of the free plate".into(),
        value_label: "Size of the modal displacement (mm)".into(),
        triangles,
        edges,
        undeformed: &block.points,
        panels: (0..10).map(panel).collect(),
        columns: 2,
        view: View::default(),
    }
}

#[test]
fn mode_shapes_fill_their_panels() {
    let block = Block::new([1000.0, 50.0, 10.0], [100, 5, 1]);
    let triangles = facets(&block.outer_faces());
    let edges = sharp_edges(&block.points, &block.outer_faces());
    assert_eq!(triangles.len(), 2 * 4 * 2 * (500 + 100 + 5));
    let figure = grid(&block, &triangles, &edges, 60.0);
    let [svg, _, png] = figure.save(folder().join("modes")).unwrap();
    assert!(size_of(&svg) < 2_000_000 && size_of(&png) < 1_000_000, "{} {}", size_of(&svg), size_of(&png));

    let cube = Block::new([100.0, 80.0, 60.0], [4, 4, 4]);
    let triangles = facets(&cube.outer_faces());
    let edges = sharp_edges(&cube.points, &cube.outer_faces());
    let mut figure = grid(&cube, &triangles, &edges, 0.0);
    figure.panels.truncate(3);
    figure.columns = 3;
    figure.value_label = "nothing moves".into();
    figure.save(folder().join("blocks")).unwrap();
}

#[test]
fn small_bodies_are_vectors_and_large_ones_pictures() {
    let draw = |name: &str, cells: [usize; 3]| {
        let block = Block::new([1000.0, 200.0, 100.0], cells);
        let triangles = facets(&block.outer_faces());
        let edges = sharp_edges(&block.points, &block.outer_faces());
        let mut figure = grid(&block, &triangles, &edges, 60.0);
        figure.panels.truncate(4);
        let [svg, pdf, _] = figure.save(folder().join(name)).unwrap();
        let text = std::fs::read_to_string(&svg).unwrap();
        assert_eq!(count(&svg, "0"), 1, "the bar begins at 0");
        assert_eq!((count(&svg, "x"), count(&svg, "y"), count(&svg, "z")), (1, 1, 1));
        let is_picture = String::from_utf8_lossy(&std::fs::read(&pdf).unwrap()).contains("/Subtype/Image");
        assert_eq!(text.contains("<image"), is_picture);
        (text.matches("<polygon").count(), text.contains("<image"), text.len())
    };
    let (areas, is_picture, length) = draw("vectors", [20, 4, 2]);
    // Half of the surface is seen from one side, and less where it hides itself.
    let all = 4 * 8 * 2 * (20 * 4 + 4 * 2 + 20 * 2);
    assert!(!is_picture && areas > all / 3 && areas < 3 * all / 5 && length < 1_000_000, "{areas} of {all}, {length}");
    let (areas, is_picture, _) = draw("no vectors", [60, 10, 5]);
    assert!(is_picture && areas == 0, "{areas}");
}

#[test]
fn areas_that_cannot_be_painted_one_after_another_are_a_picture() {
    // Two squares that pass through each other: each is in front of the other on one side.
    let points = [
        [-1.0, -1.0, -0.5],
        [1.0, -1.0, 0.5],
        [1.0, 1.0, 0.5],
        [-1.0, 1.0, -0.5],
        [-1.0, -1.0, 0.5],
        [1.0, -1.0, -0.5],
        [1.0, 1.0, -0.5],
        [-1.0, 1.0, 0.5],
    ];
    let panel = Panel { title: String::new(), points: points.to_vec(), values: (0..8).map(f64::from).collect() };
    let triangles = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let draw = |triangles: &[[u32; 3]], name: &str| {
        let figure = ShapeGrid {
            title: String::new(),
            value_label: "x".into(),
            triangles,
            edges: &[],
            undeformed: &[],
            panels: vec![panel.clone()],
            columns: 1,
            view: View { azimuth: -90.0, elevation: 90.0 },
        };
        std::fs::read_to_string(&figure.save(folder().join(name)).unwrap()[0]).unwrap().contains("<image")
    };
    assert!(draw(&triangles, "crossed"));
    assert!(!draw(&triangles[..2], "one of them"));
}

#[test]
fn shapes_refuse_what_does_not_fit_together() {
    let block = Block::new([4.0, 2.0, 1.0], [2, 1, 1]);
    let triangles = facets(&block.outer_faces());
    let good = grid(&block, &triangles, &[], 0.1);
    let refused = |figure: ShapeGrid, words: &str| refuses(figure.save(folder().join("never")), words);

    refused(ShapeGrid { columns: 0, ..good.clone() }, "has no column");
    refused(ShapeGrid { panels: vec![], ..good.clone() }, "has no panel");
    let far = [[0, 1, 999]];
    refused(ShapeGrid { triangles: &far, ..good.clone() }, "a triangle that names point 999,");
    let mut short = good.clone();
    short.panels[4].values.pop();
    refused(short, "entries where");
    let mut nan = good;
    nan.panels[2].points[5][1] = f64::NAN;
    refused(nan, "entry 5");
}

#[test]
fn a_tumbling_plate_is_a_small_animation() {
    let block = Block::new([1000.0, 50.0, 10.0], [100, 5, 1]);
    let triangles = facets(&block.outer_faces());
    let edges = sharp_edges(&block.points, &block.outer_faces());
    let frames: Vec<FilmFrame> = (0..60)
        .map(|i| {
            let time = i as f64 / 60.0;
            let (points, values) = mode(&block, 0, 40.0 * (2.0 * PI * 3.0 * time).sin());
            let (sin, cos) = (2.0 * PI * time).sin_cos();
            let place = |p: &[f64; 3]| [cos * p[0] + sin * p[2] + 300.0 * time, p[1], cos * p[2] - sin * p[0]];
            FilmFrame { points: points.iter().map(place).collect(), values, caption: format!("t = {time:.3} s") }
        })
        .collect();
    let animation = Animation {
        title: "Free plate, 50 N end pulse".into(),
        value_label: "displacement by deformation, mm".into(),
        triangles: &triangles,
        edges: &edges,
        frames: &frames,
        frame_milliseconds: 50,
        view: View::default(),
        ground: true,
        plain_triangles: &[],
        traced_point: Some(0),
    };
    let path = folder().join("tumbling.gif");
    animation.save_gif(&path).unwrap();
    assert!(size_of(&path) < 1_500_000, "{}", size_of(&path));
    // All frames with one palette, and no two of them the same.
    let mut gif = gif::Decoder::new(std::fs::File::open(&path).unwrap()).unwrap();
    assert!(gif.global_palette().is_some());
    let mut drawn = Vec::new();
    while let Some(frame) = gif.read_next_frame().unwrap() {
        assert!(frame.palette.is_none() && frame.delay == 5 && (frame.width, frame.height) == (720, 440));
        drawn.push(frame.buffer.to_vec());
    }
    assert_eq!(drawn.len(), 60);
    assert!(drawn.windows(2).all(|pair| pair[0] != pair[1]));

    let refused = Animation { traced_point: Some(block.points.len()), ..animation.clone() };
    refuses(refused.save_gif(&path), "the trace that names point");
    let refused = Animation { frames: &[], ..animation };
    refuses(refused.save_gif(&path), "has no frame");
}

#[test]
fn a_body_without_extent_is_drawn() {
    let points = vec![[7.0, 8.0, 9.0]; 3];
    let panel = Panel { title: "a point".into(), points: points.clone(), values: vec![1.0; 3] };
    let figure = ShapeGrid {
        title: String::new(),
        value_label: "x".into(),
        triangles: &[[0, 1, 2]],
        edges: &[[0, 1]],
        undeformed: &[],
        panels: vec![panel],
        columns: 4,
        view: View::default(),
    };
    figure.save(folder().join("point")).unwrap();
    let frames = vec![FilmFrame { points, values: vec![0.0; 3], caption: String::new() }; 2];
    let animation = Animation {
        title: String::new(),
        value_label: String::new(),
        triangles: &[[0, 1, 2]],
        edges: &[[0, 1]],
        frames: &frames,
        frame_milliseconds: 20,
        view: View::default(),
        ground: true,
        plain_triangles: &[],
        traced_point: Some(2),
    };
    animation.save_gif(folder().join("point.gif")).unwrap();
}

#[test]
fn guides_are_labelled_at_their_ends_and_rings_lie_within_the_window() {
    let wave = |t: f64| 5.0 + 4.0 * (20.0 * t).sin();
    let chart = LineChart {
        y_scale: Scale::Window(0.0, 7.0),
        ..chart(
            "Guides, rings and a window",
            vec![
                series("wave", Stroke::Solid, times(200).map(|t| (t, wave(t)))),
                series("to the right", Stroke::Guide, [(0.0, 0.0), (0.5, 5.0)]),
                series("to the top", Stroke::Guide, [(0.0, 0.0), (0.5, 20.0)]),
                series("meetings", Stroke::Rings, [(0.1, 2.0), (0.2, 6.9), (0.3, 7.5)]),
            ],
        )
    };
    let [svg, ..] = chart.save(folder().join("window")).unwrap();
    let text = std::fs::read_to_string(&svg).unwrap();
    for label in ["wave", "meetings", "to the right", "to the top"] {
        assert_eq!(count(&svg, label), 1, "{label}");
    }
    // The wave leaves the window and comes back: pieces of 0.5 × 20/π half waves. And its line of the legend.
    let strokes = text.lines().filter(|line| line.contains("polyline") && line.contains("#0072B2")).count();
    assert_eq!(strokes, 3 + 1);
    // Rings within the window and that of the legend; the one above 7 is not there.
    assert_eq!(text.lines().filter(|line| line.contains("circle") && line.contains("stroke=\"#1E1E1E\"")).count(), 3);
}

#[test]
fn charts_of_a_stack_have_axes_of_their_own() {
    let line = |label: &str, size: f64| {
        let guide = series("24.5", Stroke::Guide, [(0.2, 0.0), (0.2, size)]);
        chart("", vec![series(label, Stroke::Solid, times(50).map(|t| (t, size * t))), guide])
    };
    let stack = ChartStack { title: "Two units".into(), charts: vec![line("force", 1e6), line("displacement", 1e-3)] };
    let [svg, ..] = stack.save(folder().join("stack")).unwrap();
    assert_eq!(["Two units", "force", "displacement", "24.5"].map(|text| count(&svg, text)), [1, 1, 1, 2]);
    let none = ChartStack { title: "None".into(), charts: Vec::new() };
    refuses(none.save(folder().join("none")), "has no chart");
}
