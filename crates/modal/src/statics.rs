//! Static responses, buckling, and shapes of second order.

pub(crate) mod buckling;
pub(crate) mod inertia_relief;
pub(crate) mod mass_left_out;
pub(crate) mod response;
pub(crate) mod second_order;
