//! One HTML page of answers over the frequency, with the values of all curves under the pointer.

use std::path::Path;

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

/// Answers over the frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Responses {
    /// Title.
    pub title: String,
    /// Name and version of the program.
    pub program: String,
    /// Lines of the summary.
    pub facts: Vec<Fact>,
    /// Reservations.
    pub warnings: Vec<String>,
    /// Unit of frequencies.
    pub frequency_unit: String,
    /// True where the axis of the frequency is logarithmic at first.
    pub logarithmic: bool,
    /// Frequencies, rising (n).
    pub frequencies: Vec<f64>,
    /// Charts, one above the other (c).
    pub charts: Vec<Chart>,
    /// Headings of the numbers that each curve has as a whole (m).
    pub headings: Vec<String>,
    /// Curves. A page holds two million numbers; those after them are left out, and the page says so.
    pub curves: Vec<Curve>,
}

/// A chart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Chart {
    /// Name.
    pub name: String,
    /// True where the axis of its values is logarithmic; values of zero and below have no place then.
    pub logarithmic: bool,
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
    facts: Vec<[&'a str; 2]>,
    warnings: &'a [String],
    frequency_unit: &'a str,
    logarithmic: bool,
    frequencies: Numbers,
    charts: &'a [Chart],
    headings: &'a [String],
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

impl Responses {
    /// The page as one text. Values are in single precision.
    ///
    /// # Errors
    /// Lists that do not fit together, numbers that are not finite, nothing to show.
    pub fn html(&self) -> Result<String, ReportError> {
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
            program: &self.program,
            title: &self.title,
            facts: self.facts.iter().map(|Fact { label, value }| [&label[..], &value[..]]).collect(),
            warnings: &self.warnings,
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
    pub fn write(&self, path: &Path) -> Result<(), ReportError> {
        write_whole(path, self.html()?).map_err(|source| ReportError::Write { path: path.to_owned(), source })
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

    fn page(count: usize, frequencies: usize) -> Responses {
        let curve = |k: usize| Curve {
            name: format!("tip.displacement</script>{k}"),
            units: vec!["mm".to_owned(), "°".to_owned()],
            values: vec![vec![1.0; frequencies], vec![-90.0; frequencies]],
            about: vec!["1 mm at 2 Hz".to_owned()],
        };
        Responses {
            title: "Bar".to_owned(),
            program: "flexframe".to_owned(),
            facts: Vec::new(),
            warnings: Vec::new(),
            frequency_unit: "Hz".to_owned(),
            logarithmic: false,
            frequencies: (0..frequencies).map(|k| k as f64).collect(),
            charts: [("Magnitude", true), ("Phase", false)]
                .map(|(name, logarithmic)| Chart { name: name.to_owned(), logarithmic })
                .to_vec(),
            headings: vec!["peak".to_owned()],
            curves: (0..count).map(curve).collect(),
        }
    }

    #[test]
    fn texts_of_the_user_stay_within_the_data() {
        let page = page(2, 5).html().unwrap();
        assert!(!page.contains("displacement</script>") && page.contains("displacement\\u003c/script>"));
        assert!(!page.contains(PLACE) && page.contains("\"left_out\":null"));
    }

    #[test]
    fn a_page_says_what_it_leaves_out() {
        let page = page(3, 500_001).html().unwrap();
        assert!(page.contains("2 more curves are in the table"));
    }

    #[test]
    fn lists_that_do_not_fit_and_numbers_that_are_none_are_refused() {
        let mut short = page(1, 5);
        short.curves[0].values[1].pop();
        assert!(matches!(short.html(), Err(ReportError::WrongLength { found: 4, expected: 5, .. })));
        let mut none = page(1, 5);
        none.curves[0].values[0][3] = f64::NAN;
        assert!(matches!(none.html(), Err(ReportError::NotFinite { index: 3, .. })));
        assert!(matches!(page(0, 5).html(), Err(ReportError::Empty { .. })));
    }
}
