//! The way a mesh lies, and the numbers of its nodes, change no static shape.

use nalgebra::{Rotation3, Vector3};

use crate::{DENSITY, POISSON, YOUNG, build, observations, parse};

/// The bar of `data/bar.msh` turned about the origin, its nodes in the opposite order and with other numbers.
fn turned(text: &str, turn: &Rotation3<f64>) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let place = |name: &str| lines.iter().position(|line| *line == name).unwrap();
    let (nodes, elements) = (place("$Nodes"), place("$Elements"));
    let last: usize = lines[nodes + 1].split(' ').nth(1).unwrap().parse().unwrap();
    let other = |tag: &str| (last + 1 - tag.parse::<usize>().unwrap()).to_string();
    let mut out: Vec<String> = lines[..nodes + 2].iter().map(ToString::to_string).collect();
    let mut next = nodes + 2;
    while lines[next] != "$EndNodes" {
        let count: usize = lines[next].split(' ').nth(3).unwrap().parse().unwrap();
        let block = &lines[next + 1..next + 1 + 2 * count];
        out.push(lines[next].to_owned());
        out.extend(block[..count].iter().rev().map(|tag| other(tag)));
        for line in block[count..].iter().rev() {
            let x: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
            let x = turn * Vector3::new(x[0], x[1], x[2]);
            out.push(format!("{:?} {:?} {:?}", x.x, x.y, x.z));
        }
        next += 1 + 2 * count;
    }
    out.extend(lines[next..elements + 2].iter().map(ToString::to_string));
    next = elements + 2;
    while lines[next] != "$EndElements" {
        let count: usize = lines[next].split(' ').nth(3).unwrap().parse().unwrap();
        out.push(lines[next].to_owned());
        for line in &lines[next + 1..next + 1 + count] {
            let (element, of) = line.trim().split_once(' ').unwrap();
            let of: Vec<String> = of.split(' ').map(other).collect();
            out.push(format!("{element} {}", of.join(" ")));
        }
        next += 1 + count;
    }
    out.extend(lines[next..].iter().map(ToString::to_string));
    out.join("\n") + "\n"
}

/// Conserved: the same shapes, frequencies and motion, however the mesh lies.
#[test]
fn static_shapes_are_the_same_however_the_mesh_lies() {
    let folder = tempfile::tempdir().unwrap();
    let text = include_str!("../data/bar.msh");
    let found = [Rotation3::identity(), Rotation3::from_euler_angles(0.3, -0.8, 1.1)].map(|turn| {
        let mesh = folder.path().join(format!("{:.3}.msh", turn.angle()));
        std::fs::write(&mesh, if turn.angle() == 0.0 { text.to_owned() } else { turned(text, &turn) }).unwrap();
        let vector = |x: f64, y: f64, z: f64| {
            let x = turn * Vector3::new(x, y, z);
            format!("[{:?}, {:?}, {:?}]", x.x, x.y, x.z)
        };
        let scene = parse(&format!(
            "title = \"Bar\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = {mesh:?}\n\
             material = {{ young_modulus = {YOUNG:e}, poisson_ratio = {POISSON}, density = {DENSITY:e} }}\n\
             [modes]\nflexible = 6\nstatic_correction = true\n[initial]\nangular_velocity = {}\n\
             [[loads]]\nkind = \"force\"\nat = {}\ndirection = {}\namplitude = 1.0\nhistory = {{ kind = \"constant\" }}\n\
             [[loads]]\nkind = \"gravity\"\ndirection = {}\namplitude = 9810.0\n\
             [effects]\nlarge_deflection = false\n[time]\nend = 2e-3\ntolerance = 1e-8\n[output]\ninterval = 1e-3\n\
             points = {{ tip = {} }}\n",
            vector(0.0, 0.0, 100.0),
            vector(200.0, 0.0, 0.0),
            vector(0.3, 0.4, 1.0),
            vector(0.0, 1.0, 0.0),
            vector(200.0, 0.0, 0.0),
        ));
        let model = build(&scene);
        let last = observations(&scene, &model).pop().unwrap();
        let moved = turn.inverse() * last.points[0].elastic_displacement_global;
        println!("{} {:?} {moved:?}", model.static_shapes(), model.natural_frequencies());
        (model.static_shapes(), model.natural_frequencies(), moved)
    });
    let [(shapes, frequencies, moved), (others, of_turned, moved_turned)] = &found;
    assert!(*shapes > 0 && shapes == others, "{shapes} {others}");
    for (a, b) in frequencies.iter().zip(of_turned) {
        assert!((b / a - 1.0).abs() < 1e-6, "{a} {b}");
    }
    assert!((moved - moved_turned).norm() < 1e-6 * moved.norm(), "{moved:?} {moved_turned:?}");
}
