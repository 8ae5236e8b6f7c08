//! The methods of this crate by their names.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::run::description::error::DescriptionError;
use crate::simulation::setup::Method;
use crate::system::collocation::SystemScheme;

const KNOWN: [Method; 5] = [
    Method::EXPONENTIAL,
    Method::RKMK4,
    Method::of_joints(SystemScheme::Radau),
    Method::of_joints(SystemScheme::Gauss),
    Method::of_joints(SystemScheme::Rkmk4),
];

/// Refuses a method from outside.
pub(super) fn check(method: &Method) -> Result<(), DescriptionError> {
    let Method { formulation, scheme, .. } = *method;
    let [formulation, scheme] = [formulation, scheme].map(str::to_owned);
    if KNOWN.contains(method) { Ok(()) } else { Err(DescriptionError::Method { formulation, scheme }) }
}

pub(super) fn serialize<S: Serializer>(method: &Method, serializer: S) -> Result<S::Ok, S::Error> {
    (method.formulation, method.scheme, method.joints).serialize(serializer)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Method, D::Error> {
    let found = <(&str, &str, Option<SystemScheme>)>::deserialize(deserializer)?;
    let is = |method: &Method| (method.formulation, method.scheme, method.joints) == found;
    KNOWN.into_iter().find(is).ok_or_else(|| D::Error::custom("an unknown method"))
}
