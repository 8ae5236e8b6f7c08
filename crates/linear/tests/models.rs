//! Linear models of oscillators against closed forms.

use std::f64::consts::TAU;

use linear::faer::{Mat, c64};
use linear::{Channel, Damping, LinearError, Output, Quadrature, RandomInput, Rate, SecondOrder};

fn channels(count: usize) -> Vec<Channel> {
    (1..=count).map(|k| Channel::new(format!("c{k}"), "")).collect()
}

/// Oscillators of unit mass by ω and ζ, each with all inputs and seen by each output as `rows` say.
fn oscillators(omega_zeta: &[[f64; 2]], forces: &[&[f64]], rows: &[(Rate, &[f64])]) -> SecondOrder {
    let n = omega_zeta.len();
    let diagonal =
        |of: &dyn Fn(&[f64; 2]) -> f64| Mat::from_fn(n, n, |i, j| if i == j { of(&omega_zeta[i]) } else { 0.0 });
    let output = |(rate, row): &(Rate, &[f64])| Output::new(Channel::new("y", ""), *rate, row.to_vec());
    SecondOrder {
        stiffness: diagonal(&|[omega, _]| omega * omega),
        damping: diagonal(&|[omega, zeta]| 2.0 * zeta * omega),
        forces: Mat::from_fn(n, forces[0].len(), |i, j| forces[i][j]),
        inputs: channels(forces[0].len()),
        outputs: rows.iter().map(output).collect(),
        coordinates: channels(n),
    }
}

/// A small pseudo-random number in (−1, 1).
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A model of coupled, damped oscillators.
fn random_model(n: usize, m: usize, p: usize, seed: &mut u64) -> SecondOrder {
    let omega_zeta: Vec<[f64; 2]> =
        (0..n).map(|_| [10.0_f64.powf(1.0 + noise(seed)), 0.05 + 0.045 * noise(seed)]).collect();
    let forces: Vec<Vec<f64>> = (0..n).map(|_| (0..m).map(|_| noise(seed)).collect()).collect();
    let rows: Vec<Vec<f64>> = (0..p).map(|_| (0..n).map(|_| noise(seed)).collect()).collect();
    let rates = [Rate::Place, Rate::Velocity, Rate::Acceleration];
    let mut model = oscillators(
        &omega_zeta,
        &forces.iter().map(Vec::as_slice).collect::<Vec<_>>(),
        &rows.iter().enumerate().map(|(k, row)| (rates[k % 3], row.as_slice())).collect::<Vec<_>>(),
    );
    // Gyroscopic forces take and give no energy.
    for i in 0..n {
        for j in 0..i {
            let g = noise(seed);
            model.damping[(i, j)] += g;
            model.damping[(j, i)] -= g;
        }
    }
    model
}

/// Conserved: the coordinates η in a complex mode of a pole s obey (s² + sC + K) η = 0.
#[test]
fn complex_modes_obey_the_equations() {
    let mut seed = 5;
    let mut model = random_model(6, 1, 1, &mut seed);
    let row = |k: usize| (0..6).map(|j| f64::from(u8::from(j == k))).collect::<Vec<f64>>();
    model.outputs = (0..6).map(|k| Output::new(Channel::new("y", ""), Rate::Place, row(k))).collect();
    let space = model.state_space().unwrap();
    for pole in space.poles().unwrap() {
        let eta = space.complex_mode(pole);
        let size = eta.iter().map(|x| x.norm()).fold(0.0, f64::max);
        for i in 0..6 {
            let entry = |j: usize| {
                let own = if i == j { pole * pole } else { c64::ZERO };
                own + pole * model.damping[(i, j)] + model.stiffness[(i, j)]
            };
            let terms: Vec<c64> = (0..6).map(|j| entry(j) * eta[j]).collect();
            let (sum, scale) = (terms.iter().sum::<c64>().norm(), (pole * pole).norm() * size);
            assert!(size > 0.0 && sum < 1e-7 * scale, "{pole} {i}: {sum:e} of {scale:e}");
        }
    }
}

