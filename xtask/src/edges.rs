//! `cargo xtask edges`: no crate depends on what it must not.

use anyhow::{Context as _, Result, bail};

use crate::edge_rules::{Findings, RULES};
use crate::graph::Graph;
use crate::process;
use crate::say::say;
use crate::workspace::Workspace;

/// The platforms whose edges count. Not "all that a manifest mentions": wgpu mentions tokio for a combination of
/// platform and unstable flag that nobody can build.
const PLATFORMS: [&str; 4] =
    ["x86_64-unknown-linux-gnu", "x86_64-pc-windows-msvc", "aarch64-apple-darwin", "wasm32-unknown-unknown"];

/// Holds the workspace against the table of rules; a broken rule is an error that names the chain.
pub fn run(workspace: &Workspace) -> Result<()> {
    // With all features: an edge that only some builds have is an edge.
    let mut query = workspace.cargo(["metadata", "--format-version", "1", "--all-features", "--locked"]);
    for platform in PLATFORMS {
        query.args(["--filter-platform", platform]);
    }
    let metadata =
        serde_json::from_str(&process::output(&mut query)?).context("cargo metadata is no JSON")?;
    let graph = Graph::from_metadata(&metadata)?;
    let mut findings = Findings::default();
    RULES.iter().for_each(|rule| rule.check(&graph, &mut findings));
    for note in &findings.exempt {
        say(format_args!("    exempt: {note}"));
    }
    for fault in &findings.broken {
        say(format_args!("    broken: {fault}"));
    }
    if let Some(first) = findings.broken.first() {
        bail!("{} dependency edges are not allowed, the first: {first}", findings.broken.len());
    }
    say(format_args!("    {} rules hold for {} crates", RULES.len(), graph.members().count()));
    Ok(())
}
