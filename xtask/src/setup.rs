//! `cargo xtask setup`: a driver for the GPU parts, and compilers that judge the shaders which are exported.

use std::process::Command;

use anyhow::{Result, bail};

use crate::apt;
use crate::interrupt::Interrupted;
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

/// Programs that tests call, and Debian's packages of them: compilers, and a browser for GLSL ES.
const COMPILERS: [(&str, &str); 3] =
    [("glslangValidator", "glslang-tools"), ("spirv-val", "spirv-tools"), ("chromium", "chromium")];

/// Finds the compilers, or installs them where that can be done. What is missing in the end is no error here: the tests that
/// need it say so, and on a build server they fail.
pub fn compilers() -> Result<()> {
    let missing = missing();
    if missing.is_empty() {
        say(format_args!("    found {}", COMPILERS.map(|(program, _)| program).join(", ")));
        return Ok(());
    }
    if apt::is_here()
        && let Err(cause) = apt::install(&missing)
    {
        if cause.is::<Interrupted>() {
            return Err(cause);
        }
        say(format_args!("    {cause:#}"));
    }
    let missing = self::missing();
    if !missing.is_empty() {
        let list = missing.join(", no ");
        say(format_args!("    there is no {list}: the tests of exported shaders that need it cannot run"));
    }
    Ok(())
}

/// The packages of the programs that are not here.
fn missing() -> Vec<&'static str> {
    let here = |program: &str| process::works(Command::new(program).arg("--version"));
    COMPILERS.into_iter().filter(|(program, _)| !here(program)).map(|(_, package)| package).collect()
}
