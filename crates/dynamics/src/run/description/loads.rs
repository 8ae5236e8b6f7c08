//! The loads of this crate as data.

use std::any::Any;
use std::borrow::Cow;
use std::sync::Arc;

use serde::ser::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::load::{FieldLoad, Load, PointForce, PointMoment, SharedLoad};

/// A load of this crate.
#[derive(Serialize, Deserialize)]
pub(super) enum LoadData<'a> {
    Force(Cow<'a, PointForce>),
    Moment(Cow<'a, PointMoment>),
    Field(Cow<'a, FieldLoad>),
}

/// A load as data; none of one that is code.
pub(super) fn data(load: &dyn Load) -> Option<LoadData<'_>> {
    let load: &dyn Any = load;
    let force = load.downcast_ref().map(|force| LoadData::Force(Cow::Borrowed(force)));
    let moment = || load.downcast_ref().map(|moment| LoadData::Moment(Cow::Borrowed(moment)));
    let field = || load.downcast_ref().map(|field| LoadData::Field(Cow::Borrowed(field)));
    force.or_else(moment).or_else(field)
}

pub(super) fn serialize<S: Serializer>(loads: &[SharedLoad], serializer: S) -> Result<S::Ok, S::Error> {
    let data: Option<Vec<_>> = loads.iter().map(|load| data(&**load)).collect();
    data.ok_or_else(|| S::Error::custom("a load that only its program knows"))?.serialize(serializer)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<SharedLoad>, D::Error> {
    let load = |data| match data {
        LoadData::Force(force) => Arc::new(force.into_owned()) as SharedLoad,
        LoadData::Moment(moment) => Arc::new(moment.into_owned()),
        LoadData::Field(field) => Arc::new(field.into_owned()),
    };
    Ok(Vec::deserialize(deserializer)?.into_iter().map(load).collect())
}