/// Closed form: 1/(ω₀² − ω² + 2iζω₀ω), times iω and −ω²; and K(1 + ig) of structural damping.
#[test]
fn an_oscillator_responds_as_its_closed_form() {
    let (omega, zeta) = (3.0, 0.02);
    let rows: [(Rate, &[f64]); 3] = [(Rate::Place, &[2.0]), (Rate::Velocity, &[2.0]), (Rate::Acceleration, &[2.0])];
    let model = oscillators(&[[omega, zeta]], &[&[5.0]], &rows);
    let frequencies = [0.0, 0.1, omega / TAU, 2.0];
    let found = model.frequency_response(&frequencies, Damping::OfEquations).unwrap();
    for (f, values) in frequencies.iter().zip(&found.values) {
        let w = TAU * f;
        let place = c64::new(10.0, 0.0) / c64::new(omega * omega - w * w, 2.0 * zeta * omega * w);
        let expected = [place, place * c64::new(0.0, w), place * -(w * w)];
        for (i, expected) in expected.into_iter().enumerate() {
            assert!((values[(i, 0)] - expected).norm() <= 1e-13 * expected.norm(), "{f} {i}");
        }
        let through_states = model.state_space().unwrap().response(w).unwrap();
        assert!((&through_states - values).norm_l2() <= 1e-12 * values.norm_l2());
    }
    let structural = model.frequency_response(&[0.7], Damping::Structural(0.1)).unwrap();
    let w = TAU * 0.7;
    let expected = c64::new(10.0, 0.0) / c64::new(omega * omega - w * w, 0.1 * omega * omega);
    assert!((structural.values[0][(0, 0)] - expected).norm() <= 1e-13 * expected.norm());
}

/// Independent reference: the state space solved as a whole, of coupled coordinates.
#[test]
fn coupled_coordinates_respond_as_their_state_space() {
    let model = random_model(7, 2, 5, &mut 3);
    let space = model.state_space().unwrap();
    let frequencies: Vec<f64> = (0..50).map(|k| 0.3 * f64::from(k)).collect();
    let found = model.frequency_response(&frequencies, Damping::OfEquations).unwrap();
    for (f, values) in frequencies.iter().zip(&found.values) {
        let expected = space.response(TAU * f).unwrap();
        assert!((&expected - values).norm_l2() <= 1e-11 * expected.norm_l2(), "{f}");
    }
}

/// Closed form: poles −ζω ± iω√(1−ζ²).
#[test]
fn poles_are_those_of_the_oscillators() {
    let model = oscillators(&[[2.0, 0.1], [5.0, 0.01]], &[&[1.0], &[1.0]], &[(Rate::Place, &[1.0, 1.0])]);
    let poles = model.state_space().unwrap().poles().unwrap();
    for (pole, (omega, zeta)) in poles.chunks(2).zip([(2.0_f64, 0.1_f64), (5.0, 0.01)]) {
        let expected = c64::new(-zeta * omega, omega * (1.0 - zeta * zeta).sqrt());
        assert!(pole.iter().any(|pole| (pole - expected).norm() < 1e-12), "{pole:?} {expected}");
    }
}

/// Closed form: the slow root of two coordinates that are coupled, λ² + tr K λ + det K = 0 with λ = −ω², beside a fast one.
#[test]
fn slow_poles_have_little_of_the_rounding_of_fast_ones() {
    let [slow, between, fast] = [2.0, 1e3, 1e12];
    let mut model = oscillators(&[[1.0, 0.0]; 2], &[&[1.0], &[1.0]], &[(Rate::Place, &[1.0, 1.0])]);
    model.stiffness = Mat::from_fn(2, 2, |i, j| if i != j { between } else { [slow, fast][i] });
    let (sum, product) = (slow + fast, slow * fast - between * between);
    let expected = (2.0 * product / (sum + (sum * sum - 4.0 * product).sqrt())).sqrt();
    let poles = model.state_space().unwrap().poles().unwrap();
    assert!(poles[..2].iter().all(|pole| (pole.im.abs() / expected - 1.0).abs() < 1e-9), "{poles:?} {expected}");
}

