//! What the refits may take.

use std::time::Duration;

use ltc_fit::progress::{CHANNELS, MEASUREMENT};
use ltc_fit::{Cost, Limits};

use crate::RefitError;

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
    /// Seconds of one core that either of the last two stages (magnitude and Fresnel, measurement) may take: a kill within
    /// such a stage loses what is done of it.
    pub stage_seconds: f64,
    /// How often what is done so far is kept: the length of a shard.
    pub shard: Duration,
    /// After this time without a sign of life a worker counts as dead.
    pub lease: Duration,
    /// What names the program: only checkpoints of the same one are gone on from, since another may fit otherwise.
    pub program: String,
}

impl Default for RefitConfig {
    /// One refit at a time on all cores, of at most 2 GiB and 4 hours of one core; 64 may wait. Shards of a second, the last
    /// two stages of at most a minute of one core each.
    fn default() -> Self {
        Self {
            workers: 1,
            threads: 0,
            queue: 64,
            limits: Limits { memory: 2 << 30, seconds: 4.0 * 3600.0 },
            stage_seconds: 60.0,
            shard: Duration::from_secs(1),
            lease: Duration::from_secs(30),
            program: concat!("ltc-refit ", env!("CARGO_PKG_VERSION")).to_owned(),
        }
    }
}

impl RefitConfig {
    /// Whether a fit may be taken on.
    ///
    /// # Errors
    /// [`RefitError::TooLarge`], with the estimate and what to lower.
    pub fn allows(&self, cost: &Cost) -> Result<(), RefitError> {
        cost.check(&self.limits)?;
        let (entries, memory, seconds) = (cost.entries, cost.memory, cost.total_seconds());
        for (stage, of_stage) in cost.seconds {
            let fields = match stage {
                CHANNELS => "channels.samples or channels.queries",
                MEASUREMENT => "measure.samples or measure.queries",
                _ => continue,
            };
            if of_stage > self.stage_seconds {
                let limit = self.stage_seconds;
                let reason = format!(
                    "{entries} entries would take about {of_stage:.0} s of one core for the stage \"{stage}\", which is done in one \
                     piece; the limit is {limit:.0} s: lower {fields}, or fit with fewer entries"
                );
                return Err(RefitError::TooLarge { entries, memory, seconds, reason });
            }
        }
        Ok(())
    }
}
