//! Bars hinged along shared lines of nodes, against nonlinear finite elements of the joined mesh.

use fem_tet10::Material;
use nalgebra::Vector3;
use verification::systems::hinged::{Hinge, Motions, Off, off, reference};
use verification::systems::meshes::BarFrame;

/// Bars of it bend by some thousandths of their length.
const SOFT: f64 = 5e7;
const SIZE: [f64; 3] = [1.0, 0.1, 0.05];

fn material(young_modulus: f64) -> Material {
    Material { young_modulus, poisson_ratio: 0.3, density: 1000.0 }
}

/// Two bars that tumble, the second one flapping about the hinge as well.
fn tumbling(end: f64, steps: usize, rows: usize) -> (BarFrame, Motions) {
    let frame = BarFrame::pair(SIZE, [6, 2]);
    let omega = Vector3::new(1.5, 3.0, 2.0);
    let flap = Vector3::new(0.0, -3.0, 0.0);
    let middle = |side: f64| Vector3::new(side * 0.5, 0.0, -side * 0.025);
    let velocities = vec![[omega.cross(&middle(-1.0)), omega], [(omega + flap).cross(&middle(1.0)), omega + flap]];
    (frame, Motions { material: material(SOFT), velocities, gravity: 0.0, hung: false, end, steps, rows })
}

fn found(frame: &BarFrame, motions: &Motions, hinges: &[(Hinge, &str)]) -> Vec<Off> {
    let directory = tempfile::tempdir().unwrap();
    let expected = reference(frame, motions).unwrap();
    let found = hinges.iter().map(|(hinge, keys)| {
        let found = off(directory.path(), frame, motions, *hinge, keys, &expected).unwrap();
        let Off { attitude, center, elastic, peak } = found;
        println!(
            "{hinge:?} {keys:?}: {attitude:.1e} rad, {center:.1e} m, {:.2} % of a peak of {peak:.2e} m",
            100.0 * elastic
        );
        found
    });
    found.collect()
}

/// Independent reference: the nonlinear finite elements of this crate on the joined mesh.
#[test]
fn a_hinge_of_nodes_moves_as_the_joined_mesh() {
    let (frame, motions) = tumbling(0.1, 100, 10);
    let balls = found(&frame, &motions, &[(Hinge::Balls, "modes = { flexible = 6 }")]).remove(0);
    assert!(balls.attitude < 1e-4 && balls.center < 1e-5 && balls.elastic < 0.02 && balls.peak > 1e-3, "{balls:?}");
}

const MODES: &str = "modes = { flexible = 6 }";

/// The price of a hinge on the mean of the line beside a ball at each node.
const BOTH: [(Hinge, &str); 2] = [(Hinge::Balls, MODES), (Hinge::Mean, MODES)];

/// Independent reference: the nonlinear finite elements of this crate on the joined mesh.
#[test]
#[ignore = "minutes: just nonlinear"]
fn a_pair_tumbles_as_the_joined_mesh() {
    let (frame, motions) = tumbling(1.0, 2000, 50);
    let hinges = [BOTH[0], BOTH[1], (Hinge::Balls, "modes = { flexible = 12 }")];
    let [balls, mean, _] = found(&frame, &motions, &hinges).try_into().unwrap();
    assert!(balls.attitude < 1e-4 && balls.center < 1e-4 && balls.elastic < 0.02, "{balls:?}");
    assert!(mean.attitude > balls.attitude, "{mean:?}");
}

/// Independent reference: the nonlinear finite elements of this crate on the joined mesh.
#[test]
#[ignore = "minutes: just nonlinear"]
fn a_hung_pair_falls_as_the_joined_mesh() {
    let frame = BarFrame::pair(SIZE, [6, 2]);
    let rest = [[Vector3::zeros(); 2]; 2].to_vec();
    let motions = Motions {
        material: material(2.0 * SOFT),
        velocities: rest,
        gravity: 9.81,
        hung: true,
        end: 0.6,
        steps: 800,
        rows: 40,
    };
    let [balls, mean] = found(&frame, &motions, &BOTH).try_into().unwrap();
    assert!(mean.attitude > balls.attitude, "{mean:?}");
    assert!(balls.attitude < 1e-4 && balls.center < 1e-4 && balls.elastic < 0.02, "{balls:?}");
}

/// Independent reference: the nonlinear finite elements of this crate on the joined mesh. Four bars around a square, a loop, which
/// shears and tumbles.
#[test]
#[ignore = "minutes: just nonlinear"]
fn a_rhombus_moves_as_the_joined_mesh() {
    let frame = BarFrame::rhombus(SIZE, [6, 2]);
    // The square shears: lying bars keep their direction, upright ones turn, seen from its middle; and all tumble.
    let (shear, omega) = (Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.6, 0.8, 0.4));
    let middle = Vector3::new(0.5, 0.0, 0.5);
    let velocities = frame.bars.iter().map(|bar| {
        let [length, height] = if bar.upright { [SIZE[2], SIZE[0]] } else { [SIZE[0], SIZE[2]] };
        let center = Vector3::from(bar.at) + Vector3::new(0.5 * length, 0.0, 0.5 * height) - middle;
        // The hinge lines move by v = shear × (0, 0, z), and a bar as its two lines do.
        let own = if bar.upright { shear } else { Vector3::zeros() };
        let line = if bar.upright {
            // Its lines are at z = 0 and 1, x of the square's side.
            own.cross(&Vector3::new(center.x - 0.5 * center.x.signum(), 0.0, center.z))
        } else {
            shear.cross(&Vector3::new(0.0, 0.0, 0.5 * center.z.signum()))
        };
        [line + omega.cross(&center), own + omega]
    });
    let motions = Motions {
        material: material(SOFT),
        velocities: velocities.collect(),
        gravity: 0.0,
        hung: false,
        end: 0.5,
        steps: 500,
        rows: 25,
    };
    let [balls, mean] = found(&frame, &motions, &BOTH).try_into().unwrap();
    assert!(mean.attitude > balls.attitude, "{mean:?}");
    assert!(balls.attitude < 1e-4 && balls.center < 1e-4 && balls.elastic < 0.02, "{balls:?}");
}
