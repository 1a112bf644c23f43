//! The outside readers that some checks need, kept under the target directory: nothing is installed for the user.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail};

use crate::say::say;
use crate::{apt, process};

const NUMPY: &str = "numpy>=1.24,<3";
const REQUESTS: &str = "requests>=2.28,<3";
const KTX_PARSE: &str = "ktx-parse@2.0.0";

/// A Python that has NumPy and requests, in a virtual environment.
pub fn python(target: &Path) -> Result<PathBuf> {
    let folder = target.join("venv");
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    // Asked, not remembered: an installation that was cut short answers no, and is made anew.
    let has_both = || process::works(Command::new(&python).args(["-c", "import numpy, requests"]));
    if has_both() {
        return Ok(python);
    }
    let can_make = || process::works(Command::new("python3").args(["-c", "import venv, ensurepip"]));
    need("python3 with its module venv", can_make, &["python3", "python3-venv"])?;
    say(format_args!("    putting NumPy and requests into {}", folder.display()));
    empty(&folder)?;
    process::run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    process::run(Command::new(&python).args(["-m", "pip", "install", "--quiet", NUMPY, REQUESTS]))?;
    if !has_both() {
        bail!("NumPy and requests are installed in {} and cannot be imported", folder.display());
    }
    Ok(python)
}

/// A folder from which Node's scripts can import ktx-parse.
pub fn node(target: &Path) -> Result<PathBuf> {
    let folder = target.join("node");
    let imports = ["--input-type=module", "--eval", "await import('ktx-parse')"];
    let has_ktx_parse = || process::works(Command::new("node").current_dir(&folder).args(imports));
    if has_ktx_parse() {
        return Ok(folder);
    }
    let can_install = || {
        process::works(Command::new("node").arg("--version"))
            && process::works(Command::new("npm").arg("--version"))
    };
    need("Node.js with npm", can_install, &["nodejs", "npm"])?;
    say(format_args!("    putting {KTX_PARSE} into {}", folder.display()));
    empty(&folder)?;
    let mut install = Command::new("npm");
    install.current_dir(&folder).args(["install", "--no-audit", "--no-fund", "--prefix"]).arg(&folder);
    process::run(install.args(["--loglevel", "error", KTX_PARSE]))?;
    if !has_ktx_parse() {
        bail!("{KTX_PARSE} is installed in {} and cannot be imported", folder.display());
    }
    Ok(folder)
}

/// Makes sure of a tool, by apt-get where there is one.
fn need(what: &str, is_here: impl Fn() -> bool, packages: &[&str]) -> Result<()> {
    if is_here() {
        return Ok(());
    }
    if !apt::is_here() {
        bail!("this machine lacks {what}");
    }
    say(format_args!("    this machine lacks {what}"));
    apt::install(packages)?;
    if !is_here() {
        bail!("{} are installed, and {what} is still missing", packages.join(" and "));
    }
    Ok(())
}

/// Makes `folder` anew, without what was in it.
pub fn empty(folder: &Path) -> Result<()> {
    let remake = || -> std::io::Result<()> {
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
        fs::create_dir_all(folder)
    };
    remake().with_context(|| format!("cannot make {} anew", folder.display()))
}
