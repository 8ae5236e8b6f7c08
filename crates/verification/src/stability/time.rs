//! Time: steps too long, loads that jump, pulse and resonate, and loads on modes much faster than the step.
//!
//! A load on a single mode, without a resultant, leaves a body at rest in its place: the mode is then an oscillator
//! `q̈ + 2ζω q̇ + ω² q = f(t)` with a closed form, for every scheme.

use std::f64::consts::TAU;
use std::sync::Arc;

use dynamics::{
    BodyField, Expression, FieldLoad, History, Initial, LoadFrame, Method, PointForce, SetupError, SharedLoad, Table,
};
use nalgebra::Vector3;
use reduced_body::ReducedBody;

use crate::stability::Bound::{Refused, Within};
use crate::stability::bodies::{ElasticBody, changed, cluster, spinning};
use crate::stability::case::on;
use crate::stability::trial::{Trial, worse};
use crate::stability::{HardCase, TrialOutcome};

/// Refusal of a step beyond the limit of a mode.
const MODES: &str = "beyond the stability limit";

/// The cases.
pub fn cases() -> Vec<HardCase> {
    vec![
        HardCase {
            name: "steps of ten times the limit 2.83/ω of the highest mode",
            why: "each step of Runge–Kutta would make more than 1e4 of every 1",
            body: None,
            measure: "free vibration, relative",
            run: |method, _| free_vibration(method),
            expected: [Within(1e-9), Refused(MODES), Refused(MODES), Refused(MODES)],
        },
        HardCase {
            name: "a spin of more than the scheme follows in a step",
            why: "beyond 2π a rotation vector is another one",
            body: None,
            measure: "drift",
            run: |method, _| {
                on(cluster(3).map(|e| e.body), |body| {
                    Trial::free(body, spinning(body, [300.0, 400.0, 1e3], 0.01), 1e-2, 1.0).drift(method)
                })
            },
            expected: [
                Refused("too long for a spin"),
                Refused("within a step"),
                Refused("within a step"),
                Refused("within a step"),
            ],
        },
        HardCase {
            name: "a load that jumps in the middle of a step",
            why: "a step across a jump is of first order",
            body: None,
            measure: "modal coordinate over its peak",
            run: |method, _| {
                let jump = 0.123_456;
                oscillator(|_| (History::Step { at: jump }, Exact(step_response, jump)), 0.1, 20.0 * TAU, method)
            },
            expected: [Within(1e-9), Within(1e-4), Within(1e-4), Within(1e-4)],
        },
        HardCase {
            name: "a pulse of 2e-6 s in steps of 5e-3 s",
            why: "between the stages nothing can be seen of it",
            body: None,
            measure: "modal coordinate over its peak",
            run: |method, _| {
                let pulse = History::HalfSine { start: 0.05, duration: PULSE };
                oscillator(|_| (pulse.clone(), Exact(pulse_response, 0.05)), 0.05, 20.0 * TAU, method)
            },
            expected: [Within(1e-4), Within(1e-4), Within(5e-2), Within(1e-4)],
        },
        HardCase {
            name: "a spike of 2e-6 s in a table, in steps of 5e-3 s",
            why: "between the stages nothing can be seen of it",
            body: None,
            measure: "modal coordinate over its peak",
            run: |method, _| {
                let rows = Table::new(vec![0.05, 0.05 + 0.5 * PULSE, 0.05 + PULSE], vec![0.0, 1.0, 0.0]);
                with_history(rows.map(History::Table), Exact(spike_response, 0.05), method)
            },
            expected: [Within(1e-4), Within(1e-4), Within(5e-2), Within(1e-4)],
        },
        HardCase {
            name: "a spike of 2e-6 s in a formula, its place named by discontinuities, in steps of 5e-3 s",
            why: "a formula does not tell where it changes; its law between two discontinuities is sampled before the run",
            body: None,
            measure: "modal coordinate over its peak",
            run: |method, _| {
                let formula =
                    Expression::new("exp(-((t - 0.05)/2e-7)^2)", vec![0.05 - 0.5 * PULSE, 0.05 + 0.5 * PULSE]);
                with_history(formula.map(History::Expression), Exact(bell_response, 0.05 - 0.5 * PULSE), method)
            },
            expected: [Within(1e-4), Within(1e-4), Within(5e-2), Within(1e-4)],
        },
        HardCase {
            name: "a bell curve of 20 ms, in steps of 2 ms, from rest",
            why: "before it is felt, the energy grows by a factor of up to 2e4 a step, which no account of the work follows",
            body: None,
            measure: "gap in the balance of energy afterwards, relative to the energy",
            run: |method, _| bell(method),
            expected: [Within(1e-3), Within(1e-3), Within(1e-2), Within(1e-3)],
        },
        HardCase {
            name: "a formula of eight cycles a step: sin(1e4*t) in steps of 5e-3 s",
            why: "the stages see a slow swing that is not there",
            body: None,
            measure: "modal coordinate over its peak",
            run: |method, _| {
                let formula = Expression::new("sin(1e4*t)", vec![]);
                with_history(formula.map(History::Expression), Exact(fast_sine_response, 0.0), method)
            },
            expected: [Within(1e-3), Within(1e-3), Within(5e-2), Within(1e-3)],
        },
        HardCase {
            name: "a formula that jumps within a step where no discontinuity is named",
            why: "a step across a jump is of first order",
            body: None,
            measure: "modal coordinate over its peak",
            run: |method, _| {
                let formula = Expression::new("(1 + sign(t - 0.123456))/2", vec![]);
                with_history(formula.map(History::Expression), Exact(step_response, 0.123_456), method)
            },
            expected: [Within(1e-3), Within(1e-3), Within(5e-3), Within(1e-3)],
        },
        HardCase {
            name: "a formula of 8e6 cycles a step: sin(1e10*t) in steps of 5e-3 s",
            why: "no step that could be taken follows it",
            body: None,
            measure: "–",
            run: |method, _| {
                let formula = Expression::new("sin(1e10*t)", vec![]);
                with_history(formula.map(History::Expression), Exact(step_response, 0.0), method)
            },
            expected: [Refused("changes too fast"); 4],
        },
        HardCase {
            name: "1000 cycles at a natural frequency without damping",
            why: "the amplitude grows with every cycle, and so does every error of phase",
            body: None,
            measure: "modal coordinate over its peak",
            run: |method, extent| {
                let cycles = extent.pick(method, 100, 1000);
                let load = |omega: f64| {
                    let frequency = omega / TAU;
                    (History::Sine { frequency, phase: 0.0, start: 0.0, duration: None }, Exact(resonance, 0.0))
                };
                oscillator(load, TAU / 100.0, cycles * TAU, method)
            },
            expected: [Within(1e-6), Within(1e-2), Within(1e-2), Within(1e-2)],
        },
        HardCase {
            name: "a static load switched on, in steps of 0.2/ω",
            why: "the answer must be K⁻¹f once the vibration has died",
            body: None,
            measure: "modal coordinates at the end over K⁻¹f",
            run: |method, _| settled(0.2, method),
            expected: [Within(1e-9), Within(1e-9), Within(1e-9), Within(1e-9)],
        },
        HardCase {
            name: "a static load switched on, in steps of 1000/ω",
            why: "the vibration is over within a thousandth of a step",
            body: None,
            measure: "modal coordinates at the end over K⁻¹f",
            run: |method, _| settled(1000.0, method),
            expected: [Within(1e-9), Refused(MODES), Refused(MODES), Refused(MODES)],
        },
        HardCase {
            name: "a follower force on a point of a tumbling body, stiff in its modes",
            why: "it feeds energy into the tumbling without end, while the modes swing hundreds of times in a turn",
            body: None,
            measure: "gap in the balances of energy and angular momentum",
            run: |method, _| follower(method),
            expected: [Within(1e-9), Within(1e-7), Refused("the attitude is lost"), Within(1e-2)],
        },
    ]
}

