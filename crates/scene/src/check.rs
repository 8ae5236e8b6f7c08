//! The rules on the values of a scene that need no mesh. What the file gives comes in, what the scene holds goes out.

mod body;
mod constraint;
mod effects;
mod history;
mod initial;
mod load;
mod marker;
mod measured;
mod modes;
pub(crate) mod tie;
mod time;
pub(crate) mod units;

use std::cell::Cell;

use nalgebra::Vector3;

use crate::body::Frame;
use crate::document::{Document, join};
use crate::error::SceneError;
use crate::loads::unit_vector::unit;
use crate::text::shorten::shorten;

/// Three points whose triangle has an angle with a smaller sine count as lying on one line.
const LEAST_SINE: f64 = 1e-6;

/// The most entries of a list of which each takes memory and work as the mesh does.
const MAX_ENTRIES: usize = 1000;

/// The most that is read from the table files of a scene, in bytes (16 MiB).
const LONGEST_TABLES: u64 = 16 << 20;

/// The rules, on the values of one document.
pub(crate) struct Check<'d> {
    document: &'d Document<'d>,
    /// End of the run; a rule of its own says what it must be.
    end: f64,
    /// Bytes that table files may still have: one file may be named many times.
    table_bytes: Cell<u64>,
}

impl<'d> Check<'d> {
    pub fn new(document: &'d Document<'d>, end: f64) -> Self {
        Self { document, end, table_bytes: Cell::new(LONGEST_TABLES) }
    }
}

impl Check<'_> {
    /// Refuses the value with the key path `key`, as it is written, unless `rule` holds.
    fn require(&self, rule: bool, key: &str, expected: &str, help: &str) -> Result<(), SceneError> {
        if rule {
            return Ok(());
        }
        let node = self.document.nearest(key);
        Err(node.place().refuse(shorten(node.written()), expected, help))
    }

    fn positive(&self, key: &str, value: f64, help: &str) -> Result<(), SceneError> {
        self.require(value > 0.0, key, "a number greater than 0", help)
    }

    /// The refusal of a required key that is absent, as serde would give it.
    fn missing(&self, table: &str, key: &str) -> SceneError {
        SceneError::MissingKey { at: self.document.place(&join(table, key)).into(), key: key.to_owned() }
    }

    /// True if the file has a value with this key path.
    fn has(&self, key: &str) -> bool {
        self.document.nearest(key).path == key
    }

    /// Refuses the values at `table` if more than one of `keys` is there.
    fn at_most_one(&self, table: &str, keys: &[&str], help: &str) -> Result<(), SceneError> {
        let mut found = keys.iter().filter(|key| self.has(&join(table, key)));
        match (found.next(), found.next()) {
            (Some(first), Some(second)) => Err(self.document.place(&join(table, second)).refuse(
                format!("both `{first}` and `{second}`"),
                "at most one of them",
                help,
            )),
            _ => Ok(()),
        }
    }

    /// Refuses a list that would take too much with a large mesh.
    fn not_too_many(&self, key: &str, entries: usize, help: &str) -> Result<(), SceneError> {
        if entries <= MAX_ENTRIES {
            return Ok(());
        }
        let expected = format!("at most {MAX_ENTRIES}");
        Err(self.document.place(key).refuse(format!("{entries} entries"), expected, help))
    }

    /// Makes a vector a unit one.
    fn normalise(&self, key: &str, vector: &mut [f64; 3], help: &str) -> Result<(), SceneError> {
        let unit = unit(&Vector3::from(*vector));
        self.require(unit.is_some(), key, "a vector that is not zero", help)?;
        *vector = unit.unwrap_or_default().into();
        Ok(())
    }

    /// Refuses a list of numbers that do not rise, at the first one that does not.
    fn rising(
        &self,
        key: &str,
        numbers: &[f64],
        entry: impl Fn(usize) -> String,
        what: &str,
    ) -> Result<(), SceneError> {
        match numbers.windows(2).position(|pair| pair[0] >= pair[1]) {
            None => Ok(()),
            Some(i) => Err(self.document.place(&format!("{key}{}", entry(i + 1))).refuse(
                format!("{:?} after {:?}", numbers[i + 1], numbers[i]),
                format!("{what} that rise from entry to entry"),
                "put the entries in order, each once",
            )),
        }
    }

    pub fn label(&self, key: &str, text: &str) -> Result<(), SceneError> {
        self.require(
            !text.contains(char::is_control),
            key,
            "a text on one line, without control characters",
            "remove line breaks, tabs and `\\u0000`",
        )
    }

    pub fn frame(&self, frame: Option<&Frame>) -> Result<(), SceneError> {
        let Some(frame) = frame else { return Ok(()) };
        let [r, p, q] = [frame.r, frame.p, frame.q].map(Vector3::from);
        let help = "choose three points of the body that span a triangle, \
                    or remove [frame] to have them chosen";
        for (key, one, other, same) in
            [("frame.P", "R", "P", r == p), ("frame.Q", "R", "Q", r == q), ("frame.Q", "P", "Q", p == q)]
        {
            if same {
                let found = format!("the same point for {one} and {other}");
                return Err(self.document.place(key).refuse(found, "three different points", help));
            }
        }
        let sine = least_sine(&r, &p, &q);
        if sine >= LEAST_SINE {
            return Ok(());
        }
        Err(self.document.place("frame").refuse(
            format!("R, P, Q on one line (the smallest sine of an angle is {sine:.1e})"),
            format!("a triangle with no sine below {LEAST_SINE:e}"),
            help,
        ))
    }
}

/// The smallest sine of an angle of the triangle: the altitude on the longest side over the
/// second longest side. Near 0 if the points are on one line or two of them close together.
fn least_sine(r: &Vector3<f64>, p: &Vector3<f64>, q: &Vector3<f64>) -> f64 {
    let scale = r.amax().max(p.amax()).max(q.amax());
    let [rp, rq, pq] = [p / scale - r / scale, q / scale - r / scale, q / scale - p / scale];
    let mut sides = [rp.norm(), rq.norm(), pq.norm()];
    sides.sort_by(f64::total_cmp);
    rp.cross(&rq).norm() / (sides[1] * sides[2])
}
