//! Reports of commands, for people and for scripts.

use std::fmt::{self, Write};
use std::time::Duration;

use memory::Bytes;
use modal::EngineStats;
use model::{MatrixChecks, Meshed, Model};
use results::kind::{COMBINATION, NATURAL_MODE, STATIC_ANSWER, STATIC_SHAPE};
use serde::{Serialize, Serializer};

pub use ::report::{File, Form, Report, Table, Value, quantity};

/// The list `bodies`, and of a single one its keys.
pub(crate) fn list_of_bodies<B: Serialize, S: Serializer>(list: &[B], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Bodies<'a, B> {
        bodies: &'a [B],
        #[serde(flatten)]
        single: Option<&'a B>,
    }
    let single = list.first().filter(|_| list.len() == 1);
    Bodies { bodies: list, single }.serialize(serializer)
}

/// Times of the phases, seconds, in the order in which they were passed.
#[derive(Debug, Clone, Default)]
pub struct Times(Vec<(&'static str, f64)>);

impl Times {
    /// The phases of a model's making.
    pub fn of_model(model: &Model) -> Self {
        let build = &model.times;
        let mut times = Self::default();
        let Some(solve) = model.meshed.as_ref().map(|meshed| meshed.modes.stats) else { return times };
        times.add("mesh", build.mesh);
        times.add("assembly", build.assembly);
        times.add("rigid modes", solve.preparation_time);
        match solve.engine {
            Some(engine) => {
                times.add("MUMPS", engine.factor_time);
                times.add("SLEPc", engine.search_time);
                times.add("count", engine.count_time);
            }
            None => {
                times.add("ordering", solve.ordering_time);
                times.add("factor", solve.factor_time);
                times.add("Lanczos", solve.lanczos_time);
            }
        }
        times.add("Ritz", solve.ritz_time);
        if !build.statics.is_zero() {
            times.add("statics", build.statics);
        }
        times.add("reduction", build.reduction);
        times
    }

    /// Adds to a phase.
    pub fn add(&mut self, phase: &'static str, time: Duration) {
        self.add_seconds(phase, time.as_secs_f64());
    }

    /// Adds to all phases of others.
    pub fn add_all(&mut self, others: &Self) {
        others.0.iter().for_each(|(phase, seconds)| self.add_seconds(phase, *seconds));
    }

    fn add_seconds(&mut self, phase: &'static str, seconds: f64) {
        match self.0.iter_mut().find(|(known, _)| *known == phase) {
            Some((_, sum)) => *sum += seconds,
            None => self.0.push((phase, seconds)),
        }
    }

    /// Sum of all phases, seconds.
    pub fn total(&self) -> f64 {
        // The sum of none is -0.
        self.0.iter().fold(0.0, |sum, (_, seconds)| sum + seconds)
    }
}

/// An object: the seconds of each phase by its name.
impl Serialize for Times {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().copied())
    }
}

impl fmt::Display for Times {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = String::new();
        for (phase, seconds) in &self.0 {
            write!(line, "{phase} {seconds:.3}, ")?;
        }
        write!(f, "{line}together {:.2} s", self.total())
    }
}

/// A number to `digits` significant digits.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// Name and version of the program, as a page says them.
pub fn program() -> String {
    format!("flexframe {}", env!("CARGO_PKG_VERSION"))
}

/// Size of the finite-element model.
#[derive(Debug, Clone, Serialize)]
pub struct MeshReport {
    /// The mesh file.
    pub file: String,
    /// Nodes.
    pub nodes: usize,
    /// Elements.
    pub elements: usize,
    /// Degrees of freedom.
    pub unknowns: usize,
    /// Findings about the matrices of another program.
    pub matrices: Option<MatricesReport>,
    /// Extent along the axes of the mesh.
    pub size: [f64; 3],
    /// Bytes of the mass and stiffness matrices.
    pub matrix_bytes: usize,
    /// Entries of the factor of K + sM.
    pub factor_entries: usize,
    /// Bytes that the model takes while it is made, at the most at a time: matrices, factor, basis and scratch. None where its
    /// modes were known from before.
    pub peak_bytes: Option<usize>,
    /// Work of SLEPc, where it found the modes.
    pub engine: Option<EngineReport>,
}

/// Work of SLEPc.
#[derive(Debug, Clone, Serialize)]
pub struct EngineReport {
    /// Its version.
    pub slepc: String,
    /// Version of PETSc.
    pub petsc: String,
    /// Processes.
    pub ranks: usize,
    /// Megabytes that the largest factorisation took in all processes.
    pub megabytes: usize,
    /// Where the eigenvalues were counted, (rad/time)².
    pub below: f64,
    /// How many are below, with those of rigid motions.
    pub counted: usize,
}

