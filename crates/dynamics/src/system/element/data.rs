//! The forces between markers of this crate as data.

use std::any::Any;
use std::borrow::Cow;
use std::sync::Arc;

use serde::ser::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::system::element::ForceElement;
use crate::system::element::springs::{Bushing, PointSpring};

/// An element of this crate.
#[derive(Serialize, Deserialize)]
pub(crate) enum ElementData<'a> {
    Spring(Cow<'a, PointSpring>),
    Bushing(Cow<'a, Bushing>),
}

/// An element as data; none of one that is code.
pub(crate) fn data(element: &dyn ForceElement) -> Option<ElementData<'_>> {
    let element: &dyn Any = element;
    let spring = element.downcast_ref().map(|spring| ElementData::Spring(Cow::Borrowed(spring)));
    spring.or_else(|| element.downcast_ref().map(|bushing| ElementData::Bushing(Cow::Borrowed(bushing))))
}

pub(crate) fn serialize<S: Serializer>(elements: &[Arc<dyn ForceElement>], serializer: S) -> Result<S::Ok, S::Error> {
    let data: Option<Vec<_>> = elements.iter().map(|element| data(&**element)).collect();
    data.ok_or_else(|| S::Error::custom("a force that only its program knows"))?.serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Arc<dyn ForceElement>>, D::Error> {
    let element = |data| match data {
        ElementData::Spring(spring) => Arc::new(spring.into_owned()) as Arc<dyn ForceElement>,
        ElementData::Bushing(bushing) => Arc::new(bushing.into_owned()),
    };
    Ok(Vec::deserialize(deserializer)?.into_iter().map(element).collect())
}
