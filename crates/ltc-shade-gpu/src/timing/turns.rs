//! Several programs, timed in turns.

use std::time::{Duration, Instant};

use super::clock::{Stamps, doubt, processor, submit, wait_for, wall};
use super::{Clock, PixelGrid, PixelProgram};
use crate::{Gpu, GpuError};

/// How long to measure.
#[derive(Clone, Copy, Debug)]
pub struct Turns {
    /// What one measurement lasts at least, in nanoseconds: passes are repeated for that.
    pub shortest: f64,
    /// Turns of all programs that are not counted, until this has passed: clocks rise under load.
    pub warm_up: Duration,
    /// Turns that are counted at least.
    pub least: usize,
    /// And at most.
    pub most: usize,
}

/// Passes of one measurement at most.
const MOST_REPEATS: f64 = 512.0;

/// Nanoseconds of a pass of each program in each turn, and what told them.
///
/// `enough` is asked after each turn from [`Turns::least`] on whether that was all.
///
/// # Errors
/// [`GpuError::Device`].
pub fn in_turns(
    gpu: &Gpu,
    grid: &PixelGrid,
    programs: &[&PixelProgram],
    turns: Turns,
    mut enough: impl FnMut(&[Vec<f64>]) -> bool,
) -> Result<(Clock, Vec<Vec<f64>>), GpuError> {
    gpu.checked(|| {
        let repeats = repeats(gpu, grid, programs, turns)?;
        let jobs: Vec<_> = programs.iter().copied().zip(repeats.iter().copied()).collect();
        let (clock, stamps) = clock(gpu, grid, &jobs)?;
        let now = processor().filter(|_| clock == Clock::Processor).unwrap_or(wall);
        let turn = || match &stamps {
            Some(stamps) => stamped(gpu, grid, &jobs, stamps),
            None => jobs.iter().map(|(program, n)| wait_for(gpu, grid, program, *n, None, now)).collect(),
        };
        let start = Instant::now();
        while start.elapsed() < turns.warm_up {
            turn()?;
        }
        let mut samples = vec![Vec::with_capacity(turns.most); jobs.len()];
        for count in 1..=turns.most {
            for ((samples, time), (_, n)) in samples.iter_mut().zip(turn()?).zip(&jobs) {
                samples.push(time / f64::from(*n));
            }
            if count >= turns.least && enough(&samples) {
                break;
            }
        }
        Ok((clock, samples))
    })
}

/// All programs one after the other without waiting between them, so that the device is never idle.
fn stamped(
    gpu: &Gpu,
    grid: &PixelGrid,
    jobs: &[(&PixelProgram, u32)],
    stamps: &Stamps,
) -> Result<Vec<f64>, GpuError> {
    for (place, (program, n)) in jobs.iter().enumerate() {
        submit(gpu, grid, program, *n, Some((stamps, place)));
    }
    stamps.read(gpu)
}

/// How often to repeat each program's pass.
fn repeats(
    gpu: &Gpu,
    grid: &PixelGrid,
    programs: &[&PixelProgram],
    turns: Turns,
) -> Result<Vec<u32>, GpuError> {
    let count = |program: &&PixelProgram| {
        // The first pass may compile.
        wait_for(gpu, grid, program, 1, None, wall)?;
        let mut repeats = 1.0_f64;
        loop {
            let took = wait_for(gpu, grid, program, repeats as u32, None, wall)?;
            if took >= 0.7 * turns.shortest || repeats >= MOST_REPEATS {
                return Ok((repeats * (turns.shortest / took).clamp(1.0, 2.0)).ceil() as u32);
            }
            repeats = (repeats * (turns.shortest / took).clamp(2.0, 16.0)).min(MOST_REPEATS).floor();
        }
    };
    programs.iter().map(count).collect()
}

/// The device's clock, if it is hardware, has one, and it is to be believed for every one of these.
fn clock(
    gpu: &Gpu,
    grid: &PixelGrid,
    jobs: &[(&PixelProgram, u32)],
) -> Result<(Clock, Option<Stamps>), GpuError> {
    if gpu.info().software && processor().is_some() {
        return Ok((Clock::Processor, None));
    }
    let Some(stamps) = Stamps::new(gpu, jobs.len())? else {
        return Ok((Clock::Wall { reason: "the device has no timestamps".to_owned() }, None));
    };
    let mut walls = Vec::with_capacity(jobs.len());
    for (place, (program, n)) in jobs.iter().enumerate() {
        walls.push(wait_for(gpu, grid, program, *n, Some((&stamps, place)), wall)?);
    }
    let told = stamps.read(gpu)?;
    match told.into_iter().zip(walls).find_map(|(stamped, wall)| doubt(stamped, wall)) {
        Some(reason) => Ok((Clock::Wall { reason }, None)),
        None => Ok((stamps.clock(), Some(stamps))),
    }
}
