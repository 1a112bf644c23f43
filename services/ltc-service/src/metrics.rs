//! Counters and their Prometheus text.

use std::fmt::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// A number that only grows.
#[derive(Debug, Default)]
pub(crate) struct Counter(AtomicU64);

impl Counter {
    pub(crate) fn add(&self, count: u64) {
        self.0.fetch_add(count, Ordering::Relaxed);
    }

    pub(crate) fn value(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// Upper ends of the buckets of latencies, seconds.
const BUCKETS: [f64; 14] =
    [0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 1.0, 5.0, 30.0];

/// How long things took.
#[derive(Debug, Default)]
struct Histogram {
    counts: [Counter; BUCKETS.len() + 1],
    microseconds: Counter,
}

impl Histogram {
    fn observe(&self, time: Duration) {
        let seconds = time.as_secs_f64();
        let bucket = BUCKETS.iter().position(|end| seconds <= *end).unwrap_or(BUCKETS.len());
        self.counts[bucket].add(1);
        self.microseconds.add(time.as_micros() as u64);
    }
}

/// Statuses that are counted each by itself; others are counted under the hundred they belong to.
const STATUSES: [u16; 24] = [
    200, 201, 202, 204, 206, 304, 400, 401, 403, 404, 405, 408, 409, 412, 413, 415, 416, 422, 428, 429, 431,
    500, 503, 507,
];
const CLASSES: [&str; 5] = ["1xx", "2xx", "3xx", "4xx", "5xx"];

/// What is counted of one route.
#[derive(Debug, Default)]
struct RouteMetrics {
    statuses: [Counter; STATUSES.len() + CLASSES.len()],
    latency: Histogram,
}

/// Which route answered, by its place in the list of routes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RouteLabel(pub usize);

/// Room for routes; the first is for requests that match none.
pub(crate) const MOST_ROUTES: usize = 48;

/// Everything that is counted here. Nothing is allocated to count.
#[derive(Debug)]
pub(crate) struct Metrics {
    routes: Box<[RouteMetrics]>,
    /// Answers given again as they were.
    pub answer_hits: Counter,
    /// Files made of tables: from memory.
    pub cache_hits: Counter,
    /// From the store.
    pub store_hits: Counter,
    /// Made.
    pub cache_misses: Counter,
    /// Requests refused because there were too many.
    pub shed: Counter,
    /// Requests refused because one client asked too often.
    pub limited: Counter,
}

impl Default for Metrics {
    fn default() -> Self {
        Self {
            routes: (0..MOST_ROUTES).map(|_| RouteMetrics::default()).collect(),
            answer_hits: Counter::default(),
            cache_hits: Counter::default(),
            store_hits: Counter::default(),
            cache_misses: Counter::default(),
            shed: Counter::default(),
            limited: Counter::default(),
        }
    }
}

impl Metrics {
    /// Counts an answer.
    pub(crate) fn answered(&self, RouteLabel(route): RouteLabel, status: u16, time: Duration) {
        let Some(route) = self.routes.get(route) else { return };
        let class = STATUSES.len() + usize::from(status / 100).clamp(1, CLASSES.len()) - 1;
        let index = STATUSES.iter().position(|known| *known == status).unwrap_or(class);
        route.statuses[index].add(1);
        route.latency.observe(time);
    }

    /// As Prometheus text; `routes` are the patterns of the labels.
    pub(crate) fn write(&self, out: &mut String, routes: &[&str]) {
        head(out, "ltc_http_requests_total", "counter", "Requests by route and status.");
        for (route, pattern) in self.routes.iter().zip(routes) {
            for (index, count) in route.statuses.iter().enumerate().filter(|(_, count)| count.value() > 0) {
                let status = STATUSES
                    .get(index)
                    .map_or_else(|| CLASSES[index - STATUSES.len()].to_owned(), ToString::to_string);
                // Writing to a string cannot fail, here and below.
                let _ = writeln!(
                    out,
                    "ltc_http_requests_total{{route=\"{pattern}\",status=\"{status}\"}} {}",
                    count.value()
                );
            }
        }
        let name = "ltc_http_request_duration_seconds";
        head(out, name, "histogram", "Time until an answer began, by route.");
        for (route, pattern) in self.routes.iter().zip(routes) {
            write_histogram(out, name, pattern, &route.latency);
        }
        for (name, help, counter) in [
            ("ltc_answer_cache_hits_total", "Answers that were given again as they were.", &self.answer_hits),
            ("ltc_requests_shed_total", "Requests refused because there were too many.", &self.shed),
            (
                "ltc_requests_limited_total",
                "Requests refused because a client asked too often.",
                &self.limited,
            ),
        ] {
            head(out, name, "counter", help);
            let _ = writeln!(out, "{name} {}", counter.value());
        }
        let name = "ltc_derived_total";
        head(out, name, "counter", "Files made of tables, by where they came from.");
        for (from, counter) in
            [("memory", &self.cache_hits), ("store", &self.store_hits), ("made", &self.cache_misses)]
        {
            let _ = writeln!(out, "{name}{{from=\"{from}\"}} {}", counter.value());
        }
    }
}

fn write_histogram(out: &mut String, name: &str, route: &str, histogram: &Histogram) {
    let total: u64 = histogram.counts.iter().map(Counter::value).sum();
    if total == 0 {
        return;
    }
    let mut below = 0;
    for (end, count) in BUCKETS.iter().zip(&histogram.counts) {
        below += count.value();
        let _ = writeln!(out, "{name}_bucket{{route=\"{route}\",le=\"{end}\"}} {below}");
    }
    let seconds = histogram.microseconds.value() as f64 / 1e6;
    let _ = writeln!(out, "{name}_bucket{{route=\"{route}\",le=\"+Inf\"}} {total}");
    let _ = writeln!(out, "{name}_sum{{route=\"{route}\"}} {seconds}");
    let _ = writeln!(out, "{name}_count{{route=\"{route}\"}} {total}");
}

/// The two lines before a metric.
pub(crate) fn head(out: &mut String, name: &str, kind: &str, help: &str) {
    let _ = writeln!(out, "# HELP {name} {help}\n# TYPE {name} {kind}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_counted_by_route_and_status() {
        let metrics = Metrics::default();
        for (status, milliseconds) in [(200, 0), (200, 2), (418, 40_000)] {
            metrics.answered(RouteLabel(1), status, Duration::from_millis(milliseconds));
        }
        metrics.answered(RouteLabel(MOST_ROUTES), 200, Duration::ZERO);
        let mut text = String::new();
        metrics.write(&mut text, &["none", "/a"]);
        for line in [
            "ltc_http_requests_total{route=\"/a\",status=\"200\"} 2",
            "ltc_http_requests_total{route=\"/a\",status=\"4xx\"} 1",
            "ltc_http_request_duration_seconds_bucket{route=\"/a\",le=\"0.0001\"} 1",
            "ltc_http_request_duration_seconds_bucket{route=\"/a\",le=\"0.0025\"} 2",
            "ltc_http_request_duration_seconds_bucket{route=\"/a\",le=\"30\"} 2",
            "ltc_http_request_duration_seconds_bucket{route=\"/a\",le=\"+Inf\"} 3",
            "ltc_http_request_duration_seconds_count{route=\"/a\"} 3",
            "ltc_http_request_duration_seconds_sum{route=\"/a\"} 40.002",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\n{text}");
        }
        assert!(!text.contains("route=\"none\""));
    }
}
