//! `cargo xtask setup`: a driver for the GPU parts.

use anyhow::{Result, bail};

use crate::apt;
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
