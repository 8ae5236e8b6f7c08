//! A rigid body without a mesh.

use scene::{Body, BodySource, Flexible, RigidBody};

use crate::common::EXAMPLE;

const MESH: &str = "mesh = \"../meshes/plate.msh\"";
const MATERIAL: &str = "material = { young_modulus = 70000.0, poisson_ratio = 0.33, density = 2.7e-9 }";
const POINT_MASSES: &str = "point_masses = [ { at = [-500.0, -25.0, 0.0], mass = 0.001 } ]";
const TOP: &str = "mass = 20, center_of_mass = [0, 0, 1], inertia = [[21, 0, 0], [0, 21, 0], [0, 0, 2]], \
                   about = [0, 0, 0]";

/// The example with a rigid body of these keys.
fn text(keys: &str) -> String {
    EXAMPLE.replace(crate::parts::section("[body]", "[frame]"), &format!("[body]\nrigid = {{ {keys} }}\n\n"))
}

fn rigid(keys: &str) -> RigidBody {
    match Body::parse(&text(keys), "a.toml").unwrap_or_else(|error| panic!("{error}")).source {
        BodySource::Rigid(body) => body,
        body => panic!("{body:?}"),
    }
}

/// Closed form: Steiner's theorem.
#[test]
fn inertia_is_moved_to_the_centre_of_mass() {
    // 20 (0, 0, 1): 21 - 20 = 1 across, 2 along.
    let top = rigid(TOP);
    let inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]];
    assert_eq!(top, RigidBody { mass: 20.0, center_of_mass: [0.0, 0.0, 1.0], inertia });
    // Given about the centre of mass itself it stays as it is.
    let central = rigid("mass = 20, center_of_mass = [0, 0, 1], inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 2]]");
    assert_eq!(central, top);
    // Two masses 3 and 5 at known points and a ball of 2 on the second: moments about the origin by their sums.
    let masses = [(3.0, [1.0, -2.0, 0.5]), (5.0, [-0.4, 0.7, 2.0])];
    let mass: f64 = masses.iter().map(|(m, _)| m).sum();
    let center = [0, 1, 2].map(|i| masses.iter().map(|(m, x)| m * x[i]).sum::<f64>() / mass);
    let about = |from: [f64; 3]| {
        [0, 1, 2].map(|i| {
            [0, 1, 2].map(|j| {
                let point = |(m, x): &(f64, [f64; 3])| {
                    let d = [0, 1, 2].map(|k| x[k] - from[k]);
                    let square: f64 = d.iter().map(|c| c * c).sum();
                    m * (if i == j { square } else { 0.0 } - d[i] * d[j])
                };
                masses.iter().map(point).sum::<f64>() + if i == j { 2.0 } else { 0.0 }
            })
        })
    };
    let from = [0.3, -0.1, 4.0];
    let body =
        rigid(&format!("mass = {mass}, center_of_mass = {center:?}, inertia = {:?}, about = {from:?}", about(from)));
    for (found, wanted) in body.inertia.as_flattened().iter().zip(about(center).as_flattened()) {
        // 8.9e-15 measured
        assert!((found - wanted).abs() < 1e-13, "{:?}", body.inertia);
    }
    assert_eq!(body.inertia[0][1], body.inertia[1][0]);
}

#[test]
fn it_needs_no_modes_and_takes_none() {
    let body = Body::parse(&text(TOP), "a.toml").unwrap();
    assert_eq!(body.modes.flexible, Flexible::Count(0));
    let modes = |lines: &str| text(TOP).replace("[frame]", &format!("[modes]\n{lines}\n[frame]"));
    let given = Body::parse(&modes("flexible = 0"), "a.toml").unwrap();
    assert_eq!((&given.modes, &given.source), (&body.modes, &body.source));
    for lines in ["flexible = 3", "flexible = \"auto\""] {
        let message = Body::parse(&modes(lines), "a.toml").unwrap_err().to_string();
        let words = "`modes.flexible`: found flexible modes of a rigid body, expected 0, since `rigid`";
        assert!(message.contains(words) && message.contains("= remove [modes], or give `mesh`"), "{message}");
    }
    let message = Body::parse(&modes("flexible = 0\nstatic_correction = true"), "a.toml").unwrap_err().to_string();
    assert!(message.contains("`modes.static_correction`: found a static correction of a body without"), "{message}");
}