/// Closed form: the variance of an oscillator under white noise of one-sided density S is π² S f₀ ... in rad, S/(8 ζ ω³).
#[test]
fn white_noise_gives_the_variance_of_its_closed_form() {
    let (omega, zeta, density) = (TAU * 5.0, 0.02, 0.3);
    let model = oscillators(&[[omega, zeta]], &[&[1.0]], &[(Rate::Place, &[1.0])]);
    // E[x²] = ∫₀^∞ S |H|² df = S / (8 ζ ω³), and of the rate ω² times that.
    let expected = (density / (8.0 * zeta * omega.powi(3))).sqrt();
    let poles = model.state_space().unwrap().poles().unwrap();
    let fine: Vec<f64> = (0..200_001).map(|k| 5e-4 * f64::from(k)).collect();
    let of_poles = Quadrature::of_poles([0.0, 1e7], &[], &poles).unwrap();
    assert!(of_poles.frequencies.len() < 1000, "{}", of_poles.frequencies.len());
    for (rule, end, bound) in [(Quadrature::trapezoidal(&fine), 100.0, 1e-4), (of_poles, 1e7, 1e-10)] {
        let response = model.frequency_response(&rule.frequencies, Damping::OfEquations).unwrap();
        let input = RandomInput::Independent(vec![vec![density]; rule.frequencies.len()]);
        let found = &response.random(&input, &rule.weights).unwrap()[0];
        assert!((found.rms / expected - 1.0).abs() < bound, "{} {expected}", found.rms);
        // The tail of the rate beyond the end is left out: ∫ S/(2πf)² df = S/(4π² end).
        let tail = density / (TAU * TAU * end);
        let rate = ((expected * omega).powi(2) - tail).sqrt();
        assert!((found.rate_rms / rate - 1.0).abs() < bound, "{} {rate}", found.rate_rms);
        assert!((found.crossings(0.0) - rate / (TAU * expected)).abs() < 10.0 * bound);
    }
}

#[test]
fn spectra_that_are_none_are_refused() {
    let model = oscillators(&[[1.0, 0.1]], &[&[1.0]], &[(Rate::Place, &[1.0])]);
    let response = model.frequency_response(&[0.1, 0.2], Damping::OfEquations).unwrap();
    for wrong in [vec![vec![-1.0]; 2], vec![vec![f64::NAN]; 2], vec![vec![1.0, 1.0]; 2]] {
        let error = response.random(&RandomInput::Independent(wrong), &[0.1; 2]).unwrap_err();
        assert!(matches!(error, LinearError::Spectrum { frequency: 0.1, .. }), "{error}");
    }
    assert!(matches!(response.random(&RandomInput::Independent(vec![]), &[0.1; 2]), Err(LinearError::Size { .. })));
    // Pairs that are each possible, but not together: a with b, b with c, a against c.
    let three = oscillators(&[[1.0, 0.1]], &[&[1.0, 1.0, 1.0]], &[(Rate::Place, &[1.0])]);
    let response = three.frequency_response(&[0.1], Damping::OfEquations).unwrap();
    let entry = |i: usize, j: usize| {
        if i == j {
            1.0
        } else if i + j == 2 {
            -0.9
        } else {
            0.9
        }
    };
    let apart = Mat::from_fn(3, 3, |i, j| c64::new(entry(i, j), 0.0));
    let error = response.random(&RandomInput::Correlated(vec![apart]), &[1.0]).unwrap_err();
    assert!(error.to_string().contains("together"), "{error}");
    let undamped = oscillators(&[[1.0, 0.0]], &[&[1.0]], &[(Rate::Place, &[1.0])]).state_space().unwrap();
    let poles = undamped.poles().unwrap();
    assert!(matches!(Quadrature::of_poles([0.1, 0.2], &[], &poles), Err(LinearError::NotStable { .. })));
    assert!(Quadrature::of_poles([0.2, 0.3], &[], &poles).is_ok());
}

/// Closed form: inputs in step and of one density are one input; against each other they cancel.
#[test]
fn correlated_inputs_add_or_cancel() {
    let model = oscillators(&[[1.0, 0.1]], &[&[1.0, 1.0]], &[(Rate::Place, &[1.0])]);
    let frequencies = [0.1, 0.2, 0.3];
    let response = model.frequency_response(&frequencies, Damping::OfEquations).unwrap();
    let with = |coherence: f64| {
        let matrix = Mat::from_fn(2, 2, |i, j| c64::new(if i == j { 1.0 } else { coherence }, 0.0));
        response.random(&RandomInput::Correlated(vec![matrix; 3]), &[1.0; 3]).unwrap()[0].rms
    };
    let apart = response.random(&RandomInput::Independent(vec![vec![1.0; 2]; 3]), &[1.0; 3]).unwrap()[0].rms;
    assert!((with(1.0) / apart - 2.0_f64.sqrt()).abs() < 1e-12);
    assert!(with(-1.0) < 1e-12 * apart && (with(0.0) / apart - 1.0).abs() < 1e-12);
}

