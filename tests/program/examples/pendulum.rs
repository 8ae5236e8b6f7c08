//! Compound pendulums on a hinge under gravity, against the elliptic integral.

use flexframe::dynamics::Observation;
use flexframe::model::Model;
use flexframe::scene::{Body, BodySource, Choice, Effect, Materials, MeshedBody};
use nalgebra::Vector3;

use crate::examples::{build, rows, scene};

/// 4 K(sin ½θ₀) √(J/(M g d)) = 2π √(J/(M g d)) / AGM(1, cos ½θ₀).
fn elliptic_period(inertia_over_weight_arm: f64, largest: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (0.5 * largest).cos());
    while (a - b).abs() > 1e-15 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    std::f64::consts::TAU * inertia_over_weight_arm.sqrt() / a
}

/// Time between the first and the last passage in one direction through the lowest place, over the number of swings
/// between. The angle between two rows is the cubic through their angles and rates.
fn measured_period(rows: &[Observation], axis: Vector3<f64>, down: Vector3<f64>) -> f64 {
    let angle = |o: &Observation| {
        let arm = o.attitude.to_global(&Vector3::x());
        axis.dot(&down.cross(&arm)).atan2(down.dot(&arm))
    };
    let passages: Vec<f64> = rows
        .windows(2)
        .filter(|pair| angle(&pair[0]) < 0.0 && angle(&pair[1]) >= 0.0 && angle(&pair[1]) < 1.0)
        .map(|pair| {
            let h = pair[1].time - pair[0].time;
            let ([a, b], [da, db]) =
                ([0, 1].map(|i| angle(&pair[i])), [0, 1].map(|i| h * pair[i].omega_body.dot(&axis)));
            let cubic = |s: f64| a + s * (da + s * (3.0 * (b - a) - 2.0 * da - db + s * (2.0 * (a - b) + da + db)));
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if cubic(middle) < 0.0 { low = middle } else { high = middle }
            }
            pair[0].time + h * low
        })
        .collect();
    assert!(passages.len() > 2, "{passages:?}");
    (passages[passages.len() - 1] - passages[0]) / (passages.len() - 1) as f64
}

/// Closed form: the elliptic integral.
#[test]
fn the_period_of_a_rigid_pendulum_is_the_elliptic_integral() {
    let body = scene("pendulum");
    let down = Vector3::new(2.0_f64.cos(), 2.0_f64.sin(), 0.0);
    let measured = measured_period(&rows(&build(&body), &body), Vector3::z(), down);
    let expected = elliptic_period(1.0 / (3.0 * 9.81 * 0.5), 2.0);
    // Measured: 7.7e-13.
    assert!((measured / expected - 1.0).abs() < 1e-9, "{measured} {expected}");
}

fn period_of_bar(body: &Body, model: &Model) -> f64 {
    measured_period(&rows(model, body), Vector3::y(), Vector3::new(1.0_f64.cos(), 0.0, -1.0_f64.sin()))
}

/// Closed form: the elliptic integral; the gap of the bar that bends falls as 1/E.
#[test]
fn the_period_of_a_meshed_pendulum_is_the_elliptic_integral() {
    let mut body = scene("bar/pendulum");
    let expected = elliptic_period((400.0 * 400.0 / 3.0 + 10.0 * 10.0 / 12.0) / (9810.0 * 200.0), 1.0);
    let rigid = build(&body);
    assert_eq!(rigid.body.flexible(), 0);
    let period = period_of_bar(&body, &rigid);
    // Measured: 7.6e-12.
    assert!((period / expected - 1.0).abs() < 1e-9, "{period} {expected}");

    // The bar that deforms bends as it swings, by something of (Ω/ω₁)² = 1.6e-5: the gap falls as 1/E.
    body.effects.choices[Effect::Flexibility] = Choice::On;
    let gap = |body: &Body| {
        let model = build(body);
        assert_eq!(model.body.flexible(), 10);
        period_of_bar(body, &model) / expected - 1.0
    };
    let of_steel = gap(&body);
    let BodySource::Meshed(MeshedBody { materials: Materials::Uniform(material), .. }) = &mut body.source else {
        panic!()
    };
    material.young_modulus *= 10.0;
    let of_stiffer = gap(&body);
    // Measured: 1.0947e-6 and 1.0948e-7.
    assert!((1e-7..2e-6).contains(&of_steel) && (of_steel / of_stiffer / 10.0 - 1.0).abs() < 0.02);
}
