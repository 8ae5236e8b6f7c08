//! Structure: frequencies that repeat or lie far apart, damping, masses and inertias of extreme proportions.

use std::f64::consts::TAU;

use dynamics::{Initial, Method};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::stability::Bound::{Refused, Within};
use crate::stability::bodies::{CLUSTER, ElasticBody, changed, cluster, rigid, spinning, truss};
use crate::stability::case::on;
use crate::stability::trial::{Trial, worse};
use crate::stability::{BodyFigure, HardCase, TrialOutcome};

/// Refusal of a step beyond the limit of a mode.
const MODES: &str = "beyond the stability limit";
const DRIFT: &str = "drift";

/// The cases.
pub fn cases() -> Vec<HardCase> {
    vec![
        HardCase {
            name: "a cube of eight equal masses",
            why: "its frequencies repeat two and three times, and any turn of a group's modes is as good as another",
            body: Some(BodyFigure {
                what: "relative gap within the groups of 1, 1, 3, 3 … frequencies",
                figure: || Ok(largest_gap_in_groups(&cube()?.body.circular_frequencies)),
                expected: Within(1e-12),
            }),
            measure: DRIFT,
            run: |method, _| on(cube().map(|e| e.body), |body| tumble(body, method)),
            expected: [Within(1e-11), Within(1e-6), Within(0.1), Within(0.1)],
        },
        HardCase {
            name: "an icosahedron of twelve equal masses",
            why: "the inertia of a sphere, whose principal axes are any, and frequencies that repeat five times",
            body: Some(BodyFigure {
                what: "difference of the principal moments, relative",
                figure: || {
                    let moments = icosahedron()?.body.inertia.symmetric_eigenvalues();
                    Ok(moments.max() / moments.min() - 1.0)
                },
                expected: Within(1e-14),
            }),
            measure: DRIFT,
            run: |method, _| on(icosahedron().map(|e| e.body), |body| tumble(body, method)),
            expected: [Within(1e-11), Within(1e-6), Within(0.1), Within(0.1)],
        },
        HardCase {
            name: "modes from 1e-3 to 1e6 Hz in one body, steps of 10 ms",
            why: "the fastest swings 10 000 times within a step, the softest not once within the run, and a step is a whole number of periods: resonance for a splitting",
            body: None,
            measure: DRIFT,
            run: |method, _| on(cluster(6).map(|e| e.body), |body| wide_spectrum(body, method)),
            expected: [Within(1e-3), Refused(MODES), Refused(MODES), Refused(MODES)],
        },
        HardCase {
            name: "damping of 0, 100 % and 500 % in one body",
            why: "at 100 % the two solutions of a mode fall together; at 500 % they are a hundred times apart",
            body: None,
            measure: "modal coordinates over the start",
            run: |method, _| damped([0.0, 1.0, 5.0, 0.0, 1.0, 5.0], 0.05, method),
            expected: [Within(1e-9), Within(1e-4), Within(1e-4), Within(1e-4)],
        },
        HardCase {
            name: "damping of 100 % and 500 %, steps of 100/ω",
            why: "at 500 % the fast solution is down to 1e-430 after a step of the highest mode, the slow one to 5e-5",
            body: None,
            measure: "modal coordinates over the start",
            run: |method, _| damped([1.0, 5.0, 1.0, 5.0, 1.0, 5.0], 100.0, method),
            expected: [Within(1e-9), Refused(MODES), Refused(MODES), Refused(MODES)],
        },
        HardCase {
            name: "a point mass of 1e6 times the rest of the body",
            why: "the body swings about a point of it that hardly moves; the rest of the masses are rounding in the sum",
            body: None,
            measure: DRIFT,
            run: |method, _| {
                let mut nodes = CLUSTER;
                nodes[0].1 = 1e6;
                on(truss(&nodes, 60.0, 6).map(|e| e.body), |body| tumble(body, method))
            },
            expected: [Within(1e-9), Within(1e-6), Within(0.1), Within(0.1)],
        },
        HardCase {
            name: "P, Q, R on a line but for 1e-7 of it",
            why: "three points on a line do not see the turn about it (the other schemes do not need them)",
            body: None,
            measure: DRIFT,
            run: |method, _| reference_points(1e-7, method),
            expected: [Within(1e-9), Within(1e-6), Refused("line"), Within(0.1)],
        },
        HardCase {
            name: "P, Q, R on a line but for 1e-4 of it",
            why: "the turn about the line is seen through differences of one part in 10 000",
            body: None,
            measure: DRIFT,
            run: |method, _| reference_points(1e-4, method),
            expected: [Within(1e-9), Within(1e-6), Within(0.1), Within(0.1)],
        },
        HardCase {
            name: "the inertia of a rod: principal moments 1e-8, 1, 1 + 1e-8",
            why: "a small moment about the axis makes fast spins; J⁻¹ spans eight orders of magnitude",
            body: None,
            measure: "attitude, angular velocity",
            run: |method, _| {
                on(rigid([1e-8, 1.0, 1.0 + 1e-8]), |body| {
                    let initial = Initial { omega: Vector3::new(10.0, 1.0, 0.5), ..Initial::at_rest(0) };
                    Trial::free(body, initial, 1e-3, 10.0).off_closed_form(method)
                })
            },
            expected: [Within(1e-6), Within(1e-6), Refused("the attitude is lost"), Within(1e-6)],
        },
        HardCase {
            name: "the inertia of a sphere but for 1e-12",
            why: "the differences of the moments, which drive Euler's equations, are rounding",
            body: None,
            measure: "attitude, angular velocity",
            run: |method, _| {
                on(rigid([1.0, 1.0 + 1e-12, 1.0 - 1e-12]), |body| {
                    let initial = Initial { omega: Vector3::new(1.0, 2.0, -1.5), ..Initial::at_rest(0) };
                    Trial::free(body, initial, 1e-3, 10.0).off_closed_form(method)
                })
            },
            expected: [Within(1e-10), Within(1e-10), Within(0.5), Within(1e-10)],
        },
    ]
}

