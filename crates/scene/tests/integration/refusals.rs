//! Every refusal names file, line, column and key, says what was found and expected, and help.

use crate::common::{EXAMPLE, refusal, refused};
use scene::{Body, SceneError};

#[test]
fn misspelt_keys() {
    for (from, to, mark, key, near, others) in [
        ("step = 1e-4", "stpe = 1e-4", "stpe", "time.stpe", "step", "`end`, `step`, `tolerance`"),
        ("[time]", "[tiem]", "tiem]", "tiem", "time", "`loads`, `time`, `output`"),
        ("title =", "Title =", "Title", "Title", "title", "`title`, `units`"),
        ("length =", "lenght =", "lenght", "units.lenght", "length", "`length`, `mass`, `time`"),
        ("mesh =", "mehs =", "mehs", "body.mehs", "mesh", "`material`, `materials`"),
        ("density =", "densty =", "densty", "body.material.densty", "density", "`poisson_ratio`"),
        ("mass = 0.001", "mas = 1", "mas = 1", "body.point_masses[0].mas", "mass", "`spread`"),
        ("damping_ratio", "damping", "damping", "modes.damping", "damping_ratio", "`flexible`"),
        ("R = ", "r = ", "r = [", "frame.r", "R", "`R`, `P`, `Q`"),
        (
            "velocity = [0.0, 0.0, 0.0]\nangular",
            "velosity = [0.0, 0.0, 0.0]\nangular",
            "velosity",
            "initial.velosity",
            "velocity",
            "`modal_velocity`",
        ),
        ("amplitude", "amplitud", "amplitud", "loads[0].amplitud", "amplitude", "`kind`, `at`"),
        ("duration", "durration", "durration", "loads[0].history.durration", "duration", "`start`"),
        ("every", "evry", "evry", "output.evry", "every", "`every`, `interval`, `points`"),
    ] {
        let help = format!("rename it to `{near}`");
        let meant = format!("did you mean `{near}`?");
        refused(from, to, mark, key, &["unknown key", &meant, &help, others]);
    }
}

#[test]
fn the_stress_of_no_point() {
    let words = ["found true", "points whose stress is written", "peak_stress = true"];
    refused("points = { P1 = [-500.0, -25.0, 0.0] }", "stress = true", "true", "output.stress", &words);
}

#[test]
fn keys_like_no_other() {
    let words = ["unknown key `gravity`\n", "possible here: `end`, `step`, `tolerance`, `formulation`, `scheme`"];
    refused("scheme = ", "gravity = 9.81\nscheme = ", "gravity", "time.gravity", &words);
    let words = ["unknown key `g r`", "possible here: `length`, `mass`, `time`"];
    refused("units = {", "units = { \"g r\" = 1,", "\"g r\"", "units.\"g r\"", &words);
    let words = ["unknown key `tolerance`", "possible here: `kind`"];
    let scheme = "{ kind = \"rkmk4\", tolerance = 1e-6 }";
    refused("\"exponential\"", scheme, "tolerance", "time.scheme.tolerance", &words);
}

