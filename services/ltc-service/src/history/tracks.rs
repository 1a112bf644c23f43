//! Which runs can be compared, and what became of each measure.

use std::collections::BTreeMap;

use ltc_records::{Change, Comparison, Interval, Run, SCHEMA, Thresholds, Verdict, compare, measures};
use ltc_store::Benchmark;
use ltc_table::digest::digest;

/// A run as it was kept.
pub(crate) struct Kept {
    /// Name of the series.
    pub name: String,
    /// When it ran.
    pub at: String,
    pub run: Run,
}

/// Runs of one series on one machine, with one build, of one length: those that can be compared.
pub(crate) struct Track {
    /// Its name in a query.
    pub key: String,
    /// Its name for people.
    pub label: String,
    /// Places of its runs in the history, oldest first.
    pub runs: Vec<usize>,
    /// The newest run against the one before it, where there are two.
    pub newest: Option<Comparison>,
}

/// A measure in one run.
pub(crate) struct Dot {
    /// Place of the run in the history.
    pub run: usize,
    pub value: Interval,
    /// Against the run before it on the same track, where that has it.
    pub change: Option<Change>,
}

impl Dot {
    pub(crate) fn verdict(&self) -> Verdict {
        self.change.as_ref().map_or(Verdict::Same, |change| change.verdict)
    }
}

/// A measure along one track.
pub(crate) struct Line {
    /// Place of the track in the history.
    pub track: usize,
    pub dots: Vec<Dot>,
}

/// What is drawn in one chart.
pub(crate) struct Measure {
    /// The record's id.
    pub id: String,
    /// `time`, `bytes`, or the kind of the error.
    pub kind: String,
    /// What one unit of time does.
    pub per: String,
    pub lines: Vec<Line>,
}

impl Measure {
    /// Whether the newest run of a track is worse in it than the one before.
    pub(crate) fn is_worse(&self, tracks: &[Track]) -> bool {
        self.lines.iter().any(|line| {
            let newest = tracks[line.track].runs.last();
            line.dots.last().is_some_and(|dot| Some(&dot.run) == newest && dot.verdict() == Verdict::Worse)
        })
    }

    /// Whether any run is worse in it than the one before.
    pub(crate) fn ever_worse(&self) -> bool {
        self.lines.iter().flat_map(|line| &line.dots).any(|dot| dot.verdict() == Verdict::Worse)
    }
}

/// All of it.
pub(crate) struct History {
    /// Oldest first.
    pub runs: Vec<Kept>,
    pub tracks: Vec<Track>,
    /// By id and kind.
    pub measures: Vec<Measure>,
    /// Runs that are none of `ltc bench`.
    pub strangers: usize,
}

impl History {
    /// Of runs, oldest first.
    pub(crate) fn of(found: Vec<Benchmark>) -> Self {
        let (mut runs, mut strangers) = (Vec::new(), 0);
        for Benchmark { name, at, run, .. } in found {
            match serde_json::from_value::<Run>(run) {
                Ok(run) if run.schema == SCHEMA => runs.push(Kept { name, at, run }),
                _ => strangers += 1,
            }
        }
        let mut tracks: BTreeMap<String, Track> = BTreeMap::new();
        for (place, kept) in runs.iter().enumerate() {
            let label = label(kept);
            let key = key(&label);
            let new = Track { key: key.clone(), label, runs: Vec::new(), newest: None };
            tracks.entry(key).or_insert(new).runs.push(place);
        }
        let mut tracks: Vec<Track> = tracks.into_values().collect();
        tracks.sort_by(|a, b| a.label.cmp(&b.label));
        let mut charts: BTreeMap<(String, String), Measure> = BTreeMap::new();
        for (track, of) in tracks.iter_mut().enumerate() {
            let mut before: Option<&Run> = None;
            for &place in &of.runs {
                let run = &runs[place].run;
                let comparison = before.map(|before| compare(before, run, Thresholds::default()));
                add(&mut charts, track, place, run, comparison.as_ref());
                (before, of.newest) = (Some(run), comparison);
            }
        }
        Self { runs, tracks, measures: charts.into_values().collect(), strangers }
    }
}

