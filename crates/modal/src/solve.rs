//! From (K, M) and the nodes to vibration modes, checked.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

use faer::sparse::SparseColMatRef;
use faer::{ColRef, Mat};

use crate::eigen::engine::{Engine, EngineStats};
use crate::eigen::lanczos::{BLOCK, FIXED, LanczosPairs, largest_pairs, room};
use crate::eigen::polynomials::Polynomials;
use crate::eigen::ritz::{RitzPairs, rayleigh_ritz};
use crate::eigen::start;
use crate::error::ModalError;
use crate::factor::shifted::{Ordered, Shifted};
use crate::input::{check_edge_ends, check_finite_positions, check_matrix, check_rows};
use crate::matrix::columns::Columns;
use crate::matrix::mass_matrix::{MassMatrix, Turning, dofs};
use crate::matrix::stiffness::{NodalStiffness, StiffnessMatrix};
use crate::matrix::symmetry::check_symmetric;
use crate::memory_estimate::MemoryEstimate;
use crate::multigrid::{CycledBody, Cycles, NoCycles, are_faster};
use crate::progress::Progress;
use crate::statics::answered::StaticAnswer;
use crate::support::constraints::Constraints;
use crate::support::held::Support;
use crate::support::held_problem::HeldProblem;
use crate::support::rigid::RigidModes;

/// An eigenvalue below this fraction of the shift has no stiffness behind it.
const ZERO_ENERGY: f64 = 1e-9;

/// Largest ε |φ|ᵀ|K||φ| of the lowest mode relative to its eigenvalue. Rounding in the entries of K changes an eigenvalue
/// by less than a tenth of this. At 2.2 an error of the lowest frequency of 6 % has been seen; where it is all rounding,
/// 6 and more.
const ROUNDING: f64 = 3.0;

/// Largest ε |φ|ᵀ|M||φ| of the lowest mode: frequencies err by as much. Where the many nodes of a spread point mass of 1e9 times
/// the rest move against each other it is 1e-7 to 4e-6, and above 1e-4 it hides the frequencies.
const MASS_ROUNDING: f64 = 1e-5;

/// Rigid and flexible modes of a body. All shapes are M-orthonormal together.
#[derive(Debug, Clone)]
pub struct Modes {
    /// The rigid modes that the support leaves, and the mass properties.
    pub rigid: RigidModes,
    /// λ of the flexible modes, (rad/time)², smallest first; then those of static shapes, if any.
    pub eigenvalues: Vec<f64>,
    /// Flexible mode shapes (N×nf), mass-normalised, the component of largest magnitude positive; then static shapes,
    /// which are K-orthogonal and M-orthonormal to the modes and to each other.
    pub shapes: Mat<f64>,
    /// ‖(K + sM)⁻¹Mφ − μφ‖_M / μ for each natural mode, in the scale of the shifted problem, where rounding is small; of modes
    /// by multigrid cycles B, √(rᵀBr/λ) with r = Kφ − λMφ, by the square of which λ errs; as an engine says them, of modes that
    /// it has found.
    pub residuals: Vec<f64>,
    /// ‖Kφ − λMφ‖ / ‖Kφ‖ for each natural mode, without the reactions of a support. Rounding in K leaves up to 1e-6 of
    /// this in the lowest modes of fine meshes.
    pub force_residuals: Vec<f64>,
    /// The static answer among the shapes ([`Modes::with_answer`]), if there is one.
    pub answer: Option<StaticAnswer>,
    /// Counts of the work, and its times.
    pub stats: SolveStats,
}

