//! Eqs. (28) to (31) and (36) to (40) word for word, with vectors of all N = 3n degrees of freedom.

use faer::sparse::SparseColMatRef;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use rigid_kin::{ReferencePoints, f_inverse, relative_velocity_rate, transformation_matrix};

use crate::common::Specimen;

/// Choices that the paper leaves open.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    /// Each step begins with x_n = Ψ q_n. Otherwise x_n keeps what T turned out of the span of the modes.
    pub projected: bool,
    /// Each step's rotation vector begins at zero. Otherwise (38) sums the total one.
    pub reanchored: bool,
}

/// A dead half-sine from time zero, on one node.
#[derive(Debug, Clone, Copy)]
pub struct NodeForce {
    pub node: usize,
    pub force_global: Vector3<f64>,
    pub duration: f64,
}

pub struct Literal {
    reading: Reading,
    step: f64,
    steps_done: u32,
    mass: Csc,
    /// Ψ (N×(6+nf)).
    psi: DMatrix<f64>,
    /// M_q⁻¹.
    inverse_modal_mass: DMatrix<f64>,
    /// M_q⁻¹ K_q and M_q⁻¹ C_q.
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    /// Nodes of R, P, Q.
    nodes: [usize; 3],
    points: ReferencePoints,
    force: NodeForce,
    total_mass: f64,
    /// A at the last anchor, and the rotation vector since.
    anchor: Matrix3<f64>,
    rotation_vector: Vector3<f64>,
    pub displacement: DVector<f64>,
    pub velocity: DVector<f64>,
    pub origin_global: Vector3<f64>,
}

/// Δη, Δv and ΔM of a stage.
struct Increment {
    q: DVector<f64>,
    y: DVector<f64>,
    relative_velocity: [Vector3<f64>; 2],
    rotation_vector: Vector3<f64>,
}

impl Literal {
    pub fn new(specimen: &Specimen, reading: Reading, damping_ratio: f64, force: NodeForce, step: f64) -> Self {
        let mass = Csc::new(specimen.matrices.mass());
        let (rigid, flexible) = (&specimen.modes.rigid.shapes, &specimen.modes.shapes);
        let nf = flexible.ncols();
        let psi =
            DMatrix::from_fn(rigid.nrows(), 6 + nf, |i, k| if k < 6 { rigid[(i, k)] } else { flexible[(i, k - 6)] });
        let modal_mass = psi.transpose() * mass.times(&psi); // (25)
        let inverse_modal_mass = modal_mass.try_inverse().unwrap();
        let lambda = |k: usize| if k < 6 { 0.0 } else { specimen.modes.eigenvalues[k - 6] };
        let diagonal = |f: &dyn Fn(f64) -> f64| DMatrix::from_diagonal(&DVector::from_fn(6 + nf, |k, _| f(lambda(k))));
        let nodes = specimen.reference_points.map(|at| specimen.nearest_node(at));
        let [r, p, q] = nodes.map(|node| Vector3::from(specimen.mesh.positions()[node]));
        Self {
            reading,
            step,
            steps_done: 0,
            stiffness: &inverse_modal_mass * diagonal(&|lambda| lambda), // (26)
            damping: &inverse_modal_mass * diagonal(&|lambda| 2.0 * damping_ratio * lambda.sqrt()), // (27)
            mass,
            displacement: DVector::zeros(psi.nrows()),
            velocity: DVector::zeros(psi.nrows()),
            psi,
            inverse_modal_mass,
            nodes,
            points: ReferencePoints::new(&r, &p, &q).unwrap(),
            force,
            total_mass: specimen.body.mass,
            anchor: Matrix3::identity(),
            rotation_vector: Vector3::zeros(),
            origin_global: specimen.body.center_of_mass,
        }
    }

    /// Begins with a velocity of every node and a displacement in the span of the modes.
    pub fn start(&mut self, displacement: DVector<f64>, velocity: DVector<f64>) {
        self.displacement = displacement;
        self.velocity = velocity;
        self.project();
    }

    pub fn global_to_body(&self) -> Matrix3<f64> {
        transformation_matrix(&self.rotation_vector) * self.anchor
    }

