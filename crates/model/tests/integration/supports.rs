//! Every kind of support from a scene, and the paper's scheme on bodies that are held.

use nalgebra::Vector3;
use reduced_body::RigidMotion;

use crate::{Body, Observation, bar, build, observations, refusal};

const TIME: &str = "end = 0.02\nstep = 1e-5";

const PINS: [&str; 2] = ["kind = \"pin\"\nat = [0.0, 0.0, 0.0]", "kind = \"pin\"\nat = [0.0, 0.0, 0.0]\nradius = 6.0"];
const HINGES: [&str; 5] = [
    "kind = \"hinge\"\npoints = [[0.0, -5.0, 0.0], [0.0, 5.0, 0.0]]",
    "kind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 2.0, 0.0]",
    "kind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\nradius = 6.0",
    "kind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\nbox = [[0.0, -5.0, -5.0], [0.0, 5.0, 5.0]]",
    "kind = \"hinge\"\nat = [0.0, 0.0, 0.0]\naxis = [0.0, 1.0, 0.0]\ngroup = \"root\"",
];
const CLAMPS: [&str; 3] = [
    "kind = \"clamp\"\nat = [0.0, 0.0, 0.0]\nradius = 8.0",
    "kind = \"clamp\"\nbox = [[0.0, -5.0, -5.0], [0.0, 5.0, 5.0]]",
    "kind = \"clamp\"\ngroup = \"root\"",
];
const SLIDERS: [&str; 3] = [
    "kind = \"slider\"\ndirection = [0.0, 0.0, 1.0]\nat = [0.0, 0.0, 0.0]\nradius = 8.0",
    "kind = \"slider\"\ndirection = [0.0, 0.0, 1.0]\nbox = [[0.0, -5.0, -5.0], [0.0, 5.0, 5.0]]",
    "kind = \"slider\"\ndirection = [0.0, 0.0, 1.0]\ngroup = \"root\"",
];

fn held(constraint: &str, rest: &str, time: &str) -> Body {
    bar("flexible = 4\nstatic_correction = false", &format!("{rest}\n[[constraints]]\n{constraint}"), time)
}

#[test]
fn each_kind_leaves_its_rigid_motions() {
    let count = |constraint: &str| build(&held(constraint, "", TIME)).body.motion;
    assert_eq!(build(&bar("flexible = 4", "", TIME)).body.motion.count(), 6);
    for pin in PINS {
        assert_eq!(count(pin), RigidMotion::pin(Vector3::zeros()));
    }
    for hinge in HINGES {
        let motion = count(hinge);
        let ([], [axis], Some(point)) = (motion.translations(), motion.rotations(), motion.fixed_point()) else {
            panic!("{hinge}")
        };
        assert_eq!((point.cross(axis), *axis), (Vector3::zeros(), Vector3::y()), "{hinge}");
    }
    for clamp in CLAMPS {
        assert_eq!(count(clamp).count(), 0);
    }
    for slider in SLIDERS {
        assert_eq!(count(slider), RigidMotion::slider(Vector3::z()));
    }
    for (kind, constraint) in [HINGES[4], SLIDERS[2]].into_iter().enumerate() {
        let motion = "motion = { amplitude = 2.0, history = { kind = \"ramp\", duration = 0.01 } }";
        let driven = build(&held(&format!("{constraint}\n{motion}"), "", TIME));
        assert_eq!((kind, driven.body.motion.count()), (kind, 0));
        assert!(driven.physics.drive.is_some());
    }
}

#[test]
fn a_part_of_the_body_that_is_not_there_is_refused_with_a_help() {
    for (constraint, words) in [
        ("kind = \"pin\"\nat = [0.0, 0.0, 1.0]", "constraints[0].at"),
        ("kind = \"pin\"\nat = [0.0, 0.0, 0.0]\nradius = 0.1", "constraints[0].radius"),
        ("kind = \"hinge\"\nat = [0.0, 0.0, 1.3]\naxis = [0.0, 1.0, 0.0]", "constraints[0].axis"),
        ("kind = \"hinge\"\npoints = [[0.0, -5.0, 0.0], [0.0, 5.0, 0.1]]", "constraints[0].points"),
        ("kind = \"clamp\"\ngroup = \"roof\"", "one of"),
        ("kind = \"clamp\"\ngroup = \"bar\"", "holds every node"),
        ("kind = \"clamp\"\nbox = [[-9.0, -5.0, -5.0], [-1.0, 5.0, 5.0]]", "0 node(s)"),
    ] {
        let message = refusal(&held(constraint, "", TIME)).to_string();
        assert!(message.contains("scene.toml:") && message.contains(words), "{message}");
    }
}

