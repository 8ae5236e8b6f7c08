//! Large deflection: modes that bend the body, on a curved (quadratic) manifold.
//!
//! ```text
//! u = Ψ_ext ξ(q)        ξ_a = q_a + s_a,   s_a = ½ Σ_jk T_a,jk q_j q_k   (j, k of the large modes; zero for a among them)
//! D = ∂ξ/∂q = [I; 0] + T q        ν = D q̇        M = DᵀD
//! V = ½ qᵀΛq + V_n,   V_n = ⅙ Σ g_ijk q_i q_j q_k + ⅛ Σ w_ijkl q_i q_j q_k q_l
//! ```
//!
//! The extended shapes Ψ_ext are the modes q of the motion and, after them, shapes that only follow: what a large mode
//! draws in, twists or stretches. T, g and w are constants of the mesh ([`modal::SecondOrderShapes`]).
//!
//! The equations of motion are in coordinates z that hold ξ without a sum in the time loop: the modes, and the products m
//! of the large ones.
//!
//! ```text
//! z = (q, m),   m_jk = q_j q_k (j ≤ k)        ξ = E z,   E = [1 T'],   T'_jk = T_jk, and ½ T_jj of squares
//! ∂z/∂q = [1; B],   B x = the products' rates at q̇ = x
//! ```
//!
//! B has two entries in a row. A matrix A of the extended shapes, EᵀAE of these coordinates, is made once.

use std::sync::Arc;

use faer::{Mat, MatRef};
use keys::{Hash, Key, Keyed};
use modal::{ReducedBody, SecondOrderShapes};

use crate::error::SetupError;
use crate::matrix::blocked_matrix::BlockedMatrix;
use crate::matrix::column_major::{add_product, columns, dot};

/// Most modes that may be large.
pub const MAX_LARGE: usize = 8;

/// Most products of them.
const MAX_PAIRS: usize = MAX_LARGE * (MAX_LARGE + 1) / 2;

/// A call of a function for as many large modes as there are: their number is known to the compiler in it.
macro_rules! by_count {
    ($count:expr, $name:ident($($argument:expr),*)) => {
        match $count {
            1 => $name::<1>($($argument),*),
            2 => $name::<2>($($argument),*),
            3 => $name::<3>($($argument),*),
            4 => $name::<4>($($argument),*),
            5 => $name::<5>($($argument),*),
            6 => $name::<6>($($argument),*),
            7 => $name::<7>($($argument),*),
            _ => $name::<MAX_LARGE>($($argument),*),
        }
    };
}

/// The manifold that a body with large modes moves on.
#[derive(Debug, Clone)]
pub struct Manifold(Arc<Constants>);

#[derive(Debug)]
struct Constants {
    /// The body in the extended shapes.
    body: ReducedBody,
    /// By what it was made of.
    hash: Hash,
    /// Number of modes of the motion.
    modes: usize,
    /// Which of them are large.
    large: Vec<usize>,
    /// Products j ≤ k of the large modes, numbered among these.
    pairs: Vec<[usize; 2]>,
    /// T', column by column (extended shapes × pairs), and ready for products with it and with its transpose.
    shapes: Vec<f64>,
    to_shapes: BlockedMatrix,
    from_shapes: BlockedMatrix,
    /// E, column by column (extended shapes × (modes + pairs)).
    shapes_by_coordinates: Mat<f64>,
    /// T'ᵀE (pairs × (modes + pairs)): rows of the mass of the products in z; and the same columns, by −.
    mass: BlockedMatrix,
    negative_mass: BlockedMatrix,
    /// T_jk of the modes by large modes k: large modes j within modes, then modes within large modes j.
    slopes: BlockedMatrix,
    /// M − 1 of the large modes, by products (entries i ≥ j × pairs).
    locked: BlockedMatrix,
    /// ∂V_n/∂q by products: ½ Σ g_ijk q_j q_k, then the ½ Σ w_ijkl q_k q_l for i ≥ j.
    forces: BlockedMatrix,
}

/// The place on the manifold.
#[derive(Debug, Clone, Default)]
pub(crate) struct ManifoldPoint {
    /// The large ones of q and q̇.
    displacement: [f64; MAX_LARGE],
    rate: [f64; MAX_LARGE],
    /// T q of the modes: large modes within modes, then modes within large modes.
    slopes: Vec<f64>,
    /// Cholesky factor of what M leaves to the large modes: entries i ≥ j, row by row, with the reciprocals of the diagonal.
    factor: Vec<f64>,
}

