//! What the refits may take.

use std::time::{Duration, SystemTime};

use ltc_fit::progress::{CHANNELS, ENTRIES, JOINT};
use ltc_fit::{Cost, FitSpec, Limits};

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
    /// Seconds of one core that the longest piece of a fit may take, that is of work that cannot be interrupted and kept
    /// ([`Cost::longest_piece`]).
    pub piece_seconds: f64,
    /// How often what is done so far is kept: the length of a shard, where no piece is longer.
    pub shard: Duration,
    /// After this time without a sign of life a worker counts as dead.
    pub lease: Duration,
    /// What names the program, by default its version, size and date: only checkpoints of the same one are gone on from, since
    /// another may fit otherwise.
    pub program: String,
}

impl Default for RefitConfig {
    /// One refit at a time on all cores, of at most 2 GiB and 4 hours of one core; 64 may wait. Shards of a quarter of a
    /// second, longer where keeping one takes long: a twentieth of the time goes to that. Pieces of at most 10 s of one core,
    /// far above those of any preset (0.3 s).
    fn default() -> Self {
        Self {
            workers: 1,
            threads: 0,
            queue: 64,
            limits: Limits { memory: 2 << 30, seconds: 4.0 * 3600.0 },
            piece_seconds: 10.0,
            shard: Duration::from_millis(250),
            lease: Duration::from_secs(30),
            program: program(),
        }
    }
}

/// What names this build of the program.
fn program() -> String {
    let metadata = std::env::current_exe().and_then(std::fs::metadata);
    let build = metadata.map_or_else(
        |_| String::new(),
        |m| {
            let since = |t: SystemTime| t.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_nanos());
            format!(", {} bytes, {}", m.len(), m.modified().map_or(0, since))
        },
    );
    concat!("ltc-refit ", env!("CARGO_PKG_VERSION")).to_owned() + &build
}

impl RefitConfig {
    /// Whether a fit may be taken on.
    ///
    /// # Errors
    /// [`RefitError::TooLarge`], with the estimate and what to lower.
    pub fn allows(&self, spec: &FitSpec, cost: &Cost) -> Result<(), RefitError> {
        cost.check(&self.limits)?;
        let (stage, piece) = cost.longest_piece(spec);
        let limit = self.piece_seconds;
        if piece <= limit {
            return Ok(());
        }
        let fields = match stage {
            ENTRIES => {
                "entries.samples, or set entries.continuation to false and entries.optimiser to quasi_newton"
            }
            JOINT => "joint.queries or joint.samples",
            CHANNELS => "channels.samples",
            _ => "measure.samples",
        };
        let (entries, memory, seconds) = (cost.entries, cost.memory, cost.total_seconds());
        let reason = format!(
            "{entries} entries would take about {piece:.0} s of one core for a piece of the stage \"{stage}\" that cannot be \
             interrupted; the limit is {limit:.0} s: lower {fields}, or fit fewer entries"
        );
        Err(RefitError::TooLarge { entries, memory, seconds, reason })
    }
}
