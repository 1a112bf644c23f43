//! What changed from one run to another.

use std::collections::BTreeMap;

use crate::{Interval, Record, Run, YARDSTICK};

/// From which ratio on a change counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    /// Of times: 0.1 for a tenth slower.
    pub time: f64,
    /// Of errors and sizes: they are reproducible, so that little is enough.
    pub error: f64,
    /// Errors below this are rounding, and no news.
    pub error_floor: f64,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self { time: 0.1, error: 0.005, error_floor: 1e-8 }
    }
}

/// How a change is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Beyond the threshold, upwards, and by more than the intervals leave open.
    Worse,
    /// The same, downwards.
    Better,
    /// Neither.
    Same,
}

/// One measure in both runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The record's id.
    pub id: String,
    /// `time`, `bytes`, `ratio`, or the kind of the error.
    pub measure: String,
    /// In the first run and in the second.
    pub values: [f64; 2],
    /// Second over first.
    pub ratio: Interval,
    /// What it comes to.
    pub verdict: Verdict,
}

/// Two runs side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Every measure that both have, in the order of the first.
    pub changes: Vec<Change>,
    /// How much slower the machine as a whole was: nothing that was timed beside a yardstick is judged by it.
    pub drift: Option<Interval>,
    /// Measures that the second lacks.
    pub gone: Vec<String>,
    /// Why the two may not be comparable: other machines, a short and a long run.
    pub doubts: Vec<String>,
}

impl Comparison {
    /// Whether nothing became worse and nothing went away.
    pub fn is_good(&self) -> bool {
        self.gone.is_empty() && self.changes.iter().all(|change| change.verdict != Verdict::Worse)
    }
}

/// Compares `after` with `before`.
pub fn compare(before: &Run, after: &Run, thresholds: Thresholds) -> Comparison {
    let found: BTreeMap<&str, &Record> = after.records.iter().map(|r| (r.id.as_str(), r)).collect();
    let drift = drift(before, after);
    let mut comparison =
        Comparison { changes: Vec::new(), drift, gone: Vec::new(), doubts: doubts(before, after) };
    for old in before.records.iter().filter(|record| record.word(0) != "yardstick") {
        let new = found.get(old.id.as_str()).copied();
        for (measure, value) in measures(old) {
            let Some((new, other)) = new.and_then(|new| Some((new, measure_of(new, &measure)?))) else {
                comparison.gone.push(format!("{} {measure}", old.id));
                continue;
            };
            let judged = judged(&measure, [old, new]).unwrap_or([value, other]);
            let (ratio, verdict) = change(&measure, judged, thresholds);
            let values = [value.median, other.median];
            comparison.changes.push(Change { id: old.id.clone(), measure, values, ratio, verdict });
        }
    }
    comparison
}

/// Time of a core's yardstick in the second run over that in the first.
fn drift(before: &Run, after: &Run) -> Option<Interval> {
    let of = |run: &Run| run.records.iter().find(|record| record.id == YARDSTICK)?.time;
    Some(over(of(after)?, of(before)?))
}

/// What a measure is judged by in place of itself: times by those beside a yardstick, where both have them.
fn judged(measure: &str, [old, new]: [&Record; 2]) -> Option<[Interval; 2]> {
    if measure == "time" { Some([old.relative?, new.relative?]) } else { None }
}

fn measure_of(record: &Record, measure: &str) -> Option<Interval> {
    measures(record).into_iter().find(|(name, _)| name == measure).map(|(_, value)| value)
}

/// The quotient, as far as both leave it open.
fn over(new: Interval, old: Interval) -> Interval {
    Interval { median: new.median / old.median, low: new.low / old.high, high: new.high / old.low }
}

