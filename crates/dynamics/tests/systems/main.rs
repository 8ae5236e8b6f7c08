//! Systems of bodies and joints.

mod andrews;
mod flexible;
mod mechanism;
mod rigid;
