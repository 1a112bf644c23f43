//! How long reads from a store take while a refit has every core: `cargo run --release -p ltc-refit --example latency`.
//!
//! Reads a payload and the list of versions 200 times a second, first alone and then beside a refit of `ggx-anisotropic`, and
//! prints the median, the 99th percentile and the longest of each.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ltc_refit::{Ask, RefitConfig, Refits, spec_digest};
use ltc_store::{BlobKind, Blobs, EmbeddedStore, Jobs, Metadata, seed};
use serde_json::json;

/// Reads a second.
const RATE: u64 = 200;
/// Seconds of each measurement.
const SECONDS: u64 = 10;

#[tokio::main]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let store = Arc::new(EmbeddedStore::open(folder.path())?);
    seed(&*store, &*store, &ltc_tables::shipped()?, &spec_digest).await?;
    tell("alone", measure(&store).await);
    let refits = Refits::new(store.clone(), store.clone(), store.clone(), RefitConfig::default());
    let workers = refits.start();
    let spec = json!({ "preset": "ggx-anisotropic", "joint": { "steps": 100_000 } });
    let (job, _) = refits.request(Ask::new(spec)).await?;
    tokio::time::sleep(Duration::from_secs(2)).await;
    tell("beside a refit", measure(&store).await);
    let job = store.job(&job.id).await?;
    let rate = refits.metrics().await?.lobes_per_second;
    println!("the refit: {:?}, {:.4} done, {rate:.0} lobes a second", job.state, job.progress);
    workers.stop().await;
    Ok(())
}

/// Times of reads, each begun on its own beat, sorted.
async fn measure(store: &Arc<EmbeddedStore>) -> Vec<Duration> {
    let digest = store.versions().await.ok().and_then(|all| all.last().map(|version| version.digest.clone()));
    let digest = digest.unwrap_or_default();
    let mut beat = tokio::time::interval(Duration::from_secs(1) / RATE as u32);
    let mut tasks = tokio::task::JoinSet::new();
    for _ in 0..RATE * SECONDS {
        // From when it was due, so that a late beat counts.
        let due = beat.tick().await.into_std();
        let (store, digest) = (Arc::clone(store), digest.clone());
        tasks.spawn(async move {
            let read = store.get(BlobKind::Payload, &digest).await;
            let listed = store.versions().await;
            (read.is_ok() && listed.is_ok()).then(|| Instant::now().duration_since(due))
        });
    }
    let mut times: Vec<Duration> = tasks.join_all().await.into_iter().flatten().collect();
    times.sort();
    times
}

fn tell(what: &str, times: Vec<Duration>) {
    let at =
        |share: f64| times.get(((times.len() as f64 - 1.0) * share) as usize).copied().unwrap_or_default();
    println!(
        "{what}: {} reads, median {:.2?}, p99 {:.2?}, longest {:.2?}",
        times.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
}
