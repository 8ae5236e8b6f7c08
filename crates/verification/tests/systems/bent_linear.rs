//! Linearised equations of bodies that bend far, in joints: against nonlinear finite elements, and against the equations of the run.

use dynamics::{CommonSpin, MotionState, Observation, SteadyState, StepControl, System, SystemMotion};
use flexframe::linearize::{LinearSettings, linear_model};
use nalgebra::Vector3;
use rigid_kin::Attitude;
use verification::systems::run::{Built, built, rows};

use crate::bent::{MATERIAL, SIZE, UNITS, at, body, solid, tip, with_bar};

const LARGE: &str = "flexible = 16, large = [1, 3], following = 7";
const ROOT: &str = "root = { box = [[-1e-6, -1, -1], [1e-6, 1, 1]] }";
const WELD: &str = "[[joints]]\nname = 'weld'\nkind = 'fixed'\nbetween = ['ground', 'bar.root']\n";

fn whole(text: &str) -> String {
    format!("{UNITS}{text}[time]\nend = 1.0\ntolerance = 1e-6\n")
}

fn motion(built: &Built) -> SystemMotion {
    let mut motion = SystemMotion::new(built.tied.system.clone(), &built.tied.states).unwrap();
    motion.assemble().unwrap();
    motion
}

/// The force at the tip that bends a beam by a part of its length.
fn force(deflection: f64) -> f64 {
    3.0 * MATERIAL.young_modulus * SIZE[1] * SIZE[2].powi(3) / 12.0 * deflection
}

/// A bar on a fixed joint, with a force at its tip.
fn cantilever(modes: &str, force: f64) -> String {
    let rest = format!(
        "markers = {{ {ROOT} }}\npoints = {{ tip = {place:?} }}\n\
         loads = [{{ kind = 'force', at = {place:?}, direction = [0, 0, -1], amplitude = {force:e} }}]\n",
        place = tip().as_slice()
    );
    body("bar", MATERIAL.young_modulus, modes, &rest) + WELD
}

/// Independent reference: vibrations about the rest of the nonlinear finite elements of this crate, with the nodes of one end held, by the
/// tangent there.
#[test]
fn a_bent_bar_in_a_joint_vibrates_as_the_clamped_mesh() {
    let directory = with_bar();
    let clamped = solid(MATERIAL.young_modulus, |x| x.x < 1e-9);
    let node = at(&clamped, &tip());
    let shapes: Vec<Vec<f64>> = (0..10)
        .map(|k| {
            let of_node = |x: &[f64; 3]| {
                let along = x[0] * x[0] * (1.0 + f64::from(k / 2) * x[0]).cos();
                if k % 2 == 0 { [0.0, 0.0, along] } else { [0.0, along, 0.1 * x[1] * along] }
            };
            clamped.mesh().positions().iter().flat_map(of_node).collect()
        })
        .collect();
    for (deflection, within) in [(0.1, 6e-3), (0.2, 2e-2)] {
        let mut load = vec![0.0; clamped.dofs()];
        load[3 * node + 2] = -force(deflection);
        let u = clamped.at_rest(8, 0.0, |_| load.clone()).unwrap();
        let expected = clamped.frequencies_at_rest(&u, &shapes).unwrap();
        let built = built(directory.path(), &whole(&cantilever(LARGE, force(deflection)))).unwrap();
        let linear = motion(&built).steady_state(&CommonSpin::REST).unwrap().linear;
        let found = linear.vibrations().unwrap().modes;
        for (mode, expected) in found.iter().zip(&expected).take(4) {
            let off = mode.circular_frequency() / expected - 1.0;
            println!("{deflection}: {:.4}, {expected:.4} rad/s: {off:+.2e}", mode.circular_frequency());
            assert!(off.abs() < within, "{off:e}");
        }
    }
}

