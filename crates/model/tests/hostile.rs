//! Scenes whose numbers are as bad as numbers can be: each is refused with a message, or begins to move with finite
//! numbers only. Never a panic, never memory by what a number claims.

use std::fmt::Display;
use std::path::Path;

use dynamics::{Observation, Reached};
use model::Model;
use scene::Body;

const UNITS: &str = "title = \"t\"\nunits = { length = \"m\", mass = \"kg\", time = \"s\" }\n";
const STONE: &str = "[body.rigid]\nmass = 2.0\ncenter_of_mass = [1.0, 2.0, 3.0]\n\
                     inertia = [[5.0, 0.5, 0.2], [0.5, 6.0, -0.3], [0.2, -0.3, 4.0]]\nabout = [1.0, 2.0, 3.5]\n";
const CUBE: &str = "[body]\nmesh = \"../../fem-tet10/tests/data/cube_groups.msh\"\n\
                    material = { young_modulus = 7e4, poisson_ratio = 0.33, density = 2.7e-9 }\n\
                    point_masses = [{ at = [5.0, 5.0, 5.0], mass = 1e-7, spread = 20.0 }]\n";
const PUSH: &str =
    "[[loads]]\nkind = \"force\"\nat = [10.0, 10.0, 10.0]\ndirection = [1.0, 2.0, 3.0]\namplitude = 4.0\n";

/// Scenes that run, with every key that is a number and every kind of history.
fn scenes() -> Vec<String> {
    let histories = [
        "{ kind = \"step\", at = 0.001 }",
        "{ kind = \"ramp\", start = 0.0001, duration = 0.003 }",
        "{ kind = \"half-sine\", start = 0.0, duration = 0.004 }",
        "{ kind = \"sine\", frequency = 300.0, phase = 0.5, start = 0.0001, duration = 0.005 }",
        "{ kind = \"sweep\", from = 100.0, to = 500.0, start = 0.0, duration = 0.01 }",
        "{ kind = \"table\", points = [[0.0, 1.0], [0.002, -1.0], [0.004, 2.0]] }",
        "{ kind = \"expression\", formula = \"sin(2*pi*t/3.0)+exp(t*2.0)\", discontinuities = [0.002] }",
        "{ kind = \"product\", factors = [{ kind = \"sine\", frequency = 200.0 }, \
         { kind = \"table\", points = [[0.0, 1.0], [0.003, 2.0]] }] }",
    ];
    let pushed = |history: &str| format!("{PUSH}history = {history}\n");
    let all: String = histories.into_iter().map(pushed).collect();
    let step = "[time]\nend = 0.01\nstep = 1e-4\n";
    let tolerance =
        "[time]\nend = 0.01\ntolerance = 1e-4\n[output]\ninterval = 1e-3\npoints = { P = [10.0, 0.0, 0.0] }\n";
    let start = "[initial]\nvelocity = [1.0, 2.0, 3.0]\nangular_velocity = [3.0, 2.0, 1.0]\n";
    let deformed = format!("{start}modal_displacement = [1e-4, 2e-4]\nmodal_velocity = [1e-2, 0.0]\n");
    let hinge = "[[constraints]]\nkind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n";
    let driven = |history: &str| format!("motion = {{ amplitude = 5.0, history = {history} }}\n");
    let frame = "[frame]\nR = [0.0, 0.0, 0.0]\nP = [10.0, 0.0, 0.0]\nQ = [0.0, 10.0, 0.0]\n";
    let free = |modes: &str, rest: &str| format!("{UNITS}{CUBE}[modes]\n{modes}\n{deformed}{rest}");
    let mut scenes = vec![
        format!("{UNITS}{STONE}{start}{all}{step}"),
        format!("{UNITS}{STONE}{start}{frame}{PUSH}{step}formulation = \"paper\"\n"),
        format!("{UNITS}{STONE}{hinge}{PUSH}{tolerance}"),
        format!("{UNITS}{STONE}[[constraints]]\nkind = \"pin\"\nat = [0.0, 1.0, 0.0]\n{tolerance}"),
        format!(
            "{UNITS}{STONE}[[constraints]]\nkind = \"slider\"\ndirection = [0.0, 1.0, 2.0]\n{}{tolerance}",
            driven(histories[4])
        ),
        free(
            "flexible = 4\ndamping_ratio = [0.1, 0.2]",
            &format!("{}{}{step}", pushed(histories[3]), pushed(histories[5])),
        ),
        free("flexible = \"auto\"\nmost = 4\ndamping_table = [[1e4, 0.1], [1e6, 0.2]]", &format!("{PUSH}{tolerance}")),
        free(
            "flexible = 3\nrayleigh = { alpha = 10.0, beta = 1e-7 }",
            &format!("{frame}{PUSH}{step}scheme = \"rkmk4\"\n"),
        )
        .replace("step = 1e-4", "step = 1e-6"),
        free(
            "flexible = 3",
            "[[loads]]\nkind = \"pressure\"\ngroup = \"foot\"\namplitude = 2.0\n\
             [[loads]]\nkind = \"moment\"\nat = [5.0, 5.0, 5.0]\ndirection = [0.0, 1.0, 0.0]\namplitude = 3.0\nradius = 20.0\n\
             [[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0\n\
             [effects]\ngeometric_stiffening = true\ntolerance = 1e-3\n[time]\nend = 1e-3\nstep = 1e-7\nscheme = \"rkmk4\"\n\
             [output]\nevery = 2\n",
        ),
        format!(
            "{UNITS}{CUBE}[modes]\nflexible = 3\n[[constraints]]\nkind = \"clamp\"\nbox = [[-1.0, -1.0, -1.0], \
             [11.0, 11.0, 0.0]]\n[[loads]]\nkind = \"base-acceleration\"\ndirection = [1.0, 0.0, 0.0]\namplitude = 5.0\n\
             history = {}\n[effects]\nrefuse = false\n{tolerance}",
            histories[4]
        ),
    ];
    scenes.extend([histories[1], histories[5]].map(|history| {
        let hinge = format!("{hinge}radius = 12.0\n{}", driven(history));
        format!("{UNITS}{CUBE}[modes]\nflexible = 3\n{hinge}{tolerance}")
    }));
    scenes
}

