//! What a fit shows while it runs.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use ltc_fit::{Cost, Forecast, Outlook, Progress};

/// Time between two lines for machines.
const LINE_EVERY: Duration = Duration::from_millis(200);
/// Units of the bar.
const UNITS: u64 = 1000;

/// Shows progress on stderr: JSON lines for machines, a bar on a terminal, nothing elsewhere.
pub struct FitProgress {
    how: How,
    start: Instant,
    state: Mutex<State>,
}

enum How {
    Json,
    Bar(ProgressBar),
    Silent,
}

struct State {
    forecast: Forecast,
    stage: &'static str,
    told: Duration,
}

impl FitProgress {
    /// Before the first report.
    pub fn new(cost: &Cost, json: bool) -> Self {
        let how = if json {
            How::Json
        } else if std::io::stderr().is_terminal() {
            How::Bar(bar())
        } else {
            How::Silent
        };
        let state = State { forecast: Forecast::new(cost), stage: "", told: Duration::ZERO };
        Self { how, start: Instant::now(), state: Mutex::new(state) }
    }

    /// Takes a report; threads may send them at once and out of order.
    pub fn report(&self, progress: &Progress) {
        // A poisoned lock only means that a thread panicked between two prints.
        let mut state = self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let now = self.start.elapsed();
        let outlook = state.forecast.update(progress, now);
        let new_stage = state.stage != progress.stage;
        state.stage = progress.stage;
        match &self.how {
            How::Silent => {}
            How::Bar(bar) => {
                bar.set_message(words(progress, &outlook));
                bar.set_position((outlook.done * UNITS as f64) as u64);
            }
            How::Json => {
                let last = progress.done == progress.total;
                if new_stage || last || now.saturating_sub(state.told) >= LINE_EVERY {
                    state.told = now;
                    line(&json(progress, &outlook));
                }
            }
        }
    }

    /// Says something between reports.
    pub fn say(&self, text: &str) {
        match &self.how {
            How::Json => line(&serde_json::json!({ "event": "notice", "text": text })),
            How::Bar(bar) => bar.suspend(|| eprintln!("{text}")),
            How::Silent => eprintln!("{text}"),
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let How::Bar(bar) = &self.how {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(UNITS);
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

/// Stage, its progress and time left, the error, and the time left in all.
fn words(progress: &Progress, outlook: &Outlook) -> String {
    let Progress { stage, done, total, tv } = progress;
    let mut words = format!("{stage} {done}/{total}");
    if let Some(left) = outlook.stage_left {
        words += &format!(" ({} left)", time(left));
    }
    if let Some(tv) = tv {
        words += &format!(", TV {tv:.4}");
    }
    if let Some(left) = outlook.left {
        words += &format!(", {} left in all", time(left));
    }
    words
}

fn time(duration: Duration) -> String {
    let seconds = duration.as_secs_f64().ceil() as u64;
    match seconds {
        0..120 => format!("{seconds} s"),
        120..7200 => format!("{} min", seconds.div_ceil(60)),
        _ => format!("{} h", seconds.div_ceil(3600)),
    }
}

fn json(progress: &Progress, outlook: &Outlook) -> serde_json::Value {
    let seconds = |left: Option<Duration>| left.map(|t| (t.as_secs_f64() * 10.0).round() / 10.0);
    serde_json::json!({
        "event": "progress",
        "stage": progress.stage,
        "done": progress.done,
        "total": progress.total,
        "tv": progress.tv,
        "fraction": outlook.done,
        "stage_seconds_left": seconds(outlook.stage_left),
        "seconds_left": seconds(outlook.left),
    })
}

/// A line on stderr; whoever does not read it any more misses nothing.
fn line(value: &serde_json::Value) {
    let _ = writeln!(std::io::stderr(), "{value}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_told_in_fitting_units() {
        let told = |seconds: f64| time(Duration::from_secs_f64(seconds));
        assert_eq!([told(0.0), told(11.2), told(121.0), told(7201.0)], ["0 s", "12 s", "3 min", "3 h"]);
    }

    #[test]
    fn what_is_not_known_is_not_told() {
        let progress = Progress { stage: "entries", done: 3, total: 9, tv: None };
        let outlook = Outlook { done: 0.1, stage_left: None, left: None };
        assert_eq!(words(&progress, &outlook), "entries 3/9");
        assert_eq!(json(&progress, &outlook)["seconds_left"], serde_json::Value::Null);
        let known = Outlook {
            left: Some(Duration::from_secs(9)),
            stage_left: Some(Duration::from_secs(2)),
            ..outlook
        };
        let progress = Progress { tv: Some(0.07), ..progress };
        assert_eq!(words(&progress, &known), "entries 3/9 (2 s left), TV 0.0700, 9 s left in all");
    }
}
