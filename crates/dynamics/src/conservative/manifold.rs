//! Large deflection: modes that bend the body, on a curved manifold.
//!
//! ```text
//! u = Ψ_ext ξ(q)        ξ = q + Σ_α a_α q^α        D = ∂ξ/∂q        M = DᵀD
//! V = ½ qᵀΛq + Σ_α V_α q^α
//! ```
//!
//! The extended shapes Ψ_ext are the modes q of the motion and, after them, shapes that only follow: what a large mode
//! draws in, twists or stretches. α are products of the large modes to the third order, of a large and a following one, and of
//! two following ones; in the energy V to the fifth order, with two following ones at most. a and V are constants of the mesh
//! (`modal::LargeShapes`, `fem_tet10::Expansion`).
//!
//! The equations of motion are in coordinates z that hold ξ without a sum in the time loop: the modes, and the products m.
//!
//! ```text
//! z = (q, m),   m_α = q^α        ξ = E z,   E = [1 a]
//! ∂z/∂q = [1; B],   B x = the products' rates at q̇ = x
//! ```
//!
//! B has two or three entries in a row. A matrix A of the extended shapes, EᵀAE of these coordinates, is made once. M, the
//! slopes of the manifold and the forces of V are polynomials of the large and following modes.

mod bent_shape;
pub(crate) mod in_joints;
mod monomials;

pub(crate) use bent_shape::BentShape;
pub(crate) use in_joints::{BentPlace, BentTerms};

use std::sync::Arc;

use faer::{Mat, MatRef};
use keys::{Hash, Key, Keyed};
use reduced_body::{LargeCoordinates, LargeProducts, ReducedBody};

use crate::conservative::manifold::monomials::{Energy, Monomials, Polynomials};
use crate::error::SetupError;
use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::lists::dot;
use crate::matrix::triangle::entry;

/// Most modes that may be large.
pub const MAX_LARGE: usize = 4;
/// Most modes that may follow them.
pub const MAX_FOLLOWING: usize = 7;

/// Most large and following modes.
const MAX_BENT: usize = MAX_LARGE + MAX_FOLLOWING;

/// Coordinates of the large modes, then of those that follow, then a one: each product has three of these as factors.
type Bent = [f64; MAX_BENT + 1];

/// The manifold that a body with large modes moves on.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
#[serde(into = "Parts", try_from = "Parts")]
pub struct Manifold(Arc<Constants>);

#[derive(Debug)]
struct Constants {
    /// The body in the extended shapes.
    body: ReducedBody,
    /// By what it was made of.
    hash: Hash,
    coefficients: Mat<f64>,
    energies: Vec<f64>,
    /// Number of modes of the motion.
    modes: usize,
    /// The large ones among them, and those that follow.
    large: Vec<usize>,
    following: Vec<usize>,
    /// All of these.
    bent: Vec<usize>,
    /// Factors of each product, numbered among them; a one where there are two.
    factors: Vec<[usize; 3]>,
    monomials: Monomials,
    /// a, column by column (extended shapes × products), and ready for products with it and with its transpose.
    shapes: Vec<f64>,
    to_shapes: BlockedMatrix,
    from_shapes: BlockedMatrix,
    /// E (extended shapes × (modes + products)).
    shapes_by_coordinates: Mat<f64>,
    /// aᵀE (products × (modes + products)): rows of the mass of the products in z; and the same columns, by −.
    mass: BlockedMatrix,
    negative_mass: BlockedMatrix,
    /// ∂ξ/∂q beside 1 of the other modes by the bent ones: modes within bent ones.
    slopes: Polynomials,
    /// M − 1 of the bent modes without what the other modes have of it: entries i ≥ j.
    locked: Polynomials,
    /// V beyond ½ qᵀΛq, and its derivatives.
    energy: Energy,
    forces: Polynomials,
    /// Its second derivatives: entries i ≥ j of the bent modes.
    stiffness: Polynomials,
}

