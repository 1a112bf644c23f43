//! Times, as one process finds them.

use std::collections::BTreeMap;

use ltc_records::pooled;
use ltc_table::Catalogue;
use serde::{Deserialize, Serialize};

use super::integrals::Lights;
use super::timer::{self, Rounds, Task};
use super::{
    Interval, Plan, Record, StudyError, YARDSTICK, gpu, integrals, lookups, pictures, render_tables,
};

/// What a process found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Session {
    /// Times and ratios, and no errors.
    pub records: Vec<Record>,
    /// What told the times of the graphics device, where there is one.
    pub gpu_clock: Option<String>,
}

/// Times everything, here and now.
///
/// # Errors
/// [`StudyError`]: a table that is missing, a picture that cannot be made, a device that fails.
pub fn session(plan: &Plan, catalogue: &Catalogue) -> Result<Session, StudyError> {
    let mut all = Session::default();
    if !plan.device_only {
        all.records.extend(on_a_core(plan, catalogue)?);
        all.records.extend(pictures::times(&render_tables(catalogue)?, plan)?);
    }
    if let Ok((records, clock)) = gpu::times(catalogue, plan)? {
        all.records.extend(records);
        all.gpu_clock = Some(clock);
    }
    Ok(all)
}

/// The lights of the integrals.
pub(super) fn lights(plan: &Plan, catalogue: &Catalogue) -> Result<Lights, StudyError> {
    Lights::new(catalogue.find("ggx-anisotropic")?.table(), if plan.quick { 250 } else { 1000 })
}

/// Numbers of corners.
pub(super) fn polygons(plan: &Plan) -> &'static [usize] {
    if plan.quick { &[3, 8, 64] } else { &[3, 4, 8, 16, 32, 64] }
}

/// Lookups and integrals, timed in turns, so that their ratios are those of the same minute.
fn on_a_core(plan: &Plan, catalogue: &Catalogue) -> Result<Vec<Record>, StudyError> {
    let lights = lights(plan, catalogue)?.unjudged();
    let mut forms = integrals::forms(&lights, polygons(plan))?;
    let mut records = vec![Record::new(YARDSTICK, "step")];
    let mut tasks = vec![timer::yardstick()];
    for name in ["ggx-isotropic", "ggx-isotropic-dropin", "ggx-anisotropic", "ggx-anisotropic-closed-form"] {
        let Ok(version) = catalogue.find(name) else { continue };
        for (task, way) in lookups::tasks(version, 1000).into_iter().zip(["interpolated", "inverted"]) {
            records.push(Record::new(format!("lookup/{name}/{way}"), "lookup"));
            tasks.push(task);
        }
    }
    for form in &mut forms {
        records.push(Record::new(format!("integral/{}", form.name), "light"));
        tasks.push(Task::new(form.count(), || form.run()));
    }
    let rounds =
        if plan.quick { Rounds { count: 5, seconds: 4e-3 } } else { Rounds { count: 15, seconds: 10e-3 } };
    let times = timer::in_turns(&mut tasks, rounds);
    let with_time = |(record, samples): (Record, &Vec<f64>)| {
        let time = Interval::of(samples.clone()).ok_or_else(|| StudyError::Untimed(record.id.clone()))?;
        let relative = timer::quotients(samples, &times[0]).filter(|_| record.id != YARDSTICK);
        Ok(record.timed(time).relative(relative))
    };
    records.into_iter().zip(&times).map(with_time).collect()
}

/// What is known of each thing: errors and sizes of `judged`, times of all sessions. The order is that of `judged`; what was
/// timed alone follows.
pub(super) fn joined(judged: Vec<Record>, sessions: Vec<Session>) -> Vec<Record> {
    let sessions: Vec<Vec<Record>> = sessions.into_iter().map(|session| session.records).collect();
    let mut timed: BTreeMap<usize, Record> = pooled(&sessions).into_iter().enumerate().collect();
    let places: BTreeMap<String, usize> = timed.iter().map(|(k, r)| (r.id.clone(), *k)).collect();
    let with_times = |record: Record| match places.get(&record.id).and_then(|k| timed.remove(k)) {
        Some(Record { time, relative, ratio, .. }) => Record { time, relative, ratio, ..record },
        None => record,
    };
    let mut records: Vec<Record> = judged.into_iter().map(with_times).collect();
    records.extend(timed.into_values());
    records
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_and_times_of_one_thing_come_together() {
        let at = |x: f64| Interval { median: x, low: x, high: x };
        let judged = vec![
            Record::new("table/a", "table").sized(7),
            Record::new("integral/b", "light").error("max", 0.5),
        ];
        let timed = vec![
            Record::new(YARDSTICK, "step").timed(at(2.0)),
            Record::new("integral/b", "light").timed(at(3.0)),
        ];
        let all = joined(judged, vec![Session { records: timed, gpu_clock: None }]);
        let ids: Vec<&str> = all.iter().map(|record| record.id.as_str()).collect();
        assert_eq!(ids, ["table/a", "integral/b", YARDSTICK]);
        assert_eq!((all[0].bytes, all[0].time), (Some(7), None));
        assert_eq!((all[1].errors["max"], all[1].time), (0.5, Some(at(3.0))));
        assert_eq!(all[2].time, Some(at(2.0)));
    }
}
