//! `ltc serve`

use std::io::IsTerminal;

use anyhow::{Context, Result};
use clap::Args;
use ltc_service::ServeConfig;
use tracing_subscriber::EnvFilter;

use crate::tables::Tables;

/// Serves the tables over HTTP until Ctrl-C.
///
/// Example: ltc serve --listen 127.0.0.1:9000
#[derive(Args)]
pub struct Serve {
    /// Address and port to listen on; port 0 takes a free one.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:8787")]
    listen: String,
    /// What to log, to stderr: error, warn, info, debug, or a filter like ltc_service=debug.
    #[arg(long, value_name = "FILTER", env = "LTC_LOG", default_value = "info")]
    log: String,
}

impl Serve {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let catalogue = tables.catalogue()?;
        let filter = EnvFilter::try_new(&self.log).with_context(|| format!("--log {}", self.log))?;
        tracing_subscriber::fmt()
            .with_env_filter(filter)
            .with_ansi(std::io::stderr().is_terminal())
            .with_writer(std::io::stderr)
            .init();
        let listing: Vec<String> = catalogue.names().map(str::to_owned).collect();
        let config = ServeConfig { listen: self.listen, ..ServeConfig::default() };
        let runtime = tokio::runtime::Runtime::new().context("cannot start threads")?;
        runtime.block_on(ltc_service::serve(config, catalogue, |address| {
            // Nobody may be reading; the service runs all the same.
            let _ = announce(&listing, address);
        }))?;
        outln!("stopped");
        Ok(())
    }
}

fn announce(names: &[String], address: std::net::SocketAddr) -> Result<()> {
    outln!("serving {} tables on http://{address}", names.len());
    for name in names {
        outln!("  http://{address}/v1/tables/{name}");
    }
    Ok(())
}
