//! What several processes found, as one.

use crate::{Interval, Record};

/// The records of the first session, each with the median of what all sessions say of it and where that median lies.
///
/// A program is as fast as its code and data happen to lie: that differs from process to process, by a tenth where branches
/// are many, and no number of turns within one process shows it. So a session's own intervals are dropped, and its medians
/// are the samples. What a session lacks is taken of those that have it.
pub fn pooled(sessions: &[Vec<Record>]) -> Vec<Record> {
    let Some(first) = sessions.first() else { return Vec::new() };
    let pool = |record: &Record| {
        let same: Vec<&Record> =
            sessions.iter().filter_map(|session| session.iter().find(|r| r.id == record.id)).collect();
        let of = |figure: fn(&Record) -> Option<Interval>| {
            Interval::of(same.iter().filter_map(|r| figure(r)).map(|found| found.median).collect())
        };
        Record {
            time: of(|r| r.time),
            relative: of(|r| r.relative),
            ratio: of(|r| r.ratio),
            ..record.clone()
        }
    };
    first.iter().map(pool).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session(time: f64) -> Vec<Record> {
        let around = |x: f64| Interval { median: x, low: 0.999 * x, high: 1.001 * x };
        vec![
            Record::new("lookup/a", "lookup").timed(around(time)).relative(Some(around(0.1 * time))),
            Record::new("ratio/b", "ratio").ratio(around(2.0 / time), Some(0.5)),
        ]
    }

    #[test]
    fn what_differs_between_processes_is_in_the_interval() {
        let sessions: Vec<_> = [11.0, 10.0, 12.0, 9.0, 10.5, 9.5, 10.2].map(session).into();
        let [lookup, ratio] = &pooled(&sessions)[..] else { panic!("two records") };
        assert_eq!(lookup.time, Some(Interval { median: 10.2, low: 9.0, high: 12.0 }));
        assert!((lookup.relative.unwrap().high - 1.2).abs() < 1e-12);
        assert_eq!((ratio.asked, ratio.ratio.unwrap().low), (Some(0.5), 2.0 / 12.0));
        assert_eq!(ratio.time, None);
    }

    #[test]
    fn nothing_comes_of_nothing_and_one_is_itself() {
        assert!(pooled(&[]).is_empty());
        let one = pooled(&[session(3.0)]);
        assert_eq!(one[0].time, Some(Interval { median: 3.0, low: 3.0, high: 3.0 }));
    }
}
