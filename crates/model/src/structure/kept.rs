//! Modes, shapes and the reduced body as they are kept in files.

use faer::Mat;
use modal::{LargeShapes, Modes, RigidModes, SolveStats};
use nalgebra::{Matrix3, Vector3};
use reduced_body::{Constants, LargeCoordinates, LargeProducts, ReducedBody, RigidMotion};
use sealed::SealedError;

use crate::cache::kept::{Arrays, Keep, Kept};

/// Modes of a body, the body in them, and what else is known once its matrices are there.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub modes: Modes,
    pub body: ReducedBody,
    /// Forces of a unit acceleration of the whole body along each axis (N×3); or of elements, which have a scalar mass for each
    /// pair of nodes, one number for each node (n×1).
    pub weights: Mat<f64>,
    /// Number of flexible modes that there are.
    pub available: usize,
    /// Bytes of the mass and stiffness matrices.
    pub matrix_bytes: usize,
}

/// Rows of the shapes, number of the modes, the motion that the support leaves, and rows and columns of the weights.
impl Keep for Found {
    type Known<'k> = (usize, usize, RigidMotion, [usize; 2]);

    fn write(&self, to: &mut Arrays) {
        let Self { modes, body, weights, available, matrix_bytes } = self;
        // Modes that are found are not coupled.
        let Modes { rigid, eigenvalues, shapes, residuals, force_residuals, answer: _, stats } = modes;
        let SolveStats { shift, unknowns, factor_entries, block_solves, basis_size, .. } = *stats;
        to.list("mass", &[rigid.mass]);
        to.list("center_of_mass", rigid.center_of_mass.as_slice());
        to.list("origin", rigid.origin.as_slice());
        to.list("inertia", rigid.inertia.as_slice());
        to.list("translation_basis", rigid.translation_basis.as_slice());
        to.list("rotation_basis", rigid.rotation_basis.as_slice());
        to.matrix("rigid_shapes", rigid.shapes.as_ref());
        to.list("eigenvalues", eigenvalues);
        to.matrix("shapes", shapes.as_ref());
        to.list("residuals", residuals);
        to.list("force_residuals", force_residuals);
        to.list("shift", &[shift]);
        to.matrix("weights", weights.as_ref());
        let counts = [unknowns, factor_entries, block_solves, basis_size, *available, *matrix_bytes];
        to.list("counts", &counts.map(|count| count as f64));
        body.write(to);
    }

    fn read(from: &Kept<'_>, (rows, flexible, motion, weights): Self::Known<'_>) -> Result<Self, SealedError> {
        let vector = |name| Ok::<_, SealedError>(Vector3::from(from.array::<3>(name)?));
        let matrix = |name| Ok::<_, SealedError>(Matrix3::from_column_slice(&from.array::<9>(name)?));
        let list = |name| from.list(name, Some(flexible));
        let [unknowns, factor_entries, block_solves, basis_size, available, matrix_bytes] =
            from.array::<6>("counts")?.map(|count| count as usize);
        let rigid = RigidModes {
            motion,
            mass: from.array::<1>("mass")?[0],
            center_of_mass: vector("center_of_mass")?,
            origin: vector("origin")?,
            inertia: matrix("inertia")?,
            translation_basis: matrix("translation_basis")?,
            rotation_basis: matrix("rotation_basis")?,
            shapes: from.matrix("rigid_shapes", rows, Some(6))?,
        };
        // No time was spent on it, and no memory, which goes with the number of threads.
        let shift = from.array::<1>("shift")?[0];
        let stats = SolveStats { shift, unknowns, factor_entries, block_solves, basis_size, ..SolveStats::default() };
        let modes = Modes {
            rigid,
            eigenvalues: list("eigenvalues")?,
            shapes: from.matrix("shapes", rows, Some(flexible))?,
            residuals: list("residuals")?,
            force_residuals: list("force_residuals")?,
            answer: None,
            stats,
        };
        let weights = from.matrix("weights", weights[0], Some(weights[1]))?;
        Ok(Self { body: ReducedBody::read(from, &modes)?, modes, weights, available, matrix_bytes })
    }
}

/// The shapes after the first `before`.
fn write_added(modes: &Modes, before: usize, to: &mut Arrays) {
    to.list("eigenvalues", &modes.eigenvalues[before..]);
    to.matrix("shapes", modes.shapes.get(.., before..));
}