/// Where the numbers stand in a text.
fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut found = Vec::new();
    let mut at = 0;
    for piece in text.split_inclusive(|c: char| " ,[]{}\n()*+/".contains(c)) {
        let word = piece.trim_end_matches(|c: char| " ,[]{}\n()*+/".contains(c));
        if word.starts_with(|c: char| c.is_ascii_digit() || c == '-') && word.parse::<f64>().is_ok() {
            found.push(at..at + word.len());
        }
        at += piece.len();
    }
    found
}

const NASTY: [&str; 22] = [
    "0.0",
    "-0.0",
    "-1.0",
    "1",
    "0.5",
    "1e-5",
    "1e-13",
    "1e-17",
    "1e-40",
    "1e-160",
    "1e-300",
    "5e-324",
    "1e5",
    "1e9",
    "1e20",
    "1e100",
    "1e160",
    "-1e200",
    "1e300",
    "1.7e308",
    "18446744073709551615",
    "1000000000000",
];

/// How a scene ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ended {
    Unread,
    Unbuilt,
    Unstarted,
    Stopped,
    Moved,
}

fn message(error: impl Display) -> String {
    let message = error.to_string();
    assert!(!message.is_empty() && message.chars().count() < 4000, "{message}");
    message
}

fn is_finite(now: &Observation) -> bool {
    let vectors = [
        now.origin_global,
        now.position_global,
        now.velocity_global,
        now.omega_body,
        now.alpha_body,
        now.linear_balance_global(),
        now.angular_balance_global(),
        now.linear_momentum_global,
        now.angular_momentum_global,
    ];
    let points = now.points.iter().flat_map(|p| [p.displacement, p.velocity, p.acceleration, p.rigid_acceleration]);
    let lists = [&now.modal_displacement, &now.modal_velocity, &now.modal_acceleration];
    let scalars = [now.time, now.kinetic_energy, now.strain_energy, now.energy_balance()];
    vectors.into_iter().chain(points).all(|v| v.iter().all(|x| x.is_finite()))
        && lists.into_iter().flatten().chain(&scalars).chain(&now.attitude.wxyz()).all(|x| x.is_finite())
}