/// Every figure of a record: `time` in nanoseconds, `bytes`, and errors by their kind. Exact ones are intervals of no width.
pub fn measures(record: &Record) -> Vec<(String, Interval)> {
    let exact = |x: f64| Interval { median: x, low: x, high: x };
    let time = record.time.map(|time| ("time".to_owned(), time));
    let bytes = record.bytes.map(|bytes| ("bytes".to_owned(), exact(bytes as f64)));
    let ratio = record.ratio.map(|ratio| ("ratio".to_owned(), ratio));
    let errors = record.errors.iter().map(|(kind, error)| (kind.clone(), exact(*error)));
    time.into_iter().chain(bytes).chain(ratio).chain(errors).collect()
}

fn change(measure: &str, [old, new]: [Interval; 2], thresholds: Thresholds) -> (Interval, Verdict) {
    let is_timed = measure == "time" || measure == "ratio";
    let is_error = !is_timed && measure != "bytes";
    // Two errors in the noise of rounding are equal.
    let floor = if is_error { thresholds.error_floor } else { f64::MIN_POSITIVE };
    let raised = |i: Interval| Interval {
        median: i.median.max(floor),
        low: i.low.max(floor),
        high: i.high.max(floor),
    };
    let ratio = over(raised(new), raised(old));
    let threshold = 1.0 + if is_timed { thresholds.time } else { thresholds.error };
    let verdict = if ratio.median > threshold && ratio.low > 1.0 {
        Verdict::Worse
    } else if ratio.median < 1.0 / threshold && ratio.high < 1.0 {
        Verdict::Better
    } else {
        Verdict::Same
    };
    (ratio, verdict)
}