/// The first `before` shapes of `modes`, and those that are kept.
fn read_added(from: &Kept<'_>, modes: &Modes, before: usize) -> Result<Modes, SealedError> {
    let rows = modes.shapes.nrows();
    let eigenvalues = from.list("eigenvalues", None)?;
    let added = from.matrix("shapes", rows, Some(eigenvalues.len()))?;
    let mut shapes = Mat::zeros(rows, before + added.ncols());
    shapes.as_mut().subcols_mut(0, before).copy_from(modes.shapes.subcols(0, before));
    shapes.as_mut().subcols_mut(before, added.ncols()).copy_from(&added);
    let eigenvalues = modes.eigenvalues[..before].iter().copied().chain(eigenvalues).collect();
    let Modes { rigid, residuals, force_residuals, answer, stats, .. } = modes.clone();
    Ok(Modes { rigid, eigenvalues, shapes, residuals, force_residuals, answer, stats })
}

/// Static responses side by side (3n×k).
#[derive(Debug)]
pub(crate) struct StaticResponses {
    pub fields: Mat<f64>,
    /// Remainders beside the natural modes, √(uᵀMu − Σ(Φ_kᵀMu)²), of those to the centrifugal field (6) and to the drive; of each
    /// that is there.
    pub remainders: Vec<f64>,
}

/// Rows, columns, and the number of the remainders.
impl Keep for StaticResponses {
    type Known<'k> = [usize; 3];

    fn write(&self, to: &mut Arrays) {
        to.matrix("responses", self.fields.as_ref());
        to.list("remainders", &self.remainders);
    }

    fn read(from: &Kept<'_>, [rows, columns, remainders]: [usize; 3]) -> Result<Self, SealedError> {
        let fields = from.matrix("responses", rows, Some(columns))?;
        Ok(Self { fields, remainders: from.list("remainders", Some(remainders))? })
    }
}

/// Modes, other shapes after the natural ones, and the body in all of them.
#[derive(Debug)]
pub(crate) struct Basis {
    pub modes: Modes,
    pub body: ReducedBody,
}

/// By the natural modes.
impl Keep for Basis {
    type Known<'k> = &'k Modes;

    fn write(&self, to: &mut Arrays) {
        write_added(&self.modes, self.modes.natural(), to);
        self.body.write(to);
    }

    fn read(from: &Kept<'_>, natural: &Modes) -> Result<Self, SealedError> {
        let modes = read_added(from, natural, natural.natural())?;
        Ok(Self { body: ReducedBody::read(from, &modes)?, modes })
    }
}

/// Forces, energies and static responses of second order, of pairs of modes.
#[derive(Debug)]
pub(crate) struct SecondOrder {
    /// Forces of the pairs (3n×p).
    pub forces: Mat<f64>,
    /// The static responses to them (3n×p).
    pub responses: Mat<f64>,
    /// Energies of quadruples.
    pub energies: Vec<f64>,
}

/// Rows, pairs and quadruples.
impl Keep for SecondOrder {
    type Known<'k> = [usize; 3];

    fn write(&self, to: &mut Arrays) {
        to.matrix("forces", self.forces.as_ref());
        to.matrix("responses", self.responses.as_ref());
        to.list("energies", &self.energies);
    }

    fn read(from: &Kept<'_>, [rows, pairs, quadruples]: [usize; 3]) -> Result<Self, SealedError> {
        Ok(Self {
            forces: from.matrix("forces", rows, Some(pairs))?,
            responses: from.matrix("responses", rows, Some(pairs))?,
            energies: from.list("energies", Some(quadruples))?,
        })
    }
}

/// The second order of modes, each with itself.
#[derive(Debug)]
pub(crate) struct OwnSecondOrder {
    pub second: SecondOrder,
    /// φᵀMu of each mode and its response.
    pub along: Vec<f64>,
    /// uᵀMu of each response.
    pub inertia: Vec<f64>,
}

/// Rows, and number of the modes.
impl Keep for OwnSecondOrder {
    type Known<'k> = [usize; 2];

    fn write(&self, to: &mut Arrays) {
        self.second.write(to);
        to.list("along", &self.along);
        to.list("inertia", &self.inertia);
    }

    fn read(from: &Kept<'_>, [rows, modes]: [usize; 2]) -> Result<Self, SealedError> {
        let second = SecondOrder::read(from, [rows, modes, modes])?;
        Ok(Self { second, along: from.list("along", Some(modes))?, inertia: from.list("inertia", Some(modes))? })
    }
}

