//! Systems of bodies and joints.

mod andrews;
mod coordinates;
mod dense;
mod described;
mod elements;
mod equation;
mod equilibrium;
mod far;
mod flexible;
mod hard;
mod laws;
mod linear;
mod linkages;
mod mechanism;
mod rigid;
mod rotor;
mod run;
mod stiff;
mod stiffening;
mod tolerance;
mod vibrations;