/// Conserved: the static answer of the linear model is the change of the rest by the load, at a point of the bent body.
#[test]
fn the_static_answer_about_a_bent_rest_is_the_change_of_the_rest() {
    let directory = with_bar();
    let load = force(0.15);
    let text = |force: f64| whole(&cantilever(LARGE, force));
    let at_tip = |force: f64| {
        let built = built(directory.path(), &text(force)).unwrap();
        let steady = motion(&built).steady_state(&CommonSpin::REST).unwrap();
        let (state, model) = (&steady.states()[0], &built.models[0]);
        state.origin_global + state.attitude.to_global(&model.arm(&model.points[0].1, &state.modal_displacement))
    };
    let part = 1e-3;
    let expected = (at_tip(load * (1.0 + part)) - at_tip(load * (1.0 - part))) / (2.0 * part);
    let scene = scene::Scene::parse(&text(load), directory.path().join("scene.toml")).unwrap();
    let model = linear_model(&scene, &model::Builder::default(), &LinearSettings::default(), |_| ()).unwrap();
    let equations = model.equations;
    let (n, input) = (equations.stiffness.nrows(), 0);
    let matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| equations.stiffness[(i, j)]);
    let answer = matrix.lu().solve(&nalgebra::DVector::from_fn(n, |i, _| equations.forces[(i, input)])).unwrap();
    let state =
        &motion(&built(directory.path(), &text(load)).unwrap()).steady_state(&CommonSpin::REST).unwrap().states()[0];
    let along = |axis: &str| {
        let name = format!("tip.displacement.{axis}");
        let output = equations.outputs.iter().find(|output| output.channel.name == name).unwrap_or_else(|| {
            panic!("{:?}", equations.outputs.iter().map(|output| output.channel.name.clone()).collect::<Vec<_>>())
        });
        output.rows[0].iter().zip(&answer).map(|(row, x)| row * x).sum::<f64>()
    };
    let found = state.attitude.to_global(&Vector3::new(along("x"), along("y"), along("z")));
    println!("{found} {expected}");
    assert!(expected.z.abs() > 0.1 && expected.x.abs() > 0.02, "{expected}");
    assert!((found - expected).norm() < 1e-5 * expected.norm(), "{found} {expected}");
}

/// Accelerations V̇, ω̇ of each body in its axes, and q̈.
fn accelerations(system: &System, states: &[MotionState]) -> Vec<f64> {
    let mut motion = SystemMotion::new(system.clone(), states).unwrap();
    motion.find_reactions().unwrap();
    let mut all = Vec::new();
    for body in 0..states.len() {
        let state = motion.state(body).unwrap();
        let mut out = Observation::new(state.modal_displacement.len(), 0);
        motion.observe(body, &[], &mut out).unwrap();
        let velocity = state.attitude.to_body(&state.velocity_global);
        let turned = state.attitude.to_body(&out.origin_acceleration_global) - state.omega_body.cross(&velocity);
        all.extend(turned.iter().chain(&out.alpha_body).chain(&out.modal_acceleration));
    }
    all
}

fn part(list: &[f64], first: usize) -> Vector3<f64> {
    Vector3::from_column_slice(&list[first..first + 3])
}

/// L x: the changes of V and ω by those of place.
fn convected(steady: &SteadyState, x: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; x.len()];
    for (body, state) in steady.states().iter().enumerate() {
        let first = steady.linear.coordinates_of(body).start;
        let velocity = state.attitude.to_body(&state.velocity_global);
        let moved = state.omega_body.cross(&part(x, first)) + velocity.cross(&part(x, first + 3));
        out[first..first + 3].copy_from_slice(moved.as_slice());
        out[first + 3..first + 6].copy_from_slice(state.omega_body.cross(&part(x, first + 3)).as_slice());
    }
    out
}

/// The states after changes of place and of velocities.
fn changed(steady: &SteadyState, place: &[f64], velocity: &[f64]) -> Vec<MotionState> {
    let of_body = |(body, state): (usize, MotionState)| {
        let own = steady.linear.coordinates_of(body);
        let attitude = state.attitude.advanced_by(&part(place, own.start + 3));
        let of_origin = state.attitude.to_body(&state.velocity_global) + part(velocity, own.start);
        let modes = own.start + 6..own.end;
        MotionState {
            origin_global: state.origin_global + state.attitude.to_global(&part(place, own.start)),
            attitude,
            velocity_global: attitude.to_global(&of_origin),
            omega_body: state.omega_body + part(velocity, own.start + 3),
            modal_displacement: state
                .modal_displacement
                .iter()
                .zip(&place[modes.clone()])
                .map(|(q, d)| q + d)
                .collect(),
            modal_velocity: velocity[modes].to_vec(),
            ..state
        }
    };
    steady.states().into_iter().enumerate().map(of_body).collect()
}