/// Length of the short pulse.
const PULSE: f64 = 2e-6;

/// q(t) of `q̈ + ω² q = f` for the load, from its beginning.
#[derive(Clone, Copy)]
struct Exact(fn(f64, f64) -> f64, f64);

fn step_response(omega: f64, t: f64) -> f64 {
    (1.0 - (omega * t).cos()) / (omega * omega)
}

/// After a half-sine of a duration that is nothing against the period: an impulse 2/π of its length, at its middle.
fn pulse_response(omega: f64, t: f64) -> f64 {
    2.0 / std::f64::consts::PI * PULSE / omega * (omega * (t - 0.5 * PULSE)).sin()
}

/// After a triangle of the same length: half of it at its middle.
fn spike_response(omega: f64, t: f64) -> f64 {
    0.5 * PULSE / omega * (omega * (t - 0.5 * PULSE)).sin()
}

/// After a bell curve of a tenth of that length, all but 1e-11 of it within it.
fn bell_response(omega: f64, t: f64) -> f64 {
    std::f64::consts::PI.sqrt() * 0.1 * PULSE / omega * (omega * (t - 0.5 * PULSE)).sin()
}

/// To sin(1e4 t) from rest.
fn fast_sine_response(omega: f64, t: f64) -> f64 {
    const FAST: f64 = 1e4;
    ((FAST * t).sin() - FAST / omega * (omega * t).sin()) / (omega * omega - FAST * FAST)
}

fn resonance(omega: f64, t: f64) -> f64 {
    let angle = omega * t;
    0.5 * (angle.sin() - angle * angle.cos()) / (omega * omega)
}

/// Modal force: so small that the modes do not see each other.
const FORCE: f64 = 1e-6;

/// A force on one mode, fixed in the body, without force or moment on the whole.
fn on_mode(body: &ReducedBody, mode: usize, history: History) -> SharedLoad {
    let nf = body.flexible();
    let mut modal = vec![0.0; 6 + nf];
    modal[6 + mode] = FORCE;
    let field = BodyField {
        force_body: Vector3::zeros(),
        moment_body: Vector3::zeros(),
        modal,
        force_change: Vec::new(),
        load_stiffness: Vec::new(),
        second_order: None,
        moment_change: vec![Vector3::zeros(); nf],
    };
    Arc::new(FieldLoad { field, history })
}

