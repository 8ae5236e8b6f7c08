//! Fills structs from a document by serde, with the place of every fault.
//!
//! Differences to the deserializer of `toml`: a fault carries data instead of a sentence; every
//! number is finite; and an enum is chosen by the key `kind` of a table (`{ kind = "half-sine",
//! duration = 0.02 }`) or, if the variant has no keys, by a string alone. Serde's own
//! `#[serde(tag = "kind")]` would buffer the table and lose all places in it.

use std::fmt;

use serde::Deserialize;
use serde::de::value::StrDeserializer;
use serde::de::{self, DeserializeSeed, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;
use toml::de::DeValue;

use crate::document::{Document, Node};
use crate::error::SceneError;
use crate::text::shape::{Shape, wrong_shape, wrong_type};

/// The key that chooses the variant of an enum.
const KIND: &str = "kind";

/// Reads the whole document as a `T`.
pub(crate) fn from_document<'de, T: Deserialize<'de>>(document: &'de Document<'de>) -> Result<T, SceneError> {
    let root = document.root();
    T::deserialize(root.clone()).map_err(|fault| fault.at(&root))
}

/// A fault on its way to a node that knows the place.
#[derive(Debug)]
pub(crate) enum Fault {
    Placed(SceneError),
    MissingKey(&'static str),
    /// A value of another type than this.
    Type(String),
    UnknownName {
        found: String,
        known: &'static [&'static str],
    },
    Other(String),
}

impl Fault {
    fn at(self, node: &Node) -> SceneError {
        match self {
            Fault::Placed(error) => error,
            Fault::MissingKey(key) => missing_key(node, key),
            Fault::Type(expected) => wrong_type(node, &expected),
            Fault::UnknownName { found, known } => unknown_name(node, &found, known),
            Fault::Other(message) => {
                node.place().refuse(message, "another value", "see the description of the scene file")
            }
        }
    }
}

impl de::Error for Fault {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Fault::Other(message.to_string())
    }

    fn missing_field(field: &'static str) -> Self {
        Fault::MissingKey(field)
    }

    fn invalid_type(_found: de::Unexpected, expected: &dyn de::Expected) -> Self {
        Fault::Type(expected.to_string())
    }

    fn unknown_variant(found: &str, known: &'static [&'static str]) -> Self {
        Fault::UnknownName { found: found.to_owned(), known }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::Placed(error) => error.fmt(f),
            Fault::MissingKey(key) => write!(f, "`{key}` is missing"),
            Fault::Type(expected) => write!(f, "expected {expected}"),
            Fault::UnknownName { found, .. } => write!(f, "unknown value `{found}`"),
            Fault::Other(message) => f.write_str(message),
        }
    }
}

impl std::error::Error for Fault {}

impl From<SceneError> for Fault {
    fn from(error: SceneError) -> Self {
        Fault::Placed(error)
    }
}

fn missing_key(table: &Node, key: &str) -> SceneError {
    SceneError::MissingKey { at: table.place_of_missing(key).into(), key: key.to_owned() }
}

