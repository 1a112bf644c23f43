//! What tells how long a pass took.

use std::fmt;
use std::sync::LazyLock;
use std::time::Instant;

use wgpu::{BufferUsages, Features};

use super::{PixelGrid, PixelProgram};
use crate::compute::read_back;
use crate::{Gpu, GpuError};

/// What tells how long a pass took.
#[derive(Clone, Debug, PartialEq)]
pub enum Clock {
    /// The device's own.
    Timestamps {
        /// Nanoseconds between two ticks.
        tick: f64,
    },
    /// The processor's, around submitting and waiting: all threads of this process together. For a software driver, whose work
    /// that is; what else runs on the machine does not count.
    Processor,
    /// The wall clock, around submitting and waiting.
    Wall {
        /// Why not the device's own.
        reason: String,
    },
}

impl fmt::Display for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Timestamps { tick } => write!(f, "timestamps of the device, {tick} ns a tick"),
            Self::Processor => {
                write!(f, "time of the processor, all threads of the software driver together")
            }
            Self::Wall { reason } => write!(f, "the wall clock around submitting and waiting: {reason}"),
        }
    }
}

/// Timestamps, one pair for each program.
pub(super) struct Stamps {
    set: wgpu::QuerySet,
    buffer: wgpu::Buffer,
    tick: f64,
}

/// A device's own clock is believed if it says at least this part of what passes around submitting and waiting.
const BELIEVED: [f64; 2] = [0.4, 1.05];

impl Stamps {
    /// `None` where the device has no timestamps for this many programs.
    pub fn new(gpu: &Gpu, programs: usize) -> Result<Option<Self>, GpuError> {
        let count = 2 * programs as u32;
        if !gpu.device().features().contains(Features::TIMESTAMP_QUERY) || count > wgpu::QUERY_SET_MAX_QUERIES
        {
            return Ok(None);
        }
        gpu.checked(|| {
            let label = Some("ltc timestamps");
            let ty = wgpu::QueryType::Timestamp;
            let set = gpu.device().create_query_set(&wgpu::QuerySetDescriptor { label, ty, count });
            let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label,
                size: 8 * u64::from(count),
                usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            Ok(Some(Self { set, buffer, tick: f64::from(gpu.queue().get_timestamp_period()) }))
        })
    }

    /// Nanoseconds from each program's first pass to its last, of the latest submissions.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<f64>, GpuError> {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        encoder.resolve_query_set(&self.set, 0..self.buffer.size() as u32 / 8, &self.buffer, 0);
        gpu.queue().submit([encoder.finish()]);
        let words = read_back(gpu, &self.buffer)?;
        let ticks: Vec<u64> = words
            .as_chunks::<2>()
            .0
            .iter()
            .map(|[low, high]| u64::from(*high) << 32 | u64::from(*low))
            .collect();
        let between = |[from, to]: &[u64; 2]| to.saturating_sub(*from) as f64 * self.tick;
        Ok(ticks.as_chunks::<2>().0.iter().map(between).collect())
    }

    pub fn clock(&self) -> Clock {
        Clock::Timestamps { tick: self.tick }
    }
}

/// Submits `repeats` passes of a program, which is number `place` of the timestamps.
pub(super) fn submit(
    gpu: &Gpu,
    grid: &PixelGrid,
    program: &PixelProgram,
    repeats: u32,
    stamps: Option<(&Stamps, usize)>,
) {
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    for i in 0..repeats {
        let writes = stamps.and_then(|(stamps, place)| {
            let first = (i == 0).then_some(2 * place as u32);
            let last = (i + 1 == repeats).then_some(2 * place as u32 + 1);
            (first.is_some() || last.is_some()).then_some((&stamps.set, first, last))
        });
        program.encode(&mut encoder, grid, writes);
    }
    gpu.queue().submit([encoder.finish()]);
}

/// Nanoseconds around submitting that and waiting for it, by `now`.
pub(super) fn wait_for(
    gpu: &Gpu,
    grid: &PixelGrid,
    program: &PixelProgram,
    repeats: u32,
    stamps: Option<(&Stamps, usize)>,
    now: fn() -> f64,
) -> Result<f64, GpuError> {
    let start = now();
    submit(gpu, grid, program, repeats, stamps);
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).map_err(GpuError::device)?;
    Ok(now() - start)
}

static BEGINNING: LazyLock<Instant> = LazyLock::new(Instant::now);

/// Nanoseconds of the wall clock.
pub(super) fn wall() -> f64 {
    BEGINNING.elapsed().as_secs_f64() * 1e9
}

/// Nanoseconds that processors have spent on this process.
#[cfg(unix)]
pub(super) fn processor() -> Option<fn() -> f64> {
    Some(|| {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
    })
}

/// Not told here.
#[cfg(not(unix))]
pub(super) fn processor() -> Option<fn() -> f64> {
    None
}

/// Why timestamps of `stamped` nanoseconds are not believed where the wall clock says `wall`.
pub(super) fn doubt(stamped: f64, wall: f64) -> Option<String> {
    let part = stamped / wall;
    let believed = (BELIEVED[0]..=BELIEVED[1]).contains(&part);
    (!believed).then(|| format!("timestamps say {:.3} ms where {:.3} ms pass", stamped * 1e-6, wall * 1e-6))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timestamps_that_cannot_be_are_not_believed() {
        assert_eq!(doubt(0.9e6, 1e6), None);
        assert_eq!(doubt(0.0, 1e6).unwrap(), "timestamps say 0.000 ms where 1.000 ms pass");
        assert!(doubt(2e6, 1e6).is_some() && doubt(f64::NAN, 1e6).is_some());
    }
}
