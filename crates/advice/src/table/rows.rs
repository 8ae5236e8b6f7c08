//! The table: a row for each effect, and for what else a run goes by.

use dynamics::{Effect, EffectMap};
use faer::Mat;
use nalgebra::Matrix3;
use reduced_body::ReducedBody;

use crate::limits::{LINEAR, Refusal, deflected};
use crate::motion::case::{AdviceError, Case};
use crate::motion::course::Course;
use crate::motion::excitation::Spin;
use crate::motion::response::{Response, norm, of_drive};
use crate::motion::source::Source;
use crate::motion::{rigid, tensor};
use crate::strain::error_bound;
use crate::table::estimate::Estimate;
use crate::table::number::Number;
use crate::table::relative::relative;
use crate::table::row::{Row, Subject, Worth};

/// Advice on a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// The row of each effect.
    pub effects: EffectMap<Row>,
    /// The row of [`Subject::StaticCorrection`].
    pub static_correction: Row,
    /// The row of [`Subject::Deflection`].
    pub large_deflection: Row,
    /// Worth of each mode (nf).
    pub modes: Vec<Worth>,
    /// How many of the modes to keep: those after them have shares that sum to less than the tolerance.
    pub keep: usize,
    /// True if the last mode there was to choose from is still worth keeping: then more should be computed.
    pub more_modes: bool,
    /// Largest |ω| that the estimates allow for.
    pub spin: f64,
    /// Largest displacement by deformation, over the length of the body, that is to be expected at most.
    pub deflection: f64,
    /// Its certain part: that of loads on a body that neither spins nor is stiffened by them.
    pub certain_deflection: f64,
    /// Influence of what the modes leave out of the static response to the spin, bounded above; at most 1.
    pub stretch: f64,
    /// The same of the static response to the inertia of the drive; 0 where it is not known.
    pub pushed: f64,
    /// The tolerance.
    pub tolerance: f64,
}

impl Advice {
    /// All rows, those of the effects first.
    pub fn rows(&self) -> impl Iterator<Item = (Subject, &Row)> {
        let others =
            [(Subject::StaticCorrection, &self.static_correction), (Subject::Deflection, &self.large_deflection)];
        Effect::ALL.into_iter().map(|effect| (Subject::Effect(effect), &self.effects[effect])).chain(others)
    }

    /// Which of the first `keep` modes are to be large, numbered from 0.
    pub fn large_modes(&self, keep: usize) -> Vec<usize> {
        error_bound::large_modes(&self.modes, keep, self.tolerance)
    }

    /// Which of the first `keep` modes move furthest, whether or not linear strain gets them wrong; none where none moves.
    pub fn furthest_modes(&self, keep: usize) -> Vec<usize> {
        error_bound::furthest_modes(&self.modes, keep)
    }

    /// Error of the model that the loads make known, if there is one.
    pub fn refusal(&self) -> Option<Refusal> {
        deflected(self.certain_deflection)
    }
}

/// How far the stiffening that [`screen`] allows for is above the bending of a bar whose mass is at its ends (π²/8).
const SCREEN: f64 = 10.0;
/// How far what the modes leave out of a static response may count above its share in the work of the load.
const SWING: f64 = 4.0;
/// The same of the centrifugal field, with what the Euler force of a spin that changes adds.
const SPUN: f64 = 10.0;
/// ½∫w'² of the first bending mode of a free bar with a deflection of one at its ends, over one length.
const SHORTENING: f64 = 6.2;

/// Before anything dear: whether K_ij may matter, by the spin that there is and that the loads may cause. `value` bounds
/// `Ω² K_kk/ω_k²` by `10 m a_k² (Ω/ω_k)² (ω_k/ω_1)`, a_k the largest displacement in mode k: a tension of the order
/// `m Ω² L` along a bar that is bent into waves. Needs no [`reduced_body::Constants::stress_stiffness`].
///
/// # Errors
/// [`AdviceError`]: lists of the wrong length and numbers out of range.
pub fn screen(case: &Case, tolerance: f64) -> Result<Row, AdviceError> {
    case.check(tolerance)?;
    let (spin, sources) = Spin::new(case);
    let response = Response::new(case, &spin, &sources);
    Ok(stiffening(case, &spin, &response, None).row(tolerance))
}

