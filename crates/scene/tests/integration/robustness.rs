//! Spoiled scenes and tables, and those made to be large: never much more memory than a multiple of the text, never much
//! more work.

use std::path::{Path, PathBuf};

use scene::Scene;

const EXAMPLE: &str = include_str!("../../src/text/example.toml");

/// Cost of reading a text, and its result.
struct Read {
    answer: Result<Scene, String>,
    /// Most bytes held meanwhile.
    held: usize,
    /// Allocations.
    calls: usize,
}

/// Reads a scene; a refusal must be readable.
fn read(text: &str, path: &Path) -> Read {
    let mut answer = None;
    let memory = allocation_counter::measure(|| {
        answer = Some(Scene::parse(text, path).map_err(|error| error.to_string()));
    });
    let answer = answer.unwrap();
    if let Err(message) = &answer {
        assert!(message.chars().count() < 4000, "a message of {} bytes", message.len());
    }
    Read { answer, held: memory.bytes_max as usize, calls: memory.count_total as usize }
}

/// Knuth's MMIX linear congruential generator.
fn next(state: &mut u64) -> u8 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 56) as u8
}

#[test]
fn a_text_costs_a_multiple_of_its_length() {
    real_scenes();
    many_bodies();
    damaged_scenes();
    scenes_made_to_be_large();
    tables();
}

fn examples() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    scenes.map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

fn real_scenes() {
    for (path, text) in examples() {
        let read = read(&text, &path);
        assert!(read.answer.is_ok(), "{}", path.display());
        // Measured: at most 46, and 72 of several bodies, whose text is parsed to be taken apart, too.
        assert!(read.held < 90 * text.len(), "{} bytes for {}", read.held, path.display());
    }
}

fn many_bodies() {
    let rigid = "rigid={mass=1,center_of_mass=[0,0,0],inertia=[[1,0,0],[0,1,0],[0,0,1]]}";
    let bodies: String = (0..1000).map(|i| format!("[bodies.b{i}]\n{rigid}\n")).collect();
    let text = format!(
        "title='many'\nunits={{length='m',mass='kg',time='s'}}\ntime={{end=1,step=0.1}}\noutput={{interval=0.5}}\n{bodies}"
    );
    let read = read(&text, Path::new("many.toml"));
    assert_eq!(read.answer.unwrap().bodies.len(), 1000);
    println!("{} bytes, {} allocations for a byte", read.held / text.len(), read.calls / text.len());
    // Measured: 155 and 5.
    assert!(read.held < 200 * text.len() && read.calls < 10 * text.len(), "{} {}", read.held, read.calls);
}

fn damaged_scenes() {
    let path = Path::new("damaged.toml");
    let mut worst = 0;
    for seed in 1..=5000_u64 {
        let mut state = seed;
        let mut cut = || (usize::from(next(&mut state)) * 256 + usize::from(next(&mut state))) * EXAMPLE.len() / 65536;
        let (a, b) = (cut(), cut());
        let spoiled = format!("{}{}", &EXAMPLE[..a], &EXAMPLE[b..]);
        let held = read(&spoiled, path).held;
        // What a message shows of the examples is parsed, too, which is all there is to a very short text.
        let more = held.saturating_sub(50 * spoiled.len());
        worst = worst.max(more);
    }
    // Measured: 41 568.
    assert!(worst < 64 << 10, "{worst} bytes more than 50 for a byte of the text");
}

