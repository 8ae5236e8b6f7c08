//! The Princeton beam: a large deflection by a chain of bodies that deform little.

use dynamics::StepControl;
use verification::stability::meshes::box_mesh;
use verification::systems::meshes::write;
use verification::systems::run::{built, rows};

/// Independent reference: beams of Bauchau et al. (2016) for the Princeton experiment, load P3 = 13.345 N at 90°, across the thin side:
/// the tip of the beam of 0.508 m × 12.377 mm × 3.2024 mm goes 0.200695 m across and 0.050407 m back. Euler's elastica has 0.200687
/// and 0.050404.
#[test]
fn a_chain_of_segments_bends_as_the_princeton_beam() {
    let (segments, length, [breadth, height]) = (8, 0.508, [0.012_377, 0.003_202_4]);
    let part = length / segments as f64;
    let directory = tempfile::tempdir().unwrap();
    write(directory.path(), "segment", &box_mesh([part, breadth, height], [6, 2, 1]), &[]).unwrap();
    let mut text = "title = 'Princeton'\nunits = { length = 'm', mass = 'kg', time = 's' }\n".to_owned();
    for k in 0..segments {
        let face = |x: f64| format!("{{ box = [[{}, -1, -1], [{}, 1, 1]], patches = 3 }}", x - 1e-6, x + 1e-6);
        let last = k + 1 == segments;
        // Slow, so that it hardly swings.
        let load = format!(
            "loads = [{{ kind = 'force', at = [{part}, {}, {}], direction = [0, 0, -1], amplitude = 13.345, history = {{ kind = 'ramp', duration = 1.0 }} }}]\n\
             points = {{ tip = [{part}, {}, {}] }}\n",
            0.5 * breadth,
            0.5 * height,
            0.5 * breadth,
            0.5 * height,
        );
        text += &format!(
            "[bodies.s{k}]\nmesh = 'segment.msh'\nmaterial = {{ young_modulus = 71.7e9, poisson_ratio = 0.31, density = 2700.0 }}\n\
             modes = {{ flexible = 2, damping_ratio = 0.05, static_correction = false }}\ninitial = {{ position = [{}, 0, 0] }}\n\
             markers = {{ root = {}, tip = {} }}\n{}",
            part * k as f64,
            face(0.0),
            face(part),
            if last { &load } else { "" }
        );
    }
    for k in 0..segments {
        let root = if k == 0 { "ground".to_owned() } else { format!("s{}.tip", k - 1) };
        text += &format!("[[joints]]\nkind = 'fixed'\nbetween = ['{root}', 's{k}.root']\n");
    }
    text += &format!(
        "[ground.markers.wall]\nat = [{length}, 0, 0]\n\
         [[bushings]]\nbetween = ['ground.wall', 's{}.tip']\ndamping = {{ translation = [2, 2, 2] }}\n\
         [time]\nend = 3.0\ntolerance = 1e-4\n",
        segments - 1
    );
    let built = built(directory.path(), &text).unwrap();
    let mut simulation = built.start(StepControl::Tolerance(1e-4), 3.0, 0.5, false).unwrap();
    let found = rows(&mut simulation, segments).unwrap();
    let [moved, before] = [1, 2].map(|back| found[found.len() - back][segments - 1].points[0].displacement);
    assert!((moved - before).norm() < 1e-6, "at rest: {moved} {before}");
    println!("across {}, back {}, {} steps", moved.z, moved.x, simulation.stats().accepted);
    assert!((moved.z / -0.200_695 - 1.0).abs() < 0.01 && (moved.x / -0.050_407 - 1.0).abs() < 0.01, "{moved}");
}
