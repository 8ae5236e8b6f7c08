//! Forces between markers: laws from outside, and those that are here.

pub(crate) mod data;
mod differences;
pub(crate) mod law;
pub(crate) mod springs;

use std::any::Any;
use std::fmt;

use crate::system::element::differences::DIFFERENCE;
use crate::system::joint::observation::JointObservation;
use crate::system::marker::Marker;
use crate::system::marker::motion::{MarkerChange, MarkerMotion, MarkerWrench};

/// Takes a direction of an element: its number, its stiffness and damping, and the wrenches of one unit of force along it.
pub type SetDirection<'a> = dyn FnMut(usize, [f64; 2], &[MarkerWrench]) + 'a;

/// Energy and losses of an element at one time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Stored {
    /// Energy of its springs.
    pub energy: f64,
    /// Power that its dampers take.
    pub damping_power: f64,
}

/// A law that puts forces on some markers by their motion.
///
/// Where the wrenches sum to no force and no moment, momenta are kept. What it does is its work, in
/// [`SystemMotion::element_work`](crate::SystemMotion::element_work).
pub trait ForceElement: fmt::Debug + Send + Sync + Any {
    /// Its markers.
    fn markers(&self) -> &[Marker];

    /// Finds the wrench on each of its markers at a time; laws with branches are taken as they are at the time `times[1]`.
    /// `wrenches` are zero before.
    fn apply(&self, times: [f64; 2], motions: &[MarkerMotion], wrenches: &mut [MarkerWrench]);

    /// True if what it does depends only on how its markers are and move against each other. Then positions and velocities in `motions` are
    /// counted from a place near the bodies that moves with them, and so have all digits far from the global origin; else they are global.
    fn is_relative(&self) -> bool {
        false
    }

    /// The element in rows of results, where it is between two markers. A law from outside is in none: it may take long.
    fn observe(&self, _motions: &[MarkerMotion; 2]) -> Option<JointObservation> {
        None
    }

    /// The energy of its springs and the power of its dampers, where these are all of it and the energy depends on the places of the markers
    /// alone. The work of the springs is then the change of the energy, so that balances see what steps make or lose there.
    fn stored(&self, _motions: &[MarkerMotion]) -> Option<Stored> {
        None
    }

    /// A continuous function that changes its sign where the law has a kink or a jump: the gap of a contact, the slack of a cable. Under
    /// step control steps end there. Without one, the work of the law shows that there is something, and steps grow short.
    fn switch(&self, _times: [f64; 2], _motions: &[MarkerMotion]) -> Option<f64> {
        None
    }

    /// Times at which the law or one of its rates jumps, rising. Steps end there.
    fn discontinuities(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Number of directions in which it may be stiff. By default, with [`Self::linearize`], six for each of up to two markers that are on
    /// bodies. Steps with a stiff law that has none are as short as its period asks.
    fn directions(&self) -> usize {
        differences::directions(self.markers())
    }

    /// Calls `set` for each direction, by its number: with its stiffness and damping, neither negative, and with the wrenches of
    /// one unit of force along it. Where the markers move along it, by a path that is the work of those wrenches, the wrenches
    /// fall by (stiffness × path + damping × rate of the path) times them. It need not be exact: it is for Newton's method, which asks
    /// once a step at each of its three stages, and again where it converges slowly.
    ///
    /// A law without a method of its own is differentiated, by up to 25 calls.
    fn linearize(&self, times: [f64; 2], motions: &[MarkerMotion], set: &mut SetDirection<'_>) {
        differences::linearize(
            self.markers(),
            motions,
            |motions, wrenches| self.apply(times, motions, wrenches),
            |number, slopes, wrenches| set(number, slopes, wrenches),
        );
    }

    /// Finds the change of the wrench on each of its markers by small changes of their motions, for the linearised equations.
    /// `changes` are zero before.
    ///
    /// Without a method of its own a law is differentiated by central differences.
    fn differentiate(
        &self,
        times: [f64; 2],
        motions: &[MarkerMotion],
        by: &[MarkerChange],
        changes: &mut [MarkerWrench],
    ) {
        for sign in [1.0, -1.0] {
            let moved: Vec<MarkerMotion> =
                motions.iter().zip(by).map(|(motion, change)| motion.changed(change, sign * DIFFERENCE)).collect();
            let mut wrenches = vec![MarkerWrench::default(); motions.len()];
            self.apply(times, &moved, &mut wrenches);
            for (change, wrench) in changes.iter_mut().zip(&wrenches) {
                change.force_global += wrench.force_global * (0.5 * sign / DIFFERENCE);
                change.moment_global += wrench.moment_global * (0.5 * sign / DIFFERENCE);
            }
        }
    }
}