/// The table, with the stiffness by spin if the body has it, and by [`screen`] if not.
///
/// # Errors
/// [`AdviceError`]: lists of the wrong length and numbers out of range.
pub fn advise(case: &Case, tolerance: f64) -> Result<Advice, AdviceError> {
    case.check(tolerance)?;
    let (spin, sources) = Spin::new(case);
    let mut response = Response::new(case, &spin, &sources);
    let second = tensor::of_pairs(&case.body.inertia_second, &spin.directions);
    let stiffness = case.body.stress_stiffness.as_ref().map(|k| tensor::of_pairs(k, &spin.directions));
    let coupling = tensor::of_vectors(&case.body.gyroscopic, &spin.directions);
    response.share_out(|k, l| {
        let static_force = second[(k, l)] + stiffness.as_ref().map_or(0.0, |s| s[(k, l)]);
        spin.largest.powi(2) * static_force + spin.pull(coupling[(k, l)], case.body.circular_frequencies[l])
    });
    let shares = response.shares();
    let deflection = response.displacement.iter().zip(case.peaks).map(|(q, a)| q * a).sum::<f64>() / case.length;
    let believed = error_bound::believed(deflection);
    let modes: Vec<Worth> = shares
        .iter()
        .enumerate()
        .map(|(k, share)| {
            let expected = believed * response.displacement[k];
            let backbone = case.backbones.get(k).and_then(Option::as_ref);
            Worth {
                circular_frequency: case.body.circular_frequencies[k],
                displacement: response.displacement[k],
                share: *share,
                worth_keeping: *share >= tolerance,
                strain_bound: error_bound::screen(case, &response, k, expected) * share,
                strain: backbone.map(|backbone| error_bound::by_backbone(case, &response, k, expected, backbone)),
            }
        })
        .collect();
    // What is left out adds up.
    let mut rest = 0.0;
    let negligible = shares.iter().rev().take_while(|share| {
        rest += **share;
        rest < tolerance
    });
    let keep = shares.len() - negligible.count();
    let (stretch, pushed) = (stretch(case, &spin, &response), pushed(case, &response));
    let estimate = |effect| match effect {
        Effect::Flexibility => flexibility(case, &spin, &sources, &response, deflection),
        Effect::Damping => damping(case, &response),
        Effect::Gravity => rigid::gravity(case, &sources, &response),
        Effect::DeformedInertia => deformed_inertia(case, &spin, &response, &second, stiffness.as_ref(), stretch),
        Effect::Coriolis => coriolis(case, &spin, &response, &coupling),
        Effect::GeometricStiffening => stiffening(case, &spin, &response, stiffness.as_ref()),
        Effect::LargeDeflection => error_bound::large_deflection(&modes, deflection, (case.length, case.length_unit)),
        Effect::Translation => rigid::translation(case, &sources),
        Effect::Rotation => rigid::rotation(case, &spin, &sources, &response),
    };
    Ok(Advice {
        effects: EffectMap::from_fn(|effect| estimate(effect).row(tolerance)),
        static_correction: static_correction(case, &spin, &sources, keep, [stretch, pushed]).row(tolerance),
        large_deflection: bending(case, deflection),
        modes,
        keep,
        more_modes: keep > 0 && keep == case.body.flexible(),
        spin: spin.largest,
        deflection,
        certain_deflection: if spin.largest == 0.0 { response.certain_deflection } else { 0.0 },
        stretch,
        pushed,
        tolerance,
    })
}

fn flexibility(case: &Case, spin: &Spin, sources: &[Source], response: &Response, deflection: f64) -> Estimate {
    let flexible = norm(&response.acceleration);
    let pushed = sources.iter().map(|s| s.course.largest * s.translation.hypot(s.rotation)).fold(0.0, f64::max);
    let rigid = pushed.max(spin.certain * spin.certain_momentum);
    let (value, influence, why) = if flexible == 0.0 {
        (0.0, 0.0, "Nothing moves the modes.".into())
    } else if rigid == 0.0 {
        (f64::INFINITY, 1.0, "The body can do nothing but deform.".into())
    } else {
        let ratio = flexible / rigid;
        let influence = relative(ratio.max(deflection), 1.0);
        let why = format!(
            "{} It accelerates up to {} times what the rigid motion does.",
            bends(case, deflection),
            Number(ratio)
        );
        (ratio, influence, why)
    };
    Estimate { value, influence, why }
}

