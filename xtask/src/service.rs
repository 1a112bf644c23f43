//! `ltc serve` as a child of ours.

use std::net::SocketAddr;
use std::path::Path;
use std::process::{Command, ExitStatus};
use std::time::{Duration, Instant};

use anyhow::{Result, bail};

use crate::process::Running;
use crate::{http, interrupt, listen};

/// How long the service may take to be ready.
const PATIENCE: Duration = Duration::from_secs(60);

/// A service that is up and ready. Dropping it stops it.
pub struct Service {
    running: Running,
    address: SocketAddr,
}

impl Service {
    /// Starts `ltc serve` on `address` and waits until it is ready.
    pub fn start(ltc: &Path, root: &Path, address: SocketAddr) -> Result<Self> {
        let mut command = Command::new(ltc);
        command.current_dir(root).args(["serve", "--log", "warn", "--listen", &address.to_string()]);
        let mut service =
            Self { running: Running::start(&mut command)?, address: listen::reachable(address) };
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            interrupt::check()?;
            service.check()?;
            if http::get(service.address, "/readyz").is_ok_and(|answer| answer.status == 200) {
                // Had somebody else taken the port meanwhile, ours would have ended by now.
                std::thread::sleep(Duration::from_millis(50));
                service.check()?;
                return Ok(service);
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        bail!("ltc serve was not ready on {address} after {} s", PATIENCE.as_secs())
    }

    /// Where a client on this machine reaches it.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// An error once the service has ended of itself.
    pub fn check(&mut self) -> Result<()> {
        match self.running.poll()? {
            Some(status) => bail!("ltc serve ended of itself with {status}"),
            None => Ok(()),
        }
    }

    /// Stays until Ctrl-C, then stops the service; an error when the service ends of itself.
    pub fn stay(mut self) -> Result<()> {
        while !interrupt::pending() {
            self.check()?;
            std::thread::sleep(Duration::from_millis(50));
        }
        self.stop()
    }

    /// Asks the service to stop. That it then ends in good order is part of its contract.
    pub fn stop(mut self) -> Result<()> {
        graceful(self.running.stop()?)
    }
}

fn graceful(status: ExitStatus) -> Result<()> {
    if !status.success() {
        bail!("ltc serve did not stop in good order: {status}");
    }
    Ok(())
}