/// A body that tumbles at a twentieth of its lowest frequency and vibrates with a hundredth of that energy, in steps of
/// 0.1/ω of its highest mode, for some periods of the lowest.
pub(crate) fn tumble(body: &ReducedBody, method: Method) -> TrialOutcome {
    let (trial, _) = tumbling(body);
    trial.drift(method)
}

/// The trial of [`tumble`], and the size of its modal velocities.
fn tumbling(body: &ReducedBody) -> (Trial<'_>, f64) {
    let omegas = &body.circular_frequencies;
    let lowest = omegas.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = omegas.iter().copied().fold(0.0, f64::max);
    let omega = Vector3::new(1.0, 2.0, 1.5).normalize() * (0.05 * lowest);
    let vibration = 0.1 * (omega.dot(&(body.inertia * omega)) / omegas.len() as f64).sqrt();
    let trial = Trial::free(body, spinning(body, omega.into(), vibration), 0.1 / highest, 50.0 / lowest);
    (trial, vibration)
}

fn cube() -> Result<ElasticBody, String> {
    let corners: [[f64; 3]; 8] = std::array::from_fn(|k| [k & 1, k >> 1 & 1, k >> 2].map(|bit| bit as f64));
    truss(&corners.map(|at| (at, 1.0)), 100.0, 12)
}

fn icosahedron() -> Result<ElasticBody, String> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut nodes = Vec::new();
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        nodes.extend([([0.0, a, b], 1.0), ([a, b, 0.0], 1.0), ([b, 0.0, a], 1.0)]);
    }
    truss(&nodes, 100.0, 12)
}

/// The largest relative gap between neighbours that are closer than 1e-6: frequencies that should be one.
fn largest_gap_in_groups(frequencies: &[f64]) -> f64 {
    let gaps = frequencies.windows(2).map(|pair| pair[1] / pair[0] - 1.0).filter(|gap| *gap < 1e-6);
    // None at all would be a cube without its symmetry.
    gaps.reduce(f64::max).unwrap_or(f64::NAN)
}

fn wide_spectrum(body: &ReducedBody, method: Method) -> TrialOutcome {
    let frequencies = [1e-3, 1e-1, 1e1, 1e3, 1e5, 1e6].map(|hertz| TAU * hertz).to_vec();
    let body = changed(body, |body| body.circular_frequencies = frequencies);
    let initial = spinning(&body, [1e-4, 2e-4, 1.5e-4], 1e-5);
    Trial::free(&body, initial, 1e-2, 100.0).drift(method)
}

/// Modes set free from rest, so small that they do not see each other, in steps of `turn`/ω of the highest damped rate.
fn damped(ratios: [f64; 6], turn: f64, method: Method) -> TrialOutcome {
    const AMPLITUDE: f64 = 1e-9;
    on(cluster(6).map(|e| e.body), |body| {
        let omegas = &body.circular_frequencies;
        let step = turn / omegas[5];
        let initial = Initial { modal_displacement: vec![AMPLITUDE; 6], ..Initial::at_rest(6) };
        let trial = Trial::free(body, initial, step, (10.0 * step).max(1.0));
        Trial { damping_ratios: ratios.to_vec(), ..trial }.largest(method, |_, row| {
            let errors = row.modal_displacement.iter().zip(omegas).zip(ratios);
            errors.map(|((q, omega), zeta)| (q / AMPLITUDE - free_decay(*omega, zeta, row.time)).abs()).fold(0.0, worse)
        })
    })
}

/// q(t) of `q̈ + 2ζω q̇ + ω² q = 0` from q = 1 at rest.
fn free_decay(omega: f64, zeta: f64, t: f64) -> f64 {
    if zeta < 1.0 {
        let root = (1.0 - zeta * zeta).sqrt();
        let angle = omega * root * t;
        (-zeta * omega * t).exp() * (angle.cos() + zeta / root * angle.sin())
    } else if zeta == 1.0 {
        (1.0 + omega * t) * (-omega * t).exp()
    } else {
        let root = (zeta * zeta - 1.0).sqrt();
        // ζ − √(ζ² − 1) without its cancellation.
        let (slow, fast) = ((zeta + root).recip(), zeta + root);
        (fast * (-slow * omega * t).exp() - slow * (-fast * omega * t).exp()) / (fast - slow)
    }
}

fn reference_points(off: f64, method: Method) -> TrialOutcome {
    on(cluster(3).map(|e| e.body), |body| {
        let points = [Vector3::new(-1.0, 0.0, 0.0), Vector3::new(0.0, off, 0.0), Vector3::x()];
        Trial { reference_points: points, ..tumbling(body).0 }.drift(method)
    })
}
