//! `cargo xtask setup`: a driver for the GPU parts, and compilers that judge the shaders which are exported.

use std::process::Command;

use anyhow::{Result, bail};

use crate::apt;
use crate::process;
use crate::say::say;
use crate::vulkan::Search;

/// Mesa's software driver, and the loader that finds it.
const DEBIAN_PACKAGES: [&str; 2] = ["libvulkan1", "mesa-vulkan-drivers"];

/// Finds a driver, or puts a software driver in place where that can be done. What is there already is left alone.
pub fn graphics() -> Result<()> {
    if !cfg!(target_os = "linux") {
        say("    this system comes with the graphics interface that is used here: nothing to install");
        return Ok(());
    }
    let missing = match Search::this_machine().driver() {
        Ok(driver) => {
            say(format_args!("    found {driver}"));
            return Ok(());
        }
        Err(missing) => missing,
    };
    if !apt::is_here() {
        bail!("this machine lacks {missing}: {}", apt::vulkan_hint());
    }
    say(format_args!("    this machine lacks {missing}"));
    apt::install(&DEBIAN_PACKAGES)?;
    match Search::this_machine().driver() {
        Ok(driver) => say(format_args!("    there is now {driver}")),
        Err(missing) => {
            bail!("{} are installed, and {missing} is still missing", DEBIAN_PACKAGES.join(" and "))
        }
    }
    Ok(())
}

/// Programs that tests call, and Debian's packages of them.
const COMPILERS: [(&str, &str); 2] = [("glslangValidator", "glslang-tools"), ("spirv-val", "spirv-tools")];

/// Finds the compilers, or installs them where that can be done. Elsewhere the tests that need them say so.
pub fn compilers() -> Result<()> {
    let here = |program: &str| process::works(Command::new(program).arg("--version"));
    let missing: Vec<_> = COMPILERS.into_iter().filter(|(program, _)| !here(program)).collect();
    if missing.is_empty() {
        say(format_args!("    found {}", COMPILERS.map(|(program, _)| program).join(" and ")));
        return Ok(());
    }
    let packages: Vec<_> = missing.iter().map(|(_, package)| *package).collect();
    if !apt::is_here() {
        say(format_args!(
            "    there is no {}: tests of exported shaders will be skipped",
            packages.join(", no ")
        ));
        return Ok(());
    }
    apt::install(&packages)?;
    match COMPILERS.into_iter().find(|(program, _)| !here(program)) {
        None => Ok(()),
        Some((program, package)) => bail!("{package} is installed, and {program} is still missing"),
    }
}