/// The parts of a manifold, as serde has it.
#[derive(serde::Serialize, serde::Deserialize)]
struct Parts {
    body: ReducedBody,
    dynamic: usize,
    large: Vec<usize>,
    following: Vec<usize>,
    #[serde(with = "reduced_body::as_data")]
    coefficients: Mat<f64>,
    energies: Vec<f64>,
}

impl From<Manifold> for Parts {
    fn from(Manifold(of): Manifold) -> Self {
        Self {
            body: of.body.clone(),
            dynamic: of.modes,
            large: of.large.clone(),
            following: of.following.clone(),
            coefficients: of.coefficients.clone(),
            energies: of.energies.clone(),
        }
    }
}

impl TryFrom<Parts> for Manifold {
    type Error = SetupError;

    fn try_from(parts: Parts) -> Result<Self, SetupError> {
        Self::of_parts(parts)
    }
}

/// The place on the manifold.
#[derive(Debug, Clone, Default)]
pub(crate) struct ManifoldPoint {
    /// The bent ones of q, and a one; of q̇, and zero.
    displacement: Bent,
    rate: Bent,
    monomials: Vec<f64>,
    /// B by its entries: the derivative of each product by each factor; and its rate.
    partials: Vec<[f64; 3]>,
    partial_rates: Vec<[f64; 3]>,
    /// Slopes of the other modes: modes within bent ones.
    slopes: Vec<f64>,
    /// Cholesky factor of what M leaves to the bent modes: entries i ≥ j, row by row, with the reciprocals of the diagonal.
    factor: Vec<f64>,
}

impl Manifold {
    /// By the coordinates, the body in the extended shapes, and the strain `energies` of [`LargeProducts::of_energy`].
    ///
    /// # Errors
    /// [`SetupError`] for more modes than [`MAX_LARGE`] and [`MAX_FOLLOWING`], sizes that do not fit together, and numbers that
    /// are not finite.
    pub fn new(body: ReducedBody, coordinates: LargeCoordinates, energies: &[f64]) -> Result<Self, SetupError> {
        let (expected, found) = (coordinates.coefficients.nrows(), body.flexible());
        if found != expected {
            return Err(SetupError::Length { what: "the body in the extended shapes", expected, found });
        }
        let LargeCoordinates { dynamic, large, following, coefficients } = coordinates;
        Self::of_parts(Parts { body, dynamic, large, following, coefficients, energies: energies.to_vec() })
    }