#[test]
fn it_has_no_stress() {
    for key in ["stress", "peak_stress"] {
        let message = Body::parse(&format!("{}\n{key} = true\n", text(TOP)), "a.toml").unwrap_err().to_string();
        assert!(message.contains(&format!("`output.{key}`: found true, expected a body with a mesh")), "{message}");
    }
}

#[test]
fn what_is_no_rigid_body() {
    for (keys, key, words) in [
        (TOP.replace("20", "0"), "mass", "found 0, expected a number greater than 0"),
        (TOP.replace("mass = 20, ", ""), "mass", "`mass` is missing"),
        (TOP.replace("center_of_mass = [0, 0, 1], ", ""), "center_of_mass", "`center_of_mass` is missing"),
        (TOP.replace("center_of", "centre_of"), "centre_of_mass", "did you mean `center_of_mass`?"),
        (TOP.replace("[0, 0, 2]]", "[0, 0]]"), "inertia[2]", "found a list of 2 entries, expected a list of 3 numbers"),
        (
            TOP.replace("[[21, 0, 0]", "[[21, 0.5, 0]"),
            "inertia",
            "whose entries across the diagonal differ by up to 0.5",
        ),
        (TOP.replace("about = [0, 0, 0]", "about = [0, 0, 3]"), "inertia", "principal moments -5.9"),
        (TOP.replace("[0, 0, 2]", "[0, 0, 2.1]"), "inertia", "found the principal moments 1.000000e0, 1.000000e0, 2.1"),
        (TOP.replace("[0, 0, 2]", "[0, 0, 0]"), "inertia", "positive principal moments of inertia, none above the sum"),
        (TOP.replace("mass = 20", "mass = 1e308"), "inertia", "principal moments"),
        (TOP.replace("[0, 0, 1]", "[0, 0, 1e200]"), "inertia", "a tensor with the largest entry"),
    ] {
        let message = Body::parse(&text(&keys), "a.toml").unwrap_err().to_string();
        assert!(message.contains(&format!("`body.rigid.{key}`: ")) && message.contains(words), "{words}: {message}");
    }
    // A point mass has to be tied.
    let alone = TOP.replace("[[21, 0, 0], [0, 21, 0], [0, 0, 2]]", "[[0, 0, 0], [0, 0, 0], [0, 0, 0]]");
    let alone = alone.replace(", about = [0, 0, 0]", "");
    let message = Body::parse(&text(&alone), "a.toml").unwrap_err().to_string();
    assert!(message.contains("zeros for a body that neither a joint nor a spring ties"), "{message}");
    // A flat body, its moments written with four digits.
    rigid("mass = 1, center_of_mass = [0, 0, 0], inertia = [[1.333, 0, 0], [0, 1.333, 0], [0, 0, 2.667]]");
}

#[test]
fn mesh_or_rigid() {
    let rigid = format!("rigid = {{ {TOP} }}");
    for (from, key) in [(MESH, "mesh"), (MATERIAL, "material"), (POINT_MASSES, "point_masses")] {
        let others = [MESH, MATERIAL, POINT_MASSES].into_iter().filter(|other| *other != from);
        let text = others.fold(EXAMPLE.to_owned(), |text, other| text.replace(other, "# "));
        let text = text.replace("[modes]\nflexible = 10", &format!("{rigid}\n[modes]\nflexible = 0"));
        let message = Body::parse(&text, "a.toml").unwrap_err().to_string();
        let words = format!("`body.{key}`: found both `rigid` and `{key}`, expected mass properties, or a mesh");
        assert!(message.contains(&words), "{message}");
    }
    // A material is one of a mesh; without it the body has nothing of its own.
    crate::common::refused(MESH, "#", "[body]", "body.mesh", &["`mesh` is missing"]);
    let text = EXAMPLE.replace(MESH, "# ").replace(MATERIAL, "# ");
    let message = Body::parse(&text, "a.toml").unwrap_err().to_string();
    for words in
        ["a body with nothing of its own", "one of `mesh`, `rigid`, `file` and `matrices`", "`flexframe reduce`"]
    {
        assert!(message.contains(words), "{message}");
    }
}