/// Two bars in a weld, the first on a hinge that a drive turns, both bent far by forces that turn with them: at rest in their spin.
fn bent_pair() -> String {
    let push = |amplitude: f64, frame: &str| {
        format!(
            "loads = [{{ kind = 'force', at = {:?}, direction = [0.1, 0.5, -1], amplitude = {amplitude:e}, frame = '{frame}' }}]\n",
            tip().as_slice()
        )
    };
    let end = "end = { box = [[0.999999, -1, -1], [1.000001, 1, 1]] }";
    let modes = "flexible = 6, damping_ratio = 0.01, large = [1, 2], following = 3";
    body("a", MATERIAL.young_modulus, modes, &(format!("markers = {{ {ROOT}, {end} }}\n") + &push(force(0.1), "body")))
        + &body(
            "b",
            MATERIAL.young_modulus,
            modes,
            &(format!("markers = {{ {ROOT} }}\ninitial = {{ position = [1, 0, 0] }}\n")
                + &push(force(0.03), "material")),
        )
        + "[[joints]]\nname = 'shaft'\nkind = 'revolute'\nbetween = ['ground', 'a.root']\naxis = [0, 0, 1]\n\
           drive = { amplitude = 3.0, history = { kind = 'expression', formula = 't' } }\n\
           [[joints]]\nname = 'weld'\nkind = 'fixed'\nbetween = ['a.end', 'b.root']\n"
}

/// Accelerations below these are not looked at in part, since the differences have rounding of the run's forces: by a unit velocity in a
/// coordinate, 1/s, and by a unit place, 1/s². The slowest and least damped motions, and those that nothing resists, are below them.
const LEAST_RATES: [f64; 2] = [1.0, 100.0];

/// Independent reference: central differences of the accelerations that the equations of the run give.
#[test]
fn linear_equations_of_bent_bars_are_those_of_differences_of_the_run() {
    let directory = with_bar();
    let built = built(directory.path(), &whole(&bent_pair())).unwrap();
    let motion = motion(&built);
    let system = motion.system();
    for speed in [0.0, 3.0] {
        let root = motion.joint_axis(0).0;
        let spin = CommonSpin { omega_global: Vector3::z() * speed, point_global: root };
        let steady = motion.steady_state(&spin).unwrap();
        let linear = &steady.linear;
        // The first shaft holds all turns of its root: the mean axes of a bar turn as the bars before it bend, and half of it.
        let bent: Vec<f64> =
            steady.states().iter().map(|state| state.attitude.angle_to(&Attitude::identity())).collect();
        let (n, size) = (linear.basis.nrows(), linear.size());
        let norm = |list: &[f64]| list.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut worst = 0.0_f64;
        for (of_velocity, k) in [false, true].into_iter().flat_map(|of| (0..size).map(move |k| (of, k))) {
            let direction: Vec<f64> = (0..n).map(|i| linear.basis[(i, k)]).collect();
            let step = if of_velocity { 1e-3 } else { 1e-5 / linear.stiffness[(k, k)].abs().sqrt().max(10.0) };
            let mut found = vec![0.0; n];
            for sign in [1.0, -1.0] {
                let scaled: Vec<f64> = direction.iter().map(|x| sign * step * x).collect();
                let moved = match of_velocity {
                    true => changed(&steady, &vec![0.0; n], &scaled),
                    false => changed(&steady, &scaled, &convected(&steady, &scaled)),
                };
                let of = accelerations(system, &moved);
                found.iter_mut().zip(&of).for_each(|(sum, a)| *sum += sign * a / (2.0 * step));
            }
            let rates: Vec<f64> = (0..size)
                .map(|i| -if of_velocity { linear.damping[(i, k)] } else { linear.stiffness[(i, k)] })
                .collect();
            let mut expected: Vec<f64> =
                (0..n).map(|i| (0..size).map(|j| linear.basis[(i, j)] * rates[j]).sum::<f64>()).collect();
            if of_velocity {
                expected.iter_mut().zip(convected(&steady, &direction)).for_each(|(a, more)| *a += more);
            }
            let off: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
            let relative = norm(&off) / (norm(&expected) + LEAST_RATES[usize::from(!of_velocity)]);
            if relative > 1e-7 {
                println!("velocity {of_velocity}, coordinate {k}: {relative:e} of {:e}", norm(&expected));
            }
            worst = worst.max(relative);
        }
        assert!(bent.iter().all(|turn| *turn > 0.1), "{bent:?}");
        println!("at {speed} rad/s: off by {worst:e}; {size} coordinates, bars turned by bending by {bent:.3?} rad");
        assert!(worst < 1e-7, "{worst:e}");
    }
}