    /// η by the inverse modal expansion, (30) and (31).
    pub fn modal_state(&self) -> (DVector<f64>, DVector<f64>) {
        (self.inverse_expansion(&self.displacement), self.inverse_expansion(&self.velocity))
    }

    /// q̈ of the state by (35), ω by (36) and α by (37).
    pub fn rates(&self) -> (DVector<f64>, Vector3<f64>, Vector3<f64>) {
        let (q, y) = self.modal_state();
        let t = f64::from(self.steps_done) * self.step;
        let a = self.acceleration(&q, &y, &self.force_global(t), &self.global_to_body());
        let [v_p, v_q] = self.relative(&y);
        let [a_p, a_q] = self.relative(&a);
        let omega = self.points.angular_velocity(&v_p, &v_q);
        let alpha = self.points.angular_acceleration(&v_p, &v_q, &a_p, &a_q, &omega);
        (a, omega, alpha)
    }

    pub fn step(&mut self) {
        let h = self.step;
        let t = f64::from(self.steps_done) * h;
        let (force_n, force_next) = (self.force_global(t), self.force_global(f64::from(self.steps_done + 1) * h));
        let mean = 0.5 * (force_n + force_next);
        let m_n = self.rotation_vector;
        let (q_n, y_n) = self.modal_state();
        let v_n = self.relative(&y_n);

        // k1
        let omega_n = self.points.angular_velocity(&v_n[0], &v_n[1]); // (36)
        let a_n = self.acceleration(&q_n, &y_n, &force_n, &self.global_to_body());
        let k1 = self.increment(&y_n, &a_n, &v_n, &omega_n, &m_n);
        // k2, k3, k4
        let k2 = self.stage(0.5, &k1, &v_n, &mean);
        let k3 = self.stage(0.5, &k2, &v_n, &mean);
        let k4 = self.stage(1.0, &k3, &v_n, &force_next);

        let m_next =
            m_n + (k1.rotation_vector + 2.0 * k2.rotation_vector + 2.0 * k3.rotation_vector + k4.rotation_vector) / 6.0; // (38)
        let dq = (k1.q + 2.0 * k2.q + 2.0 * k3.q + k4.q) / 6.0; // (39)
        let dy = (k1.y + 2.0 * k2.y + 2.0 * k3.y + k4.y) / 6.0;
        let (x, v) = self.turned(&m_next, &dq, &dy, 1.0); // (40)
        let frame = self.global_to_body().transpose() * self.mean(&self.rigid_expansion(&dq));
        self.origin_global += frame;
        self.displacement = x;
        self.velocity = v;
        self.rotation_vector = m_next;
        if self.reading.reanchored {
            self.anchor = self.global_to_body();
            self.rotation_vector = Vector3::zeros();
        }
        if self.reading.projected {
            self.project();
        }
        self.steps_done += 1;
    }

    /// One of k2, k3, k4 from the increment before it.
    fn stage(
        &self,
        fraction: f64,
        before: &Increment,
        v_n: &[Vector3<f64>; 2],
        force_global: &Vector3<f64>,
    ) -> Increment {
        let v = [0, 1].map(|i| v_n[i] + fraction * before.relative_velocity[i]);
        let omega = self.points.angular_velocity(&v[0], &v[1]);
        let m = self.rotation_vector + fraction * before.rotation_vector;
        let (x, xdot) = self.turned(&m, &before.q, &before.y, fraction);
        let (q, y) = (self.inverse_expansion(&x), self.inverse_expansion(&xdot));
        let a = self.acceleration(&q, &y, force_global, &(transformation_matrix(&m) * self.anchor));
        self.increment(&y, &a, &v, &omega, &m)
    }

    fn increment(
        &self,
        y: &DVector<f64>,
        a: &DVector<f64>,
        v: &[Vector3<f64>; 2],
        omega: &Vector3<f64>,
        m: &Vector3<f64>,
    ) -> Increment {
        let relative_acceleration = self.relative(a);
        let rate = |i: usize| relative_velocity_rate(&relative_acceleration[i], &v[i], omega); // (15), (16)
        Increment {
            q: self.step * y,
            y: self.step * a,
            relative_velocity: [0, 1].map(|i| self.step * rate(i)),
            rotation_vector: self.step * f_inverse(m, omega).unwrap(), // (20)
        }
    }

