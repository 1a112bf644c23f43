//! What the refits may take.

use std::time::Duration;

use ltc_fit::Limits;

/// How refits are run.
#[derive(Clone, Debug, PartialEq)]
pub struct RefitConfig {
    /// Refits at once; 0 takes jobs in and runs none.
    pub workers: usize,
    /// Threads of each; 0 is one for each core.
    pub threads: usize,
    /// Jobs that may wait.
    pub queue: u64,
    /// What one refit may take.
    pub limits: Limits,
    /// How often what is done so far is kept: the length of a shard.
    pub shard: Duration,
    /// After this time without a sign of life a worker counts as dead.
    pub lease: Duration,
    /// What names the program: only checkpoints of the same one are gone on from, since another may fit otherwise.
    pub program: String,
}

impl Default for RefitConfig {
    /// One refit at a time on all cores, of at most 2 GiB and 4 hours of one core; 64 may wait.
    fn default() -> Self {
        Self {
            workers: 1,
            threads: 0,
            queue: 64,
            limits: Limits { memory: 2 << 30, seconds: 4.0 * 3600.0 },
            shard: Duration::from_secs(1),
            lease: Duration::from_secs(30),
            program: concat!("ltc-refit ", env!("CARGO_PKG_VERSION")).to_owned(),
        }
    }
}
