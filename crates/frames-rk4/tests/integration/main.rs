//! The paper's scheme on real bodies: against its literal form, measured, and against closed forms.

#[path = "../common/mod.rs"]
mod common;

mod body_motion;
mod exactness;
mod initial_state;
mod limit_equation;
mod literal;
mod oracle;
mod order;
mod reference;
mod refusals;
mod spin;
mod stability;