    /// `T({x, ẋ} + Ψ fraction Δη − {Ψ_R fraction Δq_R, 0})`.
    fn turned(
        &self,
        m: &Vector3<f64>,
        dq: &DVector<f64>,
        dy: &DVector<f64>,
        fraction: f64,
    ) -> (DVector<f64>, DVector<f64>) {
        let turn = transformation_matrix(m) * transformation_matrix(&self.rotation_vector).transpose();
        let x = &self.displacement + fraction * (&self.psi * dq - self.rigid_expansion(dq));
        let v = &self.velocity + fraction * (&self.psi * dy);
        let each_node = |x: DVector<f64>| {
            let mut x = x;
            for node in 0..x.len() / 3 {
                let turned = turn * x.fixed_rows::<3>(3 * node);
                x.fixed_rows_mut::<3>(3 * node).copy_from(&turned);
            }
            x
        };
        (each_node(x), each_node(v))
    }

    fn rigid_expansion(&self, modal: &DVector<f64>) -> DVector<f64> {
        self.psi.columns(0, 6) * modal.rows(0, 6)
    }

    fn inverse_expansion(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.inverse_modal_mass * self.psi.tr_mul(&self.mass.times_vector(x))
    }

    fn project(&mut self) {
        let (q, y) = self.modal_state();
        self.displacement = &self.psi * q;
        self.velocity = &self.psi * y;
    }

    fn force_global(&self, t: f64) -> Vector3<f64> {
        let phase = t / self.force.duration;
        let factor = if phase <= 1.0 { (std::f64::consts::PI * phase).sin() } else { 0.0 };
        factor * self.force.force_global
    }

    fn acceleration(
        &self,
        q: &DVector<f64>,
        y: &DVector<f64>,
        force_global: &Vector3<f64>,
        global_to_body: &Matrix3<f64>,
    ) -> DVector<f64> {
        let mut f = DVector::zeros(self.psi.nrows());
        f.fixed_rows_mut::<3>(3 * self.force.node).copy_from(&(global_to_body * force_global));
        &self.inverse_modal_mass * self.psi.tr_mul(&f) - &self.stiffness * q - &self.damping * y
    }

    /// Motion of P and Q less that of R in the field Ψ_R y_R.
    fn relative(&self, modal: &DVector<f64>) -> [Vector3<f64>; 2] {
        let field = self.rigid_expansion(modal);
        let [r, p, q] = self.nodes.map(|node| Vector3::from(field.fixed_rows::<3>(3 * node)));
        [p - r, q - r]
    }

    /// Motion of the centre of mass in a field.
    fn mean(&self, field: &DVector<f64>) -> Vector3<f64> {
        let momentum = self.mass.times_vector(field);
        (0..field.len() / 3).map(|node| Vector3::from(momentum.fixed_rows::<3>(3 * node))).sum::<Vector3<f64>>()
            / self.total_mass
    }
}

/// A sparse matrix by columns.
pub struct Csc {
    columns: Vec<Vec<(usize, f64)>>,
}

impl Csc {
    pub fn new(matrix: SparseColMatRef<'_, usize, f64>) -> Self {
        let column = |j| {
            let entries = matrix.row_idx_of_col(j).zip(matrix.val_of_col(j).iter().copied());
            entries.filter(|(_, value)| *value != 0.0).collect()
        };
        Self { columns: (0..matrix.ncols()).map(column).collect() }
    }

    pub fn times_vector(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut y = DVector::zeros(x.len());
        for (column, x) in self.columns.iter().zip(x.iter()) {
            for (i, value) in column {
                y[*i] += value * x;
            }
        }
        y
    }

    pub fn times(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = x.column_iter().map(|c| self.times_vector(&c.into())).collect();
        DMatrix::from_columns(&columns)
    }
}
