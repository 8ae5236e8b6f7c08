//! The linearised equations of all bodies, before the rows of joints reduce them: Eqs. (L1) to (L6) of `docs/method/systems.md`.

use faer::Mat;

use crate::conservative::ConservativeBody;
use crate::matrix::lists::dot;
use crate::system::constraints::{Constraints, End, near};
use crate::system::description::System;
use crate::system::elimination::inverse::{Inertia, Inverse};
use crate::system::elimination::joint_matrix::{JointMatrix, Pattern};
use crate::system::geometry::posture::Posture;
use crate::system::geometry::rank::Judgement;
use crate::vibration::system::blocks::Blocks;
use crate::vibration::system::body::BodyTerms;
use crate::vibration::system::configuration::{BodyConfiguration, Configuration};
use crate::vibration::system::error::SteadyError;
use crate::vibration::system::tie::{Borne, Sums, Tie};

/// M ξ̈ + C ξ̇ + K ξ = Gᵀ δλ with G ξ = 0, over the changes of place ξ of all bodies.
#[derive(Debug, Clone)]
pub(crate) struct Terms {
    /// M of each body.
    pub masses: Vec<Mat<f64>>,
    /// L of each body: δv = ξ̇ + L ξ.
    pub convections: Vec<Mat<f64>>,
    /// C.
    pub damping: Blocks,
    /// K without Λ and without what strains springs, and the rows B of that: K = `unsprung` + BᵀB.
    pub unsprung: Blocks,
    pub springs: Mat<f64>,
    /// The part of K that is M L': what it leaves with the loads that give these accelerations has its rounding.
    pub accelerated: Blocks,
    /// K without Λ if no forces acted: springs, bushings and their like alone.
    pub unloaded: Blocks,
    /// Forces of joints and elements on each body; K has their stiffening.
    pub borne: Vec<Borne>,
    /// G, by the ends of its rows, and g.
    pub rows: Vec<Vec<End>>,
    pub residuals: Vec<f64>,
    /// λ of the motion; zero for rows that others imply.
    pub multipliers: Vec<f64>,
    /// True for rows that others imply.
    pub is_implied: Vec<bool>,
    /// Generalised forces in the motion, but for those of the multipliers.
    pub forces: Vec<f64>,
    /// G v: rates of the rows in the motion, but for those of drives.
    pub row_rates: Vec<f64>,
    /// Number of motions that deform no body.
    pub rigid_motions: usize,
    mass_inverses: Vec<Inverse<f64>>,
    of_mass: JointMatrix<f64>,
    pattern: Pattern,
}

impl Terms {
    /// Where the bodies are, in their motion.
    pub fn new(system: &System, at: &Configuration) -> Result<Self, SteadyError> {
        let n = system.coordinates();
        let bodies: Vec<BodyTerms> =
            system.bodies.iter().zip(&at.bodies).map(|(body, of)| BodyTerms::new(body, of, at.time)).collect();
        let constraints = constraints_at(system, at);
        let m = system.rows();
        let rows = constraints.ends[..m].to_vec();
        let velocities: Vec<f64> = at
            .bodies
            .iter()
            .flat_map(|body| body.velocity.iter().chain(&body.omega).copied().chain(body.q.iter().map(|_| 0.0)))
            .collect();
        let row_rates = rows.iter().map(|row| along(row, &velocities)).collect();
        let [mut damping, mut unsprung, mut accelerated] = [(); 3].map(|()| Blocks::default());
        for (terms, first) in bodies.iter().zip(&system.first) {
            damping.add([*first; 2], 1.0, &terms.damping);
            unsprung.add([*first; 2], 1.0, &terms.stiffness);
            accelerated.add([*first; 2], 1.0, &terms.accelerated);
        }
        let mut terms = Self {
            damping,
            unsprung,
            springs: Mat::zeros(0, n),
            accelerated,
            unloaded: Blocks::default(),
            borne: system.first.windows(2).map(|range| Borne::nothing(range[1] - range[0] - 6)).collect(),
            rows,
            residuals: constraints.residuals.clone(),
            multipliers: vec![0.0; m],
            is_implied: vec![false; m],
            forces: bodies.iter().flat_map(|terms| terms.forces.iter().copied()).collect(),
            row_rates,
            rigid_motions: 0,
            mass_inverses: Vec::new(),
            pattern: Pattern::new(
                &system.connections.groups().collect::<Vec<_>>(),
                &constraints.ends,
                system.bodies.len(),
            ),
            of_mass: JointMatrix::new(&Pattern::new(&[], &[], 0), 0),
            masses: Vec::new(),
            convections: Vec::new(),
        };
        let mut sources: Vec<Tie> = force_ties(system, at).collect();
        terms.factor((system, at), &constraints, &bodies)?;
        (terms.masses, terms.convections) = bodies.into_iter().map(|terms| (terms.mass, terms.convection)).unzip();
        sources.iter().for_each(|tie| tie.add_law(&mut terms.unloaded));
        let springs: Vec<Vec<f64>> = sources.iter_mut().flat_map(|tie| tie.take_springs(n)).collect();
        terms.springs = Mat::from_fn(springs.len(), n, |i, k| springs[i][k]);
        terms.add(system, &sources);
        terms.find_multipliers(system);
        let held: Vec<Tie> = row_ties(system, at, &terms.multipliers);
        let forces = terms.forces.clone();
        terms.add(system, &held);
        // The forces of the multipliers stay apart.
        terms.forces = forces;
        Ok(terms)
    }

