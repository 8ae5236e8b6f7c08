//! Geometry that was made to lead the scan astray: whatever it does not refuse, gmsh runs, and no mark is left. `FLEXFRAME_HOSTILE`
//! is the number of files. Needs gmsh.

use std::fmt::Write;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

use mesh_import::{ImportError, ImportSettings, read_mesh};

/// Files, unless `FLEXFRAME_HOSTILE` says otherwise.
const FILES: usize = 150;

/// Numbers that look random: xorshift.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % count as u64) as usize
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }
}

/// Statements that leave a mark, where gmsh runs them.
fn attacks(mark: &str) -> Vec<String> {
    vec![
        format!("SystemCall \"touch {mark}\";"),
        format!("SystemCall 'touch {mark}';"),
        format!("SystemCall Str(\"touch {mark}\");"),
        format!("System 'touch {mark}';"),
        format!("NonBlockingSystemCall 'touch {mark}';"),
        format!("S2N[StrCat('Sys','tem')] 'touch {mark}';"),
        format!("S2N[ 'SystemCall' ] 'touch {mark}';"),
        format!("StringToName[Sprintf('Sys%s', 'tem')] 'touch {mark}';"),
        format!("Printf('x') > '{mark}';"),
        format!("Printf('x %g', 1) >> '{mark}';"),
        format!("Printf( 'x' )\n>\n'{mark}';"),
        format!("Save '{mark}.msh';"),
        format!("Print '{mark}.geo_unrolled';"),
        format!("Print.ParameterCommand = 'SystemCall \"touch {mark}\";'; Print '{mark}.png';"),
        format!("Field[9] = ExternalProcess; Field[9].CommandLine = 'touch {mark}'; Background Field = 9;"),
        format!("OnelabRun('x', 'touch {mark}');"),
        "Include 'evil.txt';".to_owned(),
        "Merge 'evil.msh';".to_owned(),
        "Merge 'evil.txt';".to_owned(),
        "Merge 'evil.pos';".to_owned(),
        "MergeWithBoundingBox 'evil.geo';".to_owned(),
        "Merge 'good.step';".to_owned(),
        "name = 'evil.geo'; Include name;".to_owned(),
        "Include StrCat('evil', '.geo');".to_owned(),
        "v[] = ShapeFromFile('evil.brep');".to_owned(),
        "Include 'loop.txt';".to_owned(),
        "Call Hidden;".to_owned(),
    ]
}

/// An attack where it is not to be seen: in comments and texts that end otherwise than they seem to, in loops and blocks.
fn disguised(random: &mut Random, attack: &str) -> String {
    let one_line = attack.replace('\n', " ");
    let other_quotes = one_line.replace('"', "'");
    let pad = |count: usize| "x".repeat(count);
    match random.below(30) {
        0 => attack.to_owned(),
        1 => format!("/* {attack} */"),
        2 => format!("/*/ {attack} /*/"),
        3 => format!("// {one_line}\r\n"),
        4 => format!("// a comment\r{one_line}\n"),
        5 => format!("/* \0 {attack} */"),
        6 => format!("s = \"{}{other_quotes}\";", pad(1024 + random.below(3))),
        7 => format!("s = \"{}\"{other_quotes}\";", pad(1020 + random.below(9))),
        8 => format!("If (0)\n s = \"EndIf {other_quotes}\";\nEndIf"),
        9 => format!("If (0)\n /* EndIf {attack} */\nEndIf"),
        10 => format!("If (0) s = \"/*\"; EndIf\n{attack}\ns = \"*/\";"),
        11 => format!("For i In {{0:1}} s = \"\n{other_quotes}\n\";\nEndFor"),
        12 => format!("For i In {{0:1}} /*\n{attack}\n*/\nEndFor"),
        13 => format!("Macro M{}\n/* Return {attack} */\nReturn", random.below(1000)),
        14 => format!("Macro N{0}\n{attack}\nReturn\nCall N{0};", random.below(1000)),
        15 => {
            // Cut by the end of a part of 8192 bytes.
            let cut = random.below(12);
            format!("For i In {{0:1}} {} {one_line}\nEndFor", pad(8170 + cut))
        }
        16 => format!("l[] = {{{}0}}; {one_line}", "1,".repeat(4080 + random.below(20))),
        17 => format!("x1EndIf2{one_line}"),
        18 => format!("If (0)\n x1EndIf2{one_line}\nEndIf"),
        19 => format!("s = 'it\"; {other_quotes} //\"';"),
        20 => format!("{}\u{c}\t{}", random.of(&["", ";", "}", "EndIf", "EndFor", "Return"]), attack),
        21 => format!("If (1)\n{attack}\nElse\n{attack}\nEndIf"),
        22 => format!("s = \"a\\\"; {other_quotes} //\";"),
        23 => format!("s = \"a\n{other_quotes}\n\";"),
        24 => format!("DefineConstant[ c = {{0, Name 'a', Help '{}'}} ];", other_quotes.replace('\'', "\"")),
        25..=28 => {
            // Something inside of a word, or of what follows it.
            let mut attack = attack.to_owned();
            for _ in 0..1 + random.below(2) {
                let what: [&str; 17] = [
                    "\r", "\n", "\0", " ", "/**/", "//\n", "\u{b}", "_", "\\", "\"", "'", "1", "\u{ff}", "~{1}", "=",
                    ";", "*/",
                ];
                let at = (0..=random.below(14).min(attack.len())).rev().find(|at| attack.is_char_boundary(*at));
                attack.insert_str(at.unwrap_or_default(), random.of::<&str>(&what));
            }
            attack
        }
        _ => attack.replace(' ', random.of::<&str>(&["/**/", "\n", "\t", "\u{c}", "\r", "// \n", "/* ; */ "])),
    }
}

