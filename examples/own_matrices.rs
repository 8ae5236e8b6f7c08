//! A beam from its own matrices, with six degrees of freedom a node: its frequencies, and how it tumbles.
//!
//! Two-node Euler–Bernoulli elements with consistent mass. A beam of length L that nothing holds bends at
//! ω_k = (β_k/L)² √(EI/ρA), cos β cosh β = 1, and energy and momentum of its free motion stay what they are.

use std::error::Error;

use flexframe::dynamics::{Initial, Method, Observation, Physics, Rows, Setup, Simulation, StepControl};
use flexframe::faer::sparse::{SparseColMat, Triplet};
use flexframe::modal::{Solver, Support};
use flexframe::nalgebra::Vector3;
use flexframe::reduced_body::ReducedBody;

/// A steel beam of 2 m with a section of 40 × 30 mm, SI units.
const LENGTH: f64 = 2.0;
const HEIGHT: f64 = 0.04;
const WIDTH: f64 = 0.03;
const YOUNG_MODULUS: f64 = 210e9;
const SHEAR_MODULUS: f64 = 81e9;
const DENSITY: f64 = 7850.0;
const AREA: f64 = HEIGHT * WIDTH;
/// Second moments of area about y and z.
const ABOUT_Y: f64 = WIDTH * HEIGHT * HEIGHT * HEIGHT / 12.0;
const ABOUT_Z: f64 = HEIGHT * WIDTH * WIDTH * WIDTH / 12.0;
const ELEMENTS: usize = 16;

type Sparse = SparseColMat<usize, f64>;

/// Result of the example.
pub struct Answer {
    /// Frequencies of the first four bending modes over those of beam theory.
    pub frequencies: [f64; 4],
    /// Largest change of the energy over the run, relative.
    pub energy: f64,
    /// Largest change of the angular momentum over the run, relative.
    pub angular_momentum: f64,
    /// Angle that the beam has turned by against a rigid one, rad: the deformation does act on the motion.
    pub against_rigid: f64,
}

/// Runs the example.
pub fn run() -> Result<Answer, Box<dyn Error>> {
    let positions: Vec<[f64; 3]> = (0..=ELEMENTS).map(|i| [LENGTH * i as f64 / ELEMENTS as f64, 0.0, 0.0]).collect();
    let [stiffness, mass] = matrices()?;
    let modes = Solver::new(stiffness.as_ref(), mass.as_ref(), &positions, &Support::free())?.modes(6, |_| ())?;
    let theory = |beta: f64, moment: f64| {
        (beta / LENGTH).powi(2) * (YOUNG_MODULUS * moment / (DENSITY * AREA)).sqrt() / std::f64::consts::TAU
    };
    let (first, second) = (4.730_040_744_862_704, 7.853_204_624_095_838);
    let expected = [theory(first, ABOUT_Z), theory(first, ABOUT_Y), theory(second, ABOUT_Z), theory(second, ABOUT_Y)];
    let found = modes.natural_frequencies();

    let body = modes.reduced(mass.as_ref(), &positions)?;
    let flexible = tumble(&body)?;
    let rigid = tumble(&body.truncated(0))?;
    let [start, .., end] = &flexible[..] else { return Err("the run has no rows".into()) };
    let momentum = start.angular_momentum_global;
    let largest = |change: &dyn Fn(&Observation) -> f64| flexible.iter().map(change).fold(0.0, f64::max);
    Ok(Answer {
        frequencies: std::array::from_fn(|k| found[k] / expected[k]),
        energy: largest(&|row| (row.energy() / start.energy() - 1.0).abs()),
        angular_momentum: largest(&|row| (row.angular_momentum_global - momentum).norm() / momentum.norm()),
        against_rigid: end.attitude.angle_to(&rigid.last().ok_or("the run has no rows")?.attitude),
    })
}

/// K and M of the beam along x.
fn matrices() -> Result<[Sparse; 2], Box<dyn Error>> {
    let h = LENGTH / ELEMENTS as f64;
    let line = DENSITY * AREA;
    // Rows of K and M in an element: degrees of freedom 0 to 5 at its first node, 6 to 11 at its second.
    let (mut k, mut m) = (Vec::new(), Vec::new());
    let mut add = |rows: &[usize], stiffness: &dyn Fn(usize, usize) -> f64, inertia: &dyn Fn(usize, usize) -> f64| {
        for (i, j) in (0..rows.len()).flat_map(|i| (0..rows.len()).map(move |j| (i, j))) {
            for first in (0..ELEMENTS).map(|element| 6 * element) {
                k.push(Triplet::new(first + rows[i], first + rows[j], stiffness(i, j)));
                m.push(Triplet::new(first + rows[i], first + rows[j], inertia(i, j)));
            }
        }
    };
    // Stretching and torsion.
    let polar = ABOUT_Y + ABOUT_Z;
    for (rows, rigidity, inertia) in
        [([0, 6], YOUNG_MODULUS * AREA, line), ([3, 9], SHEAR_MODULUS * polar, DENSITY * polar)]
    {
        add(&rows, &|i, j| if i == j { rigidity / h } else { -rigidity / h }, &|i, j| {
            inertia * h / if i == j { 3.0 } else { 6.0 }
        });
    }
    // Bending: deflection and slope at both nodes. The slope of v is the rotation about z, that of w the one about −y.
    let bending = [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
    let consistent =
        [[156.0, 22.0, 54.0, -13.0], [22.0, 4.0, 13.0, -3.0], [54.0, 13.0, 156.0, -22.0], [-13.0, -3.0, -22.0, 4.0]];
    for (rows, sense, moment) in [([1, 5, 7, 11], 1.0, ABOUT_Z), ([2, 4, 8, 10], -1.0, ABOUT_Y)] {
        let scale = |i: usize| if i % 2 == 1 { sense * h } else { 1.0 };
        add(&rows, &|i, j| YOUNG_MODULUS * moment / h.powi(3) * bending[i][j] * scale(i) * scale(j), &|i, j| {
            line * h / 420.0 * consistent[i][j] * scale(i) * scale(j)
        });
    }
    let size = 6 * (ELEMENTS + 1);
    Ok([Sparse::try_new_from_triplets(size, size, &k)?, Sparse::try_new_from_triplets(size, size, &m)?])
}

/// A second of free motion, tumbling and vibrating.
fn tumble(body: &ReducedBody) -> Result<Vec<Observation>, Box<dyn Error>> {
    let flexible = body.flexible();
    let mut initial = Initial { omega: Vector3::new(20.0, 3.0, 4.0), ..Initial::at_rest(flexible) };
    initial.modal_velocity = [1.5, -2.0, 1.0, 0.5, 0.3, 0.2][..flexible].to_vec();
    let simulation = Simulation::new(&Setup {
        body,
        damping_ratios: &vec![0.0; flexible],
        loads: &[],
        physics: &Physics::default(),
        initial: &initial,
        method: &Method::EXPONENTIAL,
        control: StepControl::Fixed(1e-4),
        end: 1.0,
        rows: Rows::Interval(0.01),
        points: &[],
    })?;
    Ok(simulation.collect::<Result<_, _>>()?)
}

#[allow(dead_code)] // a test runs the example as a module
fn main() -> Result<(), Box<dyn Error>> {
    let Answer { frequencies, energy, angular_momentum, against_rigid } = run()?;
    println!("frequencies over those of beam theory: {frequencies:.6?}");
    println!("energy kept to {energy:.1e}, angular momentum to {angular_momentum:.1e}");
    println!("turned {against_rigid:.2e} rad away from a rigid beam");
    Ok(())
}
