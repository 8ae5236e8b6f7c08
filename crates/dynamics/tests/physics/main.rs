//! Held and driven bodies, loads of every kind, effects that are off and steady spin, on a body of made-up constants:
//! what the equations conserve they conserve for any.

mod described;
mod driven;
mod effects;
mod events;
mod held;
mod loads;
mod open;
mod sample;
mod signal;
mod steady;
mod stress;
