//! The command line tool `ltc`: fits, keeps, serves and uses tables of linearly transformed cosines.

/// Prints to stdout; an error where `print!` would panic, as when the reader has gone.
macro_rules! out {
    ($($text:tt)*) => { std::io::Write::write_fmt(&mut std::io::stdout(), format_args!($($text)*))? };
}
/// The same with a line break.
macro_rules! outln {
    ($($text:tt)*) => { out!("{}\n", format_args!($($text)*)) };
}

mod commands;
mod fit_progress;
mod interrupt;
mod json_lines;
mod picture;
mod progress;
mod shaders;
mod tables;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::tables::Tables;

/// Area lights with real materials: fit, keep, serve and use tables of linearly transformed cosines.
#[derive(Parser)]
#[command(name = "ltc", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    tables: Tables,
}

#[derive(Subcommand)]
enum Command {
    Serve(commands::serve::Serve),
    Fit(commands::fit::Fit),
    Tables(commands::tables::List),
    Inspect(commands::tables::Inspect),
    Diff(commands::diff::Diff),
    Verify(commands::verify::Verify),
    Lookup(commands::lookup::Lookup),
    Integrate(commands::integrate::Integrate),
    Export(commands::export::Export),
    Render(commands::render::Render),
    Shader(commands::shader::Shader),
    Probe(commands::probe::Probe),
    Bench(commands::bench::Bench),
    Token(commands::token::Tokens),
    Backup(commands::backup::Backup),
    Restore(commands::backup::Restore),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let tables = &cli.tables;
    let result = match cli.command {
        Command::Serve(command) => command.run(tables),
        Command::Fit(command) => command.run(),
        Command::Tables(command) => command.run(tables),
        Command::Inspect(command) => command.run(tables),
        Command::Diff(command) => command.run(tables),
        Command::Verify(command) => command.run(tables),
        Command::Lookup(command) => command.run(tables),
        Command::Integrate(command) => command.run(tables),
        Command::Export(command) => command.run(tables),
        Command::Render(command) => command.run(tables),
        Command::Shader(command) => command.run(),
        Command::Probe(command) => command.run(),
        Command::Bench(command) => command.run(tables),
        Command::Token(command) => command.run(),
        Command::Backup(command) => command.run(),
        Command::Restore(command) => command.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) if error.is::<interrupt::Interrupted>() => {
            eprintln!("{}", one_line(&error));
            error
                .downcast_ref::<interrupt::Interrupted>()
                .map_or(ExitCode::FAILURE, interrupt::Interrupted::exit_code)
        }
        Err(error) => {
            eprintln!("error: {}", one_line(&error));
            ExitCode::FAILURE
        }
    }
}

/// An error with its causes, those left out that an error before them tells already. One line, whatever the cause: names
/// from outside may hold line breaks.
fn one_line(error: &anyhow::Error) -> String {
    let mut line = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !line.contains(&cause) {
            line = if line.is_empty() { cause } else { format!("{line}: {cause}") };
        }
    }
    line.replace(['\n', '\r'], " ")
}

/// Whoever read our output has had enough, as `head` does.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let io = error.downcast_ref::<std::io::Error>();
    io.is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
}
