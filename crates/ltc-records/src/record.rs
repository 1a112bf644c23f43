//! What a study says: one record for each thing measured.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::Machine;

/// The layout of [`Run`] that this program writes.
pub const SCHEMA: u32 = 1;

/// The record of what takes as long as a core is slow, timed in the same turns as lookups and integrals.
pub const YARDSTICK: &str = "yardstick/chain";

/// One run of the study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Layout of this document; grows when a reader has to know.
    pub schema: u32,
    /// Version of the program.
    pub tool: String,
    /// Whether this was the short run: fewer cases and rounds, so that figures of short and long runs are not comparable.
    pub quick: bool,
    /// When it began, RFC 3339 in UTC.
    pub date: String,
    /// The commit that was measured, where the caller named it.
    pub commit: Option<String>,
    /// Where it ran.
    pub machine: Machine,
    /// What was measured, in the order of measuring.
    pub records: Vec<Record>,
}

/// What something costs, and how wrong it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its name for ever: lower-case words between slashes, from the general to the particular.
    pub id: String,
    /// What one unit of `time` does: "lookup", "light", "frame", "light of a frame", "table"; "ratio" for what has none.
    pub per: String,
    /// Time of one unit, in nanoseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<Interval>,
    /// The same in times of a yardstick that was measured beside it: what the machine's clock does falls out. Two runs are
    /// compared by it, where both have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<Interval>,
    /// Size, where it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
    /// How one thing's time compares with another's, turn by turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio: Option<Interval>,
    /// What the ratio may be, where something is asked of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asked: Option<f64>,
    /// Errors by kind: `tv_mean`, `tv_p95`, `max`, `rms`, `relative_rmse`, `rmse`, `flip`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub errors: BTreeMap<String, f64>,
}

impl Record {
    /// A record with nothing measured yet.
    pub fn new(id: impl Into<String>, per: &str) -> Self {
        Self { id: id.into(), per: per.to_owned(), ..Self::default() }
    }

    /// With an error.
    #[must_use]
    pub fn error(mut self, kind: &str, value: f64) -> Self {
        self.errors.insert(kind.to_owned(), value);
        self
    }

    /// With a time.
    #[must_use]
    pub fn timed(mut self, time: Interval) -> Self {
        self.time = Some(time);
        self
    }

    /// With a time in times of a yardstick.
    #[must_use]
    pub fn relative(mut self, relative: Option<Interval>) -> Self {
        self.relative = relative;
        self
    }

    /// With a ratio, and what it may be.
    #[must_use]
    pub fn ratio(mut self, ratio: Interval, asked: Option<f64>) -> Self {
        (self.ratio, self.asked) = (Some(ratio), asked);
        self
    }

    /// With a size.
    #[must_use]
    pub fn sized(mut self, bytes: u64) -> Self {
        self.bytes = Some(bytes);
        self
    }

    /// The `n`th word of the id, from 0; empty beyond the last.
    pub fn word(&self, n: usize) -> &str {
        self.id.split('/').nth(n).unwrap_or("")
    }
}

/// A median and where it lies with a confidence of 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// The median of the rounds.
    pub median: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The median of `samples` with the interval between two of them that holds the true median in 95 of 100 cases, whatever
    /// their distribution (order statistics of a binomial). `None` without samples or with one that is not a number.
    pub fn of(mut samples: Vec<f64>) -> Option<Self> {
        if samples.is_empty() || samples.iter().any(|x| !x.is_finite()) {
            return None;
        }
        samples.sort_by(f64::total_cmp);
        let n = samples.len();
        let outer = ranks_outside(n);
        let middle = if n % 2 == 1 { samples[n / 2] } else { 0.5 * (samples[n / 2 - 1] + samples[n / 2]) };
        Some(Self { median: middle, low: samples[outer], high: samples[n - 1 - outer] })
    }

    /// In units of something else.
    #[must_use]
    pub fn over(&self, unit: f64) -> Self {
        Self { median: self.median / unit, low: self.low / unit, high: self.high / unit }
    }

    /// Whether both hold a common value.
    pub fn meets(&self, other: &Self) -> bool {
        self.low <= other.high && other.low <= self.high
    }
}

/// How many order statistics at each end lie outside a 95 % interval of the median of `n` samples: the largest k with
/// `P(Bin(n, ½) ≤ k − 1) ≤ 2.5 %`; 0 where even all samples are too few.
fn ranks_outside(n: usize) -> usize {
    let mut probability = 0.5_f64.powi(i32::try_from(n).unwrap_or(i32::MAX));
    let (mut up_to, mut k) = (probability, 0);
    loop {
        // `up_to` is P(Bin ≤ k): what the interval from the (k + 2)nd to the last but k + 1 would leave out at one end.
        probability *= (n - k) as f64 / (k + 1) as f64;
        up_to += probability;
        if up_to > 0.025 || 2 * (k + 1) >= n {
            return k;
        }
        k += 1;
    }
}

#[cfg(test)]
mod tests {
    use ltc_core::points::SplitMix64;

    use super::*;

    #[test]
    fn ranks_are_those_of_the_sign_test() {
        // From tables of the sign test: k for n = 5, 6, 10, 15, 20, 30.
        for (n, k) in [(1, 0), (5, 0), (6, 0), (9, 1), (10, 1), (15, 3), (20, 5), (30, 9)] {
            assert_eq!(ranks_outside(n), k, "{n}");
        }
    }

    #[test]
    fn intervals_hold_the_median_as_often_as_they_say() {
        let mut rng = SplitMix64::new(3);
        let trials = 4000;
        let held = (0..trials)
            .filter(|_| {
                // Skewed, as times are: the median of −ln(u) is ln 2.
                let samples = (0..21).map(|_| -(1.0 - rng.unit()).ln()).collect();
                let found = Interval::of(samples).unwrap();
                (found.low..=found.high).contains(&std::f64::consts::LN_2)
            })
            .count();
        let share = held as f64 / f64::from(trials);
        assert!((0.95..0.985).contains(&share), "{share}");
    }

    #[test]
    fn nothing_has_no_median() {
        assert_eq!(Interval::of(Vec::new()), None);
        assert_eq!(Interval::of(vec![1.0, f64::NAN]), None);
        let one = Interval::of(vec![2.0]).unwrap();
        assert_eq!((one.low, one.median, one.high), (2.0, 2.0, 2.0));
        let apart = Interval::of(vec![3.0]).unwrap();
        assert!(!one.meets(&apart) && one.meets(&one));
    }
}
