//! The motions of a run, led from time to time and changed on the way.

use dynamics::faer::Mat;
use dynamics::nalgebra::Vector3;
use dynamics::reduced_body::{BodyPoint, ReducedBody};
use dynamics::{DescribedBody, Manifold, MotionState, Observation, PointShapes, Work};
use std::sync::Arc;

use crate::change::Change;
use crate::error::LiveError;
use crate::motion::{Motion, prolong, show_every};
use crate::pull::Pull;
use crate::run::LiveRun;

/// Numbers of a body in [`Player::numbers`] before its modal displacements.
pub const BODY_NUMBERS: usize = 27;

/// A run that is led on.
#[derive(Debug)]
pub struct Player {
    /// As recorded, but for the rows.
    run: LiveRun,
    motions: Vec<Motion>,
    /// Values that are not those of the recorded run.
    changes: Vec<(Change, f64)>,
    /// A pull, and the body of the page that it pulls at.
    pull: Option<(usize, Pull)>,
    /// Work and impulses of each body of the page before its motion was made anew.
    done: Vec<Work>,
    time: f64,
    /// True as long as nothing was changed.
    is_recorded: bool,
    numbers: Vec<f64>,
}

impl Player {
    /// Begins a run. Systems are seen at least every `frame`.
    ///
    /// # Errors
    /// [`LiveError`] where a motion cannot begin.
    pub fn new(mut run: LiveRun, frame: f64) -> Result<Self, LiveError> {
        run.check()?;
        if !(frame > 0.0 && frame.is_finite()) {
            return Err(LiveError::Value { what: "the time of a frame", found: frame, expected: "a positive number" });
        }
        run.motions.iter_mut().for_each(|motion| show_every(&mut motion.run, frame));
        let motions = run.motions.iter().map(|motion| Motion::begin(&motion.run, None)).collect::<Result<_, _>>()?;
        let (changes, pull, done) = (Vec::new(), None, vec![Work::default(); run.bodies()]);
        let mut player = Self { run, motions, changes, pull, done, time: 0.0, is_recorded: true, numbers: Vec::new() };
        player.lead_to(0.0)?;
        Ok(player)
    }

    /// Time that has been led to.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// True as long as nothing was changed: up to its end the motion is the recorded one.
    pub fn is_recorded(&self) -> bool {
        self.is_recorded
    }

    /// Steps taken since the motions began, or were changed.
    pub fn steps(&self) -> u64 {
        self.motions.iter().map(Motion::steps).sum()
    }

    /// Goes back to the beginning, with nothing changed.
    ///
    /// # Errors
    /// [`LiveError`].
    pub fn restart(&mut self) -> Result<(), LiveError> {
        let begin = |motion: &crate::run::LiveMotion| Motion::begin(&motion.run, None);
        self.motions = self.run.motions.iter().map(begin).collect::<Result<_, _>>()?;
        self.done.fill(Work::default());
        (self.changes, self.pull, self.time, self.is_recorded) = (Vec::new(), None, 0.0, true);
        self.lead_to(0.0)
    }

    /// Steps all motions to a time; beyond the end of the recorded run they go on. A time that has passed changes nothing.
    ///
    /// # Errors
    /// [`LiveError::Step`] of a step that fails: the motions stay where they were before it.
    pub fn lead_to(&mut self, time: f64) -> Result<(), LiveError> {
        let time = time.max(self.time);
        for motion in 0..self.motions.len() {
            let end = self.motions[motion].end();
            self.motions[motion].lead_to(time.min(end))?;
            if time > end {
                // The recorded run is over: the same goes on.
                self.begin_anew(motion, None, time)?;
                self.motions[motion].lead_to(time)?;
            }
        }
        self.time = time;
        self.write_numbers();
        Ok(())
    }

    /// Value of something that may be changed.
    pub fn value(&self, of: Change) -> f64 {
        self.changes.iter().find(|(change, _)| *change == of).map_or(of.recorded(), |(_, value)| *value)
    }

