//! Motion: long, fast, slow, far away, and through the unstable axis.

use std::f64::consts::TAU;

use dynamics::{Initial, Method};
use nalgebra::Vector3;
use reduced_body::ReducedBody;
use rigid_kin::{Attitude, Inertia, TorqueFreeMotion, euler_angular_acceleration};

use crate::stability::Bound::{Refused, Within};
use crate::stability::bodies::{CLUSTER, cluster, rigid, spinning, truss};
use crate::stability::case::on;
use crate::stability::trial::{Trial, worse};
use crate::stability::{Extent, HardCase, TrialOutcome};

const MOMENTS: [f64; 3] = [1.0, 2.0, 3.0];
const LOST: &str = "the attitude is lost";

/// The cases.
pub fn cases() -> Vec<HardCase> {
    vec![
        HardCase {
            name: "10 000 turns at 100 rad/s, 0.1 rad a step",
            why: "rotation vectors are singular at 2π, 4π …; rounding adds up over 628 000 steps",
            body: None,
            measure: "attitude, angular velocity, ‖A Aᵀ − I‖",
            run: |method, extent| on(rigid(MOMENTS), |body| turns(body, method, extent)),
            expected: [Within(1e-9), Within(1e-9), Refused(LOST), Within(1e-9)],
        },
        HardCase {
            name: "tumbling through the unstable axis, 100 flips, rigid",
            why: "each flip starts from an error that grows exponentially",
            body: None,
            measure: "attitude, angular velocity",
            run: |method, extent| on(rigid(MOMENTS), |body| flips(body, method, extent)),
            expected: [Within(1e-4), Within(1e-4), Refused(LOST), Within(1e-4)],
        },
        HardCase {
            name: "tumbling through the unstable axis, flexible",
            why: "the flips shake the modes, which must give the energy back",
            body: None,
            measure: "drift",
            run: |method, extent| {
                on(cluster(6).map(|e| e.body), |body| {
                    let end = extent.pick(method, 100, 1500);
                    Trial::free(body, spinning(body, tilted(body), 0.01), 0.01, end).drift(method)
                })
            },
            expected: [Within(1e-8), Within(1e-3), Refused(LOST), Refused(LOST)],
        },
        HardCase {
            name: "1e-8 rad/s from the separatrix, a whole period",
            why: "what tells the two kinds of motion apart is the last bit of the energy: no attitude can be right",
            body: None,
            measure: "drift",
            run: |method, _| on(rigid(MOMENTS), |body| near_separatrix(body, method)),
            expected: [Within(1e-11), Within(1e-11), Refused(LOST), Within(1e-11)],
        },
        HardCase {
            name: "1e-5 rad/s from the separatrix, a whole period",
            why: "a part in 1e10 of the energy makes it another motion",
            body: None,
            measure: "attitude, angular velocity",
            run: |method, _| {
                on(rigid(MOMENTS), |body| {
                    let omega = [1e-5, 1.0, 1e-5];
                    let Some(period) = period(body, omega) else { return TrialOutcome::Ran(f64::NAN) };
                    Trial::free(body, spin(omega), 1e-3, period).off_closed_form(method)
                })
            },
            expected: [Within(1e-3), Within(1e-3), Refused(LOST), Within(1e-3)],
        },
        HardCase {
            name: "1e-12 rad a step",
            why: "sines and cosines of tiny angles cancel",
            body: None,
            measure: "attitude and angular velocity, relative to the angle turned",
            run: |method, _| on(rigid(MOMENTS), |body| tiny(body, method)),
            expected: [Within(1e-12); 4],
        },
        HardCase {
            name: "no motion at all",
            why: "a zero angle has no axis",
            body: None,
            measure: "anything that moves",
            run: |method, _| on(cluster(6).map(|e| e.body), |body| nothing(body, method)),
            expected: [Within(0.0); 4],
        },
        HardCase {
            name: "spin about each axis at 1e-6 and 1e6 rad/s, 100 turns",
            why: "squares of spins over 24 orders of magnitude; the middle axis is unstable",
            body: None,
            measure: "attitude, angular velocity",
            run: |method, _| on(rigid(MOMENTS), |body| each_axis(body, method)),
            expected: [Within(1e-9), Within(1e-9), Refused(LOST), Within(1e-9)],
        },
        HardCase {
            name: "ten million steps of a vibrating, tumbling body",
            why: "what drifts by 1e-10 a step is off by 1e-3",
            body: None,
            measure: "drift",
            run: |method, extent| {
                on(cluster(3).map(|e| e.body), |body| {
                    let end = 1e-3 * extent.pick(method, 100_000, 10_000_000);
                    Trial::free(body, spinning(body, [1.0, 2.0, 1.5], 0.05), 1e-3, end).drift(method)
                })
            },
            expected: [Within(1e-8), Within(1e-6), Refused(LOST), Refused(LOST)],
        },
        HardCase {
            name: "a body 1e6 units away from the origin of its mesh",
            why: "its shape is in the last six digits of its coordinates",
            body: None,
            measure: "attitude, modal coordinates; against the origin",
            run: |method, _| far_away(method),
            expected: [Within(1e-6); 4],
        },
        HardCase {
            name: "a body that moves at 1e6 units a second",
            why: "the kinetic energy of the whole is 1e12 times that of the rest",
            body: None,
            measure: "attitude, modal coordinates; against rest",
            run: |method, _| on(cluster(6).map(|e| e.body), |body| fast(body, method)),
            expected: [Within(1e-9), Within(1e-9), Within(1e-9), Within(1e-9)],
        },
    ]
}

fn spin(omega: [f64; 3]) -> Initial {
    Initial { omega: omega.into(), ..Initial::at_rest(0) }
}

