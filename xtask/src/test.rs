//! `cargo xtask test`: everything that has to pass before a change lands.

use std::env;

use anyhow::Result;

use crate::say::{complain, say};
use crate::step::{Outcome, Steps};
use crate::workspace::Workspace;
use crate::{edges, outside, process, setup};

/// One thing that has to pass. To add one, add it to [`PARTS`].
struct Part {
    what: &'static str,
    /// Left out by `--fast`.
    slow: bool,
    work: fn(&Workspace) -> Result<Outcome>,
}

/// In this order: set-up first, then what is quick to fail.
const PARTS: [Part; 11] = [
    Part {
        what: "set-up: a driver for the GPU tests, compilers for exported shaders",
        slow: false,
        work: graphics,
    },
    Part { what: "set-up: what the outside readers need", slow: true, work: outside_tools },
    Part { what: "formatting: cargo fmt --check", slow: false, work: formatting },
    Part {
        what: "dependency edges: which crates may not depend on which",
        slow: false,
        work: dependency_edges,
    },
    Part { what: "lints: cargo clippy, warnings are errors", slow: false, work: lints },
    Part { what: "tests of all crates, GPU tests included", slow: false, work: tests },
    Part { what: "ten million lights made to break things: release", slow: true, work: adversarial },
    Part { what: "the client by TLS: a feature that is off in all else", slow: true, work: client_by_tls },
    Part { what: "examples in the documentation: cargo test --doc", slow: true, work: doc_tests },
    Part { what: "documentation: cargo doc, warnings are errors", slow: true, work: documentation },
    Part { what: "outside readers: the scripts in tests/outside", slow: true, work: outside::run },
];

/// Runs all parts, or with `fast` those that are not slow, and stops at the first that fails.
pub fn run(workspace: &Workspace, fast: bool) -> Result<()> {
    let (chosen, left_out): (Vec<_>, Vec<_>) = PARTS.iter().partition(|part| !(fast && part.slow));
    let mut steps = Steps::new(chosen.len(), is_build_server());
    for part in left_out {
        say(format_args!("left out by --fast: {}", part.what));
    }
    for part in chosen {
        if let Err(cause) = steps.step_or_skip(part.what, || (part.work)(workspace)) {
            complain(steps.tally(true));
            return Err(cause);
        }
    }
    say(format_args!("all of it took {}", steps.elapsed()));
    say(steps.tally(false));
    Ok(())
}

/// Build servers set `CI`.
fn is_build_server() -> bool {
    env::var("CI").is_ok_and(|value| !["", "0", "false"].contains(&value.as_str()))
}

fn graphics(_: &Workspace) -> Result<Outcome> {
    setup::graphics()?;
    setup::compilers()?;
    Ok(Outcome::Passed)
}

/// Early, so that whoever has to give a password for it is still there; the last part says what came of it.
fn outside_tools(workspace: &Workspace) -> Result<Outcome> {
    outside::prepare(workspace)?;
    Ok(Outcome::Passed)
}

fn formatting(workspace: &Workspace) -> Result<Outcome> {
    if !has(workspace, "fmt") {
        return Ok(Outcome::Skipped("rustfmt is missing: rustup component add rustfmt".to_owned()));
    }
    cargo(workspace, &["fmt", "--all", "--check"])
}

fn dependency_edges(workspace: &Workspace) -> Result<Outcome> {
    edges::run(workspace)?;
    Ok(Outcome::Passed)
}

fn lints(workspace: &Workspace) -> Result<Outcome> {
    if !has(workspace, "clippy") {
        return Ok(Outcome::Skipped("clippy is missing: rustup component add clippy".to_owned()));
    }
    cargo(workspace, &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])?;
    for (krate, features) in LEAN {
        cargo(
            workspace,
            &["clippy", "-p", krate, "--no-default-features", "--features", features, "--", "-D", "warnings"],
        )?;
    }
    Ok(Outcome::Passed)
}

/// Crates with features of their own, as somebody takes them who takes one thing alone: the workspace compiles them with everything.
const LEAN: [(&str, &str); 4] =
    [("ltc-shade-gpu", ""), ("ltc-shade-gpu", "device"), ("ltc-shade-gpu", "export"), ("ltc-render", "")];

fn tests(workspace: &Workspace) -> Result<Outcome> {
    if has(workspace, "nextest") {
        return cargo(workspace, &["nextest", "run", "--workspace"]);
    }
    say("    there is no cargo-nextest: cargo test does the same, more slowly");
    cargo(workspace, &["test", "--workspace", "--lib", "--bins", "--tests"])
}

/// The same test runs on fewer lights among all others, unoptimised.
fn adversarial(workspace: &Workspace) -> Result<Outcome> {
    cargo(workspace, &["test", "--release", "-p", "ltc-core", "--test", "adversarial"])
}

fn client_by_tls(workspace: &Workspace) -> Result<Outcome> {
    cargo(workspace, &["test", "-p", "ltc-client", "--features", "tls", "--test", "tls"])
}

fn doc_tests(workspace: &Workspace) -> Result<Outcome> {
    cargo(workspace, &["test", "--doc", "--workspace"])
}

fn documentation(workspace: &Workspace) -> Result<Outcome> {
    let mut command = workspace.cargo(["doc", "--no-deps", "--workspace"]);
    process::run(command.env("RUSTDOCFLAGS", "-D warnings"))?;
    Ok(Outcome::Passed)
}

/// Whether cargo has this subcommand.
fn has(workspace: &Workspace, subcommand: &str) -> bool {
    process::works(&mut workspace.cargo([subcommand, "--version"]))
}

fn cargo(workspace: &Workspace, args: &[&str]) -> Result<Outcome> {
    process::run(&mut workspace.cargo(args.iter().copied()))?;
    Ok(Outcome::Passed)
}
