//! A run in the formats of others.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::{Value, json};

use super::{Interval, Record, Run};

/// A row for each record: id, unit, time with its interval in nanoseconds, bytes, every kind of error, the ratio with its
/// interval and what it may be, and the time beside a yardstick with its interval.
pub fn csv(run: &Run) -> String {
    let mut kinds: Vec<&str> = run.records.iter().flat_map(|r| r.errors.keys()).map(String::as_str).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let mut text = format!(
        "id,per,time_ns,time_low_ns,time_high_ns,bytes,{}{}ratio,ratio_low,ratio_high,asked,relative,relative_low,relative_high\n",
        kinds.join(","),
        if kinds.is_empty() { "" } else { "," }
    );
    let number = |x: Option<f64>| x.map(|x| x.to_string()).unwrap_or_default();
    for record in &run.records {
        let three =
            |i: Option<Interval>| [i.map(|i| i.median), i.map(|i| i.low), i.map(|i| i.high)].map(number);
        let mut cells = vec![record.id.clone(), record.per.clone()];
        cells.extend(three(record.time));
        cells.push(record.bytes.map(|b| b.to_string()).unwrap_or_default());
        cells.extend(kinds.iter().map(|kind| number(record.errors.get(*kind).copied())));
        cells.extend(three(record.ratio));
        cells.push(number(record.asked));
        cells.extend(three(record.relative));
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}

/// [Bencher Metric Format](https://bencher.dev/docs/reference/bencher-metric-format/): by id the measures `latency` (ns),
/// `file-size` (bytes), `ratio` and `error-<kind>`.
pub fn bencher(run: &Run) -> Value {
    let metrics = |record: &Record| {
        let mut metrics = BTreeMap::new();
        if let Some(time) = record.time {
            let value = json!({ "value": time.median, "lower_value": time.low, "upper_value": time.high });
            metrics.insert("latency".to_owned(), value);
        }
        if let Some(bytes) = record.bytes {
            metrics.insert("file-size".to_owned(), json!({ "value": bytes }));
        }
        if let Some(ratio) = record.ratio {
            let value = json!({ "value": ratio.median, "lower_value": ratio.low, "upper_value": ratio.high });
            metrics.insert("ratio".to_owned(), value);
        }
        for (kind, error) in &record.errors {
            metrics.insert(format!("error-{}", kind.replace('_', "-")), json!({ "value": error }));
        }
        metrics
    };
    let by_id: BTreeMap<&str, _> = run.records.iter().map(|r| (r.id.as_str(), metrics(r))).collect();
    json!(by_id)
}

/// What github-action-benchmark reads with `tool: customSmallerIsBetter`.
pub fn action(run: &Run) -> Value {
    let mut entries = Vec::new();
    for record in &run.records {
        if let Some(time) = record.time {
            let range = format!("± {:.3}", 0.5 * (time.high - time.low));
            entries.push(json!({
                "name": format!("{} time", record.id), "unit": format!("ns per {}", record.per),
                "value": time.median, "range": range,
            }));
        }
        if let Some(bytes) = record.bytes {
            entries.push(json!({ "name": format!("{} size", record.id), "unit": "bytes", "value": bytes }));
        }
        if let Some(ratio) = record.ratio {
            let range = format!("± {:.3}", 0.5 * (ratio.high - ratio.low));
            let name = format!("{} ratio", record.id);
            entries.push(json!({ "name": name, "unit": "ratio", "value": ratio.median, "range": range }));
        }
        for (kind, error) in &record.errors {
            let name = format!("{} error {kind}", record.id);
            entries.push(json!({ "name": name, "unit": "fraction", "value": error }));
        }
    }
    json!(entries)
}