#[test]
fn tables_beside_the_body_and_in_a_body_of_several() {
    for (table, help) in [("modes", "as [modes]"), ("loads", "as [[loads]]")] {
        let body = format!("[body]\n{table} = 1\n");
        let words = [&format!("unknown key `{table}`\n"), "write it beside [body]", help];
        refused("[body]\n", &body, table, &format!("body.{table}"), &words);
    }
    let text = "title = 'two'\nunits = { length = 'm', mass = 'kg', time = 's' }\n[bodies.arm]\nmesh = 'arm.msh'\nspeed = 1\n\
                [time]\nend = 1.0\nstep = 0.1\n";
    let error = scene::Scene::parse(text, "two.toml").unwrap_err().to_string();
    for words in ["`bodies.arm.speed`: unknown key `speed`", "`markers`, `modes`", "`loads`", "`points`"] {
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn misspelt_names() {
    for (from, to, mark, key, near, known) in [
        ("\"force\"", "\"forse\"", "\"forse\"", "loads[0].kind", "force", "`force`"),
        ("\"global\"", "\"globl\"", "\"globl\"", "loads[0].frame", "global", "`global`"),
        (
            "\"half-sine\"",
            "\"half_sine\"",
            "\"half_sine\"",
            "loads[0].history.kind",
            "half-sine",
            "`constant`, `step`, `ramp`, `half-sine`",
        ),
        ("\"exponential\"", "\"papr\"", "\"papr\"", "time.scheme", "paper", "`paper`, `rkmk4`, `exponential`"),
        ("\"exponential\"", "\"rkmk\"", "\"rkmk\"", "time.scheme", "rkmk4", "`paper`, `rkmk4`"),
        (
            "\"conservative\"",
            "\"conservativ\"",
            "\"conservativ\"",
            "time.formulation",
            "conservative",
            "`paper`, `conservative`",
        ),
    ] {
        let meant = format!("did you mean `{near}`?");
        let help = format!("rename it to `{near}` (possible here: {known}");
        refused(from, to, mark, key, &["unknown value", &meant, &help]);
    }
    let words = ["unknown value `rk45`\n", "possible here: `paper`, `rkmk4`"];
    refused("\"exponential\"", "\"rk45\"", "\"rk45\"", "time.scheme", &words);
}

#[test]
fn missing_sections() {
    for (section, next) in [("body", "modes"), ("modes", "frame"), ("time", "output")] {
        let start = EXAMPLE.find(&format!("[{section}]")).unwrap();
        let end = EXAMPLE.find(&format!("[{next}]")).unwrap();
        let (text, error) = refusal(&EXAMPLE[start..end], "");
        let place = error.place().unwrap();
        assert_eq!((place.line, place.key.as_str()), (text.lines().count(), section));
        let message = error.to_string();
        assert!(message.contains(&format!("`{section}` is missing")), "{message}");
        assert!(message.contains(&format!("add it, for example:\n     [{section}]\n")), "{message}");
    }
    let (_, error) = refusal("units =", "# units =");
    assert!(error.to_string().ends_with("units = { length = \"mm\", mass = \"Mg\", time = \"s\" }"));

    for text in ["", "\n\n", "# nothing"] {
        let message = Body::parse(text, "plate.toml").unwrap_err().to_string();
        assert!(message.starts_with("plate.toml:1:"), "{message}");
        assert!(message.contains("`title`: `title` is missing"), "{message}");
    }
}

#[test]
fn missing_keys() {
    for (from, mark, key, example) in [
        ("length = \"mm\", ", "{ mass", "units.length", "length = \"mm\""),
        ("mesh = \"../meshes/plate.msh\"  ", "[body]", "body.mesh", "mesh = \"../meshes/plate.msh\""),
        ("poisson_ratio = 0.33, ", "{ young", "body.material.poisson_ratio", "poisson_ratio = 0.33"),
        ("at = [-500.0, -25.0, 0.0], ", "{ mass = 0.001", "body.point_masses[0].at", "at = ["),
        (", mass = 0.001", "{ at", "body.point_masses[0].mass", "mass = 0.001"),
        ("flexible = 10", "[modes]", "modes.flexible", "flexible = 10"),
        ("Q = [500.0, 25.0, 0.0]", "[frame]", "frame.Q", "Q = [500.0, 25.0, 0.0]"),
        ("kind = \"force\"", "[[loads]]", "loads[0].kind", "kind = \"force\""),
        ("direction = [1.0, 0.0, 1.0] ", "[[loads]]", "loads[0].direction", "direction = ["),
        ("amplitude = 50.0", "[[loads]]", "loads[0].amplitude", "amplitude = 50.0"),
        ("kind = \"half-sine\", ", "{ start", "loads[0].history.kind", "kind = \"half-sine\""),
        (", duration = 0.02", "{ kind", "loads[0].history.duration", "duration = 0.02"),
        ("end = 0.5", "[time]", "time.end", "end = 0.5"),
    ] {
        let name = key.rsplit('.').next().unwrap();
        let missing = format!("`{name}` is missing\n");
        refused(from, "", mark, key, &[&missing, "add it, for example:\n", example]);
    }
}

#[test]
fn neither_or_both_materials() {
    let material = "material = { young_modulus = 70000.0, poisson_ratio = 0.33, density = 2.7e-9 }";
    refused(material, "", "[body]", "body.material", &["`material` is missing", material]);
    let both = material.to_owned() + "\nmaterials = { core = {young_modulus=1, poisson_ratio=0, density=1} }";
    refused(
        material,
        &both,
        "{ core",
        "body.materials",
        &["found both `material` and `materials`, expected exactly one", "keep `material` for"],
    );
    refused(
        material,
        "materials = {}",
        "{}",
        "body.materials",
        &["found {}, expected a material for each physical group", "add `group_name = {"],
    );
}

#[test]
fn neither_or_both_of_step_and_tolerance() {
    let helps = ["expected exactly one of them", "e.g. `step = 1e-4`", "e.g. `tolerance = 1e-6`"];
    let words = |found| [&[found], &helps[..]].concat();
    refused("step = 1e-4", "", "[time]", "time.step", &words("found neither `step` nor `tolerance`"));
    let both = "step = 1e-4\ntolerance = 1e-7";
    refused("step = 1e-4", both, "1e-7", "time.tolerance", &words("found both `step` and `tolerance`"));
}

/// The `[time]` of the example.
const TIME: &str = "step = 1e-4\nformulation = \"conservative\"                              # or \"paper\"\n\
                    scheme = \"exponential\"";

#[test]
fn formulation_and_scheme_that_do_not_go_together() {
    for (formulation, scheme, expected) in [
        (
            "conservative",
            "paper",
            "expected `rkmk4` or `exponential`, or the formulation `paper`, which has that scheme",
        ),
        (
            "paper",
            "exponential",
            "expected `paper` or `rkmk4`, or the formulation `conservative`, which has that scheme",
        ),
    ] {
        let quoted = format!("\"{scheme}\"");
        refused(
            TIME,
            &format!("step = 1e-4\nformulation = \"{formulation}\"\nscheme = {quoted}"),
            &quoted,
            "time.scheme",
            &[&format!("found {quoted} with the formulation `{formulation}`"), expected],
        );
    }
}

#[test]
fn a_tolerance_without_an_error_estimate() {
    for (method, found) in [
        ("scheme = \"paper\"", "found a tolerance with the scheme `paper` of the formulation `paper`"),
        ("formulation = \"paper\"", "found a tolerance with the scheme `paper` of the formulation `paper`"),
        (
            "formulation = \"paper\"\nscheme = \"rkmk4\"",
            "found a tolerance with the scheme `rkmk4` of the formulation `paper`",
        ),
    ] {
        refused(
            TIME,
            &format!("tolerance = 1e-7\n{method}"),
            "1e-7",
            "time.tolerance",
            &[
                found,
                "expected `step`, since only `exponential` and `rkmk4` on the conservative form estimate the error",
                "give `step`, e.g. `step = 1e-4`, or set `scheme = \"exponential\"` and `formulation = \"conservative\"`",
            ],
        );
    }
    for bad in ["0", "-1e-8", "1", "1.0", "2"] {
        refused(
            "step = 1e-4",
            &format!("tolerance = {bad}"),
            &format!("{bad}\nformulation"),
            "time.tolerance",
            &[&format!("found {bad}, expected a number between 0 and 1, both excluded"), "e.g. `tolerance = 1e-6`"],
        );
    }
}

#[test]
fn rows_after_steps_or_at_times() {
    let both = "every = 1\ninterval = 0.01";
    let words = ["found both `every` and `interval`, expected at most one of them", "keep `every`"];
    refused("every = 1", both, "0.01", "output.interval", &words);

    // The example has `every = 1`.
    let words = ["`every` with a tolerance", "expected `interval`", "not equally long", "e.g. `interval = 1e-3`"];
    refused("step = 1e-4", "tolerance = 1e-8", "1\npoints", "output.every", &words);
}

#[test]
fn wrong_types() {
    for (from, to, mark, key, found, expected, help) in [
        (
            "step = 1e-4",
            "step = '1e-4'",
            "'1e-4'",
            "time.step",
            "the string '1e-4'",
            "a finite number",
            "remove the quotes",
        ),
        (
            "step = 1e-4",
            "step = \"short\"",
            "\"short\"",
            "time.step",
            "the string \"short\"",
            "a finite number",
            "write it like this: `step = 1e-4`",
        ),
        (
            "step = 1e-4",
            "step = true",
            "true",
            "time.step",
            "the boolean true",
            "a finite number",
            "write it like this: `step = 1e-4`",
        ),
        (
            "step = 1e-4",
            "step = 2020-01-01",
            "2020",
            "time.step",
            "the date 2020-01-01",
            "a finite number",
            "write it like this: `step = 1e-4`",
        ),
        (
            "step = 1e-4",
            "step = [1e-4]",
            "[1e-4]",
            "time.step",
            "a list of 1 entry",
            "a finite number",
            "write it like this: `step = 1e-4`",
        ),
        (
            "step = 1e-4",
            "step = { a = 1 }",
            "{ a = 1",
            "time.step",
            "a table",
            "a finite number",
            "write it like this: `step = 1e-4`",
        ),
        (
            "flexible = 10",
            "flexible = 10.0",
            "10.0",
            "modes.flexible",
            "the number 10.0",
            "a whole number, 0 or more",
            "write it like this: `flexible = 10`",
        ),
        (
            "flexible = 10",
            "flexible = -1",
            "-1\n",
            "modes.flexible",
            "the number -1",
            "a whole number, 0 or more",
            "write it like this: `flexible = 10`",
        ),
        (
            "flexible = 10",
            "flexible = \"10\"",
            "\"10\"",
            "modes.flexible",
            "the string \"10\"",
            "a whole number, 0 or more",
            "remove the quotes",
        ),
        (
            "every = 1",
            "every = 1.5",
            "1.5",
            "output.every",
            "the number 1.5",
            "a whole number, 0 or more",
            "write it like this: `every = 1`",
        ),
        ("length = \"mm\"", "length = 1", "1,", "units.length", "the number 1", "a string", "put it in quotes"),
        (
            "title = \"Free plate, 50 N end pulse\"",
            "title = []",
            "[]",
            "title",
            "a list of 0 entries",
            "a string",
            "write it like this: `title = \"Free",
        ),
        (
            "scheme = \"exponential\"",
            "scheme = 1",
            "1\n\n[output]",
            "time.scheme",
            "the number 1",
            "a string",
            "put it in quotes",
        ),
        (
            "formulation = \"conservative\"",
            "formulation = []",
            "[]                              # or",
            "time.formulation",
            "a list of 0 entries",
            "a string",
            "write it like this: `formulation = \"conservative\"`",
        ),
        (
            "step = 1e-4",
            "tolerance = \"1e-8\"",
            "\"1e-8\"",
            "time.tolerance",
            "the string \"1e-8\"",
            "a finite number",
            "remove the quotes",
        ),
        (
            "every = 1",
            "interval = []",
            "[]\npoints",
            "output.interval",
            "a list of 0 entries",
            "a finite number",
            "write a finite number",
        ),
        (
            "kind = \"force\"",
            "kind = ['force']",
            "['force']",
            "loads[0].kind",
            "a list of 1 entry",
            "a string",
            "write it like this: `kind = \"force\"`",
        ),
        (
            "direction = [1.0, 0.0, 1.0]",
            "direction = [1.0, 1.0]",
            "[1.0, 1.0]",
            "loads[0].direction",
            "a list of 2 entries",
            "a list of 3 numbers",
            "write it like this: `direction = [1.0,",
        ),
        (
            "direction = [1.0, 0.0, 1.0]",
            "direction = \"x\"",
            "\"x\"",
            "loads[0].direction",
            "the string \"x\"",
            "a list of 3 numbers",
            "write it like this: `direction = [1.0,",
        ),
        (
            "direction = [1.0, 0.0, 1.0]",
            "direction = [1, '0', 1]",
            "'0'",
            "loads[0].direction[1]",
            "the string '0'",
            "a finite number",
            "remove the quotes",
        ),
        (
            "modal_displacement = []",
            "modal_displacement = 0",
            "0  ",
            "initial.modal_displacement",
            "the number 0",
            "a list",
            "write it like this: `modal_displacement = []`",
        ),
        (
            "[time]",
            "[[time]]",
            "[[time]]",
            "time",
            "a list of 1 entry",
            "a table",
            "write it like this:\n     [time]\n     end = 0.5",
        ),
        (
            "[[loads]]",
            "[loads]",
            "[loads]",
            "loads",
            "a table",
            "a list",
            "write it like this:\n     [[loads]]\n     kind = \"force\"",
        ),
        (
            "{ P1 = [-500.0, -25.0, 0.0] }",
            "[[-500.0, -25.0, 0.0]]",
            "[[-500.0, -25.0",
            "output.points",
            "a list of 1 entry",
            "a table",
            "write it like this: `points = { P1 = [",
        ),
        (
            "material = {",
            "material = 'steel' #",
            "'steel'",
            "body.material",
            "the string 'steel'",
            "a table",
            "write it like this: `material = { young_modulus",
        ),
        (
            "mass = 0.001",
            "mass = 1, spread = 'big'",
            "'big'",
            "body.point_masses[0].spread",
            "the string 'big'",
            "a finite number",
            "write a finite number",
        ),
        (
            "history = {",
            "history = \"half-sine\" #",
            "\"half-sine\" #",
            "loads[0].history",
            "the string \"half-sine\"",
            "a table",
            "write it like this: `history = { kind = \"half-sine\", start",
        ),
    ] {
        let headline = format!("found {found}, expected {expected}");
        refused(from, to, mark, key, &[&headline, help]);
    }
}

#[test]
fn numbers_that_are_not_finite() {
    for bad in ["nan", "+nan", "inf", "-inf", "1e999", "-1e999"] {
        for (from, name, key) in [
            ("young_modulus = 70000.0", "young_modulus", "body.material.young_modulus"),
            ("step = 1e-4", "step", "time.step"),
            ("amplitude = 50.0", "amplitude", "loads[0].amplitude"),
            ("start = 0.0", "start", "loads[0].history.start"),
            ("damping_ratio = 0.05", "damping_ratio", "modes.damping_ratio"),
            ("mass = 0.001", "mass", "body.point_masses[0].mass"),
        ] {
            let headline = format!("found the number {bad}, expected a finite number");
            let help = format!("write it like this: `{from}`");
            refused(from, &format!("{name} = {bad}"), bad, key, &[&headline, &help]);
        }
        let list = format!("modal_displacement = [0, {bad}]");
        refused("modal_displacement = []", &list, bad, "initial.modal_displacement[1]", &[bad]);
        let point = format!("R = [0, 0, {bad}]");
        refused("R = [-500.0, -25.0, 0.0]", &point, bad, "frame.R[2]", &["a finite number"]);
    }
}

#[test]
fn numbers_out_of_range() {
    let positive = "expected a number greater than 0";
    for (from, to, key, expected, help) in [
        ("young_modulus = 70000.0", "0", "body.material.young_modulus", positive, "force per area"),
        ("young_modulus = 70000.0", "-7e4", "body.material.young_modulus", positive, "N/mm²"),
        ("density = 2.7e-9", "0.0", "body.material.density", positive, "mass per volume"),
        ("density = 2.7e-9", "-2.7e-9", "body.material.density", positive, "mass per volume"),
        ("poisson_ratio = 0.33", "0.5", "body.material.poisson_ratio", "between -1 and 0.5", "0.49"),
        ("poisson_ratio = 0.33", "-1", "body.material.poisson_ratio", "between -1 and 0.5", "0.33"),
        ("mass = 0.001", "0.0", "body.point_masses[0].mass", positive, "remove the point mass"),
        ("mass = 0.001", "-0.001", "body.point_masses[0].mass", positive, "unit of mass"),
        ("damping_ratio = 0.05", "-0.05", "modes.damping_ratio", "of 0 or more", "e.g. 0.05"),
        ("end = 0.5", "0", "time.end", positive, "at least one step"),
        ("end = 0.5", "-0.5", "time.end", positive, "at least one step"),
        ("step = 1e-4", "0", "time.step", positive, "`step = 1e-4`"),
        ("step = 1e-4", "-1e-4", "time.step", positive, "`step = 1e-4`"),
        ("step = 1e-4", "0.6", "time.step", "at most the end of the run, 0.5", "step shorter"),
        ("step = 1e-4", "1e-13", "time.step", "not lost in rounding", "step longer"),
        ("every = 1", "0", "output.every", "a whole number, 1 or more", "10 for every tenth"),
        ("every = 1", "0", "output.interval", positive, "`interval = 1e-3`"),
        ("every = 1", "-0.1", "output.interval", positive, "`interval = 1e-3`"),
        ("every = 1", "0.6", "output.interval", "at most the end of the run, 0.5", "interval shorter"),
        ("every = 1", "1e-13", "output.interval", "not lost in rounding", "interval longer"),
        ("duration = 0.02", "4.9e-13", "loads[0].history.duration", "not lost in rounding beside", "duration longer"),
        ("duration = 0.02", "0", "loads[0].history.duration", positive, "length of the pulse"),
        ("duration = 0.02", "-1", "loads[0].history.duration", positive, "length of the pulse"),
        (
            "direction = [1.0, 0.0, 1.0]",
            "[0, 0.0, -0.0]",
            "loads[0].direction",
            "a vector that is not zero",
            "its length does not matter",
        ),
    ] {
        let name = key.rsplit('.').next().unwrap();
        let to_line = format!("{name} = {to}");
        let (text, error) = refusal(from, &to_line);
        let value_starts = text.find(&to_line).unwrap() + name.len() + 3;
        let found = format!("found {to}, expected ");
        refused(from, &to_line, &text[value_starts..], key, &[&found, expected, help]);
        assert!(matches!(error, SceneError::Invalid { .. }));
    }
    let spread = "mass = 0.001, spread = 0.0";
    refused("mass = 0.001", spread, "0.0 }", "body.point_masses[0].spread", &[positive, "one node"]);
}

#[test]
fn values_in_groups_and_later_entries_are_named() {
    let material = "material = { young_modulus = 70000.0, poisson_ratio = 0.33, density = 2.7e-9 }";
    let groups = "[body.materials.\"sand wich\"]\nyoung_modulus = 1\npoisson_ratio = 0.7\ndensity = 1\n";
    let masses = "point_masses = [ { at = [-500.0, -25.0, 0.0], mass = 0.001 } ]";
    let text = EXAMPLE.replace(material, "").replace("[modes]", &format!("{groups}[modes]"));
    let error = Body::parse(&text, "p.toml").unwrap_err();
    assert_eq!(error.place().unwrap().key, "body.materials.\"sand wich\".poisson_ratio");
    assert!(error.to_string().contains("|                 ^^^\n"), "{error}");

    let two = "point_masses = [\n  { at = [0, 0, 0], mass = 1 },\n  { at = [0, 0, 0], mass = -1 },\n]";
    refused(masses, two, "-1 }", "body.point_masses[1].mass", &["found -1, expected"]);

    let load = "[[loads]]\nkind = \"force\"\nat = [0, 0, 0]\ndirection = [0, 0, 0]\namplitude = 1\n\
                history = { kind = \"half-sine\", duration = 1 }\n\n[time]";
    refused("[time]", load, "[0, 0, 0]\namp", "loads[1].direction", &["not zero"]);
}

#[test]
fn too_many_initial_values() {
    for name in ["modal_displacement", "modal_velocity"] {
        let list = format!("{name} = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]");
        refused(
            &format!("{name} = []"),
            &list,
            "[1, 2",
            &format!("initial.{name}"),
            &["found 11 entries, expected at most 10", "set `flexible = 11` in [modes]"],
        );
    }
}

#[test]
fn reference_points_on_a_line() {
    let q = "Q = [500.0, 25.0, 0.0]";
    for (to, mark, key, found) in [
        ("Q = [-500, -25, 0]", "[-500, -25", "frame.Q", "the same point for R and Q"),
        ("Q = [500, -25, 0]", "[500, -25", "frame.Q", "the same point for P and Q"),
        ("Q = [0.0, -25, 0]", "[frame]", "frame", "on one line (the smallest sine of an angle is 0.0e0)"),
        ("Q = [900.0, -24.9995, 0]", "[frame]", "frame", "the smallest sine of an angle is 3.6e-7"),
        ("Q = [500.0, -25.0005, 0]", "[frame]", "frame", "the smallest sine of an angle is 5.0e-7"),
    ] {
        refused(q, to, mark, key, &[found, "choose three points", "or remove [frame]"]);
    }
    let p = "P = [500.0, -25.0, 0.0]";
    refused(p, "P = [-500, -25, 0]", "[-500, -25,", "frame.P", &["the same point for R and P"]);
    // A triangle just over the limit, and huge and tiny ones, are accepted.
    for (r, p, q) in [
        ("[0, 0, 0]", "[1, 0, 0]", "[0.5, 1e-6, 0]"),
        ("[-1e300, 0, 0]", "[1e300, 0, 0]", "[0, 1e300, 0]"),
        ("[0, 0, 0]", "[1e-300, 0, 0]", "[0, 0, 1e-300]"),
    ] {
        let text = EXAMPLE.replace("R = [-500.0, -25.0, 0.0]", &format!("R = {r}"));
        let text = text.replace("P = [500.0, -25.0, 0.0]", &format!("P = {p}"));
        Body::parse(&text.replace("Q = [500.0, 25.0, 0.0]", &format!("Q = {q}")), "").unwrap();
    }
}

#[test]
fn names_and_texts() {
    for name in ["", ".", "..", "a/b", "/", "a\\u0000", "a\\nb"] {
        let points = format!("points = {{ \"{name}\" = [0, 0, 0] }}");
        let shown = format!("\"{}\"", name.replace("\\u0000", "\\0"));
        refused(
            "points = { P1 = [-500.0, -25.0, 0.0] }",
            &points,
            &format!("\"{name}\" = [0, 0, 0]"),
            &format!("output.points.{shown}"),
            &["found the name \"", "without `/`", "rename the point, e.g. `P1`"],
        );
    }
    refused("\"mm\"", "\"m\\u0000m\"", "\"m\\u0000m\"", "units.length", &["found \"m\\u0000m\"", "control"]);
    refused("\"Free plate, 50 N end pulse\"", "\"\"\"a\nb\"\"\"", "\"\"\"a", "title", &["on one line"]);
    refused("\"../meshes/plate.msh\"", "\"\"", "\"\"", "body.mesh", &["found \"\"", "the name of a mesh file"]);
}

#[test]
fn text_that_is_not_toml() {
    for (from, to, mark, words) in [
        ("step = 1e-4", "step = 1e-4\nstep = 2", "step = 2", "duplicate key"),
        ("step = 1e-4", "step 1e-4", "1e-4", "expected"),
        ("step = 1e-4", "step = ", "\nformulation", ""),
        ("scheme = \"exponential\"", "scheme = exponential", "exponential\n\n[output]", "quoted"),
        ("[time]", "[time", "\nend", "expected `]`"),
    ] {
        let (text, error) = refusal(from, to);
        let message = error.to_string();
        let line = 1 + text[..text.find(mark).unwrap()].matches('\n').count();
        assert_eq!(error.place().unwrap().line, line, "{message}");
        assert!(matches!(error, SceneError::Syntax { .. }), "{message}");
        for word in ["this is not TOML: ", words, "^", "   = "] {
            assert!(message.contains(word), "no {word:?} in {message}");
        }
    }
}

#[test]
fn initial_values_whose_squares_overflow() {
    for (key, written) in [
        ("velocity", "[0.0, 1e308, 0.0]"),
        ("angular_velocity", "[0.0, -1e308, 0.0]"),
        ("modal_displacement", "[0.0, 1e141]"),
        ("modal_velocity", "[0.0, 1e141]"),
    ] {
        let start = EXAMPLE.find("[initial]").unwrap();
        let section = &EXAMPLE[start..start + EXAMPLE[start..].find("\n\n").unwrap()];
        let mark = written.split(['[', ',', ']', ' ']).find(|number| number.contains("1e")).unwrap();
        let words = [&format!("found {mark}, expected a number of at most 1e140"), "whose square is still a number"];
        let key_path = format!("initial.{key}[1]");
        refused(section, &format!("[initial]\n{key} = {written}"), mark, &key_path, &words);
    }
}
