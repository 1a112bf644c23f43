//! `cargo xtask tables`: fits the shipped tables anew, by the command that made them.

use std::process::Command;

use anyhow::Result;

use crate::process;
use crate::step::Steps;
use crate::workspace::{Profile, Workspace};

/// The presets that are shipped.
const PRESETS: [&str; 8] = [
    "ggx-isotropic",
    "ggx-isotropic-dropin",
    "ggx-anisotropic",
    "ggx-anisotropic-closed-form",
    "beckmann-isotropic",
    "disney-diffuse",
    "oren-nayar",
    "charlie-sheen",
];

/// Fits each preset into `tables/`, then verifies it there.
pub fn run(workspace: &Workspace) -> Result<()> {
    let mut steps = Steps::new(1 + 2 * PRESETS.len(), false);
    let ltc = steps.step("build ltc, optimised", || workspace.build_ltc(Profile::Release))?;
    let verb = |words: &[&str]| process::run(Command::new(&ltc).current_dir(workspace.root()).args(words));
    for preset in PRESETS {
        steps.step(format_args!("fit {preset}"), || verb(&["fit", preset, "-o", "tables"]))?;
        steps.step(format_args!("verify {preset}"), || verb(&["verify", preset, "--tables", "tables"]))?;
    }
    Ok(())
}
