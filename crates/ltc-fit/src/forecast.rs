//! How long a running fit will still take.

use core::time::Duration;

use crate::{Cost, Progress};

/// Turns reports of a running fit into the share that is done and the time that is left.
///
/// Shares of the stages are those of the [`Cost`]; speed is what has been seen since the first report, so that a fit that
/// goes on from a checkpoint is judged by its own work.
#[derive(Clone, Debug)]
pub struct Forecast {
    stages: [(&'static str, f64); 4],
    first: Option<Mark>,
    stage: &'static str,
    stage_first: Mark,
}

/// A share that was done at some time.
#[derive(Clone, Copy, Debug, Default)]
struct Mark {
    at: Duration,
    done: f64,
}

/// What a [`Forecast`] says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlook {
    /// Share of the whole fit that is done, in [0, 1].
    pub done: f64,
    /// Time until the end of the stage, once there is something to judge by.
    pub stage_left: Option<Duration>,
    /// Time until the end.
    pub left: Option<Duration>,
}

impl Forecast {
    /// Before the first report.
    pub fn new(cost: &Cost) -> Self {
        let total = cost.total_seconds();
        let stages = cost.seconds.map(|(stage, seconds)| (stage, seconds / total));
        Self { stages, first: None, stage: "", stage_first: Mark::default() }
    }

    /// After a report that came `at` this time since the start.
    pub fn update(&mut self, progress: &Progress, at: Duration) -> Outlook {
        let within = progress.done as f64 / progress.total.max(1) as f64;
        let known = self.stages.iter().position(|(stage, _)| *stage == progress.stage);
        let done = known.map_or(0.0, |i| {
            let after: f64 = self.stages[i + 1..].iter().map(|(_, share)| share).sum();
            (1.0 - after - self.stages[i].1 * (1.0 - within)).clamp(0.0, 1.0)
        });
        let first = *self.first.get_or_insert(Mark { at, done });
        if self.stage != progress.stage {
            self.stage = progress.stage;
            self.stage_first = Mark { at, done: within };
        }
        Outlook {
            done,
            stage_left: left(self.stage_first, Mark { at, done: within }),
            left: left(first, Mark { at, done }),
        }
    }
}

/// The time from `now` to 1, at the speed since `first`.
fn left(first: Mark, now: Mark) -> Option<Duration> {
    /// Share that has to be done, and time that has to pass, before a speed is known.
    const ENOUGH: f64 = 0.005;
    const LONG_ENOUGH: Duration = Duration::from_millis(200);
    let (share, time) = (now.done - first.done, now.at.saturating_sub(first.at));
    if now.done >= 1.0 {
        return Some(Duration::ZERO);
    }
    (share > ENOUGH && time > LONG_ENOUGH).then(|| time.mul_f64((1.0 - now.done) / share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::{ENTRIES, JOINT};

    fn forecast() -> Forecast {
        let seconds = [(ENTRIES, 1.0), (JOINT, 2.0), ("c", 1.0), ("d", 0.0)];
        Forecast::new(&Cost { entries: 1, memory: 1, seconds })
    }

    fn at(forecast: &mut Forecast, stage: &'static str, done: usize, seconds: f64) -> Outlook {
        let progress = Progress { stage, done, total: 100, tv: None };
        forecast.update(&progress, Duration::from_secs_f64(seconds))
    }

    #[test]
    fn even_work_ends_when_it_is_said_to() {
        let mut forecast = forecast();
        assert_eq!(at(&mut forecast, ENTRIES, 0, 1.0).left, None, "nothing to judge by");
        let middle = at(&mut forecast, ENTRIES, 50, 6.0);
        assert_eq!(middle.done, 0.125);
        assert_eq!(at(&mut forecast.clone(), "d", 100, 6.0).done, 1.0);
        assert_eq!(middle.stage_left, Some(Duration::from_secs(5)));
        assert_eq!(middle.left, Some(Duration::from_secs(35)));
        let next = at(&mut forecast, JOINT, 50, 21.0);
        assert_eq!((next.done, next.left), (0.5, Some(Duration::from_secs(20))));
    }

    #[test]
    fn what_was_done_before_does_not_count_as_speed() {
        let mut forecast = forecast();
        at(&mut forecast, JOINT, 90, 0.0);
        let outlook = at(&mut forecast, JOINT, 95, 10.0);
        assert_eq!(outlook.stage_left.map(|t| t.as_secs_f64().round()), Some(10.0));
        // A quarter and five hundredths of a half are left; the latter took 10 seconds.
        assert!((outlook.left.unwrap().as_secs_f64() - 110.0).abs() < 1e-6, "{outlook:?}");
    }

    #[test]
    fn an_unknown_stage_says_nothing() {
        let outlook = at(&mut forecast(), "rest", 50, 9.0);
        assert_eq!((outlook.done, outlook.left), (0.0, None));
    }
}