    fn of_parts(parts: Parts) -> Result<Self, SetupError> {
        let Parts { body, dynamic, large, following, coefficients, energies } = &parts;
        let (dynamic, extended) = (*dynamic, body.flexible());
        let key = Key::new().of("manifold", 2).with("body", body).with("modes", &dynamic).with("large", large);
        let key = key.with("following", following).with("coefficients", coefficients).with("energies", energies);
        let products = LargeProducts { large: large.len(), following: following.len() };
        let of_energy = products.of_energy();
        for (what, found, least, most, expected) in [
            ("the number of large modes", large.len(), 1, MAX_LARGE, "1 to 4"),
            ("the number of modes that follow large ones", following.len(), 0, MAX_FOLLOWING, "7 at most"),
        ] {
            if found < least || found > most {
                return Err(SetupError::Value { what, found: found as f64, expected });
            }
        }
        let of_displacement = products.of_displacement();
        for (what, found, expected) in [
            ("the list of strain energies", energies.len(), of_energy.len()),
            ("the rows of the shapes of products", coefficients.nrows(), extended),
            ("the shapes of products", coefficients.ncols(), of_displacement.len()),
        ] {
            if found != expected {
                return Err(SetupError::Length { what, expected, found });
            }
        }
        if let Some(mode) = large.iter().chain(following).find(|mode| **mode >= dynamic.min(extended)) {
            let what = "the number of a mode that bends";
            return Err(SetupError::Value { what, found: *mode as f64, expected: "that of a mode, from 0" });
        }
        if let Some(found) = energies.iter().copied().find(|energy| !energy.is_finite()) {
            return Err(SetupError::Value { what: "a strain energy", found, expected: "a finite number" });
        }
        let monomials = Monomials::new(products);
        let bent: Vec<usize> = large.iter().chain(following).copied().collect();
        let one = bent.len();
        let factors = of_displacement.iter().map(|product| [0, 1, 2].map(|i| product.get(i).copied().unwrap_or(one)));
        let count = of_displacement.len();
        let shapes_by_coordinates = Mat::from_fn(extended, dynamic + count, |i, a| match a.checked_sub(dynamic) {
            None => f64::from(u8::from(i == a)),
            Some(product) => coefficients[(i, product)],
        });
        let mass = coefficients.transpose() * &shapes_by_coordinates;
        let slopes = Polynomials::new(&monomials, bent.len() * dynamic, [1, 2], |add| {
            for (product, column) in of_displacement.iter().zip(coefficients.col_iter()) {
                for a in 0..bent.len() {
                    let Some((times, rest)) = Monomials::derivative(product, a) else { continue };
                    for k in (0..dynamic).filter(|k| !bent.contains(k)) {
                        add(a * dynamic + k, &rest, times * column[k]);
                    }
                }
            }
        });
        let energy = Energy::new(&monomials, &of_energy, energies);
        Ok(Self(Arc::new(Constants {
            hash: key.finish(),
            modes: dynamic,
            large: large.clone(),
            following: following.clone(),
            factors: factors.collect(),
            shapes: coefficients.col_iter().flat_map(|column| column.iter().copied()).collect(),
            to_shapes: BlockedMatrix::new(coefficients.as_ref()),
            from_shapes: BlockedMatrix::new(coefficients.transpose()),
            negative_mass: BlockedMatrix::new((-mass.transpose()).as_ref()),
            mass: BlockedMatrix::new(mass.as_ref()),
            slopes,
            locked: locked_mass(&monomials, &of_displacement, coefficients.as_ref(), &bent, dynamic),
            forces: energy.forces(&monomials),
            stiffness: energy.stiffness(&monomials),
            energy,
            shapes_by_coordinates,
            monomials,
            bent,
            body: body.clone(),
            energies: energies.clone(),
            coefficients: coefficients.clone(),
        })))
    }

    /// The body in the extended shapes.
    pub fn body(&self) -> &ReducedBody {
        &self.0.body
    }

    /// Number of modes of the motion.
    pub fn modes(&self) -> usize {
        self.0.modes
    }

    /// Which modes are large, numbered from 0.
    pub fn large(&self) -> &[usize] {
        &self.0.large
    }

    /// Which modes follow the large ones, numbered from 0.
    pub fn following(&self) -> &[usize] {
        &self.0.following
    }

    /// The large modes, then those that follow.
    pub fn bent(&self) -> &[usize] {
        &self.0.bent
    }

    /// The products of the modes that are in the displacement, each by the numbers of its two or three modes.
    pub fn products(&self) -> Vec<Vec<usize>> {
        let Constants { large, following, bent, .. } = &*self.0;
        let products = LargeProducts { large: large.len(), following: following.len() };
        let of_modes = |product: Vec<usize>| product.into_iter().map(|k| bent[k]).collect();
        products.of_displacement().into_iter().map(of_modes).collect()
    }

    /// ξ of a unit of each of the [`products`](Self::products), product by product.
    pub fn of_products(&self) -> &[f64] {
        &self.0.shapes
    }

    /// ξ(q) in the extended shapes, as many as the body has.
    pub fn coordinates(&self, q: &[f64], xi: &mut [f64]) {
        let Constants { bent, factors, modes, shapes, .. } = &*self.0;
        xi[..*modes].copy_from_slice(q);
        xi[*modes..].fill(0.0);
        let mut x = Bent::default();
        bent_of(bent, q, 1.0, &mut x);
        for (factors, shape) in factors.iter().zip(shapes.chunks_exact(xi.len().max(1))) {
            let product = value(factors, &x);
            xi.iter_mut().zip(shape).for_each(|(xi, shape)| *xi += shape * product);
        }
    }

    /// Number of coordinates z.
    pub(crate) fn size(&self) -> usize {
        self.0.modes + self.0.factors.len()
    }

    /// E, by which ξ = E z.
    pub(crate) fn shapes_by_coordinates(&self) -> &Mat<f64> {
        &self.0.shapes_by_coordinates
    }

