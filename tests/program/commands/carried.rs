//! `flexframe modes`: what each mode carries, where its strain energy is, the error of the mesh, and MAC.

use flexframe::columns::COLUMNS;
use flexframe::results::Results;
use serde_json::Value;

use crate::program::{done, flexframe, json, numbers, root};

#[track_caller]
fn modes(arguments: &[&str]) -> Value {
    json(&[&["modes"], arguments].concat())
}

/// Independent reference: CalculiX 2.20, the mesh of `meshes/rotating_bar.msh` as C3D10 with its root held, `*FREQUENCY`: its table
/// "EFFECTIVE MODAL MASS". Pairs of modes of bending are summed, since their plane is that of rounding. CalculiX leaves out the mass that
/// couples the base with the nodes beside it.
#[test]
fn effective_masses_are_those_of_calculix() {
    let report = modes(&["examples/rotating_bar.toml"]);
    let carried = &report["carried"];
    assert_eq!(carried["point"], "the support");
    let masses: Vec<Vec<f64>> = carried["effective_masses"].as_array().unwrap().iter().map(numbers).collect();
    let pairs = [
        (0, 1, 0.333_789_2e-4 + 0.611_013_2e-7, 0.131_793_0e-2 + 0.719_975_8),
        (2, 3, 0.103_136_3e-4 + 0.125_381_4e-9, 0.222_895_8e-6 + 0.018_360_07),
        (4, 5, 0.355_921_0e-5 + 0.689_457_7e-9, 0.451_690_8e-6 + 0.233_574_8e-2),
    ];
    for (j, k, along_y, about_y) in pairs {
        let sum = |i: usize| masses[j][i] + masses[k][i];
        assert!((sum(1) / along_y - 1.0).abs() < 4e-4, "{j}: {} {along_y}", sum(1));
        assert!((sum(4) / about_y - 1.0).abs() < 4e-4, "{j}: {} {about_y}", sum(4));
    }
    assert!((masses[7][0] / 0.442_256_4e-4 - 1.0).abs() < 4e-4 && (masses[6][3] / 0.736_322_2e-3 - 1.0).abs() < 4e-4);
    // What is missed and what is carried make the whole.
    let (missed, cumulated) = (numbers(&carried["missed"]), numbers(&carried["cumulated"][11]));
    assert!(missed.iter().zip(&cumulated).all(|(missed, carried)| (missed + carried - 1.0).abs() < 1e-12));
    let text = done(&["modes", "examples/rotating_bar.toml"]);
    assert!(text.contains("modes that are kept miss of the mass 18.9 % x, 7.9 % y, 7.9 % z"), "{text}");
}

/// Closed form: Steiner's theorem for the whole about the tip; the factor of a rotation is moved by L times that of the translation.
#[test]
fn the_base_turns_about_the_point_that_is_asked_for() {
    let about_tip = modes(&["examples/rotating_bar.toml", "--about=202.07,0,0"]);
    let about_root = modes(&["examples/rotating_bar.toml"]);
    assert_eq!(about_tip["carried"]["point"], "the point asked for");
    let whole = |report: &Value| numbers(&report["carried"]["whole"])[5];
    assert!((whole(&about_tip) / whole(&about_root) - 1.0).abs() < 1e-9);
    let factors = |report: &Value| numbers(&report["carried"]["factors"][0]);
    let (tip, root) = (factors(&about_tip), factors(&about_root));
    let (sign, length) = ((tip[1] * root[1]).signum(), 202.07);
    assert!((tip[5] * sign - (root[5] - length * root[1])).abs() < 1e-9 * root[5].abs());
}

