//! The frames in which steps are taken, one for each island: bodies that joints or elements connect, not by way of the ground.
//!
//! A frame stands at a place near the bodies, and where nothing ties them to the ground it moves with their centre of mass:
//!
//! ```text
//! r_b − a(t),  P_b − m_b U,  h_b = (r_b − c)×(P_b − m_b U) + A_bᵀ π_b        a(t) = a₀ + U (t − t₀),  c = the centre of mass of the start
//! ```
//!
//! Far from the origin, and of a body that flies fast, what bodies do to each other would be small differences of large numbers. Places of the
//! ground are counted from a₀, too. Eq. (J37) of `docs/method/systems.md`.

use nalgebra::Vector3;

use crate::body::motion_state::MotionState;
use crate::conservative::frame::Frame;
use crate::conservative::{ConservativeBody, get, part, set};
use crate::state::State;
use crate::system::collocation::STAGES;
use crate::system::description::System;
use crate::system::description::islands::Island;
use crate::system::radau::SystemMotion;
use crate::system::radau::past::Past;
use crate::system::stage::{put, vector};

/// Gap of joints over the rounding of the places on the ground between which they are.
pub(crate) const GAP: f64 = 8.0;
/// Way of the centre of mass in its frame, over the size of the island, from which it gets a new frame.
const STRAYED: f64 = 100.0;

impl System {
    /// Gives the bodies frames in which they begin in these states, and the markers on the ground the anchors of these.
    pub(crate) fn begin_at(&mut self, states: &[MotionState]) {
        for (body, state) in self.bodies.iter_mut().zip(states) {
            body.begin_at(state.attitude, state.origin_global, Frame::GLOBAL);
        }
        self.rounding = 0.0;
        for island in self.islands.clone() {
            let on_ground = self.ground_of(&island);
            // One place may be anywhere.
            if on_ground.len() > 1 {
                let farthest = on_ground.iter().map(Vector3::amax).fold(0.0, f64::max);
                self.rounding = self.rounding.max(GAP * f64::EPSILON * farthest);
            }
            self.find_frame(&island, &on_ground, states);
        }
        let Self { bodies, connections, .. } = self;
        let frames: Vec<Frame> = bodies.iter().map(|body| body.frame).collect();
        connections.each_tie(|markers| {
            let frame = markers.iter().find_map(|marker| frames.get(marker.body()?));
            let anchor = frame.map_or_else(Vector3::zeros, Frame::anchor);
            markers.iter_mut().for_each(|marker| marker.count_from(anchor));
        });
    }

    /// Finds the frame of an island.
    fn find_frame(&mut self, island: &Island, on_ground: &[Vector3<f64>], states: &[MotionState]) {
        let Some(first) = island.bodies.first().and_then(|body| states.get(*body)) else { return };
        let (mut mass, mut moment, mut momentum) = (0.0, Vector3::zeros(), Vector3::zeros());
        for b in &island.bodies {
            let (own, state) = (self.bodies[*b].mass(), &states[*b]);
            mass += own;
            moment += (state.origin_global - first.origin_global) * own;
            momentum += (state.velocity_global - first.velocity_global) * own;
        }
        let center = first.origin_global + moment / mass;
        // Bodies may still be far from where joints on the ground take them.
        let (about, spread) = if on_ground.is_empty() {
            let spread = island.bodies.iter().map(|b| (states[*b].origin_global - center).norm());
            (center, spread.fold(0.0, f64::max))
        } else {
            let start = on_ground[0];
            let mean =
                start + on_ground.iter().map(|place| place - start).sum::<Vector3<f64>>() / on_ground.len() as f64;
            (mean, on_ground.iter().map(|place| (place - mean).norm()).fold(0.0, f64::max))
        };
        let size = island.bodies.iter().map(|b| self.sizes[*b]).fold(spread, f64::max);
        let flies = !island.is_on_ground;
        let velocity = if flies { first.velocity_global + momentum / mass } else { Vector3::zeros() };
        let frame = Frame::new(Frame::anchor_near(&about, size), velocity, first.time, center);
        island.bodies.iter().for_each(|b| self.bodies[*b].frame = frame);
    }

    /// Places of the ground that hold the bodies of an island.
    fn ground_of(&self, island: &Island) -> Vec<Vector3<f64>> {
        let mut places = Vec::new();
        for markers in self.connections.ties() {
            if markers.iter().any(|marker| marker.body().is_some_and(|body| island.bodies.contains(&body))) {
                let on_ground = markers.iter().filter(|marker| marker.body().is_none());
                places.extend(on_ground.map(|marker| marker.position()));
            }
        }
        places
    }
}

