//! The folder of this workspace, and cargo in it.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::process;

/// How `ltc` is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// Compiles fast.
    Dev,
    /// Runs fast.
    Release,
}

/// Where things are.
pub struct Workspace {
    root: PathBuf,
    target: PathBuf,
}

impl Workspace {
    /// Asks cargo. Works from any folder of the workspace and with any target directory.
    pub fn find() -> Result<Self> {
        // Cargo sets the variable for what it runs; the constant is for a binary that is started by hand.
        let here = env::var_os("CARGO_MANIFEST_DIR")
            .map_or_else(|| env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
        let root = here.parent().context("xtask lies in a workspace")?.to_owned();
        let mut query = cargo(&root);
        query.args(["metadata", "--no-deps", "--format-version", "1"]).stderr(Stdio::inherit());
        let metadata: Value = serde_json::from_str(&process::output(&mut query)?)?;
        let target = metadata["target_directory"].as_str().context("cargo names no target directory")?.into();
        Ok(Self { root, target })
    }

    /// The folder of the root manifest.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The folder that cargo builds into; what the chores make lies there too, for git ignores it.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// A cargo command in the root folder.
    pub fn cargo<'a>(&self, args: impl IntoIterator<Item = &'a str>) -> Command {
        let mut command = cargo(&self.root);
        command.args(args);
        command
    }

    /// Builds the binary `ltc`, with cargo's own progress on the terminal, and returns its path.
    pub fn build_ltc(&self, profile: Profile) -> Result<PathBuf> {
        let mut build = self.cargo(["build", "--package", "ltc-cli"]);
        if profile == Profile::Release {
            build.arg("--release");
        }
        build.args(["--message-format", "json-render-diagnostics"]);
        let messages = process::output(&mut build)?;
        executable(&messages, "ltc").context("cargo built no binary called ltc")
    }

    /// A file of the repository that a chore needs; a missing one is an error that names it.
    pub fn file(&self, path: &str) -> Result<PathBuf> {
        let full = self.root.join(path);
        if !full.is_file() {
            bail!("{path} is missing from the repository");
        }
        Ok(full)
    }
}

/// The same cargo that runs us, so that a chosen toolchain stays chosen.
fn cargo(root: &Path) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root);
    command
}

/// The path of the binary `name` in cargo's messages, one JSON object a line.
fn executable(messages: &str, name: &str) -> Option<PathBuf> {
    let artifacts = messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let mut binaries = artifacts.filter(|artifact| artifact["target"]["name"] == name);
    binaries.find_map(|artifact| artifact["executable"].as_str().map(PathBuf::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_binary_in_the_messages() {
        let messages = r#"{"reason":"compiler-artifact","target":{"name":"ltc"},"executable":null}
not JSON
{"reason":"compiler-artifact","target":{"name":"other"},"executable":"/x/other"}
{"reason":"compiler-artifact","target":{"name":"ltc"},"executable":"/x/ltc"}"#;
        assert_eq!(executable(messages, "ltc"), Some("/x/ltc".into()));
        assert_eq!(executable(messages, "third"), None);
    }
}
