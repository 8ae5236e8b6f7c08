//! Arguments, and what is printed.

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use flexframe::animation::{AnimationSettings, Coloured, MAX_FRAMES, animate, animate_mode, animate_results};
use flexframe::campbell::{self, AboutRest, CampbellError, CampbellSettings, Speeds, SystemCampbellSettings};
use flexframe::check::{self, CheckRows};
use flexframe::cost::{self, CostSettings};
use flexframe::export::{self, ExportRows, Exported, Motion};
use flexframe::failure::{Details, FailureReport, Kind};
use flexframe::figures::{self, View};
use flexframe::fit::{self, FitError, FitSettings};
use flexframe::fmu::{self, FmuSettings};
use flexframe::frequencies::Frequencies;
use flexframe::frf::{self, FrfSettings};
use flexframe::given_file::GivenFile;
use flexframe::gradient::{self, GradientError, GradientSettings};
use flexframe::hand_over::{self, Form};
use flexframe::linearize::{self, LinearSettings, Reduction};
use flexframe::outputs::{OutputError, Outputs, Written, outputs_of_results, outputs_of_scene, outputs_of_scenes};
use flexframe::psd::{self, PsdSettings};
use flexframe::report::OfBodies;
use flexframe::run::{RunProgress, RunSettings};
use flexframe::shock;
use flexframe::srs::{self, SrsSettings};
use flexframe::sweep::{Shard, SweepSettings};
use flexframe::system_modes::{self, AdviceOnSystems, ModesOfSystems};
use flexframe::{advise, html_report, mode_shapes, modes, new_scene, paper, plausible, run, sweep};
use model::{BuildError, Builder, Cache};
use scene::{Flexible, Measured, Scene, SceneError, System};
use slepc::files_of_folder;

use crate::cli_error::{self, CliError};
use crate::progress::Bar;
use crate::scene_input::SceneInput;
use crate::served::Served;
use crate::signals::Signals;
use crate::solver_input::{SolverInput, WriteOnly};
use crate::{output, threads};