/// The highest mode of the cluster, set free.
fn free_vibration(method: Method) -> TrialOutcome {
    const AMPLITUDE: f64 = 1e-3;
    on(cluster(6).map(|e| e.body), |body| {
        let last = body.flexible() - 1;
        let omega = body.circular_frequencies[last];
        let step = 28.3 / omega;
        let mut initial = Initial::at_rest(body.flexible());
        initial.modal_displacement[last] = AMPLITUDE;
        Trial::free(body, initial, step, 1000.0 * step)
            .largest(method, |_, row| (row.modal_displacement[last] / AMPLITUDE - (omega * row.time).cos()).abs())
    })
}

/// The softest mode of the cluster, at ω, under a load that is given by ω, in steps and to an end in parts of 1/ω.
fn oscillator(load: impl Fn(f64) -> (History, Exact), step: f64, end: f64, method: Method) -> TrialOutcome {
    on(cluster(6).map(|e| e.body), |body| {
        let omega = body.circular_frequencies[0];
        let (history, Exact(response, begin)) = load(omega);
        let loads = vec![on_mode(body, 0, history)];
        let trial = Trial::free(body, Initial::at_rest(body.flexible()), step / omega, end / omega);
        let (mut peak, mut most) = (0.0_f64, 0.0_f64);
        let outcome = Trial { loads, rows: 997, ..trial }.largest(method, |_, row| {
            // Not within a pulse.
            let since = row.time - begin;
            let expected = if since > PULSE { response(omega, since) } else { 0.0 };
            peak = peak.max(expected.abs());
            most = worse(most, (row.modal_displacement[0] / FORCE - expected).abs());
            0.0
        });
        match outcome {
            TrialOutcome::Ran(ran) => TrialOutcome::Ran(worse(ran, most / peak)),
            refused => refused,
        }
    })
}

/// [`oscillator`] in steps of 0.05/ω, about 5 ms, for five turns of the mode.
fn with_history(history: Result<History, SetupError>, exact: Exact, method: Method) -> TrialOutcome {
    match history {
        Ok(history) => oscillator(|_| (history.clone(), exact), 0.05, 5.0 * TAU, method),
        Err(refusal) => TrialOutcome::Refused(refusal.to_string()),
    }
}

/// A bell curve on the softest mode of the cluster.
fn bell(method: Method) -> TrialOutcome {
    let formula = match Expression::new("exp(-((t - 0.5)/0.02)^2)", vec![]) {
        Ok(formula) => formula,
        Err(refusal) => return TrialOutcome::Refused(refusal.to_string()),
    };
    on(cluster(6).map(|e| e.body), |body| {
        let loads = vec![on_mode(body, 0, History::Expression(formula))];
        let trial = Trial::free(body, Initial::at_rest(body.flexible()), 2e-3, 1.0);
        Trial { loads, ..trial }.largest(method, |first, row| {
            let gap = (row.energy_balance() - first.energy_balance()).abs();
            if row.time < 0.6 { 0.0 } else { gap / row.energy() }
        })
    })
}

/// All modes under a constant load from the beginning on, half damped, in steps of `turn`/ω of the highest one.
fn settled(turn: f64, method: Method) -> TrialOutcome {
    on(cluster(6).map(|e| e.body), |body| {
        let nf = body.flexible();
        let omega = &body.circular_frequencies;
        let step = turn / omega[nf - 1];
        let trial = Trial::free(body, Initial::at_rest(nf), step, (200.0 / omega[0]).max(20.0 * step));
        let loads = (0..nf).map(|k| on_mode(body, k, History::Constant)).collect();
        Trial { loads, damping_ratios: vec![0.5; nf], rows: 4, ..trial }.largest(method, |first, row| {
            if row.time < 0.99 * (200.0 / omega[0]) || row.time == first.time {
                return 0.0;
            }
            row.modal_displacement.iter().zip(omega).map(|(q, w)| (q / FORCE * w * w - 1.0).abs()).fold(0.0, f64::max)
        })
    })
}

fn follower(method: Method) -> TrialOutcome {
    match cluster(6) {
        Ok(mut elastic) => {
            elastic.body = changed(&elastic.body, |body| body.circular_frequencies.iter_mut().for_each(|w| *w *= 50.0));
            let ElasticBody { body, .. } = &elastic;
            let force = Vector3::new(0.1, 0.4, -0.2);
            let history = History::Ramp { start: 0.0, duration: 1.0 };
            let load = PointForce { point: elastic.point(0), force, frame: LoadFrame::Body, turning: None, history };
            let trial = Trial::free(body, spinning(body, [0.3, -0.2, 0.5], 0.0), 1e-3, 20.0);
            let loads: Vec<SharedLoad> = vec![Arc::new(load)];
            Trial { loads, damping_ratios: vec![0.05; 6], ..trial }.drift(method)
        }
        Err(refusal) => TrialOutcome::Refused(refusal),
    }
}
