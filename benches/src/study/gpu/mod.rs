//! Times on a graphics device: lookups, integrals, both, with the published forms beside them, and the ratios between them.
//!
//! Every form runs over the same floor (`scene.rs`), is held against `ltc_core` and `ltc_table` in `f64` first, and is timed in
//! turns with all others of its picture by [`ltc_shade_gpu::timing`]. The published forms are written from the papers, in
//! `wgsl/`; nothing of them is in the shipped modules.

mod bench;
#[cfg(test)]
mod checks;
mod forms;
mod ratios;
mod scene;
mod sources;
mod tables;

use std::time::{Duration, Instant};

use ltc_shade_gpu::timing::{PixelProgram, Turns, in_turns};
use ltc_shade_gpu::{Filtering, Gpu, GpuOptions};
use ltc_table::Catalogue;

use super::{Interval, Plan, Record, StudyError};
use bench::{Bench, Measure};
use forms::{Extent, Forms};

/// What was measured, and on what.
pub struct OnDevice {
    /// Forms and ratios.
    pub records: Vec<Record>,
    /// The device, its driver, and whether it is software.
    pub device: String,
    /// What told the times.
    pub clock: String,
}

/// A picture's size and how much is timed over it.
struct Picture {
    name: &'static str,
    size: [u32; 2],
    extent: Extent,
    turns: Turns,
    /// No further turn begins after this.
    budget: Duration,
    judged: usize,
}

const MANY: &[u32] = &[1, 2, 4, 8, 16, 64];

/// A software driver does at 1080p what the ratios need, and everything on a smaller picture.
fn pictures(plan: &Plan, software: bool) -> Vec<Picture> {
    let turns = |shortest: f64, least: usize, most: usize, warm_up: u64| Turns {
        shortest,
        warm_up: Duration::from_millis(warm_up),
        least,
        most,
    };
    let few = Extent { all: false, few_many: [1, 3], counts: &[1, 4, 16] };
    let small = |name, size| Picture {
        name,
        size,
        extent: few,
        turns: turns(2e6, 5, 9, 0),
        budget: Duration::from_secs(5),
        judged: 100,
    };
    let whole = |name, size| Picture {
        name,
        size,
        extent: Extent { all: true, few_many: [2, 8], counts: MANY },
        turns: turns(1e6, 15, 201, 500),
        budget: Duration::from_secs(60),
        judged: 1000,
    };
    match (plan.quick, software) {
        (true, true) => vec![small("180p", [320, 180])],
        (true, false) => vec![small("1080p", [1920, 1080])],
        (false, false) => vec![whole("1080p", [1920, 1080]), whole("720p", [1280, 720])],
        (false, true) => vec![
            Picture {
                turns: turns(4e6, 7, 51, 0),
                budget: Duration::from_secs(150),
                ..whole("180p", [320, 180])
            },
            Picture {
                extent: Extent { all: false, few_many: [1, 2], counts: &[1, 2, 4] },
                turns: turns(1e6, 7, 9, 0),
                budget: Duration::from_secs(150),
                judged: 1000,
                ..whole("1080p", [1920, 1080])
            },
        ],
    }
}

/// All figures of the best device there is; `Ok(Err)` with the reason where there is none.
///
/// # Errors
/// A form that is worse than it may be, a table that is missing, a device that fails.
pub fn measure(
    catalogue: &Catalogue,
    plan: &Plan,
    step: &dyn Fn(&str),
) -> Result<Result<OnDevice, String>, StudyError> {
    let gpu = match Gpu::new(GpuOptions { filtering: Filtering::Exact, ..GpuOptions::default() }) {
        Ok(gpu) => gpu,
        Err(reason) => return Ok(Err(reason.to_string())),
    };
    let mut all = OnDevice { records: Vec::new(), device: gpu.info().to_string(), clock: String::new() };
    for picture in pictures(plan, gpu.info().software) {
        let of = picture.name;
        let say = |what: &str| step(&format!("{of} {what}"));
        let bench = Bench::new(&gpu, picture.size, picture.judged)?;
        let forms = Forms::new(bench, picture.extent, catalogue, &say)?;
        say("in turns");
        let (records, clock) = time(&forms.bench, &picture)?;
        all.records.extend(records);
        all.clock = clock;
    }
    Ok(Ok(all))
}

/// Turns until every interval of a frame is within a hundredth of its median, or the time is up.
fn time(bench: &Bench<'_>, picture: &Picture) -> Result<(Vec<Record>, String), StudyError> {
    let programs: Vec<&PixelProgram> = bench.programs.iter().collect();
    let start = Instant::now();
    let enough = |samples: &[Vec<f64>]| {
        let narrow =
            |times: &Vec<f64>| Interval::of(times.clone()).is_some_and(|i| i.high - i.low < 0.02 * i.median);
        start.elapsed() > picture.budget || samples.iter().all(narrow)
    };
    let (clock, samples) = in_turns(bench.gpu, &bench.grid, &programs, picture.turns, enough)?;
    let mut records = Vec::new();
    for form in &bench.forms {
        let id = match form.name.as_str() {
            "yardstick" => format!("yardstick/gpu/{}", picture.name),
            name => format!("gpu/{}/{name}", picture.name),
        };
        let per = if matches!(form.measure, Measure::Slope { .. }) { "light of a frame" } else { "frame" };
        let time = Interval::of(form.measure.nanoseconds(&samples));
        let mut record =
            Record::new(id, per).timed(time.ok_or_else(|| StudyError::Untimed(form.name.clone()))?);
        if let Some([max, rms]) = form.errors {
            record = record.error("max", max).error("rms", rms);
        }
        records.push(record);
    }
    records.extend(ratios::records(bench, &samples, picture.name));
    Ok((records, clock.to_string()))
}

/// What a difference counts that noise has made negative, in nanoseconds.
const LEAST: f64 = 1.0;

impl Measure {
    /// Turn by turn; a difference of two times that cannot be told apart may come out at [`LEAST`].
    fn nanoseconds(self, samples: &[Vec<f64>]) -> Vec<f64> {
        let both = |a: usize, b: usize| samples[a].iter().zip(&samples[b]);
        match self {
            Self::Frame(place) => samples[place].clone(),
            Self::Net(place, empty) => both(place, empty).map(|(a, b)| (a - b).max(LEAST)).collect(),
            Self::Slope { few, many, lights } => {
                both(many, few).map(|(a, b)| ((a - b) / lights).max(LEAST)).collect()
            }
        }
    }
}