/// Adds a dot for every measure of a run.
fn add(
    charts: &mut BTreeMap<(String, String), Measure>,
    track: usize,
    place: usize,
    run: &Run,
    comparison: Option<&Comparison>,
) {
    let changes = comparison.map_or(&[][..], |comparison| &comparison.changes);
    let changes: BTreeMap<(&str, &str), &Change> =
        changes.iter().map(|change| ((change.id.as_str(), change.measure.as_str()), change)).collect();
    for record in &run.records {
        for (kind, value) in measures(record) {
            let change = changes.get(&(record.id.as_str(), kind.as_str())).map(|change| (*change).clone());
            let dot = Dot { run: place, value, change };
            let chart = charts.entry((record.id.clone(), kind.clone())).or_insert_with(|| Measure {
                id: record.id.clone(),
                kind,
                per: record.per.clone(),
                lines: Vec::new(),
            });
            match chart.lines.last_mut().filter(|line| line.track == track) {
                Some(line) => line.dots.push(dot),
                None => chart.lines.push(Line { track, dots: vec![dot] }),
            }
        }
    }
}

/// Everything that two runs must share to be comparable.
fn label(Kept { name, run, .. }: &Kept) -> String {
    let machine = &run.machine;
    let length = if run.quick { "quick" } else { "full" };
    let mut label = format!(
        "{name}: {}, {} threads, {}, {}",
        machine.cpu, machine.threads, machine.system, machine.build
    );
    if let Some(gpu) = &machine.gpu {
        label.push_str(", ");
        label.push_str(gpu);
    }
    format!("{label}, {length} runs")
}

fn key(label: &str) -> String {
    digest(label.as_bytes()).trim_start_matches("sha256:").chars().take(12).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// A run in which one light takes so long, as it would be posted.
    pub(crate) fn posted(cpu: &str, day: u32, time: f64, error: f64) -> Benchmark {
        let at = format!("2026-01-{day:02}T00:00:00Z");
        let run = json!({
            "schema": 1, "tool": "0.1.0", "quick": true, "date": at, "commit": format!("c{day}"),
            "machine": { "cpu": cpu, "threads": 2, "system": "linux", "build": "optimised" },
            "records": [
                { "id": "integral/quad", "per": "light", "errors": { "max": error },
                  "time": { "median": time, "low": 0.99 * time, "high": 1.01 * time } },
                { "id": "table/ggx/f16", "per": "table", "bytes": 98304 },
            ],
        });
        Benchmark { id: u64::from(day), name: "nightly".to_owned(), at, run }
    }

    fn stranger(run: Value) -> Benchmark {
        Benchmark { id: 0, name: "other".to_owned(), at: "2026-01-01T00:00:00Z".to_owned(), run }
    }

    #[test]
    fn each_machine_is_compared_with_itself() {
        // Another machine's run lies between; it is half as fast, and that is no regression.
        let history = History::of(vec![
            posted("a", 1, 40.0, 1e-6),
            posted("b", 2, 80.0, 1e-6),
            posted("a", 3, 41.0, 1e-6),
            posted("b", 4, 81.0, 1e-6),
        ]);
        assert_eq!(history.tracks.len(), 2);
        assert_eq!(history.tracks.iter().map(|t| t.runs.clone()).collect::<Vec<_>>(), [[0, 2], [1, 3]]);
        let names: Vec<String> = history.measures.iter().map(|m| format!("{} {}", m.id, m.kind)).collect();
        assert_eq!(names, ["integral/quad max", "integral/quad time", "table/ggx/f16 bytes"]);
        assert!(history.measures.iter().all(|m| m.lines.len() == 2 && !m.ever_worse()));
    }

    #[test]
    fn a_planted_slowdown_and_a_planted_error_are_marked_where_they_came() {
        let history = History::of(vec![
            posted("a", 1, 40.0, 1e-6),
            posted("a", 2, 48.0, 1e-6),
            posted("a", 3, 48.0, 1.01e-6),
        ]);
        let verdicts = |kind: &str| {
            let measure = history.measures.iter().find(|m| m.kind == kind).unwrap();
            measure.lines[0].dots.iter().map(Dot::verdict).collect::<Vec<_>>()
        };
        assert_eq!(verdicts("time"), [Verdict::Same, Verdict::Worse, Verdict::Same]);
        assert_eq!(verdicts("max"), [Verdict::Same, Verdict::Same, Verdict::Worse]);
        let worse: Vec<bool> = history.measures.iter().map(|m| m.is_worse(&history.tracks)).collect();
        assert_eq!(worse, [true, false, false], "in the newest run");
        assert!(!history.tracks[0].newest.as_ref().unwrap().is_good());
    }

    #[test]
    fn what_is_no_run_of_the_study_is_counted() {
        let mut newer = posted("a", 1, 1.0, 1.0);
        newer.run["schema"] = json!(2);
        let history = History::of(vec![stranger(json!({ "ns": 3 })), newer, posted("a", 2, 1.0, 1.0)]);
        assert_eq!((history.strangers, history.runs.len()), (2, 1));
        let nothing = History::of(Vec::new());
        assert!(nothing.tracks.is_empty() && nothing.measures.is_empty());
    }
}
