//! Linearised equations of bodies that bend far, in joints: against nonlinear finite elements, and against the equations of the run.

use dynamics::{CommonSpin, MotionState, Observation, SteadyState, System, SystemMotion};
use nalgebra::Vector3;
use verification::systems::run::built;

use crate::bent::{MATERIAL, SIZE, UNITS, at, body, solid, tip, with_bar};

fn motion(directory: &std::path::Path, text: &str) -> SystemMotion {
    let built = built(directory, &format!("{UNITS}{text}[time]\nend = 1.0\ntolerance = 1e-6\n")).unwrap();
    let mut motion = SystemMotion::new(built.tied.system.clone(), &built.tied.states).unwrap();
    motion.assemble().unwrap();
    motion
}

/// Independent reference: vibrations about the rest of the nonlinear finite elements of this crate, with the nodes of one end held, by the
/// tangent there.
#[test]
fn a_bent_bar_in_a_joint_vibrates_as_the_clamped_mesh() {
    let directory = with_bar();
    let clamped = solid(MATERIAL.young_modulus, |x| x.x < 1e-9);
    let node = at(&clamped, &tip());
    let bending = MATERIAL.young_modulus * SIZE[1] * SIZE[2].powi(3) / 12.0;
    let shapes: Vec<Vec<f64>> = (0..10)
        .map(|k| {
            let of_node = |x: &[f64; 3]| {
                let along = x[0] * x[0] * (1.0 + f64::from(k / 2) * x[0]).cos();
                if k % 2 == 0 { [0.0, 0.0, along] } else { [0.0, along, 0.1 * x[1] * along] }
            };
            clamped.mesh().positions().iter().flat_map(of_node).collect()
        })
        .collect();
    let (mut worst, mut of_small): (f64, f64) = (0.0, 0.0);
    for deflection in [0.0, 0.1, 0.2] {
        let force = 3.0 * bending * deflection;
        let mut load = vec![0.0; clamped.dofs()];
        load[3 * node + 2] = -force;
        let u = clamped.at_rest(8, 0.0, |_| load.clone()).unwrap();
        let expected = clamped.frequencies_at_rest(&u, &shapes).unwrap();
        let rest = format!(
            "markers = {{ root = {{ box = [[-1e-6, -1, -1], [1e-6, 1, 1]] }} }}\n\
             loads = [{{ kind = 'force', at = {:?}, direction = [0, 0, -1], amplitude = {force:e} }}]\n",
            tip().as_slice()
        );
        for modes in ["flexible = 16, large = [1, 3], following = 7", "flexible = 16"] {
            let text = body("bar", MATERIAL.young_modulus, modes, &rest)
                + "[[joints]]\nkind = 'fixed'\nbetween = ['ground', 'bar.root']\n";
            let motion = motion(directory.path(), &text);
            let linear = motion.steady_state(&CommonSpin::REST).unwrap().linear;
            let found = linear.vibrations().unwrap().modes;
            for k in 0..4 {
                let off = found[k].circular_frequency() / expected[k] - 1.0;
                println!(
                    "{deflection}, {modes}: {:.4} instead of {:.4} rad/s: {off:+.2e}",
                    found[k].circular_frequency(),
                    expected[k]
                );
                let largest = if modes.contains("large") { &mut worst } else { &mut of_small };
                *largest = largest.max(off.abs());
            }
        }
    }
    assert!(worst < 0.02 && of_small > 3.0 * worst, "{worst} {of_small}");
}
