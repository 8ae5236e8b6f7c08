//! Large modes with those that follow them.

use model::StateCheck;
use nonlinear::StateErrorSettings;
use scene::{Body, Choice, Flexible, Large};

use crate::bodies::{ARC, BLADE, BRACKET, CLAMP, CONED, CONSTANT, Solid, built, checked};

impl Solid {
    /// Spinning at this multiple of its first frequency at rest.
    fn spinning(&self, modes: &str, part: f64) -> Body {
        self.scene(modes, &self.driven(part * self.first()))
    }

    /// Clamped under a constant dead force at its tip.
    fn pushed(&self, modes: &str, force: [f64; 3]) -> Body {
        self.scene(modes, &format!("{CLAMP}{}", self.force(force, 1.0, CONSTANT)))
    }

    /// Clamped under gravity.
    fn hanging(&self, modes: &str, gravity: f64) -> Body {
        self.scene(
            modes,
            &format!("{CLAMP}[[loads]]\nkind = \"gravity\"\ndirection = [0.0, -1.0, 0.0]\namplitude = {gravity:e}\n"),
        )
    }
}

/// The rest of a model against the full body: displacement and error of the tip, and errors of frequencies.
struct Rest {
    large: Vec<usize>,
    check: StateCheck,
}

impl Rest {
    fn of(body: &Body) -> Self {
        let (model, check) = checked(body, &StateErrorSettings::converged());
        Self { large: model.large_modes().to_vec(), check }
    }

    /// Errors of the tip and of the first frequency, in percent.
    fn errors(&self, name: &str) -> [f64; 2] {
        let Self { large, check } = self;
        let tip = &check.points[0];
        let moved = tip.displacement.iter().map(|u| u * u).sum::<f64>().sqrt();
        let frequencies: Vec<String> = check.frequencies.iter().map(|f| format!("{:+.3}", 100.0 * f.error)).collect();
        println!(
            "{name}: large {large:?}, tip {moved:.3} m off by {:.3} %, frequencies {} %, inside {:.1e}, beside {:.1e}, {} factors",
            100.0 * tip.relative,
            frequencies.join(" "),
            check.within_modes,
            check.beside_modes,
            check.factors
        );
        [100.0 * tip.relative, 100.0 * check.frequencies.first().map_or(0.0, |f| f.error.abs())]
    }

    #[track_caller]
    fn is_within(&self, name: &str, [tip, frequency]: [f64; 2]) {
        let found = self.errors(name);
        assert!(found[0] <= tip && found[1] <= frequency, "{name}: {found:?} % instead of {tip} and {frequency}");
    }
}

const LARGE: &str = "large = 1";

/// Independent reference: the full nonlinear body of the same mesh. Twice the errors of the same method on like bodies.
#[test]
fn a_coned_rod_is_straightened_by_a_fast_spin() {
    for (part, bounds) in [(1.0, [0.1, 0.1]), (2.0, [0.44, 0.8]), (3.0, [1.22, 3.8])] {
        Rest::of(&CONED.spinning("", part)).is_within(&format!("coned rod at {part}"), bounds);
    }
}

/// Independent reference: as above.
#[test]
fn a_swept_blade_stands_at_twice_its_first_frequency() {
    for (part, bounds) in [(0.5, [0.12, 0.2]), (1.0, [1.0, 1.6]), (2.0, [4.0, 9.6])] {
        Rest::of(&BLADE.spinning("", part)).is_within(&format!("blade at {part}"), bounds);
    }
}

/// Independent reference: as above.
#[test]
fn a_quarter_arc_opens_as_it_spins() {
    for (part, bounds) in [(0.25, [0.02, 0.1]), (0.5, [0.24, 0.6]), (1.0, [8.2, 14.0])] {
        Rest::of(&ARC.spinning("", part)).is_within(&format!("arc at {part}"), bounds);
    }
}

/// Independent reference: as above.
#[test]
fn a_bracket_bends_under_a_force_at_its_tip_and_under_gravity() {
    for (force, bounds) in [(13.0, [0.42, 1.0]), (30.0, [1.48, 3.0])] {
        Rest::of(&BRACKET.pushed("", [0.0, -force, 0.0])).is_within(&format!("bracket under {force} N"), bounds);
    }
    Rest::of(&BRACKET.hanging("", 110.0)).is_within("bracket under gravity", [0.58, 1.2]);
}

