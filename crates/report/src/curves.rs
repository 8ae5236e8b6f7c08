//! Curves over the frequency: a chart, and one HTML page with the values of all curves under the pointer.

use std::path::Path;

use diagnostic::Failure;
use figures::{ChartStack, LineChart, Scale, Series, Stroke};
use serde::Serialize;
use whole_file::write_whole;

use crate::Fact;
use crate::check::{finite, length};
use crate::error::{empty, not_written};
use crate::numbers::Numbers;
use crate::page::filled;

/// The page that `./dev report-page` builds from `web/src/responses`.
const PAGE: &str = include_str!("../web/responses.html");

/// Where the data stand in the page.
const PLACE: &str = "\"the data of the page\"";

/// The most numbers in a page.
const MOST: usize = 2_000_000;

/// Curves of a chart at the most.
const MAX_CURVES: usize = 12;
/// Charts of a figure at the most.
const MAX_CHARTS: usize = 8;
/// Part of the axis of the frequency that the label of a resonance takes.
const ROOM: f64 = 0.07;

/// Curves over the frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// Words after the title of the report, such as "frequency response".
    pub subject: &'static str,
    /// Unit of frequencies.
    pub frequency_unit: String,
    /// True where the axis of the frequency is logarithmic at first.
    pub logarithmic: bool,
    /// Frequencies, rising (n).
    pub frequencies: Vec<f64>,
    /// Natural frequencies that the figure names, rising.
    pub resonances: Vec<f64>,
    /// Charts, one above the other (c).
    pub charts: Vec<Chart>,
    /// Headings of the numbers that each curve has as a whole (m).
    pub headings: Vec<&'static str>,
    /// Curves. A page holds two million numbers; those after them are left out, and the page says so.
    pub curves: Vec<Curve>,
}

/// A chart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Chart {
    /// Name of its values, with their unit where all have the same.
    pub name: String,
    /// True where the axis of its values is logarithmic; values of zero and below have no place then.
    pub logarithmic: bool,
}

impl Chart {
    /// By its name, and with a logarithmic axis or not.
    pub fn new(name: impl Into<String>, logarithmic: bool) -> Self {
        Self { name: name.into(), logarithmic }
    }
}

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name.
    pub name: String,
    /// Unit of its values in each chart (c).
    pub units: Vec<String>,
    /// Its values in each chart (c × n).
    pub values: Vec<Vec<f64>>,
    /// A text under each heading (m).
    pub about: Vec<String>,
}

/// The page as its program reads it. `web/src/responses/data.ts` has the same fields.
#[derive(Debug, Serialize)]
struct Data<'a> {
    program: &'a str,
    title: &'a str,
    facts: Vec<[String; 2]>,
    warnings: &'a [String],
    frequency_unit: &'a str,
    logarithmic: bool,
    frequencies: Numbers,
    charts: &'a [Chart],
    headings: &'a [&'static str],
    curves: Vec<CurveData<'a>>,
    left_out: Option<String>,
}

#[derive(Debug, Serialize)]
struct CurveData<'a> {
    name: &'a str,
    units: &'a [String],
    values: Vec<Numbers>,
    about: &'a [String],
}

/// The words of a page beside its curves.
#[derive(Debug, Clone)]
pub struct PageWords<'a> {
    /// Title.
    pub title: &'a str,
    /// Name and version of the program.
    pub program: &'a str,
    /// Lines of the summary.
    pub facts: Vec<Fact>,
    /// Reservations.
    pub warnings: &'a [String],
}

impl Curves {
    /// The page as one text. Values are in single precision.
    ///
    /// # Errors
    /// Lists that do not fit together, numbers that are not finite, nothing to show.
    pub fn html(&self, words: PageWords) -> Result<String, Failure> {
        self.check()?;
        let of_curve = self.charts.len() * self.frequencies.len();
        let kept = (MOST / of_curve).max(1).min(self.curves.len());
        let left_out = self.curves.len() - kept;
        let curves = self.curves[..kept].iter().map(|Curve { name, units, values, about }| CurveData {
            name,
            units,
            values: values.iter().map(|values| Numbers::single(values.iter().copied(), 1)).collect(),
            about,
        });
        let data = Data {
            program: words.program,
            title: &self.titled(words.title),
            facts: words.facts.into_iter().map(|Fact { label, value }| [label, value]).collect(),
            warnings: words.warnings,
            frequency_unit: &self.frequency_unit,
            logarithmic: self.logarithmic,
            frequencies: Numbers::double(self.frequencies.iter().copied()),
            charts: &self.charts,
            headings: &self.headings,
            curves: curves.collect(),
            left_out: (left_out > 0).then(|| {
                format!("{left_out} more curves are in the table beside this page (CSV): ask for fewer frequencies or outputs to see them here.")
            }),
        };
        Ok(filled(PAGE, PLACE, &data))
    }

