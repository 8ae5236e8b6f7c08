//! Additions to flexframe from outside, each in as few lines as it takes: an own load, an own observer, an own scheme,
//! an own force between bodies, and an own joint. The tests run them.

pub mod drag;
pub mod magnet;
pub mod midpoint;
pub mod peak;
pub mod wire;

#[cfg(test)]
mod body {
    use dynamics::nalgebra::{Matrix3, Vector3};
    use reduced_body::{ReducedBody, RigidMotion};

    /// A free ball of 2 kg.
    pub fn ball() -> ReducedBody {
        ReducedBody::rigid(2.0, Vector3::zeros(), Matrix3::identity() * 0.1, RigidMotion::free()).unwrap()
    }
}