fn damping(case: &Case, response: &Response) -> Estimate {
    let lost = |k: usize| {
        let x = case.damping_ratios[k] * case.body.circular_frequencies[k] * case.end;
        response.displacement[k] * (-(-x).exp_m1() + 2.0 * case.damping_ratios[k]).min(1.0)
    };
    let lost: Vec<f64> = (0..case.body.flexible()).map(lost).collect();
    let influence = relative(norm(&lost), response.scale);
    let largest = |of: &dyn Fn(usize) -> f64| (0..case.body.flexible()).map(of).fold(0.0, f64::max);
    let value = largest(&|k| case.damping_ratios[k] * case.body.circular_frequencies[k] * case.end);
    let why = if influence == 0.0 {
        "No mode that moves is damped.".into()
    } else {
        format!("Vibration decays by up to e^-{value:.1e} in the run.")
    };
    Estimate { value, influence, why }
}

fn deformed_inertia(
    case: &Case,
    spin: &Spin,
    response: &Response,
    second: &Mat<f64>,
    stiffness: Option<&Mat<f64>>,
    stretch: f64,
) -> Estimate {
    let body = case.body;
    let q = &response.displacement;
    let first: f64 =
        tensor::of_modes(&body.inertia_first, &body.rotation_basis).iter().zip(q).map(|(c, q)| 2.0 * c * q).sum();
    let pairs = tensor::of_pairs(&body.inertia_second, &body.rotation_basis);
    let value = first + double_sum(&pairs, q, q);
    let attitude = rigid::attitude_change(case, spin, value * spin.momentum, response.scale);
    let square = spin.largest * spin.largest;
    let centrifugal: Vec<f64> =
        tensor::of_modes(&body.inertia_first, &spin.directions).iter().map(|c| c * square).collect();
    // The stiffness is part of the same terms.
    let force = |k, l| square * (second[(k, l)] + stiffness.map_or(0.0, |s: &Mat<f64>| s[(k, l)]));
    let modes = response.change(force, q, &centrifugal);
    let why = if spin.largest == 0.0 {
        "The body does not turn.".into()
    } else {
        format!(
            "Deformation changes the inertia by up to {value:.1e}: {attitude:.1e} of the rotation, and the centrifugal field {modes:.1e} of the vibration."
        )
    };
    // The centrifugal field stretches in ways that the modes do not carry, too, where that is known.
    let stretch = if case.centrifugal_remainders.is_empty() { 0.0 } else { stretch };
    let influence = if spin.largest == 0.0 { 0.0 } else { attitude.max(modes).max(stretch) };
    Estimate { value, influence, why }
}

fn coriolis(case: &Case, spin: &Spin, response: &Response, g: &Mat<f64>) -> Estimate {
    let body = case.body;
    let omega = &body.circular_frequencies;
    let (q, v) = (&response.displacement, &response.velocity);
    let force = |k: usize, l: usize| spin.pull(g[(k, l)], omega[l]);
    let amplitude: Vec<f64> = (0..q.len()).map(|k| q[k].max(v[k] / omega[k])).collect();
    let modes = response.change(force, &amplitude, &vec![0.0; q.len()]);
    let turning = tensor::of_vectors(&body.gyroscopic, &body.rotation_basis);
    let attitude = rigid::attitude_change(case, spin, double_sum(&turning, q, v), response.scale);
    let pair = |k: usize, l: usize| 2.0 * spin.largest * g[(k, l)] / omega[k].max(omega[l]);
    let value = (0..q.len()).flat_map(|k| (0..k).map(move |l| (k, l))).map(|(k, l)| pair(k, l)).fold(0.0, f64::max);
    let influence = if modes.is_nan() { 1.0 } else { modes.max(attitude) };
    let why = if influence == 0.0 {
        "No two modes that move are coupled by turning.".into()
    } else {
        format!(
            "Turning couples modes by up to {value:.1e}: {modes:.1e} of the vibration, and what it returns {attitude:.1e} of the rotation."
        )
    };
    Estimate { value, influence, why }
}