fn doubts(before: &Run, after: &Run) -> Vec<String> {
    let mut doubts = Vec::new();
    let mut differ = |what: &str, a: &str, b: &str| {
        if a != b {
            doubts.push(format!("{what} differ: {a} and {b}"));
        }
    };
    let length = |run: &Run| if run.quick { "quick" } else { "full" };
    differ("lengths of the runs", length(before), length(after));
    differ("processors", &before.machine.cpu, &after.machine.cpu);
    differ("builds", &before.machine.build, &after.machine.build);
    let device = |run: &Run| run.machine.gpu.clone().unwrap_or_else(|| "none".to_owned());
    differ("graphics devices", &device(before), &device(after));
    for (run, which) in [(before, "first"), (after, "second")] {
        if let Some(load) = run.machine.load.filter(|load| *load > 1.0) {
            doubts.push(format!("the {which} run began on a busy machine (load {load})"));
        }
    }
    doubts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Machine;

    fn run() -> Run {
        let time = |median: f64| Interval { median, low: 0.97 * median, high: 1.03 * median };
        let records = vec![
            Record::new("integral/quad/exact/f32", "light").timed(time(40.0)).error("max", 6e-7),
            Record::new("table/ggx/f16", "table").sized(98304).error("tv_mean", 0.0723),
            Record::new("integral/quad/exact/f64", "light").timed(time(41.0)).error("max", 2e-13),
        ];
        let machine = Machine::default();
        Run { schema: 1, tool: "0".into(), quick: true, date: String::new(), commit: None, machine, records }
    }

    fn worse(after: &Run) -> Vec<String> {
        let found = compare(&run(), after, Thresholds::default());
        let worse = found.changes.iter().filter(|c| c.verdict == Verdict::Worse);
        worse.map(|c| format!("{} {}", c.id, c.measure)).collect()
    }

    #[test]
    fn a_run_is_as_good_as_itself() {
        let same = compare(&run(), &run(), Thresholds::default());
        assert!(same.is_good() && same.doubts.is_empty());
        assert_eq!(same.changes.len(), 6);
    }

    #[test]
    fn a_planted_slowdown_of_a_fifth_is_caught() {
        let mut after = run();
        let time = after.records[0].time.as_mut().unwrap();
        *time = Interval { median: 1.2 * time.median, low: 1.2 * time.low, high: 1.2 * time.high };
        assert_eq!(worse(&after), ["integral/quad/exact/f32 time"]);
        assert!(!compare(&run(), &after, Thresholds::default()).is_good());
        // The other way round it is an improvement.
        let back = compare(&after, &run(), Thresholds::default());
        assert!(back.is_good());
        assert_eq!(back.changes[0].verdict, Verdict::Better);
    }

    #[test]
    fn a_planted_error_of_a_hundredth_is_caught() {
        let mut after = run();
        after.records[1].errors.insert("tv_mean".into(), 1.01 * 0.0723);
        assert_eq!(worse(&after), ["table/ggx/f16 tv_mean"]);
        let mut after = run();
        after.records[0].errors.insert("max".into(), 1.01 * 6e-7);
        assert_eq!(worse(&after), ["integral/quad/exact/f32 max"]);
    }

    /// The run on a machine whose clock is slower by a factor, where all things take longer by another.
    fn beside_a_yardstick(clock: f64, by: f64) -> Run {
        let around = |x: f64| Interval { median: x, low: 0.99 * x, high: 1.01 * x };
        let mut run = run();
        for record in &mut run.records {
            if let Some(time) = record.time {
                record.time = Some(around(by * time.median));
                record.relative = Some(around(by * time.median / clock));
            }
        }
        run.records.push(Record::new(YARDSTICK, "step").timed(around(2.0 * clock)));
        run.records.push(Record::new("ratio/gpu/1080p/line_over_quad", "ratio").ratio(around(by), Some(0.5)));
        run
    }

    #[test]
    fn a_slower_machine_is_no_slower_program() {
        let before = beside_a_yardstick(1.0, 1.0);
        let worse = |clock: f64, by: f64| -> Vec<String> {
            let found = compare(&before, &beside_a_yardstick(clock, by), Thresholds::default());
            assert!((found.drift.unwrap().median - clock).abs() < 1e-12);
            let worse = found.changes.into_iter().filter(|c| c.verdict == Verdict::Worse);
            worse.map(|c| format!("{} {}", c.id.split('/').next().unwrap_or(""), c.measure)).collect()
        };
        // The clock explains the times, and not the ratio.
        assert_eq!(worse(1.2, 1.2), ["ratio ratio"]);
        assert!(worse(1.2, 1.0).is_empty());
        // On a machine that is faster by a fifth, the same times are a loss.
        assert_eq!(worse(1.0 / 1.2, 1.0), ["integral time", "integral time"]);
        let same = compare(&before, &beside_a_yardstick(1.2, 1.2), Thresholds::default());
        assert!((same.changes[0].ratio.median - 1.0).abs() < 1e-12);
        assert!((same.changes[0].values[1] - 48.0).abs() < 1e-9, "what is shown is in nanoseconds");
    }

    #[test]
    fn where_one_run_has_no_yardstick_times_are_compared_as_they_are() {
        let after = beside_a_yardstick(1.2, 1.2);
        assert_eq!(worse(&after), ["integral/quad/exact/f32 time", "integral/quad/exact/f64 time"]);
    }

    #[test]
    fn noise_is_no_news() {
        let mut after = run();
        // Within both intervals, and in the rounding of f64.
        after.records[0].time.as_mut().unwrap().median *= 1.05;
        after.records[2].errors.insert("max".into(), 9e-13);
        assert!(worse(&after).is_empty());
        // Beyond the threshold, but so uncertain that nothing follows.
        after.records[2].time = Some(Interval { median: 50.0, low: 30.0, high: 80.0 });
        assert!(worse(&after).is_empty());
    }

    #[test]
    fn what_goes_away_is_missed() {
        let mut after = run();
        after.records.pop();
        let found = compare(&run(), &after, Thresholds::default());
        assert_eq!(found.gone, ["integral/quad/exact/f64 time", "integral/quad/exact/f64 max"]);
        assert!(!found.is_good());
    }

    #[test]
    fn other_machines_are_a_doubt() {
        let mut after = run();
        after.machine.cpu = "another".into();
        after.quick = false;
        after.machine.load = Some(3.0);
        assert_eq!(compare(&run(), &after, Thresholds::default()).doubts.len(), 3);
    }
}
