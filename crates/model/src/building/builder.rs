//! Settings with which bodies are built.

use slepc::Slepc;

use crate::cache::Cache;

/// Builds models of scenes. None of its settings changes a model but for rounding, so they are no part of a scene.
#[derive(Debug, Clone, Default)]
pub struct Builder {
    /// Results of the finite-element model that are kept from run to run; none by default.
    pub cache: Cache,
    /// Solver of modes and static responses in the place of this program's own. What the cache has is taken from there, whoever
    /// has computed it.
    pub solver: Option<Slepc>,
    /// True if gmsh may do all that geometry says
    /// ([`ImportSettings::trust_geometry`](mesh_import::ImportSettings::trust_geometry)).
    pub trust_geometry: bool,
}

impl Builder {
    /// One with a cache.
    pub fn with_cache(cache: Cache) -> Self {
        Self { cache, ..Self::default() }
    }
}