    pub(crate) fn place(&self) -> ManifoldPoint {
        let Constants { bent, modes, factors, monomials, .. } = &*self.0;
        ManifoldPoint {
            monomials: vec![0.0; monomials.count(4)],
            partials: vec![[0.0; 3]; factors.len()],
            partial_rates: vec![[0.0; 3]; factors.len()],
            slopes: vec![0.0; bent.len() * modes],
            factor: vec![0.0; bent.len() * (bent.len() + 1) / 2],
            ..ManifoldPoint::default()
        }
    }

    /// Goes to q: z there, and M.
    pub(crate) fn go(&self, q: &[f64], place: &mut ManifoldPoint, z: &mut [f64]) {
        self.go_to(q, place, z);
        let Constants { bent, monomials, slopes, locked, .. } = &*self.0;
        let ManifoldPoint { displacement: x, monomials: values, slopes: at_q, factor, .. } = place;
        monomials.find(x, values);
        slopes.find(values, at_q);
        // Of M, the other modes leave to the bent ones what is here.
        locked.find(values, factor);
        factorize(bent.len(), factor);
    }

    /// Goes to q: z and B there alone.
    pub(crate) fn go_to(&self, q: &[f64], place: &mut ManifoldPoint, z: &mut [f64]) {
        let Constants { bent, modes, factors, .. } = &*self.0;
        let ManifoldPoint { displacement: x, partials, .. } = place;
        bent_of(bent, q, 1.0, x);
        let (of_modes, products) = z.split_at_mut(*modes);
        of_modes.copy_from_slice(q);
        for ((product, partials), [i, j, k]) in products.iter_mut().zip(partials).zip(factors) {
            let (a, b, c) = (x[*i], x[*j], x[*k]);
            *partials = [b * c, a * c, a * b];
            *product = a * b * c;
        }
    }

    /// Goes along with q̇: ż.
    pub(crate) fn go_along(&self, rate: &[f64], place: &mut ManifoldPoint, z_rate: &mut [f64]) {
        let Constants { bent, modes, factors, .. } = &*self.0;
        let ManifoldPoint { displacement: x, rate: v, partials, partial_rates, .. } = place;
        bent_of(bent, rate, 0.0, v);
        let (of_modes, products) = z_rate.split_at_mut(*modes);
        of_modes.copy_from_slice(rate);
        let rows = products.iter_mut().zip(partials).zip(partial_rates);
        for (((product, [da, db, dc]), rates), [i, j, k]) in rows.zip(factors) {
            let ([a, b, c], [u, v, w]) = ([x[*i], x[*j], x[*k]], [v[*i], v[*j], v[*k]]);
            *rates = [v * c + b * w, u * c + a * w, u * b + a * v];
            *product = *da * u + *db * v + *dc * w;
        }
    }

    /// ∂z/∂q x of modal velocities or accelerations x.
    pub(crate) fn extend(&self, place: &ManifoldPoint, x: &[f64], out: &mut [f64]) {
        let Constants { bent, modes, factors, .. } = &*self.0;
        let (of_modes, products) = out.split_at_mut(*modes);
        of_modes.copy_from_slice(x);
        let mut of_bent = Bent::default();
        bent_of(bent, x, 0.0, &mut of_bent);
        for ((product, partials), factors) in products.iter_mut().zip(&place.partials).zip(factors) {
            *product = along(partials, factors, &of_bent);
        }
    }

    /// Adds what z̈ has without q̈ to out, one number for each coordinate z.
    pub(crate) fn add_curvature(&self, place: &ManifoldPoint, out: &mut [f64]) {
        let Constants { modes, factors, .. } = &*self.0;
        for ((out, rates), factors) in out[*modes..].iter_mut().zip(&place.partial_rates).zip(factors) {
            *out += along(rates, factors, &place.rate);
        }
    }