/// The shapes of large modes and of those that follow them, the body in the extended shapes, and the strain energies of
/// [`LargeProducts::of_energy`].
#[derive(Debug)]
pub(crate) struct Extended {
    pub shapes: LargeShapes,
    pub body: ReducedBody,
    pub energies: Vec<f64>,
}

/// By the modes, and the large and the following ones among them.
impl Keep for Extended {
    type Known<'k> = (&'k Modes, &'k [usize], &'k [usize]);

    fn write(&self, to: &mut Arrays) {
        let LargeShapes { modes, coordinates: LargeCoordinates { dynamic, coefficients, .. } } = &self.shapes;
        write_added(modes, *dynamic, to);
        to.matrix("coefficients", coefficients.as_ref());
        to.list("energies", &self.energies);
        self.body.write(to);
    }

    fn read(from: &Kept<'_>, (modes, large, following): Self::Known<'_>) -> Result<Self, SealedError> {
        let dynamic = modes.shapes.ncols();
        let products = LargeProducts { large: large.len(), following: following.len() };
        let modes = read_added(from, modes, dynamic)?;
        let body = ReducedBody::read(from, &modes)?;
        let coefficients = from.matrix("coefficients", modes.shapes.ncols(), Some(products.of_displacement().len()))?;
        let energies = from.list("energies", Some(products.of_energy().len()))?;
        let (large, following) = (large.to_vec(), following.to_vec());
        let shapes = LargeShapes { modes, coordinates: LargeCoordinates { dynamic, large, following, coefficients } };
        Ok(Self { shapes, body, energies })
    }
}

/// The constants that the mesh makes; the others are those of the modes, which are known.
impl Keep for ReducedBody {
    type Known<'k> = &'k Modes;

    fn write(&self, to: &mut Arrays) {
        to.matrices("rotation_products", self.rotation_products.iter().flatten());
        to.list("position_products", &self.position_products.as_flattened().concat());
        to.list("inertia_first", &self.inertia_first.concat());
        to.matrices("inertia_second", &self.inertia_second);
        to.matrices("gyroscopic", &self.gyroscopic);
        to.list("translation_first", &self.translation_first.concat());
        to.list("rotation_first", &self.rotation_first.concat());
    }

    fn read(from: &Kept<'_>, modes: &Modes) -> Result<Self, SealedError> {
        let rigid = &modes.rigid;
        let nf = modes.eigenvalues.len();
        let unfit = || from.damaged("its constants do not fit together".to_owned());
        let lists = |name: &str, count: usize, each: usize| -> Result<Vec<Vec<f64>>, SealedError> {
            let columns = from.matrix(name, each, Some(count))?;
            Ok(columns.col_iter().map(|column| column.iter().copied().collect()).collect())
        };
        let rotation_products = from.matrices("rotation_products", 9, 6 + nf)?;
        let position_products = lists("position_products", 9, 6 + nf)?;
        let constants = Constants {
            mass: rigid.mass,
            center_of_mass: rigid.center_of_mass,
            motion: rigid.motion,
            origin: rigid.origin,
            inertia: rigid.inertia,
            translation_basis: rigid.translation_basis,
            rotation_basis: rigid.rotation_basis,
            circular_frequencies: modes.eigenvalues.iter().map(|lambda| lambda.sqrt()).collect(),
            natural_modes: modes.natural(),
            rotation_products: std::array::from_fn(|a| std::array::from_fn(|b| rotation_products[3 * a + b].clone())),
            position_products: std::array::from_fn(|a| std::array::from_fn(|b| position_products[3 * a + b].clone())),
            inertia_first: lists("inertia_first", 6, nf)?.try_into().map_err(|_| unfit())?,
            inertia_second: from.matrices("inertia_second", 6, nf)?.try_into().map_err(|_| unfit())?,
            gyroscopic: from.matrices("gyroscopic", 3, nf)?.try_into().map_err(|_| unfit())?,
            translation_first: lists("translation_first", 3, nf)?.try_into().map_err(|_| unfit())?,
            rotation_first: lists("rotation_first", 3, nf)?.try_into().map_err(|_| unfit())?,
            stress_stiffness: None,
        };
        Self::from_constants(constants).map_err(|error| from.damaged(error.to_string()))
    }
}
