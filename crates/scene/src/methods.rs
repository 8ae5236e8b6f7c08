//! The list of the schemes that a scene can name.

use std::sync::LazyLock;

use dynamics::Method;

/// All schemes of bodies that nothing ties, each with its formulation.
pub const METHODS: [Method; 4] = [frames_rk4::PAPER, frames_rk4::LIMIT, Method::RKMK4, Method::EXPONENTIAL];

/// The scheme of this name; where no formulation is named, that of the conservative form comes first. `None` where
/// the list has no such pair.
pub fn method_named(formulation: Option<&str>, scheme: &str) -> Option<Method> {
    let fits = |method: &&Method| method.scheme == scheme && formulation.is_none_or(|name| method.formulation == name);
    METHODS.iter().filter(fits).max_by_key(|method| method.formulation == Method::EXPONENTIAL.formulation).copied()
}

/// The scheme of this name, of bodies that joints, springs or bushings tie together.
pub(crate) fn method_of_joints_named(name: &str) -> Option<Method> {
    Method::OF_JOINTS.into_iter().find(|method| method.scheme == name)
}

/// True of the name of a scheme of bodies that nothing ties.
pub(crate) fn is_without_joints(name: &str) -> bool {
    METHODS.iter().any(|method| method.scheme == name)
}

/// The names of all schemes, each once.
pub(crate) fn scheme_names() -> &'static [&'static str] {
    static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| {
        let mut names = once_each(|method| method.scheme);
        names.extend(Method::OF_JOINTS.iter().map(|method| method.scheme).filter(|name| !is_without_joints(name)));
        names
    });
    &NAMES
}

/// The names of all formulations, each once.
pub(crate) fn formulation_names() -> &'static [&'static str] {
    static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| once_each(|method| method.formulation));
    &NAMES
}

fn once_each(name: fn(&Method) -> &'static str) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for method in &METHODS {
        if !names.contains(&name(method)) {
            names.push(name(method));
        }
    }
    names
}
