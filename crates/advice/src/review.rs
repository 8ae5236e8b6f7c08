//! After, or during, the run: whether what was assumed has held.

use std::fmt;

use dynamics::{DrivenMotion, Effect, EffectMap, Moment, Observation};
use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};

use crate::limits::{LINEAR, Refusal, deflected, detuned, impossible, refusal};
use crate::motion::case::{AdviceError, Case};
use crate::strain::error_bound::OF_BAR;
use crate::table::number::Number;
use crate::table::relative::relative;
use crate::table::rows::{Advice, held, held_of_drive, left_out};

/// An assumption that has broken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Broken {
    /// The spin rose above what the estimates allow for.
    #[error(
        "at time {time:.6} the spin was {}, above the {} that the estimates allow for: set {off} = true in [effects]",
        Number(*.found), Number(*.assumed)
    )]
    Spin {
        /// When it was so for the first time.
        time: f64,
        /// The largest |ω| there was.
        found: f64,
        /// The largest that was assumed.
        assumed: f64,
        /// The effects that were left out.
        off: String,
    },
    /// The deflection rose above what the estimates allow for.
    #[error(
        "at time {time:.6} the deflection was {found:.3e} of the length, above the {assumed:.3e} that the estimates allow for: set {off} = true in [effects]"
    )]
    Deflection {
        /// When it was so for the first time.
        time: f64,
        /// The largest there was.
        found: f64,
        /// The largest that was assumed.
        assumed: f64,
        /// The effects that were left out.
        off: String,
    },
    /// The strain is not linear.
    #[error("at time {time:.6} the deflection reached {:.1} % of the length{}", 100.0 * .found, Detunings(.modes))]
    Linear {
        /// When it was largest.
        time: f64,
        /// The largest there was.
        found: f64,
        /// The modes whose frequencies that changes noticeably.
        modes: Vec<Detuning>,
    },
    /// The modes do not carry what the spin, or the acceleration of the drive, does to the body.
    #[error(
        "at time {time:.6} the modes left out {:.1} % of the static response to {}, and the answer lacks it, \
         {influence:.1e} of the deformation: take static_correction = true with the scheme exponential, or more modes",
        100.0 * .left_out, if *.of_drive { "the acceleration of the drive" } else { "the spin" }
    )]
    Stretch {
        /// When most was missing.
        time: f64,
        /// Part of the static response that the modes left out.
        left_out: f64,
        /// Part of the whole deformation that was missing.
        influence: f64,
        /// True if it was the response to the acceleration of the drive, not to the spin.
        of_drive: bool,
    },
    /// A spin was reached in which the model has no rest, or a deflection at which it is known to be wrong.
    #[error("at time {time:.6}: {refusal}")]
    Limit {
        /// When it was so for the first time.
        time: f64,
        /// The reason.
        refusal: Refusal,
    },
}

/// Detuning of a mode that swings far: the error of linear strain, by its own [`Backbone`](crate::Backbone) without spin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detuning {
    /// Number of the mode, the first flexible one is 1.
    pub mode: usize,
    /// Its largest deflection over the length of the body.
    pub deflection: f64,
    /// Change of the frequency at that amplitude, relative to the linear one: negative where the linear one is too high.
    pub shift: f64,
    /// Periods that its phase is out by at the end, with the amplitudes that there were, and how many periods there were.
    pub phase: f64,
    /// Periods of the mode in the time that was watched.
    pub periods: f64,
}

/// The modes of [`Broken::Linear`] in words.
struct Detunings<'a>(&'a [Detuning]);

impl fmt::Display for Detunings<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(first) = self.0.first() else {
            return write!(
                f,
                ": linear strain ends at 10 %, and so does what the answer can be trusted for; name the modes that bend the \
                 body in `large` in [modes]"
            );
        };
        write!(f, ", which linear strain does not follow:")?;
        for (i, detuning) in self.0.iter().enumerate() {
            let Detuning { mode, deflection, shift, phase, periods } = *detuning;
            let (comma, way) = (if i == 0 { "" } else { ";" }, if shift < 0.0 { "high" } else { "low" });
            write!(
                f,
                "{comma} at {:.1} % the frequency of mode {mode} is about {:.2} % too {way}, its phase out by {} of a period \
                 after {periods:.1} periods",
                100.0 * deflection,
                100.0 * shift.abs(),
                Number(phase.abs()),
            )?;
        }
        write!(
            f,
            " (each by its own motion, without spin); smaller motions are right, their error goes with the square; name these \
             modes in `large` in [modes], and the run follows them"
        )?;
        if first.phase.abs() > LOST { write!(f, "; the phase is lost") } else { Ok(()) }
    }
}

