//! Spoiled scenes and tables, and those made to be large: never much more memory than a multiple of the text, never much
//! more work.
//!
//! A program of its own, with one test, since it counts what the whole program allocates.

use std::alloc::{GlobalAlloc, Layout, System};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use scene::Scene;

/// The system's allocator, with the bytes held now and at most, and how often it was called.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);
static CALLS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.fetch_add(1, Relaxed);
        let held = HELD.fetch_add(layout.size(), Relaxed) + layout.size();
        MOST.fetch_max(held, Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const EXAMPLE: &str = include_str!("../src/example.toml");

/// What a text has cost, and what came of it.
struct Read {
    answer: Result<Scene, String>,
    /// Most bytes held meanwhile.
    held: usize,
    /// Allocations.
    calls: usize,
}

/// Reads a scene; a refusal must be readable.
fn read(text: &str, path: &Path) -> Read {
    let (before, calls) = (HELD.load(Relaxed), CALLS.load(Relaxed));
    MOST.store(before, Relaxed);
    let answer = Scene::parse(text, path).map_err(|error| error.to_string());
    if let Err(message) = &answer {
        assert!(message.chars().count() < 4000, "a message of {} bytes", message.len());
    }
    Read { answer, held: MOST.load(Relaxed) - before, calls: CALLS.load(Relaxed) - calls }
}

/// Bytes held for a byte of the text.
fn multiple(text: &str, path: &Path) -> f64 {
    read(text, path).held as f64 / text.len() as f64
}

/// Knuth's MMIX linear congruential generator.
fn next(state: &mut u64) -> u8 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 56) as u8
}

#[test]
fn a_text_costs_a_multiple_of_its_length() {
    real_scenes();
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
    let mut worst = 0.0_f64;
    for (path, text) in examples() {
        assert!(read(&text, &path).answer.is_ok(), "{}", path.display());
        worst = worst.max(multiple(&text, &path));
    }
    println!("real {worst:.1}");
}

fn damaged_scenes() {
    let mut worst = 0.0_f64;
    let path = Path::new("damaged.toml");
    for seed in 1..=20_000_u64 {
        let mut state = seed;
        let mut cut = || (usize::from(next(&mut state)) * 256 + usize::from(next(&mut state))) * EXAMPLE.len() / 65536;
        let (a, b) = (cut(), cut());
        let spoiled = format!("{}{}", &EXAMPLE[..a], &EXAMPLE[b..]);
        if !spoiled.is_empty() {
            worst = worst.max(read(&spoiled, path).held as f64 / spoiled.len().max(500) as f64);
        }
    }
    println!("damaged {worst:.1}");
}

fn scenes_made_to_be_large() {
    let n = 40_000;
    let path = Path::new("large.toml");
    let load = "[[loads]]\nkind = \"gravity\"\ndirection = [1, 0, 0]\namplitude = 1\n";
    let before_output = EXAMPLE.split("[output]").next().unwrap();
    let cases = [
        ("tables of a key", format!("x=[{}]", "{a=1},".repeat(n))),
        ("tables in tables", format!("x=[{}]", format!("{{{}a=1}},", "a.".repeat(70)).repeat(n / 70))),
        ("headers", "[[a.a]]\n".repeat(n)),
        ("headers of keys", (0..n).map(|i| format!("[a{i}.a]\n")).collect()),
        ("headers and keys", "[[a]]\na=1\n".repeat(n)),
        ("lists", format!("x=[{}]", "[],".repeat(n))),
        ("numbers", format!("x=[{}]", "1,".repeat(n))),
        ("keys", (0..n).map(|i| format!("a{i}=1\n")).collect()),
        ("strings", format!("x=[{}]", "'',".repeat(n))),
        ("escapes", format!("x=\"{}\"", "\\n".repeat(n))),
        ("comments", "#\n".repeat(n)),
        ("loads", EXAMPLE.replace("[[loads]]", &format!("{}[[loads]]", load.repeat(n / 20)))),
        ("points", format!("{before_output}[output.points]\n{}", (0..n).map(|i| format!("a{i}=[0,0,0]\n")).collect::<String>())),
        ("masses", EXAMPLE.replace("point_masses = [", &format!("point_masses = [{}", "{at=[0,0,0],mass=1},".repeat(n)))),
        ("modal", EXAMPLE.replace("modal_displacement = [", &format!("modal_displacement = [{}", "0,".repeat(n)))),
        ("constant factors", EXAMPLE.replace("{ kind = \"half-sine\", start = 0.0, duration = 0.02 }", &format!("{{kind=\"product\",factors=[{}]}}", "'constant',".repeat(n)))),
        ("table", EXAMPLE.replace("{ kind = \"half-sine\", start = 0.0, duration = 0.02 }", &format!("{{kind=\"table\",points=[{}]}}", (0..n).map(|i| format!("[{i},0],")).collect::<String>()))),
        ("damping", EXAMPLE.replace("damping_ratio = 0.05", &format!("damping_table=[{}]", (0..n).map(|i| format!("[{i},0],")).collect::<String>()))),
        ("materials", EXAMPLE.replace("material = {", &format!("materials = {{ {} b = {{", (0..n).map(|i| format!("a{i}={{young_modulus=1,poisson_ratio=0,density=1}},")).collect::<String>())).replace("2.7e-9 }", "2.7e-9 }}")),
        ("tables", EXAMPLE.replace("{ kind = \"half-sine\", start = 0.0, duration = 0.02 }", &format!("{{kind=\"product\",factors=[{}]}}", "{kind='table',points=[[0,1],[1,1]]},".repeat(n/10)))),
    ];
    for (what, text) in cases {
        let now = std::time::Instant::now();
        let read = read(&text, path);
        println!(
            "{what}: {} bytes, {:.1} times held, {:.1} calls, {:?} {:?}",
            text.len(),
            read.held as f64 / text.len() as f64,
            read.calls as f64 / text.len() as f64,
            now.elapsed(), 
            read.answer.map(|_| ()).map_err(|m| m.lines().next().unwrap().chars().take(150).collect::<String>()),
        );
    }
}

fn tables() {}
