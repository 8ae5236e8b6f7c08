//! Spoiled files: never a panic, never much more memory than the file itself.

use std::path::PathBuf;

use fem_tet10::parse_msh;

fn data(name: &str) -> Vec<u8> {
    std::fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)).unwrap()
}

/// Parses, and gives whether the mesh was accepted and the most memory held meanwhile.
fn parse(bytes: &[u8]) -> (bool, usize) {
    let mut accepted = false;
    let memory = allocation_counter::measure(|| match parse_msh(bytes, "spoiled.msh") {
        Ok(mesh) => accepted = mesh.positions().iter().flatten().all(|c| c.is_finite()),
        Err(error) => assert!(error.to_string().len() < 2000, "{error}"),
    });
    (accepted, memory.bytes_max as usize)
}

/// Knuth's MMIX linear congruential generator.
fn next(state: &mut u64) -> u8 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 56) as u8
}

#[test]
fn spoiled_files_cost_an_error_and_no_more() {
    // What other threads hold would not be seen.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().unwrap();
    let mut worst = 0.0_f64;
    for name in ["cube_groups.msh", "cube_groups_binary.msh", "overlapping_groups_partitioned.msh"] {
        let good = data(name);
        assert!(parse(&good).0);
        // Any byte at all, a digit, a sign, and the ends of the range, at every position.
        for seed in 1..=3_u64 {
            let mut state = seed;
            for position in 0..good.len() {
                for replacement in
                    [next(&mut state), b'0' + next(&mut state) % 10, [0xff, b'-', 0x00][seed as usize - 1]]
                {
                    let mut spoiled = good.clone();
                    spoiled[position] = replacement;
                    worst = worst.max(parse(&spoiled).1 as f64 / good.len() as f64);
                }
            }
        }
        // Numbers that claim very much, in the place of every word or of every eight bytes.
        for position in 0..good.len().saturating_sub(8) {
            for claim in [1_000_000_000_000, u64::MAX, 1 << 63, i64::MIN as u64 >> 32] {
                let mut spoiled = good.clone();
                if name != "cube_groups_binary.msh" {
                    if !good[position].is_ascii_whitespace() {
                        continue;
                    }
                    let rest = &good[position + 1..];
                    let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
                    spoiled.splice(position + 1..position + 1 + end, claim.to_string().into_bytes());
                } else {
                    spoiled[position..position + 8].copy_from_slice(&claim.to_le_bytes());
                }
                worst = worst.max(parse(&spoiled).1 as f64 / good.len() as f64);
            }
        }
        // Parts taken out, and parts twice.
        for seed in 0..2000_u64 {
            let mut state = seed;
            let mut cut = || usize::from(next(&mut state)) * good.len() / 256;
            let (a, b) = (cut(), cut());
            let spoiled = [&good[..a], &good[b..]].concat();
            worst = worst.max(parse(&spoiled).1 as f64 / good.len() as f64);
        }
    }
    // Measured: 3.6.
    assert!(worst < 5.0, "{worst:.1} bytes were held for a byte of the file");
    made_to_be_large();
}

/// Small files written so that they become as large as possible in memory, and as slow as possible to read.
fn made_to_be_large() {
    let file = |sections: &str| format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{sections}");
    let repeated = |count: usize, line: &dyn Fn(usize) -> String| (0..count).map(line).collect::<String>();
    let triangles = |count| repeated(count, &|k| format!("{} 1 2 3 4 5 6\n", k + 1));
    // Every one of many groups has the one surface, and every one of its triangles or blocks.
    let groups = |count: usize| format!("{count}{}", repeated(count, &|k| format!(" {}", k + 1)));
    let surface = |count| format!("$Entities\n0 0 1 0\n1 0 0 0 0 0 0 {} 0\n$EndEntities\n", groups(count));
    let nodes = "$Nodes\n0 0 0 0\n$EndNodes\n";
    let elements =
        |blocks: usize, count: usize, all: &str| format!("$Elements\n{blocks} {count} 0 0\n{all}$EndElements\n");
    let block = |count| format!("2 1 9 {count}\n{}", triangles(count));
    let n = 20_000;
    let cases = [
        (
            "many groups of many triangles",
            surface(n) + nodes + &elements(1, n, &block(n)),
            "is in 20000 physical groups",
        ),
        (
            "many groups of many blocks",
            surface(n) + nodes + &elements(n, n, &repeated(n, &|_| block(1))),
            "is in 20000 physical groups",
        ),
        // As many groups as are let through.
        ("six groups of many triangles", surface(6) + nodes + &elements(1, n, &block(n)), "no tetrahedra"),
        (
            "many blocks",
            nodes.to_owned() + &elements(n, n, &repeated(n, &|k| format!("2 {k} 15 1\n1 1\n"))),
            "no tetrah",
        ),
        ("many regions", nodes.to_owned() + &elements(n, 0, &repeated(n, &|k| format!("3 {k} 11 0\n"))), "no tetrah"),
        (
            "many names",
            format!("$PhysicalNames\n{n}\n{}$EndPhysicalNames\n", repeated(n, &|k| format!("1 {k} \"\"\n"))),
            "no $Nodes",
        ),
        (
            "many points",
            format!("$Entities\n{n} 0 0 0\n{}$EndEntities\n", repeated(n, &|k| format!("{k} 0 0 0 1 1\n"))),
            "no $Nodes",
        ),
        ("many sections", repeated(n, &|_| "$a\n$Enda\n".to_owned()), "no $Nodes"),
    ];
    for (what, sections, says) in cases {
        let contents = file(&sections);
        let message = parse_msh(contents.as_bytes(), "large.msh").unwrap_err().to_string();
        assert!(message.contains(says) && message.len() < 1000, "{what}: {message}");
        let held = parse(contents.as_bytes()).1 as f64 / contents.len() as f64;
        // Measured: 35.8 for six groups of many triangles, below 15 for the others.
        assert!(held < 40.0, "{what}: {held:.1} bytes were held for a byte of the file");
    }
}
