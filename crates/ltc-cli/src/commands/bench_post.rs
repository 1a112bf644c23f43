//! `ltc bench post`, and `ltc bench --post`

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use ltc_benches::study::Run;
use ltc_client::Client;

/// Sends a run to a table service, which shows its history as charts at /benchmarks.
///
/// The service asks for a token with the scope `benchmark`. It is taken from LTC_TOKEN or a file: what stands in a command line can be
/// read by everybody on the machine.
///
/// Example: LTC_TOKEN=ltc_… ltc bench post bench --to http://127.0.0.1:8787
#[derive(Args)]
pub struct Post {
    /// The run: a bench.json, or the folder that holds it.
    #[arg(value_name = "RUN")]
    run: PathBuf,
    /// The service.
    #[arg(long, value_name = "URL")]
    to: String,
    #[command(flatten)]
    how: How,
}

/// Under which name, and by whose leave.
#[derive(Args)]
pub struct How {
    /// The series that it belongs to: runs of one series, machine and build are compared.
    #[arg(long, value_name = "NAME", default_value = "ltc bench")]
    series: String,
    /// A file that holds the token; unless given, LTC_TOKEN does.
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
}

impl Post {
    pub fn run(&self, read: impl Fn(&Path) -> Result<Run>) -> Result<()> {
        self.how.destination(&self.to)?.send(&read(&self.run)?)
    }
}

/// A service that takes runs.
pub struct Destination {
    client: Client,
    url: String,
    series: String,
}

impl How {
    /// Fails without a token: before anything is measured.
    pub fn destination(&self, url: &str) -> Result<Destination> {
        let token = match &self.token_file {
            Some(file) => {
                std::fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?
            }
            None => std::env::var("LTC_TOKEN").unwrap_or_default(),
        };
        let token = token.trim();
        if token.is_empty() || token.contains(char::is_whitespace) {
            bail!("there is no token: set LTC_TOKEN, or name a file that holds one with --token-file");
        }
        let url = url.trim_end_matches('/').to_owned();
        Ok(Destination { client: Client::new(&url).with_token(token), url, series: self.series.clone() })
    }
}

impl Destination {
    pub fn send(&self, run: &Run) -> Result<()> {
        let id = self.client.add_benchmark(&self.series, &run.date, run).context("the run was not taken")?;
        outln!("kept as {id}; the history is at {}/benchmarks", self.url);
        Ok(())
    }
}
