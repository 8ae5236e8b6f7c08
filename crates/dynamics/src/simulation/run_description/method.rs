//! The methods of this crate by their names.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::simulation::run_description::error::DescriptionError;
use crate::simulation::setup::Method;

const KNOWN: [Method; 2] = [Method::EXPONENTIAL, Method::RKMK4];

/// Refuses a method from outside.
pub(super) fn check(method: &Method) -> Result<(), DescriptionError> {
    let Method { formulation, scheme, .. } = *method;
    let [formulation, scheme] = [formulation, scheme].map(str::to_owned);
    if KNOWN.contains(method) { Ok(()) } else { Err(DescriptionError::Method { formulation, scheme }) }
}

pub(super) fn serialize<S: Serializer>(method: &Method, serializer: S) -> Result<S::Ok, S::Error> {
    (method.formulation, method.scheme).serialize(serializer)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Method, D::Error> {
    let (formulation, scheme) = <(&str, &str)>::deserialize(deserializer)?;
    let is = |method: &Method| (method.formulation, method.scheme) == (formulation, scheme);
    KNOWN.into_iter().find(is).ok_or_else(|| D::Error::custom("an unknown method"))
}
