//! Bodies in space.

pub(crate) mod animation;
pub(crate) mod facets;
pub(crate) mod key;
pub(crate) mod render;
pub(crate) mod shapes;
pub(crate) mod surface;
#[cfg(test)]
pub(crate) mod test_body;
pub(crate) mod view;