/// Moving as the support lets it, vibrating, and pushed by a load that is there from the beginning.
fn moving(constraint: &str) -> String {
    let start = match constraint {
        _ if PINS.contains(&constraint) => "angular_velocity = [20.0, 30.0, 10.0]",
        _ if HINGES.contains(&constraint) => "angular_velocity = [0.0, 30.0, 0.0]",
        _ if SLIDERS.contains(&constraint) => "velocity = [0.0, 0.0, 800.0]",
        _ => "",
    };
    format!(
        "[initial]\n{start}\nmodal_velocity = [0.5, 0.2]\n[effects]\ngeometric_stiffening = false\n[[loads]]\n\
         kind = \"force\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.3, 1.0]\namplitude = 2.0"
    )
}

/// The first and the last observation.
fn ends(constraint: &str, step: f64, method: &str) -> [Observation; 2] {
    let scene = held(constraint, &moving(constraint), &format!("end = 0.01\nstep = {step:e}\n{method}"));
    let model = build(&scene);
    let mut rows = observations(&scene, &model);
    let last = rows.pop().unwrap();
    [rows.swap_remove(0), last]
}

fn apart(a: &Observation, b: &Observation) -> (f64, f64) {
    (a.attitude.angle_to(&b.attitude), (a.position_global - b.position_global).norm())
}

fn halved(coarse: f64, fine: f64) -> bool {
    (coarse / fine - 2.0).abs() < 0.1
}

/// Conserved: order 1. The paper's scheme has its rigid modes "determined by constraints": to first order it goes
/// where its fourth-order limit does, and that is the conservative answer but for what the paper leaves out of
/// deformed bodies that turn.
#[test]
fn the_scheme_of_the_paper_converges_on_held_bodies() {
    for constraint in [PINS[0], PINS[1], HINGES[0], HINGES[4], CLAMPS[2], SLIDERS[2]] {
        let [_, limit] = ends(constraint, 2e-6, "formulation = \"paper\"\nscheme = \"rkmk4\"");
        let [first, right] = ends(constraint, 1e-5, "");
        let [coarse, fine] = [1e-5, 5e-6].map(|step| {
            let [start, found] = ends(constraint, step, "scheme = \"paper\"");
            assert_eq!(apart(&start, &first), (0.0, 0.0));
            let [linear, angular] = [
                found.linear_balance_global() - start.linear_balance_global(),
                found.angular_balance_global() - start.angular_balance_global(),
            ];
            // What holds the body balances the rest.
            assert_eq!(linear.norm(), 0.0, "{constraint}");
            (apart(&found, &limit), angular.norm() / found.angular_momentum_global.norm())
        });
        let ((turned_coarse, moved_coarse), balance_coarse) = coarse;
        let ((turned_fine, moved_fine), balance_fine) = fine;
        let turns = PINS.contains(&constraint) || HINGES.contains(&constraint);
        if turns {
            // Measured: 1e-5 to 2e-5 rad and 6e-4 mm off at 1e-5 s, 2.000 and 2.001 times as much as at half of that;
            // angular momentum about what is held to 4e-5, 2.03 times as much.
            assert!(halved(turned_coarse, turned_fine) && halved(moved_coarse, moved_fine), "{constraint}: {coarse:?}");
            assert!(halved(balance_coarse, balance_fine) && balance_fine < 3e-5, "{constraint}: {balance_fine}");
        } else {
            // Without a turn it is classical RK4. Measured: 16 times as much at 1e-5 s.
            assert!(turned_fine == 0.0 && moved_coarse / moved_fine > 15.0, "{constraint}: {coarse:?} {fine:?}");
            assert!(balance_coarse.is_nan(), "a body that cannot turn has no angular momentum of its own");
        }
        let ((turned_off, moved_off), (turned, moved)) = (apart(&limit, &right), apart(&right, &first));
        // Measured: 6e-6 of the turn and 2.4e-7 of the way where it turns, 1.3e-9 where it does not.
        let bound = if turns { 2e-5 } else { 1e-8 };
        assert!(turned_off <= bound * turned && moved_off < bound * moved, "{constraint}: {turned_off} {moved_off}");
    }
}

