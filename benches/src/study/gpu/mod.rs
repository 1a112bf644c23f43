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

use super::timer::quotients;
use super::{Interval, Plan, Record, StudyError};
use bench::{Bench, Form, Measure};
use forms::{Extent, Forms};

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
        turns: turns(1e6, 3, 5, 0),
        budget: Duration::from_secs(1),
        judged: 100,
    };
    let whole = |name, size| Picture {
        name,
        size,
        extent: Extent { all: true, few_many: [2, 8], counts: MANY },
        turns: turns(1e6, 5, 31, 500),
        budget: Duration::from_secs(10),
        judged: 1000,
    };
    match (plan.quick, software) {
        (true, true) => vec![small("180p", [320, 180])],
        (true, false) => vec![small("1080p", [1920, 1080])],
        (false, false) => vec![whole("1080p", [1920, 1080]), whole("720p", [1280, 720])],
        (false, true) => vec![
            Picture {
                turns: turns(2e6, 3, 9, 0),
                budget: Duration::from_secs(15),
                ..whole("180p", [320, 180])
            },
            Picture {
                extent: Extent { all: false, few_many: [1, 2], counts: &[1, 2, 4] },
                turns: turns(1e6, 1, 3, 0),
                budget: Duration::from_secs(15),
                judged: 1000,
                ..whole("1080p", [1920, 1080])
            },
        ],
    }
}

/// Errors of all forms on the best device there is, and what device that is; `Ok(Err)` with the reason where there is none.
///
/// # Errors
/// A form that is worse than it may be, a table that is missing, a device that fails.
pub fn errors(
    catalogue: &Catalogue,
    plan: &Plan,
    step: &dyn Fn(&str),
) -> Result<Result<(Vec<Record>, String), String>, StudyError> {
    let gpu = match open() {
        Ok(gpu) => gpu,
        Err(reason) => return Ok(Err(reason)),
    };
    let mut records = Vec::new();
    for picture in pictures(plan, gpu.info().software) {
        let say = |what: &str| step(&format!("{} {what}", picture.name));
        let bench = Bench::new(&gpu, picture.size, Some(picture.judged))?;
        let forms = Forms::new(bench, picture.extent, catalogue, &say)?;
        for form in &forms.bench.forms {
            let record = picture.record(form);
            records.push(match form.errors {
                Some([max, rms]) => record.error("max", max).error("rms", rms),
                None => record,
            });
        }
    }
    Ok(Ok((records, gpu.info().to_string())))
}

/// Times of the same, ratios of them, and what told the times.
///
/// # Errors
/// A table that is missing, a device that fails.
pub fn times(
    catalogue: &Catalogue,
    plan: &Plan,
) -> Result<Result<(Vec<Record>, String), String>, StudyError> {
    let gpu = match open() {
        Ok(gpu) => gpu,
        Err(reason) => return Ok(Err(reason)),
    };
    let (mut records, mut told) = (Vec::new(), String::new());
    for picture in pictures(plan, gpu.info().software) {
        let bench = Bench::new(&gpu, picture.size, None)?;
        let forms = Forms::new(bench, picture.extent, catalogue, &|_| {})?;
        let (timed, clock) = time(&forms.bench, &picture)?;
        records.extend(timed);
        told = clock;
    }
    Ok(Ok((records, told)))
}

fn open() -> Result<Gpu, String> {
    Gpu::new(GpuOptions { filtering: Filtering::Exact, ..GpuOptions::default() }).map_err(|e| e.to_string())
}

impl Picture {
    /// With nothing measured yet.
    fn record(&self, form: &Form) -> Record {
        let id = match form.name.as_str() {
            YARDSTICK => format!("yardstick/gpu/{}", self.name),
            name => format!("gpu/{}/{name}", self.name),
        };
        Record::new(
            id,
            if matches!(form.measure, Measure::Slope { .. }) { "light of a frame" } else { "frame" },
        )
    }
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
    let yardstick = bench.measure(YARDSTICK).map(|measure| measure.nanoseconds(&samples));
    let mut records = Vec::new();
    for form in &bench.forms {
        let times = form.measure.nanoseconds(&samples);
        let relative = yardstick.as_ref().filter(|_| form.name != YARDSTICK);
        let relative = relative.and_then(|yardstick| quotients(&times, yardstick));
        let time = Interval::of(times).ok_or_else(|| StudyError::Untimed(form.name.clone()))?;
        records.push(picture.record(form).timed(time).relative(relative));
    }
    records.extend(ratios::records(bench, &samples, picture.name));
    Ok((records, clock.to_string()))
}

/// The form that says how slow the device is.
const YARDSTICK: &str = "yardstick";

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
