//! Time of the frequency response of 40 modes, 3 inputs, 20 outputs at 10 000 frequencies, alone and coupled by gyroscopic forces:
//! `cargo bench -p linear --bench response`. The shortest of several runs, all cores.

use std::time::Instant;

use linear::faer::Mat;
use linear::{Channel, Damping, Output, Rate, SecondOrder};

const MODES: usize = 40;
const INPUTS: usize = 3;
const OUTPUTS: usize = 20;
const FREQUENCIES: u32 = 10_000;
const RUNS: usize = 7;

fn main() -> Result<(), linear::LinearError> {
    let frequencies: Vec<f64> = (0..FREQUENCIES).map(|k| 0.01 * f64::from(k)).collect();
    for (name, gyroscopic) in [("modes alone", 0.0), ("modes coupled", 0.3)] {
        let model = model(gyroscopic);
        let mut best = f64::INFINITY;
        for _ in 0..RUNS {
            let started = Instant::now();
            let response = model.frequency_response(&frequencies, Damping::OfEquations)?;
            best = best.min(started.elapsed().as_secs_f64());
            assert_eq!(response.values.len(), frequencies.len());
        }
        println!("{name:>16}: {:.1} ms", 1e3 * best);
    }
    Ok(())
}

fn model(gyroscopic: f64) -> SecondOrder {
    let wave = |i: usize, j: usize| ((3 * i + 7 * j + 1) as f64).sin();
    let omega = |k: usize| 5.0 + 12.0 * k as f64;
    let channel = |name: String| Channel::new(name, "");
    let output = |i: usize| {
        let rates = [Rate::Place, Rate::Velocity, Rate::Acceleration];
        Output::new(channel(format!("y{i}")), rates[i % 3], (0..MODES).map(|k| wave(i, k)).collect())
    };
    SecondOrder {
        stiffness: Mat::from_fn(MODES, MODES, |i, j| if i == j { omega(i).powi(2) } else { 0.0 }),
        damping: Mat::from_fn(MODES, MODES, |i, j| match i.cmp(&j) {
            std::cmp::Ordering::Equal => 0.02 * omega(i),
            std::cmp::Ordering::Less => gyroscopic * wave(i, j),
            std::cmp::Ordering::Greater => -gyroscopic * wave(j, i),
        }),
        forces: Mat::from_fn(MODES, INPUTS, |i, j| wave(j, i)),
        inputs: (0..INPUTS).map(|j| channel(format!("u{j}"))).collect(),
        outputs: (0..OUTPUTS).map(output).collect(),
        coordinates: (0..MODES).map(|k| channel(format!("mode{k}"))).collect(),
    }
}