/// Independent reference: the largest singular value of the difference at 400 frequencies, of 100 models of all orders, against the bound.
#[test]
fn balanced_truncation_is_within_its_bound() {
    let mut seed = 7;
    let mut closest = 0.0_f64;
    for _ in 0..100 {
        let model = random_model(6, 2, 3, &mut seed);
        let space = model.state_space().unwrap();
        let order = 2 + (noise(&mut seed).abs() * 9.0) as usize;
        let reduced = space.balanced(order).unwrap();
        assert!(reduced.model.poles().unwrap().iter().all(|pole| pole.re < 0.0));
        let mut largest = 0.0_f64;
        for k in 0..400 {
            let w = 10.0_f64.powf(-1.0 + 0.0085 * f64::from(k));
            let difference = space.response(w).unwrap() - reduced.model.response(w).unwrap();
            largest = largest.max(difference.singular_values().unwrap()[0]);
        }
        let rounding = 1e-9 * reduced.hankel_values[0];
        assert!(largest <= reduced.error_bound + rounding, "{largest:e} {:e}", reduced.error_bound);
        closest = closest.max(largest / reduced.error_bound.max(rounding));
    }
    // It is a bound that is nearly reached, not any large number.
    assert!(closest > 0.3, "{closest}");
}

#[test]
fn what_cannot_be_balanced_is_refused() {
    let undamped = oscillators(&[[1.0, 0.0]], &[&[1.0]], &[(Rate::Place, &[1.0])]).state_space().unwrap();
    assert!(matches!(undamped.balanced(1), Err(LinearError::Order { found: 1, least: 2, most: 2 })));
    assert!(matches!(undamped.modal(1), Err(LinearError::Order { found: 1, least: 2, most: 2 })));
    let unseen = oscillators(&[[1.0, 0.1]], &[&[1.0]], &[(Rate::Place, &[0.0])]).state_space().unwrap();
    assert!(matches!(unseen.balanced(1), Err(LinearError::Unconnected)));
    assert!(matches!(unseen.balanced(3), Err(LinearError::Order { found: 3, least: 1, most: 2 })));
    let free = oscillators(&[[0.0, 0.0]], &[&[1.0]], &[(Rate::Place, &[1.0])]);
    let resonant = free.frequency_response(&[0.0], Damping::OfEquations);
    assert!(matches!(resonant, Err(LinearError::Resonance { frequency: 0.0 })));
}

/// A rigid motion, a motion that grows, and an undamped vibration, all turned into vibrations that decay.
fn with_lasting_motions() -> SecondOrder {
    let mut seed = 11;
    let mut model = random_model(9, 2, 4, &mut seed);
    for (k, stiffness) in [(0, 0.0), (1, -0.3), (2, 4.0)] {
        for j in 0..9 {
            (model.damping[(k, j)], model.damping[(j, k)]) = (0.0, 0.0);
        }
        model.stiffness[(k, k)] = stiffness;
    }
    let turn = Mat::from_fn(9, 9, |_, _| noise(&mut seed)).qr().compute_Q();
    model.stiffness = turn.transpose() * (&model.stiffness * &turn);
    model.damping = turn.transpose() * (&model.damping * &turn);
    model
}

