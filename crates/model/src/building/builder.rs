//! Settings with which bodies are built.

use std::path::PathBuf;

use scene::Body;
use slepc::Slepc;

use crate::cache::Cache;
use crate::needs::{Needed, Needs};

/// Builds models of scenes, with what a command needs of them. None of its other settings changes a model but for rounding, so they are no
/// part of a scene.
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
    /// The parts of a body that are wanted.
    pub needs: Needs,
}

impl Builder {
    /// One with a cache.
    pub fn with_cache(cache: Cache) -> Self {
        Self { cache, ..Self::default() }
    }

    /// The same with its cache, or with one in a folder where it has none: work that comes back to a mesh finds what it has asked of it.
    pub fn with_cache_or(&self, folder: impl Into<PathBuf>) -> Self {
        let cache =
            if self.cache.folder().is_some() { self.cache.clone() } else { self.cache.elsewhere(folder, u64::MAX) };
        Self { cache, ..self.clone() }
    }

    /// The same for other needs.
    pub fn needing(&self, needs: Needs) -> Self {
        Self { needs, ..self.clone() }
    }

    /// The body of a scene with the needs.
    pub(crate) fn needed<'a>(&self, body: &'a Body) -> Needed<'a> {
        Needed::new(body, &self.needs)
    }
}
