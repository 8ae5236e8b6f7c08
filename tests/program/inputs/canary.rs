//! Nothing of a file that another file names is shown: a scene from elsewhere may name any file of the user's.

use std::fs;

use crate::program::flexframe;

const CANARY: &str = "kanarie";
/// Contents of a file with a secret: no table, a table of words, a line of names, TOML of other keys and values.
const SECRETS: [&str; 7] = [
    "kanarie:kanarie:1\nkanarie:1",
    "kanarie = \"kanarie\"\n",
    "kanarie",
    "frequency,kanarie\n1,2\n",
    "frequency,damping\n1,kanarie\nkanarie,1\n",
    "kanarie = 'kanarie'\n",
    "[body.kanarie]\nkanarie = 1\n[body]\nmesh = 3\nmaterial = 'kanarie'\n",
];
/// Keys of a scene with the path of a file.
const KEYS: [&str; 13] = [
    "[body]\nmesh = 'SECRET.msh'\n",
    "[body]\nmesh = 'SECRET.bdf'\n",
    "[body]\nmesh = 'SECRET.inp'\n",
    "[body]\nmesh = 'SECRET.unv'\n",
    "[body]\nmesh = 'bar.msh'\n[modes]\nmeasured = 'SECRET.csv'\n",
    "[body]\nmatrices = { mass = 'SECRET.mtx', stiffness = 'SECRET.mtx', nodes = 'SECRET.csv' }\n",
    "[body]\nmatrices = { mass = 'SECRET.mtx', stiffness = 'SECRET.mtx', nodes = 'SECRET.inp' }\n",
    "[body]\nmatrices = { mass = 'SECRET.mtx', stiffness = 'SECRET.mtx', nodes = 'nodes.csv' }\n",
    "[body]\nmatrices = { mass = 'SECRET.csv', stiffness = 'SECRET.mtx', nodes = 'nodes.csv', dofs = 'SECRET.csv' }\n",
    "[body]\nfile = 'SECRET.h5'\n",
    "[body]\nmesh = 'bar.msh'\n[[loads]]\nkind = 'force'\nat = [0, 0, 0]\ndirection = [1, 0, 0]\namplitude = 1\n\
     history = { kind = 'table', file = 'SECRET.csv' }\n",
    "[body]\nmesh = 'bar.inp'\n",
    "[body]\nmesh = 'bar.geo'\n",
];

#[test]
fn no_line_of_a_file_that_another_file_names_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mesh = crate::program::root().join("crates/model/tests/data/bar.msh");
    fs::copy(mesh, path("bar.msh")).unwrap();
    fs::write(path("nodes.csv"), "1, 0, 0, 0\n2, 1, 0, 0\n").unwrap();
    fs::write(path("bar.geo"), "Include \"secret.csv\";\n").unwrap();
    fs::write(path("bar.inp"), "*INCLUDE, INPUT=secret.csv\n").unwrap();
    for secret in SECRETS {
        for ending in ["csv", "mtx", "msh", "inp", "bdf", "unv", "toml", "h5"] {
            fs::write(path(&format!("secret.{ending}")), secret).unwrap();
        }
        for key in KEYS {
            let material = if key.contains("mesh") {
                "[body.material]\nyoung_modulus = 7e4\npoisson_ratio = 0.3\ndensity = 2.7e-9\n"
            } else {
                ""
            };
            let head = "title = 't'\nunits = { length = 'mm', mass = 'Mg', time = 's' }\n";
            let named = key.replace("SECRET", "secret");
            fs::write(path("scene.toml"), format!("{head}{named}{material}[time]\nend = 1\nstep = 0.1\n")).unwrap();
            quiet(&["modes", &path("scene.toml"), "--no-cache"]);
        }
        fs::write(path("sweep.toml"), "scene = 'secret.toml'\n[parameters]\na = [1]\n[results]\nf = 'frequencies'\n")
            .unwrap();
        quiet(&["sweep", &path("sweep.toml"), "-o", &path("table.csv")]);
    }
}

/// Runs a command that fails, in words and in JSON, and looks for the secret.
#[track_caller]
fn quiet(arguments: &[&str]) {
    for more in [&[][..], &["--json"]] {
        let output = flexframe(&[arguments, more].concat());
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8_lossy(&said);
        assert!(!output.status.success() && !said.contains(CANARY), "{arguments:?}: {said}");
    }
}
