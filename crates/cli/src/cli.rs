//! The command line: options of the program, and its commands.

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};
use diagnostic::{Failure, Kind};
use flexframe::failure::FailureReport;
use model::{Builder, Cache};
use toml::Value;

use crate::cli_error;
use crate::commands::{
    advise, campbell, check, cost, equilibrium, fmu, linear, modes, new, paper, pictures, reduce, resume, run, sweep,
    verify,
};
use crate::progress::Bar;
use crate::session::Session;
use crate::signals::Signals;
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
    New(new::New),
    Run(run::Run),
    Resume(resume::Resume),
    Check(check::Check),
    Reduce(reduce::Reduce),
    Fmu(fmu::Fmu),
    Equilibrium(equilibrium::Equilibrium),
    Modes(modes::Modes),
    Advise(advise::Advise),
    Campbell(campbell::Campbell),
    Srs(linear::srs::Srs),
    Linearize(linear::linearize::Linearize),
    Frf(linear::frf::Frf),
    Psd(linear::psd::Psd),
    Shock(linear::shock::Shock),
    Gradient(linear::gradient::Gradient),
    Fit(linear::fit::Fit),
    Paper(paper::Paper),
    Cost(cost::Cost),
    Export(pictures::export::Export),
    Report(pictures::report::Report),
    Play(pictures::play::Play),
    Sweep(sweep::Sweep),
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
    Animate(pictures::animate::Animate),
    Verify(verify::Verify),
}

pub fn main() -> ExitCode {
    // A wrong command line has to be reported before it is parsed to its end.
    let json = std::env::args_os().skip(1).take_while(|argument| argument != "--").any(|argument| argument == "--json");
    let mut command = Cli::command();
    let parsed = command.try_get_matches_from_mut(std::env::args_os()).and_then(|mut matches| {
        let set = values_set(&matches);
        let cli = Cli::from_arg_matches_mut(&mut matches).map_err(|error| error.format(&mut command))?;
        Ok((cli, set))
    });
    let done = match parsed {
        Ok((cli, set)) => execute(cli, json).map_err(|error| cli_error::report(&*error, &set)),
        Err(error) if error.use_stderr() && !json => {
            // Where it cannot be written, the exit code still tells.
            let _ = error.print();
            return ExitCode::from(Kind::Usage.exit_code());
        }
        Err(error) if error.use_stderr() => {
            let text = error.render().to_string();
            let message = text.trim().strip_prefix("error: ").unwrap_or(text.trim());
            Err(FailureReport::new(message, Kind::Usage.alone()))
        }
        // The help or the version was asked for.
        Err(asked) => output::written(asked.print()).map_err(|error| FailureReport::of(&*error)),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(report) => {
            output::report(&report, json);
            ExitCode::from(report.exit_code())
        }
    }
}

/// The values of `--set`.
fn values_set(matches: &ArgMatches) -> Vec<(String, Value)> {
    let of_command = matches.subcommand().and_then(|(_, of_command)| of_command.try_get_many("set").ok().flatten());
    of_command.into_iter().flatten().cloned().collect()
}

fn execute(cli: Cli, json: bool) -> Result<(), Failure> {
    let cache = if cli.no_cache { Cache::none() } else { Cache::of_user() };
    let builder = Builder { trust_geometry: cli.trust_geometry, ..Builder::with_cache(cache.clone()) };
    let done = command(cli, json, builder);
    if !json {
        output::notes(&cache.notes());
    }
    done
}

fn command(cli: Cli, json_errors: bool, builder: Builder) -> Result<(), Failure> {
    let signals = Signals::listen(json_errors).map_err(|error| {
        let help = "allow the program another thread and a few open files";
        Kind::Io.alone().help(help).says(format!("cannot listen to signals: {error}"))
    })?;
    threads::start(cli.threads)?;
    execute_command(cli.command, Session { builder, signals, bar: Bar::new(json_errors), json_errors, taken: None })
}

/// Executes a command line that another command asks for, without the name of the program.
fn execute_words(words: &[OsString], session: Session) -> Result<(), Failure> {
    let program = OsString::from("flexframe");
    let parsed = Cli::try_parse_from(std::iter::once(&program).chain(words));
    let cli = parsed.map_err(|error| Kind::Usage.alone().says(error.render().to_string().trim().to_owned()))?;
    execute_command(cli.command, session)
}

fn execute_command(command: Command, session: Session) -> Result<(), Failure> {
    match command {
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "flexframe", &mut script);
            output::written(std::io::stdout().write_all(&script))
        }
        Command::Schema => output::text(&format!("{:#}\n", flexframe::scene::json_schema())),
        Command::New(command) => command.execute(session),
        Command::Run(command) => command.execute(session),
        Command::Resume(command) => command.execute(session),
        Command::Check(command) => command.execute(session),
        Command::Reduce(command) => command.execute(session),
        Command::Fmu(command) => command.execute(session),
        Command::Equilibrium(command) => command.execute(session),
        Command::Modes(command) => command.execute(session),
        Command::Advise(command) => command.execute(session),
        Command::Campbell(command) => command.execute(session),
        Command::Srs(command) => command.execute(session),
        Command::Linearize(command) => command.execute(session),
        Command::Frf(command) => command.execute(session),
        Command::Psd(command) => command.execute(session),
        Command::Shock(command) => command.execute(session),
        Command::Gradient(command) => command.execute(session),
        Command::Fit(command) => command.execute(session),
        Command::Paper(command) => command.execute(session),
        Command::Cost(command) => command.execute(session),
        Command::Export(command) => command.execute(session),
        Command::Report(command) => command.execute(session),
        Command::Play(command) => command.execute(session),
        Command::Sweep(command) => command.execute(session),
        Command::Animate(command) => command.execute(session),
        Command::Verify(command) => command.execute(session, execute_words),
    }
}

/// The exit codes as a part of the help.
fn exit_codes() -> String {
    let line = |kind: &Kind| format!("\n  {:>3}  {}", kind.exit_code(), kind.meaning());
    let codes: String = Kind::ALL.iter().map(line).collect();
    format!("Exit codes:\n    0  done{codes}")
}