fn stiffening(case: &Case, spin: &Spin, response: &Response, stiffness: Option<&Mat<f64>>) -> Estimate {
    let omega = &case.body.circular_frequencies;
    let square = spin.largest * spin.largest;
    let bound = |k: usize| {
        let lowest = omega.iter().copied().fold(f64::INFINITY, f64::min);
        SCREEN * case.body.mass * case.peaks[k] * case.peaks[k] * omega[k] / lowest
    };
    let force = |k: usize, l: usize| match stiffness {
        Some(matrix) => square * matrix[(k, l)],
        None => square * (bound(k) * bound(l)).sqrt(),
    };
    let ratio = |k: usize| force(k, k) / (omega[k] * omega[k]);
    let stiffest = (0..omega.len()).max_by(|k, l| ratio(*k).total_cmp(&ratio(*l)));
    let value = stiffest.map_or(0.0, ratio);
    let influence =
        if square == 0.0 { 0.0 } else { response.change(force, &response.displacement, &vec![0.0; omega.len()]) };
    let why = match (stiffest, stiffness) {
        _ if square == 0.0 => "The body does not turn.".into(),
        (Some(k), Some(_)) => {
            let shift = 100.0 * ((1.0 + value).sqrt() - 1.0);
            format!("The stress of the spin moves the frequency of mode {} by up to {shift:.2} %.", k + 1)
        }
        (Some(k), None) => {
            format!("The stress of the spin might move mode {}; its stiffness has not been computed.", k + 1)
        }
        (None, _) => "There are no modes.".into(),
    };
    Estimate { value, influence, why }
}

/// Influence of what the modes leave out of the static response to the spin; by [`left_out_at_most`] where it is not known.
fn stretch(case: &Case, spin: &Spin, response: &Response) -> f64 {
    if spin.largest == 0.0 || case.body.flexible() == 0 {
        return 0.0;
    }
    let bounds;
    let remainders = match case.centrifugal_remainders {
        [] => {
            bounds = left_out_at_most(case.body);
            &bounds[..]
        }
        known => known,
    };
    // |ω_i ω_j| is at most Ω².
    let left = SPUN * spin.largest * spin.largest * remainders.iter().sum::<f64>();
    relative(left, response.scale + left)
}

/// Influence of what the modes leave out of the static response to the inertia of the drive.
fn pushed(case: &Case, response: &Response) -> f64 {
    let (Some(drive), Some(remainder)) = (case.drive, case.drive_remainder) else { return 0.0 };
    let course = Course::new(&drive.speed.history, case.end, case.costly_histories());
    let left = SWING * drive.speed.amplitude.abs() * course.steepest() * remainder;
    relative(left, response.scale + left)
}

/// Part of the static response to a unit acceleration of the drive that the modes hold, and how much they leave out.
pub(crate) fn held_of_drive(case: &Case) -> Option<(f64, f64)> {
    let (drive, left) = (case.drive?, case.drive_remainder?);
    let (unit, coupling) = of_drive(case.body, drive);
    let answer = |(k, omega): (usize, &f64)| (0..3).map(|i| unit[i] * coupling[i][k]).sum::<f64>() / (omega * omega);
    let carried: Vec<f64> = case.body.circular_frequencies.iter().enumerate().map(answer).collect();
    let carried = norm(&carried);
    Some((if left > 0.0 { carried / carried.hypot(left) } else { 1.0 }, left))
}

/// Part of the static response to a spin that the modes hold, and how much they leave out: √(uᵀMu) of the answer u.
/// `squares` are ω_iω_j.
pub(crate) fn held(case: &Case, squares: &Matrix3<f64>) -> (f64, f64) {
    let left = left_out(case, squares);
    let answer = |k: usize, omega: &f64| {
        let fields = times_of_pairs(squares).zip(&case.body.inertia_first);
        fields.map(|(times, first)| times * first[k]).sum::<f64>() / (omega * omega)
    };
    let carried: Vec<f64> = case.body.circular_frequencies.iter().enumerate().map(|(k, w)| answer(k, w)).collect();
    let carried = norm(&carried);
    (if left > 0.0 { carried / carried.hypot(left) } else { 1.0 }, left)
}

/// The part of the static response to the spin that the modes leave out, at most; see [`held`].
pub(crate) fn left_out(case: &Case, squares: &Matrix3<f64>) -> f64 {
    times_of_pairs(squares).zip(case.centrifugal_remainders).map(|(times, r)| times.abs() * r).sum()
}

/// How many times the field of each pair of axes acts.
fn times_of_pairs(squares: &Matrix3<f64>) -> impl Iterator<Item = f64> {
    ReducedBody::PAIRS.into_iter().map(|(i, j)| if i == j { squares[(i, i)] } else { 2.0 * squares[(i, j)] })
}

