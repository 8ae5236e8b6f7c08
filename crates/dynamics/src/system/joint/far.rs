//! Rows of joints whose markers are turned far against each other: angles in the place of their sines, Eq. (J35) of
//! `docs/method/systems.md`. Near to where a joint is closed they are its rows.

use std::f64::consts::TAU;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use crate::system::joint::coordinate::Coordinate;
use crate::system::joint::row::Row;
use crate::system::joint::wrench::RowWrench;
use crate::system::marker::MarkerPlace;

/// Sine below which two axes are in line.
const IN_LINE: f64 = 1e-12;
/// Sine below which two axes that point against each other are taken for one line.
const OPPOSITE: f64 = 1e-6;

/// A row of these on the same two markers, with the value and the rate of the drive.
pub(crate) fn far_wrench(rows: &[Row], number: usize, places: [&MarkerPlace; 2], driven: [f64; 2]) -> RowWrench {
    let [i, j] = places;
    let column = |place: &MarkerPlace, axis: usize| -> Vector3<f64> { place.axes.column(axis).into() };
    match rows[number] {
        Row::Rotation(axis) if rows.iter().filter(|row| matches!(row, Row::Rotation(_))).count() == 3 => {
            let turned = Rotation3::from_matrix_unchecked(j.axes * i.axes.transpose());
            let turn = UnitQuaternion::from_rotation_matrix(&turned).scaled_axis();
            let e = column(i, axis);
            RowWrench::turning(turn.dot(&e), -e)
        }
        Row::Perpendicular(of_i, of_j) => {
            let is_other = |row: &Row| matches!(row, Row::Perpendicular(i, j) if *i == of_i && *j != of_j);
            let along = column(i, of_i);
            if let Some(Row::Perpendicular(_, other)) = rows.iter().find(|row| is_other(row)) {
                // The third axis of j is to be in line with that of i.
                let third = column(j, 3 - of_j - other);
                // Axes that are opposite are one line.
                let is_opposite = along.dot(&third) < 0.0 && along.cross(&third).norm() < OPPOSITE;
                let third = if is_opposite { -third } else { third };
                let across = along.cross(&third);
                let angle = across.norm().atan2(along.dot(&third));
                let axis = if across.norm() > IN_LINE { across.normalize() } else { column(j, of_j) };
                let e = column(j, of_j).cross(&third);
                return RowWrench::turning(angle * axis.dot(&e), -e);
            }
            let other = column(j, of_j);
            let across = along.cross(&other);
            let e = if across.norm() > IN_LINE { across.normalize() } else { column(i, (of_i + 1) % 3) };
            RowWrench::turning(along.dot(&other).clamp(-1.0, 1.0).asin(), e)
        }
        Row::DrivenRotation => {
            let turn = Coordinate::Turn.wrench(places, 0.0);
            let off = turn.residual - driven[0];
            RowWrench { residual: off - TAU * (off / TAU).round(), own_rate: -driven[1], ..turn }
        }
        _ => rows[number].wrench(places, driven),
    }
}
