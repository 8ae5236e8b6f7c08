//! The page of all commands and options, made of what `--help` is made of.

use std::fmt::Write;

use clap::{Arg, Command, CommandFactory};

use super::{cell, is_made};
use crate::cli::Cli;

#[test]
fn the_page_of_commands_is_what_the_program_has() {
    is_made("docs/reference/commands.md", &page());
}

fn page() -> String {
    let mut program = Cli::command();
    program.build();
    let mut page = "# All commands and options\n\nMade of the program's own help by `./dev reference`. \
         [The command line](cli.md) has exit codes, output and what needs more words.\n\n\
         These options go with every command:\n\n"
        .to_owned();
    page += &table(program.get_arguments().filter(|argument| argument.is_global_set()).map(row));
    let commands: Vec<&Command> = program.get_subcommands().filter(|command| command.get_name() != "help").collect();
    let all: Vec<(String, String)> = commands.iter().flat_map(|command| arguments(command)).map(row).collect();
    let of_many =
        |row: &(String, String)| row.0.starts_with('-') && all.iter().filter(|other| *other == row).count() >= 3;
    let mut shared: Vec<(String, String)> = Vec::new();
    for row in all.iter().filter(|row| of_many(row)) {
        if !shared.contains(row) {
            shared.push(row.clone());
        }
    }
    page += "\n## Options of several commands\n\nEach of these commands names the ones that it takes.\n\n";
    page += &table(shared.into_iter());
    for command in commands {
        let about = command.get_long_about().or(command.get_about()).map(ToString::to_string).unwrap_or_default();
        let _ = writeln!(page, "\n## {}\n\n{}\n", command.get_name(), about.trim());
        let usage = command.clone().render_usage().to_string();
        let _ = writeln!(page, "`{}`\n", usage.trim());
        let (many, own): (Vec<_>, Vec<_>) = arguments(command).map(row).partition(of_many);
        page += &table(own.into_iter());
        if !many.is_empty() {
            let names: Vec<String> = many.iter().map(|(name, _)| format!("`{name}`")).collect();
            let _ = writeln!(page, "\n[As other commands](#options-of-several-commands): {}.", names.join(", "));
        }
    }
    page
}

fn arguments(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|argument| {
        !argument.is_global_set()
            && !argument.is_hide_set()
            && !["help", "version"].contains(&argument.get_id().as_str())
    })
}

/// Name and meaning of an option.
fn row(argument: &Arg) -> (String, String) {
    (name(argument).replace('|', "\\|"), meaning(argument))
}

fn table(options: impl Iterator<Item = (String, String)>) -> String {
    let rows: String = options.map(|(name, meaning)| format!("| `{name}` | {meaning} |\n")).collect();
    if rows.is_empty() { rows } else { format!("| option | meaning |\n|---|---|\n{rows}") }
}

/// `-o, --output <DIR>`, or the name of an argument without dashes.
fn name(argument: &Arg) -> String {
    let values: Vec<String> =
        argument.get_value_names().unwrap_or_default().iter().map(|name| format!("<{name}>")).collect();
    let takes = argument.get_action().takes_values();
    let value = if takes { values.join(" ") } else { String::new() };
    let short = argument.get_short().map(|short| format!("-{short}"));
    let long = argument.get_long().map(|long| format!("--{long}"));
    let names: Vec<String> = short.into_iter().chain(long).collect();
    format!("{} {value}", names.join(", ")).trim().to_owned()
}

fn meaning(argument: &Arg) -> String {
    let help = argument.get_long_help().or(argument.get_help()).map(ToString::to_string).unwrap_or_default();
    let mut text = cell(&help);
    let possible = argument.get_possible_values();
    if argument.get_action().takes_values() && !possible.is_empty() {
        let values: Vec<String> = possible.iter().map(|value| format!("`{}`", value.get_name())).collect();
        let _ = write!(text, " One of {}.", values.join(", "));
    }
    let defaults: Vec<_> = argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if argument.get_action().takes_values() && !defaults.is_empty() {
        let _ = write!(text, " Default: `{}`.", defaults.join(" "));
    }
    text
}