    /// K x over all coordinates, without Λ.
    pub fn stiffness_times(&self, x: &[f64]) -> Vec<f64> {
        let mut forces = self.unsprung.times_list(x);
        for spring in self.springs.row_iter() {
            let strain: f64 = spring.iter().zip(x).map(|(row, x)| row * x).sum();
            forces.iter_mut().zip(spring.iter()).for_each(|(sum, row)| *sum += row * strain);
        }
        forces
    }

    /// Adds ties to the forces, K and C.
    fn add(&mut self, system: &System, ties: &[Tie]) {
        let (mut by_place, mut by_velocity) = (Blocks::default(), Blocks::default());
        for tie in ties {
            tie.add_to(&mut Sums { forces: &mut self.forces, by_place: &mut by_place, by_velocity: &mut by_velocity });
            tie.add_borne(&mut self.borne);
        }
        by_place.iter().for_each(|(at, block)| self.unsprung.add(*at, -1.0, block));
        for (at, block) in by_velocity.iter() {
            let body = system.first.partition_point(|first| *first <= at[1]) - 1;
            self.unsprung.add(*at, -1.0, &(block * &self.convections[body]));
            self.damping.add(*at, -1.0, block);
        }
    }

    /// Finds the factor of G M⁻¹ Gᵀ, the rows that others imply, and how many motions deform nothing.
    fn factor(
        &mut self,
        (system, at): (&System, &Configuration),
        constraints: &Constraints,
        bodies: &[BodyTerms],
    ) -> Result<(), SteadyError> {
        let of_body = |((body, at), terms): ((&ConservativeBody, &BodyConfiguration), &BodyTerms)| {
            inertia_of(body, at, &terms.mass)
        };
        let inertias: Vec<Inertia> = system.bodies.iter().zip(&at.bodies).zip(bodies).map(of_body).collect();
        for (body, inertia) in system.bodies.iter().zip(&inertias) {
            let mut inverse = Inverse::of(body);
            if !inverse.find_of_mass(inertia) {
                return Err(SteadyError::Inertia);
            }
            self.mass_inverses.push(inverse);
        }
        self.of_mass = JointMatrix::new(&self.pattern, system.coordinates());
        self.of_mass.assemble(&self.pattern, constraints, &self.mass_inverses);
        let places: Vec<_> = at.bodies.iter().map(|body| (body.origin, body.body_from_global)).collect();
        let (positions, attitudes): (Vec<_>, Vec<_>) = places.into_iter().unzip();
        let points = system.connections.joints.iter().map(|joint| at.places(&joint.markers)[1].position);
        let posture = Posture::new(system, positions.into_iter(), points, &attitudes, &constraints.ends);
        self.is_implied = Judgement::first(system, &posture, true).rank.is_implied;
        self.of_mass.factor(&self.pattern, &self.is_implied);
        let of_rigid = Judgement::first(system, &posture, false).rank.is_implied;
        let rank = of_rigid.iter().filter(|is_implied| !**is_implied).count();
        self.rigid_motions = system.rigid_coordinates().saturating_sub(rank);
        Ok(())
    }

    /// λ that leaves the least of the forces.
    fn find_multipliers(&mut self, system: &System) {
        let against: Vec<f64> = self.forces.iter().map(|force| -force).collect();
        self.multipliers = self.multipliers_of(system, &against);
    }

    /// S f = (G M⁻¹Gᵀ)⁻¹ G M⁻¹ f: the multipliers whose forces are nearest to these in the metric of M⁻¹.
    pub fn multipliers_of(&self, system: &System, forces: &[f64]) -> Vec<f64> {
        let mut accelerations = forces.to_vec();
        for (inverse, range) in self.mass_inverses.iter().zip(system.first.windows(2)) {
            inverse.apply(&mut accelerations[range[0]..range[1]]);
        }
        let mut multipliers: Vec<f64> = self.rows.iter().map(|row| along(row, &accelerations)).collect();
        self.of_mass.solve(&self.pattern, &mut multipliers);
        multipliers
    }

