//! `ltc serve`

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result};
use clap::Args;
use ltc_service::settings::{Layers, LogFormat};
use ltc_service::{AppState, Settings, Stores};
use ltc_store::EmbeddedStore;
use ltc_table::Catalogue;
use tempfile::TempDir;
use tracing_subscriber::EnvFilter;

use crate::shaders::Shaders;
use crate::tables::Tables;

/// Serves the tables over HTTP until Ctrl-C, with refits, uploads and benchmark history.
///
/// Every setting can come from a flag, the environment (LTC_LISTEN, LTC_LIMITS_BODY_BYTES, …), a TOML file or its default; the
/// first of these counts. --check lists them.
///
/// Example: ltc serve --listen 127.0.0.1:9000 --data /var/lib/ltc
#[derive(Args)]
pub struct Serve {
    /// Address and port to listen on; port 0 takes a free one. [default: 127.0.0.1:8787]
    #[arg(long, value_name = "ADDRESS")]
    listen: Option<String>,
    /// Folder that keeps versions, refits, tokens and benchmarks; made and filled with the shipped tables where there is none.
    /// Without it nothing outlives the service.
    #[arg(long, value_name = "DIR")]
    data: Option<String>,
    /// A TOML file of settings.
    #[arg(long, value_name = "FILE", env = "LTC_CONFIG")]
    config: Option<PathBuf>,
    /// What to log, to stderr: error, warn, info, debug, or a filter like ltc_service=debug. [default: info]
    #[arg(long, value_name = "FILTER")]
    log: Option<String>,
    /// How to log: text or json. [default: text]
    #[arg(long, value_name = "FORMAT")]
    log_format: Option<String>,
    /// Who may read: open or token. [default: open]
    #[arg(long, value_name = "WHO")]
    read: Option<String>,
    /// Any setting, such as limits.body_bytes=65536. May be repeated.
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_setting)]
    set: Vec<(String, String)>,
    /// Checks the settings, prints them as a TOML file, and ends.
    #[arg(long)]
    check: bool,
}

fn parse_setting(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("must be NAME=VALUE")?;
    Ok((name.to_owned(), value.to_owned()))
}

impl Serve {
    pub fn run(self, tables: &Tables) -> Result<()> {
        let settings = self.settings()?;
        let filter = filter(&settings.log)?;
        if self.check {
            out!("{}", settings.to_toml()?);
            return Ok(());
        }
        // Before anything starts a thread.
        ltc_service::share_heaps();
        start_log(filter, settings.log_format);
        let catalogue = tables.catalogue()?;
        let runtime = tokio::runtime::Runtime::new().context("cannot start threads")?;
        // Kept until the end: it goes with the value.
        let temporary = settings.data.as_os_str().is_empty().then(TempDir::new).transpose();
        let temporary = temporary.context("cannot make a temporary folder; give one with --data")?;
        let folder = temporary.as_ref().map_or(settings.data.as_path(), TempDir::path).to_owned();
        let store = open(&folder, &settings)?;
        runtime.block_on(serve(store, &catalogue, settings, temporary.is_some()))?;
        outln!("stopped");
        Ok(())
    }

    fn settings(&self) -> Result<Settings> {
        let named = [
            ("listen", &self.listen),
            ("data", &self.data),
            ("log", &self.log),
            ("log_format", &self.log_format),
            ("read", &self.read),
        ];
        let named = named.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value.clone()?)));
        let environment = std::env::vars_os()
            .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)));
        let layers = Layers {
            file: self.config.clone(),
            environment: environment.collect(),
            flags: self.set.iter().cloned().chain(named).collect(),
        };
        Ok(layers.resolve()?)
    }
}

fn filter(log: &str) -> Result<EnvFilter> {
    EnvFilter::try_new(log).with_context(|| format!("log {log}"))
}

fn start_log(filter: EnvFilter, format: LogFormat) {
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_ansi(std::io::stderr().is_terminal() && format == LogFormat::Text)
        .with_writer(std::io::stderr);
    match format {
        LogFormat::Text => log.init(),
        LogFormat::Json => log.json().flatten_event(true).init(),
    }
}

fn open(folder: &Path, settings: &Settings) -> Result<Arc<EmbeddedStore>> {
    let store = EmbeddedStore::open_with(folder, settings.limits.derived_bytes);
    let store = store.with_context(|| format!("cannot open the store in {}", folder.display()))?;
    if !store.is_writable() {
        tracing::error!(folder = %folder.display(), "the store cannot be written: it is served for reading alone");
    }
    Ok(Arc::new(store))
}

async fn serve(
    store: Arc<EmbeddedStore>,
    catalogue: &Catalogue,
    settings: Settings,
    temporary: bool,
) -> Result<()> {
    if store.is_writable() {
        let spec_digest = |manifest: &_| ltc_refit::spec_digest(manifest);
        let added = ltc_store::seed(&*store, &*store, catalogue, &spec_digest).await;
        match added.context("cannot fill the store with the shipped tables") {
            Ok(added) => tracing::debug!(added, "tables of the program are in the store"),
            // A full disk: what is there is served all the same.
            Err(error) => tracing::error!("{error:#}"),
        }
    }
    let state = AppState::new(Stores::of(store), settings).await.context("cannot read the store")?;
    state.serve_shaders(Arc::new(Shaders));
    let names: Vec<String> = state.table_names();
    ltc_service::serve(state, |address| {
        if temporary {
            tracing::warn!("nothing outlives this process; --data DIR keeps it");
        }
        // Nobody may be reading; the service runs all the same.
        let _ = announce(&names, address);
    })
    .await?;
    Ok(())
}

fn announce(names: &[String], address: std::net::SocketAddr) -> Result<()> {
    outln!("serving {} tables on http://{address}", names.len());
    for name in names {
        outln!("  http://{address}/v1/tables/{name}");
    }
    Ok(())
}
