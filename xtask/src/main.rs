//! The chores of this workspace: `cargo xtask test`, `setup`, `edges`, `demo`, `tables`.
//!
//! Every command of the README goes through this binary, so it compiles in seconds and depends on little. It only
//! starts other programs and reads what they say; the work itself is in the crates.

mod apt;
mod args;
mod demo;
mod edge_rules;
mod edges;
mod graph;
mod http;
mod interrupt;
mod listen;
mod outside;
mod process;
mod say;
mod service;
mod setup;
mod step;
mod table_copy;
mod tables;
mod test;
mod tool_box;
mod vulkan;
mod workspace;

use std::process::ExitCode;

use args::Chore;
use say::say;
use workspace::Workspace;

fn main() -> ExitCode {
    let chore = match args::parse(std::env::args().skip(1)) {
        Ok(chore) => chore,
        Err(cause) => {
            say::complain(format_args!("error: {cause} (`cargo xtask help` lists what there is)"));
            return ExitCode::from(2);
        }
    };
    match carry_out(&chore) {
        Ok(()) => ExitCode::SUCCESS,
        Err(cause) if cause.is::<interrupt::Interrupted>() => {
            say::complain("interrupted: everything that was started has been stopped");
            ExitCode::from(130)
        }
        Err(cause) => {
            say::complain(format_args!("error: {cause:#}"));
            ExitCode::FAILURE
        }
    }
}

fn carry_out(chore: &Chore) -> anyhow::Result<()> {
    interrupt::watch()?;
    if matches!(chore, Chore::Help) {
        say(args::USAGE);
        return Ok(());
    }
    let workspace = Workspace::find()?;
    match chore {
        Chore::Help => Ok(()),
        Chore::Test { fast } => test::run(&workspace, *fast),
        Chore::Setup => setup::graphics().and_then(|()| setup::compilers()),
        Chore::Edges => edges::run(&workspace),
        Chore::Demo { once, listen } => demo::run(&workspace, listen, *once),
        Chore::Tables => tables::run(&workspace),
    }
}