/// A text with a number of something, for each thing that there may be many of, and what it is refused with ("" if it is
/// not).
fn large_scenes(n: usize) -> Vec<(&'static str, String, &'static str)> {
    let repeated = |line: &dyn Fn(usize) -> String| (0..n).map(line).collect::<String>();
    let example = |from: &str, to: String| {
        assert_eq!(EXAMPLE.matches(from).count(), 1, "{from}");
        EXAMPLE.replace(from, &to)
    };
    let history = |history: String| example("{ kind = \"half-sine\", start = 0.0, duration = 0.02 }", history);
    let factors = |factor: &str| history(format!("{{kind='product',factors=[{}]}}", factor.repeat(n)));
    let deep = format!("{{{}a=1}},", "a.".repeat(70));
    let pairs = repeated(&|i| format!("[{i},0],"));
    let unknown = "unknown key `x`";
    vec![
        ("tables of one key", format!("x=[{}]", "{a=1},".repeat(n)), unknown),
        ("tables in tables", format!("x=[{}]", deep.repeat(n / 70)), unknown),
        ("tables deeper than any", format!("x={}", "{a=".repeat(n)), "this is not TOML"),
        ("lists deeper than any", format!("x={}", "[".repeat(n)), "this is not TOML"),
        ("headers", format!("[x]\n{}", repeated(&|i| format!("[a{i}.a]\n"))), unknown),
        ("headers of lists", "[[x]]\na=1\n".repeat(n), unknown),
        ("lists", format!("x=[{}]", "[],".repeat(n)), unknown),
        ("numbers", format!("x=[{}]", "1,".repeat(n)), unknown),
        ("strings", format!("x=[{}]", "'',".repeat(n)), unknown),
        ("escapes", format!("x=\"{}\"", "\\n".repeat(n)), unknown),
        ("a long key", format!("{}=1", "x".repeat(n)), "unknown key `xxx"),
        ("keys", format!("x=1\n{}", repeated(&|i| format!("y{i}=1\n"))), unknown),
        ("comments", "#\n".repeat(n), "`title` is missing"),
        (
            "loads",
            example("[[loads]]", "[[loads]]\nkind='gravity'\ndirection=[1,0,0]\namplitude=1\n".repeat(n) + "[[loads]]"),
            "expected at most 1000",
        ),
        (
            "constraints",
            example("[[loads]]", "[[constraints]]\nkind='pin'\nat=[0,0,0]\n".repeat(n) + "[[loads]]"),
            "at most one",
        ),
        ("bodies", format!("[bodies]\n{}", repeated(&|i| format!("[bodies.b{i}]\n"))), "expected at most 1000"),
        (
            "points",
            example("points = { ", format!("points = {{ {}", repeated(&|i| format!("a{i}=[0,0,0],")))),
            "expected at most 1000",
        ),
        (
            "masses",
            example("point_masses = [", format!("point_masses = [{}", "{at=[0,0,0],mass=1},".repeat(n))),
            "expected at most 1000",
        ),
        (
            "a long group",
            history("'constant'".into()).replace("kind = \"force\"", &format!("kind='{}'", "x".repeat(n))),
            "unknown value",
        ),
        (
            "a long table file",
            history(format!("{{kind='table',file='{}'}}", "x".repeat(n))),
            "a table that cannot be read",
        ),
        (
            "modal displacements",
            example("modal_displacement = [", format!("modal_displacement = [{}", "0,".repeat(n))),
            "at most 10",
        ),
        ("points of a table", history(format!("{{kind='table',points=[{pairs}]}}")), ""),
        (
            "points of a table, the last not rising",
            history(format!("{{kind='table',points=[{pairs}[0,0]]}}")),
            "that rise",
        ),
        ("pairs of damping", example("damping_ratio = 0.05", format!("damping_table=[{pairs}]")), ""),
        ("factors", factors("'constant',"), ""),
        ("factors that are tables", factors("{kind='table',points=[[0,1],[1,1]]},"), ""),
        ("a long formula", history(format!("{{kind='expression',formula='{}1'}}", "1+".repeat(n))), ""),
        (
            "materials",
            example(
                "material = {",
                format!(
                    "materials = {{ {} b = {{",
                    repeated(&|i| { format!("a{i}={{young_modulus=1,poisson_ratio=0,density=1}},") })
                ),
            )
            .replace("2.7e-9 }", "2.7e-9 }}"),
            "",
        ),
    ]
}

fn scenes_made_to_be_large() {
    let path = Path::new("large.toml");
    for ((what, half, _), (_, whole, says)) in large_scenes(4000).into_iter().zip(large_scenes(8000)) {
        let (of_half, of_whole) = (read(&half, path), read(&whole, path));
        match &of_whole.answer {
            Ok(_) => assert_eq!(says, "", "{what}"),
            Err(message) => {
                assert!(!says.is_empty() && message.contains(says), "{what}: {message}");
            }
        }
        let multiple = of_whole.held as f64 / whole.len() as f64;
        // Measured: 573 for tables in tables, below 170 for the others.
        assert!(multiple < 700.0, "{what}: {multiple:.1} bytes were held for a byte of the text");
        // Twice as much of it is twice the work, as far as work allocates. Measured: at most 2.00.
        let ratio = of_whole.calls as f64 / (of_half.calls + 200) as f64;
        assert!(ratio < 2.2, "{what}: {} allocations, then {}", of_half.calls, of_whole.calls);
    }
}

fn tables() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.csv");
    let scene = |history: &str| EXAMPLE.replace("{ kind = \"half-sine\", start = 0.0, duration = 0.02 }", history);
    let table = |of: &str| {
        std::fs::write(&file, of).unwrap();
        let read = read(&scene("{kind='table',file='a.csv'}"), &folder.path().join("a.toml"));
        (read.held.saturating_sub(100 << 10) as f64 / of.len() as f64, read.answer)
    };
    let n = 200_000;
    let rising: String = (0..n).map(|i| format!("{i},1\n")).collect();
    for (what, of, says) in [
        ("points", rising.clone(), ""),
        ("the last does not rise", rising + "0,0", "found the time 0.0 after"),
        ("commas", ",".repeat(n), "found 0 pairs"),
        ("lines", "\n".repeat(n), "found 0 pairs"),
        ("comments", "#\n".repeat(n), "found 0 pairs"),
        ("digits", "1".repeat(n), "expected two finite numbers"),
        ("digits in columns", format!("{0},{0}", "1".repeat(n)), "expected two finite numbers"),
        ("1e12 points", "1000000000000\n0,1\n".into(), "expected two finite numbers"),
    ] {
        let (multiple, answer) = table(&of);
        match answer {
            Ok(_) => assert_eq!(says, "", "{what}"),
            Err(message) => assert!(!says.is_empty() && message.contains(says), "{what}: {message}"),
        }
        // Measured: 32.3 for commas, 4.9 for points.
        assert!(multiple < 40.0, "{what}: {multiple:.1} bytes were held for a byte of the table");
    }
    // One file in the place of very many.
    let _ = table(&"0,0\n1,1\n".replace("\n", &format!("{}\n", " ".repeat(500_000))));
    let many = scene(&format!("{{kind='product',factors=[{}]}}", "{kind='table',file='a.csv'},".repeat(1000)));
    let read = read(&many, &folder.path().join("a.toml"));
    assert!(read.answer.unwrap_err().contains("found more than 16777216 bytes of tables"));
    // Measured: 2.8 MB, of which the text of a table is 1 MB.
    assert!(read.held < 4 << 20, "{} bytes were held", read.held);
}