fn turns(body: &ReducedBody, method: Method, extent: Extent) -> TrialOutcome {
    let turns = extent.pick(method, 200, 10_000);
    let end = TAU / 100.0 * turns;
    let trial = Trial::free(body, spin([0.0, 0.0, 100.0]), 1e-3, end);
    Trial { rows: 8 * turns as u32, ..trial }.off_closed_form(method)
}

/// The torque-free motion in closed form.
fn closed_form(body: &ReducedBody, omega: Vector3<f64>) -> Option<TorqueFreeMotion> {
    TorqueFreeMotion::new(&Inertia::new(body.inertia).ok()?, Attitude::identity(), omega).ok()
}

/// Its period.
fn period(body: &ReducedBody, omega: [f64; 3]) -> Option<f64> {
    closed_form(body, omega.into())?.period()
}

fn flips(body: &ReducedBody, method: Method, extent: Extent) -> TrialOutcome {
    let omega = [0.01, 1.0, 0.01];
    // Two flips in a period.
    let Some(period) = period(body, omega) else { return TrialOutcome::Ran(f64::NAN) };
    Trial::free(body, spin(omega), 2e-3, period * extent.pick(method, 5, 50)).off_closed_form(method)
}

fn near_separatrix(body: &ReducedBody, method: Method) -> TrialOutcome {
    let omega = [1e-8, 1.0, 1e-8];
    let Some(period) = period(body, omega) else { return TrialOutcome::Ran(f64::NAN) };
    Trial::free(body, spin(omega), 1e-3, period).drift(method)
}

/// A spin of 1 close to the middle axis of inertia.
fn tilted(body: &ReducedBody) -> [f64; 3] {
    let eigen = body.inertia.symmetric_eigen();
    let (low, high) = (eigen.eigenvalues.imin(), eigen.eigenvalues.imax());
    let axis = |k: usize| Vector3::from(eigen.eigenvectors.column(k));
    (axis(3 - low - high) + (axis(low) + axis(high)) * 0.01).into()
}

fn tiny(body: &ReducedBody, method: Method) -> TrialOutcome {
    let omega = Vector3::new(2e-10, -3e-10, 9e-10);
    let Ok(inertia) = Inertia::new(body.inertia) else { return TrialOutcome::Ran(f64::NAN) };
    // The next terms of both series are 1e-18 of the first. The closed form of finite turns is no help: its rounding is
    // of the size of a turn of 1.
    let alpha = euler_angular_acceleration(&Vector3::zeros(), &inertia, &omega);
    Trial::free(body, spin(omega.into()), 1e-3, 1.0).largest(method, |_, row| {
        let turn = omega * row.time + alpha * (0.5 * row.time * row.time);
        let off = row.attitude.angle_to(&Attitude::identity().advanced_by(&turn));
        let attitude = if off == 0.0 { 0.0 } else { off / turn.norm() };
        worse(attitude, (row.omega_body - omega - alpha * row.time).norm() / omega.norm())
    })
}

fn nothing(body: &ReducedBody, method: Method) -> TrialOutcome {
    let trial = Trial::free(body, Initial::at_rest(body.flexible()), 1e-3, 1.0);
    trial.largest(method, |_, row| {
        let vibration = row.modal_displacement.iter().chain(&row.modal_velocity).map(|x| x.abs()).sum::<f64>();
        row.attitude.angle_to(&Attitude::identity()) + row.energy() + vibration + row.omega_body.norm()
    })
}

fn each_axis(body: &ReducedBody, method: Method) -> TrialOutcome {
    let mut largest = 0.0;
    for axis in 0..3 {
        for speed in [1e-6, 1e6] {
            let mut omega = [0.0; 3];
            omega[axis] = speed;
            match Trial::free(body, spin(omega), 0.05 / speed, 100.0 * TAU / speed).off_closed_form(method) {
                TrialOutcome::Ran(error) => largest = worse(largest, error),
                refused => return refused,
            }
        }
    }
    TrialOutcome::Ran(largest)
}

/// The largest difference from the run of another body or start.
fn against(trial: &Trial, other: &Trial, method: Method) -> TrialOutcome {
    let mut expected = Vec::new();
    let mut scale = 0.0_f64;
    let outcome = other.largest(method, |_, row| {
        scale = row.modal_displacement.iter().fold(scale, |most, q| most.max(q.abs()));
        expected.push((row.attitude, row.modal_displacement.clone()));
        0.0
    });
    if let TrialOutcome::Refused(_) = outcome {
        return outcome;
    }
    let mut rows = expected.iter();
    trial.largest(method, |_, row| {
        let Some((attitude, modal)) = rows.next() else { return f64::NAN };
        let vibration = row.modal_displacement.iter().zip(modal).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        worse(row.attitude.angle_to(attitude), vibration / scale)
    })
}

fn far_away(method: Method) -> TrialOutcome {
    let moved = CLUSTER.map(|(at, mass)| (at.map(|x| x + 1e6), mass));
    match (cluster(6), truss(&moved, 60.0, 6)) {
        (Ok(here), Ok(there)) => {
            let trial = |body| Trial::free(body, spinning(body, [1.0, 2.0, 1.5], 0.05), 5e-3, 5.0);
            against(&trial(&there.body), &trial(&here.body), method)
        }
        (Err(refusal), _) | (_, Err(refusal)) => TrialOutcome::Refused(refusal),
    }
}

fn fast(body: &ReducedBody, method: Method) -> TrialOutcome {
    let still = spinning(body, [1.0, 2.0, 1.5], 0.05);
    let moving = Initial { velocity: Vector3::new(6e5, -8e5, 1e3), ..still.clone() };
    let trial = |initial| Trial::free(body, initial, 5e-3, 5.0);
    against(&trial(moving), &trial(still), method)
}
