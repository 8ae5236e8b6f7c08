//! Static responses, and shapes of large modes.

mod answer;
pub(crate) mod answered;
pub(crate) mod inertia_relief;
pub(crate) mod large_shapes;
pub(crate) mod mass_left_out;
pub(crate) mod response;
mod restricted;