    /// Changes something, from the state that has been reached on.
    ///
    /// # Errors
    /// [`LiveError`] where the run does not have it or cannot go on with it; all then stays as it was.
    pub fn set(&mut self, change: Change, value: f64) -> Result<(), LiveError> {
        change.check(value)?;
        let motion = self.motion_of(change)?;
        let before = self.changes.clone();
        self.changes.retain(|(other, _)| *other != change);
        if value != change.recorded() {
            self.changes.push((change, value));
        }
        self.begin_anew(motion, None, self.time).inspect_err(|_| self.changes = before)?;
        self.is_recorded = false;
        Ok(())
    }

    /// Sets the magnitude of a body's angular velocity. A body that does not turn is turned about its z axis. Joints let the
    /// body have what fits them.
    ///
    /// # Errors
    /// [`LiveError`] for a body that is not there, and a number that is not finite.
    pub fn set_spin(&mut self, body: usize, spin: f64) -> Result<(), LiveError> {
        let [motion, own] = self.run.place_of(body).ok_or(LiveError::Nothing { what: "such body" })?;
        if !spin.is_finite() {
            return Err(LiveError::Value { what: "a spin", found: spin, expected: "a finite number" });
        }
        let mut states = self.motions[motion].states()?;
        let omega = &mut states[own].omega_body;
        *omega = omega.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vector3::z) * spin;
        self.begin_anew(motion, Some(&states), self.time)?;
        self.is_recorded = false;
        Ok(())
    }

    /// Begins to pull at a place of a body: at `position_body` from its origin, where its [coordinates](Self::coordinates) have the `shapes`,
    /// three numbers each, towards `target_global`, by a spring and a damper.
    ///
    /// # Errors
    /// [`LiveError`] for a place whose shapes are not those of the body.
    pub fn pull(
        &mut self,
        body: usize,
        position_body: Vector3<f64>,
        shapes: &[f64],
        spring_and_damper: [f64; 2],
        target_global: Vector3<f64>,
    ) -> Result<(), LiveError> {
        let [motion, own] = self.run.place_of(body).ok_or(LiveError::Nothing { what: "such body" })?;
        let body_of_shapes = body_of_shapes(&self.run.motions[motion].run.bodies[own]);
        let (flexible, coordinates) = (body_of_shapes.flexible(), self.coordinates(body));
        if shapes.len() != 3 * coordinates {
            return Err(LiveError::Shapes { found: shapes.len(), expected: 3 * coordinates });
        }
        let numbers = position_body.iter().chain(shapes).chain(&spring_and_damper).chain(&target_global);
        if let Some(found) = numbers.copied().find(|number| !number.is_finite()) {
            return Err(LiveError::Value { what: "a number of a pull", found, expected: "a finite number" });
        }
        let (shapes, rest) = shapes.split_at(3 * flexible);
        let position_body = position_body + rest.first_chunk().map_or_else(Vector3::zeros, |rest| Vector3::from(*rest));
        let shapes = Mat::from_fn(3, flexible, |i, k| shapes[3 * k + i]);
        let point = PointShapes::new(body_of_shapes, &BodyPoint { position_body, shapes });
        self.let_go()?;
        self.pull = Some((body, Pull::new(point, spring_and_damper, target_global)));
        self.begin_anew(motion, None, self.time).inspect_err(|_| self.pull = None)?;
        self.is_recorded = false;
        Ok(())
    }

    /// Moves the place that is pulled to.
    ///
    /// # Errors
    /// [`LiveError::Nothing`] without a pull, [`LiveError::Value`].
    pub fn move_pull(&mut self, target_global: Vector3<f64>) -> Result<(), LiveError> {
        let (body, pull) = self.pull.as_ref().ok_or(LiveError::Nothing { what: "pull" })?;
        if let Some(found) = target_global.iter().copied().find(|number| !number.is_finite()) {
            return Err(LiveError::Value { what: "a place to pull to", found, expected: "a finite number" });
        }
        pull.move_to(target_global);
        if let Some([motion, _]) = self.run.place_of(*body) {
            self.motions[motion].loads_have_changed();
        }
        Ok(())
    }

    /// Ends a pull, if there is one.
    ///
    /// # Errors
    /// [`LiveError`].
    pub fn let_go(&mut self) -> Result<(), LiveError> {
        let Some((body, _)) = self.pull.take() else { return Ok(()) };
        match self.run.place_of(body) {
            Some([motion, _]) => self.begin_anew(motion, None, self.time),
            None => Ok(()),
        }
    }

    /// The state, number by number: the time; of each body of the page its origin (3), its attitude (w, x, y, z), its angular
    /// velocity (3, body axes), kinetic energy, strain energy, work of the loads and dissipation, linear and angular momentum
    /// (3 each), the balance of energy (1), of linear and of angular momentum (3 each), the coordinates of its shapes; at last the point
    /// that is pulled at, and the force on it (3 each, zeros without a pull). Vectors are global where nothing else is said.
    pub fn numbers(&self) -> &[f64] {
        &self.numbers
    }

    /// Number of coordinates of a body's shapes: of its flexible modes, of the shapes that follow large ones, and of the bent rest that its
    /// modes are about, which is always 1.
    pub fn coordinates(&self, body: usize) -> usize {
        self.described(body).map_or(0, |of| body_of_shapes(of).flexible() + usize::from(is_about_rest(of)))
    }

    fn described(&self, body: usize) -> Option<&DescribedBody> {
        let [motion, own] = self.run.place_of(body)?;
        self.run.motions.get(motion)?.run.bodies.get(own)
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.run.bodies()
    }

    fn seen(&self, body: usize) -> Option<&Observation> {
        let [motion, own] = self.run.place_of(body)?;
        self.motions.get(motion)?.observations.get(own)
    }

    /// The number of the motion of a change, which the run must have.
    fn motion_of(&self, change: Change) -> Result<usize, LiveError> {
        match change {
            Change::Load { body, .. } | Change::Damping { body } | Change::Drive { body } => {
                self.run.place_of(body).map(|[motion, _]| motion).ok_or(LiveError::Nothing { what: "such body" })
            }
            Change::JointStiffness { motion, .. }
            | Change::JointDamping { motion, .. }
            | Change::JointMotor { motion, .. }
            | Change::Element { motion, .. }
                if motion < self.motions.len() =>
            {
                Ok(motion)
            }
            _ => Err(LiveError::Nothing { what: "such joint or spring" }),
        }
    }

    /// Begins a motion anew with all changes, from the state that it has come to or another one.
    fn begin_anew(&mut self, motion: usize, states: Option<&[MotionState]>, time: f64) -> Result<(), LiveError> {
        let mut run = self.run.motions[motion].run.clone();
        run.start = dynamics::Start::AsPlaced; // it has begun
        let longer = until(run.end, time);
        prolong(&mut run, longer);
        let of_page = &self.run.motions[motion].bodies;
        for (change, value) in &self.changes {
            let body = match change {
                Change::Load { body, .. } | Change::Damping { body } | Change::Drive { body } => *body,
                _ => 0,
            };
            let own = of_page.iter().position(|of| *of == body);
            if self.motion_of(*change)? == motion {
                change.apply(*value, own.unwrap_or_default(), &mut run)?;
            }
        }
        if let Some((body, pull)) = &self.pull
            && let Some(own) = of_page.iter().position(|of| of == body)
        {
            let body = &mut run.bodies[own];
            body.loads.push(Arc::new(pull.clone()));
            body.points.push(PointShapes::clone(&pull.point)); // its motion is that of the last point
        }
        let reached = self.motions[motion].states()?;
        let begun = Motion::begin(&run, Some(states.unwrap_or(&reached)))?;
        let before = std::mem::replace(&mut self.motions[motion], begun);
        let seen = before.observations.iter().zip(&self.motions[motion].observations);
        for (body, (before, after)) in of_page.iter().zip(seen) {
            self.done[*body] = carried(&self.done[*body], before, after);
        }
        self.write_numbers();
        Ok(())
    }

    fn write_numbers(&mut self) {
        let mut numbers = std::mem::take(&mut self.numbers);
        numbers.clear();
        numbers.push(self.time);
        for (body, seen) in (0..self.bodies()).filter_map(|body| Some((body, self.seen(body)?))) {
            numbers.extend(&seen.origin_global);
            numbers.extend(seen.attitude.wxyz());
            numbers.extend(&seen.omega_body);
            let done = &self.done[body];
            let (work, dissipation) = (seen.work.work + done.work, seen.work.dissipation + done.dissipation);
            numbers.extend([seen.kinetic_energy, seen.strain_energy, work, dissipation]);
            numbers.extend(&seen.linear_momentum_global);
            numbers.extend(&seen.angular_momentum_global);
            numbers.push(seen.energy_balance() - done.work + done.dissipation);
            numbers.extend(&(seen.linear_balance_global() - done.impulse_global));
            numbers.extend(&(seen.angular_balance_global() - done.angular_impulse_global));
            self.add_coordinates(body, &seen.modal_displacement, &mut numbers);
        }
        let [point, force] = self.pulled().unwrap_or_default();
        numbers.extend(&point);
        numbers.extend(&force);
        self.numbers = numbers;
    }

    /// Adds the coordinates of a body's shapes to a list.
    fn add_coordinates(&self, body: usize, modal_displacement: &[f64], to: &mut Vec<f64>) {
        let Some(described) = self.described(body) else { return };
        match &described.physics.large_deflection {
            Some(manifold) => {
                let before = to.len();
                to.resize(before + manifold.body().flexible(), 0.0);
                manifold.coordinates(modal_displacement, &mut to[before..]);
            }
            None => to.extend(modal_displacement),
        }
        if is_about_rest(described) {
            to.push(1.0);
        }
    }

    /// The point that is pulled at, and the force on it, global components.
    fn pulled(&self) -> Option<[Vector3<f64>; 2]> {
        let (body, pull) = self.pull.as_ref()?;
        let seen = self.seen(*body)?;
        let mut coordinates = Vec::new();
        self.add_coordinates(*body, &seen.modal_displacement, &mut coordinates);
        // The place on the bent rest has its displacement.
        coordinates.truncate(body_of_shapes(self.described(*body)?).flexible());
        let arm = pull.point.position_body() + pull.point.deformation(&coordinates);
        let position = seen.origin_global + seen.attitude.to_global(&arm);
        let velocity = seen.points.last()?.velocity;
        Some([position, pull.force_global(seen.time, position, velocity)])
    }
}