/// Findings about the matrices of another program.
#[derive(Debug, Clone, Serialize)]
pub struct MatricesReport {
    /// Degrees of freedom of a node: 3, or 6 with its rotations.
    pub dofs: usize,
    /// Largest difference of the triangles, relative to the diagonal; none where the files have one triangle.
    pub asymmetry: Option<f64>,
    /// How much K resists a rigid motion, relative to its diagonal, at the most of the six.
    pub rigid_stiffness: f64,
    /// True if the mass is a scalar for each pair of nodes: then the large rotation leaves out nothing of it.
    pub is_scalar_mass: bool,
    /// The part of the mass that the large rotation leaves out, relative to the modal mass.
    pub left_out: f64,
}

/// Mass properties and modes.
#[derive(Debug, Clone, Serialize)]
pub struct BodyReport {
    /// Total mass.
    pub mass: f64,
    /// Centre of mass, mesh axes.
    pub center_of_mass: [f64; 3],
    /// Inertia about the centre of mass, body axes, row by row.
    pub inertia: [[f64; 3]; 3],
    /// Rigid motions that the body has: six of a free one.
    pub rigid_modes: usize,
    /// Natural frequencies of the flexible modes, cycles per time; after them those of static shapes, which are none.
    pub natural_frequencies: Vec<f64>,
    /// Kind of each of these: see [`results::kind`].
    pub kinds: Vec<&'static str>,
    /// Damping ratios.
    pub damping_ratios: Vec<f64>,
    /// Residual of each mode in the search for it, in the scale of the shifted problem.
    pub residuals: Vec<f64>,
    /// ‖Kφ − λMφ‖/‖Kφ‖ of each mode.
    pub force_residuals: Vec<f64>,
}

impl MeshReport {
    /// The report of a model; `None` for a rigid body without a mesh.
    pub fn new(model: &Model) -> Option<Self> {
        let Meshed { mesh, modes, matrix_bytes, checks, .. } = model.meshed.as_ref()?;
        Some(Self {
            file: mesh.source().to_owned(),
            nodes: mesh.positions().len(),
            elements: mesh.elements().len(),
            unknowns: checks.map_or(3, |checks| checks.dofs) * mesh.positions().len(),
            matrices: checks.map(MatricesReport::from),
            size: mesh.size(),
            matrix_bytes: *matrix_bytes,
            factor_entries: modes.stats.factor_entries,
            peak_bytes: Some(modes.stats.peak_bytes).filter(|bytes| *bytes > 0).map(with_kept),
            engine: modes.stats.engine.map(EngineReport::from),
        })
    }
}

impl From<EngineStats> for EngineReport {
    fn from(stats: EngineStats) -> Self {
        let EngineStats { slepc, petsc, ranks, megabytes, below, counted, .. } = stats;
        let [slepc, petsc] = [slepc, petsc].map(|version| version.map(|number| number.to_string()).join("."));
        Self { slepc, petsc, ranks, megabytes, below, counted }
    }
}

impl fmt::Display for EngineReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { slepc, petsc, ranks, megabytes, below, counted } = self;
        write!(
            f,
            "SLEPc {slepc} on PETSc {petsc} with MUMPS, {ranks} rank(s), {megabytes} MB in the largest factorization; "
        )?;
        write!(f, "none is missing: {counted} eigenvalues below {below:.4e} by a count, with those of rigid motions")
    }
}

impl From<MatrixChecks> for MatricesReport {
    fn from(checks: MatrixChecks) -> Self {
        let MatrixChecks { dofs, asymmetry, rigid_stiffness, is_scalar_mass, left_out } = checks;
        Self { dofs, asymmetry, rigid_stiffness, is_scalar_mass, left_out }
    }
}

impl MeshReport {
    /// "393 nodes, 40 elements", or "393 nodes, matrices of another program".
    pub(crate) fn in_words(&self) -> String {
        match self.matrices {
            None => format!("{} nodes, {} elements", self.nodes, self.elements),
            Some(_) => format!("{} nodes, matrices of another program", self.nodes),
        }
    }
}

impl fmt::Display for MatricesReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} degrees of freedom a node, ", self.dofs)?;
        match self.asymmetry {
            Some(asymmetry) => write!(f, "symmetric to {asymmetry:.0e}, ")?,
            None => write!(f, "symmetric as written, ")?,
        }
        write!(f, "no stiffness against the six rigid motions (to {:.0e}), mass positive; ", self.rigid_stiffness)?;
        if self.is_scalar_mass {
            write!(f, "the large rotation leaves out nothing of the mass")
        } else {
            write!(f, "the large rotation leaves out {:.1e} of the modal mass", self.left_out)
        }
    }
}

