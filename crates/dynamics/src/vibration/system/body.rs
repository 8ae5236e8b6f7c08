//! One body in the linearised equations: Eqs. (L1), (L2) and (L11) of `docs/method/systems.md`.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use reduced_body::ReducedBody;
use rigid_kin::cross_matrix;

use crate::conservative::ConservativeBody;
use crate::conservative::body::Drawn;
use crate::conservative::manifold::BentShape;
use crate::vibration::system::configuration::BodyConfiguration;
use crate::vibration::system::load::load_forces;

/// The terms of one body: M ξ̈ + C ξ̇ + K ξ, and the forces that steady motion leaves.
#[derive(Debug, Clone)]
pub(crate) struct BodyTerms {
    /// M.
    pub mass: Mat<f64>,
    /// C.
    pub damping: Mat<f64>,
    /// K, without the stiffness Λ of the modes, with ∂²V/∂q² − Λ of large ones.
    pub stiffness: Mat<f64>,
    /// The part M L' of it.
    pub accelerated: Mat<f64>,
    /// L: δv = ξ̇ + L ξ.
    pub convection: Mat<f64>,
    /// Forces of inertia, modes and loads in its motion.
    pub forces: Vec<f64>,
}

impl BodyTerms {
    /// At a time, in its motion.
    pub fn new(body: &ConservativeBody, at: &BodyConfiguration, time: f64) -> Self {
        let nf = at.q.len();
        let n = 6 + nf;
        let (q, omega) = (&at.q, &at.omega);
        let inertia = body.inertia_where(at);
        let cross = cross_matrix(omega);
        let moment = cross_matrix(&inertia.moment);
        let mut mass = Mat::from_fn(n, n, |i, j| match (i, j) {
            (0..3, 0..3) => {
                if i == j {
                    body.mass()
                } else {
                    0.0
                }
            }
            (0..3, 3..6) => -moment[(i, j - 3)],
            (3..6, 0..3) => moment[(i - 3, j)],
            (0..3, _) => inertia.translation[j - 6][i],
            (_, 0..3) => inertia.translation[i - 6][j],
            (3..6, 3..6) => inertia.whole[(i - 3, j - 3)],
            (3..6, _) => inertia.coupling[i - 3][j - 6],
            (_, 3..6) => inertia.coupling[j - 3][i - 6],
            _ => inertia.of_modes.as_ref().map_or(f64::from(u8::from(i == j)), |of_modes| of_modes[(i - 6, j - 6)]),
        });
        let by_modes = inertia.change_of_momenta(omega);
        let mut convection = Mat::zeros(n, n);
        put(&mut convection, [0, 0], &cross);
        put(&mut convection, [0, 3], &cross_matrix(&at.velocity));
        put(&mut convection, [3, 3], &cross);
        // Forces on the modes by changes of velocities and of q.
        let (mut by_velocity, mut by_q) = (Mat::zeros(n, n), Mat::zeros(n, nf));
        let damping = body.circular_frequencies.iter().zip(&body.damping_ratios).map(|(w, zeta)| 2.0 * zeta * w);
        for (k, damping) in damping.enumerate() {
            (0..n).for_each(|j| by_velocity[(6 + k, j)] = by_modes[(j, k)]);
            for j in 0..nf {
                by_q[(6 + k, j)] = omega.dot(&(inertia.curvature(k, j) * omega));
            }
            by_velocity[(6 + k, 6 + k)] -= damping;
        }
        // What draws its drive in counts as mass.
        let drawn = body.drawn(q);
        if let Some(Drawn { along, momenta, .. }) = &drawn {
            for (k, i) in (0..nf).flat_map(|k| (0..6).map(move |i| (k, i))) {
                let less = momenta[k] * along[i / 3][i % 3];
                mass[(i, 6 + k)] -= less;
                mass[(6 + k, i)] -= less;
            }
        }
        // y' + ω×y = forces, with momenta y of the rigid motion: a body that is held away from its center of mass turns about its origin, or
        // moves along a line.
        let momentum = at.velocity * body.mass() + omega.cross(&inertia.moment);
        let angular_momentum = inertia.whole * omega + at.own_momentum;
        let turning = |x: &Mat<f64>| {
            let columns = x.ncols();
            let mut out = Mat::zeros(n, columns);
            for column in 0..columns {
                for first in [0, 3] {
                    let part = omega.cross(&Vector3::from_fn(|i, _| x[(first + i, column)]));
                    (0..3).for_each(|i| out[(first + i, column)] = part[i]);
                }
            }
            out
        };
        let mut of_velocity = turning(&mass) - by_velocity;
        put_less(&mut of_velocity, [0, 3], &cross_matrix(&momentum));
        put_less(&mut of_velocity, [3, 3], &cross_matrix(&angular_momentum));
        let mut damping = &mass * &convection + &of_velocity;
        let mut stiffness = &of_velocity * &convection;
        let by_place = turning(&by_modes) - by_q;
        for (i, k) in (0..nf).flat_map(|k| (0..n).map(move |i| (i, k))) {
            damping[(i, 6 + k)] += by_modes[(i, k)];
            stiffness[(i, 6 + k)] += by_place[(i, k)];
        }
        let mut forces = vec![0.0; n];
        let [force, moment] = [omega.cross(&momentum), omega.cross(&angular_momentum)];
        for i in 0..3 {
            (forces[i], forces[3 + i]) = (-force[i], -moment[i]);
        }
        for k in 0..nf {
            let strain = body.circular_frequencies[k] * body.circular_frequencies[k] * q[k];
            forces[6 + k] = omega.dot(&(inertia.slope(k) * omega)) - strain;
        }
        if let Some(reference) = &body.reference {
            reference.subtract_force(q, &mut forces[6..]);
            add_to_modes(&mut stiffness, 1.0, &reference.stiffness());
        }
        if let Some(Drawn { along: [direction, axis], stiffness: of_drive, .. }) = &drawn {
            let acceleration = direction.dot(&at.velocity_rate) + axis.dot(&at.omega_rate);
            add_to_modes(&mut stiffness, -acceleration, of_drive);
        }
        if let Some(bent) = at.bent.as_ref().map(BentShape::place) {
            bent.subtract_force(&mut forces[6..]);
            let terms = bent.terms();
            for (row, i) in terms.stiffness.chunks_exact(terms.modes.len()).zip(&terms.modes) {
                row.iter().zip(&terms.modes).for_each(|(k, j)| stiffness[(6 + i, 6 + j)] += k);
            }
        }
        let mut terms = Self { mass, damping, stiffness, accelerated: Mat::zeros(n, n), convection, forces };
        terms.add_acceleration(&inertia, at);
        terms.add_loads(body, at, time);
        terms
    }

