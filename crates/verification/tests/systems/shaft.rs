//! A shaft with a disk beside its axis, run up through its critical speed.

use dynamics::StepControl;
use verification::stability::meshes::box_mesh;
use verification::systems::meshes::write;
use verification::systems::run::{built, rows};

const YOUNG: f64 = 2e11;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 78.0;
const LENGTH: f64 = 1.0;
const SIDE: f64 = 0.02;
const DISK: f64 = 3.0;
const OFF: f64 = 5e-4;
const RATE: f64 = 280.0;
const END: f64 = 1.0;
const ROWS: usize = 200;

/// Deflections of the shaft at the disk by Jeffcott's equations, integrated here: mẍ + kx = m e (Ω² cos φ + Ω' sin φ), and across.
fn jeffcott() -> Vec<f64> {
    let moment = SIDE.powi(4) / 12.0;
    let shear = 5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * SIDE * SIDE;
    let stiffness = 1.0 / (LENGTH.powi(3) / (48.0 * YOUNG * moment) + LENGTH / (4.0 * shear));
    // 17/35 of the mass of the shaft move with the disk.
    let mass = DISK + 17.0 / 35.0 * DENSITY * SIDE * SIDE * LENGTH;
    let rates = |t: f64, [y, z, dy, dz]: [f64; 4]| {
        let (speed, (sine, cosine)) = (RATE * t, (0.5 * RATE * t * t).sin_cos());
        let push = DISK * OFF / mass;
        let square = stiffness / mass;
        [
            dy,
            dz,
            push * (speed * speed * cosine + RATE * sine) - square * y,
            push * (speed * speed * sine - RATE * cosine) - square * z,
        ]
    };
    let (fine, mut y) = (200, [0.0; 4]);
    let h = END / (ROWS * fine) as f64;
    let mut found = vec![0.0];
    for step in 0..ROWS * fine {
        let t = step as f64 * h;
        let add = |k: [f64; 4], by: f64| std::array::from_fn(|i| y[i] + by * k[i]);
        let k1 = rates(t, y);
        let k2 = rates(t + 0.5 * h, add(k1, 0.5 * h));
        let k3 = rates(t + 0.5 * h, add(k2, 0.5 * h));
        let k4 = rates(t + h, add(k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        if (step + 1) % fine == 0 {
            found.push(y[0].hypot(y[1]));
        }
    }
    found
}

/// Closed form: Jeffcott's rotor, integrated beside it. The critical speed is passed at three quarters of the time.
#[test]
fn a_shaft_passes_its_critical_speed_as_jeffcotts_does() {
    let directory = tempfile::tempdir().unwrap();
    write(directory.path(), "half", &box_mesh([0.5 * LENGTH, SIDE, SIDE], [10, 2, 2]), &[]).unwrap();
    let mut text = "title = 'shaft'\nunits = { length = 'm', mass = 'kg', time = 's' }\n".to_owned();
    for (name, x) in [("left", 0.0), ("right", 0.5 * LENGTH)] {
        let face = |x: f64| format!("{{ box = [[{}, -1, -1], [{}, 1, 1]] }}", x - 1e-6, x + 1e-6);
        text += &format!(
            "[bodies.{name}]\nmesh = 'half.msh'\nmaterial = {{ young_modulus = {YOUNG:e}, poisson_ratio = {POISSON}, density = {DENSITY} }}\n\
             modes = {{ flexible = 2 }}\nmarkers = {{ low = {}, high = {} }}\ninitial = {{ position = [{x}, {}, {}] }}\n",
            face(0.0),
            face(0.5 * LENGTH),
            -0.5 * SIDE,
            -0.5 * SIDE
        );
    }
    text += &format!(
        "[bodies.hub]\nrigid = {{ mass = 0.1, center_of_mass = [0, 0, 0], inertia = [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]] }}\n\
         markers = {{ m = {{ at = [0, 0, 0] }} }}\n\
         [bodies.disk]\nrigid = {{ mass = {DISK}, center_of_mass = [0, {OFF}, 0], inertia = [[1e-2, 0, 0], [0, 5e-3, 0], [0, 0, 5e-3]] }}\n\
         initial = {{ position = [{}, 0, 0] }}\nmarkers = {{ m = {{ at = [0, 0, 0] }} }}\npoints = {{ axis = [0, 0, 0] }}\n\
         [ground.markers.bearing]\nat = [{LENGTH}, 0, 0]\n\
         [[joints]]\nkind = 'revolute'\nbetween = ['ground', 'hub.m']\naxis = [1, 0, 0]\n\
         drive = {{ amplitude = {}, history = {{ kind = 'expression', formula = 't^2' }} }}\n\
         [[joints]]\nkind = 'universal'\nbetween = ['hub.m', 'left.low']\naxis = [1, 0, 0]\n\
         [[joints]]\nkind = 'fixed'\nbetween = ['left.high', 'disk.m']\n\
         [[joints]]\nkind = 'fixed'\nbetween = ['disk.m', 'right.low']\n\
         [[joints]]\nlocked = ['y', 'z']\nbetween = ['ground.bearing', 'right.high']\naxis = [0, 0, 1]\n\
         [time]\nend = {END}\ntolerance = 1e-5\n",
        0.5 * LENGTH,
        0.5 * RATE
    );
    let built = built(directory.path(), &text).unwrap();
    let mut simulation = built.start(StepControl::Tolerance(1e-5), END, END / ROWS as f64, false).unwrap();
    let found = rows(&mut simulation, 4).unwrap();
    let expected = jeffcott();
    let peak = expected.iter().copied().fold(0.0, f64::max);
    let off = found.iter().zip(&expected).map(|(row, expected)| {
        let u = row[3].points[0].displacement;
        (u.y.hypot(u.z) - expected).abs() / peak
    });
    let off = off.fold(0.0, f64::max);
    println!("off by {off:.4} of a peak of {peak:.5}, {} steps", simulation.stats().accepted);
    assert!(peak > 10.0 * OFF && off < 0.03, "{off} {peak}");
}