impl SystemMotion {
    /// Gives islands new frames whose centre of mass has gone far from where it was in theirs, as long accelerations take it. Between steps.
    pub(in crate::system) fn follow_islands(&mut self) {
        let Self { system, bodies: states, time, last, last_length, past, scheme, .. } = self;
        let System { islands, bodies, sizes, first, .. } = system;
        for island in islands.iter().filter(|island| !island.is_on_ground) {
            let of = |part: usize| {
                let (bodies, states) = (&*bodies, &*states);
                island.bodies.iter().map(move |b| (get(bodies[*b].list(&states[*b]).slow(), part), bodies[*b].mass()))
            };
            let mass: f64 = of(part::POSITION).map(|(_, mass)| mass).sum();
            let center = of(part::POSITION).map(|(place, mass)| place * mass).sum::<Vector3<f64>>() / mass;
            let Some(frame) = island.bodies.first().map(|body| bodies[*body].frame) else { continue };
            let spread = of(part::POSITION).map(|(place, _)| (place - center).norm()).fold(0.0, f64::max);
            let size = island.bodies.iter().map(|b| sizes[*b]).fold(spread, f64::max);
            let strayed = center - frame.center();
            // A NaN stays where it is; a point alone has no size.
            if size == 0.0 || strayed.norm().partial_cmp(&(STRAYED * size)).is_none_or(|order| order.is_le()) {
                continue;
            }
            let faster = of(part::MOMENTUM).map(|(momentum, _)| momentum).sum::<Vector3<f64>>() / mass;
            let shift = Frame::anchor_near(&center, size);
            let moved = frame.moved_by(&shift, &faster, *time).about(center - shift);
            let at_end = scheme.at_end.unwrap_or([0.0, 0.0, 1.0]);
            let change = Change { faster, strayed, length: *last_length, times: scheme.times, at_end };
            for b in &island.bodies {
                let (body, state) = (&mut bodies[*b], &mut states[*b]);
                let own = (first[*b], body.mass(), get(body.list(state).slow(), part::MOMENTUM));
                if !scheme.is_explicit {
                    change.apply_to_last(own, last);
                    change.apply_to_past(first[*b], past);
                }
                change_frame(body, state, [&shift, &faster]);
                body.frame = moved;
            }
        }
    }
}

/// A frame that goes on faster about a centre that has strayed from the one before, as the last step is to be seen from it.
struct Change {
    faster: Vector3<f64>,
    strayed: Vector3<f64>,
    /// The length of the last step, and the parts of it at which its stages are.
    length: f64,
    times: [f64; STAGES],
    /// Factors of the stages in the end of the step.
    at_end: [f64; STAGES],
}

impl Change {
    /// The place of the centre before from the new one, a time after now.
    fn offset(&self, time: f64) -> Vector3<f64> {
        -self.strayed - self.faster * time
    }

    /// Increments of the stages of the last step, of a body with its first coordinate, its mass and its momentum in the frame before:
    ///
    /// ```text
    /// r' = r − dU τ + …,   P' = P − m dU,   h' = h + (d − dU τ)×P − m (r − c + d)×dU      τ: time from now, d = c − c'
    /// ```
    fn apply_to_last(&self, (first, mass, momentum): (usize, f64, Vector3<f64>), last: &mut [[Vec<f64>; 2]; STAGES]) {
        let given: Vector3<f64> = self.at_end.iter().zip(&*last).map(|(part, [_, y])| vector(y, first) * *part).sum();
        let at_start = momentum - given;
        for (time, [x, y]) in self.times.into_iter().zip(last) {
            let [moved, given, turned] = [vector(x, first), vector(y, first), vector(y, first + 3)];
            let turned = turned + self.offset((time - 1.0) * self.length).cross(&(at_start + given))
                - self.offset(-self.length).cross(&at_start)
                - moved.cross(&self.faster) * mass;
            put(x, first, &(moved - self.faster * (time * self.length)));
            put(y, first + 3, &turned);
        }
    }

    /// The rates at the start and at the end of the last step.
    fn apply_to_past(&self, first: usize, past: &mut Past) {
        for (time, [x, y]) in [(-self.length, &mut past.start), (0.0, &mut past.end)] {
            let [velocity, force, moment] = [vector(x, first), vector(y, first), vector(y, first + 3)];
            put(x, first, &(velocity - self.faster));
            put(y, first + 3, &(moment + self.offset(time).cross(&force)));
        }
    }
}

/// Takes the state of a body to a frame that is elsewhere and faster by these.
fn change_frame(body: &ConservativeBody, state: &mut State, [shift, faster]: [&Vector3<f64>; 2]) {
    let mut list = body.list_mut(state);
    let mut slow = *list.slow();
    let [position, momentum, impulse] = [part::POSITION, part::MOMENTUM, part::IMPULSE].map(|part| get(&slow, part));
    set(&mut slow, part::POSITION, &(position - shift));
    set(&mut slow, part::MOMENTUM, &(momentum - faster * body.mass()));
    slow[part::WORK] -= faster.dot(&impulse);
    list.set_slow(&slow);
}