/// Independent reference: as above.
#[test]
fn a_quarter_arc_bends_under_a_force_at_its_tip() {
    for (force, bounds) in [(6.0, [0.24, 0.5]), (13.0, [0.8, 1.5]), (35.0, [5.2, 8.0])] {
        Rest::of(&ARC.pushed("", [0.0, 0.0, force])).is_within(&format!("arc under {force} N"), bounds);
    }
}

/// Independent reference: as above. Named large modes are those that the rule finds.
#[test]
fn a_named_large_mode_is_the_one_of_the_rule() {
    let by_rule = Rest::of(&BLADE.spinning("", 0.5));
    let named = Rest::of(&BLADE.spinning(LARGE, 0.5));
    assert_eq!(by_rule.large, named.large);
}

/// Independent reference: as above. Errors of the shifts of the four lowest frequencies, of the largest of each spin, about three
/// axes: with linear modes and the stress alone they are wrong by up to 85 %, however slow the spin is.
#[test]
fn slow_spins_shift_the_frequencies_of_a_bracket_as_they_should() {
    for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        let bracket = Solid { axis, ..BRACKET };
        let clamp = "[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n";
        let at_rest = Rest::of(&bracket.scene("", clamp)).check.frequencies;
        for (part, bound) in [(0.05, 0.004), (0.1, 0.01), (0.3, 0.12)] {
            let spun = Rest::of(&bracket.spinning("", part));
            spun.errors(&format!("bracket about {axis:?} at {part}"));
            let shifts = spun.check.frequencies.iter().zip(&at_rest);
            let shifts: Vec<[f64; 2]> = shifts.map(|(f, rest)| [f.model - f.full, f.full - rest.full]).collect();
            let largest = shifts.iter().map(|[_, shift]| shift.abs()).fold(0.0, f64::max);
            let error = shifts.iter().map(|[error, _]| error.abs()).fold(0.0, f64::max) / largest;
            println!("{axis:?} at {part}: {:.3} % of the largest shift", 100.0 * error);
            assert!(error < bound, "{axis:?} at {part}: {error}");
        }
    }
}

/// E I/L of the rod.
const BENDING: f64 = 2e9 * 0.02 * 0.02 * 0.02 * 0.02 / 12.0;

/// Clamped under a constant dead moment at the tip.
fn twisted(body: &Solid, direction: [f64; 3], moment: f64) -> Body {
    let load = format!(
        "[[loads]]\nkind = \"moment\"\nat = {:?}\ndirection = {direction:?}\namplitude = {moment:e}\n\
         history = {CONSTANT}\n",
        body.tip
    );
    body.scene("", &format!("{CLAMP}{load}"))
}

/// The rod, whose end the moment turns by an angle, about.
fn turned(angle: f64) -> Body {
    twisted(&CONED, [0.0, 0.0, 1.0], angle * BENDING)
}

/// Independent reference: as above. By the exact rotation of the patch the moment does its work on the angle, not on its sine; with its
/// static answer as a large coordinate the manifold holds the whole bent rod.
#[test]
fn a_moment_at_the_end_turns_it_far() {
    for (angle, bounds) in [(0.2, [0.05, 0.02]), (0.5, [0.95, 0.7])] {
        let rest = Rest::of(&turned(angle));
        rest.is_within(&format!("end moment to {angle} rad"), bounds);
        assert_eq!(rest.large, [0, 1, 2]);
    }
}

/// Independent reference: as above. What the static answer draws in is coupled to the other modes by K, unless a symmetry forbids it. Without
/// this the arc was off by 2.3 % under the first moment, and stood nowhere under the second.
#[test]
fn a_moment_bends_an_arc_and_twists_a_rod() {
    for (name, body, direction, angle, bounds) in [
        ("arc in its plane", &ARC, [1.0, 0.0, 0.0], 0.1, [0.2, 0.25]),
        ("arc in its plane", &ARC, [1.0, 0.0, 0.0], 0.3, [2.2, 6.5]),
        ("arc, bent and twisted", &ARC, [1.0, 1.0, 0.0], 0.2, [0.25, 0.4]),
        ("rod, bent and twisted", &CONED, [1.0, 1.0, 0.0], 0.2, [0.85, 0.1]),
    ] {
        Rest::of(&twisted(body, direction, angle * BENDING)).is_within(&format!("moment, {name}, {angle}"), bounds);
    }
}