/// Counts and times of a solution.
#[derive(Debug, Clone, Copy, Default)]
pub struct SolveStats {
    /// The shift s, (rad/time)².
    pub shift: f64,
    /// Unknowns N.
    pub unknowns: usize,
    /// Entries of the factor of K + sM, or of that on the corners of the elements where `cycles` are not zero; zero where an
    /// engine had it.
    pub factor_entries: usize,
    /// Bytes that are held here at the most, from K and M to the reduced body, estimated from the sizes of all that is large and
    /// the number of threads; zero where the modes were known.
    pub peak_bytes: usize,
    /// Solutions with a block of vectors.
    pub block_solves: usize,
    /// Vectors in the basis of the search at the end.
    pub basis_size: usize,
    /// Blocks of multigrid cycles that found the modes without the factor of K + sM.
    pub cycles: usize,
    /// Rigid modes, the check of K, and the first guess.
    pub preparation_time: Duration,
    /// Ordering and symbolic factorisation.
    pub ordering_time: Duration,
    /// Numeric factorisation.
    pub factor_time: Duration,
    /// The search for modes.
    pub lanczos_time: Duration,
    /// Rayleigh–Ritz, residuals and signs.
    pub ritz_time: Duration,
    /// Work of the engine that found the modes; `None` if they were found here.
    pub engine: Option<EngineStats>,
}

impl Modes {
    /// Number of natural modes, or of the combinations in their places; what follows them are static shapes.
    pub fn natural(&self) -> usize {
        self.answer.as_ref().map_or(self.residuals.len(), |answer| answer.natural)
    }

    /// The first of them only.
    #[must_use]
    pub fn truncated(&self, flexible: usize) -> Self {
        let kept = flexible.min(self.eigenvalues.len());
        let first = |list: &[f64]| list.iter().copied().take(kept).collect();
        Self {
            rigid: self.rigid.clone(),
            eigenvalues: first(&self.eigenvalues),
            shapes: self.shapes.get(.., ..kept).to_owned(),
            residuals: first(&self.residuals),
            force_residuals: first(&self.force_residuals),
            answer: self.answer.as_ref().and_then(|answer| answer.truncated(kept)),
            stats: self.stats,
        }
    }

    /// Frequencies of the flexible modes and static shapes, cycles per time.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        self.eigenvalues.iter().map(|lambda| lambda.sqrt() / std::f64::consts::TAU).collect()
    }
}

/// The inverse that modes and static responses come from.
#[derive(Clone, Copy)]
pub(crate) enum Inverse<'a> {
    /// The factor of K + sM.
    Factor(&'a Shifted),
    /// Multigrid cycles.
    Cycles(&'a Cycles),
}

/// Modes of a body, Eq. (M5) of `docs/method/modes.md`: the body, its support, and from the first question on the inverse that
/// modes and static responses come from: the factor of K + sM, or multigrid cycles.
pub struct Solver<'a> {
    pub(crate) stiffness: StiffnessMatrix<'a>,
    pub(crate) positions: &'a [[f64; 3]],
    pub(crate) mass: MassMatrix<'a>,
    /// Bytes of K and M, in all the forms that are there.
    pub(crate) matrix_bytes: usize,
    pub(crate) rigid: RigidModes,
    pub(crate) constraints: Constraints,
    factor: OnceLock<Shifted>,
    pub(crate) cycles: OnceLock<Cycles>,
    no_cycles: OnceLock<NoCycles>,
    shift: OnceLock<f64>,
    /// Polynomial fields that tell the shift, for matrices over nodes.
    polynomials: Option<Polynomials>,
    pub(crate) engine: Option<Box<dyn Engine>>,
    /// Nodes at the ends of the edge that each node is in the middle of, for second-order elements.
    pub(crate) edge_ends: Option<Vec<[u32; 2]>>,
    preparation_time: Duration,
}

