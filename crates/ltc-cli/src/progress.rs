//! What long work shows while it runs.

use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// How often a line is printed where no terminal is attached.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// A bar on a terminal; elsewhere a line every few seconds. All of it goes to stderr.
pub struct Reporter {
    bar: Option<ProgressBar>,
    lines: Mutex<Lines>,
}

struct Lines {
    stage: String,
    last: Instant,
}

impl Reporter {
    /// A reporter that has said nothing yet.
    pub fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(1);
            let style = ProgressStyle::with_template("{msg:<40} {wide_bar} {pos}/{len} {eta} left");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        Self { bar, lines: Mutex::new(Lines { stage: String::new(), last: Instant::now() }) }
    }

    /// `done` of `total` units of `stage`; `note` is shown beside it.
    pub fn report(&self, stage: &str, done: usize, total: usize, note: &str) {
        // A poisoned lock only means that a thread panicked between two prints.
        let mut lines = self.lines.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let new_stage = lines.stage != stage;
        if new_stage {
            stage.clone_into(&mut lines.stage);
        }
        if let Some(bar) = &self.bar {
            if new_stage {
                bar.reset();
                bar.set_length(total as u64);
            }
            bar.set_message(format!("{stage}{note}"));
            bar.set_position(done as u64);
        } else if new_stage || lines.last.elapsed() >= LINE_EVERY || done == total {
            lines.last = Instant::now();
            eprintln!("{stage}: {done}/{total}{note}");
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