/// Conserved: energy, to the fourth order of the step, where the static answer of a moment is a coordinate that the stiffness couples to
/// others. The moment begins at once, and the rod swings.
#[test]
fn a_rod_that_a_moment_swings_keeps_its_energy() {
    let errors = [2e-4, 1e-4].map(|step| {
        let mut body = turned(0.2);
        (body.time.control, body.time.end) = (dynamics::StepControl::Fixed(step), 0.1);
        let model = built(&body);
        let rows: Vec<_> = model.start(&body).unwrap().map(Result::unwrap).collect();
        let largest = |of: &dyn Fn(&dynamics::Observation) -> f64| rows.iter().map(of).fold(0.0, f64::max);
        let error = largest(&|row| (row.energy_balance() - rows[0].energy_balance()).abs());
        error / largest(&|row| row.strain_energy)
    });
    println!("energy off by {errors:?}");
    assert!(errors[1] < 2e-7 && errors[1] < errors[0] / 8.0, "{errors:?}");
}

/// With no more modes than are large, the answer is the static shape.
#[test]
fn the_answer_may_be_all_that_is_left() {
    let mut body = turned(0.2);
    body.modes.flexible = Flexible::Count(2);
    let model = built(&body);
    assert_eq!((model.large_modes(), model.static_answer()), (&[0, 1, 2][..], Some(2)));
    // Of one mode more, which is not large, and without a static shape: in its place.
    (body.modes.flexible, body.modes.static_correction) = (Flexible::Count(3), Choice::Off);
    body.modes.large = Some(Large::List(vec![2, 3]));
    let model = built(&body);
    assert_eq!((model.large_modes(), model.static_answer()), (&[0, 1, 2][..], Some(0)));
}

/// Moments that go by several histories have no answer together.
#[test]
fn moments_that_act_one_after_the_other_have_no_answer() {
    let mut body = turned(0.2);
    body.loads.extend(turned(0.2).loads);
    assert_eq!(built(&body).static_answer(), Some(2));
    body.loads[1].history = dynamics::History::HalfSine { start: 0.05, duration: 0.01 };
    assert_eq!(built(&body).static_answer(), None);
}

/// Bodies whose loads are no moments, or are small beside others, have their modes as coordinates.
#[test]
fn the_answer_to_a_small_moment_is_no_coordinate() {
    let mut body = turned(0.01);
    let force = CONED.scene("", &CONED.force([0.0, 1.0, 0.0], 10.0, CONSTANT));
    body.loads.extend(force.loads);
    let model = built(&body);
    assert!(model.meshed.unwrap().modes.answer.is_none());
}

/// Independent reference: 29.0332 Hz of the nonlinear finite elements of `verification::nonlinear` (`a_rod_under_pressure_on_all_sides_as_the_whole_mesh`).
/// A pressure on all sides moves nothing but the modes that stretch the rod, which are not taken as large: with the first of them the
/// frequency was 0.8 % too low.
#[test]
fn a_mode_that_stretches_the_body_is_not_large_by_itself() {
    let mut body = CONED.scene("", "[[loads]]\nkind = \"pressure\"\ngroup = \"all\"\namplitude = 1e6\n");
    body.effects.tolerance = 1e-9;
    body.modes.flexible = Flexible::Count(20);
    body.modes.static_correction = Choice::Off;
    let model = built(&body);
    assert!(model.large_modes().is_empty(), "{:?}", model.large_modes());
    let frequency = model.loaded_modes(&body).unwrap()[0].circular_frequency / std::f64::consts::TAU;
    assert!((frequency / 29.0332 - 1.0).abs() < 5e-4, "{frequency}");
}

/// Independent reference: 157.2063 and 158.0044 Hz of the nonlinear finite elements of `verification::nonlinear` (`a_closed_tube_stiffens_under_inner_pressure_as_the_whole_mesh`),
/// 156.9388 Hz without pressure. The walls bulge as large modes by themselves: with their stress alone the tube had a quarter of the shift.
#[test]
fn the_walls_of_a_tube_are_large_by_themselves() {
    let tube = Solid { mesh: "tube", tip: [1.0, 0.0, 0.0], axis: [0.0, 0.0, 1.0] };
    for (pressure, expected) in [(5e5, 157.2063), (2e6, 158.0044)] {
        let load = format!("[[loads]]\nkind = \"pressure\"\ngroup = \"inside\"\namplitude = {pressure:e}\n");
        let mut body = tube.scene("", &load);
        body.effects.tolerance = 1e-9;
        body.modes.flexible = Flexible::Count(20);
        body.modes.static_correction = Choice::Off;
        let model = built(&body);
        assert_eq!(model.large_modes(), [5]);
        let frequency = model.loaded_modes(&body).unwrap()[0].circular_frequency / std::f64::consts::TAU;
        assert!((frequency - expected).abs() < 0.01 * (expected - 156.9388), "{frequency}");
    }
}
