//! Spectra of random inputs in a CSV file: a frequency, and a column for each density, coherence or phase.
//!
//! Densities are straight between rows on axes that are both logarithmic, as specifications of random vibration have them; where one is
//! zero, and for coherences and phases, on linear axes.

use std::path::{Path, PathBuf};

use diagnostic::{Failure, Kind};
use faer::{Mat, c64};
use linear::RandomInput;

use super::names::is_asked;
use super::table;

/// Two inputs with their coherence and phase.
#[derive(Debug, Clone)]
struct Pair {
    inputs: [usize; 2],
    /// Columns of the coherence and of the phase.
    coherence: usize,
    phase: Option<usize>,
}

/// Names of inputs, and their columns.
type Inputs = Vec<(String, usize)>;

/// Spectra of random inputs.
#[derive(Debug, Clone)]
pub struct Spectra {
    path: PathBuf,
    inputs: Inputs,
    pairs: Vec<Pair>,
    /// Rows: frequency, then the columns.
    rows: Vec<Vec<f64>>,
}

impl Spectra {
    /// Reads a table. Empty lines and those that begin with `#` are left out.
    ///
    /// # Errors
    /// [`Failure`].
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let unreadable =
            |error: std::io::Error| Kind::Io.of(path).help("name a CSV file of spectra").says(error.to_string());
        let mut lines = table::lines(path).map_err(unreadable)?.into_iter();
        let header = lines.next().map_or_else(String::new, |(_, content)| content);
        let (inputs, pairs) = columns(path, &header)?;
        let width = header.split(',').count();
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for (line, content) in lines {
            let refuse = |found: String, expected: &str| {
                Err(Kind::Input.of(path).line(line).found(found).expected(expected).into())
            };
            let numbers: Vec<f64> = content
                .split(',')
                .map_while(|field| field.trim().parse().ok().filter(|x: &f64| x.is_finite()))
                .collect();
            if numbers.len() != width || content.split(',').count() != width {
                let found = format!(
                    "{} field(s), the first {} of them finite numbers",
                    content.split(',').count(),
                    numbers.len()
                );
                return refuse(found, &format!("{width} numbers"));
            }
            if numbers[0] < 0.0 || rows.last().is_some_and(|before| before[0] >= numbers[0]) {
                return refuse(
                    format!("frequency {}", numbers[0]),
                    "a frequency above that of the row before, 0 or more",
                );
            }
            if let Some((name, column)) = inputs.iter().find(|(_, column)| numbers[*column] < 0.0) {
                return refuse(format!("density {} of {name}", numbers[*column]), "0 or more");
            }
            if let Some(pair) = pairs.iter().find(|pair| !(0.0..=1.0).contains(&numbers[pair.coherence])) {
                return refuse(format!("coherence {}", numbers[pair.coherence]), "0 to 1");
            }
            rows.push(numbers);
        }
        if rows.len() < 2 {
            return Err(Kind::Input.of(path).found(format!("{} rows", rows.len())).expected("2 or more").into());
        }
        Ok(Self { path: path.to_owned(), inputs, pairs, rows })
    }

    /// Names of the inputs, or beginnings of them.
    pub fn inputs(&self) -> Vec<String> {
        self.inputs.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Frequencies of the rows.
    pub fn frequencies(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row[0]).collect()
    }

    /// The band of the table, or a band that is within it.
    ///
    /// # Errors
    /// A band that is none, or not within the table.
    pub fn band(&self, asked: Option<[f64; 2]>) -> Result<[f64; 2], Failure> {
        let table = [self.rows[0][0], self.rows[self.rows.len() - 1][0]];
        let Some(band) = asked else { return Ok(table) };
        let [start, end] = band;
        if !(start >= 0.0 && end > start && end.is_finite()) {
            let expected = "start:end with 0 ≤ start < end, e.g. 20:2000";
            let wrong = Kind::Usage.alone().key("--band").found(format!("{start}:{end}")).expected(expected);
            return Err(wrong.says(format!("band {start}:{end}: expected {expected}")));
        }
        let covered = (end.min(table[1]) - start.max(table[0])).max(0.0);
        let left_out = 1.0 - covered / (end - start);
        if start < table[0] || end > table[1] {
            let wrong = Kind::Usage.of(&self.path).found(format!(
                "rows from {} to {}, which leave out {left_out:.3} of the band {start} to {end} on a linear axis",
                table[0], table[1]
            ));
            let help = "give rows for all of it, with 0 where nothing acts, or a band within the table (--band)";
            return Err(wrong.expected("rows for all of the band").help(help).into());
        }
        Ok(band)
    }

    /// The densities of a model's inputs, by their names, at some frequencies.
    ///
    /// # Errors
    /// A name of no input, or of several.
    pub fn at(&self, names: &[&str], frequencies: &[f64]) -> Result<RandomInput, Failure> {
        let mut place = Vec::new();
        for (asked, _) in &self.inputs {
            let found: Vec<usize> = (0..names.len()).filter(|k| is_asked(names[*k], asked)).collect();
            let [only] = found[..] else {
                let found = format!("column `{asked}`, which names {} inputs", found.len());
                let wrong = Kind::Input.of(&self.path).line(1).found(found);
                return Err(wrong.expected(format!("one of {}", names.join(", "))).into());
            };
            place.push(only);
        }
        let m = names.len();
        let densities = |frequency: f64| {
            let mut own = vec![0.0; m];
            for ((_, column), input) in self.inputs.iter().zip(&place) {
                own[*input] = self.density(*column, frequency);
            }
            own
        };
        if self.pairs.is_empty() {
            return Ok(RandomInput::Independent(frequencies.iter().map(|f| densities(*f)).collect()));
        }
        let matrix = |frequency: &f64| {
            let own = densities(*frequency);
            let mut matrix = Mat::from_fn(m, m, |i, j| c64::new(if i == j { own[i] } else { 0.0 }, 0.0));
            for Pair { inputs, coherence, phase } in &self.pairs {
                let [a, b] = inputs.map(|input| place[input]);
                let size = (self.straight(*coherence, *frequency) * own[a] * own[b]).sqrt();
                let phase = phase.map_or(0.0, |column| self.straight(column, *frequency).to_radians());
                // The phase of B before A: E[B A*] has it.
                let (sine, cosine) = phase.sin_cos();
                matrix[(b, a)] = c64::new(size * cosine, size * sine);
                matrix[(a, b)] = c64::new(size * cosine, -size * sine);
            }
            matrix
        };
        Ok(RandomInput::Correlated(frequencies.iter().map(matrix).collect()))
    }

    /// The rows around a frequency, and its part of the way between them.
    fn around(&self, frequency: f64) -> [&Vec<f64>; 2] {
        let after = self.rows.partition_point(|row| row[0] <= frequency).clamp(1, self.rows.len() - 1);
        [&self.rows[after - 1], &self.rows[after]]
    }

    fn straight(&self, column: usize, frequency: f64) -> f64 {
        let [before, after] = self.around(frequency);
        let part = (frequency - before[0]) / (after[0] - before[0]);
        before[column] + part * (after[column] - before[column])
    }

    fn density(&self, column: usize, frequency: f64) -> f64 {
        let [before, after] = self.around(frequency);
        let [low, high] = [before[column], after[column]];
        if low <= 0.0 || high <= 0.0 || before[0] <= 0.0 {
            return self.straight(column, frequency);
        }
        low * (frequency / before[0]).powf((high / low).ln() / (after[0] / before[0]).ln())
    }
}