/// Size and mass, such as "1000 x 50 x 10 mm, 0.00935 Mg"; of a body without a mesh, its mass.
pub(crate) fn size_and_mass(mesh: Option<&MeshReport>, body: &BodyReport, length: &str, mass: &str) -> String {
    let size = mesh.map_or_else(String::new, |mesh| {
        let [x, y, z] = mesh.size.map(quantity);
        format!("{x} x {y} x {z} {length}, ")
    });
    format!("{size}{} {mass}", quantity(body.mass))
}

/// With what the allocator of the C library keeps of blocks that were given back. Measured on bodies of 21 000 to 189 000
/// unknowns: 10 to 27 MB where the search for modes takes the most memory, nothing where their reduction does.
fn with_kept(bytes: usize) -> usize {
    bytes + (bytes / 5).min(16 << 20)
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} unknowns (", self.in_words(), self.unknowns)?;
        if let Some(bytes) = self.peak_bytes {
            write!(f, "memory {}: ", Bytes(bytes))?;
        }
        write!(f, "matrices {}", Bytes(self.matrix_bytes))?;
        if self.factor_entries > 0 {
            write!(f, ", factor {}", Bytes(8 * self.factor_entries))?;
        }
        f.write_str(if self.peak_bytes.is_some() { " of it)" } else { ")" })
    }
}

impl BodyReport {
    /// How many there are and their frequencies, such as "10 flexible modes from 24.53 to 582.1 Hz and 4 static shapes"; of a
    /// rigid body, "rigid".
    pub fn modes_in_words(&self, frequency_unit: &str) -> String {
        let of_kinds = self.kinds.iter().zip(&self.natural_frequencies);
        let natural: Vec<f64> = of_kinds.filter(|(kind, _)| **kind == NATURAL_MODE).map(|(_, f)| *f).collect();
        let (Some(first), Some(last)) = (natural.first(), natural.last()) else { return "rigid".to_owned() };
        let modes = counted(natural.len(), ["flexible mode", "flexible modes"]);
        let others: String = others_in_words(self.kinds.iter().copied()).map(|words| format!(" and {words}")).collect();
        format!("{modes} from {first:.4} to {last:.4} {frequency_unit}{others}")
    }

    /// The report of a model.
    pub fn new(model: &Model) -> Self {
        let body = &model.body;
        let inertia = body.inertia_about_center();
        let modes = model.meshed.as_ref().map(|meshed| &meshed.modes);
        Self {
            mass: body.mass,
            center_of_mass: body.center_of_mass.into(),
            inertia: std::array::from_fn(|i| std::array::from_fn(|j| inertia[(i, j)])),
            rigid_modes: body.motion.count(),
            natural_frequencies: model.natural_frequencies(),
            kinds: kinds(model),
            damping_ratios: model.damping_ratios().to_vec(),
            residuals: modes.map_or_else(Vec::new, |modes| modes.residuals.clone()),
            force_residuals: modes.map_or_else(Vec::new, |modes| modes.force_residuals.clone()),
        }
    }
}

/// A count and its noun, such as "1 mode" or "3 modes".
pub(crate) fn counted(count: usize, [one, several]: [&str; 2]) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// How many coordinates there are of each kind beside natural modes, such as "4 static shapes".
pub(crate) fn others_in_words<'a>(kinds: impl Iterator<Item = &'a str> + Clone) -> impl Iterator<Item = String> {
    let names =
        [[STATIC_ANSWER, "static answers"], [COMBINATION, "combinations of modes"], [STATIC_SHAPE, "static shapes"]];
    names.into_iter().filter_map(move |names| {
        let count = kinds.clone().filter(|kind| *kind == names[0]).count();
        (count > 0).then(|| counted(count, names))
    })
}

/// Kind of each coordinate. Beside a static answer only the large modes are as they were.
pub(crate) fn kinds(model: &Model) -> Vec<&'static str> {
    let natural = model.body.flexible() - model.static_shapes();
    let kind = |k: usize| match model.static_answer() {
        Some(answer) if k == answer => STATIC_ANSWER,
        Some(_) if !model.large_modes().contains(&k) => COMBINATION,
        _ if k < natural => NATURAL_MODE,
        _ => STATIC_SHAPE,
    };
    (0..model.body.flexible()).map(kind).collect()
}

#[cfg(test)]
mod tests {
    use ::report::quantity;

    /// Closed form: numbers rounded by hand.
    #[test]
    fn quantities_have_seven_digits_and_no_rounding_dust() {
        assert_eq!(quantity(0.009349999999998967), "0.00935");
        assert_eq!(quantity(33.909140001), "33.90914");
        assert_eq!(quantity(-2112.7112499), "-2112.711");
        assert_eq!(quantity(1e-12), "1.000000e-12");
        assert_eq!(quantity(2.5e9), "2.500000e9");
        assert_eq!(quantity(0.0), "0");
        assert_eq!(quantity(1000.0), "1000");
    }
}
