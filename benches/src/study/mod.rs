//! Run time against error: the study behind `ltc bench`.
//!
//! A [`Run`] is a list of [`Record`]s, each a thing with its time, its size and its errors, measured in one go on one machine.
//! [`page`] makes a page to look at of it, [`csv`], [`bencher`] and [`action`] feed what others draw dashboards with, and
//! [`compare`] says what became slower or more wrong from one run to another.

mod error;
mod exports;
pub mod gpu;
pub mod integrals;
mod lookups;
mod machine;
mod page;
mod pictures;
mod plot;
mod tables;
pub mod timer;

use ltc_render::RenderTables;
use ltc_table::Catalogue;

pub use error::StudyError;
pub use exports::{action, bencher, csv};
pub use ltc_records::{
    Change, Comparison, Interval, Machine, Record, Run, SCHEMA, Thresholds, Verdict, YARDSTICK, compare,
};
pub use page::page;
use timer::{Rounds, Task};

/// What to measure.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// In under a minute, with fewer cases, smaller pictures and wider intervals.
    pub quick: bool,
    /// When it begins, RFC 3339 in UTC.
    pub date: String,
    /// The commit that is measured, if known.
    pub commit: Option<String>,
}

/// What [`run`] is at.
pub struct Step<'a> {
    /// In words.
    pub stage: &'a str,
    /// Steps done.
    pub done: usize,
    /// Steps in all.
    pub total: usize,
}

const STAGES: usize = 4;

/// Measures everything; `observe` is told of each step.
///
/// # Errors
/// [`StudyError`]: a form worse than it may be, a table that is missing, a picture that cannot be made.
pub fn run(plan: &Plan, catalogue: &Catalogue, observe: &dyn Fn(Step<'_>)) -> Result<Run, StudyError> {
    let step = |done: usize, stage: &str| observe(Step { stage, done, total: STAGES });
    let mut machine = machine::here();
    let mut records = Vec::new();
    let versions: Vec<_> = catalogue.names().filter_map(|name| catalogue.find(name).ok()).collect();
    step(0, "tables");
    for version in versions.iter().filter(|version| tables::is_ggx(version)) {
        records.extend(tables::shipped(version, plan)?);
    }
    records.extend(tables::sizes(plan, |what| step(0, what))?);
    step(1, "lookups and integrals");
    records.extend(timed(plan, catalogue)?);
    step(2, "pictures");
    let isotropic = catalogue.find("ggx-isotropic")?;
    let anisotropic = catalogue.find("ggx-anisotropic")?;
    let of_pictures = RenderTables { isotropic: isotropic.table(), anisotropic: anisotropic.table() };
    let (pictures, device) = pictures::measure(&of_pictures, plan, |scene| step(2, scene))?;
    records.extend(pictures);
    machine.gpu = device.ok();
    on_device(&mut machine, &mut records, plan, catalogue, &|form| step(3, form))?;
    step(STAGES, "done");
    Ok(finished(plan, machine, records))
}

/// Measures what a graphics device does, and nothing else: for a machine that is had for a short time.
///
/// # Errors
/// [`StudyError`]; [`StudyError::NoDevice`] where there is none.
pub fn run_on_device(
    plan: &Plan,
    catalogue: &Catalogue,
    observe: &dyn Fn(Step<'_>),
) -> Result<Run, StudyError> {
    let step = |done: usize, stage: &str| observe(Step { stage, done, total: 1 });
    let (mut machine, mut records) = (machine::here(), Vec::new());
    if let Some(reason) = on_device(&mut machine, &mut records, plan, catalogue, &|form| step(0, form))? {
        return Err(StudyError::NoDevice(reason));
    }
    step(1, "done");
    Ok(finished(plan, machine, records))
}

/// Why there is no device, if there is none.
fn on_device(
    machine: &mut Machine,
    records: &mut Vec<Record>,
    plan: &Plan,
    catalogue: &Catalogue,
    step: &dyn Fn(&str),
) -> Result<Option<String>, StudyError> {
    match gpu::measure(catalogue, plan, step)? {
        Ok(found) => {
            records.extend(found.records);
            (machine.gpu, machine.gpu_clock) = (Some(found.device), Some(found.clock));
            Ok(None)
        }
        Err(reason) => Ok(Some(reason)),
    }
}

fn finished(plan: &Plan, machine: Machine, records: Vec<Record>) -> Run {
    Run {
        schema: SCHEMA,
        tool: env!("CARGO_PKG_VERSION").to_owned(),
        quick: plan.quick,
        date: plan.date.clone(),
        commit: plan.commit.clone(),
        machine,
        records,
    }
}

/// Lookups and integrals, timed in turns, so that their ratios are those of the same minute.
fn timed(plan: &Plan, catalogue: &Catalogue) -> Result<Vec<Record>, StudyError> {
    let count = if plan.quick { 250 } else { 1000 };
    let polygons: &[usize] = if plan.quick { &[3, 8, 64] } else { &[3, 4, 8, 16, 32, 64] };
    let lights = integrals::Lights::new(catalogue.find("ggx-anisotropic")?.table(), count)?;
    let mut forms = integrals::forms(&lights, polygons)?;
    let mut records = vec![Record::new(YARDSTICK, "step")];
    let mut tasks = vec![timer::yardstick()];
    for name in ["ggx-isotropic", "ggx-isotropic-dropin", "ggx-anisotropic"] {
        let Ok(version) = catalogue.find(name) else { continue };
        for (task, way) in lookups::tasks(version, 1000).into_iter().zip(["interpolated", "inverted"]) {
            records.push(Record::new(format!("lookup/{name}/{way}"), "lookup"));
            tasks.push(task);
        }
    }
    for form in &mut forms {
        let (max, rms) = form.errors()?;
        let record = Record::new(format!("integral/{}", form.name), "light");
        records.push(record.error("max", max).error("rms", rms));
    }
    for form in &mut forms {
        tasks.push(Task::new(form.count(), || form.run()));
    }
    let rounds =
        if plan.quick { Rounds { count: 25, seconds: 4e-3 } } else { Rounds { count: 101, seconds: 10e-3 } };
    let times = timer::nanoseconds(&mut tasks, rounds);
    let with_time = |(record, time): (Record, Option<Interval>)| {
        let time = time.ok_or_else(|| StudyError::Untimed(record.id.clone()))?;
        Ok(record.timed(time))
    };
    records.into_iter().zip(times).map(with_time).collect()
}