/// Independent reference: another implementation: a bar that a joint fixes to the ground by a rigid face, turned and put elsewhere, carries what the bar carries
/// that is clamped at this face; Steiner's theorem about another point.
#[test]
fn a_bar_in_a_joint_carries_what_a_clamped_one_does() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = root().join("meshes/half_bar.msh");
    let head = "title = 'bar'\nunits = { length = 'mm', mass = 'Mg', time = 's' }\n";
    let body = format!(
        "mesh = '{}'\nmaterial = {{ young_modulus = 7e4, poisson_ratio = 0.33, density = 2.7e-9 }}\n",
        mesh.display()
    );
    let time = "[time]\nend = 1e-3\ntolerance = 1e-6\n";
    let clamped =
        format!("{head}[body]\n{body}[modes]\nflexible = 20\n[[constraints]]\nkind = 'clamp'\ngroup = 'left'\n{time}");
    // Its y axis is the global z axis, its z axis the global −y axis.
    let jointed = format!(
        "{head}[bodies.bar]\n{body}modes = {{ flexible = 20 }}\nmarkers = {{ root = {{ group = 'left', tie = 'rigid' }} }}\n\
         initial = {{ position = [30, 40, -50], attitude = [0.7071067811865476, 0.7071067811865476, 0, 0] }}\n\
         [[joints]]\nkind = 'fixed'\nbetween = ['ground', 'bar.root']\n{time}"
    );
    let scene = |name: &str, text: String| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let (clamped, jointed) = (scene("clamped.toml", clamped), scene("jointed.toml", jointed));
    let of_body = modes(&[&clamped])["carried"].clone();
    let of_system = modes(&[&jointed])["systems"][0]["carried"].clone();
    assert_eq!(of_system["point"], "the first place on the ground");
    assert!((numbers(&of_system["about"])[1] - 40.0).abs() < 1e-9, "{of_system}");
    let masses = |carried: &Value, k: usize| numbers(&carried["effective_masses"][k]);
    let whole = numbers(&of_body["whole"]);
    let mut worst = 0.0_f64;
    for k in 0..8 {
        let (body, system) = (masses(&of_body, k), masses(&of_system, k));
        // y and z in the place of each other, and squares of the factors.
        for (i, j) in [(0, 0), (1, 2), (2, 1), (3, 3), (4, 5), (5, 4)] {
            worst = worst.max((body[i] / whole[i] - system[j] / whole[i]).abs());
        }
    }
    println!("{worst:e}");
    assert!(worst < 2e-5, "{worst:e}");
    // Of a beam: 0.6131 of the mass in the first pair.
    let pair: f64 = (0..2).map(|k| masses(&of_system, k)[1] / whole[0]).sum();
    assert!((pair - 0.6131).abs() < 5e-3, "{pair}");
    let about = modes(&[&jointed, "--about=30,40,50"])["systems"][0]["carried"].clone();
    assert_eq!(about["point"], "the point asked for");
    // 100 along z from the bar's axis.
    let (near, far) = (numbers(&of_system["whole"])[3], numbers(&about["whole"])[3]);
    assert!(((far - near) / (whole[0] * 1e4) - 1.0).abs() < 1e-9, "{near} {far}");
    let text = done(&["modes", &jointed]);
    assert!(text.contains("about the first place on the ground at [30, 40, -50]"), "{text}");
}

/// Conserved: the parts of the energy sum to one; the stiffer half of a bar that bends has less of it.
#[test]
fn strain_energy_is_shared_among_groups() {
    let folder = tempfile::tempdir().unwrap();
    let geometry = folder.path().join("two.geo");
    let text = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 100, 10, 10};\nBox(2) = {100, 0, 0, 100, 10, 10};\n\
                BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }\nPhysical Volume(\"soft\") = {1};\n\
                Physical Volume(\"stiff\") = {2};\nMesh.MeshSizeMin = 10;\nMesh.MeshSizeMax = 10;\n";
    std::fs::write(&geometry, text).unwrap();
    let scene = folder.path().join("two.toml");
    let text = "title = \"Two\"\nunits = { length = \"mm\", mass = \"Mg\", time = \"s\" }\n[body]\nmesh = \"two.geo\"\n\
                materials = { soft = { young_modulus = 7e4, poisson_ratio = 0.3, density = 2.7e-9 }, stiff = { young_modulus = 7e7, \
                poisson_ratio = 0.3, density = 2.7e-9 } }\n[modes]\nflexible = 3\n[time]\nend = 1e-3\ntolerance = 1e-6\n";
    std::fs::write(&scene, text).unwrap();
    let report = modes(&[scene.to_str().unwrap()]);
    let energy = &report["strain_energy"];
    for table in ["by_material", "by_group"] {
        let parts: Vec<Vec<f64>> = energy[table].as_array().unwrap().iter().map(|row| numbers(&row["parts"])).collect();
        for k in 0..3 {
            assert!((parts[0][k] + parts[1][k] - 1.0).abs() < 1e-12, "{table} {parts:?}");
            assert!(parts[1][k] < 0.05 && parts[1][k] > 0.0, "{table} {parts:?}");
        }
    }
    let text = done(&["modes", scene.to_str().unwrap()]);
    assert!(text.contains("strain energy by material, %") && text.contains("the body is free"), "{text}");
}

