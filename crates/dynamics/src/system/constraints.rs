//! The rows of all joints of a system, and what they do to its bodies.

use crate::system::connections::Connections;
use crate::system::elimination::number::Number;
use crate::system::joint::row::Row;
use crate::system::joint::wrench::RowWrench;
use crate::system::marker::motion::MarkerWrench;
use crate::system::marker::{BodyPlace, Marker, MarkerPlace};

/// Gives a row of those on two markers, with the value and the rate of the drive.
pub(crate) type RowForm = fn(&[Row], usize, [&MarkerPlace; 2], [f64; 2]) -> RowWrench;

/// The rows as steps have them.
pub(crate) fn near(rows: &[Row], number: usize, places: [&MarkerPlace; 2], driven: [f64; 2]) -> RowWrench {
    rows[number].wrench(places, driven)
}

/// One end of a row: the entries of G for the coordinates of one body.
#[derive(Debug, Clone)]
pub(crate) struct End {
    pub body: usize,
    /// First coordinate of the body.
    pub first: usize,
    /// Entries: force and moment about the origin, both in body axes, and modal forces.
    pub entries: Vec<f64>,
}

/// G and the residuals g where the bodies are, row by row.
#[derive(Debug, Clone)]
pub(crate) struct Constraints {
    /// g (m).
    pub residuals: Vec<f64>,
    /// g_t: rates of the residuals by drives alone (m).
    pub own_rates: Vec<f64>,
    /// The ends of each row that are on bodies: one for each body. After the rows of joints and couplings come the compliant ones:
    /// the coordinates of the forces of joints, then the directions of elements.
    pub ends: Vec<Vec<End>>,
    /// The coordinates of the forces of joints.
    pub coordinates: Vec<f64>,
    /// How the forces along the compliant rows fall.
    pub compliant: Vec<Compliant>,
}

/// A row along which a force falls by a stiffness times displacement and a damping times velocity.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Compliant {
    pub stiffness: f64,
    pub damping: f64,
}

impl Compliant {
    /// True if there is neither.
    pub fn is_slack(self) -> bool {
        self.stiffness == 0.0 && self.damping == 0.0
    }

    /// The larger of two stiffnesses and of two dampings.
    pub fn or(self, other: Self) -> Self {
        Self { stiffness: self.stiffness.max(other.stiffness), damping: self.damping.max(other.damping) }
    }

    /// True if it is not within half and twice another.
    pub fn is_far_from(self, other: Self, kappa: f64) -> bool {
        let [now, then] = [self, other].map(|row| row.resistance(kappa));
        now > 2.0 * then || 2.0 * now < then
    }

    /// k/κ + c
    pub fn resistance<T: Number>(self, kappa: T) -> T {
        kappa.recip().scale(self.stiffness) + T::from_real(self.damping)
    }
}

impl Constraints {
    /// Room for the rows of these connections; `first` are the first coordinates of the bodies, and their number.
    pub fn new(connections: &Connections, first: &[usize]) -> Self {
        let of_row = |markers: Vec<&Marker>| {
            let mut bodies: Vec<usize> = Vec::new();
            for body in markers.iter().filter_map(|marker| marker.body()) {
                if !bodies.contains(&body) {
                    bodies.push(body);
                }
            }
            let end = |body: usize| End { body, first: first[body], entries: vec![0.0; first[body + 1] - first[body]] };
            bodies.into_iter().map(end).collect()
        };
        let ends: Vec<Vec<End>> = connections.ends().map(of_row).collect();
        let rows = connections.rows();
        Self {
            residuals: vec![0.0; rows],
            own_rates: vec![0.0; rows],
            coordinates: vec![0.0; connections.joint_forces().count()],
            compliant: vec![Compliant::default(); ends.len() - rows],
            ends,
        }
    }

