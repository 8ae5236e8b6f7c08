//! The fields that an export for ParaView has: to add one, give it a line in [`FIELDS`].

use results::{Field, Shapes};

use super::motion::Placed;

/// A field at the points: its name, numbers of each point, and where a step has it.
pub(super) struct PointField {
    name: &'static str,
    components: usize,
    /// True if only a body whose stress is known has it.
    is_stress: bool,
    pub values: fn(&Placed) -> &[f64],
}

/// All of them. The mesh stays where the scene has it; warped by the first it is where the body is.
const FIELDS: [PointField; 3] = [
    PointField { name: "displacement", components: 3, is_stress: false, values: |placed| &placed.displacement },
    PointField { name: "elastic_displacement", components: 3, is_stress: false, values: |placed| &placed.elastic },
    PointField { name: "von_mises_stress", components: 1, is_stress: true, values: |placed| &placed.von_mises },
];

/// Fields of a body with these shapes, and the words of a file about them.
pub(super) fn fields(shapes: &Shapes) -> (Vec<&'static PointField>, Vec<Field>) {
    let fields: Vec<_> = FIELDS.iter().filter(|field| !field.is_stress || shapes.stress.is_some()).collect();
    let described = fields.iter().map(|field| Field { name: field.name.to_owned(), components: field.components });
    let described = described.collect();
    (fields, described)
}
