//! Momenta of what flies freely: constants of the motion but for the loads, to rounding at any tolerance.
//!
//! The wrenches of a joint or an element cancel, so a group of bodies that nothing ties to the ground has the momenta that the loads give it.
//! Newton's method leaves them off by its own error. That is taken back by a small motion of the group as a whole, which no
//! joint resists.

use nalgebra::{Matrix6, Vector3, Vector6};
use rigid_kin::cross_matrix;

use crate::system::description::System;
use crate::system::stage::{Stage, Start, put, vector};

impl Stage {
    /// Gives each free group the change of momenta since the start of the step that the sums `change` of its rates say.
    pub fn correct_momenta(&mut self, system: &System, change: impl Fn(usize) -> f64) {
        for group in system.free_groups() {
            let (mut missing, mut inertia) = (Vector6::zeros(), Matrix6::zeros());
            for b in group {
                let first = system.first[*b];
                for k in 0..6 {
                    missing[k] += change(first + k) - self.y[first + k];
                }
                let (mass, of_body) = self.inertia_about_center(*b);
                let arm = cross_matrix(&self.arms[*b]) * mass;
                for i in 0..3 {
                    inertia[(i, i)] += mass;
                    for j in 0..3 {
                        inertia[(3 + i, j)] += arm[(i, j)];
                        inertia[(i, 3 + j)] -= arm[(i, j)];
                        inertia[(3 + i, 3 + j)] += of_body[(i, j)];
                    }
                }
            }
            let Some(twist) = inertia.lu().solve(&missing) else { continue };
            let [u, w] = [0, 3].map(|first| Vector3::new(twist[first], twist[first + 1], twist[first + 2]));
            for b in group {
                let first = system.first[*b];
                let (mass, of_body) = self.inertia_about_center(*b);
                let momentum = (u + w.cross(&self.arms[*b])) * mass;
                let angular_momentum = self.arms[*b].cross(&(u * mass)) + of_body * w;
                let now = [vector(&self.y, first) + momentum, vector(&self.y, first + 3) + angular_momentum];
                put(&mut self.y, first, &now[0]);
                put(&mut self.y, first + 3, &now[1]);
                let omega = self.attitudes[*b] * w;
                for (s, omega) in self.inertia[*b].coupling.iter().zip(omega.iter()) {
                    self.y[first + 6..].iter_mut().zip(s).for_each(|(p, s)| *p += s * omega);
                }
            }
        }
    }

    /// Moves each free group to where its momenta take its centre of mass in a step of length h, of which `impulse` is what the forces along a
    /// coordinate have given it on average. Where the frame moves, places that are off have a part in the angular momentum about a place at rest.
    pub fn correct_centers(&mut self, (system, start): (&System, &Start), h: f64, impulse: impl Fn(usize) -> f64) {
        for group in system.free_groups() {
            if group.iter().all(|b| system.bodies[*b].frame.velocity() == Vector3::zeros()) {
                continue;
            }
            let (mut mass, mut missing) = (0.0, Vector3::zeros());
            for b in group {
                let first = system.first[*b];
                let own = system.bodies[*b].mass();
                mass += own;
                let given = Vector3::from_fn(|i, _| impulse(first + i));
                missing += (start.bodies[*b].momentum + given) * h - vector(&self.x, first) * own;
            }
            for b in group {
                let moved = vector(&self.x, system.first[*b]) + missing / mass;
                put(&mut self.x, system.first[*b], &moved);
            }
        }
    }

    /// Mass of a body, and its inertia about the centre of the frame, global.
    fn inertia_about_center(&self, b: usize) -> (f64, nalgebra::Matrix3<f64>) {
        let inertia = &self.inertia[b];
        let own = inertia.whole();
        let arm = cross_matrix(&self.arms[b]);
        (inertia.mass, self.attitudes[b].transpose() * own * self.attitudes[b] - arm * arm * inertia.mass)
    }
}
