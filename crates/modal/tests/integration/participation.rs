//! The mass that each mode carries in motions of the base.

use faer::Mat;
use modal::Support;
use nalgebra::{Matrix3, Vector3};
use reduced_body::{Participation, RigidMotion};

use crate::beam::Beam;
use crate::held::supports;

/// Participation in the modes of a clamped beam along x, about its root.
fn cantilever(beam: &Beam, count: usize) -> Participation {
    let model = beam.model();
    let root = Vector3::from(model.positions[0]);
    let modes = model.modes(&Support::new(RigidMotion::clamp(root), vec![0]), count);
    modes.reduced(model.mass.as_ref(), &model.positions).unwrap().participation(&root)
}

/// Closed form: Euler–Bernoulli cantilever with the roots β of cos β cosh β = −1: effective mass (2σ/β)² m = 0.6131, 0.1883, 0.0647 of
/// it, effective inertia 4/β⁴ m L² about the root; torsion and stretch 8/π² of J and m first.
#[test]
fn a_cantilever_carries_what_the_beam_theory_says() {
    let beam = Beam { turn: Matrix3::identity(), stiffness: [3e5, 4e3, 90.0, 300.0], elements: 24, ..Beam::default() };
    let mass = beam.mass[0] * beam.length;
    let Participation { whole, rigid, factors, .. } = cantilever(&beam, 24);
    assert_eq!(rigid, [0.0; 6]);
    assert!(
        (whole[0] / mass - 1.0).abs() < 1e-12 && (whole[5] / (mass * beam.length.powi(2) / 3.0) - 1.0).abs() < 1e-12
    );
    // The largest parts of a motion of the base come with its lowest modes.
    let largest = |i: usize| {
        let mut parts: Vec<f64> = factors.iter().map(|factors| factors[i].powi(2) / whole[i]).collect();
        parts.sort_by(|a, b| b.total_cmp(a));
        parts
    };
    for (translation, rotation) in [(1, 5), (2, 4)] {
        for (k, [part, beta]) in
            [[0.613_08, 1.875_104], [0.188_30, 4.694_091], [0.064_73, 7.854_757]].into_iter().enumerate()
        {
            let (found, of_rotation) = (largest(translation)[k], largest(rotation)[k]);
            assert!((found - part).abs() < 2e-5, "{translation} {k}: {found} {part}");
            assert!((of_rotation - 12.0 / beta.powi(4)).abs() < 2e-5, "{rotation} {k}: {of_rotation}");
        }
    }
    let torsion = 8.0 / std::f64::consts::PI.powi(2);
    assert!((largest(3)[0] - torsion).abs() < 1e-3 && (largest(0)[0] - torsion).abs() < 1e-3, "{:?}", largest(3));
}

/// Conserved: modes and rigid motions share the mass out; all of them carry all of it but for that of the node that is held.
#[test]
fn all_modes_together_miss_the_mass_at_the_support() {
    let beam = Beam { elements: 6, ..Beam::default() };
    let few = cantilever(&beam, 3).missed();
    let all = cantilever(&beam, 36).missed();
    assert!(few.iter().zip(&all).all(|(few, all)| few >= all && (0.0..0.06).contains(all)), "{few:?} {all:?}");
    assert!(all.iter().skip(3).all(|missed| *missed < 0.06), "{all:?}");
}

/// Independent reference: Ψᵀ M R with the fields R of the motions of the base node by node, for supports that leave motions.
#[test]
fn factors_equal_their_definition_whatever_the_support_leaves() {
    let body = supports::body();
    let about = Vector3::new(4.0, -3.0, 11.0);
    let at = Vector3::from(body.positions[0]);
    let fields = Mat::from_fn(3 * body.positions.len(), 6, |i, motion| {
        let axis = Vector3::ith(motion % 3, 1.0);
        if motion < 3 { axis[i % 3] } else { axis.cross(&(Vector3::from(body.positions[i / 3]) - about))[i % 3] }
    });
    let momenta = body.matrices.mass() * &fields;
    let hinge = Support::new(
        RigidMotion::hinge(at, Vector3::z()),
        supports::nodes(&body.positions, |x| (x - at).xy().norm() < 1e-9),
    );
    for support in [Support::free(), hinge, Support::new(RigidMotion::pin(at), vec![0])] {
        let modes = body.held(&support).modes(5, |_| ()).unwrap();
        let reduced = modes.reduced(body.matrices.mass(), &body.positions).unwrap();
        let found = reduced.participation(&about);
        let expected = modes.shapes.transpose() * &momenta;
        let of_rigid = modes.rigid.shapes.transpose() * &momenta;
        for i in 0..6 {
            let whole = fields.col(i).transpose() * momenta.col(i);
            let rigid: f64 = of_rigid.col(i).iter().map(|factor| factor * factor).sum();
            assert!((found.whole[i] / whole - 1.0).abs() < 1e-10);
            assert!((found.rigid[i] - rigid).abs() < 1e-10 * whole, "{i}: {} {rigid}", found.rigid[i]);
            for k in 0..5 {
                let difference = found.factors[k][i].abs() - expected[(k, i)].abs();
                assert!(
                    difference.abs() < 1e-8 * whole.sqrt(),
                    "{i} {k}: {} {}",
                    found.factors[k][i],
                    expected[(k, i)]
                );
            }
        }
    }
}
