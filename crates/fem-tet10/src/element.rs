//! The ten-node tetrahedron: shape functions, integration, deformation.

pub(crate) mod columns;
pub(crate) mod deformation;
pub(crate) mod integration;
pub(crate) mod lanes;
pub mod quadrature;
pub(crate) mod shape;
pub(crate) mod vectorized;