/// Independent reference: the largest singular value of the difference from the whole; what does not decay stays as it is.
#[test]
fn reduction_keeps_what_does_not_decay() {
    let space = with_lasting_motions().state_space().unwrap();
    let reduced = space.balanced(12).unwrap();
    // Two states of the rigid motion and of the undamped vibration each, and one that grows.
    assert_eq!((reduced.lasting, reduced.model.states.len()), (5, 12));
    let mut largest = 0.0_f64;
    for k in 0..400 {
        let w = 10.0_f64.powf(-1.0 + 0.0085 * f64::from(k));
        let difference = space.response(w).unwrap() - reduced.model.response(w).unwrap();
        largest = largest.max(difference.singular_values().unwrap()[0]);
    }
    let bound = reduced.error_bound;
    assert!(largest <= 1.0001 * bound && largest > 0.05 * bound, "{largest} {bound}");
    let growing = (0.3_f64).sqrt();
    for model in [reduced.model, space.modal(12).unwrap()] {
        let poles = model.poles().unwrap();
        for expected in [c64::new(growing, 0.0), c64::new(0.0, 2.0)] {
            assert!(poles.iter().any(|pole| (pole - expected).norm() < 1e-9), "{expected} {poles:?}");
        }
    }
}

/// Closed form: with the residual in D, the response at frequency 0 is that of the whole, and poles that are kept stay.
#[test]
fn modal_truncation_keeps_the_static_response() {
    let space = random_model(6, 2, 3, &mut 5).state_space().unwrap();
    let reduced = space.modal(6).unwrap();
    let [whole, kept] = [&space, &reduced].map(|space| space.response(0.0).unwrap());
    assert!((&whole - &kept).norm_l2() < 1e-11 * whole.norm_l2());
    for (pole, expected) in reduced.poles().unwrap().iter().zip(space.poles().unwrap()) {
        assert!((pole.norm() / expected.norm() - 1.0).abs() < 1e-10, "{pole} {expected}");
    }
    assert!((&reduced.d - &space.d).norm_l2() > 1e-6);
    assert!(matches!(space.modal(5), Err(LinearError::Order { found: 5, .. })));
}

/// Closed form: an oscillator on a base that is accelerated with a, η̈ + 2ζω η̇ + ω² η = −a. The mass has η̈ + a, as the force of its spring
/// and damper says, too.
#[test]
fn outputs_see_several_rates_and_the_inputs() {
    let (omega, zeta) = (3.0, 0.1);
    let mut model = oscillators(&[[omega, zeta]], &[&[-1.0]], &[(Rate::Acceleration, &[1.0])]);
    model.outputs[0].direct = vec![1.0];
    let mut force = Output::new(Channel::new("f", ""), Rate::Place, vec![-omega * omega]);
    force.rows[1] = vec![-2.0 * zeta * omega];
    model.outputs.push(force);
    let space = model.state_space().unwrap();
    let frequencies = [0.0, 0.3, 0.5, 4.0];
    let found = model.frequency_response(&frequencies, Damping::OfEquations).unwrap();
    for (f, values) in frequencies.iter().zip(&found.values) {
        let w = TAU * f;
        let swing = c64::new(omega * omega, 2.0 * zeta * omega * w);
        let expected = swing / (swing - w * w);
        let through_states = space.response(w).unwrap();
        for found in [values[(0, 0)], values[(1, 0)], through_states[(0, 0)], through_states[(1, 0)]] {
            assert!((found - expected).norm() < 1e-13, "{f} {found} {expected}");
        }
    }
}