impl Manifold {
    /// By the shapes of second order, the body in the extended shapes, and `energies`: the `∫ ε₂(i,j):C:ε₂(k,l) dV` of the
    /// large modes, for each pair of pairs (i ≤ j, k ≤ l) as in [`SecondOrderShapes::pairs`], row by row.
    ///
    /// # Errors
    /// [`SetupError`] for more large modes than [`MAX_LARGE`], sizes that do not fit together, and numbers that are not
    /// finite.
    pub fn new(body: ReducedBody, shapes: &SecondOrderShapes, energies: &[f64]) -> Result<Self, SetupError> {
        let SecondOrderShapes { dynamic, large, slopes, cubic, relief, .. } = shapes;
        let key = Key::new().of("manifold", 1).with("body", &body).with("modes", dynamic).with("large", large);
        let key = key.with("slopes", slopes).with("cubic", cubic).with("relief", relief).with("energies", energies);
        let (count, pairs) = (large.len(), SecondOrderShapes::pairs(large.len()));
        for (what, found, expected) in [
            ("the list of energies of second order", energies.len(), pairs.len() * pairs.len()),
            ("the body in the extended shapes", body.flexible(), shapes.modes.shapes.ncols()),
            ("the slopes of the manifold", slopes.ncols(), pairs.len()),
        ] {
            if found != expected {
                return Err(SetupError::Length { what, expected, found });
            }
        }
        if count == 0 || count > MAX_LARGE {
            let expected = "1 to 8";
            return Err(SetupError::Value { what: "the number of large modes", found: count as f64, expected });
        }
        if let Some(found) = energies.iter().copied().find(|energy| !energy.is_finite()) {
            let what = "an energy of second order";
            return Err(SetupError::Value { what, found, expected: "a finite number" });
        }
        let pair = |i: usize, j: usize| pairs.iter().position(|p| *p == [i.min(j), i.max(j)]).unwrap_or_default();
        // The energy of a pair of pairs, less what the shapes that follow relieve; symmetric in all four.
        let of_pairs = |a: usize, b: usize| energies[a * pairs.len() + b] - relief[(a, b)];
        let quartic = |i: usize, j: usize, k: usize, l: usize| {
            [[i, j, k, l], [i, k, j, l], [i, l, j, k]]
                .map(|[a, b, c, d]| 0.5 * (of_pairs(pair(a, b), pair(c, d)) + of_pairs(pair(c, d), pair(a, b))))
                .iter()
                .sum::<f64>()
                / 3.0
        };
        let cubic = |i: usize, j: usize, k: usize| {
            (cubic[(i, pair(j, k))] + cubic[(j, pair(i, k))] + cubic[(k, pair(i, j))]) / 3.0
        };
        let mut forces = Vec::new();
        for [k, l] in &pairs {
            // A sum over all ordered pairs has the product twice, but for squares.
            let twice = if k == l { 0.5 } else { 1.0 };
            forces.extend((0..count).map(|i| twice * cubic(i, *k, *l)));
            forces.extend(triangle(count).map(|[i, j]| twice * quartic(i, j, *k, *l)));
        }
        let extended = body.flexible();
        let of_products = |i: usize, a: usize| {
            let [j, k] = pairs[a];
            if j == k { 0.5 * slopes[(i, a)] } else { slopes[(i, a)] }
        };
        let shapes_by_coordinates =
            Mat::from_fn(extended, dynamic + pairs.len(), |i, a| match a.checked_sub(*dynamic) {
                None => f64::from(u8::from(i == a)),
                Some(a) => of_products(i, a),
            });
        let shapes = shapes_by_coordinates.get(.., *dynamic..);
        let mass = shapes.transpose() * &shapes_by_coordinates;
        let slope = |i: usize, j: usize, k: usize| slopes[(i, pair(j, k))];
        let follow = |a: [usize; 2], b: [usize; 2]| -> f64 {
            (*dynamic..extended).map(|i| slope(i, a[0], a[1]) * slope(i, b[0], b[1])).sum()
        };
        let mut locked = Vec::new();
        for [j, k] in &pairs {
            locked.extend(triangle(count).map(|[a, b]| {
                let both = if j == k { 0.0 } else { follow([a, *k], [b, *j]) };
                follow([a, *j], [b, *k]) + both
            }));
        }
        let of_modes = (0..*dynamic).flat_map(|i| (0..count).map(move |j| [i, j]));
        let by_modes = (0..count).flat_map(|j| (0..*dynamic).map(move |i| [i, j]));
        let of_slopes: Vec<[usize; 2]> = of_modes.chain(by_modes).collect();
        let by_products = |entries: &[f64]| {
            BlockedMatrix::new(MatRef::from_column_major_slice(entries, entries.len() / pairs.len(), pairs.len()))
        };
        Ok(Self(Arc::new(Constants {
            hash: key.finish(),
            slopes: BlockedMatrix::new(
                Mat::from_fn(of_slopes.len(), count, |row, k| slope(of_slopes[row][0], of_slopes[row][1], k)).as_ref(),
            ),
            modes: *dynamic,
            large: large.clone(),
            to_shapes: BlockedMatrix::new(shapes),
            from_shapes: BlockedMatrix::new(shapes.transpose()),
            shapes: columns(shapes),
            negative_mass: BlockedMatrix::new((-mass.transpose()).as_ref()),
            mass: BlockedMatrix::new(mass.as_ref()),
            locked: by_products(&locked),
            forces: by_products(&forces),
            pairs,
            shapes_by_coordinates,
            body,
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

    /// ξ of a unit of q_j q_k, for each pair of large modes as in [`SecondOrderShapes::pairs`]: T', pair by pair.
    pub fn of_products(&self) -> &[f64] {
        &self.0.shapes
    }

    /// ξ(q) in the extended shapes, as many as the body has.
    pub fn coordinates(&self, q: &[f64], xi: &mut [f64]) {
        let Constants { large, pairs, modes, shapes, .. } = &*self.0;
        xi[..*modes].copy_from_slice(q);
        xi[*modes..].fill(0.0);
        for ([j, k], shape) in pairs.iter().zip(shapes.chunks_exact(xi.len().max(1))) {
            let product = q[large[*j]] * q[large[*k]];
            xi.iter_mut().zip(shape).for_each(|(xi, shape)| *xi += shape * product);
        }
    }

    /// Number of coordinates z.
    pub(crate) fn size(&self) -> usize {
        self.0.modes + self.0.pairs.len()
    }

    /// E, by which ξ = E z.
    pub(crate) fn shapes_by_coordinates(&self) -> &Mat<f64> {
        &self.0.shapes_by_coordinates
    }

    pub(crate) fn place(&self) -> ManifoldPoint {
        let Constants { large, modes, .. } = &*self.0;
        ManifoldPoint {
            slopes: vec![0.0; 2 * large.len() * modes],
            factor: vec![0.0; large.len() * (large.len() + 1) / 2],
            ..ManifoldPoint::default()
        }
    }

    /// Goes to q: z there, and M.
    pub(crate) fn go(&self, q: &[f64], place: &mut ManifoldPoint, z: &mut [f64]) {
        let Constants { large, modes, slopes, locked, .. } = &*self.0;
        let ManifoldPoint { displacement: x, slopes: at_q, factor, .. } = place;
        large_of(large, q, x);
        let (of_modes, products) = z.split_at_mut(*modes);
        of_modes.copy_from_slice(q);
        by_count!(large.len(), find_products(x, products));
        slopes.multiply(&x[..large.len()], at_q);
        // Of M, the modes that are not large leave to the large ones 1 + tᵀt of the shapes that only follow.
        locked.multiply(products, factor);
        by_count!(large.len(), factorize(factor));
    }

    /// Goes along with q̇: ż.
    pub(crate) fn go_along(&self, rate: &[f64], place: &mut ManifoldPoint, z_rate: &mut [f64]) {
        large_of(&self.0.large, rate, &mut place.rate);
        self.extend(place, rate, z_rate);
    }

    /// ∂z/∂q x of modal velocities or accelerations x.
    pub(crate) fn extend(&self, place: &ManifoldPoint, x: &[f64], out: &mut [f64]) {
        let Constants { large, modes, .. } = &*self.0;
        let (of_modes, products) = out.split_at_mut(*modes);
        of_modes.copy_from_slice(x);
        let mut of_large = [0.0; MAX_LARGE];
        large_of(large, x, &mut of_large);
        for ((products, q), j) in rows_mut(products, &place.displacement[..large.len()]).zip(0..) {
            let x = &of_large[j..];
            for ((product, of_q), of_x) in products.iter_mut().zip(q).zip(x) {
                *product = q[0] * of_x + of_q * x[0];
            }
        }
    }

    /// Adds what z̈ has without q̈ to out, one number for each coordinate z.
    pub(crate) fn add_curvature(&self, place: &ManifoldPoint, out: &mut [f64]) {
        let Constants { large, modes, .. } = &*self.0;
        for (out, rate) in rows_mut(&mut out[*modes..], &place.rate[..large.len()]) {
            out.iter_mut().zip(rate).for_each(|(out, other)| *out += 2.0 * rate[0] * other);
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
        self.add_products(&place.displacement, products, out);
    }

    /// Adds Ḋᵀ of momenta of the products.
    pub(crate) fn add_projected_rate(&self, place: &ManifoldPoint, momenta: &[f64], out: &mut [f64]) {
        self.add_products(&place.rate, momenta, out);
    }

    fn add_products(&self, x: &[f64; MAX_LARGE], of_products: &[f64], out: &mut [f64]) {
        let large = &self.0.large;
        let sums = by_count!(large.len(), sums_of_products(x, of_products));
        for (mode, sum) in large.iter().zip(sums) {
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

    /// L⁻¹ y in place (modes), of the Cholesky factor M = L Lᵀ that has the large modes last.
    pub(crate) fn substitute_forward(&self, place: &ManifoldPoint, y: &mut [f64]) {
        let large = &self.0.large;
        by_count!(large.len(), forward(large, &place.slopes, &place.factor, y));
    }

    /// L⁻ᵀ y in place.
    pub(crate) fn substitute_back(&self, place: &ManifoldPoint, y: &mut [f64]) {
        let large = &self.0.large;
        let x = by_count!(large.len(), backward(large, &place.factor, y));
        let negative = x.map(|x| -x);
        add_product(&place.slopes[large.len() * y.len()..], y.len(), &negative[..large.len()], y);
        for (x, mode) in x.iter().zip(large) {
            y[*mode] = *x;
        }
    }

    /// Subtracts ∂V_n/∂q from modal forces, at z.
    pub(crate) fn subtract_force(&self, place: &ManifoldPoint, z: &[f64], force: &mut [f64]) {
        let [cubic, quartic] = self.forces(&place.displacement, &z[self.0.modes..]);
        for (mode, (cubic, quartic)) in self.0.large.iter().zip(cubic.iter().zip(quartic)) {
            force[*mode] -= cubic + quartic;
        }
    }

    /// V_n: the strain energy beyond ½ qᵀΛq.
    pub fn energy(&self, q: &[f64]) -> f64 {
        let Constants { large, pairs, .. } = &*self.0;
        let mut x = [0.0; MAX_LARGE];
        large_of(large, q, &mut x);
        let mut products = [0.0; MAX_PAIRS];
        products.iter_mut().zip(pairs).for_each(|(product, [j, k])| *product = x[*j] * x[*k]);
        let [cubic, quartic] = self.forces(&x, &products[..pairs.len()]);
        // Of third and of fourth degree.
        dot(&cubic, &x) / 3.0 + dot(&quartic, &x) / 4.0
    }

    /// ∂V_n/∂q of third and of fourth order, by the large modes and their products.
    fn forces(&self, x: &[f64; MAX_LARGE], products: &[f64]) -> [[f64; MAX_LARGE]; 2] {
        let count = self.0.large.len();
        let mut rows = [0.0; MAX_LARGE + MAX_PAIRS];
        let rows = &mut rows[..count + products.len()];
        self.0.forces.multiply(products, rows);
        let (of_third, of_fourth) = rows.split_at(count);
        let mut cubic = [0.0; MAX_LARGE];
        cubic[..count].copy_from_slice(of_third);
        [cubic, by_count!(count, symmetric_product(of_fourth, x))]
    }
}

/// The entries i ≥ j of a triangle, row by row.
fn triangle(size: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..size).flat_map(|i| (0..=i).map(move |j| [i, j]))
}

/// The products j ≤ k of each large mode j with itself and those after it, and the list `x` of the large modes from j on.
fn rows_mut<'a>(products: &'a mut [f64], x: &'a [f64]) -> impl Iterator<Item = (&'a mut [f64], &'a [f64])> {
    let mut rest = products;
    (0..x.len()).map(move |j| {
        let (row, after) = std::mem::take(&mut rest).split_at_mut(x.len() - j);
        rest = after;
        (row, &x[j..])
    })
}

/// The products j ≤ k of large modes.
fn find_products<const C: usize>(x: &[f64; MAX_LARGE], products: &mut [f64]) {
    let products = &mut products[..C * (C + 1) / 2];
    let mut a = 0;
    for j in 0..C {
        for k in j..C {
            products[a] = x[j] * x[k];
            a += 1;
        }
    }
}

/// Bᵀ y of a number for each product.
fn sums_of_products<const C: usize>(x: &[f64; MAX_LARGE], of_products: &[f64]) -> [f64; MAX_LARGE] {
    let y = &of_products[..C * (C + 1) / 2];
    let (mut sums, mut a) = ([0.0; MAX_LARGE], 0);
    for j in 0..C {
        for k in j..C {
            sums[j] += y[a] * x[k];
            sums[k] += y[a] * x[j];
            a += 1;
        }
    }
    sums
}

/// Turns the entries i ≥ j of M − 1 into those of the Cholesky factor of M, with the reciprocals of the diagonal.
fn factorize<const C: usize>(factor: &mut [f64]) {
    let factor = &mut factor[..C * (C + 1) / 2];
    for i in 0..C {
        for j in 0..=i {
            let mut sum = f64::from(u8::from(i == j)) + factor[entry(i, j)];
            for k in 0..j {
                sum -= factor[entry(i, k)] * factor[entry(j, k)];
            }
            factor[entry(i, j)] = if i == j { sum.sqrt().recip() } else { sum * factor[entry(j, j)] };
        }
    }
}

/// L⁻¹ y in place, by the slopes of the large modes within all modes and the factor of what M leaves to the large ones.
fn forward<const C: usize>(large: &[usize], slopes: &[f64], factor: &[f64], y: &mut [f64]) {
    let (slopes, factor) = (slopes.as_chunks::<C>().0, &factor[..C * (C + 1) / 2]);
    // The slopes are zero along the large modes, so that these rows of y stay out of the sums.
    let mut sums = [0.0; C];
    for (slopes, y) in slopes.iter().zip(y.iter()) {
        sums.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += slope * y);
    }
    let mut x = [0.0; C];
    for i in 0..C {
        let mut rest = y[large[i]] - sums[i];
        for k in 0..i {
            rest -= factor[entry(i, k)] * x[k];
        }
        x[i] = rest * factor[entry(i, i)];
    }
    large.iter().zip(x).for_each(|(mode, x)| y[*mode] = x);
}

/// L⁻ᵀ y along the large modes, of the factor of what M leaves to them.
fn backward<const C: usize>(large: &[usize], factor: &[f64], y: &[f64]) -> [f64; MAX_LARGE] {
    let factor = &factor[..C * (C + 1) / 2];
    let mut x = [0.0; MAX_LARGE];
    for i in (0..C).rev() {
        let mut rest = y[large[i]];
        for k in i + 1..C {
            rest -= factor[entry(k, i)] * x[k];
        }
        x[i] = rest * factor[entry(i, i)];
    }
    x
}

/// A x, of a symmetric matrix by its entries i ≥ j, row by row.
fn symmetric_product<const C: usize>(entries: &[f64], x: &[f64; MAX_LARGE]) -> [f64; MAX_LARGE] {
    let entries = &entries[..C * (C + 1) / 2];
    let mut product = [0.0; MAX_LARGE];
    for i in 0..C {
        for j in 0..i {
            product[i] += entries[entry(i, j)] * x[j];
            product[j] += entries[entry(i, j)] * x[i];
        }
        product[i] += entries[entry(i, i)] * x[i];
    }
    product
}

/// The large ones of q, then zeros.
fn large_of(large: &[usize], q: &[f64], x: &mut [f64; MAX_LARGE]) {
    x.iter_mut().zip(large).for_each(|(x, k)| *x = q[*k]);
}

/// Where a triangle row by row has the entry i ≥ j.
fn entry(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

impl Keyed for Manifold {
    fn key(&self, key: Key) -> Key {
        self.0.hash.key(key)
    }
}