#[test]
fn driven_bodies_are_not_the_paper_s() {
    let motion = "motion = { amplitude = 2.0, history = { kind = \"ramp\", duration = 0.01 } }";
    let scene = held(&format!("{}\n{motion}", HINGES[4]), "", &format!("{TIME}\nscheme = \"paper\""));
    let message = build(&scene).start(&scene).unwrap_err().to_string();
    assert!(message.contains("driven motion") && message.contains("conservative"), "{message}");
}

/// Constraints of the kind `support` on nodes of the bar, each with its directions.
fn supports(parts: &[(&str, &str)]) -> String {
    parts
        .iter()
        .map(|(region, directions)| {
            format!("[[constraints]]\nkind = \"support\"\ndirections = {directions}\n{region}\n")
        })
        .collect()
}

const ALL: &str = "[\"x\", \"y\", \"z\"]";
const ROOT: &str = "group = \"root\"";
/// One node on the line of the bar, and the edge of the root along y.
const MIDDLE: &str = "at = [0.0, 0.0, 0.0]\nradius = 0.1";
const EDGE: &str = "box = [[0.0, -5.0, -5.0], [0.0, 5.0, -5.0]]";

fn supported(parts: &[(&str, &str)], rest: &str) -> Body {
    bar("flexible = 4\nstatic_correction = false", &format!("{rest}\n{}", supports(parts)), TIME)
}

/// Conserved: the same frequencies by the constraint of that name.
#[test]
fn supports_leave_what_the_geometry_says() {
    // As the constraint with that name leaves it, modes and all.
    for (parts, constraint) in [
        (vec![(ROOT, ALL)], CLAMPS[2]),
        (vec![(ROOT, "[\"x\", \"y\"]")], SLIDERS[2]),
        (vec![(EDGE, ALL)], "kind = \"hinge\"\nat = [0.0, 0.0, -5.0]\naxis = [0.0, 1.0, 0.0]"),
        (vec![(MIDDLE, ALL)], PINS[0]),
    ] {
        let (found, expected) = (build(&supported(&parts, "")), build(&held(constraint, "", TIME)));
        let (of_support, of_constraint) = (found.body.motion, expected.body.motion);
        assert_eq!(of_support.to_string(), of_constraint.to_string(), "{parts:?}");
        assert!(of_support.others().is_empty());
        let close = |a: &[Vector3<f64>], b: &[Vector3<f64>]| a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-9);
        if of_support.count() == 1 {
            assert!(close(of_support.rotations(), of_constraint.rotations()), "{of_support:?}");
            assert!(close(of_support.translations(), of_constraint.translations()), "{of_support:?}");
        }
        // The root of a slider moves as one along it, where a support leaves each of its nodes free.
        let tolerance = if constraint == SLIDERS[2] { 0.01 } else { 1e-8 };
        for (a, b) in found.natural_frequencies().iter().zip(expected.natural_frequencies()) {
            assert!((a / b - 1.0).abs() < tolerance, "{parts:?}: {a} {b}");
        }
    }
    let of = |parts: &[(&str, &str)]| build(&supported(parts, "")).body.motion.to_string();
    // The nodes of the root are in the plane x = 0, so that z of them leaves the turn about y too.
    assert_eq!(of(&[(ROOT, "[\"z\"]")]), "2 translations and 2 rotations");
    assert_eq!(of(&[(ROOT, "[\"z\"]"), (EDGE, "[\"y\", \"x\"]")]), "1 rotation");
    assert_eq!(of(&[(ROOT, "[\"x\"]"), (EDGE, "[\"y\", \"z\"]")]), "no rigid motion");
}