/// The body whose shapes are drawn: with those that follow large modes.
fn body_of_shapes(described: &DescribedBody) -> &ReducedBody {
    described.physics.large_deflection.as_ref().map_or(&described.body, Manifold::body)
}

/// True if the modes of a body are about a bent rest.
fn is_about_rest(described: &DescribedBody) -> bool {
    described.physics.reference.is_some()
}

/// Work and impulses of a body up to where its motion was made anew, so that its balances go on: what a change of its state gave it
/// is work of the loads.
fn carried(done: &Work, before: &Observation, after: &Observation) -> Work {
    let dissipation = done.dissipation + before.work.dissipation;
    let energy = before.energy_balance() - done.work + done.dissipation;
    let linear = before.linear_balance_global() - done.impulse_global;
    let angular = before.angular_balance_global() - done.angular_impulse_global;
    Work {
        work: after.energy_balance() + dissipation - energy,
        dissipation,
        impulse_global: after.linear_balance_global() - linear,
        angular_impulse_global: after.angular_balance_global() - angular,
    }
}

/// An end beyond a time: that of the recorded run, doubled as often as it takes.
fn until(end: f64, time: f64) -> f64 {
    let mut until = end;
    while until <= time && until.is_finite() {
        until *= 2.0;
    }
    until
}
