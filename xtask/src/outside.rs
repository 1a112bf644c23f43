//! Checks by outside readers: scripts in `tests/outside/`, run against a service that is up.
//!
//! To add a check, add a script there; no list has to be edited.
//! - `NAME.py` runs in a Python with NumPy, `NAME.mjs` in a Node.js that can import ktx-parse.
//! - It finds the service's URL in `LTC_URL`, the binary in `LTC_BIN`, the folder of the shipped tables in
//!   `LTC_TABLES`, and an empty folder of its own in `LTC_SCRATCH`.
//! - It passes when it ends with 0; on a fault it prints one line and ends with another code.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result};

use crate::interrupt::Interrupted;
use crate::say::say;
use crate::service::Service;
use crate::step::Outcome;
use crate::workspace::{Profile, Workspace};
use crate::{listen, process, tool_box};

/// Where the scripts lie.
const FOLDER: &str = "tests/outside";

/// A tool that is ready, or the reason why there is none.
type Tool = Result<PathBuf, String>;

/// Puts in place what the scripts need, and nothing when there are none that need it.
pub fn prepare(workspace: &Workspace) -> Result<()> {
    for (extension, make) in makers() {
        if !scripts(workspace.root(), extension).is_empty()
            && let Err(why) = tool(make, workspace.target())?
        {
            say(format_args!("    {FOLDER}/*.{extension} cannot run here: {why}"));
        }
    }
    Ok(())
}

/// Runs every script. What cannot run is skipped, with the reason; what fails is an error.
pub fn run(workspace: &Workspace) -> Result<Outcome> {
    let mut skipped = Vec::new();
    let mut ready = Vec::new();
    for (extension, make) in makers() {
        let scripts = scripts(workspace.root(), extension);
        if scripts.is_empty() {
            continue;
        }
        match tool(make, workspace.target())? {
            Ok(tool) => ready.extend(scripts.into_iter().map(|script| (script, tool.clone()))),
            Err(why) => skipped.push(why),
        }
    }
    if ready.is_empty() && skipped.is_empty() {
        return Ok(Outcome::Skipped(format!("{FOLDER} has no scripts")));
    }
    if !ready.is_empty() {
        let ltc = workspace.build_ltc(Profile::Dev)?;
        let service = Service::start(&ltc, workspace.root(), listen::free_address("127.0.0.1:0")?)?;
        let url = format!("http://{}", service.address());
        for (script, tool) in &ready {
            say(format_args!("    {}", script.strip_prefix(workspace.root()).unwrap_or(script).display()));
            let mut command = command(script, tool)?;
            command
                .env("LTC_URL", &url)
                .env("LTC_BIN", &ltc)
                .env("LTC_TABLES", workspace.root().join("tables"));
            process::run(command.env("LTC_SCRATCH", scratch(workspace.target())?))?;
        }
        service.stop()?;
    }
    Ok(if skipped.is_empty() { Outcome::Passed } else { Outcome::Skipped(skipped.join("; ")) })
}

type Maker = fn(&Path) -> Result<PathBuf>;

fn makers() -> [(&'static str, Maker); 2] {
    [("py", tool_box::python), ("mjs", tool_box::node)]
}

/// A tool that cannot be had is a reason to skip; an interrupt is one to stop.
fn tool(make: Maker, target: &Path) -> Result<Tool> {
    match make(target) {
        Ok(tool) => Ok(Ok(tool)),
        Err(cause) if cause.is::<Interrupted>() => Err(cause),
        Err(cause) => Ok(Err(format!("{cause:#}"))),
    }
}

/// The scripts of one kind, sorted.
fn scripts(root: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root.join(FOLDER)).into_iter().flatten().flatten();
    let mut scripts: Vec<_> = entries.map(|entry| entry.path()).collect();
    scripts.retain(|path| path.is_file() && path.extension().is_some_and(|found| found == extension));
    scripts.sort();
    scripts
}

/// How a script is run with its tool.
fn command(script: &Path, tool: &Path) -> Result<Command> {
    if !tool.is_dir() {
        let mut command = Command::new(tool);
        command.arg(script);
        return Ok(command);
    }
    // Node looks for packages beside the script, so the script goes beside the packages.
    let copy = tool.join(script.file_name().context("a script has a name")?);
    fs::copy(script, &copy).with_context(|| format!("cannot write {}", copy.display()))?;
    let mut command = Command::new("node");
    command.arg(copy);
    Ok(command)
}

fn scratch(target: &Path) -> Result<PathBuf> {
    let folder = target.join("outside");
    tool_box::empty(&folder)?;
    Ok(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_scripts_by_their_kind() {
        let root = tempfile::tempdir().expect("a folder");
        assert!(scripts(root.path(), "py").is_empty());
        let folder = root.path().join(FOLDER);
        fs::create_dir_all(folder.join("c.py")).expect("made");
        for name in ["b.py", "a.py", "a.mjs", "README.md"] {
            fs::write(folder.join(name), "").expect("written");
        }
        assert_eq!(scripts(root.path(), "py"), [folder.join("a.py"), folder.join("b.py")]);
        assert_eq!(scripts(root.path(), "mjs"), [folder.join("a.mjs")]);
    }

    #[test]
    fn a_tool_that_cannot_be_had_is_a_reason_and_an_interrupt_is_not() {
        let lacking = tool(|_| anyhow::bail!("no such thing"), Path::new("")).expect("no error");
        assert_eq!(lacking, Err("no such thing".to_owned()));
        tool(|_| Err(Interrupted.into()), Path::new("")).expect_err("interrupted");
    }
}
