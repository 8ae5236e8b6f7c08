//! A rod that is pinned beside its axis, so that the spin bends it.

use nalgebra::Vector3;
use verification::nonlinear::{NodalState, Solid, SolidMotion, bodies, cases};

/// Independent reference: the nonlinear finite elements of this crate. The centrifugal field of a body that is pinned
/// at a corner bends it, and its static response stretches it besides. With static shapes, stiffening about that
/// answer coupled bending to stretching, and the rod was far too soft.
#[test]
fn a_rod_that_is_pinned_at_a_corner_swings_as_the_whole_mesh_does() {
    let (young_modulus, end, steps) = (1e8, 0.4, 800);
    let material = bodies::soft(young_modulus);
    let mesh = bodies::mesh("rod").unwrap();
    let positions: Vec<Vector3<f64>> = mesh.positions().iter().map(|x| Vector3::from(*x)).collect();
    let corner = *positions.iter().min_by(|a, b| (a.x + a.y + a.z).total_cmp(&(b.x + b.y + b.z))).unwrap();
    let tip = positions.iter().position(|x| (x - Vector3::x()).norm() < 1e-9).unwrap();
    let (omega, gravity) = (Vector3::new(0.0, 0.0, 2.0), Vector3::new(0.0, -0.3, -1.0));

    let solid = Solid::new(mesh, material, |x| (x - corner).norm() < 1e-9).unwrap();
    let weight = solid.momentum(&gravity.as_slice().repeat(positions.len()));
    let v: Vec<f64> = positions.iter().flat_map(|x| <[f64; 3]>::from(omega.cross(&(x - corner)))).collect();
    let start = NodalState { time: 0.0, u: vec![0.0; solid.dofs()], v };
    let mut motion = SolidMotion::new(&solid, start, end / f64::from(steps), |_, _| weight.clone());
    let mut expected = vec![Vector3::zeros()];
    for _ in 0..steps {
        motion.advance().unwrap();
        expected.push(Vector3::from_column_slice(&motion.state.u[3 * tip..3 * tip + 3]));
    }
    let small = "[effects]\nlarge_deflection = false\nrefuse = false";
    for (flexible, effects, tolerance) in [(8, "", 0.02), (20, "", 0.015), (20, small, 0.035)] {
        let text = format!(
            "[modes]\nflexible = {flexible}\n{effects}\n[[constraints]]\nkind = \"pin\"\nat = {:?}\n\
             [[loads]]\nkind = \"gravity\"\ndirection = {:?}\namplitude = {}\n[initial]\nangular_velocity = {:?}\n\
             [output]\nevery = 4\npoints = {{ tip = [1.0, 0.0, 0.0] }}\n[time]\nend = {end:e}\nstep = {:e}\n",
            corner.as_slice(),
            gravity.as_slice(),
            gravity.norm(),
            omega.as_slice(),
            end / f64::from(4 * steps)
        );
        let (scene, model) = cases::built("rod", material, &text).unwrap();
        let rows = cases::rows(&scene, &model).unwrap();
        assert_eq!(rows.len(), expected.len());
        let peak = rows.iter().map(|row| row.points[0].elastic_displacement_body.norm()).fold(0.0, f64::max);
        let off =
            rows.iter().zip(&expected).map(|(row, u)| (row.points[0].displacement - u).norm()).fold(0.0, f64::max);
        println!("{flexible} modes {effects:?}: off by {:.5} of the peak of {peak:.5}", off / peak);
        assert!(peak > 1e-3 && off < tolerance * peak, "{flexible} {effects:?}: {off} {peak}");
    }
}