    /// Writes the page to `path`, whole or not at all.
    ///
    /// # Errors
    /// Errors of [`Self::html`], and of the system.
    pub fn write(&self, words: PageWords, path: &Path) -> Result<(), Failure> {
        write_whole(path, self.html(words)?).map_err(|error| not_written(path, &error))
    }

    fn titled(&self, title: &str) -> String {
        if title.is_empty() { self.subject.to_owned() } else { format!("{title}: {}", self.subject) }
    }

    /// Charts one below another: for each unit of the first values of the curves one a chart of the page, with as many curves as there is
    /// room for. On a logarithmic axis are values above zero, as the acceleration at no frequency is not; where there is none at all, the
    /// axis is linear and the curves are zero.
    pub(crate) fn figure(&self, title: &str) -> ChartStack {
        let mut units: Vec<&str> = Vec::new();
        for unit in self.curves.iter().filter_map(|curve| curve.units.first()) {
            if !units.contains(&unit.as_str()) {
                units.push(unit);
            }
        }
        let of_unit = |unit: &&str| {
            let curves = self.curves.iter().filter(|curve| curve.units.first().is_some_and(|of| of == unit));
            let curves: Vec<&Curve> = curves.take(MAX_CURVES).collect();
            let charts = (0..self.charts.len()).map(|k| self.chart(k, &curves));
            charts.filter(|chart| !chart.is_empty()).collect::<Vec<LineChart>>()
        };
        let charts = units.iter().flat_map(of_unit).take(MAX_CHARTS).collect();
        ChartStack { title: self.titled(title), charts }
    }

    /// The chart with a number of some curves, with the resonances.
    fn chart(&self, k: usize, curves: &[&Curve]) -> LineChart {
        let Chart { name, logarithmic } = &self.charts[k];
        let any_positive = curves.iter().flat_map(|curve| &curve.values[k]).any(|value| *value > 0.0);
        let scale = |logarithmic: bool| if logarithmic { Scale::Log } else { Scale::Linear };
        let y_scale = scale(*logarithmic && any_positive);
        let is_drawn = |(x, y): &(f64, f64)| (y_scale == Scale::Linear || *y > 0.0) && (!self.logarithmic || *x > 0.0);
        let line = |(number, curve): (usize, &&Curve)| Series {
            label: curve.name.clone(),
            points: self.frequencies.iter().copied().zip(curve.values[k].iter().copied()).filter(is_drawn).collect(),
            stroke: Stroke::of_line(number),
        };
        let mut series: Vec<Series> = curves.iter().enumerate().map(line).collect();
        series.retain(|series| !series.points.is_empty());
        let values = || series.iter().flat_map(|series| &series.points).map(|point| point.1);
        let (low, high) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        if low < high {
            series.extend(self.guides(low, high));
        }
        let unit = curves.first().map_or("", |curve| &curve.units[k]);
        LineChart {
            title: String::new(),
            x_label: format!("Frequency ({})", self.frequency_unit),
            y_label: if unit.is_empty() || name.contains(unit) { name.clone() } else { format!("{name} ({unit})") },
            x_scale: scale(self.logarithmic),
            y_scale,
            series,
            reference: None,
        }
    }

    /// A line for each resonance, with its frequency where there is room.
    fn guides(&self, low: f64, high: f64) -> Vec<Series> {
        let drawn = self.frequencies.iter().copied().filter(|x| !self.logarithmic || *x > 0.0);
        let along = |x: f64| if self.logarithmic { x.ln() } else { x };
        let (start, end) = drawn.fold((f64::INFINITY, 0.0), |(start, end): (f64, f64), x| (start.min(x), end.max(x)));
        let mut labelled = along(start);
        let guide = |resonance: &f64| {
            let x = along(*resonance);
            let has_room = x - labelled > ROOM * (along(end) - along(start));
            if has_room {
                labelled = x;
            }
            let label = if has_room { format!("{resonance:.1}") } else { String::new() };
            Series { label, points: vec![(*resonance, low), (*resonance, high)], stroke: Stroke::Guide }
        };
        self.resonances.iter().filter(|x| (start..=end).contains(*x)).map(guide).collect()
    }