    /// ξ or its rates, of z or its rates.
    pub(crate) fn in_shapes(&self, z: &[f64], xi: &mut [f64]) {
        let (of_modes, products) = z.split_at(self.0.modes);
        let (xi_of_modes, following) = xi.split_at_mut(of_modes.len());
        xi_of_modes.copy_from_slice(of_modes);
        following.fill(0.0);
        self.0.to_shapes.add_product(products, xi);
    }

    /// Adds the forces on z of forces in the extended shapes.
    pub(crate) fn add_from_shapes(&self, force: &[f64], out: &mut [f64]) {
        let (of_modes, products) = out.split_at_mut(self.0.modes);
        of_modes.iter_mut().zip(force).for_each(|(out, f)| *out += f);
        self.0.from_shapes.add_product(force, products);
    }

    /// Adds Dᵀ y of forces or momenta y on z, on the modes.
    pub(crate) fn add_projection(&self, place: &ManifoldPoint, y: &[f64], out: &mut [f64]) {
        let (of_modes, products) = y.split_at(self.0.modes);
        out.iter_mut().zip(of_modes).for_each(|(out, y)| *out += y);
        self.add_products(&place.partials, products.iter().copied(), out);
    }

    /// Adds Ḋᵀ of momenta of the products.
    pub(crate) fn add_projected_rate(&self, place: &ManifoldPoint, momenta: &[f64], out: &mut [f64]) {
        self.add_products(&place.partial_rates, momenta.iter().copied(), out);
    }

    fn add_products(&self, partials: &[[f64; 3]], of_products: impl Iterator<Item = f64>, out: &mut [f64]) {
        let Constants { bent, factors, .. } = &*self.0;
        let mut sums = Bent::default();
        for ((partials, factors), y) in partials.iter().zip(factors).zip(of_products) {
            for (partial, factor) in partials.iter().zip(factors) {
                sums[*factor] += partial * y;
            }
        }
        for (mode, sum) in bent.iter().zip(sums) {
            out[*mode] += sum;
        }
    }

    /// The momenta of the products at these ż, without spin.
    pub(crate) fn momenta_of_products(&self, z_rate: &[f64], momenta: &mut [f64]) {
        self.0.mass.multiply(z_rate, momenta);
    }

    /// Subtracts the mass of z times z̈ that only the products have.
    pub(crate) fn subtract_mass_of_products(&self, acceleration: &[f64], out: &mut [f64]) {
        self.0.negative_mass.add_product(&acceleration[self.0.modes..], out);
    }

    /// M⁻¹ y in place (modes).
    pub(crate) fn solve(&self, place: &ManifoldPoint, y: &mut [f64]) {
        self.substitute_forward(place, y);
        self.substitute_back(place, y);
    }

    /// L⁻¹ y in place (modes), of the Cholesky factor M = L Lᵀ that has the bent modes last.
    pub(crate) fn substitute_forward(&self, place: &ManifoldPoint, y: &mut [f64]) {
        let Constants { bent, modes, .. } = &*self.0;
        let mut x = Bent::default();
        // The slopes are zero along the bent modes, so that these rows of y stay out of the sums.
        for (i, (mode, slopes)) in bent.iter().zip(place.slopes.chunks_exact(*modes)).enumerate() {
            let mut rest = y[*mode] - dot(slopes, y);
            for (k, x) in x.iter().enumerate().take(i) {
                rest -= place.factor[entry(i, k)] * x;
            }
            x[i] = rest * place.factor[entry(i, i)];
        }
        bent.iter().zip(x).for_each(|(mode, x)| y[*mode] = x);
    }

    /// L⁻ᵀ y in place.
    pub(crate) fn substitute_back(&self, place: &ManifoldPoint, y: &mut [f64]) {
        let Constants { bent, modes, .. } = &*self.0;
        let mut x = Bent::default();
        for i in (0..bent.len()).rev() {
            let mut rest = y[bent[i]];
            for (k, x) in x.iter().enumerate().take(bent.len()).skip(i + 1) {
                rest -= place.factor[entry(k, i)] * x;
            }
            x[i] = rest * place.factor[entry(i, i)];
        }
        for (slopes, x) in place.slopes.chunks_exact(*modes).zip(x) {
            y.iter_mut().zip(slopes).for_each(|(y, slope)| *y -= slope * x);
        }
        bent.iter().zip(x).for_each(|(mode, x)| y[*mode] = x);
    }

