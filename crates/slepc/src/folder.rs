//! The folder that a driver works in.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use diagnostic::Failure;
use faer::MatRef;
use foreign_program::shell_word;
use modal::{HeldMatrix, HeldProblem};
use serde::{Deserialize, Serialize};
use whole_file::WholeFile;

use crate::binary::{write_matrix, write_vectors};
use crate::error::{failed, other_matrices};
use crate::json::json;

/// The program that every rank runs.
const DRIVER: &str = include_str!("driver.py");
pub(crate) const DRIVER_FILE: &str = "driver.py";
/// Where the script for Slurm sends what the driver says.
pub(crate) const LOG: &str = "driver.log";
/// ‖(K + sM)⁻¹Mφ − μφ‖_M / μ of a pair that the driver accepts: that of the search in this program.
const TOLERANCE: f64 = 1e-10;

/// Files of a new folder.
const WRITTEN: [&str; 7] = ["problem.json", "K.petsc", "M.petsc", "rigid.petsc", DRIVER_FILE, "job.sh", "README.txt"];

/// Digits of the names of forces.
const NAME: usize = 16;

/// The part of `problem.json` about the matrices.
#[derive(Deserialize)]
struct Digest {
    digest: String,
}

/// `problem.json`.
#[derive(Serialize)]
struct Problem<'a> {
    /// Digest of K and M.
    digest: &'a str,
    unknowns: usize,
    /// Number of modes asked for.
    modes: usize,
    /// Number of modes that there are.
    available: usize,
    /// Rigid motions.
    rigid: usize,
    shift: f64,
    tolerance: f64,
}

/// Files of a folder that take their places together, once all are whole.
struct Files<'a> {
    folder: &'a Path,
    written: Vec<(PathBuf, WholeFile)>,
}

impl<'a> Files<'a> {
    fn of(folder: &'a Path) -> Self {
        Self { folder, written: Vec::new() }
    }

    /// Writes one, which is not in its place yet.
    fn add<T>(&mut self, name: &str, contents: impl FnOnce(&mut WholeFile) -> io::Result<T>) -> Result<T, Failure> {
        let path = self.folder.join(name);
        let written = WholeFile::create(&path).and_then(|mut file| {
            let done = contents(&mut file)?;
            file.make_safe()?;
            Ok((done, file))
        });
        let (done, file) = written.map_err(failed(path.clone(), "write it"))?;
        self.written.push((path, file));
        Ok(done)
    }

    /// Writes K and M, the rigid motions, and the driver. Returns the digest of K and M.
    fn add_matrices(&mut self, problem: &HeldProblem<'_>) -> Result<String, Failure> {
        let mut written = |name: &str, matrix: &HeldMatrix<'_>| {
            self.add(name, |file| hashed(file, |file| write_matrix(matrix, file)))
        };
        let digest = joined(written("K.petsc", &problem.stiffness)?, written("M.petsc", &problem.mass)?);
        self.add("rigid.petsc", |file| write_vectors(problem.rigid.as_ref(), file))?;
        self.add(DRIVER_FILE, |file| file.write_all(DRIVER.as_bytes()))?;
        Ok(digest)
    }

    /// Writes the question for the driver: a number of modes, of the matrices with this digest.
    fn add_problem(&mut self, problem: &HeldProblem<'_>, digest: &str, modes: usize) -> Result<(), Failure> {
        let problem = Problem {
            digest,
            unknowns: problem.stiffness.size(),
            modes,
            available: problem.available,
            rigid: problem.rigid.ncols(),
            shift: problem.shift,
            tolerance: TOLERANCE,
        };
        self.add("problem.json", |file| Ok(serde_json::to_writer_pretty(file, &problem)?))
    }

    /// Puts them into their places.
    fn finish(self) -> Result<(), Failure> {
        let finish = |(path, file): (PathBuf, WholeFile)| file.finish().map_err(failed(path, "write it"));
        self.written.into_iter().try_for_each(finish)
    }
}

/// Writes K and M, the rigid motions, and the driver. Returns the digest of K and M.
pub(crate) fn write_matrices(problem: &HeldProblem<'_>, folder: &Path) -> Result<String, Failure> {
    let mut files = Files::of(folder);
    let digest = files.add_matrices(problem)?;
    files.finish()?;
    Ok(digest)
}

/// Writes the question for the driver: a number of modes, of the matrices with this digest. Those that were asked for before are
/// removed.
pub(crate) fn write_problem(
    problem: &HeldProblem<'_>,
    digest: &str,
    modes: usize,
    folder: &Path,
) -> Result<(), Failure> {
    let before = folder.join("modes.json");
    if before.exists() {
        fs::remove_file(&before).map_err(failed(before, "remove what was there"))?;
    }
    let mut files = Files::of(folder);
    files.add_problem(problem, digest, modes)?;
    files.finish()
}

/// Writes forces to which static responses are asked for. Returns their name, which follows from them.
pub(crate) fn write_forces(forces: MatRef<'_, f64>, folder: &Path) -> Result<String, Failure> {
    let hash = hashed(io::sink(), |file| write_vectors(forces, file));
    let name = hash.map_err(failed(folder, "write forces into it"))?.to_hex()[..NAME].to_owned();
    if !folder.join(format!("forces-{name}.json")).exists() {
        let mut files = Files::of(folder);
        files.add(&format!("forces-{name}.petsc"), |file| write_vectors(forces, file))?;
        files.add(&format!("forces-{name}.json"), |file| writeln!(file, "{{\"count\": {}}}", forces.ncols()))?;
        files.finish()?;
    }
    Ok(name)
}