/// Bounds of what the modes leave out of the static responses to the centrifugal fields, as
/// [`Case::centrifugal_remainders`]: the field −A_ij x has the norm tr(A S A), S = ∫ x xᵀ dm = ½ tr J − J, the modes
/// have Σc_k² of it, and what is left meets frequencies above theirs.
fn left_out_at_most(body: &ReducedBody) -> [f64; 6] {
    let moments = Matrix3::identity() * (0.5 * body.inertia.trace()) - body.inertia;
    let highest = body.circular_frequencies.iter().copied().fold(0.0, f64::max);
    std::array::from_fn(|pair| {
        let (i, j) = ReducedBody::PAIRS[pair];
        let mut field: Matrix3<f64> = if i == j { Matrix3::identity() } else { Matrix3::zeros() };
        field[(i, j)] -= 0.5;
        field[(j, i)] -= 0.5;
        let carried: f64 = body.inertia_first[pair].iter().map(|c| c * c).sum();
        ((field * moments * field).trace() - carried).max(0.0).sqrt() / (highest * highest)
    })
}

fn static_correction(
    case: &Case,
    spin: &Spin,
    sources: &[Source],
    keep: usize,
    [stretch, pushed]: [f64; 2],
) -> Estimate {
    let omega = &case.body.circular_frequencies;
    let left = |(i, source): (usize, &Source)| match case.static_compliances.get(i) {
        Some(whole) => source.left_out(whole, omega, keep),
        None if source.course.largest == 0.0 => 0.0,
        None => 1.0,
    };
    let value = sources.iter().enumerate().map(left).fold(0.0, f64::max);
    let known = case.static_compliances.len() == sources.len();
    // What is left out may swing about its static response, and is measured over the whole body.
    let influence = relative(SWING * value, 1.0).max(stretch).max(pushed);
    let why = if influence == 0.0 {
        "The modes carry the whole static response.".into()
    } else if pushed >= influence {
        let held = held_of_drive(case).map_or(1.0, |(held, _)| held);
        let left_out = 100.0 * (1.0 - held * held).max(0.0).sqrt();
        format!(
            "The modes leave out {left_out:.1} % of the static response to the acceleration of the drive, which may come to {pushed:.1e} of the deformation."
        )
    } else if stretch > value && case.centrifugal_remainders.is_empty() && known {
        format!(
            "What the modes leave out of the static response to the spin may come to {stretch:.1e} of the deformation."
        )
    } else if !case.centrifugal_remainders.is_empty() && stretch > if known { value } else { 0.0 } {
        let squares = spin.directions * (spin.largest * spin.largest);
        let held = held(case, &squares).0;
        let left_out = 100.0 * (1.0 - held * held).max(0.0).sqrt();
        format!(
            "The modes leave out {left_out:.1} % of the static response to the spin, which may come to {stretch:.1e} of the deformation."
        )
    } else if known {
        format!(
            "The modes that are kept leave out {:.1} % of the static deflection where the loads act.",
            100.0 * value
        )
    } else {
        "The whole static response to the loads is not known.".into()
    };
    Estimate { value, influence, why }
}

/// How far the body bends, for people.
fn bends(case: &Case, deflection: f64) -> String {
    if deflection > 1.0 {
        return "How far vibration bends the body cannot be told before the run.".into();
    }
    format!("Vibration moves no place by more than {} {}.", Number(deflection * case.length), case.length_unit)
}

/// The deflection.
fn bending(case: &Case, deflection: f64) -> Row {
    let influence = relative(SHORTENING * deflection * deflection, 1.0);
    let good = if deflection < LINEAR {
        format!("Linear strain is good to {}.", Number(influence))
    } else {
        "Linear strain ends at a tenth of the length.".into()
    };
    Row { value: deflection, influence, on: deflection >= LINEAR, why: format!("{} {good}", bends(case, deflection)) }
}

/// Σ m_kl x_k y_l
fn double_sum(matrix: &Mat<f64>, x: &[f64], y: &[f64]) -> f64 {
    x.iter().enumerate().map(|(k, x)| x * y.iter().enumerate().map(|(l, y)| matrix[(k, l)] * y).sum::<f64>()).sum()
}
