//! Debian's package manager, and the names of other systems' ways to the same things.

use std::fs;
use std::process::Command;

use anyhow::{Result, bail};

use crate::process;
use crate::say::say;

/// Whether this is Debian, Ubuntu or one of their kin.
pub fn is_here() -> bool {
    family(&os_release()).contains(&"debian".to_owned())
        && process::works(Command::new("apt-get").arg("--version"))
}

/// Installs `packages`, after saying so. Never asks a question; `sudo` may ask for a password.
pub fn install(packages: &[&str]) -> Result<()> {
    let list = packages.join(" ");
    let root = is_root();
    if !root && !process::works(Command::new("sudo").arg("--version")) {
        bail!(
            "{list} must be installed, which needs root: run `apt-get install {list}` as root, then try again"
        );
    }
    say(format_args!("    installing {list} with apt-get{}", if root { "" } else { " through sudo" }));
    if !root {
        // In the foreground: a password prompt has to reach the terminal.
        let granted = Command::new("sudo").arg("-v").status().is_ok_and(|status| status.success());
        if !granted {
            bail!("sudo was refused: run `apt-get install {list}` as root, then try again");
        }
    }
    process::run_to_the_end(apt_get(root).args(["update", "-qq"]))?;
    process::run_to_the_end(
        apt_get(root).args(["install", "-y", "-qq", "--no-install-recommends"]).args(packages),
    )
}

/// How the person gets a Vulkan driver on a system that we do not install on.
pub fn vulkan_hint() -> &'static str {
    const HINTS: [(&str, &str); 5] = [
        ("fedora", "dnf install mesa-vulkan-drivers vulkan-loader"),
        ("rhel", "dnf install mesa-vulkan-drivers vulkan-loader"),
        ("arch", "pacman -S vulkan-swrast vulkan-icd-loader"),
        ("alpine", "apk add mesa-vulkan-swrast vulkan-loader"),
        ("suse", "zypper install libvulkan1 libvulkan_lvp"),
    ];
    let family = family(&os_release());
    let hint = HINTS.iter().find(|(id, _)| family.iter().any(|word| word == id));
    hint.map_or(
        "install Mesa's software driver (lavapipe) and the Vulkan loader, or your GPU's driver",
        |hint| hint.1,
    )
}

fn os_release() -> String {
    fs::read_to_string("/etc/os-release").unwrap_or_default()
}

/// The words of `ID` and `ID_LIKE`. Ubuntu says that it is like Debian.
fn family(os_release: &str) -> Vec<String> {
    let fields = os_release.lines().filter_map(|line| line.split_once('='));
    let values = fields.filter(|(key, _)| ["ID", "ID_LIKE"].contains(key)).map(|(_, value)| value);
    values.flat_map(|value| value.trim_matches(['"', '\'']).split_whitespace()).map(str::to_owned).collect()
}

/// `apt-get` that asks nothing and waits for another one to finish.
fn apt_get(root: bool) -> Command {
    let mut command = Command::new(if root { "env" } else { "sudo" });
    if !root {
        command.args(["-n", "env"]);
    }
    command.args([
        "DEBIAN_FRONTEND=noninteractive",
        "apt-get",
        "-o",
        "DPkg::Lock::Timeout=120",
        "-o",
        "Dpkg::Use-Pty=0",
    ]);
    command
}

#[cfg(unix)]
fn is_root() -> bool {
    rustix::process::geteuid().is_root()
}

#[cfg(not(unix))]
fn is_root() -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knows_the_family() {
        let ubuntu = "NAME=\"Ubuntu\"\nID=ubuntu\nID_LIKE=debian\nVERSION_ID=\"24.04\"\n";
        assert_eq!(family(ubuntu), ["ubuntu", "debian"]);
        assert_eq!(
            family("ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\""),
            ["rocky", "rhel", "centos", "fedora"]
        );
        assert_eq!(family("VARIANT_ID=debian"), [""; 0]);
    }
}