/// A file of a box with some attacks.
fn geometry(random: &mut Random, mark: &str) -> String {
    let attacks = attacks(mark);
    let mut text = "SetFactory(\"OpenCASCADE\");\n".to_owned();
    let count = 1 + random.below(4) / 3;
    let box_at = random.below(count + 1);
    for i in 0..=count {
        if i == box_at {
            text += "Box(1) = {0, 0, 0, 1, 1, 1};\nMesh.MeshSizeMin = 1;\nPhysical Volume(\"block\") = {1};\n";
        }
        if i < count {
            let attack = random.of(&attacks).clone();
            let _ = writeln!(text, "{}", disguised(random, &attack));
        }
    }
    text
}

#[test]
fn whatever_the_scan_does_not_refuse_leaves_no_mark() {
    const GMSH: &str = "FLEXFRAME_GMSH";
    if std::env::var_os(GMSH).is_some() {
        return attack();
    }
    // With a gmsh that nobody waits for: some of the files make it run for ever.
    let folder = tempfile::tempdir().unwrap();
    let gmsh = folder.path().join("gmsh");
    fs::write(&gmsh, "#!/bin/sh\nexec timeout 10 gmsh \"$@\"\n").unwrap();
    fs::set_permissions(&gmsh, fs::Permissions::from_mode(0o755)).unwrap();
    let mut part = Command::new(std::env::current_exe().unwrap());
    let output = part.args(["--nocapture"]).env(GMSH, &gmsh).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
}

fn attack() {
    let count = std::env::var("FLEXFRAME_HOSTILE").ok().and_then(|text| text.parse().ok()).unwrap_or(FILES);
    let seed = std::env::var("FLEXFRAME_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(1);
    let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ seed);
    let (mut refused, mut run, mut endless, mut read, mut would) = (0, 0, 0, 0, 0);
    let trusted_of = count.div_ceil(40);
    for i in 0..count {
        let [folder, marks] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let marks_left = || fs::read_dir(marks.path()).unwrap().count();
        let mark = marks.path().join("mark").display().to_string();
        let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        for name in ["evil.geo", "evil.txt", "evil.msh", "evil.pos", "evil.brep", "bar.geo.opt", "good.step.opt"] {
            put(name, &format!("SystemCall 'touch {mark}';\n"));
        }
        put("good.step", "ISO-10303-21;\n");
        // Loops and macros that end in another file than they begin.
        put(
            "loop.txt",
            &format!("s = \"\nSystemCall 'touch {mark}';\n\";\nEndFor\nMacro Hidden\n/* Return */ EndFor\nReturn\n"),
        );
        let text = geometry(&mut random, &mark);
        put("bar.geo", &text);
        let bar = folder.path().join("bar.geo");
        match read_mesh(&bar, &ImportSettings::default()) {
            Ok(_) => read += 1,
            Err(ImportError::Refused { .. }) => refused += 1,
            Err(ImportError::Io { .. }) => refused += 1,
            Err(ImportError::Failed { status, .. }) if status.contains("124") => endless += 1,
            Err(_) => run += 1,
        }
        assert_eq!(marks_left(), 0, "file {i}:\n{text}");
        assert!(is_as_it_was(folder.path()), "file {i} has written beside itself:\n{text}");
        if i % 40 == 0 {
            // That the attacks are some: the same file, trusted.
            let _ = read_mesh(&bar, &ImportSettings { trust_geometry: true, ..ImportSettings::default() });
            would += usize::from(marks_left() > 0);
        }
    }
    println!(
        "{count} files: {refused} refused; run by gmsh: {read} meshed, {run} without a mesh, {endless} without an end. {would} of \
         {trusted_of} leave a mark if trusted"
    );
    assert!(2 * would > trusted_of, "the attacks are none: {would} of {trusted_of}");
    assert!(refused > count / 4 && run + read > count / 20, "{refused} {run} {read}");
}

fn is_as_it_was(folder: &Path) -> bool {
    fs::read_dir(folder).unwrap().count() == 10
}
