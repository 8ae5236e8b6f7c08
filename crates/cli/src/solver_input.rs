//! Who finds the modes of a body: this program, or SLEPc.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use diagnostic::Failure;
use model::Builder;
use scene::Body;
use slepc::{Slepc, Stop};

use crate::cli_error::option;

#[derive(Debug, Args)]
pub struct SolverInput {
    /// Solver of modes and static responses; slepc is SLEPc under mpirun, for bodies beyond one machine (docs/reference/cluster.md).
    ///
    /// Answers in the cache are taken from there, whoever has computed them; --no-cache computes them anew.
    #[arg(long, value_name = "SOLVER", value_enum)]
    solver: Option<Solver>,
    /// With slepc: number of processes, `mpirun -n N`.
    #[arg(long, value_name = "N", requires = "solver", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    ranks: Option<u32>,
    /// With slepc: only write K and M, the driver and a script for Slurm into a folder.
    #[arg(long, value_name = "DIR", requires = "ranks")]
    write_only: Option<PathBuf>,
    /// With slepc: take what the driver has left in the folder of --write-only.
    #[arg(long, value_name = "DIR", requires = "solver", conflicts_with = "ranks")]
    read: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Solver {
    /// This program: Lanczos with the factor of K + sM, or multigrid cycles for bulky bodies.
    BuiltIn,
    /// SLEPc on PETSc with MUMPS.
    Slepc,
}

/// Modes that are to be found elsewhere.
pub struct WriteOnly {
    /// The folder for the files.
    pub folder: PathBuf,
    /// Processes that will work on them.
    pub ranks: usize,
}

impl SolverInput {
    /// Refuses SLEPc for several bodies at once, whose files would be in each other's way.
    fn refuse_several(&self, bodies: usize) -> Result<(), Failure> {
        match self.solver {
            Some(Solver::Slepc) => {
                let found = format!("slepc for {bodies} bodies");
                Err(option("--solver", found, "a scene of one body, or one body of it", "name the body: --body NAME"))
            }
            _ => Ok(()),
        }
    }

    /// As [`Self::take`]; refuses SLEPc for several bodies.
    pub fn take_of(&self, scenes: &[Body], builder: &mut Builder, stop: &Stop) -> Result<Option<WriteOnly>, Failure> {
        match scenes.len() {
            1 => self.take(builder, stop),
            count => self.refuse_several(count).map(|()| None),
        }
    }

    /// Gives the builder its solver, or says what is to be written instead; `stop` stops the solver.
    pub fn take(&self, builder: &mut Builder, stop: &Stop) -> Result<Option<WriteOnly>, Failure> {
        let ranks = self.ranks.map(|ranks| ranks as usize);
        if self.solver != Some(Solver::Slepc) {
            let ours = [
                ("--ranks", ranks.is_some()),
                ("--write-only", self.write_only.is_some()),
                ("--read", self.read.is_some()),
            ];
            return match ours.iter().find(|(_, is_given)| *is_given) {
                Some((option, _)) => Err(refused(option, "it beside --solver built-in", "--solver slepc")),
                None => Ok(None),
            };
        }
        match (ranks, self.write_only.clone(), self.read.clone()) {
            (Some(ranks), Some(folder), _) => return Ok(Some(WriteOnly { folder, ranks })),
            (Some(ranks), None, _) => builder.solver = Some(Slepc::run(ranks, stop.clone())),
            (None, _, Some(folder)) => builder.solver = Some(Slepc::read(folder)),
            (None, ..) => return Err(refused("--solver", "slepc alone", "--ranks N or --read DIR beside it")),
        }
        Ok(None)
    }
}

fn refused(name: &str, found: &str, expected: &str) -> Failure {
    let help = "`--solver slepc --ranks N` finds the modes here; docs/reference/cluster.md shows how a cluster does";
    option(name, found, expected, help)
}
