//! Figures of the refits.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Figures of the refits that this process runs, and of the queue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RefitMetrics {
    /// Jobs that wait.
    pub queued: u64,
    /// Jobs that run, here or elsewhere.
    pub running: u64,
    /// Lobes of the BRDF that were evaluated since the start.
    pub lobes_total: u64,
    /// The same a second, at present; 0 while nothing runs.
    pub lobes_per_second: f64,
    /// Mean total variation of the fit that runs, where its stage knows it.
    pub tv: Option<f64>,
    /// Jobs that succeeded since the start.
    pub succeeded_total: u64,
    /// Jobs that failed since the start.
    pub failed_total: u64,
    /// Jobs that were cancelled while they ran, since the start.
    pub cancelled_total: u64,
}

/// Counts that only grow, and what is at present.
#[derive(Default)]
pub(crate) struct Counts {
    pub(crate) lobes: AtomicU64,
    pub(crate) succeeded: AtomicU64,
    pub(crate) failed: AtomicU64,
    pub(crate) cancelled: AtomicU64,
}

pub(crate) fn add(count: &AtomicU64, more: u64) {
    count.fetch_add(more, Ordering::Relaxed);
}

pub(crate) fn get(count: &AtomicU64) -> u64 {
    count.load(Ordering::Relaxed)
}

/// Lobes a second, as a mean over the last few seconds.
#[derive(Clone, Copy, Default)]
pub(crate) struct Rate {
    seen: u64,
    value: f64,
}

impl Rate {
    /// After `passed` there are `count` in all; how many are new, and the rate.
    pub(crate) fn update(&mut self, count: u64, passed: Duration) -> (u64, f64) {
        /// Seconds over which the mean is taken.
        const WINDOW: f64 = 5.0;
        let new = count.saturating_sub(self.seen);
        self.seen = count;
        let seconds = passed.as_secs_f64();
        if seconds > 0.0 {
            let share = 1.0 - (-seconds / WINDOW).exp();
            self.value += share * (new as f64 / seconds - self.value);
        }
        (new, self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_comes_close_to_what_is_steady_and_forgets() {
        let (mut rate, second) = (Rate::default(), Duration::from_secs(1));
        let mut last = 0.0;
        for i in 1..=30 {
            let (new, value) = rate.update(100 * i, second);
            assert_eq!(new, 100);
            last = value;
        }
        assert!((last - 100.0).abs() < 1.0, "{last}");
        assert_eq!(rate.update(3000, Duration::ZERO), (0, last));
        for _ in 0..30 {
            last = rate.update(3000, second).1;
        }
        assert!(last < 1.0, "{last}");
    }
}
