//! A chore as numbered steps: each says what it does before it starts and how long it took after.

use std::fmt::Display;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};

use crate::interrupt;
use crate::say::say;

/// How a step ended that may find nothing to work with.
#[derive(Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Done, and well.
    Passed,
    /// Not done, because of this.
    Skipped(String),
}

/// The steps of one chore, counted.
pub struct Steps {
    total: usize,
    begun: usize,
    skipped: usize,
    /// On a build server nothing may be skipped: a check that does not run there runs nowhere.
    strict: bool,
    start: Instant,
}

impl Steps {
    /// A chore of `total` steps. `strict` makes a skipped step a failed one.
    pub fn new(total: usize, strict: bool) -> Self {
        Self { total, begun: 0, skipped: 0, strict, start: Instant::now() }
    }

    /// Does one step; a failure carries the step's name.
    pub fn step<T>(&mut self, what: impl Display, work: impl FnOnce() -> Result<T>) -> Result<T> {
        let start = self.begin(&what)?;
        let result = work().with_context(|| format!("step '{what}' failed"))?;
        self.end(format_args!("done in {}", seconds(start.elapsed())));
        Ok(result)
    }

    /// Does one step that may be skipped.
    pub fn step_or_skip(&mut self, what: impl Display, work: impl FnOnce() -> Result<Outcome>) -> Result<()> {
        let start = self.begin(&what)?;
        match work().with_context(|| format!("step '{what}' failed"))? {
            Outcome::Passed => self.end(format_args!("done in {}", seconds(start.elapsed()))),
            Outcome::Skipped(why) if self.strict => {
                anyhow::bail!(
                    "step '{what}' failed: it was skipped, because {why}, and CI=true lets nothing be skipped"
                );
            }
            Outcome::Skipped(why) => {
                self.skipped += 1;
                self.end(format_args!("skipped, because {why}"));
            }
        }
        Ok(())
    }

    /// How it went, in the words of a test runner's closing line.
    pub fn tally(&self, failed: bool) -> String {
        let failed = usize::from(failed);
        let (passed, skipped) = (self.begun - self.skipped - failed, self.skipped);
        format!("steps: {passed} passed, {failed} failed, {skipped} skipped")
    }

    /// The time since the chore began.
    pub fn elapsed(&self) -> String {
        seconds(self.start.elapsed())
    }

    fn begin(&mut self, what: &impl Display) -> Result<Instant> {
        interrupt::check()?;
        self.begun += 1;
        say(format_args!("[{}/{}] {what}", self.begun, self.total));
        Ok(Instant::now())
    }

    fn end(&self, how: impl Display) {
        say(format_args!("[{}/{}] {how}", self.begun, self.total));
    }
}

/// `0.4 s`, `3 min 12 s`.
fn seconds(time: Duration) -> String {
    let whole = time.as_secs();
    if whole < 60 {
        format!("{:.1} s", time.as_secs_f64())
    } else {
        format!("{} min {} s", whole / 60, whole % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn skip() -> Result<Outcome> {
        Ok(Outcome::Skipped("there is no such tool".to_owned()))
    }

    #[test]
    fn counts_and_names_a_failure() {
        let mut steps = Steps::new(3, false);
        assert_eq!(steps.step("adding", || Ok(1 + 1)).expect("done"), 2);
        steps.step_or_skip("skipping", skip).expect("skipping is allowed here");
        let broken = || -> Result<()> { anyhow::bail!("the cause") };
        let cause = steps.step("breaking", broken).expect_err("broken");
        assert_eq!(format!("{cause:#}"), "step 'breaking' failed: the cause");
        assert_eq!(steps.tally(true), "steps: 1 passed, 1 failed, 1 skipped");
    }

    #[test]
    fn a_skip_on_a_build_server_is_a_failure() {
        let cause = Steps::new(1, true).step_or_skip("skipping", skip).expect_err("nothing may be skipped");
        assert!(cause.to_string().contains("there is no such tool"), "{cause}");
    }

    #[test]
    fn times_read_well() {
        assert_eq!(seconds(Duration::from_millis(440)), "0.4 s");
        assert_eq!(seconds(Duration::from_secs(192)), "3 min 12 s");
    }
}