/// Periods from which on a phase is lost.
const LOST: f64 = 0.25;

/// Something that has passed what was assumed.
#[derive(Debug, Clone, Copy)]
struct Passed {
    /// When it was so for the first time.
    time: f64,
    /// The largest there was.
    found: f64,
}

impl Passed {
    fn note(passed: &mut Option<Self>, time: f64, found: f64) {
        let passed = passed.get_or_insert(Self { time, found });
        passed.found = passed.found.max(found);
    }
}

/// Largest swings of some modes so far, side by side: the number of the mode over [`SIDE_BY_SIDE`] says which.
#[derive(Debug, Clone, Copy, Default)]
struct Swings {
    /// 1/ω, and ω.
    inverse: [f64; SIDE_BY_SIDE],
    omega: [f64; SIDE_BY_SIDE],
    /// Deflection over the length of the body at q = 1; the same of those whose strain is that of large deflection.
    bend: [f64; SIDE_BY_SIDE],
    large_bend: [f64; SIDE_BY_SIDE],
    /// At the last look: q̇, and q² + (q̇/ω)².
    rate: [f64; SIDE_BY_SIDE],
    square: [f64; SIDE_BY_SIDE],
    /// How far they swung between the last two looks.
    reach: [f64; SIDE_BY_SIDE],
    /// Largest |q|, and that beyond which the frequency is out by too much.
    largest: [f64; SIDE_BY_SIDE],
    most: [f64; SIDE_BY_SIDE],
    /// ∫ (q² + (q̇/ω)²) dt.
    integral: [f64; SIDE_BY_SIDE],
}

/// Modes that are gone through together.
const SIDE_BY_SIDE: usize = 4;

impl Swings {
    /// Looks at q and q̇ after so much time.
    #[inline(always)]
    fn look(&mut self, passed: f64, q: &[f64; SIDE_BY_SIDE], v: &[f64; SIDE_BY_SIDE]) {
        let mut reach = [0.0; SIDE_BY_SIDE];
        for i in 0..SIDE_BY_SIDE {
            let scaled = v[i] * self.inverse[i];
            let square = q[i] * q[i] + scaled * scaled;
            let turned = (v[i] * self.rate[i] < 0.0) | (self.omega[i] * passed >= std::f64::consts::PI);
            let furthest = if square > self.square[i] { square } else { self.square[i] };
            reach[i] = if (passed > 0.0) & turned { furthest } else { q[i] * q[i] };
            self.integral[i] += 0.5 * passed * (square + self.square[i]);
            (self.rate[i], self.square[i]) = (v[i], square);
        }
        for (reach, largest) in reach.iter_mut().zip(&mut self.largest) {
            *reach = reach.sqrt();
            *largest = if *reach > *largest { *reach } else { *largest };
        }
        self.reach = reach;
    }
}

/// A look at all modes, with the instructions that the processor has.
struct Look<'s> {
    swings: &'s mut [Swings],
    passed: f64,
    q: &'s [f64],
    v: &'s [f64],
}

/// Findings of a look.
struct LookedAt {
    /// Deflection, that of large modes, and the square of the modes' reach, summed side by side.
    sums: [[f64; SIDE_BY_SIDE]; 3],
    /// True if a mode has gone too far.
    beyond: bool,
}

impl WithSimd for Look<'_> {
    type Output = LookedAt;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> LookedAt {
        let Self { swings, passed, q, v } = self;
        let mut found = LookedAt { sums: [[0.0; SIDE_BY_SIDE]; 3], beyond: false };
        let (whole_q, rest_of_q) = q.as_chunks::<SIDE_BY_SIDE>();
        let (whole_v, rest_of_v) = v.as_chunks::<SIDE_BY_SIDE>();
        let mut rest = [[0.0; SIDE_BY_SIDE]; 2];
        rest[0][..rest_of_q.len()].copy_from_slice(rest_of_q);
        rest[1][..rest_of_v.len()].copy_from_slice(rest_of_v);
        let (whole, others) = swings.split_at_mut(whole_q.len());
        for (swings, (q, v)) in whole.iter_mut().zip(whole_q.iter().zip(whole_v)) {
            swings.look(passed, q, v);
            found.add(swings);
        }
        if let [swings] = others {
            swings.look(passed, &rest[0], &rest[1]);
            found.add(swings);
        }
        found
    }
}