impl<'a> Solver<'a> {
    /// Checks the matrices and the support.
    ///
    /// `stiffness` and `mass` are N×N, symmetric with both triangles stored, of the body without its supports; `positions`
    /// are the n nodes. N is 3n or 6n: each node has its translations along x, y and z, then its rotations about them if
    /// there are six, small angles as a vector: degree of freedom `3·node + axis`, or `6·node + axis` and
    /// `6·node + 3 + axis`. K and M are checked: their symmetry, that K resists none of the rigid motions left, that
    /// neither gives a motion a negative energy.
    ///
    /// # Errors
    /// See [`ModalError`].
    pub fn new(
        stiffness: SparseColMatRef<'a, usize, f64>,
        mass: SparseColMatRef<'a, usize, f64>,
        positions: &'a [[f64; 3]],
        support: &Support,
    ) -> Result<Self, ModalError> {
        let started = Instant::now();
        let dofs = dofs("stiffness", stiffness.ncols(), positions.len())?;
        check_matrix("stiffness", stiffness, dofs * positions.len())?;
        check_finite_positions(positions)?;
        let (rows, values) = (stiffness.symbolic().row_idx(), stiffness.val());
        check_symmetric("stiffness", 1, stiffness.symbolic().col_ptr(), |entry| rows[entry], |entry| values[entry])?;
        let stiffness = StiffnessMatrix::General(stiffness);
        let given = mass;
        let mass = MassMatrix::of_dofs(mass, positions.len(), dofs)?;
        let of_given = match &mass {
            MassMatrix::Nodal(_) => 16 * given.row_idx().len() + 8 * given.ncols(),
            MassMatrix::General(_) => 0,
        };
        Self::of_checked(started, stiffness, mass, of_given, positions, support)
    }

    /// The same of matrices over pairs of nodes, which take a fraction of the memory: `K` of 3×3 blocks, `M = M_s ⊗ I₃`, or this with points
    /// that move with nodes.
    ///
    /// # Errors
    /// See [`ModalError`].
    pub fn of_nodes(
        stiffness: NodalStiffness<'a>,
        mass: impl Into<MassMatrix<'a>>,
        positions: &'a [[f64; 3]],
        support: &Support,
    ) -> Result<Self, ModalError> {
        let started = Instant::now();
        let (stiffness, mass) = (StiffnessMatrix::Nodal(stiffness), mass.into());
        check_rows("stiffness", stiffness.ncols(), 3 * positions.len())?;
        check_rows("mass", mass.ncols(), 3 * positions.len())?;
        check_finite_positions(positions)?;
        Self::of_checked(started, stiffness, mass, 0, positions, support)
    }

    /// The solver of matrices of the right sizes, a general K checked; `of_given` bytes are kept of them besides.
    fn of_checked(
        started: Instant,
        stiffness: StiffnessMatrix<'a>,
        mass: MassMatrix<'a>,
        kept: usize,
        positions: &'a [[f64; 3]],
        support: &Support,
    ) -> Result<Self, ModalError> {
        // A scalar mass is refused by the Gram matrices of the search, and points add to it.
        if let Turning::Anisotropic(mass) = mass.turning() {
            mass.check_semidefinite()?;
        }
        let constraints = Constraints::new(support, positions, mass.dofs())?;
        let rigid = RigidModes::new(&mass, positions, support.motion)?;
        let polynomials = match (&stiffness, &mass, rigid.fields()) {
            (StiffnessMatrix::Nodal(k), MassMatrix::Nodal(m), Some(fields)) => {
                Some(Polynomials::new(k, m, positions, &rigid.center_of_mass, &fields))
            }
            _ => None,
        };
        match (&polynomials, &stiffness) {
            (Some(found), _) if found.is_symmetric() => {}
            (_, StiffnessMatrix::Nodal(stiffness)) => stiffness.check()?,
            (_, StiffnessMatrix::General(_)) => {}
        }
        match &polynomials {
            Some(found) => rigid.refuse_resistance(found.resistance.iter().copied())?,
            None => rigid.check_free(stiffness)?,
        };
        check_loose(stiffness, &mass, &constraints)?;
        let matrix_bytes = stiffness.bytes() + mass.bytes() + kept;
        let preparation_time = started.elapsed();
        Ok(Self {
            stiffness,
            matrix_bytes,
            positions,
            mass,
            rigid,
            constraints,
            factor: OnceLock::new(),
            cycles: OnceLock::new(),
            no_cycles: OnceLock::new(),
            shift: OnceLock::new(),
            polynomials,
            engine: None,
            edge_ends: None,
            preparation_time,
        })
    }

