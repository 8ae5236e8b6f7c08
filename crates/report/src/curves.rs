//! Curves over the frequency: a chart, and one HTML page with the values of all curves under the pointer.

use std::path::Path;

use figures::{LineChart, Scale, Series, Stroke};
use serde::Serialize;
use whole_file::write_whole;

use crate::numbers::Numbers;
use crate::{Fact, ReportError};

/// The page that `./dev report-page` builds from `web/src/responses`.
const PAGE: &str = include_str!("../web/responses.html");

/// Where the data stand in the page.
const PLACE: &str = "\"the data of the page\"";

/// The most numbers in a page.
const MOST: usize = 2_000_000;

/// Curves of a chart at the most.
const MAX_CURVES: usize = 12;
/// Curves with a colour of their own: those after them are dashed.
const COLOURS: usize = 7;

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
    /// Charts of the page, one above the other (c). The first is the chart of the files.
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
    pub fn html(&self, words: PageWords) -> Result<String, ReportError> {
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
        // Strings and finite numbers: they can all be written.
        let json = serde_json::to_string(&data).unwrap_or_default();
        // A text of the user could otherwise end the script that holds the data.
        Ok(PAGE.replacen(PLACE, &json.replace('<', "\\u003c"), 1))
    }

    /// Writes the page to `path`, whole or not at all.
    ///
    /// # Errors
    /// Errors of [`Self::html`], and of the system.
    pub fn write(&self, words: PageWords, path: &Path) -> Result<(), ReportError> {
        write_whole(path, self.html(words)?).map_err(|source| ReportError::Write { path: path.to_owned(), source })
    }

    fn titled(&self, title: &str) -> String {
        if title.is_empty() { self.subject.to_owned() } else { format!("{title}: {}", self.subject) }
    }

    /// The first chart, with as many curves as there is room for. On a logarithmic axis are values above zero, as the acceleration at no
    /// frequency is not; where there is none at all, the axis is linear and the curves are zero.
    pub fn chart(&self, title: &str) -> LineChart {
        let Some(Chart { name, logarithmic }) = self.charts.first() else { return LineChart::default() };
        let values = |curve: &Curve| curve.values.first().cloned().unwrap_or_default();
        let any_positive = self.curves.iter().flat_map(values).any(|value| value > 0.0);
        let scale = |logarithmic: bool| if logarithmic { Scale::Log } else { Scale::Linear };
        let y_scale = scale(*logarithmic && any_positive);
        let is_drawn = |(x, y): &(f64, f64)| (y_scale == Scale::Linear || *y > 0.0) && (!self.logarithmic || *x > 0.0);
        let series = self.curves.iter().map(|curve| {
            let points = self.frequencies.iter().copied().zip(values(curve)).filter(is_drawn);
            Series { label: curve.name.clone(), points: points.collect(), stroke: Stroke::Solid }
        });
        let mut series: Vec<Series> = series.filter(|series| !series.points.is_empty()).take(MAX_CURVES).collect();
        series.iter_mut().skip(COLOURS).for_each(|series| series.stroke = Stroke::Dashed);
        LineChart {
            title: self.titled(title),
            x_label: format!("Frequency ({})", self.frequency_unit),
            y_label: name.clone(),
            x_scale: scale(self.logarithmic),
            y_scale,
            series,
            reference: None,
        }
    }

    fn check(&self) -> Result<(), ReportError> {
        for (what, count) in
            [("frequencies", self.frequencies.len()), ("charts", self.charts.len()), ("curves", self.curves.len())]
        {
            if count == 0 {
                return Err(ReportError::Empty { what: what.to_owned() });
            }
        }
        finite("frequencies", &self.frequencies)?;
        let length = |what: &str, found: usize, expected: usize| match found == expected {
            true => Ok(()),
            false => Err(ReportError::WrongLength { what: what.to_owned(), found, expected }),
        };
        for curve in &self.curves {
            let what = format!("curve {:?}", curve.name);
            length(&format!("{what}, units"), curve.units.len(), self.charts.len())?;
            length(&format!("{what}, charts"), curve.values.len(), self.charts.len())?;
            length(&format!("{what}, texts"), curve.about.len(), self.headings.len())?;
            for values in &curve.values {
                length(&what, values.len(), self.frequencies.len())?;
                finite(&what, values)?;
            }
        }
        Ok(())
    }
}

/// Finite numbers that single precision can hold.
fn finite(what: &str, values: &[f64]) -> Result<(), ReportError> {
    match values.iter().position(|value| !(*value as f32).is_finite()) {
        Some(index) => Err(ReportError::NotFinite { what: what.to_owned(), index, value: values[index] }),
        None => Ok(()),
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
        assert!(matches!(short.html(words()), Err(ReportError::WrongLength { found: 4, expected: 5, .. })));
        let mut none = page(1, 5);
        none.curves[0].values[0][3] = f64::NAN;
        assert!(matches!(none.html(words()), Err(ReportError::NotFinite { index: 3, .. })));
        assert!(matches!(page(0, 5).html(words()), Err(ReportError::Empty { .. })));
    }
}