/// Flexible-body dynamics: the motion of elastic bodies that fly, tumble and spin while they vibrate.
///
/// A scene (a TOML file, see docs/reference/scene.md) names a gmsh mesh of second-order tetrahedra, its material, the modes to
/// keep, the loads, and the time. Start with `flexframe run examples/plate.toml`.
#[derive(Debug, Parser)]
#[command(name = "flexframe", version, max_term_width = 100, after_long_help = exit_codes(), after_help = "--help says more, exit codes too.")]
pub struct Cli {
    /// Threads for meshes and modes; all cores if not given. The results are the same for any number.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=256))]
    threads: Option<u16>,
    /// Neither read nor keep what was computed of a mesh before (in $XDG_CACHE_HOME/flexframe or ~/.cache/flexframe).
    #[arg(long, global = true)]
    no_cache: bool,
    /// Let gmsh do all that geometry (.geo) says: it is a program, and may run others, and write and read files. Without this,
    /// geometry with such commands is refused.
    #[arg(long, global = true)]
    trust_geometry: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Write a first scene of a mesh, with comments, that runs as it is.
    New {
        /// The mesh file.
        #[arg(value_name = "MESH")]
        mesh: PathBuf,
        /// The scene file to write, or - for standard output [default: the mesh file's name with .toml].
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// Largest size of an element, where geometry is meshed.
        #[arg(long, value_name = "SIZE", value_parser = positive)]
        mesh_size: Option<f64>,
        /// Give first-order elements a node in the middle of each edge.
        #[arg(long)]
        raise_order: bool,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Run a scene and write its motion to an HDF5 file.
    ///
    /// The first ctrl-C (or SIGTERM or SIGHUP) stops the run at its next row, and `flexframe resume` continues it. A second one, at
    /// least half a second later, ends the program at once.
    Run {
        #[command(flatten)]
        scene: SceneArgs,
        /// Folder for the results; it is made if it does not exist [default: out/<name of the scene file>].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
        /// Allow a results file of more than 1 GB.
        #[arg(long)]
        large: bool,
        /// Leave out the check of a row by the full nonlinear body at the end (see `flexframe check`).
        #[arg(long)]
        no_check: bool,
        #[command(flatten)]
        solver: SolverInput,
    },
    /// Continue an interrupted run: the results are the same, bit for bit, as those of a run without interruption.
    Resume {
        /// The unfinished file, such as out/plate/plate.part.h5, or the name of its results file.
        #[arg(value_name = "FILE")]
        file: PathBuf,
        #[command(flatten)]
        files: FileArgs,
        /// Leave out the check by the full nonlinear body at the end, as `flexframe run --no-check` does.
        #[arg(long)]
        no_check: bool,
        /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
        #[arg(long)]
        json: bool,
    },
    /// Check rows of a run against the full nonlinear body of its mesh: how wrong the displacements and the frequencies are, and why.
    Check {
        /// The results file, such as out/plate/plate.h5, or the unfinished one of a run. Its meshes have to be where they were.
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Numbers of the rows, from 0 [default: those where a model is most likely to be wrong].
        #[arg(long, value_name = "N,…", value_delimiter = ',')]
        rows: Vec<usize>,
        /// Write the trust card with what the check finds into the results file, so that `flexframe report` shows it.
        #[arg(long)]
        write: bool,
        /// Print the report as JSON, for scripts, and errors as JSON on standard error.
        #[arg(long)]
        json: bool,
    },
    /// Reduce a scene's body and write it to a file (docs/reference/body.md) that scenes name as `file` in [body].
    Reduce {
        #[command(flatten)]
        scene: SceneArgs,
        /// The body file to write; for other programs a file that ends in .op4 or .op2 (Nastran), .fem (MBDyn), .flex42 (NASA's 42), .sid_fem
        /// (SIMPACK, Modelica) or .glb (pictures).
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        #[command(flatten)]
        files: FileArgs,
        #[command(flatten)]
        solver: SolverInput,
        /// Write the mass and stiffness matrices, too.
        #[arg(long)]
        matrices: bool,
        /// Write the stress of all nodes in each shape, too, as where the scene asks for stress.
        #[arg(long)]
        stress: bool,
    },
    /// Pack a scene as an FMU (FMI 2.0 for co-simulation), for Simulink, OpenModelica, Dymola, FMPy (docs/reference/fmu.md).
    ///
    /// Inputs are forces and moments at the points of the output, factors on the loads and the acceleration of a drive;
    /// outputs are the columns of a results file.
    Fmu {
        #[command(flatten)]
        scene: SceneArgs,
        /// The FMU to write.
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        #[command(flatten)]
        files: FileArgs,
        /// The library that goes into it [default: FLEXFRAME_FMU_LIBRARY, or libflexframe_fmi beside the program].
        #[arg(long, value_name = "FILE")]
        library: Option<PathBuf>,
    },
    /// Find natural frequencies and mode shapes of a scene's body.
    Modes {
        #[command(flatten)]
        scene: SceneArgs,
        /// Number of flexible modes, instead of the scene's.
        #[arg(short = 'n', long, value_name = "N", value_parser = mode_count, allow_hyphen_values = true)]
        flexible: Option<usize>,
        /// The point that a base turns about, in the frame of the mesh, for effective moments of inertia [default: the support of a
        /// held body, the center of mass of a free one].
        #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
        about: Option<[f64; 3]>,
        /// Compare the shapes with those of another body in the same place (MAC): a scene, a body file, or another mesh for this scene.
        #[arg(long, value_name = "OTHER")]
        mac: Option<PathBuf>,
        /// Time of a run at which bodies in joints stand, at rest there [default: the start].
        #[arg(long, value_name = "TIME", value_parser = at_time, allow_hyphen_values = true)]
        time: Option<f64>,
        /// Folder for a picture of the mode shapes (SVG, PDF and PNG), and of bodies in joints a file for ParaView (VTKHDF)
        /// [default: no picture].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
        #[command(flatten)]
        solver: SolverInput,
    },
    /// Say which effects a scene calls for, and why.
    ///
    /// A table shows the error of linear strain in each mode that may bend the body far: frequency, phase and static
    /// force at its expected amplitude; and the modes that are among the large ones.
    Advise {
        #[command(flatten)]
        scene: SceneArgs,
        /// Run the scene with each effect switched, and show the real influence beside the estimate.
        #[arg(long)]
        verify: bool,
    },
    /// Find natural frequencies against spin speed: table, CSV and Campbell diagram, with critical speeds.
    ///
    /// The body spins steadily about an axis through its origin: the centre of mass of a free body, a fixed point of a
    /// held one (the mean of the nodes of a clamp). Coriolis terms, softening and stiffening are on unless the scene's
    /// [effects] say false; loads are left out. Frequencies are those in the rotating frame: order n is a load that
    /// passes n times in a revolution. Branches are followed by their mode shapes and numbered by their order at the
    /// lowest speed. Where two branches meet they cross, or veer if the spin couples them.
    Campbell {
        #[command(flatten)]
        scene: SceneArgs,
        /// Spin axis in the axes of the mesh: x, y, z, or three numbers such as 0,0.6,0.8. Of bodies in joints it is global and goes
        /// through their center of mass.
        #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
        axis: Option<[f64; 3]>,
        /// A joint about whose axis the bodies of a system spin, or the rigid rotor beyond it alone where other joints hold the others [default: the
        /// one that a drive turns].
        #[arg(long, value_name = "NAME", conflicts_with = "axis")]
        joint: Option<String>,
        /// Spin speeds in radians per time: from start to end, both included, count in all.
        #[arg(long, value_name = "START:END:COUNT", value_parser = speeds, allow_hyphen_values = true)]
        speeds: Speeds,
        /// Engine orders, per revolution.
        #[arg(
            long,
            value_name = "N,N,…",
            value_delimiter = ',',
            default_values_t = [1.0, 2.0, 3.0, 4.0],
            value_parser = positive
        )]
        orders: Vec<f64>,
        /// Vibrations about the rest of the full nonlinear body at each speed: auto (where the spin bends the body so far that a low
        /// frequency at the highest speed is off by 1 % without), always, or never.
        #[arg(long, value_name = "WHEN", default_value = "auto", value_parser = about_rest)]
        about_rest: AboutRest,
        /// Number of flexible modes, instead of the scene's.
        #[arg(short = 'n', long, value_name = "N", value_parser = mode_count, allow_hyphen_values = true)]
        flexible: Option<usize>,
        /// Folder for campbell.csv, critical_speeds.csv and the diagram [default: out/<name of the scene file>].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Find shock response spectra of a base motion: CSV, and a diagram (docs/method/shock.md).
    ///
    /// A spectrum has the peaks of oscillators on the base, against their frequency: displacement relative to the base, and
    /// acceleration of the mass in both directions, during the motion and in the free vibration after it.
    Srs {
        /// CSV file of two columns, time and acceleration of the base; straight between lines, zero after the last.
        #[arg(value_name = "TABLE")]
        table: PathBuf,
        /// Frequencies in cycles per time, at equal ratios: from start to end, both included, count in all.
        #[arg(long, value_name = "START:END:COUNT", value_parser = frequencies, allow_hyphen_values = true)]
        frequencies: Frequencies,
        /// Damping ratios, 0 to less than 1: a spectrum for each.
        #[arg(long, value_name = "ZETA,ZETA,…", value_delimiter = ',', default_values_t = [0.05], value_parser = finite, allow_hyphen_values = true)]
        damping: Vec<f64>,
        /// Folder for srs.csv, the diagram and the page [default: out/<name of the table>].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
        /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
        #[arg(long)]
        json: bool,
    },
    /// Write the linear model of small motions, x' = A x + B u and y = C x + D u, for control and for other programs.
    ///
    /// It is about rest, or about the steady spin that a free body begins with, or a driven hinge or joint has. Inputs are the loads of the scene (the factor
    /// that multiplies each, in the place of its history) and forces along the coordinates of joints; outputs are displacement,
    /// velocity and acceleration of the points of [output], along the axes of the body, and joint coordinates.
    Linearize {
        #[command(flatten)]
        scene: SceneArgs,
        #[command(flatten)]
        about: LinearArgs,
        /// Lower the order to N states, by balanced truncation (balanced:N; the summary says by how much a response is wrong at the most) or to
        /// the slowest modes with the static response of the others (modal:N). Rigid, undamped and unstable motions stay.
        #[arg(long, value_name = "WAY:N")]
        reduce: Option<Reduction>,
        /// The file: .mat (MATLAB, version 5) or .json [default: out/<name of the scene file>/linear.mat].
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Compute frequency responses of points and joints to loads: table, CSV and chart.
    ///
    /// Inputs and outputs are those of `flexframe linearize`. Static shapes of the loads, where the model has them, are the
    /// residual flexibility of the modes that are left out.
    Frf {
        #[command(flatten)]
        scene: SceneArgs,
        #[command(flatten)]
        about: LinearArgs,
        /// Frequencies in cycles per time: from start to end, both included, count in all.
        #[arg(long, value_name = "START:END:COUNT", value_parser = frequencies)]
        frequencies: Frequencies,
        /// Space the frequencies by equal ratios.
        #[arg(long)]
        log: bool,
        /// Loss factor of structural damping, in the place of the scene's damping.
        #[arg(long, value_name = "FACTOR", value_parser = positive)]
        structural: Option<f64>,
        /// Folder for frf.csv, the chart and the page [default: out/<name of the scene file>].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Compute the response to stationary random inputs: root mean squares, apparent frequencies, CSV and chart.
    ///
    /// A column of the table is the one-sided power spectral density of an input, in its unit² per cycle per time. Outputs are those of
    /// `flexframe linearize`; with `stress = true` in [output] the equivalent stress of von Mises is among them.
    Psd {
        #[command(flatten)]
        scene: SceneArgs,
        /// CSV file: frequency, then an input by its name each, and for two of them `coherence A & B` and `phase A & B` (degrees, of B before
        /// A). Densities are straight between rows on logarithmic axes.
        #[arg(long, value_name = "TABLE")]
        spectra: PathBuf,
        #[command(flatten)]
        about: AboutArgs,
        /// Outputs, such as tip.acceleration or tip [default: points, stresses and coordinates of joints].
        #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
        outputs: Vec<String>,
        /// Lowest and highest frequency in cycles per time [default: those of the table].
        #[arg(long, value_name = "START:END", value_parser = band)]
        band: Option<[f64; 2]>,
        /// Loss factor of structural damping, in the place of the scene's damping.
        #[arg(long, value_name = "FACTOR", value_parser = positive)]
        structural: Option<f64>,
        /// Folder for psd.csv, the chart and the page [default: out/<name of the scene file>].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Sum the peaks of the modes under a shock of the base or of a load: absolute, SRSS and CQC.
    ///
    /// The input follows the table. Modes and damping are those of the scene; outputs are those of `flexframe linearize` but for velocities. A run
    /// with the table as history of the load has the peaks themselves.
    Shock {
        #[command(flatten)]
        scene: SceneArgs,
        /// CSV file of times and values of the input, such as accelerations of the base.
        #[arg(long, value_name = "TABLE")]
        table: PathBuf,
        /// The input, such as base.acceleration.z or loads[0].
        #[arg(long, value_name = "NAME")]
        input: String,
        #[command(flatten)]
        about: AboutArgs,
        /// Outputs, such as tip.acceleration or tip [default: points, stresses and coordinates of joints].
        #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
        outputs: Vec<String>,
    },
    /// Find the rates of frequencies, effective masses and static displacements with the numbers that a body is made with.
    ///
    /// They are exact, not differences (docs/method/gradients.md). Static displacements are those of the points of [output] under each load
    /// of a body that is held. Of bodies in joints, the parameters are the stiffnesses of springs, bushings and joints, and the materials and
    /// point masses of bodies with a mesh; frequencies and responses have rates.
    Gradient {
        #[command(flatten)]
        scene: SceneArgs,
        /// Parameters: paths of keys, such as body.material.young_modulus or body.point_masses[0].mass, and thickness.AXIS or
        /// thickness.GROUP.AXIS for a factor that stretches the mesh or a physical volume along x, y or z; of bodies in joints such as
        /// springs[0].stiffness or bodies.arm.material.density [default: all keys of materials and point masses, and all stiffnesses].
        #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
        parameters: Vec<String>,
        /// Frequencies, cycles per time, at which the responses of points to the loads have rates, too: from start to end, both included,
        /// count in all. Of one body they are sums over the modes that are kept, with the damping of the scene.
        #[arg(long, value_name = "START:END:COUNT", value_parser = frequencies)]
        frequencies: Option<Frequencies>,
        /// Number of flexible modes, instead of the scene's.
        #[arg(short = 'n', long, value_name = "N", value_parser = mode_count, allow_hyphen_values = true)]
        flexible: Option<usize>,
        /// Folder for gradient.csv and, of responses, gradient_frf.csv [default: out/<name of the scene file>].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Fit parameters of a body to measured frequencies, with intervals of confidence.
    ///
    /// Modes are matched by their shapes at points of [output] where the table has them, and else by their order. The intervals have the
    /// true value in them with 95 % confidence: by the stated deviations of the frequencies, or by what is left of them.
    Fit {
        #[command(flatten)]
        scene: SceneArgs,
        /// CSV file with a column `frequency`, and if wanted `deviation` and POINT.x, POINT.y, POINT.z [default: `measured` in [modes]].
        #[arg(long, value_name = "TABLE")]
        measured: Option<PathBuf>,
        /// Parameters: paths of keys of materials and point masses, such as body.material.young_modulus, thickness.AXIS or
        /// thickness.GROUP.AXIS, or of bodies in joints stiffnesses, such as bushings[0].stiffness.rotation[2], and
        /// bodies.arm.material.density.
        #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
        parameters: Vec<String>,
        /// Standard deviation of the measured frequencies, relative to each, such as 0.01, of those that have none in the table.
        #[arg(long, value_name = "PART", value_parser = positive)]
        deviation: Option<f64>,
        /// Number of flexible modes, instead of the scene's.
        #[arg(short = 'n', long, value_name = "N", value_parser = mode_count, allow_hyphen_values = true)]
        flexible: Option<usize>,
        /// The scene with the fitted parameters, in the folder of the scene file [default: what to set is printed].
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Run the paper's plate and compare it with the paper: every figure, and a report.
    Paper {
        #[command(flatten)]
        scene: SceneArgs,
        /// Folder for results, figures and report.md [default: out/<name of the scene file>].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Measure error and computing time on a scene, for every scheme at many steps.
    Cost {
        #[command(flatten)]
        scene: SceneArgs,
        /// Folder for cost.csv and the diagram [default: out/<name of the scene file>].
        #[arg(short, long, value_name = "DIR")]
        output: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
        /// Find the cheapest setting within this error, ready for the scene.
        #[arg(long, value_name = "ERROR", value_parser = positive)]
        target: Option<f64>,
        /// Longest time of a run in seconds; the reference may take twenty times as long.
        #[arg(long, value_name = "SECONDS", default_value = "1", value_parser = patience)]
        patience: Duration,
    },
    /// Write a results file, finished or not, as a table, or as fields for ParaView.
    #[command(group = clap::ArgGroup::new("what").required(true).multiple(true))]
    Export {
        /// The results file, such as out/plate/plate.h5, or the unfinished one of a run.
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Table of the columns, with units in the heads: a file that ends in .csv, a folder, or - for standard output.
        #[arg(long, value_name = "FILE|DIR", group = "what")]
        csv: Option<PathBuf>,
        /// Columns of the table, or beginnings of their paths, such as energy,points/P1 [default: all].
        #[arg(long, value_name = "PATH,…", value_delimiter = ',', requires = "csv")]
        columns: Vec<String>,
        /// The moving body for ParaView 5.12 and later: one file with the mesh and a step for each row.
        #[arg(long, value_name = "FILE", group = "what")]
        vtkhdf: Option<PathBuf>,
        /// The same for older versions: a folder with a PVD file and a VTU file for each row.
        #[arg(long, value_name = "DIR", group = "what")]
        vtu: Option<PathBuf>,
        /// Shapes of the modes and static shapes, a field each, in one VTKHDF file.
        #[arg(long, value_name = "FILE", group = "what")]
        modes: Option<PathBuf>,
        /// The whole volume (quadratic tetrahedra) instead of the surface (triangles), from the body file beside the results file.
        #[arg(long)]
        volume: bool,
        /// First time.
        #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
        from: Option<f64>,
        /// Last time.
        #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
        to: Option<f64>,
        /// Write every N-th row.
        #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
        every: u64,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Write one HTML page about a run: the moving body in 3-D, shapes, histories, balances. It needs no network.
    Report {
        /// The results file; an unfinished one is shown up to its last row, and marked.
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// The page to write, or - for standard output [default: the results file's name with .html].
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// Put the run itself into the page: it computes the motion, lets it be changed, and be pulled at with the pointer.
        /// The bodies are built again from the scene in the file, with their meshes.
        #[arg(long)]
        live: bool,
        /// Show another run beside it: its bodies as ghosts, its courses, and their differences.
        #[arg(long, value_name = "FILE", conflicts_with = "live")]
        compare: Option<PathBuf>,
        #[command(flatten)]
        files: FileArgs,
    },
    /// Run a scene and show its live page at an address of this machine alone, until it is stopped (Ctrl-C).
    Play {
        #[command(flatten)]
        scene: SceneInput,
        /// The port; 0 takes one that is free.
        #[arg(long, value_name = "N", default_value_t = 0)]
        port: u16,
    },
    /// Run a scene with many values of its keys, and write a table of parameters and results (docs/reference/cli.md).
    ///
    /// A row that fails is marked with its error, and the others go on. Run again, it does the rows that are not done.
    Sweep {
        /// The file of the sweep: a scene, parameters and results.
        #[arg(value_name = "SWEEP")]
        sweep: PathBuf,
        /// The table to write [default: out/<name of the sweep file>.h5].
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// Run a part of the rows only, such as 2/4: for several machines. Its table is <table>.2-of-4.h5.
        #[arg(long, value_name = "I/N")]
        shard: Option<Shard>,
        /// Merge the tables of N shards into one.
        #[arg(long, value_name = "N", conflicts_with_all = ["shard", "slurm"], value_parser = clap::value_parser!(u16).range(1..=10_000))]
        merge: Option<u16>,
        /// Print a script that runs the sweep as an array of N jobs of Slurm.
        #[arg(long, value_name = "N", conflicts_with_all = ["shard", "overwrite", "large", "json"], value_parser = clap::value_parser!(u16).range(1..=10_000))]
        slurm: Option<u16>,
        #[command(flatten)]
        files: FileArgs,
        /// Allow runs whose results are more than 1 GB, which are temporary.
        #[arg(long, conflicts_with = "merge")]
        large: bool,
        /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
        #[arg(long)]
        json: bool,
    },
    /// Print a script that completes commands and options in a shell.
    ///
    /// bash: flexframe completions bash > ~/.local/share/bash-completion/completions/flexframe
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the JSON schema of scene files, by which editors complete and explain keys.
    ///
    /// flexframe schema > flexframe.schema.json
    ///
    /// Visual Studio Code with the extension Even Better TOML uses it in a scene whose first line is
    /// #:schema ./flexframe.schema.json
    #[command(verbatim_doc_comment)]
    Schema,
    /// Draw a scene or a results file as a moving picture: a GIF, or a film.
    ///
    /// A scene is run for it; of a results file (.h5) each frame is a row, and no mesh is needed. Colours run from 0 to the largest
    /// value of the frames that are shown. A warning says where the frames are too few to show how the body turns. With `--mode`
    /// the scene is not run: one of its modes swings through one period.
    Animate {
        #[command(flatten)]
        scene: SceneInput,
        /// The picture to write: a GIF (.gif), or with ffmpeg a film (.mp4, .webm).
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
        #[command(flatten)]
        files: FileArgs,
        /// Number of frames; each is shown for 0.05 s.
        #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u64).range(2..=MAX_FRAMES))]
        frames: u64,
        /// Time of the first frame [default: 0].
        #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
        from: Option<f64>,
        /// Time of the last frame [default: the end of the scene or of the results].
        #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
        to: Option<f64>,
        /// Draw this mode of the scene, from 1 as `flexframe modes` counts them; of bodies in joints, one of the whole.
        #[arg(long, value_name = "N", conflicts_with_all = ["from", "to"], value_parser = clap::value_parser!(u64).range(1..))]
        mode: Option<u64>,
        /// The coloured quantity: the displacement by deformation, or the von Mises stress.
        #[arg(long, value_enum, default_value_t)]
        colour: Colour,
        /// Viewpoint: iso; xy, xz or yz (right and up); x, y, z, -x, -y or -z (where the viewer is); or the angles of the viewer
        /// in degrees, about z from x and above the xy plane [default: -60,25].
        #[arg(long, value_name = "VIEW", value_parser = view, allow_hyphen_values = true)]
        view: Option<View>,
        /// Factor on the deformation that is drawn; of a mode, on 8 % of the size of the body.
        #[arg(long, default_value_t = 1.0, value_parser = finite, allow_hyphen_values = true)]
        magnify: f64,
    },
}

/// The coloured quantity of a moving picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum Colour {
    #[default]
    Displacement,
    Stress,
}

#[derive(Debug, Args)]
struct SceneArgs {
    #[command(flatten)]
    scene: SceneInput,
    /// Print the summary as JSON, for scripts, and errors as JSON on standard error.
    #[arg(long)]
    json: bool,
}

/// The state that a linear model is about.
#[derive(Debug, Args)]
struct AboutArgs {
    /// Angular velocity of the steady spin about the center of mass or the axis of a driven joint to the ground, radians per time, global; 0,0,0 is rest
    /// [default: that of the scene's free body or drive].
    #[arg(long, value_name = "X,Y,Z", value_parser = angular_velocity, allow_hyphen_values = true)]
    spin: Option<[f64; 3]>,
    /// Time of the run at which bodies are where they then are, under the loads of that time [default: the beginning].
    #[arg(long, value_name = "TIME", value_parser = finite, allow_hyphen_values = true)]
    time: Option<f64>,
    /// Take out the motions that deform no body.
    #[arg(long)]
    without_rigid: bool,
}

impl AboutArgs {
    fn settings(&self, inputs: Vec<String>, outputs: Vec<String>) -> LinearSettings {
        LinearSettings { spin: self.spin, time: self.time, without_rigid: self.without_rigid, inputs, outputs }
    }
}

/// A linear model: its state and its channels.
#[derive(Debug, Args)]
struct LinearArgs {
    #[command(flatten)]
    about: AboutArgs,
    /// Inputs, such as loads[0], base.acceleration.z, drive or hinge.drive [default: loads, and forces along the coordinates of joints].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    inputs: Vec<String>,
    /// Outputs, such as tip.acceleration, tip, reaction.force or hinge.moment [default: points, stresses and coordinates of joints].
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    outputs: Vec<String>,
}

impl LinearArgs {
    fn settings(self) -> LinearSettings {
        self.about.settings(self.inputs, self.outputs)
    }
}

#[derive(Debug, Args)]
struct FileArgs {
    /// Replace files that are there, once the new one is complete; of a run, an unfinished one at once. A file that the command reads
    /// is never replaced.
    #[arg(long)]
    overwrite: bool,
}

pub fn main() -> ExitCode {
    // A wrong command line has to be reported before it is parsed to its end.
    let json = std::env::args_os().skip(1).take_while(|argument| argument != "--").any(|argument| argument == "--json");
    let done = match Cli::try_parse() {
        Ok(cli) => execute(cli, json).map_err(|error| cli_error::report(&*error)),
        Err(error) if error.use_stderr() && !json => {
            // Where it cannot be written, the exit code still tells.
            let _ = error.print();
            return ExitCode::from(Kind::Usage.exit_code());
        }
        Err(error) if error.use_stderr() => {
            let text = error.render().to_string();
            let message = text.trim().strip_prefix("error: ").unwrap_or(text.trim());
            Err(FailureReport::new(Kind::Usage, message, Details::default()))
        }
        // The help or the version was asked for.
        Err(asked) => output::written(asked.print()).map_err(|error| error.report()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(report) => {
            output::report(&report, json);
            ExitCode::from(report.exit_code())
        }
    }
}

fn settings(signals: &Signals, overwrite: bool, builder: &Builder) -> RunSettings {
    RunSettings { overwrite, stop: signals.stop(), builder: builder.clone(), ..RunSettings::default() }
}

fn execute(cli: Cli, json: bool) -> Result<(), Box<dyn Error>> {
    let cache = if cli.no_cache { Cache::none() } else { Cache::of_user() };
    let builder = Builder { cache: cache.clone(), solver: None, trust_geometry: cli.trust_geometry };
    let done = command(cli, json, builder);
    if !json {
        output::notes(&cache.notes());
    }
    done
}

fn command(cli: Cli, json_errors: bool, mut builder: Builder) -> Result<(), Box<dyn Error>> {
    let tell_doubts = |system: &System| {
        if !json_errors {
            output::doubts(plausible::doubts_of_system(system));
        }
    };
    let read = |input: SceneInput| -> Result<Scene, Box<dyn Error>> {
        let scene = input.read()?;
        if !json_errors {
            output::doubts(plausible::doubts_of_scene(&scene));
        }
        Ok(scene)
    };
    let read_system = |input: SceneInput| -> Result<System, Box<dyn Error>> {
        let system = input.read_system()?;
        tell_doubts(&system);
        Ok(system)
    };
    // A scene of one body, or of bodies in joints; of several that nothing ties one has to be named.
    let read_one = |input: SceneInput, flexible: Option<usize>| -> Result<System, Box<dyn Error>> {
        let mut system = input.clone().read_system()?;
        if !system.has_connections() && system.bodies.len() > 1 {
            system = input.read()?.into();
        }
        tell_doubts(&system);
        for scene in &mut system.bodies {
            scene.modes.flexible = flexible.map_or(scene.modes.flexible, Flexible::Count);
        }
        Ok(system)
    };
    let signals = Signals::listen(json_errors).map_err(CliError::Signals)?;
    threads::start(cli.threads)?;
    let mut bar = Bar::new(json_errors);
    match cli.command {
        Command::New { mesh, output, mesh_size, raise_order, files } => {
            let settings = new_scene::ImportSettings { mesh_size, raise_order, trust_geometry: cli.trust_geometry };
            GivenFile::expect(&mesh, &[GivenFile::Mesh], "a mesh or geometry")?;
            if output.as_deref().is_some_and(output::is_standard) {
                let (scene, notes) = new_scene::scene_text(&mesh, &settings)?;
                output::doubts(notes);
                return Ok(output::text(&scene)?);
            }
            let (scene, notes) = new_scene::new_scene(&mesh, &settings, output.as_deref(), files.overwrite)?;
            output::list(&[scene])?;
            notes.iter().try_for_each(|note| output::warn(Some(note)))
        }
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "flexframe", &mut script);
            Ok(output::written(std::io::stdout().write_all(&script))?)
        }
        Command::Schema => Ok(output::text(&format!("{:#}\n", flexframe::scene::json_schema()))?),
        Command::Run { scene: SceneArgs { scene, json }, output, files, large, no_check, solver } => {
            output::require_file("--output", output.as_deref())?;
            let system = read_system(scene)?;
            if let Some(to) = solver.take_of(&system.bodies, &mut builder, signals.slepc())? {
                return write_only(&system.bodies[0], &builder, &to, files.overwrite, bar);
            }
            let folder = folder(&system.bodies[0], output)?;
            let settings = RunSettings { large, check: !no_check, ..settings(&signals, files.overwrite, &builder) };
            let (_, report) = run::run(&system, &folder, &settings, |p| {
                signals.heard(p);
                bar.run(p);
            })?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Resume { file, files, no_check, json } => {
            GivenFile::expect(&file, &[GivenFile::Results], "the unfinished results file of a run")?;
            let settings = RunSettings { check: !no_check, ..settings(&signals, files.overwrite, &builder) };
            let report = run::resume(&file, &settings, |p| {
                signals.heard(p);
                bar.run(p);
            })?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Check { file, rows, write, json } => {
            GivenFile::expect(&file, &[GivenFile::Results], RESULTS)?;
            if write {
                check::expect_finished(&file)?;
            }
            let rows = if rows.is_empty() { CheckRows::Worst } else { CheckRows::Given(rows) };
            let report = check::check(&file, &builder, &rows, |p| bar.check(p))?;
            drop(bar);
            output::print(&report, json)?;
            if write { Ok(check::write_card(&report)?) } else { Ok(()) }
        }
        Command::Reduce { scene: SceneArgs { scene, json }, output, files, solver, matrices, stress } => {
            output::require_file("--output", Some(&output))?;
            let scene = read(scene)?;
            if let Some(to) = solver.take(&mut builder, signals.slepc())? {
                return write_only(&scene, &builder, &to, files.overwrite, bar);
            }
            if let Some(form) = Form::of(&output) {
                outputs_of_scene(&scene, &builder, files.overwrite).claim_as(&form.written(), &output)?;
                let report = hand_over::hand_over(&scene, &builder, form, &output, |p| bar.build(p))?;
                drop(bar);
                output::print(&report, json)?;
                return if json { Ok(()) } else { output::list(&[output]) };
            }
            outputs_of_scene(&scene, &builder, files.overwrite).claim_as(&Written::BODY, &output)?;
            let report = modes::reduce(&scene, &builder, &output, matrices, stress, |p| bar.build(p))?;
            drop(bar);
            output::print(&report, json)?;
            if json { Ok(()) } else { output::list(&[output]) }
        }
        Command::Fmu { scene: SceneArgs { scene, json }, output, files, library } => {
            output::require_file("--output", Some(&output))?;
            let system = scene.read_system_or_body()?;
            if !json {
                output::doubts(plausible::doubts_of_system(&system));
            }
            let outputs = outputs_of_scenes(&system.bodies, &builder, files.overwrite);
            outputs.and_input(&fmu::library_path(library.as_deref())).claim_as(&Written::FMU, &output)?;
            let report = fmu::pack(&system, &builder, &output, &FmuSettings { library }, |p| bar.build(p))?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Modes { scene: SceneArgs { scene, json }, flexible, about, mac, time, output, files, solver } => {
            output::require_file("--output", output.as_deref())?;
            let mut system = read_system(scene)?;
            if mac.is_some() && system.bodies.len() > 1 {
                return Err(CliError::Option {
                    option: "--mac",
                    found: format!("a scene of {} bodies", system.bodies.len()),
                    expected: "a scene of one body, to compare it with another one".to_owned(),
                    help: "name one: --body NAME".to_owned(),
                }
                .into());
            }
            if let Some(time) = time {
                check_time(&system, time)?;
            }
            if let Some(count) = flexible {
                system.bodies.iter_mut().for_each(|scene| scene.modes.flexible = Flexible::Count(count));
            }
            let scenes = &system.bodies;
            if let Some(to) = solver.take_of(scenes, &mut builder, signals.slepc())? {
                return write_only(&scenes[0], &builder, &to, files.overwrite, bar);
            }
            output.iter().try_for_each(|folder| Written::FOLDER.check(folder)).map_err(OutputError::from)?;
            let picture = |folder: &PathBuf, scene: &Scene| match &scene.name {
                Some(body) => folder.join(format!("modes.{body}")),
                None => folder.join("modes"),
            };
            if let Some(folder) = output.as_ref().filter(|_| !system.has_connections()) {
                scenes.iter().try_for_each(modes::require_surface)?;
                let pictures: Vec<_> =
                    scenes.iter().flat_map(|scene| figures::files(&picture(folder, scene))).collect();
                outputs_of_scenes(scenes, &builder, files.overwrite).claim(&pictures)?;
            }
            let make_folder = |folder: &PathBuf| {
                std::fs::create_dir_all(folder)
                    .map_err(|source| run::RunError::Folder { folder: folder.clone(), source })
            };
            let (mut reports, mut pictures) = (Vec::new(), Vec::new());
            if system.has_connections() {
                let models = system_modes::build(&system, &builder, |p| bar.build(p))
                    .map_err(|error| of_option(error.into(), flexible))?;
                let systems = system_modes::system_modes(&system, &models, time)?;
                let number = systems.len();
                for (k, modes) in systems.iter().enumerate() {
                    let Some(folder) = &output else { continue };
                    make_folder(folder)?;
                    let name = if number == 1 { "modes".to_owned() } else { format!("modes.system{}", k + 1) };
                    let stem = folder.join(name);
                    let fields = stem.with_extension("vtkhdf");
                    let all: Vec<PathBuf> = figures::files(&stem).into_iter().chain([fields.clone()]).collect();
                    outputs_of_scenes(scenes, &builder, files.overwrite).claim(&all)?;
                    pictures.extend(system_modes::draw(&system, &models, modes, &stem)?.into_iter().flatten());
                    if system_modes::write_fields(&system, &models, modes, &fields, files.overwrite)? {
                        pictures.push(fields);
                    }
                }
                let is_tied = |number: &usize| systems.iter().any(|modes| modes.bodies.contains(number));
                for scene in (0..scenes.len()).filter(|number| !is_tied(number)).map(|number| &scenes[number]) {
                    let (_, report) = modes::modes(scene, &builder, about, |p| bar.build(p))
                        .map_err(|error| of_option(error.into(), flexible))?;
                    reports.push((scene.name.clone(), report));
                }
                let systems = systems.into_iter().map(|modes| modes.report).collect();
                drop(bar);
                output::print(&ModesOfSystems { systems, bodies: reports }, json)?;
                return if json { Ok(()) } else { output::list(&pictures) };
            }
            for scene in scenes {
                let (model, mut report) = modes::modes(scene, &builder, about, |p| bar.build(p))
                    .map_err(|error| of_option(error.into(), flexible))?;
                if let Some(other) = &mac {
                    report.mac = Some(modes::mac(scene, &model, other, &builder, |p| bar.build(p))?);
                }
                if let Some(folder) = output.as_ref().filter(|_| model.meshed.is_some() || scenes.len() == 1) {
                    make_folder(folder)?;
                    pictures.extend(mode_shapes::draw(scene, &model, &picture(folder, scene))?);
                }
                reports.push((scene.name.clone(), report));
            }
            drop(bar);
            output::print(&OfBodies(reports), json)?;
            if json { Ok(()) } else { output::list(&pictures) }
        }
        Command::Advise { scene: SceneArgs { scene, json }, verify } => {
            let system = read_system(scene)?;
            let mut reports = Vec::new();
            for scene in &system.bodies {
                let report = advise::advise(scene, &builder, verify, |p| bar.advise(p))?;
                reports.push((scene.name.clone(), report));
            }
            if system.has_connections() {
                let systems = system_modes::system_advice(&system, &builder, |p| bar.build(p))?;
                drop(bar);
                return output::print(&AdviceOnSystems { bodies: reports, systems }, json);
            }
            drop(bar);
            output::print(&OfBodies(reports), json)
        }
        Command::Campbell {
            scene: SceneArgs { scene, json },
            axis,
            joint,
            speeds,
            orders,
            about_rest,
            flexible,
            output,
            files,
        } => {
            output::require_file("--output", output.as_deref())?;
            let mut system = scene.clone().read_system()?;
            if system.bodies.len() > 1 && !system.has_connections() {
                system = read(scene)?.into();
            } else {
                tell_doubts(&system);
            }
            if let Some(count) = flexible {
                system.bodies.iter_mut().for_each(|scene| scene.modes.flexible = Flexible::Count(count));
            }
            let Some(scene) = system.bodies.first() else { return Err(run::RunError::NoBody.into()) };
            let folder = folder(scene, output)?;
            outputs_of_scenes(&system.bodies, &builder, files.overwrite).claim(&campbell::files(&folder))?;
            let report = if system.has_connections() {
                let settings = SystemCampbellSettings { axis, joint, speeds, orders };
                campbell::campbell_of_system(&system, &builder, &folder, &settings, |p| bar.campbell(p))
            } else {
                let axis = axis.ok_or_else(|| CliError::Option {
                    option: "--axis",
                    found: "none".to_owned(),
                    expected: "the axis of the spin, in the axes of the mesh".to_owned(),
                    help: "give x, y, z, or three numbers such as 0,0.6,0.8".to_owned(),
                })?;
                let settings = CampbellSettings { axis, speeds, orders, about_rest };
                campbell::campbell(scene, &builder, &folder, &settings, |p| bar.campbell(p))
            };
            let report = report.map_err(|error| of_option(error, flexible))?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Srs { table, frequencies, damping, output, files, json } => {
            GivenFile::expect(
                &table,
                &[GivenFile::Table],
                "a CSV file of times and accelerations (docs/reference/cli.md)",
            )?;
            output::require_file("--output", output.as_deref())?;
            if let Some(folder) = &output {
                Written::FOLDER.check(folder)?;
            }
            let folder = output.unwrap_or_else(|| Path::new("out").join(table.file_stem().unwrap_or("srs".as_ref())));
            Outputs::new(vec![table.clone()], files.overwrite).claim(&srs::files(&folder))?;
            let report = srs::srs(&table, &folder, &SrsSettings { frequencies, damping_ratios: damping })?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Linearize { scene: SceneArgs { scene, json }, about, reduce, output, files } => {
            output::require_file("--output", output.as_deref())?;
            let system = read_system(scene)?;
            let file = match output {
                Some(file) => file,
                None => folder(&system.bodies[0], None)?.join("linear.mat"),
            };
            outputs_of_scenes(&system.bodies, &builder, files.overwrite).claim(std::slice::from_ref(&file))?;
            let report = linearize::linearize(&system, &builder, &about.settings(), reduce, &file, |p| bar.build(p))?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Frf { scene: SceneArgs { scene, json }, about, frequencies, log, structural, output, files } => {
            output::require_file("--output", output.as_deref())?;
            let system = read_system(scene)?;
            let folder = folder(&system.bodies[0], output)?;
            outputs_of_scenes(&system.bodies, &builder, files.overwrite).claim(&frf::files(&folder))?;
            let settings =
                FrfSettings { linear: about.settings(), frequencies, logarithmic: log, loss_factor: structural };
            let report = frf::frf(&system, &builder, &folder, &settings, |p| bar.build(p))?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Psd { scene: SceneArgs { scene, json }, spectra, about, outputs, band, structural, output, files } => {
            GivenFile::expect(
                &spectra,
                &[GivenFile::Table],
                "a CSV file of frequencies and densities (docs/reference/cli.md)",
            )?;
            output::require_file("--output", output.as_deref())?;
            let system = read_system(scene)?;
            let folder = folder(&system.bodies[0], output)?;
            let read = system.bodies.iter().flat_map(|scene| builder.files(scene)).chain([spectra.clone()]);
            Outputs::new(read.collect(), files.overwrite).claim(&psd::files(&folder))?;
            let settings = PsdSettings { linear: about.settings(Vec::new(), outputs), band, loss_factor: structural };
            let report = psd::psd(&system, &builder, &spectra, &folder, &settings, |p| bar.build(p))?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Shock { scene: SceneArgs { scene, json }, table, input, about, outputs } => {
            GivenFile::expect(&table, &[GivenFile::Table], "a CSV file of times and values (docs/reference/cli.md)")?;
            let system = read_system(scene)?;
            let settings = about.settings(vec![input], outputs);
            let report = shock::shock(&system, &builder, &table, &settings, |p| bar.build(p))?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Gradient { scene: SceneArgs { scene, json }, parameters, frequencies, flexible, output, files } => {
            output::require_file("--output", output.as_deref())?;
            let system = read_one(scene, flexible)?;
            let folder = folder(&system.bodies[0], output)?;
            let settings = GradientSettings { parameters, frequencies };
            outputs_of_scenes(&system.bodies, &builder, files.overwrite).claim(&gradient::files(&folder, &settings))?;
            let report = gradient::gradient(&system, &builder, &folder, &settings, |p| bar.build(p));
            let report = report.map_err(|error| match error {
                GradientError::Build(error) => of_option(error.into(), flexible),
                error => error.into(),
            })?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Fit { scene: SceneArgs { scene, json }, measured, parameters, deviation, flexible, output, files } => {
            output::require_file("--output", output.as_deref())?;
            let system = read_one(scene, flexible)?;
            if let Some(output) = &output {
                let mut outputs = outputs_of_scenes(&system.bodies, &builder, files.overwrite);
                if let Some(measured) = &measured {
                    outputs = outputs.and_input(measured);
                }
                outputs.claim_as(&Written::SCENE, output)?;
                check_beside(&system.bodies[0], output)?;
            }
            let measured = measured.as_deref().map(Measured::read).transpose()?;
            let settings = FitSettings { parameters, measured, deviation };
            let mut report = fit::fit(&system, &builder, &settings, |p| bar.build(p)).map_err(|error| match error {
                FitError::Build(error) => of_option(error.into(), flexible),
                error => error.into(),
            })?;
            if let Some(output) = &output {
                report.write_scene(output)?;
            }
            drop(bar);
            output::print(&report, json)
        }
        Command::Paper { scene: SceneArgs { scene, json }, output, files } => {
            output::require_file("--output", output.as_deref())?;
            let scene = read(scene)?;
            let settings = RunSettings { check: true, ..settings(&signals, files.overwrite, &builder) };
            let folder = folder(&scene, output)?;
            outputs_of_scene(&scene, &builder, files.overwrite).claim(&paper::files(&folder))?;
            let report = paper::reproduce(&scene, &folder, &settings, |p| {
                signals.heard(p);
                bar.run(p);
            })?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Cost { scene: SceneArgs { scene, json }, output, files, target, patience } => {
            output::require_file("--output", output.as_deref())?;
            let system = read_system(scene)?;
            let settings = CostSettings { target, ..CostSettings::with_patience(patience) };
            let folder = folder(&system.bodies[0], output)?;
            outputs_of_scenes(&system.bodies, &builder, files.overwrite).claim(&cost::files(&folder))?;
            let report = cost::price_list(&system, &builder, &folder, settings, |p| bar.cost(p))?;
            drop(bar);
            output::print(&report, json)
        }
        Command::Export { file, csv, columns, vtkhdf, vtu, modes, volume, from, to, every, files } => {
            GivenFile::expect(&file, &[GivenFile::Results], RESULTS)?;
            output::require_file("--vtkhdf", vtkhdf.as_deref())?;
            output::require_file("--vtu", vtu.as_deref())?;
            output::require_file("--modes", modes.as_deref())?;
            let rows = ExportRows {
                from,
                to,
                every: usize::try_from(every).unwrap_or(usize::MAX),
                overwrite: files.overwrite,
            };
            let mut done = Vec::new();
            let to_standard = csv.as_deref().is_some_and(output::is_standard);
            if to_standard {
                let (table, warning) = export::csv_text(&file, &columns, &rows)?;
                output::doubts(warning);
                output::text(&table)?;
            }
            if let Some(csv) = csv.filter(|_| !to_standard) {
                done.push(export::export_csv(&file, &csv, &columns, &rows)?);
            }
            if vtkhdf.is_some() || vtu.is_some() || modes.is_some() {
                let motion = Motion::open(&file, volume)?;
                let mut moved = |part: f64| bar.run(RunProgress::Motion(part));
                if let Some(vtkhdf) = vtkhdf {
                    done.push(export::export_vtkhdf(&file, &motion, &vtkhdf, &rows, &mut moved)?);
                }
                if let Some(vtu) = vtu {
                    done.push(export::export_vtu(&file, &motion, &vtu, &rows, &mut moved)?);
                }
                if let Some(modes) = modes {
                    done.push(export::export_modes(&file, &motion, &modes, &rows)?);
                }
            }
            drop(bar);
            for Exported { files, warning } in done {
                output::list(&files)?;
                output::warn(warning.as_deref())?;
            }
            Ok(())
        }
        Command::Report { file, output, live, compare, files } => {
            for file in [&file].into_iter().chain(&compare) {
                GivenFile::expect(file, &[GivenFile::Results], RESULTS)?;
            }
            let mut contents = || match &compare {
                Some(other) => html_report::compared_contents(&file, other),
                None if live => html_report::live_contents(&file, &builder, |p| bar.build(p)),
                None => html_report::contents(&file),
            };
            if output.as_deref().is_some_and(output::is_standard) {
                let page = html_report::page(&contents()?)?;
                drop(bar);
                return Ok(output::text(&page)?);
            }
            let output = output.unwrap_or_else(|| file.with_extension("html"));
            let mut outputs = outputs_of_results(&file, files.overwrite);
            if let Some(other) = &compare {
                outputs = outputs.and_input(other);
            }
            outputs.claim_as(&Written::PAGE, &output)?;
            html_report::write(&contents()?, &output)?;
            drop(bar);
            output::list(&[output])
        }
        Command::Play { scene, port } => {
            let system = read_system(scene)?;
            let served = Served::new(port)?;
            let folder = tempfile::tempdir().map_err(CliError::Folder)?;
            let settings = RunSettings { check: false, ..settings(&signals, true, &builder) };
            let (_, report) = run::run(&system, folder.path(), &settings, |p| {
                signals.heard(p);
                bar.run(p);
            })?;
            let contents = html_report::live_contents(&report.results, &builder, |p| bar.build(p))?;
            let page = html_report::page(&contents)?;
            drop((bar, contents));
            output::line(&format!("  page     {} (Ctrl-C ends it)", served.address()))?;
            Ok(served.serve(&page, &signals.stop())?)
        }
        Command::Sweep { sweep: file, output, shard, merge, slurm, files: FileArgs { overwrite }, large, json } => {
            GivenFile::expect(&file, &[GivenFile::Sweep], "the file of a sweep (docs/reference/cli.md)")?;
            output::require_file("--output", output.as_deref())?;
            let output = output.unwrap_or_else(|| {
                Path::new("out").join(file.file_stem().unwrap_or("sweep".as_ref())).with_extension("h5")
            });
            if let Some(count) = slurm {
                let script = sweep::slurm_script(&file, &output, count.into());
                return Ok(output::written(write!(std::io::stdout(), "{script}"))?);
            }
            let report = match merge {
                Some(count) => sweep::merge(&file, &output, count.into(), overwrite)?,
                None => {
                    let threads = rayon::current_num_threads();
                    let settings = SweepSettings { overwrite, large, threads, builder, shard };
                    sweep::sweep(&file, &output, &settings, |p| bar.sweep(p))?
                }
            };
            drop(bar);
            output::print(&report, json)?;
            Ok(report.require_a_row()?)
        }
        Command::Animate { scene, output, files, frames, from, to, mode, colour, view, magnify } => {
            output::require_file("--output", Some(&output))?;
            let coloured = match colour {
                Colour::Displacement => Coloured::Displacement,
                Colour::Stress => Coloured::Stress,
            };
            let view = view.unwrap_or_default();
            let settings = AnimationSettings { frames, magnification: magnify, from, to, view, coloured };
            let warning = match scene.results()? {
                Some(_) if mode.is_some() => {
                    return Err(CliError::Option {
                        option: "--mode",
                        found: "a results file".to_owned(),
                        expected: "a scene".to_owned(),
                        help: "name the scene of the run, whose modes are found again".to_owned(),
                    }
                    .into());
                }
                Some(file) => {
                    outputs_of_results(file, files.overwrite).claim_as(&Written::ANIMATION, &output)?;
                    animate_results(file, &output, settings, |p| bar.run(p))?
                }
                None => {
                    let mut system = read_system(scene)?;
                    system.bodies = system.bodies.into_iter().map(Scene::without_rows).collect();
                    outputs_of_scenes(&system.bodies, &builder, files.overwrite)
                        .claim_as(&Written::ANIMATION, &output)?;
                    match mode {
                        Some(mode) => {
                            let mode = usize::try_from(mode).unwrap_or(usize::MAX);
                            animate_mode(&system, &builder, mode, &output, settings, |p| bar.run(p))?;
                            None
                        }
                        None => animate(&system, &builder, &output, settings, |p| bar.run(p))?,
                    }
                }
            };
            drop(bar);
            output::list(&[output])?;
            output::warn(warning.as_deref())
        }
    }
}

/// Writes the modes that a scene asks for as a problem for SLEPc.
fn write_only(
    scene: &Scene,
    builder: &Builder,
    to: &WriteOnly,
    overwrite: bool,
    mut bar: Bar,
) -> Result<(), Box<dyn Error>> {
    Written::FOLDER.check(&to.folder).map_err(OutputError::from)?;
    outputs_of_scene(scene, builder, overwrite).claim(&files_of_folder(&to.folder))?;
    let files = modes::write_problem(scene, builder, &to.folder, to.ranks, |p| bar.build(p))?;
    drop(bar);
    output::list(&files)
}

/// The exit codes as a part of the help.
fn exit_codes() -> String {
    let line = |kind: &Kind| format!("\n  {:>3}  {}", kind.exit_code(), kind.meaning());
    let codes: String = Kind::ALL.iter().map(line).collect();
    format!("Exit codes:\n    0  done{codes}")
}

/// Kind of file that export and report take.
const RESULTS: &str = "a results file of `flexframe run`";

/// A number of modes.
fn mode_count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| *count > 0);
    count.ok_or_else(|| "expected a whole number, 1 or more, such as 10".to_owned())
}

/// A finite number.
fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "expected a finite number".to_owned())
}

/// A time of a run.
fn at_time(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|time| *time >= 0.0).ok_or_else(|| "expected a time, 0 or more".to_owned())
}

/// Refuses a time of a run that bodies which nothing ties do not need, and one after its end.
fn check_time(system: &System, time: f64) -> Result<(), CliError> {
    let end = system.bodies.iter().map(|scene| scene.time.end).fold(0.0, f64::max);
    let (found, expected, help) = if !system.has_connections() {
        let help = "leave it out: a body alone has the same modes wherever it is";
        ("a scene of bodies that nothing ties together".to_owned(), "joints, springs or bushings".to_owned(), help)
    } else if time > end {
        (
            format!("{time}"),
            format!("at most the end of the run, {end}"),
            "change `end` in [time], or ask for an earlier time",
        )
    } else {
        return Ok(());
    };
    Err(CliError::Option { option: "--time", found, expected, help: help.to_owned() })
}

/// A number above zero.
fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|number| *number > 0.0).ok_or_else(|| "expected a positive number".to_owned())
}

/// Seconds that are worth measuring, and that someone may wait for.
fn patience(text: &str) -> Result<Duration, String> {
    let seconds = finite(text).ok().filter(|seconds| (1e-3..=1e6).contains(seconds));
    seconds
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| "expected a number of seconds from 0.001 to 1000000".to_owned())
}

/// An angular velocity by its components.
fn angular_velocity(text: &str) -> Result<[f64; 3], String> {
    three_numbers(text).ok_or_else(|| "expected three finite numbers, such as 0,0,6.3".to_owned())
}

/// An axis by its name, or by three numbers.
fn axis(text: &str) -> Result<[f64; 3], String> {
    let named = match text {
        "x" => Some([1.0, 0.0, 0.0]),
        "y" => Some([0.0, 1.0, 0.0]),
        "z" => Some([0.0, 0.0, 1.0]),
        _ => None,
    };
    named
        .or_else(|| three_numbers(text).filter(|v| *v != [0.0; 3]))
        .ok_or_else(|| "expected x, y, z, or three numbers that are not all zero, such as 0,0.6,0.8".to_owned())
}

/// Three finite numbers.
fn three_numbers(text: &str) -> Option<[f64; 3]> {
    let parts = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|part| !part.is_empty());
    let numbers: Vec<f64> = parts.map(str::parse).collect::<Result<_, _>>().ok()?;
    <[f64; 3]>::try_from(numbers).ok().filter(|v| v.iter().all(|x| x.is_finite()))
}

/// A point by its coordinates.
fn point(text: &str) -> Result<[f64; 3], String> {
    three_numbers(text).ok_or_else(|| "expected three numbers, such as 0,0,1.5".to_owned())
}

/// Where a viewer is: on an axis, or at two angles.
fn view(text: &str) -> Result<View, String> {
    let angles = || {
        let (azimuth, elevation) = text.split_once(',')?;
        Some((finite(azimuth.trim()).ok()?, finite(elevation.trim()).ok()?))
    };
    let by_angles = || match angles() {
        Some((azimuth, elevation)) if (-90.0..=90.0).contains(&elevation) => Some(View { azimuth, elevation }),
        _ => None,
    };
    View::named(text).or_else(by_angles).ok_or_else(|| {
        "expected iso, xy, xz, yz, x, y, z, -x, -y, -z, or two angles in degrees, the second from -90 to 90, such as -60,25"
            .to_owned()
    })
}

/// About what the vibrations of a spinning body are.
fn about_rest(text: &str) -> Result<AboutRest, String> {
    match text {
        "auto" => Ok(AboutRest::Auto),
        "always" => Ok(AboutRest::Always),
        "never" => Ok(AboutRest::Never),
        _ => Err("expected auto, always or never".to_owned()),
    }
}

/// Speeds as start:end:count.
fn speeds(text: &str) -> Result<Speeds, String> {
    let parts: Vec<&str> = text.split(':').collect();
    let speeds = match parts[..] {
        [start, end, count] => match (start.parse(), end.parse(), count.parse()) {
            (Ok(start), Ok(end), Ok(count)) => Some(Speeds { start, end, count }),
            _ => None,
        },
        _ => None,
    };
    speeds.ok_or_else(|| "expected start:end:count, such as 0:200:50".to_owned())
}

fn frequencies(text: &str) -> Result<Frequencies, String> {
    let Speeds { start, end, count } = speeds(text).map_err(|_| "expected start:end:count, such as 1:2000:200")?;
    Ok(Frequencies { start, end, count })
}

/// A band of frequencies.
fn band(text: &str) -> Result<[f64; 2], String> {
    let expected = || "expected start:end, such as 20:2000".to_owned();
    let (start, end) = text.split_once(':').ok_or_else(expected)?;
    let [start, end] = [start, end].map(|number| finite(number.trim()));
    Ok([start.map_err(|_| expected())?, end.map_err(|_| expected())?])
}

/// The refusal of a number of modes, at the option where that has replaced what the scene says.
fn of_option(error: CampbellError, flexible: Option<usize>) -> Box<dyn Error> {
    match (error, flexible) {
        (CampbellError::Build(BuildError::Scene(SceneError::Invalid { at, found, expected, help })), Some(_))
            if at.key == "modes.flexible" =>
        {
            CliError::Option { option: "--flexible", found, expected, help }.into()
        }
        (error, _) => error.into(),
    }
}

/// Refuses a scene in another folder than that of the scene which it is made of: its paths are relative to it.
fn check_beside(scene: &Scene, output: &Path) -> Result<(), CliError> {
    let folder = |path: &Path| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        parent.canonicalize().ok()
    };
    if folder(&scene.path).is_some_and(|own| folder(output) == Some(own)) {
        return Ok(());
    }
    Err(CliError::Option {
        option: "--output",
        found: format!("{}, in another folder than the scene", output.display()),
        expected: "a file beside the scene, since the paths in it are relative to its folder".to_owned(),
        help: "leave --output out, and set the values with --set, or name a file beside the scene".to_owned(),
    })
}

/// The folder asked for, or one named after the scene.
fn folder(scene: &Scene, output: Option<PathBuf>) -> Result<PathBuf, OutputError> {
    if let Some(folder) = &output {
        Written::FOLDER.check(folder)?;
    }
    Ok(output.unwrap_or_else(|| Path::new("out").join(scene.path.file_stem().unwrap_or("scene".as_ref()))))
}
