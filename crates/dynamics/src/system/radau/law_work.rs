//! The work of laws in a step, found twice, and the kinks of laws.
//!
//! The stages of a step sum up the work of a law; so does a finer rule along the polynomials of the step. Where the law has a kink, a
//! jump, or much curvature within the step, the two differ: by energy that the step makes or loses. Eqs. (J23) of
//! `docs/method/systems.md`.

use crate::error::RateError;
use crate::system::collocation::{Collocation, STAGES};
use crate::system::description::System;
use crate::system::joint::work::JointWork;
use crate::system::stage::{Stage, Start};

/// Nodes and weights of Lobatto's rule with five points, from 0 to 1.
const NODES: [f64; 5] = [0.0, 0.172_673_164_646_011_43, 0.5, 0.827_326_835_353_988_6, 1.0];
const WEIGHTS: [f64; 5] = [0.05, 49.0 / 180.0, 16.0 / 45.0, 49.0 / 180.0, 0.05];
/// Rounding of works over the sum of their parts.
const ROUNDING: f64 = 1e-13;
/// Places in a step where kinks are looked for, beside the first.
const PLACES: u32 = 10;
/// The first of them, as a part of the step: a kink before it is the one where the step began.
const FIRST_PLACE: f64 = 1e-3;
/// Bisections of the part of a step in which there is a kink.
const BISECTIONS: u32 = 24;
/// Part of the way to a kink by which a step ends before it, so that the whole step is on one side.
const BEFORE: f64 = 1e-5;

/// Works of laws in a step, and room for them.
#[derive(Debug, Clone)]
pub(in crate::system) struct LawWork {
    stage: Stage,
    /// Works of the forces of joints, and of elements, whose energy no formula tells, by the finer rule.
    pub(super) joints: Vec<JointWork>,
    pub(super) elements: Vec<JointWork>,
    /// Work that the stages sum up less that of the finer rule, and the sum of the sizes of both: of the joints, then of the elements.
    differences: Vec<[f64; 2]>,
    /// Coordinates of the forces of joints at the start and at the end of the step, and true if they are beyond a stop between.
    ends: Vec<[f64; 2]>,
    is_touched: Vec<bool>,
    /// Energy of the springs of joints at stops at the end of the step less that at its start; none without a touch.
    stored: Vec<Option<f64>>,
    switches: [Vec<f64>; 2],
    pub(super) has_work: bool,
    pub(super) has_friction: bool,
    has_switches: bool,
}

/// A step with its polynomials: increments at its stages.
#[derive(Clone, Copy)]
pub(super) struct Path<'a> {
    pub system: &'a System,
    pub start: &'a Start,
    pub scheme: &'a Collocation,
    pub increments: [&'a [f64]; STAGES],
    pub h: f64,
}

impl Path<'_> {
    /// Takes a stage to a part of the step, and returns its times.
    fn follow(&self, part: f64, stage: &mut Stage) -> [f64; 2] {
        let Self { system, start, scheme, increments, h } = self;
        let rates = scheme.rates_at(part).map(|factor| factor / h);
        let time = start.time + part * h;
        stage.follow((system, start), *increments, [scheme.at(part), rates]);
        [time, start.time + 0.5 * h]
    }
}

impl LawWork {
    /// Room for the laws of a system.
    pub(super) fn new(system: &System, stage: &Stage) -> Self {
        let connections = &system.connections;
        let [joints, elements] = [connections.joints.len(), connections.elements.len()];
        Self {
            stage: stage.clone(),
            joints: vec![JointWork::default(); joints],
            elements: vec![JointWork::default(); elements],
            differences: vec![[0.0; 2]; joints + elements],
            ends: vec![[0.0; 2]; stage.joint_powers.len()],
            is_touched: vec![false; stage.joint_powers.len()],
            stored: vec![None; joints],
            switches: [Vec::new(), Vec::new()],
            has_work: connections.joint_forces().any(|(.., force)| force.has_work()) || elements > 0,
            has_friction: connections.joint_forces().any(|(.., force)| force.friction.is_some()),
            has_switches: true,
        }
    }

    /// Finds which laws have kinks that they tell, where the system is.
    pub(super) fn find_first(&mut self, system: &System, start: &Start) {
        let Self { stage, switches: [first, _], has_switches, .. } = self;
        stage.x.fill(0.0);
        stage.velocities.fill(0.0);
        stage.place(system, start);
        // Steps tell of those that are not numbers.
        *has_switches = stage.find_switches(system, start, [start.time; 2], first).is_err() || !first.is_empty();
    }

    /// Finds the works from the start of a step to a part of it.
    pub(super) fn find(&mut self, path: &Path<'_>, to: f64) {
        self.joints.fill(JointWork::default());
        self.elements.fill(JointWork::default());
        self.differences.fill([0.0; 2]);
        self.stored.fill(None);
        self.is_touched.fill(false);
        if !self.has_work {
            return;
        }
        for half in [0.0, 0.5] {
            for (node, weight) in NODES.iter().zip(WEIGHTS) {
                // The middle counts for both halves.
                if half > 0.0 && *node == 0.0 {
                    continue;
                }
                let part = half + 0.5 * node;
                let weight = if part == 0.5 { 2.0 * weight } else { weight };
                let times = path.follow(to * part, &mut self.stage);
                self.stage.find_powers(path.system, path.start, times);
                self.add(path.system, 0.5 * weight * to * path.h);
                self.look_at_stops(path.system, part);
            }
        }
    }