/// Independent reference: code_aster V2.01.023, eight masses of 10 kg between nine springs of 1e5 N/m with dampers of 50 N s/m: |H₄₄|² of the
/// displacement is 1.0589e-6 (mm/N)² at 5.5259 Hz.
#[test]
fn eight_masses_respond_as_in_another_program() {
    let (n, mass, stiffness, damper) = (8, 10.0, 1e5, 50.0);
    let modes: Vec<(f64, f64)> = (1..=n)
        .map(|r| {
            let angle = std::f64::consts::PI * f64::from(r) / f64::from(n + 1);
            let omega = 2.0 * f64::sqrt(stiffness / mass) * (0.5 * angle).sin();
            (omega, (2.0 / (f64::from(n + 1) * mass)).sqrt() * (4.0 * angle).sin())
        })
        .collect();
    let omega_zeta: Vec<[f64; 2]> =
        modes.iter().map(|(omega, _)| [*omega, damper * omega / (2.0 * stiffness)]).collect();
    let forces: Vec<[f64; 1]> = modes.iter().map(|(_, of_fourth)| [*of_fourth]).collect();
    let row: Vec<f64> = modes.iter().map(|(_, of_fourth)| *of_fourth).collect();
    let forces: Vec<&[f64]> = forces.iter().map(|force| &force[..]).collect();
    let model = oscillators(&omega_zeta, &forces, &[(Rate::Place, &row)]);
    let found = model.frequency_response(&[5.5259], Damping::OfEquations).unwrap();
    let square = found.values[0][(0, 0)].norm_sqr();
    assert!((square / 1.0589e-6 - 1.0).abs() < 1e-4, "{square:e}");
    // White noise of that density 1 at the fourth mass: its displacement has the density of the square, and by poles the mean square of
    // the closed form Σ_r Σ_s of the modes.
    let poles = model.state_space().unwrap().poles().unwrap();
    let rule = Quadrature::of_poles([0.0, 1e6], &[], &poles).unwrap();
    let response = model.frequency_response(&rule.frequencies, Damping::OfEquations).unwrap();
    let input = RandomInput::Independent(vec![vec![1.0]; rule.frequencies.len()]);
    let mean_square = response.random(&input, &rule.weights).unwrap()[0].rms.powi(2);
    let alone = |omega: f64, zeta: f64| 1.0 / (8.0 * zeta * omega.powi(3));
    let mut expected = 0.0;
    for ((a, [wa, za]), (b, [wb, zb])) in
        row.iter().zip(&omega_zeta).flat_map(|x| row.iter().zip(&omega_zeta).map(move |y| (x, y)))
    {
        // ∫₀^∞ Re(H_a H_b*) df = (ζ_a ω_a + ζ_b ω_b) / ((ω_a² − ω_b²)² + 4 (ζ_a ω_a + ζ_b ω_b)(ζ_a ω_a ω_b² + ζ_b ω_b ω_a²)).
        let (da, db) = (za * wa, zb * wb);
        let below = (wa * wa - wb * wb).powi(2) + 4.0 * (da + db) * (da * wb * wb + db * wa * wa);
        let together = (da + db) / below;
        if wa == wb {
            assert!((together / alone(*wa, *za) - 1.0).abs() < 1e-12);
        }
        expected += a * a * b * b * together;
    }
    assert!((mean_square / expected - 1.0).abs() < 1e-9, "{mean_square:e} {expected:e}");
}

/// Closed form: two masses on springs: ω = √k (√5 ∓ 1)/2; a damper on the upper one couples the modes.
#[test]
fn real_modes_of_two_masses_and_what_has_none() {
    let stiffness = Mat::from_fn(2, 2, |i, j| [[200.0, -100.0], [-100.0, 100.0]][i][j]);
    let channel = |name: &str| Channel::new(name, "");
    let equations = |damping: [[f64; 2]; 2], stiffness: &Mat<f64>| SecondOrder {
        stiffness: stiffness.clone(),
        damping: Mat::from_fn(2, 2, |i, j| damping[i][j]),
        forces: Mat::from_fn(2, 1, |_, _| -1.0),
        inputs: vec![channel("base")],
        outputs: Vec::new(),
        coordinates: vec![channel("a"), channel("b")],
    };
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let modes = equations([[0.4, -0.2], [-0.2, 0.2]], &stiffness).real_modes().unwrap();
    for (k, root) in [golden - 1.0, golden].into_iter().enumerate() {
        assert!((modes.circular_frequencies[k] / (10.0 * root) - 1.0).abs() < 1e-14);
        // C = K/500.
        assert!((modes.damping_ratios[k] / (0.5 * 10.0 * root / 500.0) - 1.0).abs() < 1e-13);
    }
    assert!(modes.coupling < 1e-12, "{}", modes.coupling);
    // v = (1, 2 − root²) of unit length; c_ij of the damper alone is c v_i v_j, so that the modes share all of it.
    let coupled = equations([[0.0, 0.0], [0.0, 0.2]], &stiffness).real_modes().unwrap();
    assert!((coupled.coupling - 1.0).abs() < 1e-12, "{}", coupled.coupling);

    let gyroscopic = equations([[0.0, 0.5], [-0.5, 0.0]], &stiffness).real_modes().unwrap_err();
    assert!(gyroscopic.to_string().contains("without a spin"), "{gyroscopic}");
    let free = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { -1.0 });
    let rigid = equations([[0.0; 2]; 2], &free).real_modes().unwrap_err();
    assert!(rigid.to_string().contains("a body that is held"), "{rigid}");
}