    /// The same with an engine, which finds modes and static responses in the place of the factor of K + sM here.
    #[must_use]
    pub fn with_engine(self, engine: Box<dyn Engine>) -> Self {
        Self { engine: Some(engine), ..self }
    }

    /// The same of second-order elements: for each node the two nodes at the ends of the edge that it is in the middle of, and
    /// twice itself for a corner. Modes and static responses of a body whose factor of K + sM takes long are then found without it,
    /// where that is faster.
    ///
    /// # Errors
    /// [`ModalError::Length`], [`ModalError::NoNode`], [`ModalError::NoCorner`].
    pub fn with_edge_ends(self, edge_ends: Vec<[u32; 2]>) -> Result<Self, ModalError> {
        check_edge_ends(&edge_ends, self.positions.len())?;
        Ok(Self { edge_ends: Some(edge_ends), ..self })
    }

    /// The mass matrix.
    pub fn mass(&self) -> &MassMatrix<'a> {
        &self.mass
    }

    /// The rigid modes that the support leaves, and the mass properties.
    pub fn rigid(&self) -> &RigidModes {
        &self.rigid
    }

    /// The rigid and the `flexible` lowest other modes of `K φ = λ M φ`. `progress` hears how far it has come.
    ///
    /// # Errors
    /// See [`ModalError`].
    pub fn modes(&self, flexible: usize, mut progress: impl FnMut(Progress)) -> Result<Modes, ModalError> {
        let available = self.available();
        if flexible > available {
            return Err(ModalError::TooManyModes { requested: flexible, available });
        }
        let unknowns = self.stiffness.ncols();
        if flexible == 0 {
            let none = Vec::new;
            return Ok(Modes {
                rigid: self.rigid.clone(),
                eigenvalues: none(),
                shapes: Mat::zeros(unknowns, 0),
                residuals: none(),
                force_residuals: none(),
                answer: None,
                stats: SolveStats {
                    unknowns,
                    peak_bytes: self.memory_estimate().peak(0),
                    preparation_time: self.preparation_time,
                    ..SolveStats::default()
                },
            });
        }
        if let Some(engine) = &self.engine {
            return self.modes_by(engine.as_ref(), flexible, &mut progress);
        }
        let basis = FIXED + room(flexible, available);
        let search = |memory: &MemoryEstimate| memory.of_search(basis, BLOCK, flexible);
        let mut tried = Duration::ZERO;
        let factor = match self.made() {
            Some(Inverse::Factor(factor)) => factor,
            Some(Inverse::Cycles(cycles)) => {
                let started = Instant::now();
                if let Some(modes) = self.modes_by_cycles(cycles, flexible, Duration::ZERO, &mut progress)? {
                    return Ok(modes);
                }
                tried = started.elapsed();
                self.factor(search, &mut progress)?
            }
            None => {
                let (ordered, estimate_time) = self.ordered(&mut progress)?;
                let started = Instant::now();
                if let Some(cycles) = self.cycles_for(flexible, &ordered, &mut progress)?
                    && let Some(modes) = self.modes_by_cycles(&cycles, flexible, ordered.time(), &mut progress)?
                {
                    self.cycles.get_or_init(|| cycles);
                    return Ok(modes);
                }
                tried = started.elapsed();
                self.factor_of(ordered, estimate_time, search, &mut progress)?
            }
        };
        let mut stats = SolveStats {
            shift: factor.shift,
            unknowns,
            factor_entries: factor.entries(),
            ordering_time: factor.ordering_time,
            factor_time: factor.factor_time,
            ..SolveStats::default()
        };
        let started = Instant::now();
        let rigid = self.rigid.shapes.as_ref();
        let pairs = largest_pairs(factor, &self.mass, rigid, flexible, available, |converged| {
            progress(Progress::Lanczos { converged, requested: flexible });
        })?;
        stats.preparation_time = self.preparation_time + factor.estimate_time;
        stats.block_solves = pairs.block_solves;
        stats.basis_size = pairs.basis_size;
        stats.peak_bytes = factor.memory.peak(factor.memory.of_search(FIXED + pairs.basis_size, BLOCK, flexible));
        stats.lanczos_time = tried + started.elapsed();

        self.ritz(pairs.vectors, pairs.residuals, stats)
    }

    /// The modes by cycles; none where these do not find them.
    fn modes_by_cycles(
        &self,
        cycles: &Cycles,
        flexible: usize,
        ordering_time: Duration,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<Modes>, ModalError> {
        let started = Instant::now();
        let pairs = cycles.lowest_pairs(self.rigid.shapes.as_ref(), flexible, |converged| {
            progress(Progress::Lanczos { converged, requested: flexible });
        });
        let LanczosPairs { vectors, residuals, block_solves, basis_size } = match pairs {
            Ok(pairs) => pairs,
            Err(reason) => {
                self.without_cycles(reason);
                return Ok(None);
            }
        };
        let factor = &cycles.factor;
        let stats = SolveStats {
            shift: factor.shift,
            unknowns: self.stiffness.ncols(),
            factor_entries: factor.entries(),
            peak_bytes: cycles.peak_bytes(flexible),
            block_solves,
            basis_size,
            cycles: block_solves,
            preparation_time: self.preparation_time,
            ordering_time: ordering_time + factor.ordering_time,
            factor_time: cycles.time,
            lanczos_time: started.elapsed(),
            ..SolveStats::default()
        };
        self.ritz(vectors, residuals, stats).map(Some)
    }

    /// The modes in the span of these vectors.
    fn ritz(&self, vectors: Mat<f64>, residuals: Vec<f64>, stats: SolveStats) -> Result<Modes, ModalError> {
        let started = Instant::now();
        let RitzPairs { eigenvalues, shapes, force_residuals } =
            rayleigh_ritz(self.stiffness, &self.mass, &self.constraints, vectors)?;
        self.refuse_soft(&eigenvalues, &shapes, stats.shift)?;
        let stats = SolveStats { ritz_time: started.elapsed(), ..stats };
        Ok(Modes { rigid: self.rigid.clone(), eigenvalues, shapes, residuals, force_residuals, answer: None, stats })
    }

    /// Cycles, should they be faster for `modes` modes than the factor of K + sM; none for bodies of which they cannot be made, too.
    fn cycles_for(
        &self,
        modes: usize,
        ordered: &Ordered<'_>,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Option<Cycles>, ModalError> {
        if !are_faster(ordered.multiplications(), self.stiffness.ncols(), modes) {
            return Ok(None);
        }
        let cycles = Cycles::new(&self.cycled_body()?, modes, |forecast| progress(Progress::Factorizing(forecast)));
        Ok(cycles.map_err(|reason| self.without_cycles(reason)).ok())
    }

    /// Parts of the cycles.
    pub(crate) fn cycled_body(&self) -> Result<CycledBody<'_>, ModalError> {
        Ok(CycledBody {
            stiffness: self.stiffness,
            mass: &self.mass,
            positions: self.positions,
            edge_ends: self.edge_ends.as_deref(),
            constraints: &self.constraints,
            shift: self.shift()?,
            matrix_bytes: self.matrix_bytes,
        })
    }

    /// Notes the reason that the factor is made in the place of cycles.
    pub(crate) fn without_cycles(&self, reason: NoCycles) {
        self.no_cycles.get_or_init(|| reason);
    }

    /// The reason that the factor of K + sM was made though it takes long; `None` where it does not, or where multigrid cycles
    /// took its place.
    pub fn no_cycles(&self) -> Option<&NoCycles> {
        self.no_cycles.get()
    }

    /// The inverse, as far as it is made: the factor where cycles were no help.
    fn made(&self) -> Option<Inverse<'_>> {
        let cycles = || self.cycles.get().map(Inverse::Cycles);
        self.factor.get().map(Inverse::Factor).or_else(cycles)
    }

    /// The inverse for static responses, made at the first call: beside `modes` modes, where there is memory for the
    /// `search` that follows.
    pub(crate) fn inverse(
        &self,
        modes: usize,
        search: impl Fn(&MemoryEstimate) -> usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Inverse<'_>, ModalError> {
        if let Some(made) = self.made() {
            return Ok(made);
        }
        let (ordered, estimate_time) = self.ordered(progress)?;
        if let Some(cycles) = self.cycles_for(modes, &ordered, progress)? {
            return Ok(Inverse::Cycles(self.cycles.get_or_init(|| cycles)));
        }
        Ok(Inverse::Factor(self.factor_of(ordered, estimate_time, search, progress)?))
    }

    /// The factor, of a body of any kind.
    pub(crate) fn factor(
        &self,
        search: impl Fn(&MemoryEstimate) -> usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<&Shifted, ModalError> {
        let (ordered, estimate_time) = self.ordered(progress)?;
        self.factor_of(ordered, estimate_time, search, progress)
    }

    /// K + sM with an order of its unknowns, and the time that it took to choose the shift.
    fn ordered(&self, progress: &mut dyn FnMut(Progress)) -> Result<(Ordered<'_>, Duration), ModalError> {
        progress(Progress::Ordering);
        let started = Instant::now();
        let shift = self.shift()?;
        let estimate_time = started.elapsed();
        let ordered = Ordered::new(self.stiffness, &self.mass, shift, &self.constraints, &self.memory_estimate())?;
        Ok((ordered, estimate_time))
    }

    /// The factor, where there is memory for the `search` that follows.
    fn factor_of(
        &self,
        ordered: Ordered<'_>,
        estimate_time: Duration,
        search: impl Fn(&MemoryEstimate) -> usize,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<&Shifted, ModalError> {
        let mut factor = Shifted::factor(ordered, &self.constraints, self.memory_estimate(), search, |forecast| {
            progress(Progress::Factorizing(forecast));
        })?;
        factor.estimate_time = estimate_time;
        Ok(self.factor.get_or_init(|| factor))
    }

    /// The shift s, estimated at the first call.
    pub(crate) fn shift(&self) -> Result<f64, ModalError> {
        if let Some(shift) = self.shift.get() {
            return Ok(*shift);
        }
        let shift = match &self.polynomials {
            Some(polynomials) => start::shift_of(polynomials, &self.rigid.motion)?,
            None => start::shift(self.stiffness, &self.mass, self.positions, &self.rigid)?,
        };
        Ok(*self.shift.get_or_init(|| shift))
    }

    /// K and M in the space of the displacements that the support allows.
    ///
    /// # Errors
    /// [`ModalError::DenseEigen`], [`ModalError::Memory`].
    pub fn held_problem(&self) -> Result<HeldProblem<'_>, ModalError> {
        let (shift, available) = (self.shift()?, self.available());
        HeldProblem::new(self.stiffness, &self.mass, &self.constraints, &self.rigid, shift, available)
    }

    /// How many blocks of columns, and columns, the factor was used for up to now: of K + sM, or of its corners in the cycles.
    pub fn solved(&self) -> [usize; 2] {
        match self.made() {
            Some(Inverse::Factor(factor) | Inverse::Cycles(Cycles { factor, .. })) => factor.solved(),
            None => [0; 2],
        }
    }

    /// Number of flexible modes that there are.
    pub fn available(&self) -> usize {
        let free = (0..self.stiffness.ncols())
            .filter(|row| self.mass.is_massive(*row) && !self.constraints.holds(*row))
            .count();
        (free + self.constraints.motion_count()).saturating_sub(self.rigid.motion.count())
    }

    /// Bytes that are held at the most where an engine finds `modes` modes.
    pub(crate) fn peak_beside_engine(&self, modes: usize) -> usize {
        self.memory_estimate().peak_beside_engine(modes)
    }

    /// The memory that the matrices take, and what follows from their sizes.
    pub(crate) fn memory_estimate(&self) -> MemoryEstimate {
        MemoryEstimate::new(self.stiffness, &self.mass, self.matrix_bytes, FIXED)
    }

    /// Time of the checks.
    pub(crate) fn preparation_time(&self) -> Duration {
        self.preparation_time
    }

    /// Refuses modes without stiffness, and a lowest mode that may be rounding.
    pub(crate) fn refuse_soft(&self, eigenvalues: &[f64], shapes: &Mat<f64>, shift: f64) -> Result<(), ModalError> {
        self.refuse_mechanism(eigenvalues, shapes, shift)?;
        self.refuse_hidden(eigenvalues[0], shapes.col(0))
    }

    fn refuse_mechanism(&self, eigenvalues: &[f64], shapes: &Mat<f64>, shift: f64) -> Result<(), ModalError> {
        let count = eigenvalues.iter().take_while(|lambda| **lambda < ZERO_ENERGY * shift).count();
        if count == 0 {
            return Ok(());
        }
        if eigenvalues[0] < -ROUNDING * self.stiffness.rounding(shapes.col(0)) {
            return Err(ModalError::NegativeStiffness { eigenvalue: eigenvalues[0], shift });
        }
        let (positions, rigid, dofs) = (self.positions, self.rigid.motion.count(), self.mass.dofs());
        let squared = |node: usize| (0..3).map(|axis| shapes[(dofs * node + axis, 0)].powi(2)).sum::<f64>();
        let node = (0..positions.len()).max_by(|a, b| squared(*a).total_cmp(&squared(*b))).unwrap_or(0);
        Err(ModalError::Mechanism { rigid, count, eigenvalue: eigenvalues[0], shift, node, position: positions[node] })
    }

    /// Refuses a lowest mode that may be little more than rounding in K, or whose mass is not known well for rounding in M.
    fn refuse_hidden(&self, eigenvalue: f64, shape: ColRef<'_, f64>) -> Result<(), ModalError> {
        let rounding = self.stiffness.rounding(shape);
        if rounding > ROUNDING * eigenvalue {
            return Err(ModalError::HiddenByRounding { eigenvalue, rounding, limit: ROUNDING * eigenvalue });
        }
        // The shape has the mass 1.
        let rounding = self.mass.rounding(shape);
        if rounding > MASS_ROUNDING {
            return Err(ModalError::MassHiddenByRounding { rounding, limit: MASS_ROUNDING });
        }
        Ok(())
    }
}

/// Refuses a free degree of freedom that has neither stiffness nor mass.
fn check_loose(
    stiffness: StiffnessMatrix<'_>,
    mass: &MassMatrix<'_>,
    constraints: &Constraints,
) -> Result<(), ModalError> {
    let MassMatrix::General(_) = mass else { return Ok(()) };
    let is_loose = |row: &usize| {
        let mut resists = false;
        stiffness.for_each_in_column(*row, |_, value| resists |= value != 0.0);
        !resists && !mass.is_massive(*row) && !constraints.holds(*row)
    };
    match (0..stiffness.ncols()).find(is_loose) {
        Some(row) => Err(ModalError::Loose { node: row / mass.dofs(), dof: row % mass.dofs() }),
        None => Ok(()),
    }
}
