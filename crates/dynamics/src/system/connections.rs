//! Connections of the bodies of a system.

use std::ops::AddAssign;
use std::sync::Arc;

use crate::system::element::ForceElement;
use crate::system::joint::Joint;
use crate::system::joint::coordinate::Coordinate;
use crate::system::joint::coupling::Coupling;
use crate::system::joint::force::JointForce;
use crate::system::joint::row::Row;
use crate::system::marker::Marker;

/// Joints, couplings of them, and forces between markers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Connections {
    pub joints: Vec<Joint>,
    pub couplings: Vec<Coupling>,
    pub elements: Vec<Arc<dyn ForceElement>>,
    /// The markers of each element, those on the ground as the islands of bodies count them.
    pub element_markers: Vec<Vec<Marker>>,
}

impl Connections {
    /// Takes other elements.
    pub fn set_elements(&mut self, elements: Vec<Arc<dyn ForceElement>>) {
        self.element_markers = elements.iter().map(|element| element.markers().to_vec()).collect();
        self.elements = elements;
    }

    /// The markers of all of them.
    pub fn markers(&self) -> impl Iterator<Item = &Marker> {
        let of_joints = self.joints.iter().flat_map(|joint| joint.groups().flat_map(|(markers, _)| markers));
        of_joints.chain(self.element_markers.iter().flatten())
    }

    /// The markers of each joint and of each element.
    pub fn ties(&self) -> impl Iterator<Item = Vec<&Marker>> {
        let of_joints = self.joints.iter().map(Joint::all_markers);
        of_joints.chain(self.element_markers.iter().map(|markers| markers.iter().collect()))
    }

    /// The same, to be changed.
    pub fn each_tie(&mut self, mut change: impl FnMut(&mut [&mut Marker])) {
        for joint in &mut self.joints {
            let of_parts = joint.parts.iter_mut().flat_map(|part| &mut part.markers);
            change(&mut joint.markers.iter_mut().chain(of_parts).collect::<Vec<_>>());
        }
        for markers in &mut self.element_markers {
            change(&mut markers.iter_mut().collect::<Vec<_>>());
        }
    }

    /// Numbers of rows of the joints, then of the couplings.
    pub fn groups(&self) -> impl Iterator<Item = usize> {
        self.joints.iter().map(Joint::row_count).chain(self.couplings.iter().map(|_| 1))
    }

    /// Numbers of compliant rows of the forces of joints, then of the elements.
    pub fn compliant_groups(&self) -> impl Iterator<Item = usize> {
        self.joint_forces().map(|_| 1).chain(self.elements.iter().map(|element| element.directions()))
    }

    /// True if there are laws that Newton's method does not ask in each of its passes: elements, and laws from outside at joints.
    pub fn has_laws(&self) -> bool {
        let has_directions = self.elements.iter().any(|element| element.directions() > 0);
        has_directions || self.joint_forces().any(|(.., force)| !force.laws.is_empty())
    }

    /// True if there are no compliant rows.
    pub fn is_rigid(&self) -> bool {
        self.compliant_groups().all(|rows| rows == 0)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.groups().sum()
    }

    /// The name of the joint or coupling of each row.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let of_joints = self.joints.iter().flat_map(|joint| (0..joint.row_count()).map(|_| joint.name.as_str()));
        of_joints.chain(self.couplings.iter().map(|coupling| coupling.name.as_str()))
    }

    /// Sums over the rows of each joint and coupling that has rows, with its name.
    pub fn sums<T: AddAssign>(&self, of_rows: impl Iterator<Item = T>) -> Vec<(&str, T)> {
        let mut sums: Vec<(&str, T)> = Vec::new();
        for (name, of_row) in self.names().zip(of_rows) {
            match sums.last_mut() {
                Some((last, sum)) if *last == name => *sum += of_row,
                _ => sums.push((name, of_row)),
            }
        }
        sums
    }

    /// For each row, true if a drive moves it.
    pub fn is_driven(&self) -> impl Iterator<Item = bool> {
        let is_driven = |row: &Row| matches!(row, Row::DrivenRotation | Row::DrivenPoint);
        self.joints
            .iter()
            .flat_map(Joint::groups)
            .flat_map(move |(_, rows)| rows.iter().map(is_driven))
            .chain(self.couplings.iter().map(|_| false))
    }

    /// The forces of joints, with the numbers of the joints.
    pub fn joint_forces(&self) -> impl Iterator<Item = (usize, Coordinate, &JointForce)> {
        let numbered = self.joints.iter().enumerate();
        numbered.flat_map(|(number, joint)| joint.forces().map(move |(coordinate, force)| (number, coordinate, force)))
    }

    /// Times at which laws from outside jump.
    pub fn discontinuities(&self) -> impl Iterator<Item = f64> {
        let laws = self.joint_forces().flat_map(|(_, _, force)| &force.laws);
        let of_elements = self.elements.iter().flat_map(|element| element.discontinuities());
        laws.flat_map(|law| law.discontinuities()).chain(of_elements)
    }

    /// The markers that each row has ends on: rows of joints, of couplings, of forces of joints, of elements.
    pub fn ends(&self) -> impl Iterator<Item = Vec<&Marker>> {
        let groups = self.joints.iter().flat_map(Joint::groups);
        let of_joints = groups.flat_map(|(markers, rows)| rows.iter().map(|_| markers.iter().collect()));
        let of_couplings = self
            .couplings
            .iter()
            .map(|coupling| coupling.terms.iter().flat_map(|term| &self.joints[term.joint].markers).collect());
        let of_forces = self.joint_forces().map(|(joint, ..)| self.joints[joint].markers.iter().collect());
        let of_elements = self
            .elements
            .iter()
            .zip(&self.element_markers)
            .flat_map(|(element, markers)| (0..element.directions()).map(|_| markers.iter().collect()));
        of_joints.chain(of_couplings).chain(of_forces).chain(of_elements)
    }
}