/// Conserved: a run that begins in a mode about the bent rest with a small amplitude goes on as exp(λt).
#[test]
fn a_bent_bar_rings_down_as_its_mode_says() {
    let directory = with_bar();
    let modes = "flexible = 8, damping_ratio = 0.01, large = [1, 2], following = 3";
    let built = built(directory.path(), &whole(&cantilever(modes, force(0.15)))).unwrap();
    let motion = motion(&built);
    let steady = motion.steady_state(&CommonSpin::REST).unwrap();
    let mode = &steady.linear.vibrations().unwrap().modes[0];
    let amplitude = 1e-4 / mode.motion.iter().map(|x| x.norm()).fold(0.0, f64::max);
    let time = 1.2 * std::f64::consts::TAU / mode.circular_frequency();
    type Complex = nalgebra::Complex<f64>;
    let places = |phase: Complex| {
        let of = |sign: f64| {
            let along = |of: &dyn Fn(Complex) -> Complex| -> Vec<f64> {
                mode.motion.iter().map(|x| (of(Complex::new(x.re, x.im)) * phase * (sign * amplitude)).re).collect()
            };
            let lambda = Complex::new(mode.eigenvalue.re, mode.eigenvalue.im);
            let start = changed(&steady, &along(&|x| x), &along(&|x| x * lambda));
            let mut motion = SystemMotion::new(motion.system().clone(), &start).unwrap();
            motion.assemble().unwrap();
            let bent = |motion: &SystemMotion| motion.state(0).unwrap().modal_displacement[0];
            let first = bent(&motion);
            motion.advance(time, 1e-10, &mut 1e-3).unwrap();
            [first, bent(&motion)]
        };
        let [ahead, back] = [1.0, -1.0].map(of);
        [0, 1].map(|k: usize| 0.5 * (ahead[k] - back[k]))
    };
    let [real, imaginary] = [Complex::new(1.0, 0.0), Complex::new(0.0, -1.0)].map(places);
    let [first, last] = [0, 1].map(|k: usize| Complex::new(real[k], imaginary[k]));
    let found = (last / first).ln();
    let expected = Complex::new(mode.eigenvalue.re, mode.eigenvalue.im) * time;
    let turn = std::f64::consts::TAU;
    let off = [found.re - expected.re, (found.im - expected.im + 1e-2).rem_euclid(turn) - 1e-2];
    println!("{}: off by {off:?} after {time}", mode.eigenvalue);
    assert!(off.iter().all(|off| off.abs() < 1e-4 * expected.norm()), "{off:?}");
}

/// Conserved: rest. A relaxed start of a bar that a force bends far stays where it is; one that is not relaxed swings to twice the deflection.
#[test]
fn a_relaxed_start_of_a_bent_bar_stays_at_rest() {
    let directory = with_bar();
    let built = built(directory.path(), &whole(&cantilever(LARGE, force(0.2)))).unwrap();
    let swing = |relaxed: bool| {
        let mut simulation = built.start(StepControl::Tolerance(1e-6), 0.3, 0.02, relaxed).unwrap();
        let found = rows(&mut simulation, 1).unwrap();
        let place = |row: &Vec<Observation>| row[0].points[0].displacement;
        let first = place(&found[0]);
        (first, found.iter().map(|row| (place(row) - first).norm()).fold(0.0, f64::max))
    };
    let [(rest, relaxed), (_, rough)] = [true, false].map(swing);
    println!("at {rest}: moves by {relaxed:e}, unrelaxed by {rough}");
    assert!(rest.z < -0.17 && rest.x < -0.01, "{rest}");
    assert!(relaxed < 1e-7 && rough > 0.2, "{relaxed:e} {rough}");
}

#[test]
fn a_relaxed_start_that_finds_no_rest_says_so() {
    let directory = with_bar();
    let text = whole(&cantilever("flexible = 6, large = 1, following = 3", force(100.0)));
    let built = built(directory.path(), &text).unwrap();
    let error = built.start(StepControl::Tolerance(1e-6), 0.3, 0.02, true).err().unwrap().to_string();
    assert!(error.contains("find no shape in which they are at rest") && error.contains("relaxed = false"), "{error}");
}
