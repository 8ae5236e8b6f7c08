//! The methods of this crate by their names.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::run::description::error::DescriptionError;
use crate::simulation::setup::Method;
use crate::system::collocation::SystemScheme;

fn known() -> impl Iterator<Item = Method> {
    [Method::EXPONENTIAL, Method::RKMK4].into_iter().chain(Method::OF_JOINTS)
}

/// Refuses a method from outside.
pub(super) fn check(method: &Method) -> Result<(), DescriptionError> {
    let Method { formulation, scheme, .. } = *method;
    let [formulation, scheme] = [formulation, scheme].map(str::to_owned);
    if known().any(|of| of == *method) { Ok(()) } else { Err(DescriptionError::Method { formulation, scheme }) }
}

pub(super) fn serialize<S: Serializer>(method: &Method, serializer: S) -> Result<S::Ok, S::Error> {
    (method.formulation, method.scheme, method.joints).serialize(serializer)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Method, D::Error> {
    let found = <(&str, &str, Option<SystemScheme>)>::deserialize(deserializer)?;
    let is = |method: &Method| (method.formulation, method.scheme, method.joints) == found;
    known().find(is).ok_or_else(|| D::Error::custom("an unknown method"))
}