impl LookedAt {
    #[inline(always)]
    fn add(&mut self, swings: &Swings) {
        for (i, reach) in swings.reach.into_iter().enumerate() {
            self.sums[0][i] += reach * swings.bend[i];
            self.sums[1][i] += reach * swings.large_bend[i];
            self.sums[2][i] += reach * reach;
            self.beyond |= reach > swings.most[i];
        }
    }
}

/// Watches a run: [`Self::look`] at every step, [`Self::observe`] at every row.
#[derive(Debug, Clone)]
pub struct Review<'a> {
    case: Case<'a>,
    effects: EffectMap<bool>,
    spin: f64,
    deflection: f64,
    tolerance: f64,
    swings: Vec<Swings>,
    /// Time of the last look, and of the last row.
    time: f64,
    row: Option<f64>,
    /// Largest |ω| since the last row, and when.
    fastest: (f64, Vector3<f64>),
    /// The last |ω| whose limit was looked up, and its direction.
    looked_up: (f64, Vector3<f64>),
    /// The most that the modes left out of the static response to the spin and to the acceleration of the drive, when, and the
    /// part of it.
    left_out: [(f64, f64, f64); 2],
    /// The driven motion, with the part of the static response to its unit acceleration that the modes hold, and how much they
    /// leave out.
    held_of_drive: Option<(DrivenMotion, f64, f64)>,
    /// Lowest natural frequency, rad per time. The centrifugal force takes at most Ω² from the stiffness of a mode, so
    /// that below it nothing can be lost.
    lowest: f64,
    /// Largest √(qᵀq).
    deformation: f64,
    /// Largest deflection over the length by modes that are not large, and when it was that, but for a hundredth.
    bent: f64,
    bent_at: Passed,
    spun_above: Option<Passed>,
    bent_above: Option<Passed>,
    limit: Option<(f64, Refusal)>,
    stop: Option<(f64, Refusal)>,
}

/// Factor on a bound for rounding and for the change of inertia by a small deformation.
const MARGIN: f64 = 1.01;
/// Deflection over length, or angle turned, that is rounding.
const ROUNDING: f64 = 1e-10;
/// The effects of turning and bending.
const OF_TURNING: [Effect; 3] = [Effect::DeformedInertia, Effect::Coriolis, Effect::GeometricStiffening];
/// Change of a frequency, and periods of phase at the end, from which on they are told.
const SHIFTED: f64 = 0.01;
const OUT_OF_PHASE: f64 = 0.02;

impl<'a> Review<'a> {
    /// The review of a run with these effects that `advice` was given on. The case has the modes that are simulated.
    pub fn new(case: Case<'a>, effects: EffectMap<bool>, advice: &Advice) -> Self {
        let most = |k: usize| match case.backbones.get(k) {
            Some(Some(backbone)) => backbone.largest_amplitude(),
            _ => f64::INFINITY,
        };
        let is_large = |k: usize| case.manifold.is_some_and(|manifold| manifold.large().contains(&k));
        let mut swings = vec![
            Swings { most: [f64::INFINITY; SIDE_BY_SIDE], ..Swings::default() };
            case.peaks.len().div_ceil(SIDE_BY_SIDE)
        ];
        for (k, peak) in case.peaks.iter().enumerate() {
            let (swings, i) = (&mut swings[k / SIDE_BY_SIDE], k % SIDE_BY_SIDE);
            swings.omega[i] = case.body.circular_frequencies[k];
            swings.inverse[i] = swings.omega[i].recip();
            swings.bend[i] = peak / case.length;
            swings.large_bend[i] = if is_large(k) { swings.bend[i] } else { 0.0 };
            swings.most[i] = most(k);
        }
        Self {
            case,
            effects,
            spin: advice.spin,
            deflection: advice.deflection,
            tolerance: advice.tolerance,
            swings,
            time: 0.0,
            row: None,
            fastest: (0.0, Vector3::zeros()),
            looked_up: (0.0, Vector3::zeros()),
            left_out: [(0.0, 0.0, 0.0); 2],
            held_of_drive: case.drive.zip(held_of_drive(&case)).map(|(drive, (held, left))| (drive.motion, held, left)),
            lowest: case.body.circular_frequencies.iter().copied().fold(f64::INFINITY, f64::min),
            deformation: 0.0,
            bent: 0.0,
            bent_at: Passed { time: 0.0, found: 0.0 },
            spun_above: None,
            bent_above: None,
            limit: None,
            stop: None,
        }
    }