    /// Adds what the rates of V and ω do: −M v' to the forces, and M L' + ∂(M v')/∂q to K.
    fn add_acceleration(&mut self, inertia: &InertiaWhere, at: &BodyConfiguration) {
        let [velocity, omega] = [&at.velocity_rate, &at.omega_rate];
        if *velocity == Vector3::zeros() && *omega == Vector3::zeros() {
            return;
        }
        let n = self.forces.len();
        let mut convection_rate = Mat::zeros(n, n);
        put(&mut convection_rate, [0, 0], &cross_matrix(omega));
        put(&mut convection_rate, [0, 3], &cross_matrix(velocity));
        put(&mut convection_rate, [3, 3], &cross_matrix(omega));
        self.accelerated = &self.mass * &convection_rate;
        self.stiffness += &self.accelerated;
        let mut by_modes = inertia.change_of_momenta(omega);
        for (k, translation) in inertia.translation.iter().enumerate() {
            let moment = translation.cross(velocity);
            (0..3).for_each(|i| by_modes[(3 + i, k)] += moment[i]);
        }
        for (i, k) in (0..n - 6).flat_map(|k| (0..n).map(move |i| (i, k))) {
            self.stiffness[(i, 6 + k)] += by_modes[(i, k)];
        }
        for (i, force) in self.forces.iter_mut().enumerate() {
            let rates = velocity.iter().chain(omega).enumerate();
            *force -= rates.map(|(k, rate)| self.mass[(i, k)] * rate).sum::<f64>();
        }
    }

    /// Adds the loads of the body.
    fn add_loads(&mut self, body: &ConservativeBody, at: &BodyConfiguration, time: f64) {
        if body.loads().is_empty() {
            return;
        }
        let loads = load_forces(body, at, time);
        self.forces.iter_mut().zip(&loads.forces).for_each(|(sum, force)| *sum += force);
        self.stiffness -= &loads.by_place + &loads.by_velocity * &self.convection;
        self.damping -= &loads.by_velocity;
    }
}

/// The inertia of a body with some modal displacements.
struct InertiaWhere {
    /// J.
    whole: Matrix3<f64>,
    /// Mass times the place of the center of mass from the origin, and its slopes over the modes.
    moment: Vector3<f64>,
    translation: Vec<Vector3<f64>>,
    /// S, a list (nf) for each axis.
    coupling: [Vec<f64>; 3],
    /// ∂S/∂q of each axis: G_i, but with large modes.
    gyroscopic: [Mat<f64>; 3],
    /// ½ ∂J_ij/∂q of the pairs and ½ ∂²J_ij/∂q²: c_ij + N_ij q and N_ij, but with large modes.
    first: [Vec<f64>; 6],
    second: [Mat<f64>; 6],
    /// M of the modes; `None` where it is 1.
    of_modes: Option<Mat<f64>>,
}

impl InertiaWhere {
    /// ½ ∂J/∂q_k
    fn slope(&self, k: usize) -> Matrix3<f64> {
        symmetric(|pair| self.first[pair][k])
    }