    /// The change of place that closes gaps of the rows, in the metric of M.
    pub fn closing(&self, system: &System, gaps: &[f64]) -> Vec<f64> {
        let mut multipliers: Vec<f64> = gaps.iter().map(|gap| -gap).collect();
        self.of_mass.solve(&self.pattern, &mut multipliers);
        let mut change = vec![0.0; system.coordinates()];
        for (end, multiplier) in
            self.rows.iter().zip(&multipliers).flat_map(|(row, x)| row.iter().map(move |end| (end, x)))
        {
            let own = &mut change[end.first..end.first + end.entries.len()];
            own.iter_mut().zip(&end.entries).for_each(|(sum, entry)| *sum += entry * multiplier);
        }
        for (inverse, range) in self.mass_inverses.iter().zip(system.first.windows(2)) {
            inverse.apply(&mut change[range[0]..range[1]]);
        }
        change
    }
}

/// A row times a list over all coordinates.
pub(crate) fn along(row: &[End], list: &[f64]) -> f64 {
    let of = |end: &End| dot(&end.entries, &list[end.first..end.first + end.entries.len()]);
    row.iter().map(of).sum()
}

/// g and G where the bodies are.
fn constraints_at(system: &System, at: &Configuration) -> Constraints {
    let mut constraints = Constraints::new(&system.connections, &system.first);
    constraints.find(&system.connections, near, |joint, _| at.turns[joint], [at.time; 2], |body| at.place(body));
    constraints
}

/// Forces of joints along their coordinates, and force elements.
fn force_ties<'a>(system: &'a System, at: &'a Configuration) -> impl Iterator<Item = Tie> + 'a {
    let of_joints = system.connections.joint_forces().map(move |(number, coordinate, force)| {
        let joint = &system.joints()[number];
        let mut tie = Tie::new(system, at, joint.markers.iter());
        tie.add_joint_force((coordinate, force), &at.places(&joint.markers), at.turns[number], at.time);
        tie
    });
    let of_elements = (0..system.connections.elements.len()).map(move |number| Tie::of_element(system, at, number));
    of_joints.chain(of_elements)
}

/// The rows of joints and couplings with their multipliers.
fn row_ties(system: &System, at: &Configuration, multipliers: &[f64]) -> Vec<Tie> {
    let mut ties = Vec::new();
    let mut left = multipliers;
    for joint in system.joints() {
        let driven = joint.driven_at([at.time; 2]);
        for (markers, rows) in joint.groups() {
            let (own, rest) = left.split_at(rows.len());
            left = rest;
            let mut tie = Tie::new(system, at, markers.iter());
            tie.add_rows(rows, &at.places(markers), driven, own);
            ties.push(tie);
        }
    }
    for (coupling, multiplier) in system.couplings().iter().zip(left) {
        for term in &coupling.terms {
            let joint = &system.joints()[term.joint];
            let mut tie = Tie::new(system, at, joint.markers.iter());
            let force = multiplier * term.factor;
            tie.add_coordinate(term.coordinate, &at.places(&joint.markers), at.turns[term.joint], |_| {
                (force, [0.0; 2])
            });
            ties.push(tie);
        }
    }
    ties
}

/// The inertia of a body by its mass matrix.
fn inertia_of(body: &ConservativeBody, at: &BodyConfiguration, mass: &Mat<f64>) -> Inertia {
    let mut inertia = Inertia::of(body);
    inertia.mass = mass[(0, 0)];
    for (axis, list) in inertia.coupling.iter_mut().enumerate() {
        list.iter_mut().enumerate().for_each(|(k, s)| *s = mass[(6 + k, 3 + axis)]);
    }
    if let (Some(bent), Some(shape)) = (&mut inertia.bent, &at.bent) {
        bent.terms = shape.place().terms();
        bent.solve_coupling(&inertia.coupling);
    }
    let solved = inertia.bent.as_ref().map_or(&inertia.coupling, |bent| &bent.solved);
    let of_modes = |i: usize, j: usize| inertia.coupling[i].iter().zip(&solved[j]).map(|(a, b)| a * b).sum::<f64>();
    let locked = nalgebra::Matrix3::from_fn(|i, j| mass[(3 + i, 3 + j)] - of_modes(i, j));
    inertia.locked = locked;
    inertia.locked_inverse = locked.try_inverse().unwrap_or_else(nalgebra::Matrix3::zeros);
    inertia
}

/// Holders of elastic energy beside the bodies: springs of joints, then force elements, by their numbers.
pub(crate) fn springs(system: &System, at: &Configuration) -> Vec<(Spring, Tie)> {
    let of_joints = system.connections.joint_forces().map(|(number, coordinate, force)| {
        let joint = &system.joints()[number];
        let mut tie = Tie::new(system, at, joint.markers.iter());
        let law = |here| (0.0, [force.slopes(here, [at.time; 2])[0], 0.0]);
        tie.add_coordinate(coordinate, &at.places(&joint.markers), at.turns[number], law);
        (Spring::Joint(number), tie)
    });
    let of_elements = (0..system.connections.elements.len())
        .map(|number| (Spring::Element(number), Tie::of_element(system, at, number)));
    of_joints.chain(of_elements).collect()
}

/// A spring by the number of its joint or its element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spring {
    /// The spring of a joint.
    Joint(usize),
    /// A force element.
    Element(usize),
}