    /// Looks at the motion at a step. Allocates nothing, and takes some operations for each mode. A list of modal
    /// displacements or velocities of another length is not looked at.
    ///
    /// Between two looks a mode swings as far as √(q² + (q̇/ω)²) of the larger of both, if it turns there or the time
    /// between them is longer than half its period.
    pub fn look(&mut self, moment: &Moment) {
        // The start of the step after a row is the motion of the row.
        if self.row == Some(moment.time) {
            return;
        }
        let Moment { time, omega_body, modal_displacement: q, modal_velocity: v } = *moment;
        if q.len() != self.case.peaks.len() || v.len() != self.case.peaks.len() {
            return;
        }
        let passed = time - self.time;
        self.time = time;
        let LookedAt { sums, beyond: is_beyond } =
            Arch::new().dispatch(Look { swings: &mut self.swings, passed, q, v });
        let mut stopped = None;
        if is_beyond {
            let each = self.swings.iter().flat_map(|swings| swings.reach.into_iter().zip(swings.most)).enumerate();
            let mut far = each.filter(|(_, (reach, most))| reach > most);
            stopped = far.find_map(|(k, (reach, _))| detuned(&self.case, k, reach));
        }
        let [deflection, of_large, deformation] = sums.map(|sums| (sums[0] + sums[2]) + (sums[1] + sums[3]));
        stopped = stopped.or_else(|| impossible(&self.case, q, of_large));
        if self.stop.is_none() {
            self.stop = stopped.or_else(|| deflected(deflection)).map(|refusal| (time, refusal));
        }
        let linear = deflection - of_large;
        self.bent = self.bent.max(linear);
        if linear > MARGIN * self.bent_at.found {
            self.bent_at = Passed { time, found: linear };
        }
        let speed = omega_body.norm();
        if speed > self.fastest.0 {
            self.fastest = (speed, omega_body);
        }
        if self.something_is_off() {
            if speed > MARGIN * self.spin + ROUNDING / self.case.end {
                Passed::note(&mut self.spun_above, time, speed);
            }
            if deflection > MARGIN * self.deflection + ROUNDING {
                Passed::note(&mut self.bent_above, time, deflection);
            }
        }
        self.deformation = self.deformation.max(f64::sqrt(deformation));
    }

    /// Looks at the motion at a row; times rise. Where the spin is near a limit, that is looked up.
    ///
    /// # Errors
    /// An eigenvalue problem without an answer; a list of modal displacements of another length.
    pub fn observe(&mut self, observation: &Observation) -> Result<(), AdviceError> {
        for (what, list) in [
            ("the list of modal displacements", &observation.modal_displacement),
            ("the list of modal velocities", &observation.modal_velocity),
        ] {
            let (found, expected) = (list.len(), self.case.peaks.len());
            if found != expected {
                return Err(AdviceError::Length { what, found, expected });
            }
        }
        self.row = None;
        self.look(&Moment {
            time: observation.time,
            omega_body: observation.omega_body,
            modal_displacement: &observation.modal_displacement,
            modal_velocity: &observation.modal_velocity,
        });
        self.row = Some(observation.time);
        if let Some((motion, held, remainder)) = &self.held_of_drive {
            let left = remainder * observation.acceleration_of(motion).abs();
            if left > self.left_out[1].0 {
                self.left_out[1] = (left, observation.time, (1.0 - held * held).max(0.0).sqrt());
            }
        }
        let between = std::mem::replace(&mut self.fastest, (0.0, Vector3::zeros()));
        for (speed, omega_body) in [between, (observation.omega_body.norm(), observation.omega_body)] {
            if self.effects[Effect::DeformedInertia] && !self.case.centrifugal_remainders.is_empty() {
                let squares = omega_body * omega_body.transpose();
                if left_out(&self.case, &squares) > self.left_out[0].0 {
                    let (held, left) = held(&self.case, &squares);
                    self.left_out[0] = (left, observation.time, (1.0 - held * held).max(0.0).sqrt());
                }
            }
            if speed >= self.lowest && !self.is_known(&omega_body, speed) {
                let axis = omega_body / speed;
                self.looked_up = (speed, axis);
                if let Some(refusal) = refusal(&self.case, &axis, speed, &self.effects)? {
                    self.limit = Some((observation.time, refusal));
                }
            }
        }
        Ok(())
    }