/// Refuses a folder that was written for other matrices than those with this digest.
pub(crate) fn check_digest(folder: &Path, digest: &str) -> Result<(), Failure> {
    let written: Digest = json(&folder.join("problem.json"))?;
    if written.digest == digest { Ok(()) } else { Err(other_matrices(folder)) }
}

/// The answers to questions that were asked before, by the names that this program and the driver give them.
fn answers(folder: &Path) -> Vec<PathBuf> {
    let is_answer = |name: &str| {
        let of_forces = name.strip_prefix("forces-").or_else(|| name.strip_prefix("statics-"));
        let of_forces = of_forces.and_then(|rest| rest.strip_suffix(".petsc").or_else(|| rest.strip_suffix(".json")));
        ["problem.json", "modes.json", "modes.petsc", LOG].contains(&name)
            || of_forces.is_some_and(|name| name.len() == NAME && name.bytes().all(|byte| byte.is_ascii_hexdigit()))
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter(|entry| is_answer(&entry.file_name().to_string_lossy())).map(|entry| entry.path()).collect()
}

/// The files that [`write_folder`] writes to a folder, and those that it removes there: answers to other questions.
pub fn files_of_folder(folder: &Path) -> Vec<PathBuf> {
    let mut files = WRITTEN.map(|name| folder.join(name)).to_vec();
    files.extend(answers(folder).into_iter().filter(|path| path.file_name() != Some("problem.json".as_ref())));
    files
}

/// Leaves in a folder all that finds `modes` modes elsewhere: K and M, the driver, a script for Slurm with `ranks` ranks, and what
/// to do. `scene` is the scene file. Returns the files.
///
/// # Errors
/// [`Failure`] of a file.
pub fn write_folder(
    problem: &HeldProblem<'_>,
    modes: usize,
    folder: &Path,
    ranks: usize,
    scene: &Path,
) -> Result<Vec<PathBuf>, Failure> {
    fs::create_dir_all(folder).map_err(failed(folder, "make the folder"))?;
    let mut files = Files::of(folder);
    let digest = files.add_matrices(problem)?;
    files.add_problem(problem, &digest, modes)?;
    let script = script(ranks);
    let readme = format!(
        "{modes} modes of {}, {} unknowns: to be found by SLEPc on PETSc with MUMPS, for Python (slepc4py).\n\
         Where they are installed: `cd` to this folder and `sbatch job.sh`, or `bash job.sh` without Slurm.\n\
         Then: flexframe modes {} --solver slepc --read {}\n",
        shell_word(scene),
        problem.stiffness.size(),
        shell_word(scene),
        shell_word(folder)
    );
    for (name, text) in [("job.sh", &script), ("README.txt", &readme)] {
        files.add(name, |file| file.write_all(text.as_bytes()))?;
    }
    for before in answers(folder) {
        fs::remove_file(&before).map_err(failed(before, "remove what was there"))?;
    }
    files.finish()?;
    Ok(WRITTEN.map(|name| folder.join(name)).to_vec())
}

fn script(ranks: usize) -> String {
    format!(
        "#!/bin/bash
# `sbatch job.sh` in this folder runs the driver on {ranks} ranks; so does `bash job.sh` without Slurm.
# What is answered already is not computed again.
#SBATCH --job-name=flexframe-modes
#SBATCH --ntasks={ranks}
#SBATCH --cpus-per-task=1
#SBATCH --output={LOG}
set -euo pipefail
export OMP_NUM_THREADS=1
\"${{FLEXFRAME_MPIRUN:-mpirun}}\" -n \"${{SLURM_NTASKS:-{ranks}}}\" \"${{FLEXFRAME_MPI_PYTHON:-python3}}\" {DRIVER_FILE}
"
    )
}

/// The digest of K and M.
pub(crate) fn digest(problem: &HeldProblem<'_>) -> Result<String, Failure> {
    let [stiffness, mass] = [&problem.stiffness, &problem.mass]
        .map(|matrix: &HeldMatrix<'_>| hashed(io::sink(), |file| write_matrix(matrix, file)));
    let not_written = || failed("K.petsc", "write it");
    Ok(joined(stiffness.map_err(not_written())?, mass.map_err(not_written())?))
}

fn joined(stiffness: blake3::Hash, mass: blake3::Hash) -> String {
    blake3::Hasher::new().update(stiffness.as_bytes()).update(mass.as_bytes()).finalize().to_hex().to_string()
}

/// Writes to a file. Returns the hash of what went there.
fn hashed<W: Write>(file: W, contents: impl FnOnce(&mut Hashed<W>) -> io::Result<()>) -> io::Result<blake3::Hash> {
    let mut hashed = Hashed { file, hasher: blake3::Hasher::new() };
    contents(&mut hashed)?;
    Ok(hashed.hasher.finalize())
}

/// Hashes what goes to a file.
struct Hashed<W> {
    file: W,
    hasher: blake3::Hasher,
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