    fn check(&self) -> Result<(), Failure> {
        for (what, count) in
            [("frequencies", self.frequencies.len()), ("charts", self.charts.len()), ("curves", self.curves.len())]
        {
            if count == 0 {
                return Err(empty(what));
            }
        }
        finite("frequencies", self.frequencies.iter().copied())?;
        for curve in &self.curves {
            let what = format!("curve {:?}", curve.name);
            length(&format!("{what}, units"), curve.units.len(), self.charts.len())?;
            length(&format!("{what}, charts"), curve.values.len(), self.charts.len())?;
            length(&format!("{what}, texts"), curve.about.len(), self.headings.len())?;
            for values in &curve.values {
                length(&what, values.len(), self.frequencies.len())?;
                finite(&what, values.iter().copied())?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words() -> PageWords<'static> {
        PageWords { title: "Bar", program: "flexframe", facts: Vec::new(), warnings: &[] }
    }

    fn page(count: usize, frequencies: usize) -> Curves {
        let curve = |k: usize| Curve {
            name: format!("tip.displacement</script>{k}"),
            units: vec!["mm".to_owned(), "°".to_owned()],
            values: vec![vec![1.0; frequencies], vec![-90.0; frequencies]],
            about: vec!["1 mm at 2 Hz".to_owned()],
        };
        Curves {
            subject: "frequency response",
            frequency_unit: "Hz".to_owned(),
            logarithmic: false,
            frequencies: (0..frequencies).map(|k| k as f64).collect(),
            resonances: vec![2.0],
            charts: [("Magnitude", true), ("Phase", false)]
                .map(|(name, logarithmic)| Chart { name: name.to_owned(), logarithmic })
                .to_vec(),
            headings: vec!["peak"],
            curves: (0..count).map(curve).collect(),
        }
    }

    #[test]
    fn texts_of_the_user_stay_within_the_data() {
        let page = page(2, 5).html(words()).unwrap();
        assert!(!page.contains("displacement</script>") && page.contains("displacement\\u003c/script>"));
        assert!(!page.contains(PLACE) && page.contains("\"left_out\":null"));
    }

    #[test]
    fn a_page_says_what_it_leaves_out() {
        let page = page(3, 500_001).html(words()).unwrap();
        assert!(page.contains("2 more curves are in the table"));
    }

    #[test]
    fn lists_that_do_not_fit_and_numbers_that_are_none_are_refused() {
        let mut short = page(1, 5);
        short.curves[0].values[1].pop();
        let told = |page: Curves| page.html(words()).unwrap_err().to_string();
        assert!(told(short).contains("has 4 entries where 5 are expected"));
        let mut none = page(1, 5);
        none.curves[0].values[0][3] = f64::NAN;
        assert!(told(none).contains("holds NaN in entry 3 "));
        assert!(told(page(0, 5)).contains("has no curves"));
    }

    #[test]
    fn a_figure_has_charts_for_each_unit_and_names_resonances() {
        let mut curves = page(3, 5);
        curves.curves[1].units[0] = "mm/s".to_owned();
        let figure = curves.figure("Bar");
        let labels: Vec<&str> = figure.charts.iter().map(|chart| &chart.y_label[..]).collect();
        assert_eq!(labels, ["Magnitude (mm)", "Phase (°)", "Magnitude (mm/s)", "Phase (°)"]);
        assert_eq!(figure.title, "Bar: frequency response");
        // Lines that lie on one level have no place for a guide.
        assert_eq!(figure.charts[0].series.len(), 2);
        curves.curves[0].values[0][4] = 9.0;
        let guide = curves.figure("Bar").charts[0].series.pop().unwrap();
        assert_eq!((guide.label.as_str(), &guide.points[..]), ("2.0", &[(2.0, 1.0), (2.0, 9.0)][..]));
    }
}