/// Conserved: where a force has bent a body the mesh is as wrong as it was before, but for what the bend changes. The turning of the bent
/// body, counted as strain, made the error of the second mode 25 times smaller.
#[test]
fn a_bent_body_has_the_error_of_its_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = crate::program::root().join("crates/verification/meshes/l.msh");
    let scene = folder.path().join("bracket.toml");
    let text = format!(
        "title = \"Bracket\"\nunits = {{ length = \"m\", mass = \"kg\", time = \"s\" }}\n[body]\nmesh = {mesh:?}\n\
         material = {{ young_modulus = 7e10, poisson_ratio = 0.3, density = 2700.0 }}\n[modes]\nflexible = 4\n[[constraints]]\n\
         kind = \"clamp\"\ngroup = \"end\"\n[[loads]]\nkind = \"force\"\nat = [1.0, 0.05, 0.05]\ndirection = [0.0, 1.0, 0.0]\n\
         amplitude = 6e4\n[time]\nend = 1e-3\ntolerance = 1e-4\n"
    );
    std::fs::write(&scene, text).unwrap();
    let errors = |set: &[&str]| {
        let report = modes(&[&[scene.to_str().unwrap()], set].concat());
        numbers(&report["strain_energy"]["mesh_errors"])
    };
    let straight = errors(&[]);
    let bent = errors(&["--set", "modes.about=\"loads\""]);
    for (bent, straight) in bent.iter().zip(&straight) {
        assert!((0.5..2.0).contains(&(bent / straight)), "{bent} {straight}");
    }
}

/// Conserved: the modes of two meshes of a plate are the same ones, and of the same mesh to rounding.
#[test]
fn shapes_of_two_meshes_are_the_same() {
    for (other, limit) in [("meshes/plate.msh", 1e-10), ("meshes/plate_lc12.msh", 0.02)] {
        let mac = &modes(&["examples/plate.toml", "-n", "5", "--mac", other])["mac"];
        assert_eq!(numbers(&mac["nearest"]), [1.0, 2.0, 3.0, 4.0, 5.0]);
        let rows: Vec<Vec<f64>> = mac["mac"].as_array().unwrap().iter().map(numbers).collect();
        for (k, row) in rows.iter().enumerate() {
            assert!((row[k] - 1.0).abs() < limit, "{other} {rows:?}");
        }
    }
}

/// Conserved: natural modes are those of the body, whatever bends it far in a run. Of a run the static answer to the moment takes the place
/// of one.
#[test]
fn modes_of_a_body_that_a_moment_bends_far_are_natural_ones() {
    let folder = tempfile::tempdir().unwrap();
    let found = [
        "",
        "[[loads]]\nkind = \"moment\"\nat = [200.0, 0.0, 0.0]\ndirection = [0.0, 0.0, 1.0]\namplitude = 1e4\n\
         history = { kind = \"constant\" }\n",
    ]
    .map(|load| {
        let scene = folder.path().join("bent.toml");
        let mesh = crate::program::root().join("meshes/rotating_bar.msh");
        let text = format!(
            "title = \"Bent\"\nunits = {{ length = \"mm\", mass = \"Mg\", time = \"s\" }}\n[body]\nmesh = {mesh:?}\n\
             material = {{ young_modulus = 7e4, poisson_ratio = 0.3, density = 2.7e-9 }}\n[modes]\nflexible = 6\nlarge = 2\n\
             [time]\nend = 1e-3\nstep = 1e-5\n[[constraints]]\nkind = \"clamp\"\ngroup = \"root\"\n{load}"
        );
        std::fs::write(&scene, text).unwrap();
        let report = modes(&[scene.to_str().unwrap()]);
        (numbers(&report["body"]["natural_frequencies"]), report["body"]["kinds"].clone())
    });
    assert_eq!(found[0], found[1]);
    // A run names its coordinates.
    let out = folder.path().join("out");
    let words = done(&["run", folder.path().join("bent.toml").to_str().unwrap(), "-o", out.to_str().unwrap()]);
    assert!(words.contains(" and 1 static answer and 4 combinations of modes\n"), "{words}");
    let results = Results::open(out.join("bent.h5"), &COLUMNS).unwrap();
    let kinds: Vec<&str> = results.metadata.bodies[0].model.kinds().collect();
    assert_eq!(kinds[..3], ["natural mode", "natural mode", "static answer"]);
    assert!(kinds.len() == 7 && kinds[3..].iter().all(|kind| *kind == "combination of modes"), "{kinds:?}");
    let gltf = folder.path().join("bent.glb");
    done(&["reduce", folder.path().join("bent.toml").to_str().unwrap(), "-o", gltf.to_str().unwrap()]);
    let bytes = std::fs::read(gltf).unwrap();
    assert!(String::from_utf8_lossy(&bytes).contains("\"static answer 3\",\"combination of modes 4\""));
}

#[test]
fn bodies_that_cannot_be_compared_are_refused() {
    let refused = |arguments: &[&str], words: &str| {
        let output = flexframe(&[&["modes"], arguments].concat());
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && message.contains(words), "{message}");
    };
    refused(&["examples/plate.toml", "--mac", "examples/rotating_bar.toml"], "away from a node of this one");
    refused(&["examples/pair.toml", "--mac", "examples/plate.toml"], "a scene of 2 bodies");
    refused(&["examples/plate.toml", "--about", "1,2"], "expected three numbers");
}
