//! Names of channels.

/// Names of stress components, in the order of `fem_tet10::COMPONENTS`.
pub(super) const STRESS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// True of the name of a channel that is asked for by this name or beginning.
pub(super) fn is_asked(name: &str, asked: &str) -> bool {
    name == asked || name.strip_prefix(asked).is_some_and(|rest| rest.starts_with(['.', '[']))
}
