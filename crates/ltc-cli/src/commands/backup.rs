//! `ltc backup` and `ltc restore`

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use ltc_store::{Contents, back_up, restore};

/// Copies the data of a service to a folder, while it serves: all that is needed to start anew from there.
///
/// Versions, aliases, tokens (their hashes), benchmark runs, jobs and tables are in it, as they were at one moment; what can
/// be computed again is not. The folder must be empty or missing.
///
/// Example: ltc backup --data DIR -o backups/2026-01-31
#[derive(Args)]
pub struct Backup {
    /// Data folder of the service.
    #[arg(long, value_name = "DIR", env = "LTC_DATA")]
    data: PathBuf,
    /// Folder of the backup.
    #[arg(short, long, value_name = "BACKUP")]
    output: PathBuf,
    /// Prints what the backup holds as JSON.
    #[arg(long)]
    json: bool,
}

/// Makes a data folder of a backup, every digest checked. The folder must be empty or missing.
///
/// Example: ltc restore backups/2026-01-31 --data NEW_DIR
#[derive(Args)]
pub struct Restore {
    /// Folder that `ltc backup` wrote.
    #[arg(value_name = "BACKUP")]
    backup: PathBuf,
    /// Data folder to make.
    #[arg(long, value_name = "NEW_DIR", env = "LTC_DATA")]
    data: PathBuf,
    /// Prints what the backup holds as JSON.
    #[arg(long)]
    json: bool,
}

impl Backup {
    pub fn run(self) -> Result<()> {
        let contents = back_up(&self.data, &self.output)
            .with_context(|| format!("no backup of {}", self.data.display()))?;
        tell(&contents, "backed up to", &self.output.display().to_string(), self.json)
    }
}

impl Restore {
    pub fn run(self) -> Result<()> {
        let contents = restore(&self.backup, &self.data)
            .with_context(|| format!("{} is not restored", self.backup.display()))?;
        tell(&contents, "restored to", &self.data.display().to_string(), self.json)
    }
}

fn tell(contents: &Contents, what: &str, place: &str, json: bool) -> Result<()> {
    if json {
        outln!("{}", serde_json::to_string_pretty(contents)?);
        return Ok(());
    }
    let Contents { payloads, bytes, created, .. } = contents;
    outln!("{payloads} tables, {:.1} MB, as of {created}, {what} {place}", *bytes as f64 / 1e6);
    Ok(())
}
