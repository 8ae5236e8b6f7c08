//! Help about a driver that failed, by its words and those of mpirun.

/// How to install all that is needed.
pub(crate) const INSTALL: &str = "install SLEPc for Python and MPI: apt-get install python3-slepc4py python3-petsc4py openmpi-bin \
                                  (Debian, Ubuntu), or conda install -c conda-forge slepc4py openmpi; FLEXFRAME_MPIRUN and \
                                  FLEXFRAME_MPI_PYTHON name mpirun and Python where they have other names";

/// Words of a failure, and what to do about it.
const HELP: [(&str, &str); 6] = [
    (
        "enough slots",
        "ask for as many ranks as there are cores at most, or set OMPI_MCA_rmaps_base_oversubscribe=1, which lets several share a core",
    ),
    (
        "run as root",
        "run it as another user, or set OMPI_ALLOW_RUN_AS_ROOT=1 and OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1, as in a container",
    ),
    ("xecutable", INSTALL),
    ("execve", INSTALL),
    ("No such file or directory", "let every machine see the folder of the files: set TMPDIR to one that they share"),
    (
        "signal 9",
        "if the system ended a rank for want of memory, spread the ranks over more machines, or take a coarser mesh",
    ),
];

/// Help about a failure with these words.
pub(crate) fn help(said: &str) -> &'static str {
    HELP.iter().find(|(words, _)| said.contains(words)).map_or(
        "see what it said; options for PETSc and MUMPS go into PETSC_OPTIONS (docs/reference/cluster.md)",
        |(_, help)| help,
    )
}
