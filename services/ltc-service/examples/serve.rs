//! The service without the rest of `ltc`, for load tests: it builds in a fraction of the time. Settings come from the
//! environment alone (`LTC_LISTEN`, `LTC_DATA`, …).

use std::path::PathBuf;
use std::sync::Arc;

use ltc_service::settings::Layers;
use ltc_service::{AppState, Stores};
use ltc_store::{EmbeddedStore, Scope, Secret};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    // As `ltc serve` does.
    ltc_service::share_heaps();
    tokio::runtime::Runtime::new()?.block_on(serve())
}

async fn serve() -> Result<(), Failure> {
    let layers = Layers { environment: std::env::vars().collect(), ..Layers::default() };
    let settings = layers.resolve()?;
    tracing_subscriber::fmt().with_env_filter(&settings.log).with_writer(std::io::stderr).init();
    let store = Arc::new(EmbeddedStore::open_with(&data(&settings.data)?, settings.limits.derived_bytes)?);
    let spec_digest = |manifest: &_| ltc_refit::spec_digest(manifest);
    ltc_store::seed(&*store, &*store, &ltc_tables::shipped()?, &spec_digest).await?;
    if let Ok(path) = std::env::var("TOKEN_FILE") {
        let (token, secret) = Secret::generate("load", Scope::ALL.into_iter().collect(), None)?;
        ltc_store::Metadata::add_token(&*store, token).await?;
        std::fs::write(path, secret.reveal())?;
    }
    let state = AppState::new(Stores::of(store), settings).await?;
    ltc_service::serve(state, |address| println!("http://{address}")).await?;
    Ok(())
}

fn data(folder: &std::path::Path) -> Result<PathBuf, Failure> {
    if folder.as_os_str().is_empty() {
        return Err("set LTC_DATA to a folder".into());
    }
    Ok(folder.to_owned())
}
