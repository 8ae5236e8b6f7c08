//! glTF 2.0 as one binary file (`.glb`): the surface of a body with its modes as morph targets, and an animation of each.
//!
//! Positions are in the unit of the scene and the axes of the mesh. A weight of 1 is a displacement that is seen, not one of the motion.

use diagnostic::Failure;
use model::Model;
use nalgebra::Vector3;
use results::kind::NATURAL_MODE;
use scene::Body;
use serde_json::{Value, json};

use crate::commands::modes::{require_flexible, require_surface};
use crate::report::kinds;
use crate::surface::Surface;

/// Most morph targets: programs that show such files know eight of them, many not more.
const TARGETS: usize = 8;
/// Largest displacement at a weight of 1, as a fraction of the body's size.
const DRAWN: f64 = 0.08;
/// Length of an animation in seconds, and its frames.
const PERIOD: f64 = 2.0;
const FRAMES: usize = 32;

/// Types of numbers, and what a view of the buffer is for.
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// The binary part with the list of what is where.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds numbers of four bytes; returns the number of the accessor.
    fn add(&mut self, bytes: impl IntoIterator<Item = [u8; 4]>, target: Option<u32>, mut accessor: Value) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes.into_iter().flatten());
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn vectors(&mut self, vectors: &[[f32; 3]]) -> usize {
        let bound = |of: fn(f32, f32) -> f32, start: f32| {
            vectors.iter().fold([start; 3], |bound, v| std::array::from_fn(|i| of(bound[i], v[i])))
        };
        let accessor = json!({
            "componentType": FLOAT, "count": vectors.len(), "type": "VEC3",
            "min": bound(f32::min, f32::INFINITY), "max": bound(f32::max, f32::NEG_INFINITY),
        });
        self.add(vectors.as_flattened().iter().map(|x| x.to_le_bytes()), Some(VERTICES), accessor)
    }

    fn scalars(&mut self, values: &[f32]) -> usize {
        let (least, most) = values.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, m), x| (l.min(*x), m.max(*x)));
        let accessor =
            json!({ "componentType": FLOAT, "count": values.len(), "type": "SCALAR", "min": [least], "max": [most] });
        self.add(values.iter().map(|x| x.to_le_bytes()), None, accessor)
    }
}

/// The bytes of the file.
pub fn bytes(body: &Body, model: &Model) -> Result<Vec<u8>, Failure> {
    require_surface(body)?;
    let meshed = require_flexible(body, model)?;
    let surface = Surface::of_model(model);
    let single = |v: &[f64; 3]| v.map(|x| x as f32);
    let mut buffer = Buffer::default();
    let positions: Vec<[f32; 3]> = surface.shapes.positions.iter().map(single).collect();
    let position = buffer.vectors(&positions);
    let indices = surface.triangles.as_flattened();
    let accessor = json!({ "componentType": UNSIGNED, "count": indices.len(), "type": "SCALAR" });
    let indices = buffer.add(indices.iter().map(|i| i.to_le_bytes()), Some(INDICES), accessor);
    let (frequencies, kinds) = (model.natural_frequencies(), kinds(model));
    let count = frequencies.len().min(TARGETS);
    let (mut targets, mut names) = (Vec::new(), Vec::new());
    for (k, frequency) in frequencies.iter().enumerate().take(count) {
        let mut q = vec![0.0; k + 1];
        q[k] = 1.0;
        let shape = surface.displacements(&q);
        let largest = shape.iter().map(Vector3::norm).fold(0.0, f64::max);
        let scale = DRAWN * meshed.mesh.diagonal() / largest;
        let moved: Vec<[f32; 3]> = shape.iter().map(|u| single(&(u * scale).into())).collect();
        targets.push(json!({ "POSITION": buffer.vectors(&moved) }));
        names.push(match kinds[k] {
            NATURAL_MODE => format!("mode {}: {frequency:.4} per {}", k + 1, body.units.time),
            kind => format!("{kind} {}", k + 1),
        });
    }
    let times: Vec<f32> = (0..=FRAMES).map(|i| (PERIOD * i as f64 / FRAMES as f64) as f32).collect();
    let input = buffer.scalars(&times);
    let animations: Vec<Value> = (0..count)
        .map(|k| {
            let phase = |i: usize| std::f64::consts::TAU * i as f64 / FRAMES as f64;
            let weight = |i: usize, of: usize| if of == k { phase(i).sin() as f32 } else { 0.0 };
            let weights: Vec<f32> = (0..=FRAMES).flat_map(|i| (0..count).map(move |of| weight(i, of))).collect();
            let output = buffer.scalars(&weights);
            json!({
                "name": names[k],
                "samplers": [{ "input": input, "output": output, "interpolation": "LINEAR" }],
                "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }],
            })
        })
        .collect();
    let document = json!({
        "asset": { "version": "2.0", "generator": concat!("flexframe ", env!("CARGO_PKG_VERSION")) },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": body.title, "mesh": 0 }],
        "materials": [{ "doubleSided": true, "pbrMetallicRoughness": {
            "baseColorFactor": [0.62, 0.68, 0.75, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.7 } }],
        "meshes": [{
            "primitives": [{ "attributes": { "POSITION": position }, "indices": indices, "material": 0, "targets": targets }],
            "weights": vec![0.0; count],
            "extras": { "targetNames": names },
        }],
        "animations": animations,
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    Ok(binary(&text, &buffer.bytes))
}

/// A head, then the chunks of the text and of the numbers, both of whole words.
fn binary(text: &[u8], numbers: &[u8]) -> Vec<u8> {
    let length = 12 + 8 + text.len() + 8 + numbers.len();
    let word = |value: usize| (value as u32).to_le_bytes();
    let mut bytes = Vec::with_capacity(length);
    bytes.extend([*b"glTF", word(2), word(length), word(text.len()), *b"JSON"].concat());
    bytes.extend(text);
    bytes.extend([word(numbers.len()), *b"BIN\0"].concat());
    bytes.extend(numbers);
    bytes
}
