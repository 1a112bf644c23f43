//! Times of many things, measured in turns.

use std::hint::black_box;
use std::time::Instant;

use rayon::prelude::*;

use super::Interval;

/// How long to measure.
#[derive(Clone, Copy, Debug)]
pub struct Rounds {
    /// How often each thing is measured.
    pub count: usize,
    /// What one measurement takes at least, in seconds, however often the thing has to be repeated for that.
    pub seconds: f64,
}

/// Something to be timed: what to do, and how many units that is.
pub struct Task<'a> {
    run: Box<dyn FnMut() + 'a>,
    units: f64,
}

impl<'a> Task<'a> {
    /// `run` does `units` of what is asked for. It must hand its results to [`std::hint::black_box`].
    pub fn new(units: usize, run: impl FnMut() + 'a) -> Self {
        Self { run: Box::new(run), units: units as f64 }
    }

    /// What one unit takes, over so many repetitions.
    pub fn nanoseconds(&mut self, repeats: u32) -> f64 {
        self.seconds(repeats) * 1e9 / (self.units * f64::from(repeats))
    }

    fn seconds(&mut self, repeats: u32) -> f64 {
        let start = Instant::now();
        for _ in 0..repeats {
            (self.run)();
        }
        start.elapsed().as_secs_f64()
    }

    /// How often to repeat it, so that a measurement lasts long enough; warms up by the way.
    fn repeats(&mut self, seconds: f64) -> u32 {
        let mut repeats = 1;
        loop {
            let took = self.seconds(repeats);
            if took >= 0.7 * seconds || repeats >= 1 << 24 {
                return (f64::from(repeats) * (seconds / took.max(1e-9)).clamp(1.0, 2.0)).ceil() as u32;
            }
            repeats *= 2;
        }
    }
}

/// What takes as long as the machine is slow and nothing else: a chain of products and sums, each waiting for the one before.
/// Clocks differ from minute to minute by some per cent; what is timed in turns with this can be compared all the same.
pub fn yardstick() -> Task<'static> {
    const STEPS: usize = 1000;
    Task::new(STEPS, || {
        let mut x = black_box(1.0_f64);
        for _ in 0..STEPS {
            x = x * 0.999 + 0.001;
        }
        black_box(x);
    })
}

/// The same on all threads at once: for what uses them all. Pieces are more than threads, so that one that is held up does not
/// hold up the others. Each has chains enough that what slows two threads of one core down slows these, too.
pub fn yardstick_of_all_threads() -> Task<'static> {
    const PIECES: usize = 64;
    const STEPS: usize = 40_000;
    Task::new(STEPS, || {
        (0..PIECES).into_par_iter().for_each(|_| {
            let mut chains = black_box([1.0_f64, 0.9, 0.8, 0.7, 0.6, 0.5]);
            for _ in 0..STEPS {
                for x in &mut chains {
                    *x = *x * 0.999 + 0.001;
                }
            }
            black_box(chains);
        });
    })
}

/// Nanoseconds of a unit of each task, in each turn.
///
/// Tasks take turns: every one is measured once before any is measured again, so that what slows the machine down for some
/// seconds falls on all of them, and shows in the intervals and not in the comparison.
pub fn in_turns(tasks: &mut [Task<'_>], rounds: Rounds) -> Vec<Vec<f64>> {
    let repeats: Vec<u32> = tasks.iter_mut().map(|task| task.repeats(rounds.seconds)).collect();
    let mut samples = vec![Vec::with_capacity(rounds.count); tasks.len()];
    for _ in 0..rounds.count {
        for ((task, repeats), samples) in tasks.iter_mut().zip(&repeats).zip(&mut samples) {
            samples.push(task.nanoseconds(*repeats));
        }
    }
    samples
}

/// Turn by turn, one thing's time over another's.
pub fn quotients(times: &[f64], others: &[f64]) -> Option<Interval> {
    Interval::of(times.iter().zip(others).map(|(a, b)| a / b).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn work(steps: u64) -> f64 {
        (0..steps).fold(1.0, |x, i| black_box(x * 0.999 + i as f64))
    }

    #[test]
    fn the_yardstick_takes_time_and_no_more_than_a_chain_does() {
        let rounds = Rounds { count: 5, seconds: 1e-3 };
        let times = in_turns(&mut [yardstick(), yardstick_of_all_threads()], rounds);
        let [one, all] = [0, 1].map(|i| Interval::of(times[i].clone()).unwrap().median);
        // Two operations of three to five cycles each; unoptimised and on a busy machine more. Sixty-four pieces of six
        // chains on all threads.
        assert!((0.5..200.0).contains(&one), "{one}");
        assert!((1.0..50_000.0).contains(&all), "{all}");
    }

    #[test]
    fn twice_the_work_takes_twice_the_time() {
        let mut tasks = [
            Task::new(1, || {
                black_box(work(2_000));
            }),
            Task::new(1, || {
                black_box(work(4_000));
            }),
            Task::new(2, || {
                black_box(work(4_000));
            }),
        ];
        let times = in_turns(&mut tasks, Rounds { count: 31, seconds: 1e-3 });
        let [one, two, halves] = [0, 1, 2].map(|i| Interval::of(times[i].clone()).unwrap().median);
        assert!((1.7..2.3).contains(&(two / one)), "{one} {two}");
        assert!((0.85..1.15).contains(&(halves / one)), "{one} {halves}");
    }
}