    /// Subtracts the derivatives of V beyond ½ qᵀΛq from modal forces.
    pub(crate) fn subtract_force(&self, place: &ManifoldPoint, force: &mut [f64]) {
        let Constants { bent, forces, .. } = &*self.0;
        let mut of_bent = Bent::default();
        forces.find(&place.monomials, &mut of_bent[..bent.len()]);
        bent.iter().zip(of_bent).for_each(|(mode, of_bent)| force[*mode] -= of_bent);
    }

    /// The strain energy beyond ½ qᵀΛq.
    pub fn energy(&self, q: &[f64]) -> f64 {
        self.energy_by_degree(q).iter().sum()
    }

    /// Its parts of the third, fourth and fifth degree.
    pub fn energy_by_degree(&self, q: &[f64]) -> [f64; 3] {
        let mut x = Bent::default();
        bent_of(&self.0.bent, q, 1.0, &mut x);
        self.0.energy.by_degree(&x)
    }
}

/// M − 1 of the bent modes without what the other modes have of it, entries i ≥ j: of the derivatives of ξ along the bent modes
/// and along the shapes that only follow.
fn locked_mass(
    monomials: &Monomials,
    products: &[Vec<usize>],
    coefficients: MatRef<'_, f64>,
    bent: &[usize],
    dynamic: usize,
) -> Polynomials {
    let count = bent.len();
    let rows: Vec<usize> = bent.iter().copied().chain(dynamic..coefficients.nrows()).collect();
    let both = |p: usize, q: usize| rows.iter().map(|k| coefficients[(*k, p)] * coefficients[(*k, q)]).sum::<f64>();
    Polynomials::new(monomials, count * (count + 1) / 2, [1, 4], |add| {
        for (p, first) in products.iter().enumerate() {
            for a in 0..count {
                let Some((times, rest)) = Monomials::derivative(first, a) else { continue };
                // Both orders of an entry off the diagonal are one; on it they count twice.
                for (b, mode) in bent.iter().enumerate() {
                    let twice = if a == b { 2.0 } else { 1.0 };
                    add(entry(a.max(b), a.min(b)), &rest, twice * times * coefficients[(*mode, p)]);
                }
                for (q, second) in products.iter().enumerate() {
                    for b in 0..=a {
                        let Some((other_times, other)) = Monomials::derivative(second, b) else { continue };
                        let mut product = [&rest[..], &other[..]].concat();
                        product.sort_unstable();
                        add(entry(a, b), &product, times * other_times * both(p, q));
                    }
                }
            }
        }
    })
}

/// A product of three factors.
fn value([i, j, k]: &[usize; 3], x: &Bent) -> f64 {
    x[*i] * x[*j] * x[*k]
}

/// A row of B, or of its rate, times x.
fn along(partials: &[f64; 3], factors: &[usize; 3], x: &Bent) -> f64 {
    partials[0] * x[factors[0]] + partials[1] * x[factors[1]] + partials[2] * x[factors[2]]
}

/// Turns the entries i ≥ j of M − 1 into those of the Cholesky factor of M, with the reciprocals of the diagonal.
fn factorize(count: usize, factor: &mut [f64]) {
    for i in 0..count {
        for j in 0..=i {
            let mut sum = f64::from(u8::from(i == j)) + factor[entry(i, j)];
            for k in 0..j {
                sum -= factor[entry(i, k)] * factor[entry(j, k)];
            }
            factor[entry(i, j)] = if i == j { sum.sqrt().recip() } else { sum * factor[entry(j, j)] };
        }
    }
}

/// The bent ones of q, then the number that stands for a missing factor.
fn bent_of(bent: &[usize], q: &[f64], last: f64, x: &mut Bent) {
    x.iter_mut().zip(bent).for_each(|(x, k)| *x = q[*k]);
    x[bent.len()] = last;
}

impl Keyed for Manifold {
    fn key(&self, key: Key) -> Key {
        self.0.hash.key(key)
    }
}
