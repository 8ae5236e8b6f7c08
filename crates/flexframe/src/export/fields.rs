//! The fields that an export for ParaView has: to add one, give it a line in [`FIELDS`].

use results::Field;

use super::motion::Placed;

/// A field at the points: its name, numbers of each point, and where a step has it.
pub(super) struct PointField {
    name: &'static str,
    components: usize,
    pub values: fn(&Placed) -> &[f64],
}

/// All of them. The mesh stays where the scene has it; warped by the first it is where the body is.
pub(super) const FIELDS: [PointField; 3] = [
    PointField { name: "displacement", components: 3, values: |placed| &placed.displacement },
    PointField { name: "elastic_displacement", components: 3, values: |placed| &placed.elastic },
    PointField { name: "von_mises_stress", components: 1, values: |placed| &placed.von_mises },
];

/// Description of the fields in a file.
pub(super) fn described() -> Vec<Field> {
    FIELDS.iter().map(|field| Field { name: field.name.to_owned(), components: field.components }).collect()
}