/// Inputs and pairs of a header.
fn columns(path: &Path, header: &str) -> Result<(Inputs, Vec<Pair>), Failure> {
    let refuse = |found: String| {
        let expected = "`frequency`, then inputs by name, such as `frequency,loads[0].force,base.acceleration.y`, and for two of them \
                        `coherence A & B` and `phase A & B`";
        Err(Kind::Input.of(path).line(1).found(found).expected(expected).into())
    };
    let names: Vec<&str> = header.split(',').map(str::trim).collect();
    if names[0] != "frequency" || names.len() < 2 {
        return refuse(format!("`{header}`"));
    }
    let is_pair = |name: &str| name.starts_with("coherence ") || name.starts_with("phase ");
    let numbered = || names.iter().copied().enumerate().skip(1);
    let inputs: Inputs =
        numbered().filter(|(_, name)| !is_pair(name)).map(|(column, name)| (name.to_owned(), column)).collect();
    if let Some((name, _)) = inputs.iter().enumerate().find_map(|(k, input)| {
        let again = inputs[..k].iter().any(|other| other.0 == input.0);
        (again || input.0.is_empty()).then_some(input)
    }) {
        return refuse(format!("`{name}` twice, or a column without a name"));
    }
    let mut pairs: Vec<Pair> = Vec::new();
    for kind in ["coherence ", "phase "] {
        for (column, name) in numbered() {
            let Some(both) = name.strip_prefix(kind) else { continue };
            let found: Vec<usize> =
                both.split('&').filter_map(|one| inputs.iter().position(|(name, _)| name == one.trim())).collect();
            let [a, b] = found[..] else { return refuse(format!("`{name}`, of inputs that have no column")) };
            let known = pairs.iter_mut().find(|pair| pair.inputs == [a, b] || pair.inputs == [b, a]);
            match (kind, known) {
                _ if a == b => return refuse(format!("`{name}`, of an input with itself")),
                ("coherence ", None) => pairs.push(Pair { inputs: [a, b], coherence: column, phase: None }),
                ("phase ", Some(pair)) if pair.inputs == [a, b] && pair.phase.is_none() => pair.phase = Some(column),
                _ => return refuse(format!("`{name}` twice, or without `coherence` in the same order")),
            }
        }
    }
    Ok((inputs, pairs))
}