    /// Keeps the coordinates of stops at the ends of the step, and whether they are touched.
    fn look_at_stops(&mut self, system: &System, part: f64) {
        let forces = system.connections.joint_forces().zip(&self.stage.constraints.coordinates);
        for (((.., force), x), (ends, is_touched)) in forces.zip(self.ends.iter_mut().zip(&mut self.is_touched)) {
            *is_touched |= force.is_at_stop(*x);
            if part == 0.0 {
                ends[0] = *x;
            }
            ends[1] = *x;
        }
    }

    /// Adds the powers of the stage, times a weight, to the works of the finer rule.
    fn add(&mut self, system: &System, weight: f64) {
        let Self { stage, joints, elements, differences, .. } = self;
        let (of_joints, of_elements) = differences.split_at_mut(joints.len());
        let count = |sums: &mut [f64; 2], work: f64| {
            sums[0] -= weight * work;
            sums[1] += weight * work.abs();
        };
        for ((joint, ..), powers) in system.connections.joint_forces().zip(&stage.joint_powers) {
            let powers = powers.of_laws();
            joints[joint].add(weight, &powers);
            count(&mut of_joints[joint], powers.given());
        }
        for ((work, power), sums) in elements.iter_mut().zip(&stage.element_powers).zip(of_elements) {
            let power = JointWork { spring: 0.0, ..*power };
            work.add(weight, &power);
            count(sums, power.given());
        }
    }

    /// Energy that the step makes or loses at laws: the work that its stages sum up along its polynomials, less the work. After
    /// [`Self::find`] to its end.
    pub(super) fn made(&mut self, path: &Path<'_>) -> f64 {
        if !self.has_work {
            return 0.0;
        }
        let Path { system, start, scheme, h, .. } = *path;
        // Of springs beside stops that are touched.
        for (number, (joint, _, force)) in system.connections.joint_forces().enumerate() {
            if self.is_touched[number] {
                let [start, end] = self.ends[number];
                *self.stored[joint].get_or_insert(0.0) += force.energy(end) - force.energy(start);
            }
        }
        for (part, weight) in scheme.times.into_iter().zip(scheme.weights) {
            let times = path.follow(part, &mut self.stage);
            self.stage.find_powers(system, start, times);
            let weight = weight * h;
            let Self { stage, joints, differences, stored, .. } = self;
            let (of_joints, of_elements) = differences.split_at_mut(joints.len());
            let count = |sums: &mut [f64; 2], work: f64| {
                sums[0] += weight * work;
                sums[1] += weight * work.abs();
            };
            for ((joint, ..), powers) in system.connections.joint_forces().zip(&stage.joint_powers) {
                count(&mut of_joints[joint], powers.of_laws().given());
                if stored[joint].is_some() {
                    count(&mut of_joints[joint], powers.spring);
                }
            }
            for (power, sums) in stage.element_powers.iter().zip(of_elements) {
                count(sums, JointWork { spring: 0.0, ..*power }.given());
            }
        }
        for (sums, stored) in self.differences.iter_mut().zip(&self.stored) {
            sums[0] += stored.unwrap_or_default();
        }
        let seen = |[difference, size]: &[f64; 2]| {
            let difference = difference.abs();
            if difference <= ROUNDING * size { 0.0 } else { difference }
        };
        self.differences.iter().map(seen).sum()
    }

    /// Energy that has come and gone at laws in the step.
    pub(super) fn exchanged(&self) -> f64 {
        // Of the finer rule and of the stages.
        0.5 * self.differences.iter().map(|[_, size]| size).sum::<f64>()
    }

    /// The part of a step after which a law has its first kink of those that laws tell; none without.
    ///
    /// # Errors
    /// [`RateError::Switch`].
    pub(super) fn first_kink(&mut self, path: &Path<'_>) -> Result<Option<f64>, RateError> {
        if !self.has_switches {
            return Ok(None);
        }
        let Self { stage, switches: [before, after], .. } = self;
        let mut find = |part: f64, out: &mut Vec<f64>| {
            let times = path.follow(part, stage);
            stage.find_switches(path.system, path.start, times, out)
        };
        let mut last = FIRST_PLACE;
        find(last, before)?;
        for place in 1..=PLACES {
            let next = f64::from(place) / f64::from(PLACES);
            find(next, after)?;
            if is_passed(before, after) {
                let [mut low, mut high] = [last, next];
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (low + high);
                    find(middle, after)?;
                    *(if is_passed(before, after) { &mut high } else { &mut low }) = middle;
                }
                return Ok(Some(low * (1.0 - BEFORE)));
            }
            std::mem::swap(before, after);
            last = next;
        }
        Ok(None)
    }
}

/// True if one of these functions changes its sign.
fn is_passed(before: &[f64], after: &[f64]) -> bool {
    let is_beyond = |x: &f64| x.partial_cmp(&0.0).map(|order| order.is_gt());
    before.iter().zip(after).any(|(a, b)| matches!((is_beyond(a), is_beyond(b)), (Some(a), Some(b)) if a != b))
}