    /// Reason to end the run, and its time: the body bends further than its model can have any meaning.
    pub fn stop(&self) -> Option<(f64, Refusal)> {
        self.stop
    }

    /// Assumptions that have broken so far: each once, with the first time and the worst value.
    pub fn broken(&self) -> Vec<Broken> {
        let (time, limit_of_bending) = (self.bent_at.time, self.stop);
        let modes = self.detunings();
        let spin = self.spun_above.map(|Passed { time, found }| Broken::Spin {
            time,
            found,
            assumed: self.spin,
            off: self.off(),
        });
        let bent = self.bent_above.map(|Passed { time, found }| Broken::Deflection {
            time,
            found,
            assumed: self.deflection,
            off: self.off(),
        });
        let found = self.bent;
        let linear = (found > LINEAR || !modes.is_empty()).then_some(Broken::Linear { time, found, modes });
        let limits =
            [self.limit, limit_of_bending].map(|limit| limit.map(|(time, refusal)| Broken::Limit { time, refusal }));
        let stretch = |(of_drive, (left, time, left_out)): (bool, (f64, f64, f64))| {
            let influence = relative(left, self.deformation.hypot(left));
            (influence >= self.tolerance).then_some(Broken::Stretch { time, left_out, influence, of_drive })
        };
        let stretch = [false, true].into_iter().zip(self.left_out).map(stretch);
        [spin, bent, linear].into_iter().chain(limits).chain(stretch).flatten().collect()
    }

    /// The modes whose frequency, or phase in the time that was watched, linear strain puts out noticeably.
    fn detunings(&self) -> Vec<Detuning> {
        let case = &self.case;
        let of = |(k, backbone): (usize, &Option<crate::Backbone>)| {
            let (swings, i, omega) =
                (self.swings.get(k / SIDE_BY_SIDE)?, k % SIDE_BY_SIDE, case.body.circular_frequencies[k]);
            let (largest, integral) = (swings.largest[i], swings.integral[i]);
            let turns = omega / std::f64::consts::TAU;
            let bend = case.peaks[k] / case.length;
            // Where nobody thought that it would move, as a bar.
            let [shift, curvature] = match backbone {
                Some(backbone) => [backbone.shift(largest), backbone.curvature()],
                None if case.manifold.is_some_and(|manifold| manifold.bent().contains(&k)) => return None,
                None => [-OF_BAR * (largest * bend).powi(2), -OF_BAR * bend * bend],
            };
            let detuning = Detuning {
                mode: k + 1,
                deflection: largest * bend,
                shift,
                phase: curvature * integral * turns,
                periods: self.time * turns,
            };
            let matters = detuning.shift.abs() >= SHIFTED || detuning.phase.abs() >= OUT_OF_PHASE;
            (matters && detuning.deflection >= crate::strain::backbone::LARGE).then_some(detuning)
        };
        case.backbones.iter().enumerate().filter_map(of).collect()
    }

    /// True if an effect of turning and bending was left out, for which the estimates had to hold. What has no modes has none.
    fn something_is_off(&self) -> bool {
        !self.case.peaks.is_empty() && self.turns() && !OF_TURNING.into_iter().all(|effect| self.effects[effect])
    }

    /// True if the body can turn: if not, nothing of turning is left out, whatever is off.
    fn turns(&self) -> bool {
        let is_turned = |drive: &dynamics::Drive| matches!(drive.motion, dynamics::DrivenMotion::Turn { .. });
        self.case.drive.is_some_and(is_turned)
            || self.effects[Effect::Rotation] && !self.case.body.motion.rotations().is_empty()
    }

    /// The names of those effects that are off.
    fn off(&self) -> String {
        let off = OF_TURNING.into_iter().filter(|effect| !self.effects[*effect]);
        off.map(Effect::name).collect::<Vec<_>>().join(" = true, ")
    }

    /// True if a limit has broken, or was looked up for about this spin: it costs an eigenvalue problem.
    fn is_known(&self, omega_body: &Vector3<f64>, speed: f64) -> bool {
        let (fastest, axis) = &self.looked_up;
        self.limit.is_some() || speed < 1.02 * fastest && omega_body.dot(axis).abs() > 0.999 * speed
    }
}