    /// Finds g, its own rate and G at a time, by the branch of another. Turns of joints are next to what is expected of them; `form`
    /// gives a row of a list.
    pub fn find<'a>(
        &mut self,
        connections: &Connections,
        form: RowForm,
        expected_turn: impl Fn(usize, [&MarkerPlace; 2]) -> f64,
        times: [f64; 2],
        place: impl Fn(usize) -> BodyPlace<'a>,
    ) {
        let Connections { joints, couplings, .. } = connections;
        let places_of = |[i, j]: &[Marker; 2]| -> [MarkerPlace; 2] {
            [i.place(i.body().map(&place).as_ref()), j.place(j.body().map(&place).as_ref())]
        };
        let mut row = 0;
        for joint in joints {
            let driven = joint.driven_at(times);
            for (markers, rows) in joint.groups().filter(|(_, rows)| !rows.is_empty()) {
                let places = places_of(markers);
                for number in 0..rows.len() {
                    let wrench = form(rows, number, places.each_ref(), driven);
                    (self.residuals[row], self.own_rates[row]) = (wrench.residual, wrench.own_rate);
                    clear(&mut self.ends[row]);
                    add(&mut self.ends[row], markers, &places, &place, &wrench, 1.0);
                    row += 1;
                }
            }
        }
        for coupling in couplings {
            clear(&mut self.ends[row]);
            self.residuals[row] = -coupling.sum.unwrap_or_default();
            for term in &coupling.terms {
                let markers = &joints[term.joint].markers;
                let places = places_of(markers);
                let wrench = term.coordinate.wrench(places.each_ref(), expected_turn(term.joint, places.each_ref()));
                self.residuals[row] += term.factor * wrench.residual;
                add(&mut self.ends[row], markers, &places, &place, &wrench, term.factor);
            }
            row += 1;
        }
        for (k, (number, coordinate, _)) in connections.joint_forces().enumerate() {
            let markers = &joints[number].markers;
            let places = places_of(markers);
            let wrench = coordinate.wrench(places.each_ref(), expected_turn(number, places.each_ref()));
            self.coordinates[k] = wrench.residual;
            clear(&mut self.ends[row + k]);
            add(&mut self.ends[row + k], markers, &places, &place, &wrench, 1.0);
        }
    }

    /// The ends of the compliant rows.
    pub fn compliant_ends(&self) -> &[Vec<End>] {
        &self.ends[self.residuals.len()..]
    }

    /// Sets a compliant row from its number among them: the wrenches of one unit of its force on markers where they are.
    pub fn set_compliant<'a, 'q>(
        &mut self,
        number: usize,
        row: Compliant,
        wrenches: impl Iterator<Item = (&'a Marker, &'a MarkerPlace, &'a MarkerWrench)>,
        body: impl Fn(usize) -> BodyPlace<'q>,
    ) {
        self.compliant[number] = row;
        let ends = &mut self.ends[self.residuals.len() + number];
        clear(ends);
        for (marker, place, MarkerWrench { force_global, moment_global }) in wrenches {
            let Some(end) = ends.iter_mut().find(|end| Some(end.body) == marker.body()) else { continue };
            marker.add_wrench(place, &body(end.body), [force_global, moment_global], &mut end.entries);
        }
    }

    /// Takes some compliant rows of another.
    pub fn take_compliant(&mut self, other: &Self, rows: std::ops::Range<usize>) {
        self.compliant[rows.clone()].copy_from_slice(&other.compliant[rows.clone()]);
        for row in rows {
            let row = self.residuals.len() + row;
            for (own, other) in self.ends[row].iter_mut().zip(&other.ends[row]) {
                own.entries.copy_from_slice(&other.entries);
            }
        }
    }

    /// out = G v + g_t (m)
    pub fn rates(&self, velocities: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&self.own_rates);
        self.add_rates(1.0, velocities, out);
    }

    /// out += factor G v
    pub fn add_rates<T: Number>(&self, factor: f64, velocities: &[T], out: &mut [T]) {
        for (out, ends) in out.iter_mut().zip(&self.ends) {
            ends.iter().for_each(|end| end.add_rate(factor, velocities, out));
        }
    }

    /// forces += Gᵀ λ
    pub fn add_forces<T: Number>(&self, multipliers: &[T], forces: &mut [T]) {
        for (multiplier, ends) in multipliers.iter().zip(&self.ends) {
            ends.iter().for_each(|end| end.add_force(*multiplier, forces));
        }
    }
}

impl End {
    /// Adds the rate of its row in a motion, times a factor.
    pub fn add_rate<T: Number>(&self, factor: f64, velocities: &[T], rate: &mut T) {
        let velocities = &velocities[self.first..];
        self.entries.iter().zip(velocities).for_each(|(entry, velocity)| *rate += velocity.scale(factor * entry));
    }

    /// Adds the force of its row to those of its body.
    pub fn add_force<T: Number>(&self, force: T, forces: &mut [T]) {
        let forces = forces[self.first..].iter_mut();
        forces.zip(&self.entries).for_each(|(sum, entry)| *sum += force.scale(*entry));
    }
}

fn clear(ends: &mut [End]) {
    ends.iter_mut().for_each(|end| end.entries.fill(0.0));
}

/// Adds the wrenches of a row on two markers, times a factor.
fn add<'a>(
    ends: &mut [End],
    markers: &[Marker; 2],
    places: &[MarkerPlace; 2],
    body: impl Fn(usize) -> BodyPlace<'a>,
    wrench: &RowWrench,
    factor: f64,
) {
    for ((marker, place), wrench) in markers.iter().zip(places).zip(wrench.on_both()) {
        let Some(end) = ends.iter_mut().find(|end| Some(end.body) == marker.body()) else { continue };
        let [force, moment] = wrench.map(|vector| vector * factor);
        marker.add_wrench(place, &body(end.body), [&force, &moment], &mut end.entries);
    }
}