/// Reads, builds, starts and steps a scene.
fn run(text: &str) -> (Ended, String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hostile.toml");
    let body = match Body::parse(text, path) {
        Ok(body) => body,
        Err(error) => return (Ended::Unread, message(error)),
    };
    let model = match Model::build(&body, |_| ()) {
        Ok(model) => model,
        Err(error) => return (Ended::Unbuilt, message(error)),
    };
    let numbers = model.natural_frequencies().into_iter().chain(model.damping_ratios().iter().copied());
    assert!(numbers.chain([model.body.mass]).all(f64::is_finite), "{text}");
    let mut motion = match model.start(&body) {
        Ok(motion) => motion,
        Err(error) => return (Ended::Unstarted, message(error)),
    };
    let mut now = Observation::new(model.body.flexible(), model.points.len());
    for _ in 0..5 {
        if let Err(error) = motion.observe([&mut now]) {
            return (Ended::Stopped, message(error));
        }
        assert!(is_finite(&now), "{text}\n{now:?}");
        match motion.advance(4) {
            Ok(Reached::End) => break,
            Ok(_) => {}
            Err(error) => return (Ended::Stopped, message(error)),
        }
    }
    (Ended::Moved, String::new())
}

/// Knuth's MMIX linear congruential generator: a number below `end`.
fn below(state: &mut u64, end: usize) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize % end
}

#[test]
fn bad_numbers_are_refused_or_move_with_finite_ones() {
    // What other threads hold would not be seen.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().unwrap();
    let scenes = scenes();
    let mut usual = 0;
    for text in &scenes {
        let moved = || assert_eq!(run(text), (Ended::Moved, String::new()), "{text}");
        usual = allocation_counter::measure(moved).bytes_max.max(usual);
    }
    let mut ended = [0; 5];
    let mut measured = |text: &str| {
        let held = allocation_counter::measure(|| ended[run(text).0 as usize] += 1).bytes_max;
        // Measured: 3.6 MB without what the factorization asks for as its scratch, which goes with the processor's cache.
        assert!(held < usual + (8 << 20), "{held} bytes were held for {text}, where sound scenes need {usual}");
    };
    let mut state = 1;
    for text in &scenes {
        for _ in 0..60 {
            let mut spoiled = text.clone();
            for _ in 0..=below(&mut state, 2) {
                let places = numbers(&spoiled);
                let place = places[below(&mut state, places.len())].clone();
                spoiled.replace_range(place, NASTY[below(&mut state, NASTY.len())]);
            }
            measured(&spoiled);
        }
    }
    // These were found among many more: the first made the search for modes panic.
    let heavy = scenes[10].replace("7e4", "1e100").replace("1e-7", "1000000000000");
    let push = |number: &str| scenes[0].replacen("amplitude = 4.0", &format!("amplitude = {number}"), 1);
    let fast = scenes[9].replace("to = 500.0", "to = 1e300");
    [heavy, push("1.7e308"), fast].iter().for_each(|text| measured(text));
    // No way to end is left untried. Measured: 297 unread, 92 unbuilt, 12 unstarted, 30 stopped, 292 moved.
    assert!(ended.iter().all(|count| *count > 5), "{ended:?}");
}
