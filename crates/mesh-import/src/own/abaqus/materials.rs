//! Materials of a deck: `*ELASTIC` and `*DENSITY`.

use crate::error::ImportError;
use crate::own::abaqus::lines::{Block, number};
use crate::own::texts::Texts;

/// A `*MATERIAL`.
#[derive(Debug)]
pub(super) struct Material {
    pub(super) name: String,
    /// Lines of numbers.
    elastic: Vec<Vec<f64>>,
    density: Vec<Vec<f64>>,
    /// Why it is not read.
    why: Option<String>,
}

impl Material {
    pub(super) fn new(name: String) -> Self {
        Self { name, elastic: Vec::new(), density: Vec::new(), why: None }
    }

    /// Takes `*ELASTIC` or `*DENSITY`.
    pub(super) fn take(&mut self, texts: &Texts<'_>, block: &Block<'_>) -> Result<(), ImportError> {
        let is_elastic = block.keyword == "ELASTIC";
        if is_elastic
            && let Some(of) = block.parameter("TYPE")
            && !["ISO", "ISOTROPIC"].iter().any(|name| of.eq_ignore_ascii_case(name))
        {
            let of: String = of.chars().filter(char::is_ascii_alphanumeric).take(20).collect();
            self.why = Some(format!("its *ELASTIC is of TYPE={of}, and only isotropic ones are"));
            return Ok(());
        }
        for data in &block.data {
            let numbers: Option<Vec<f64>> = data.words().iter().map(|word| number(word)).collect();
            let Some(numbers) = numbers else {
                let found = format!("in *{}, found {}, expected numbers", block.keyword, texts.shown(*data));
                return Err(texts.refuse(data.place, found, "check this line"));
            };
            if is_elastic { &mut self.elastic } else { &mut self.density }.push(numbers);
        }
        Ok(())
    }

    /// Young's modulus and Poisson's ratio, where only the density is missing.
    pub(super) fn without_density(&self) -> Option<[f64; 2]> {
        match (&self.why, &self.elastic[..]) {
            (None, [line]) if self.density.is_empty() && line.len() >= 2 => Some([line[0], line[1]]),
            _ => None,
        }
    }

    /// The density, where it is one number.
    pub(super) fn density(&self) -> Option<f64> {
        match &self.density[..] {
            [line] => line.first().copied(),
            _ => None,
        }
    }

    /// Young's modulus, Poisson's ratio and the density; or why there are none.
    pub(super) fn numbers(&self) -> Result<[f64; 3], String> {
        if let Some(why) = &self.why {
            return Err(why.clone());
        }
        for (keyword, lines, count) in [("ELASTIC", &self.elastic, 2), ("DENSITY", &self.density, 1)] {
            if lines.first().is_none_or(|line| line.len() < count) {
                return Err(format!("it has no *{keyword} with numbers"));
            }
            if lines.len() > 1 {
                return Err(format!("its *{keyword} is a table over temperature"));
            }
        }
        Ok([self.elastic[0][0], self.elastic[0][1], self.density[0][0]])
    }
}