fn unknown_name(node: &Node, found: &str, known: &[&'static str]) -> SceneError {
    SceneError::UnknownName { at: node.place().into(), found: found.to_owned(), known: known.to_vec() }
}

fn refuse_unknown_keys(table: &Node, known: &[&'static str]) -> Result<(), SceneError> {
    match table.children().find(|child| !known.contains(&child.name())) {
        None => Ok(()),
        Some(child) => Err(SceneError::UnknownKey {
            at: child.place_of_key().into(),
            key: child.name().to_owned(),
            known: known.iter().copied().chain(table.keys_of_others()).collect(),
        }),
    }
}

fn number(value: &DeValue) -> Option<f64> {
    let number = match value {
        DeValue::Float(float) => float.as_str().parse().ok()?,
        DeValue::Integer(int) if int.radix() == 10 => int.as_str().parse().ok()?,
        DeValue::Integer(_) => count(value)? as f64,
        _ => return None,
    };
    number.is_finite().then_some(number)
}

fn count(value: &DeValue) -> Option<u64> {
    let int = value.as_integer()?;
    u64::from_str_radix(int.as_str(), int.radix()).ok()
}

impl<'de> Node<'de> {
    fn visit_list<V: Visitor<'de>>(self, shape: Shape, visitor: V) -> Result<V::Value, Fault> {
        let length = self.value.get_ref().as_array().map(|list| list.len());
        match (length, shape) {
            (None, _) => return Err(wrong_shape(&self, shape).into()),
            (Some(found), Shape::Vector(wanted)) if found != wanted => {
                return Err(wrong_shape(&self, shape).into());
            }
            _ => {}
        }
        visitor.visit_seq(Entries(self.children())).map_err(|fault| fault.at(&self).into())
    }

    fn visit_table<V: Visitor<'de>>(
        self,
        known: Option<&[&'static str]>,
        has_kind: bool,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        if !self.value.get_ref().is_table() {
            return Err(wrong_shape(&self, Shape::Table).into());
        }
        if let Some(known) = known {
            let kind = has_kind.then_some(KIND);
            refuse_unknown_keys(&self, &kind.into_iter().chain(known.iter().copied()).collect::<Vec<_>>())?;
        }
        let children = self.children().filter(move |child| !(has_kind && child.name() == KIND));
        let keys = Keys { rest: Box::new(children), value: None };
        visitor.visit_map(keys).map_err(|fault| fault.at(&self).into())
    }
}

impl<'de> de::Deserializer<'de> for Node<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value.get_ref() {
            DeValue::String(_) | DeValue::Datetime(_) => self.deserialize_str(visitor),
            value @ DeValue::Integer(_) if count(value).is_some() => self.deserialize_u64(visitor),
            DeValue::Integer(_) | DeValue::Float(_) => self.deserialize_f64(visitor),
            DeValue::Boolean(boolean) => visitor.visit_bool(*boolean),
            DeValue::Array(_) => self.deserialize_seq(visitor),
            DeValue::Table(_) => self.deserialize_map(visitor),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match number(self.value.get_ref()) {
            Some(number) => visitor.visit_f64(number),
            None => Err(wrong_shape(&self, Shape::Number).into()),
        }
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match count(self.value.get_ref()) {
            Some(count) => visitor.visit_u64(count),
            None => Err(wrong_shape(&self, Shape::Count).into()),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.value.get_ref().as_str() {
            Some(text) => visitor.visit_str(text),
            None => Err(wrong_shape(&self, Shape::Text).into()),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.visit_list(Shape::List, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Fault> {
        self.visit_list(Shape::Vector(length), visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.visit_table(None, false, visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.visit_table(Some(fields), false, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let chooser = match self.value.get_ref() {
            DeValue::Table(_) => match self.children().find(|child| child.name() == KIND) {
                Some(kind) => kind,
                None => return Err(missing_key(&self, KIND).into()),
            },
            _ => self.clone(),
        };
        match chooser.value.get_ref().as_str() {
            None => Err(wrong_shape(&chooser, Shape::Text).into()),
            Some(name) if variants.contains(&name) => {
                visitor.visit_enum(Variant { name: name.to_owned(), content: self })
            }
            Some(name) => Err(unknown_name(&chooser, name, variants).into()),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u128 f32 char bytes byte_buf unit unit_struct
        newtype_struct tuple_struct identifier ignored_any
    }
}

/// The entries of a list.
struct Entries<'de>(Box<dyn Iterator<Item = Node<'de>> + 'de>);

impl<'de> de::SeqAccess<'de> for Entries<'de> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Fault> {
        let Some(entry) = self.0.next() else { return Ok(None) };
        seed.deserialize(entry.clone()).map(Some).map_err(|fault| fault.at(&entry).into())
    }
}

/// The keys of a table, and the value of the last one asked for.
struct Keys<'de> {
    rest: Box<dyn Iterator<Item = Node<'de>> + 'de>,
    value: Option<Node<'de>>,
}

impl<'de> de::MapAccess<'de> for Keys<'de> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Fault> {
        self.value = self.rest.next();
        let Some(entry) = &self.value else { return Ok(None) };
        let name: StrDeserializer<Fault> = entry.name().into_deserializer();
        seed.deserialize(name).map(Some).map_err(|fault| fault.at(entry).into())
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Fault> {
        let entry = self.value.take().ok_or_else(|| Fault::Other("a value without key".to_owned()))?;
        seed.deserialize(entry.clone()).map_err(|fault| fault.at(&entry).into())
    }
}

/// The variant of an enum: its name, and the table or string that named it.
struct Variant<'de> {
    name: String,
    content: Node<'de>,
}

impl<'de> de::EnumAccess<'de> for Variant<'de> {
    type Error = Fault;
    type Variant = Content<'de>;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Content<'de>), Fault> {
        let name: StrDeserializer<Fault> = self.name.as_str().into_deserializer();
        Ok((seed.deserialize(name)?, Content(self.content)))
    }
}

/// The keys of a variant.
struct Content<'de>(Node<'de>);

impl<'de> de::VariantAccess<'de> for Content<'de> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        Ok(refuse_unknown_keys(&self.0, &[KIND])?)
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Fault> {
        seed.deserialize(WithoutKind(self.0))
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Fault> {
        de::Deserializer::deserialize_tuple(self.0, length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, fields: &'static [&'static str], visitor: V) -> Result<V::Value, Fault> {
        self.0.visit_table(Some(fields), true, visitor)
    }
}

/// A table whose key `kind` has been used.
struct WithoutKind<'de>(Node<'de>);

impl<'de> de::Deserializer<'de> for WithoutKind<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.0.visit_table(None, true, visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        self.0.visit_table(Some(fields), true, visitor)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option
        unit unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[derive(Deserialize)]
    struct Switches {
        #[serde(rename = "list")]
        _list: Vec<bool>,
    }

    /// A fault that this file does not word itself comes from serde, and still has its place.
    #[test]
    fn a_fault_worded_by_serde_has_its_place() {
        let document = Document::parse("list = [\n  true,\n  3,\n]", Path::new("a.toml")).unwrap();
        let error = from_document::<Switches>(&document).err().unwrap();
        let place = error.place().unwrap();
        assert_eq!((place.line, place.column, place.key.as_str()), (3, 3, "list[1]"));
        assert!(error.to_string().contains("expected a boolean"), "{error}");
    }
}