    /// Changes of the momenta of a spin by those of q (n×nf): ∂(M v)/∂q.
    fn change_of_momenta(&self, omega: &Vector3<f64>) -> Mat<f64> {
        let nf = self.first[0].len();
        Mat::from_fn(6 + nf, nf, |i, k| match i {
            0..3 => omega.cross(&self.translation[k])[i],
            3..6 => (2.0 * self.slope(k) * omega)[i - 3],
            _ => (0..3).map(|axis| omega[axis] * self.gyroscopic[axis][(i - 6, k)]).sum(),
        })
    }

    /// ½ ∂²J/∂q_k∂q_j
    fn curvature(&self, k: usize, j: usize) -> Matrix3<f64> {
        symmetric(|pair| self.second[pair][(k, j)])
    }
}

fn symmetric(of_pair: impl Fn(usize) -> f64) -> Matrix3<f64> {
    let mut sum = Matrix3::zeros();
    for (pair, (i, j)) in ReducedBody::PAIRS.into_iter().enumerate() {
        sum[(i, j)] = of_pair(pair);
        sum[(j, i)] = sum[(i, j)];
    }
    sum
}

impl ConservativeBody {
    fn inertia_where(&self, at: &BodyConfiguration) -> InertiaWhere {
        let constants = self.inertia_constants();
        let bent = at.bent.as_ref().map(BentShape::place);
        let z = bent.map_or(&at.q[..], |bent| bent.z);
        let product = |matrix: &Mat<f64>, i: usize| z.iter().enumerate().map(|(j, z)| matrix[(i, j)] * z).sum::<f64>();
        let of_coordinates = |matrix: &Mat<f64>| (0..z.len()).map(|i| product(matrix, i)).collect::<Vec<f64>>();
        let (mut whole, mut moment) = (constants.inertia, constants.moment);
        constants.translation.iter().zip(z).for_each(|(translation, z)| moment += translation * *z);
        let mut first = constants.first;
        whole += symmetric(|pair| {
            let bent = of_coordinates(&constants.second[pair]);
            let terms = z.iter().zip(first[pair].iter().zip(&bent));
            terms.map(|(z, (c, n_z))| z * (2.0 * c + n_z)).sum()
        });
        for (first, second) in first.iter_mut().zip(&constants.second) {
            first.iter_mut().zip(of_coordinates(second)).for_each(|(c, n_z)| *c += n_z);
        }
        let mut coupling = constants.gyroscopic.each_ref().map(of_coordinates);
        for (s, b) in coupling.iter_mut().flatten().zip(constants.coupling.iter().flatten()) {
            *s += b;
        }
        let translation = constants.translation;
        let (gyroscopic, second) = (constants.gyroscopic, constants.second);
        let Some(bent) = bent else {
            return InertiaWhere { whole, moment, translation, coupling, gyroscopic, first, second, of_modes: None };
        };
        // Of lists y and matrices A over z, Bᵀy and BᵀA B + Σ y ∂²z/∂q².
        let slopes = bent.slopes();
        let slopes = Mat::from_fn(z.len(), slopes.len(), |i, k| slopes[k][i]);
        let changed = |matrix: &Mat<f64>, list: &Vec<f64>| {
            slopes.transpose() * (matrix * &slopes) + bent.curvature(list.iter().copied())
        };
        let on_modes = |list: &Vec<f64>| {
            slopes.col_iter().map(|slope| slope.iter().zip(list).map(|(slope, y)| slope * y).sum()).collect()
        };
        InertiaWhere {
            whole,
            moment,
            translation: slopes
                .col_iter()
                .map(|slope| slope.iter().zip(&translation).map(|(slope, translation)| translation * *slope).sum())
                .collect(),
            gyroscopic: std::array::from_fn(|axis| changed(&gyroscopic[axis], &coupling[axis])),
            second: std::array::from_fn(|pair| changed(&second[pair], &first[pair])),
            coupling: coupling.each_ref().map(on_modes),
            first: first.each_ref().map(on_modes),
            of_modes: Some(bent.mass()),
        }
    }
}

/// Adds a multiple of a matrix over the modes.
fn add_to_modes(to: &mut Mat<f64>, factor: f64, of_modes: &Mat<f64>) {
    for (i, j) in (0..of_modes.ncols()).flat_map(|j| (0..of_modes.nrows()).map(move |i| (i, j))) {
        to[(6 + i, 6 + j)] += factor * of_modes[(i, j)];
    }
}

fn put(to: &mut Mat<f64>, [row, column]: [usize; 2], block: &Matrix3<f64>) {
    for (i, j) in (0..3).flat_map(|j| (0..3).map(move |i| (i, j))) {
        to[(row + i, column + j)] += block[(i, j)];
    }
}

fn put_less(to: &mut Mat<f64>, at: [usize; 2], block: &Matrix3<f64>) {
    put(to, at, &-block);
}
