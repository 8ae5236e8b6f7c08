//! The list of the schemes that a scene can name.

use std::sync::LazyLock;

use crate::setup::Method;
use crate::{conservative_motion, paper, paper_limit};

impl Method {
    /// The list of all of them.
    pub const ALL: [Self; 4] =
        [paper::METHOD, paper_limit::METHOD, conservative_motion::RKMK4, conservative_motion::EXPONENTIAL];
    /// The paper's scheme, literally.
    pub const PAPER: Self = paper::METHOD;
    /// The limit of the paper's scheme, by RKMK4.
    pub const PAPER_RKMK4: Self = paper_limit::METHOD;
    /// The conservative form by classical Runge–Kutta.
    pub const RKMK4: Self = conservative_motion::RKMK4;
    /// The conservative form by the exponential scheme: the default.
    pub const EXPONENTIAL: Self = conservative_motion::EXPONENTIAL;

    /// The scheme of this name; where no formulation is named, that of the conservative form comes first. `None` where
    /// the list has no such pair.
    pub fn named(formulation: Option<&str>, scheme: &str) -> Option<Self> {
        let fits =
            |method: &&Self| method.scheme == scheme && formulation.is_none_or(|name| method.formulation == name);
        Self::ALL.iter().filter(fits).max_by_key(|method| !method.is_of_paper()).copied()
    }

    /// The names of all schemes, each once.
    pub fn scheme_names() -> &'static [&'static str] {
        static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| once_each(|method| method.scheme));
        &NAMES
    }

    /// The names of all formulations, each once.
    pub fn formulation_names() -> &'static [&'static str] {
        static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| once_each(|method| method.formulation));
        &NAMES
    }
}

fn once_each(name: fn(&Method) -> &'static str) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for method in &Method::ALL {
        if !names.contains(&name(method)) {
            names.push(name(method));
        }
    }
    names
}
