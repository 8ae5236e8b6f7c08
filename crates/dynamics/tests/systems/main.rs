//! Systems of bodies and joints.

mod andrews;
mod mechanism;
mod rigid;
