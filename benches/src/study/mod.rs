//! Run time against error: the study behind `ltc bench`.
//!
//! A [`Run`] is a list of [`Record`]s, each a thing with its time, its size and its errors, measured in one go on one machine.
//! Errors and sizes are measured once, by [`run`]; times by [`session`]s, each of which ought to be a process of its own,
//! because a program is as fast as its code and data happen to lie.
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
mod session;
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
pub use session::{Session, session};

/// What to measure.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// In under a minute, with fewer cases, smaller pictures and wider intervals.
    pub quick: bool,
    /// What the graphics device does, and nothing else: for a machine that is had for a short time.
    pub device_only: bool,
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

/// Sessions of a run. From six on, an interval between the least and the largest of their medians holds the true one in 95 of
/// 100 cases.
fn sessions(plan: &Plan) -> usize {
    if plan.quick { 6 } else { 9 }
}

/// Measures everything: errors and sizes here, times by asking `again` for what [`session`] returns, several times. `observe`
/// is told of each step.
///
/// # Errors
/// [`StudyError`]: a form worse than it may be, a table that is missing, a picture that cannot be made, a session that failed;
/// [`StudyError::NoDevice`] where the device alone is asked for and there is none.
pub fn run(
    plan: &Plan,
    catalogue: &Catalogue,
    again: &dyn Fn() -> Result<Session, StudyError>,
    observe: &dyn Fn(Step<'_>),
) -> Result<Run, StudyError> {
    let (before, sessions) = (if plan.device_only { 1 } else { 4 }, sessions(plan));
    let step = |done: usize, stage: &str| observe(Step { stage, done, total: before + sessions });
    let mut machine = machine::here();
    let mut judged = Vec::new();
    if !plan.device_only {
        judged.extend(on_processor(plan, catalogue, &step)?);
    }
    match gpu::errors(catalogue, plan, &|form| step(before - 1, form))? {
        Ok((records, device)) => {
            judged.extend(records);
            machine.gpu = Some(device);
        }
        Err(reason) if plan.device_only => return Err(StudyError::NoDevice(reason)),
        Err(_) => {}
    }
    let mut timed = Vec::with_capacity(sessions);
    for k in 0..sessions {
        step(before + k, &format!("times, session {} of {sessions}", k + 1));
        timed.push(again()?);
    }
    machine.gpu_clock = timed.iter().find_map(|session| session.gpu_clock.clone());
    step(before + sessions, "done");
    Ok(Run {
        schema: SCHEMA,
        tool: env!("CARGO_PKG_VERSION").to_owned(),
        quick: plan.quick,
        date: plan.date.clone(),
        commit: plan.commit.clone(),
        machine,
        records: session::joined(judged, timed),
    })
}

/// Errors and sizes of what needs no graphics device, and of the pictures that it makes.
fn on_processor(
    plan: &Plan,
    catalogue: &Catalogue,
    step: &dyn Fn(usize, &str),
) -> Result<Vec<Record>, StudyError> {
    let mut records = Vec::new();
    let versions: Vec<_> = catalogue.names().filter_map(|name| catalogue.find(name).ok()).collect();
    step(0, "tables");
    for version in versions.iter().filter(|version| tables::is_ggx(version)) {
        records.extend(tables::shipped(version, plan)?);
    }
    records.extend(tables::sizes(plan, |what| step(0, what))?);
    step(1, "integrals");
    let lights = session::lights(plan, catalogue)?;
    for form in &mut integrals::forms(&lights, session::polygons(plan))? {
        let (max, rms) = form.errors()?;
        let record = Record::new(format!("integral/{}", form.name), "light");
        records.push(record.error("max", max).error("rms", rms));
    }
    step(2, "pictures");
    records.extend(pictures::errors(&render_tables(catalogue)?, plan, |scene| step(2, scene))?);
    Ok(records)
}

/// Those that pictures are made with.
fn render_tables(catalogue: &Catalogue) -> Result<RenderTables<'_>, StudyError> {
    let [isotropic, anisotropic] =
        [catalogue.find("ggx-isotropic")?.table(), catalogue.find("ggx-anisotropic")?.table()];
    Ok(RenderTables { isotropic, anisotropic })
}
