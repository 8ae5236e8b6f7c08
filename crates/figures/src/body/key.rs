//! The key below bodies: where their axes point, and what the colours mean.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::FigureError;
use crate::body::render::value_colour;
use crate::body::view::View;
use crate::chart::axis::{Axis, Scale};
use crate::document::font;
use crate::document::picture::{Area, INK, LABEL_EM, TICK_EM, Unit};

// Lengths in pixels.
const BAR: [f64; 2] = [240.0, 10.0];
const ARM: f64 = 13.0;
/// Between two labels of the bar at least.
const LABEL_GAP: f64 = 6.0;
/// Distance of a letter from the end of its arm.
const LETTER: f64 = 7.0;
/// Height of the key: the bar with its labels, or the axes.
pub(crate) const HEIGHT: f64 = BAR[1] + 2.6 * LABEL_EM + 8.0;

/// The axis of the colours for these values. It begins at 0, unless there are values below it. It has as many ticks, five or so
/// at the most, as have labels that do not touch.
pub(crate) fn colour_axis(values: impl Iterator<Item = f64>) -> Axis {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let high = if high > low { high } else { low + 1.0 };
    let axis = |count| Axis::new(Scale::Window(low, high), [], 0.0, count);
    (2..=5).rev().map(axis).find(|axis| label_gap(axis) >= LABEL_GAP).unwrap_or_else(|| axis(1))
}

/// Room between the labels of the axis of the colours where they are nearest, in pixels.
fn label_gap(axis: &Axis) -> f64 {
    let (low, high) = axis.range;
    let labels: Vec<[f64; 2]> = axis
        .labelled()
        .map(|(shown, label)| [BAR[0] * (shown - low) / (high - low), 0.5 * font::width(&label, TICK_EM)])
        .collect();
    labels.windows(2).map(|pair| pair[1][0] - pair[1][1] - pair[0][0] - pair[0][1]).fold(f64::INFINITY, f64::min)
}

/// Where a value lies on the axis of the colours: 0 at its lower end, 1 at its upper one.
pub(crate) fn shade(axis: &Axis, value: f64) -> f64 {
    let (low, high) = axis.range;
    (axis.shown(value) - low) / (high - low)
}

/// Draws both into an area as high as [`HEIGHT`] or a little higher: the axes at its left, the bar in its middle.
pub(crate) fn draw_key<DB: DrawingBackend>(
    area: &Area<DB>,
    view: &View,
    values: &Axis,
    label: &str,
    unit: Unit,
) -> Result<(), FigureError> {
    draw_bar(area, values, label, unit)?;
    draw_axes(area, view, unit)
}

fn draw_bar<DB: DrawingBackend>(area: &Area<DB>, values: &Axis, label: &str, unit: Unit) -> Result<(), FigureError> {
    let (width, height) = area.dim_in_pixel();
    let side = (width as i32 - unit.px(BAR[0])) / 2;
    let mut chart = ChartBuilder::on(area)
        .margin_left(side)
        .margin_right(side)
        .x_label_area_size(height as i32 - unit.px(BAR[1]))
        .build_cartesian_2d(values.clone(), 0.0..1.0)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(INK.stroke_width(unit.stroke(1.0)))
        .label_style(unit.text(TICK_EM, HPos::Center, VPos::Top))
        .axis_desc_style(unit.text(LABEL_EM, HPos::Center, VPos::Top))
        .x_desc(label)
        .set_all_tick_mark_size(unit.px(3.0))
        .draw()?;
    let steps = 120;
    let (low, high) = values.range;
    let at = |i: usize| low + (high - low) * i as f64 / steps as f64;
    chart.draw_series((0..steps).map(|i| {
        let colour = value_colour((i as f64 + 0.5) / steps as f64);
        // To the end of the bar, so that no seam is seen before the next one.
        Rectangle::new([(at(i), 0.0), (high, 1.0)], colour.filled())
    }))?;
    if !values.note.is_empty() {
        let (across, down) = chart.plotting_area().get_pixel_range();
        let text = unit.text(TICK_EM, HPos::Left, VPos::Bottom);
        let screen = area.use_screen_coord();
        screen.draw(&Text::new(values.note.as_str(), (across.end + unit.px(14.0), down.end), text))?;
    }
    Ok(())
}

/// The directions x, y and z as they are seen.
fn draw_axes<DB: DrawingBackend>(area: &Area<DB>, view: &View, unit: Unit) -> Result<(), FigureError> {
    let reach = ARM + LETTER + 0.5 * TICK_EM;
    let origin = [reach, f64::from(area.dim_in_pixel().1) / unit.per_pixel() - reach];
    let place = |[x, y]: [f64; 2]| (unit.px(origin[0] + x), unit.px(origin[1] - y));
    let text = unit.text(TICK_EM, HPos::Center, VPos::Center);
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        let mut unit_vector = [0.0; 3];
        unit_vector[axis] = 1.0;
        let seen = view.see(&unit_vector);
        let length = seen.x.hypot(seen.y);
        // One that points at the viewer has its letter beside the origin.
        let direction = if length > 0.1 { [seen.x / length, seen.y / length] } else { [-0.7, -0.7] };
        let end = [ARM * seen.x, ARM * seen.y];
        let line = vec![place([0.0; 2]), place(end)];
        area.draw(&PathElement::new(line, INK.stroke_width(unit.stroke(1.5))))?;
        let beyond = [0, 1].map(|i| end[i] + LETTER * direction[i]);
        area.draw_text(letter, &text, place(beyond))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: zero, or the smallest value if it is negative.
    #[test]
    fn colours_begin_at_zero_whatever_the_smallest_value() {
        let range = |values: &[f64]| colour_axis(values.iter().copied()).values();
        assert_eq!(range(&[2.0, 5.0]), (0.0, 5.0));
        assert_eq!(range(&[-1.0, 3.0]), (-1.0, 3.0));
        assert_eq!(range(&[0.0, 0.0]), (0.0, 1.0));
        assert_eq!(range(&[]), (0.0, 1.0));
        let axis = colour_axis([2e-9, 4e-9].into_iter());
        assert!((shade(&axis, 2e-9) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn labels_of_the_bar_do_not_touch_however_long_they_are() {
        for high in [1.0, 0.0123, 1234.5, 54321.0, 0.009999, 99999.0, 3.3e-7, 2.5e9, 7000.1] {
            for low in [0.0, -0.3 * high, -high, -1e6 * high] {
                let axis = colour_axis([low, high].into_iter());
                assert!(label_gap(&axis) >= LABEL_GAP, "{low} {high}: {:?}", axis.labels().collect::<Vec<_>>());
                assert!(axis.labels().count() >= 2, "{low} {high}");
            }
        }
    }
}