/// Conserved: the same motion on a hinge.
#[test]
fn a_body_on_supports_moves_as_one_on_a_hinge() {
    // Gravity across a hinge of the root's lower edge.
    let gravity = "[[loads]]\nkind = \"gravity\"\ndirection = [0.0, 0.0, -1.0]\namplitude = 9810.0";
    let start = "[initial]\nangular_velocity = [0.0, 3.0, 0.0]";
    let hinge = "kind = \"hinge\"\nat = [0.0, 0.0, -5.0]\naxis = [0.0, 1.0, 0.0]";
    let of = |constraints: &str| {
        let rest = format!("{start}\n{gravity}\n{constraints}");
        let body = bar("flexible = 4\nstatic_correction = false", &rest, "end = 0.02\nstep = 1e-3");
        observations(&body, &build(&body))
    };
    let by_support: Vec<Observation> = of(&supports(&[(EDGE, ALL)]));
    let by_hinge: Vec<Observation> = of(&format!("[[constraints]]\n{hinge}"));
    let (a, b) = (by_support.last().unwrap(), by_hinge.last().unwrap());
    assert!(a.attitude.angle_to(&b.attitude) < 1e-8, "{:e}", a.attitude.angle_to(&b.attitude));
    assert!(a.attitude.angle_to(&rigid_kin::Attitude::identity()) > 0.05);
}

#[test]
fn supports_that_prevent_the_initial_motion_are_refused() {
    for (parts, lines, words) in [
        (vec![(ROOT, ALL)], "velocity = [1.0, 0.0, 0.0]", "expected 0: the supports leave the body no rigid motion"),
        (vec![(ROOT, "[\"x\", \"y\"]")], "velocity = [0.0, 1.0, 1.0]", "a multiple of [0.000000, 0.000000, 1.000000]"),
        (vec![(EDGE, ALL)], "angular_velocity = [1.0, 0.0, 0.0]", "a multiple of [0.000000, 1.000000, 0.000000]"),
        (vec![(MIDDLE, ALL)], "velocity = [0.0, 1.0, 0.0]", "leave the body 3 rotations"),
    ] {
        let message = refusal(&supported(&parts, &format!("[initial]\n{lines}"))).to_string();
        assert!(message.contains("initial.") && message.contains(words), "{message}");
    }
    let message = refusal(&supported(&[("at = [0.0, 0.0, 900.0]\nradius = 0.1", ALL)], "")).to_string();
    assert!(message.contains("constraints[0]") && message.contains("one node or more"), "{message}");
    let message = refusal(&supported(&[(ROOT, ALL), ("group = \"rot\"", ALL)], "")).to_string();
    assert!(message.contains("constraints[1].group"), "{message}");
}

/// Conserved: the forces of supports sum to the reaction. A pressure turns with its surface, and its resultant with
/// it. Each support has its share of that, with stiffening by stress and without: before, 4 % of the force were
/// missing here.
#[test]
fn the_forces_of_supports_sum_to_the_reaction_under_a_pressure_on_a_bent_surface() {
    let tip = "box = [[200.0, -5.0, -5.0], [200.0, 5.0, 5.0]]";
    let pressure =
        "[[loads]]\nkind = \"pressure\"\ngroup = \"top\"\namplitude = 30.0\nhistory = { kind = \"constant\" }\n";
    for effects in
        ["", "[effects]\ngeometric_stiffening = false\n", "[effects]\nlarge_deflection = true\nrefuse = false\n"]
    {
        let rest = format!("{pressure}{effects}{}", supports(&[(ROOT, ALL), (tip, "[\"y\", \"z\"]")]));
        let body = bar("flexible = 4", &rest, "end = 2e-3\nstep = 2e-6\n[output]\ninterval = 1e-4");
        let model = build(&body);
        let rows = model.supports.as_ref().unwrap();
        let (mut largest, mut off) = (0.0_f64, 0.0_f64);
        for now in observations(&body, &model) {
            let sum: Vector3<f64> = rows.at(&now).iter().map(|[force, _]| force).sum();
            largest = largest.max(now.reaction.force_body.norm());
            off = off.max((sum - now.reaction.force_body).norm());
        }
        println!("{effects:?}: {:.1e} of the largest", off / largest);
        assert!(off < 1e-9 * largest, "{effects}: {off} of {largest}");
    }
}
