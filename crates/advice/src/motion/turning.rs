//! The sum of all loads that turn the body as a whole: they may cancel.

use dynamics::History;
use nalgebra::{SMatrix, Vector3};

use crate::motion::case::Case;
use crate::motion::course::Course;
use crate::motion::source::{CANCELLED, Source};

/// Courses of the different histories of the loads, in the same samples; none where fewer than two loads are there to cancel.
pub(crate) struct Histories<'a> {
    courses: Vec<(&'a History, Course)>,
}

/// Bounds of what turns the body, in the scale of the momentum of a spin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turning {
    /// Bound of the impulse.
    pub impulse: f64,
    /// Bound of the force at any time.
    pub force: f64,
}

/// The loads of one history: their sum where it is 1, as it meets the body at the beginning, and of those that turn in the body, how it
/// goes with the attitude.
#[derive(Debug, Clone, Copy)]
struct Group {
    at_start: Vector3<f64>,
    turned: SMatrix<f64, 3, 9>,
}

impl<'a> Histories<'a> {
    pub fn new(case: &'a Case) -> Self {
        if case.loads.len() < 2 {
            return Self { courses: Vec::new() };
        }
        let mut histories: Vec<&History> = Vec::new();
        for load in case.loads {
            let history = load.history().unwrap_or(&History::Constant);
            if !histories.contains(&history) {
                histories.push(history);
            }
        }
        let courses = Course::aligned(&histories, case.end, case.costly_histories());
        Self { courses: histories.into_iter().zip(courses).collect() }
    }
}

impl Turning {
    /// The sum of the bounds of each load, or the bound of their sum where that is less.
    pub fn new(sources: &[Source], histories: &Histories, turn: f64) -> Self {
        let alone = |of: &dyn Fn(&Source) -> f64| sources.iter().map(|s| s.rotation * of(s)).sum::<f64>();
        let alone = Self { impulse: alone(&Source::impulse), force: alone(&|s| s.course.largest) };
        if histories.courses.is_empty() {
            return alone;
        }
        let groups: Vec<(Group, &Course)> = histories
            .courses
            .iter()
            .map(|(history, course)| (Group::new(sources.iter().filter(|s| s.history == **history)), course))
            .collect();
        let component = |i: usize| {
            let parts: Vec<(f64, &Course)> =
                groups.iter().map(|(group, course)| (group.at_start[i], *course)).collect();
            Course::sum(&parts)
        };
        let components = [0, 1, 2].map(component);
        let norm = |of: fn(&Course) -> f64| components.iter().map(|course| of(course).powi(2)).sum::<f64>().sqrt();
        let magnitude: f64 = components.iter().map(|course| course.magnitude_integral).sum();
        // A direction that turns in the body, as one of a single load does, is off by the turn, and no more than its length.
        let astray = |of: fn(&Course) -> f64| {
            groups.iter().map(|(group, course)| turn.min(1.0) * group.worst() * of(course)).sum::<f64>()
        };
        Self {
            impulse: alone.impulse.min(
                (norm(|course| course.net_integral) * (1.0 + turn)).min(magnitude)
                    + astray(|course| course.magnitude_integral),
            ),
            force: alone.force.min(norm(|course| course.largest) + astray(|course| course.largest)),
        }
    }
}

impl Group {
    fn new<'a>(sources: impl Iterator<Item = &'a Source>) -> Self {
        let mut sum = Self { at_start: Vector3::zeros(), turned: SMatrix::zeros() };
        let mut largest = 0.0_f64;
        for source in sources {
            let turning = &source.turning;
            let at_start = turning * source.vector;
            largest = largest.max(at_start.norm());
            sum.at_start += at_start;
            if source.dead {
                sum.turned += source.vector.transpose().kronecker(turning);
            }
        }
        // Of loads that cancel, rounding is left.
        let clean = |x: &mut f64| {
            if x.abs() <= CANCELLED * largest {
                *x = 0.0;
            }
        };
        sum.at_start.iter_mut().for_each(clean);
        sum.turned.iter_mut().for_each(clean);
        sum
    }

    /// Largest of Σ C A v over the rotations A, whose nine entries have the norm √3.
    fn worst(&self) -> f64 {
        3.0_f64.sqrt() * (self.turned * self.turned.transpose()).symmetric_eigenvalues().max().max(0.0).sqrt()
    }
}
