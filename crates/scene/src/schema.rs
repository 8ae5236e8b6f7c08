//! The JSON schema of the scene file, made from the structs that it is read into: editors complete and explain keys by it.

use std::borrow::Cow;
use std::collections::BTreeMap;

use dynamics::Effect;
use schemars::generate::SchemaSettings;
use schemars::transform::{RecursiveTransform, Transform};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::{Map, Value, json};

use crate::body::effects::{Choice, Effects};
use crate::document::{BODIES, OF_A_BODY, OUTPUT_OF_A_BODY};
use crate::methods::{formulation_names, scheme_names};
use crate::section::{BodySection, CountOrAuto, Formulation, NumberOrList, OutputSection, Scheme, Sections};
use crate::tie::section::{InOrder, TieSections};

/// The schema of a scene file (JSON Schema, draft 7, which editors of TOML read): keys, types, kinds and their description.
/// Rules between keys are not in it; the program has them.
pub fn json_schema() -> Value {
    let mut generator = SchemaSettings::draft07().into_generator();
    let mut root = Sections::json_schema(&mut generator).to_value();
    let body = BodySection::json_schema(&mut generator).to_value();
    let output = OutputSection::json_schema(&mut generator).to_value();
    let ties = TieSections::json_schema(&mut generator).to_value();

    let mut of_several = body;
    copy_properties(&root, &mut of_several, |key| OF_A_BODY.contains(&key));
    copy_properties(&output, &mut of_several, |key| OUTPUT_OF_A_BODY.contains(&key));
    of_several["description"] = json!("A body of several: the keys of `body`, and in it all that belongs to it.");
    // A word in the place of the table of a body is of all bodies.
    let [of_body, of_all] = [&root, &ties].map(|table| table["properties"]["initial"].clone());
    copy_properties(&ties, &mut root, |_| true);
    root["properties"]["initial"] = json!({ "description": of_body["description"], "anyOf": [of_body, of_all] });
    root["properties"][BODIES] =
        json!({ "description": "Bodies by name.", "type": "object", "additionalProperties": of_several });
    root["required"] = json!(["title", "units", "time"]);
    root["oneOf"] = json!([{ "required": ["body"] }, { "required": [BODIES] }]);
    root["title"] = json!("Scene of flexframe");
    root["description"] =
        json!("One run of a body, or of bodies and joints. Units are your own; nothing is converted.");
    root["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    root["definitions"] = Value::Object(generator.take_definitions(true));

    let mut schema = Schema::try_from(root).unwrap_or_default();
    RecursiveTransform(in_words).transform(&mut schema);
    RecursiveTransform(kinds_alone).transform(&mut schema);
    schema.to_value()
}

/// Copies the properties whose keys are wanted from one schema of a table to another.
fn copy_properties(from: &Value, to: &mut Value, wanted: impl Fn(&str) -> bool) {
    let (Some(from), Some(to)) = (from["properties"].as_object(), to["properties"].as_object_mut()) else { return };
    to.extend(from.iter().filter(|(key, _)| wanted(key)).map(|(key, value)| (key.clone(), value.clone())));
}

/// Takes the links between items of Rust out of a description.
fn in_words(schema: &mut Schema) {
    if let Some(Value::String(text)) = schema.get_mut("description") {
        *text = without_links(text);
    }
}

/// The text with the name alone of each link: ``[`Force::frame`]`` becomes `` `frame` ``.
fn without_links(text: &str) -> String {
    let mut words = String::new();
    let mut rest = text;
    while let Some((before, link)) = rest.split_once("[`") {
        let Some((name, after)) = link.split_once("`]") else { break };
        words += before;
        words += &format!("`{}`", name.rsplit("::").next().unwrap_or(name));
        rest = match after.strip_prefix('(').and_then(|target| target.split_once(')')) {
            Some((_, after)) => after,
            None => after,
        };
    }
    words + rest
}

/// Lets a kind without keys stand as a string alone, as in `history = "constant"`.
fn kinds_alone(schema: &mut Schema) {
    let Some(Value::Array(kinds)) = schema.get_mut("oneOf") else { return };
    let alone = |kind: &Value| {
        let properties = kind["properties"].as_object().filter(|properties| properties.len() == 1)?;
        Some(properties.get("kind")?["const"].clone())
    };
    let names: Vec<Value> = kinds.iter().filter_map(alone).collect();
    kinds.extend(names.into_iter().map(|name| json!({ "const": name })));
}

impl JsonSchema for Choice {
    fn schema_name() -> Cow<'static, str> {
        "Choice".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": [true, false, "auto"], "default": "auto" })
    }
}

impl JsonSchema for Effects {
    fn schema_name() -> Cow<'static, str> {
        "Effects".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let choice = generator.subschema_for::<Choice>();
        let of = |effect: Effect| json!({ "description": effect.description(), "allOf": [choice] });
        let mut keys: Map<String, Value> =
            Effect::ALL.into_iter().map(|effect| (effect.name().to_owned(), of(effect))).collect();
        let about = "Relative influence on the answer below which \"auto\" leaves an effect out.";
        keys.insert("tolerance".into(), json!({ "type": "number", "default": 1e-3, "description": about }));
        let about = "With `false`, a model that is known to be wrong runs all the same.";
        keys.insert("refuse".into(), json!({ "type": "boolean", "default": true, "description": about }));
        json_schema!({
            "description": "Which effects are simulated; what is off is not computed.",
            "type": "object",
            "properties": keys,
            "additionalProperties": false
        })
    }
}

impl JsonSchema for CountOrAuto {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "CountOrAuto".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "oneOf": [{ "type": "integer", "minimum": 0 }, { "const": "auto" }] })
    }
}

impl JsonSchema for NumberOrList {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "NumberOrList".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "oneOf": [{ "type": "number" }, { "type": "array", "items": { "type": "number" } }] })
    }
}

impl JsonSchema for Formulation {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Formulation".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": formulation_names() })
    }
}

impl JsonSchema for Scheme {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Scheme".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": scheme_names() })
    }
}

impl<T: JsonSchema> JsonSchema for InOrder<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("TableOf{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        BTreeMap::<String, T>::json_schema(generator)
    }
}
